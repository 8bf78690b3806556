//! A recording as a source, with transport controls.

use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::Receiver;
use std::time::{Duration, Instant};

use catalogue::parameters::Parameters;
use channels::CHANNELS;
use experiments::replay::replay;
use experiments::uneven::{self, Chosen};
use recordings::arguments::{DeviceFile, RecordingOptions, Whole};
use recordings::log::Log;
use serde_json::{Value, json};
use simulation::device::Device;
use terminal::failure::Failure;
use terminal::output::note;

use super::Source;
use crate::batch::Batch;
use crate::desk::STATUS;
use crate::estimators::Estimators;
use crate::facts;
use crate::hub::{Event, Hub};
use crate::order::Order;

/// Interval in which rows are sent.
const STEP: Duration = Duration::from_millis(16);
/// Rows of a step at most: a long step at a high speed sends fewer, and takes longer.
const MOST: usize = 2000;

/// A recording with its estimates.
pub(crate) struct Recorded {
    name: String,
    device: Device,
    /// Rows as the page gets them: channels, then estimators.
    rows: Vec<Vec<f64>>,
}

impl Recorded {
    /// Reads a recording and runs the estimators on it.
    ///
    /// # Errors
    /// [`Failure::Input`] if it cannot be read.
    pub(crate) fn read(
        path: &Path,
        options: &RecordingOptions,
        file: &DeviceFile,
    ) -> Result<Self, Failure> {
        let log = Log::open(path)?;
        let name = log.name().to_owned();
        let Whole {
            recording,
            device,
            stated,
        } = options.whole(&log, file)?;
        stated.iter().chain(&recording.notes).for_each(note);
        let kinds = Estimators::kinds();
        // Those that are not made for its clock are left out, as by cargo sim replay.
        let parameters = Parameters::default();
        let clock = uneven::Recorded::new(&name, &recording, &device, &parameters);
        let chosen = Chosen::new(&kinds, false, &clock)?;
        chosen.notes(&clock).iter().for_each(note);
        let replayed = replay(
            &recording,
            &name,
            &chosen.kinds,
            &device,
            &parameters,
            &|| (),
        )?;
        let mut rows = channels::rows(&recording, &device, &replayed.estimates);
        // An estimator that is left out has a channel without values.
        for (k, kind) in kinds.iter().enumerate() {
            let is_there = replayed
                .estimates
                .iter()
                .any(|it| it.estimator == kind.name);
            if !is_there {
                rows.iter_mut()
                    .for_each(|row| row.insert(CHANNELS.len() + k, f64::NAN));
            }
        }
        Ok(Self { rows, name, device })
    }
}

impl Source for Recorded {
    fn facts(&self) -> Value {
        let mut all = facts::of_device(&self.device);
        let last = self.rows.len() - 1;
        all["source"] = json!({
            "kind": "recorded",
            "title": "recording",
            "text": "A recording. The force is that of the torque wanted.",
            "from": self.name,
            "begin": self.rows[0][0],
            "end": self.rows[last][0],
            "gap": gap(&self.rows),
        });
        all
    }

    fn run(self: Box<Self>, hub: Arc<Hub>, orders: Receiver<Order>) -> Result<(), Failure> {
        let mut playback = Playback::new(self.rows, Instant::now());
        while !hub.stops() {
            playback.step(&hub, &orders, Instant::now());
            std::thread::sleep(STEP);
        }
        Ok(())
    }
}

/// A recording that is played for the pages of a hub.
struct Playback {
    rows: Vec<Vec<f64>>,
    player: Player,
    was_seen: bool,
    /// The step before.
    last: Instant,
    /// The status before.
    told: Instant,
}

impl Playback {
    fn new(rows: Vec<Vec<f64>>, now: Instant) -> Self {
        let player = Player {
            next: 0,
            at: rows[0][0],
            plays: false,
            speed: 1.0,
            batch: Batch::new(),
        };
        Self {
            rows,
            player,
            was_seen: false,
            last: now,
            told: now,
        }
    }

