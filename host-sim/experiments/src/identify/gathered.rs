//! Everything that the recordings tell together: the equations of the shafts, and what limits them.

use std::f64::consts::TAU;

use super::equations::{Equations, SLIP, Shaft, TURNS, half_window};
use super::fit::{Equation, Fit};
use super::motion::Motion;
use super::{MOST_UNEXPLAINED, breaks, handle, quantity};
use recordings::recording::{Recording, implausible_current};
use simulation::device::Device;
use terminal::failure::Failure;

/// Share of the motor's torque from which a model that lacks it tells nothing.
const REFUSED_UNEXPLAINED: f64 = 0.30;
/// Share from which a number of it says nothing: the current is not what turns the shaft.
const UNRELATED: f64 = 10.0;
/// Largest relative spread of a velocity that is constant.
const CONSTANT_SPREAD: f64 = 0.05;
/// Mean number of uneven steps per window from which the error of too few windows names the clock.
const UNEVEN_WINDOWS: f64 = 0.5;
/// Slowest rate at which a row is assumed to be a control tick, Hz; below it the lag is rejected.
const LAG_RATE_HZ: f64 = 5000.0;

/// Longest lag of the torque, relative to half a window: beyond it the series in powers of the lag is cut off too
/// early, and every value is biased by more than its interval.
const LONGEST_LAG: f64 = 0.09;

/// The equations of all recordings, and properties of the recordings for messages.
#[derive(Default)]
pub(super) struct Gathered {
    pub(super) large: Equations,
    /// Equations of a free handle.
    pub(super) free: Vec<Equation>,
    /// Reasons for which recordings do not identify the handle.
    pub(super) without_handle: Vec<String>,
    /// The longest travel of each shaft, rad.
    pub(super) travel: [f64; 2],
    pub(super) largest_current: f64,
    /// The part of `--column` that names the current of the first recording.
    current_option: Option<String>,
    slowest_hz: Option<f64>,
    /// The shortest and the longest window, s.
    windows_s: Option<[f64; 2]>,
    /// The smallest and largest velocity of a window, rad/s.
    velocities: Option<[f64; 2]>,
    /// Whether a recording has no counts of the handle.
    pub(super) unseen: bool,
    /// Description of the first clock that leaves too few windows without uneven steps.
    uneven: Option<String>,
}

impl Gathered {
    /// Adds a recording; `place` is its index and the number of recordings, and `current_option` the part
    /// of `--column` that names its current.
    pub(super) fn add(
        &mut self,
        name: &str,
        recording: &Recording,
        place: (usize, usize),
        current_option: Option<&str>,
        device: &Device,
    ) -> Result<(), Failure> {
        let trace = &recording.trace;
        let period_s = trace.period_s();
        let Some(current) = &trace.current else {
            let remedy = match current_option {
                Some(option) => format!("name it, for example --column '{option}'"),
                None => "record scene excite with the large motor's current".to_owned(),
            };
            return Err(Failure::Input(format!(
                "{name}: line 1: no column current; torques cannot be identified from counts alone: {remedy}"
            )));
        };
        let motion = |counts: &[u32], counts_per_rev| Motion::new(counts, counts_per_rev, period_s);
        let own = motion(&trace.counts_large, device.stages.large.counts_per_rev);
        let handle = trace.counts_small.as_ref();
        let handle = handle.map(|counts| motion(counts, device.stages.small.counts_per_rev));
        let breaks = breaks(&recording.t, period_s);
        let window_s = 2.0 * half_window(period_s) as f64 * period_s;
        let [shortest, longest] = self.windows_s.unwrap_or([window_s; 2]);
        self.windows_s = Some([shortest.min(window_s), longest.max(window_s)]);
        if recording.uneven_share() * window_s > UNEVEN_WINDOWS * period_s {
            self.uneven = self.uneven.take().or_else(|| recording.unevenness());
        }
        let shaft = Shaft {
            period_s,
            own: &own,
            other: handle.as_ref(),
            current,
            ripple_per_rev: device.large_ripple.per_rev,
            breaks: &breaks,
            hand: false,
        };
        self.large.add(&shaft, place.0, place.1);
        self.velocities = own.velocities(window_s, period_s, self.velocities);
        self.travel[0] = self.travel[0].max(own.travel());
        if let (Some(option), None) = (current_option, &self.current_option) {
            self.current_option = Some(option.to_owned());
        }
        let largest = current.iter().fold(0.0_f64, |m, i| m.max(i.abs()));
        self.largest_current = self.largest_current.max(largest);
        let slowest = self.slowest_hz.unwrap_or(trace.rate_hz);
        self.slowest_hz = Some(slowest.min(trace.rate_hz));
        let Some(handle) = &handle else {
            self.unseen = true;
            return Ok(());
        };
        let free = match &recording.current_small {
            None => Err("no column current_small"),
            Some(current) => {
                let mut small = Equations::default();
                let shaft = Shaft {
                    own: handle,
                    other: Some(&own),
                    current,
                    ripple_per_rev: device.small_ripple.per_rev,
                    hand: true,
                    ..shaft
                };
                small.add(&shaft, place.0, place.1);
                handle::free(small)
            }
        };
        match free {
            Ok(equations) => {
                self.free.extend(equations);
                self.travel[1] = self.travel[1].max(handle.travel());
            }
            Err(why) => {
                self.without_handle
                    .push(format!("{name}: the handle is not identified: {why}"));
            }
        }
        Ok(())
    }

