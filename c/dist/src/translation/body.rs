//! The body of a function: instructions of WebAssembly become statements of C.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use wasmparser::{BlockType, Operator};

use super::instructions::STACK;
use super::module::{Function, Module, text};
use super::value::{Kind, Value};

/// Longest expression: a longer one gets a name.
const LONGEST: usize = 120;

/// The statements of a function, and what it needs.
pub(super) struct Body {
    pub(super) text: String,
    /// Bytes of stack of its own.
    pub(super) frame: u32,
    pub(super) uses_stack: bool,
    /// Functions that it calls.
    pub(super) calls: BTreeSet<usize>,
}

/// A block, loop or condition that is open.
struct Open {
    label: usize,
    is_loop: bool,
    is_if: bool,
    /// Number of values on the stack before it.
    height: usize,
}

pub(super) struct Translator<'m> {
    pub(super) module: &'m Module<'m>,
    pub(super) function: &'m Function<'m>,
    pub(super) locals: Vec<Kind>,
    pub(super) stack: Vec<Value>,
    open: Vec<Open>,
    pub(super) statements: String,
    /// Types of the named values, and whether each is the result of a call.
    names: Vec<(Kind, bool)>,
    labels: usize,
    jumps: BTreeSet<usize>,
    /// Number of blocks that were opened in code that is never reached.
    pub(super) unreachable: Option<usize>,
    pub(super) frame: u32,
    calls: BTreeSet<usize>,
}

impl Body {
    /// Translates a function.
    pub(super) fn translate(module: &Module, function: &Function) -> Result<Self, String> {
        let mut locals = function.parameters.clone();
        for local in function.body.get_locals_reader().map_err(text)? {
            let (number, kind) = local.map_err(text)?;
            let kind = Kind::of(kind)?;
            locals.extend((0..number).map(|_| kind));
        }
        let mut translator = Translator {
            module,
            function,
            locals,
            stack: Vec::new(),
            open: Vec::new(),
            statements: String::new(),
            names: Vec::new(),
            labels: 0,
            jumps: BTreeSet::new(),
            unreachable: None,
            frame: 0,
            calls: BTreeSet::new(),
        };
        let operators = function.body.get_operators_reader().map_err(text)?;
        let operators: Result<Vec<_>, _> = operators.into_iter_with_offsets().collect();
        let operators = operators.map_err(text)?;
        let end = function.body.range().end;
        let ends = operators.iter().skip(1).map(|(_, at)| *at).chain([end]);
        for ((operator, at), next) in operators.iter().zip(ends) {
            let address = module.addresses.range(*at..next).next().is_some();
            translator.take(operator, address)?;
        }
        Ok(translator.body())
    }
}