    /// Follows the orders, and plays what is due.
    fn step(&mut self, hub: &Hub, orders: &Receiver<Order>, now: Instant) {
        let Self { rows, player, .. } = self;
        // The playback begins with the first page, and again with the first one after the others have gone.
        if self.was_seen != hub.is_seen() {
            self.was_seen = !self.was_seen;
            if self.was_seen {
                player.seek(rows[0][0], rows);
            }
            player.plays = self.was_seen;
            self.last = now;
        }
        while let Ok(order) = orders.try_recv() {
            player.order(&order, rows);
        }
        player.advance((now - self.last).as_secs_f64(), rows);
        self.last = now;
        if let Some(bytes) = player.batch.due() {
            hub.tell(Event::Rows(bytes));
        }
        if now - self.told >= STATUS {
            self.told = now;
            hub.status(json!({
                "t": player.at,
                "plays": player.plays,
                "speed": player.speed,
            }));
        }
    }
}

/// Time between two rows from which on some between them are missing, s: more than twice the step that few steps
/// exceed, so that an uneven clock has no gaps.
fn gap(rows: &[Vec<f64>]) -> f64 {
    let mut steps: Vec<f64> = rows
        .windows(2)
        .map(|pair| pair[1][0] - pair[0][0])
        .collect();
    steps.sort_unstable_by(f64::total_cmp);
    let usual = steps.get(steps.len() * 9 / 10).copied();
    2.5 * usual.unwrap_or_default()
}

/// The position in a recording.
struct Player {
    /// The next row.
    next: usize,
    /// Time of the recording, s.
    at: f64,
    plays: bool,
    speed: f64,
    batch: Batch,
}

impl Player {
    fn order(&mut self, order: &Order, rows: &[Vec<f64>]) {
        match *order {
            Order::Play { on } => {
                if on && self.next == rows.len() {
                    self.seek(rows[0][0], rows);
                }
                self.plays = on;
            }
            Order::Seek { to } => self.seek(to, rows),
            Order::Speed { factor } => self.speed = factor,
            _ => {}
        }
    }

    fn seek(&mut self, to: f64, rows: &[Vec<f64>]) {
        self.next = rows.partition_point(|row| row[0] < to);
        self.at = to.clamp(rows[0][0], rows[rows.len() - 1][0]);
        self.batch.cut();
        // A row, so that a paused page shows the place.
        if let Some(row) = rows.get(self.next) {
            self.batch.add(row);
            self.next += 1;
        }
    }

