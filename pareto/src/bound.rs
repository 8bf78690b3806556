//! The most instructions that an update can take, from its machine code.
//!
//! The bound is the longest path through the control-flow graph of the compiled `update` and all
//! that it calls, whatever the data. A *turn* is an edge back to where a loop begins; all turns of
//! one update together are bounded by `turns`, so that a bound exists, and a loop of which
//! nothing is known there is an error.

use std::collections::BTreeMap;

use bench_image::Subject;
use virtual_board::flow::{self, Flow, Instruction};

use crate::image::Image;

/// The most instructions of an update, from its first to its return.
///
/// # Errors
/// One line on code that cannot be followed (an indirect call, recursion), or that has a loop
/// without a known bound.
pub fn of(image: &Image, subject: &Subject) -> Result<u32, String> {
    let update = image.update(subject)?;
    // Only windows have loops, and each turn takes one of the samples that a window can hold. The
    // other estimators are straight code.
    let turns = subject.window;
    let mut paths = Paths {
        image,
        turns,
        known: BTreeMap::new(),
        open: Vec::new(),
    };
    let costs = paths.of(update);
    let costs = costs.map_err(|error| format!("{subject}: {error}"))?;
    costs[turns].ok_or_else(|| format!("{subject}: never returns"))
}

/// Whether a bound can be derived. This analysis knows one loop over a window: not the loops over the
/// members of a bank, nor the routines that clear its arrays, nor the several loops of the robust exact
/// differentiator, nor the routine that clears a window of the algebraic one.
#[must_use]
pub fn is_derivable(estimator: &str) -> bool {
    !estimator.starts_with("imm") && !["algebraic", "robust-exact"].contains(&estimator)
}

/// By turns that may be taken: instructions of the longest path to a return, if there is one.
type Costs = Vec<Option<u32>>;

struct Paths<'a> {
    image: &'a Image,
    turns: usize,
    known: BTreeMap<u64, Costs>,
    /// Functions whose callees are being looked at.
    open: Vec<u64>,
}

impl Paths<'_> {
    fn of(&mut self, function: u64) -> Result<Costs, String> {
        if let Some(known) = self.known.get(&function) {
            return Ok(known.clone());
        }
        let name = self.image.name(function).to_owned();
        if self.open.contains(&function) {
            return Err(format!("{name} calls itself"));
        }
        let graph = Graph::of(
            flow::of(function, self.image.code.function(function)),
            function,
        );
        // The turns that are known of are those of estimators, not of routines that copy.
        let is_ours = name.contains("estimator_core") || name.contains("bench_image");
        if !graph.back.is_empty() && (self.turns == 0 || !is_ours) {
            return Err(format!("{name} has a loop of unknown length"));
        }
        self.open.push(function);
        let costs = self.longest(&graph, function, &name)?;
        self.open.pop();
        self.known.insert(function, costs.clone());
        Ok(costs)
    }

    fn longest(&mut self, graph: &Graph, entry: u64, name: &str) -> Result<Costs, String> {
        let budgets = self.turns + 1;
        let mut from: BTreeMap<u64, Costs> = graph
            .last_first
            .iter()
            .map(|at| (*at, vec![None; budgets]))
            .collect();
        for budget in 0..budgets {
            for at in &graph.last_first {
                let Instruction { flow, next } = graph.code[at];
                let go = |to: u64| {
                    let left = budget.checked_sub(usize::from(graph.back.contains(&(*at, to))))?;
                    *from.get(&to)?.get(left)?
                };
                let rest = match flow {
                    Flow::On => go(next),
                    Flow::Return => Some(0),
                    Flow::PerhapsReturn => go(next).max(Some(0)),
                    Flow::Jump(to) if graph.code.contains_key(&to) => go(to),
                    Flow::Perhaps(to) if graph.code.contains_key(&to) => go(to).max(go(next)),
                    // Another function, whose return is ours.
                    Flow::Jump(to) => self.of(to)?[budget],
                    Flow::Perhaps(to) => self.of(to)?[budget].max(go(next)),
                    Flow::Call(to) => {
                        let callee = self.of(to)?;
                        let rest = &from[&next];
                        (0..=budget)
                            .filter_map(|turns| Some(callee[turns]? + rest[budget - turns]?))
                            .max()
                    }
                    Flow::Unknown => {
                        return Err(format!("{name} goes on at {at:#x} where a register says"));
                    }
                };
                let cost = rest.map(|rest| rest + 1);
                from.get_mut(at).expect("has a place")[budget] = cost;
            }
        }
        Ok(from.remove(&entry).unwrap_or_else(|| vec![None; budgets]))
    }
}

/// A function's instructions, in an order that follows every edge but those back.
struct Graph {
    code: BTreeMap<u64, Instruction>,
    /// An instruction comes after all that it leads to.
    last_first: Vec<u64>,
    /// Edges back to an instruction on the way to them.
    back: Vec<(u64, u64)>,
}

impl Graph {
    fn of(code: BTreeMap<u64, Instruction>, entry: u64) -> Self {
        let mut graph = Self {
            last_first: Vec::new(),
            back: Vec::new(),
            code,
        };
        // Depth first, without recursion: instructions on the way, each with what is left to do.
        let mut way = vec![(entry, graph.leads_to(entry))];
        let mut seen = std::collections::BTreeSet::from([entry]);
        while let Some((at, left)) = way.last_mut() {
            let at = *at;
            let Some(to) = left.pop() else {
                graph.last_first.push(at);
                way.pop();
                continue;
            };
            if way.iter().any(|(on, _)| *on == to) {
                graph.back.push((at, to));
            } else if seen.insert(to) {
                let leads_to = graph.leads_to(to);
                way.push((to, leads_to));
            }
        }
        graph
    }

    fn leads_to(&self, at: u64) -> Vec<u64> {
        let Some(Instruction { flow, next }) = self.code.get(&at) else {
            return Vec::new();
        };
        let all: &[u64] = match flow {
            Flow::On | Flow::Call(_) | Flow::PerhapsReturn => &[*next],
            Flow::Perhaps(to) => &[*to, *next],
            Flow::Jump(to) => &[*to],
            Flow::Return | Flow::Unknown => &[],
        };
        let inside = all.iter().copied();
        inside.filter(|to| self.code.contains_key(to)).collect()
    }
}