    /// The length of a window for a message; of several recordings the longest.
    fn window_text(&self) -> String {
        format!(
            "{:.0} ms",
            1e3 * self.windows_s.map_or(0.0, |[_, longest]| longest)
        )
    }

    /// Fits the large shaft's equation.
    ///
    /// # Errors
    /// One line on currents, windows, or a model that does not fit.
    pub(super) fn fit(&self, device: &Device) -> Result<Fit, String> {
        if self.largest_current == 0.0 {
            return Err("column current is zero throughout; record scene excite".to_owned());
        }
        let limit = device.stages.large.current_limit;
        let option = || self.current_option.clone();
        if let Some(why) = implausible_current(self.largest_current, limit, option) {
            return Err(why);
        }
        if self.travel[0] == 0.0 {
            return Err(
                "the large motor does not move; check that the current is larger than its friction, and that its \
                 encoder counts"
                    .to_owned(),
            );
        }
        let Some(fit) = Fit::new(&self.large.usable) else {
            return Err(match &self.uneven {
                Some(uneven) => format!(
                    "{uneven}; only {} of {} windows of {} have even steps and turn one way; if only \
                     column t is uneven, give --row-rate HZ, else --resample HZ",
                    self.large.usable.len(),
                    self.large.windows,
                    self.window_text()
                ),
                None => format!(
                    "the large motor turns one way throughout only {} of {} windows of {}; record \
                     the whole scene excite, with the handle held",
                    self.large.usable.len(),
                    self.large.windows,
                    self.window_text()
                ),
            });
        };
        if let Some([low, high]) = self.velocities
            && high - low < CONSTANT_SPREAD * low.abs().max(high.abs())
        {
            return Err(format!(
                "no constant is identified: the velocity is constant, {low:.4} to {high:.4} rad/s, and the \
                 inertia shows in accelerations alone; record motion that speeds up and slows down"
            ));
        }
        let unexplained = fit.unexplained / fit.driven;
        let drive = fit.estimate(|ratios, _| ratios[0]);
        let backward = drive.value < -drive.half;
        if unexplained < MOST_UNEXPLAINED && backward {
            return Err(
                "positive current turns the large motor backward; swap two phases of the motor or \
                 the phases of its encoder, or record without a hand against which the motor works"
                    .to_owned(),
            );
        }
        if !backward && let Some(why) = self.handle_is_reversed() {
            return Err(why);
        }
        if unexplained.is_nan() || unexplained >= UNRELATED {
            return Err(
                "the motion does not follow column current: no lag and no torque constant explain it; check that \
                 column current is that of the large motor and in A, and that the motor turns the shaft, not a hand"
                    .to_owned(),
            );
        }
        if unexplained >= REFUSED_UNEXPLAINED || backward {
            return Err(format!(
                "the model leaves {:.0} % of the motor's torque unexplained (limit {:.0} %){}; check that \
                 column current is in A, that large.counts_per_rev = {} is correct, and that {}",
                100.0 * unexplained,
                100.0 * REFUSED_UNEXPLAINED,
                match backward {
                    true => ", and the shaft turns against the current",
                    false => "",
                },
                device.stages.large.counts_per_rev,
                match self.unseen {
                    true => "no hand or contact touched the shaft, and the handle was clamped",
                    false => "nothing else touched the shafts",
                }
            ));
        }
        if let Some(half_s) = self.windows_s.map(|[shortest, _]| 0.5 * shortest)
            && fit.lag_s > LONGEST_LAG * half_s
        {
            let longest_s = LONGEST_LAG * half_s;
            return Err(format!(
                "no constant is identified: the torque follows the current {:.1} ms late, and a delay above \
                 {:.1} ms (an amplifier below {:.0} Hz) biases every value in windows of {:.0} ms; record the \
                 measured current as column current_measured, or make the current loop faster",
                1e3 * fit.lag_s,
                1e3 * longest_s,
                1.0 / (TAU * longest_s),
                2e3 * half_s
            ));
        }
        Ok(fit)
    }