impl Translator<'_> {
    fn body(self) -> Body {
        let mut declared = String::new();
        let parameters = self.function.parameters.len();
        let mut statements = self.statements;
        // The values of later names contain those of earlier ones.
        for k in (0..self.names.len()).rev() {
            let name = format!("t{k}");
            if uses(&statements, &name) == 1 {
                statements = without(&statements, &name, self.names[k].1);
            }
        }
        let is_used = |name: &str| uses(&statements, name) > 0;
        for (k, kind) in self.locals.iter().enumerate() {
            let name = format!("l{k}");
            if k >= parameters && is_used(&name) {
                writeln!(declared, "    {} {name} = 0;", kind.c()).expect("a string");
            } else if k < parameters && !is_used(&name) {
                writeln!(declared, "    (void){name};").expect("a string");
            }
        }
        for (k, (kind, _)) in self.names.iter().enumerate() {
            if is_used(&format!("t{k}")) {
                writeln!(declared, "    {} t{k};", kind.c()).expect("a string");
            }
        }
        // Declarations come before statements.
        let mut lines: Vec<&str> = declared.lines().collect();
        lines.sort_by_key(|line| line.trim_start().starts_with("(void)"));
        let mut text: String = lines.iter().map(|line| format!("{line}\n")).collect();
        for line in statements.lines() {
            let label = line.trim().strip_suffix(":;");
            let number = label.and_then(|label| label.strip_prefix("label_")?.parse().ok());
            if number.is_none_or(|number| self.jumps.contains(&number)) {
                text += line;
                text.push('\n');
            }
        }
        Body {
            text,
            frame: self.frame,
            uses_stack: self.module.uses_stack(self.function),
            calls: self.calls,
        }
    }

    pub(super) fn say(&mut self, statement: &str) {
        let indent = 4 * (1 + self.open.len());
        writeln!(self.statements, "{:indent$}{statement}", "").expect("a string");
    }

    pub(super) fn pop(&mut self) -> Result<Value, String> {
        self.stack
            .pop()
            .ok_or_else(|| "takes a value that is not there".to_owned())
    }

    /// Gives a value a name, so that later changes do not reach it.
    fn named(&mut self, value: &Value) -> Value {
        self.named_as(value, false)
    }

    fn named_as(&mut self, value: &Value, is_call: bool) -> Value {
        let name = format!("t{}", self.names.len());
        self.names.push((value.kind, is_call));
        self.say(&format!("{name} = {};", value.number()));
        Value::new(value.kind, name)
    }

    /// Gives a name to the values on the stack that `changes`.
    pub(super) fn keep(&mut self, changes: impl Fn(&Value) -> bool) {
        for k in 0..self.stack.len() {
            if changes(&self.stack[k]) {
                let value = self.stack[k].clone();
                self.stack[k] = self.named(&value);
            }
        }
    }

    pub(super) fn push(&mut self, value: Value) {
        let value = match value.text.len() > LONGEST {
            true => self.named(&value),
            false => value,
        };
        self.stack.push(value);
    }

    pub(super) fn open(
        &mut self,
        block: BlockType,
        is_loop: bool,
        is_if: bool,
    ) -> Result<(), String> {
        if block != BlockType::Empty {
            return Err("has a block with a value, which is not translated".to_owned());
        }
        let label = self.labels;
        self.labels += 1;
        if is_loop {
            self.say(&format!("label_{label}:;"));
        }
        self.open.push(Open {
            label,
            is_loop,
            is_if,
            height: self.stack.len(),
        });
        Ok(())
    }

    /// Begins the other branch of a condition.
    pub(super) fn otherwise(&mut self) {
        let open = self.open.split_off(self.open.len().saturating_sub(1));
        self.say("} else {");
        self.open.extend(open);
    }

    /// Ends a block, or the function.
    pub(super) fn close(&mut self) -> Result<(), String> {
        let Some(open) = self.open.pop() else {
            if self.function.result.is_some() && !self.stack.is_empty() {
                let statement = self.leave()?;
                self.say(&statement);
            }
            return Ok(());
        };
        if open.is_if {
            self.say("}");
        }
        if !open.is_loop {
            self.say(&format!("label_{}:;", open.label));
        }
        Ok(())
    }

    /// The statement that leaves a number of blocks.
    pub(super) fn jump(&mut self, depth: u32) -> Result<String, String> {
        let depth = depth as usize;
        if depth == self.open.len() {
            return self.leave();
        }
        let open = &self.open[self.open.len() - 1 - depth];
        self.jumps.insert(open.label);
        Ok(format!("goto label_{};", open.label))
    }

    /// The statement that leaves the function.
    pub(super) fn leave(&mut self) -> Result<String, String> {
        match self.function.result {
            None => Ok("return;".to_owned()),
            Some(_) => {
                let result = self
                    .stack
                    .last()
                    .ok_or("returns a value that is not there")?;
                Ok(format!("return {};", result.number()))
            }
        }
    }

    pub(super) fn assign(&mut self, k: u32) -> Result<(), String> {
        let value = self.pop()?;
        self.keep(|other| other.locals.contains(&k));
        let name = if k == STACK {
            "stack".to_owned()
        } else {
            format!("l{k}")
        };
        self.say(&format!("{name} = {};", value.number()));
        Ok(())
    }

    pub(super) fn call(&mut self, k: usize) -> Result<(), String> {
        let called = &self.module.functions[k];
        let first = self.stack.len().checked_sub(called.parameters.len());
        let arguments = self
            .stack
            .split_off(first.ok_or("calls without arguments")?);
        self.keep(|value| value.loads);
        let mut arguments: Vec<_> = arguments.iter().map(Value::number).collect();
        if self.module.uses_stack(called) {
            arguments.push("stack".to_owned());
        }
        self.calls.insert(k);
        let call = format!("{}({})", called.name, arguments.join(", "));
        match called.result {
            None => self.say(&format!("{call};")),
            Some(kind) => {
                let value = self.named_as(&Value::new(kind, call), true);
                self.stack.push(value);
            }
        }
        Ok(())
    }

    /// Passes over code that is never reached, up to the end of its block.
    pub(super) fn is_passed_over(&mut self, operator: &Operator) -> bool {
        let Some(opened) = &mut self.unreachable else {
            return false;
        };
        match operator {
            Operator::Block { .. } | Operator::Loop { .. } | Operator::If { .. } => *opened += 1,
            Operator::End if *opened > 0 => *opened -= 1,
            Operator::End | Operator::Else if *opened == 0 => {
                self.unreachable = None;
                let height = self.open.last().map_or(0, |open| open.height);
                self.stack.truncate(height);
                return false;
            }
            _ => {}
        }
        true
    }
}

/// How often a name occurs in these statements.
fn uses(statements: &str, name: &str) -> usize {
    let is_part =
        |one: Option<char>| one.is_some_and(|one| one.is_ascii_alphanumeric() || one == '_');
    let found = statements.match_indices(name);
    let whole = found.filter(|(at, _)| {
        let after = statements[at + name.len()..].chars().next();
        let before = statements[..*at].chars().next_back();
        !is_part(before) && !is_part(after)
    });
    whole.count()
}

/// Statements without the one that gives `name` a value that nothing uses. A call is made all the same.
fn without(statements: &str, name: &str, is_call: bool) -> String {
    let assigned = format!("{name} = ");
    let lines = statements.lines().filter_map(|line| {
        let value = line.trim_start().strip_prefix(&assigned);
        match value {
            None => Some(format!("{line}\n")),
            Some(value) if is_call => {
                let indent = line.len() - line.trim_start().len();
                Some(format!("{:indent$}{value}\n", ""))
            }
            Some(_) => None,
        }
    });
    lines.collect()
}
