//! One estimator over one course.

use crate::course::{Course, Draws, Shown, Stretch, TOP_STEP};
use crate::definition::Definition;
use crate::findings::Findings;
use crate::pair::Pair;
use crate::tested::TestedEstimator;

/// Fastest slip of the paper's constant-velocity experiment. A deviation is absolute (rad/s) up to
/// it and relative to the velocity beyond.
const HAPTIC_RAD_S: f64 = 20.0;

/// Number of starts, and ticks of each.
const STARTS: u64 = 200;
const START_TICKS: u32 = 300;

/// Ticks between comparisons of a window with its definition.
const DEFINITION_EVERY: u64 = 61;

/// Number of counts kept for the definition: many more than a window, so that they are moved
/// rarely.
const HISTORY: usize = 4096;

/// Runs `tested` for `ticks` ticks.
pub fn run(tested: &TestedEstimator, seed: u64, ticks: u64) -> Findings {
    let mut trial = Trial::new(tested, seed);
    // The following ticks test the settled filter; starts are measured separately.
    trial.recover();
    while trial.found.ticks < ticks {
        trial.stretch();
        trial.recover();
    }
    trial.found
}

/// Largest deviation shortly after starts in motion, rad/s.
fn start_deviation(tested: &TestedEstimator, seed: u64) -> f64 {
    let rad_per_count = tested.rad_per_count();
    let mut draws = Draws::new(!seed);
    let mut worst = 0.0f64;
    for _ in 0..STARTS {
        let velocity = HAPTIC_RAD_S / rad_per_count * draws.unit();
        let mut pair = tested.pair();
        let mut course = Course::new(draws.bits(), tested.rate_hz);
        pair.start(&course.shown());
        course.slope(velocity, START_TICKS);
        while !course.is_over() {
            let (narrow, wide) = pair.update(&course.step());
            worst = worst.max((f64::from(narrow) - wide).abs() * rad_per_count);
        }
    }
    worst
}

struct Trial<'a> {
    tested: &'a TestedEstimator,
    pair: Box<dyn Pair>,
    course: Course,
    found: Findings,
    rad_per_count: f64,
    /// Largest velocity, counted or estimated, since the last rest, counts per tick.
    fastest: f64,
    /// The count, extended from its lower 16 bits tick by tick.
    extended: estimator_core::Count,
    /// Latest counts, newest last, for the definition.
    history: Vec<u32>,
}

impl<'a> Trial<'a> {
    fn new(tested: &'a TestedEstimator, seed: u64) -> Self {
        let course = Course::new(seed, tested.rate_hz);
        let first = course.shown();
        let mut pair = tested.pair();
        pair.start(&first);
        Self {
            tested,
            pair,
            found: Findings {
                estimator: tested.name.clone(),
                rate_hz: tested.rate_hz,
                start_deviation_rad_s: start_deviation(tested, seed),
                bounds: tested.bounds,
                ..Findings::default()
            },
            rad_per_count: tested.rad_per_count(),
            fastest: 0.0,
            extended: estimator_core::Count(first.large),
            history: vec![first.large],
            course,
        }
    }

    /// One stretch of motion.
    fn stretch(&mut self) {
        let hostile = self.course.move_on() == Stretch::Noise;
        while !self.course.is_over() {
            self.tick(hostile);
        }
    }

    /// Rest, until the outputs of both precisions are at rest.
    fn recover(&mut self) {
        self.course.rest();
        let (mut narrow_last, mut wide_last) = (0, 0);
        let mut tick = 0u32;
        let limit = 2_000_000;
        // The output must stay at rest for the same time again plus the length of a window.
        while tick < 2 * narrow_last.max(wide_last) + 130 && tick < limit {
            tick += 1;
            let (narrow, wide) = self.tick(false);
            let bound = self.tested.at_rest_rad_s;
            let at_rest = |velocity: f64| velocity.abs() * self.rad_per_count < bound;
            if !at_rest(f64::from(narrow)) {
                narrow_last = tick;
            }
            if !at_rest(wide) {
                wide_last = tick;
            }
        }
        if tick == limit {
            self.found
                .fault(|| format!("not at rest after {limit} ticks"));
        }
        self.found.recovery_ticks = self.found.recovery_ticks.max(narrow_last);
        self.found.twin_recovery_ticks = self.found.twin_recovery_ticks.max(wide_last);
        self.fastest = 0.0;
    }