    fn advance(&mut self, seconds: f64, rows: &[Vec<f64>]) {
        if !self.plays {
            return;
        }
        self.at += seconds * self.speed;
        let due = rows[self.next..]
            .iter()
            .take_while(|row| row[0] <= self.at)
            .take(MOST);
        let mut number = 0;
        for row in due {
            self.batch.add(row);
            number += 1;
        }
        self.next += number;
        if number == MOST {
            self.at = rows[self.next - 1][0];
        }
        if self.next == rows.len() {
            self.at = rows[rows.len() - 1][0];
            self.plays = false;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn log_of_an_uneven_clock_has_a_channel_without_values_for_what_needs_an_even_one() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/data/logs/uneven.csv");
        let (options, file) = (RecordingOptions::default(), DeviceFile::default());
        let recorded = Recorded::read(Path::new(path), &options, &file).expect("a recording");
        let names = Estimators::names();
        let at = |name: &str| CHANNELS.len() + names.iter().position(|it| *it == name).unwrap();
        let [even, any] = ["foaw-best-fit", "finite-difference"].map(at);
        assert!(recorded.rows.len() > 2);
        for row in &recorded.rows {
            assert_eq!(row.len(), CHANNELS.len() + names.len());
            assert!(row[even].is_nan() && row[any].is_finite());
        }
    }

    /// At less than 100 rows a second, as `cargo sim replay` reads it.
    #[test]
    fn recording_of_a_low_rate_has_the_estimators_that_are_made_for_it() {
        let file = std::env::temp_dir().join(format!("scope-slow-{}.csv", std::process::id()));
        let rows = (0..200).map(|k| format!("{},{}\n", f64::from(k) * 0.02, 7 * k));
        let text = format!("t,counts_large\n{}", rows.collect::<String>());
        std::fs::write(&file, text).expect("a file");
        let (options, device) = (RecordingOptions::default(), DeviceFile::default());
        let recorded = Recorded::read(&file, &options, &device);
        std::fs::remove_file(&file).expect("a file");
        let recorded = recorded.expect("a recording");
        let names = Estimators::names();
        let values = |k: usize| recorded.rows.iter().map(move |row| row[CHANNELS.len() + k]);
        let made = (0..names.len())
            .filter(|k| values(*k).all(f64::is_finite))
            .count();
        let left_out = (0..names.len())
            .filter(|k| values(*k).all(f64::is_nan))
            .count();
        assert!(
            made > 0 && left_out > 0 && made + left_out == names.len(),
            "{made} {left_out}"
        );
    }

    #[test]
    fn missing_rows_are_a_gap_and_an_uneven_clock_is_none() {
        let rows = |times: &[f64]| -> Vec<Vec<f64>> { times.iter().map(|t| vec![*t]).collect() };
        let mut times: Vec<f64> = (0..100).map(|k| f64::from(k) * 0.01).collect();
        times.extend([2.0, 2.01]);
        let even = gap(&rows(&times));
        assert!((0.02..0.03).contains(&even), "{even}");
        let times: Vec<f64> = (0..100).map(|k| f64::from(k * k % 7 + 10 * k)).collect();
        let steps = times.windows(2).map(|pair| pair[1] - pair[0]);
        let uneven = gap(&rows(&times));
        assert!(steps.fold(0.0, f64::max) < uneven, "{uneven}");
        assert_eq!(gap(&rows(&[1.0, 2.0])), 2.5);
    }

    /// A recording on which a source has waited for some time without a page.
    #[test]
    fn playback_begins_with_the_first_page() {
        let rows: Vec<Vec<f64>> = (0..100).map(|k| vec![f64::from(k) * 0.01]).collect();
        let (hub, orders) = Hub::new("token".to_owned(), Value::Null);
        let (mut now, second) = (Instant::now(), Duration::from_secs(1));
        let mut playback = Playback::new(rows, now);
        let mut step = |after: Duration| {
            now += after;
            playback.step(&hub, &orders, now);
            (playback.player.next, playback.player.plays)
        };
        assert_eq!(step(100 * second), (0, false));
        for _ in 0..2 {
            let page = hub.enter();
            assert_eq!(step(100 * second), (1, true), "the row at the begin");
            assert_eq!(step(second / 4), (26, true), "a row each 10 ms");
            hub.leave(page);
            assert_eq!(step(100 * second), (26, false));
        }
    }

    /// At a high speed a step would have more rows than a page can take.
    #[test]
    fn time_of_a_step_with_too_many_rows_is_that_of_its_last_row() {
        let rows: Vec<Vec<f64>> = (0..5000).map(|k| vec![f64::from(k)]).collect();
        let mut player = Player {
            next: 0,
            at: 0.0,
            plays: true,
            speed: 100.0,
            batch: Batch::new(),
        };
        player.advance(40.0, &rows);
        assert_eq!((player.next, player.at), (2000, 1999.0));
        assert!(player.plays);
    }

    #[test]
    fn player_seeks_pauses_and_ends() {
        let rows: Vec<Vec<f64>> = (0..100).map(|k| vec![f64::from(k) * 0.01]).collect();
        let mut player = Player {
            next: 0,
            at: 0.0,
            plays: true,
            speed: 2.0,
            batch: Batch::new(),
        };
        player.advance(0.1, &rows);
        assert_eq!(player.next, 21);
        player.order(&Order::Play { on: false }, &rows);
        player.advance(1.0, &rows);
        assert_eq!(player.next, 21);
        player.order(&Order::Seek { to: 0.5 }, &rows);
        assert_eq!((player.next, player.at), (51, 0.5));
        player.order(&Order::Play { on: true }, &rows);
        player.advance(10.0, &rows);
        assert!(player.next == 100 && !player.plays);
        player.order(&Order::Play { on: true }, &rows);
        assert!(player.next == 1 && player.plays);
    }
}