    /// What is wrong if the coupler's torque follows the motion of the handle with the wrong sign. The share of that
    /// motion which the slip has too much is 0, and 2 if the handle's encoder counts in the other direction.
    fn handle_is_reversed(&self) -> Option<String> {
        let mut equations = self.large.usable.clone();
        for equation in &mut equations {
            equation.others.push(equation.other_moved);
        }
        let column = equations.first()?.others.len();
        let fit = Fit::new(&equations)?;
        let share = fit.estimate(|ratios, _| ratios[column] / ratios[SLIP]);
        (share.value - share.half > 1.0).then(|| {
            "column counts_small counts against column counts_large: the torque of the coupler follows the sum of \
             both speeds, not their difference; negate column counts_small, or exchange A and B of the handle's \
             encoder"
                .to_owned()
        })
    }

    /// Reason for which no value of the fit is identified, if a torque acts that is not in the model.
    pub(super) fn doubts(&self, fit: &Fit) -> Option<String> {
        let unexplained = fit.unexplained / fit.driven;
        (unexplained >= MOST_UNEXPLAINED).then(|| {
            format!(
                "{:.0} % of the motor's torque is unexplained (limit {:.0} %), and a torque that depends on \
                 the motor's, as that of a hand, would bias the value; record with nothing that touches \
                 the shaft",
                100.0 * unexplained,
                100.0 * MOST_UNEXPLAINED
            )
        })
    }

    /// The only direction of motion, if one is too rare to separate friction from a constant torque.
    pub(super) fn turns_one_way(&self) -> Option<f64> {
        let usable = self.large.usable.len();
        let rarer_way = self.large.forward.min(usable - self.large.forward);
        let forward = 2 * self.large.forward > usable;
        (20 * rarer_way < usable).then(|| if forward { 1.0 } else { -1.0 })
    }

    /// Reason for which the recordings cannot identify this key, whatever its interval.
    pub(super) fn rejects(&self, key: &str) -> Option<String> {
        match (key, self.slowest_hz) {
            (quantity::BANDWIDTH, Some(rate_hz)) if rate_hz < LAG_RATE_HZ => Some(format!(
                "rows {} ms apart may be frames of a faster control loop; record every control tick",
                1000.0 / rate_hz
            )),
            (quantity::FRICTION, _) if self.turns_one_way().is_some() => Some(
                "the large motor turns one way only, so friction and a constant torque cannot be told \
                 apart; record both directions"
                    .to_owned(),
            ),
            (quantity::FRICTION, _) if self.travel[0] < TURNS => {
                Some("friction varies over a turn; record at least three turns".to_owned())
            }
            _ => None,
        }
    }
}