    fn tick(&mut self, hostile: bool) -> (f32, f64) {
        let before = self.course.shown().large;
        let shown = self.course.step();
        let outputs = self.pair.update(&shown);
        self.found.ticks += 1;
        let step = shown.large.wrapping_sub(before) as i32;
        self.found.wraps += u64::from(before.checked_add_signed(step).is_none());
        self.compare(f64::from(step), outputs);
        if let Some(fault) = self.pair.fault() {
            let tick = self.found.ticks;
            self.found.fault(|| format!("tick {tick}: {fault}"));
        }
        self.follow(&shown, outputs.0, hostile);
        outputs
    }

    fn compare(&mut self, step: f64, (narrow, wide): (f32, f64)) {
        let tick = self.found.ticks;
        if !narrow.is_finite() {
            self.found.fault(|| format!("tick {tick}: {narrow}"));
            return;
        }
        self.fastest = self.fastest.max(step.abs()).max(wide.abs());
        let deviation = (f64::from(narrow) - wide).abs();
        if self.fastest * self.rad_per_count <= HAPTIC_RAD_S {
            let deviation = deviation * self.rad_per_count;
            self.found.deviation_rad_s = self.found.deviation_rad_s.max(deviation);
        }
        if self.fastest >= 1.0 {
            let relative = deviation / self.fastest;
            self.found.relative_deviation = self.found.relative_deviation.max(relative);
        }
    }

    /// Integers: the 16-bit counter, and the window by its definition.
    fn follow(&mut self, shown: &Shown, output: f32, hostile: bool) {
        let tick = self.found.ticks;
        if hostile {
            self.extended = estimator_core::Count(shown.large);
        } else {
            self.extended = self.extended.extended(shown.large as u16);
            if self.extended.0 != shown.large {
                let extended = self.extended.0;
                self.found
                    .fault(|| format!("tick {tick}: {extended} from 16 bits, not {}", shown.large));
            }
        }
        let Some(definition) = self.tested.definition else {
            return;
        };
        let last = self.history.last().copied().unwrap_or(shown.large);
        let step = shown.large.wrapping_sub(last) as i32;
        if step.unsigned_abs() > TOP_STEP.unsigned_abs() {
            // The displacement is out of range: the window restarts.
            self.history.clear();
            self.history.push(shown.large);
        } else {
            if self.history.len() == HISTORY {
                self.history.drain(..HISTORY - definition.n);
            }
            self.history.push(shown.large);
            if tick.is_multiple_of(DEFINITION_EVERY) {
                self.define(&definition, shown.large, output);
            }
        }
    }

    fn define(&mut self, definition: &Definition, shown: u32, output: f32) {
        let newest_first = self.history.iter().rev();
        let z: Vec<i32> = newest_first
            .skip(1)
            .take(definition.n)
            .map(|count| shown.wrapping_sub(*count) as i32)
            .collect();
        let (slope, window) = definition.slope(&z);
        let (exact, used) = (slope.rounded(), self.pair.window());
        self.found.windows_compared += 1;
        // The fraction goes through f64 on its way to f32: the last place may differ.
        let near = exact.next_down() <= output && output <= exact.next_up();
        if !near || used != Some(window) {
            let tick = self.found.ticks;
            self.found.fault(|| {
                format!("tick {tick}: {output} over {used:?}, by definition {exact} over {window}")
            });
        }
    }
}
