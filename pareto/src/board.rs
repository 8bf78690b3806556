//! The image on the emulated board, one job after the other.

use std::collections::BTreeMap;
use std::num::NonZeroU64;

use bench_image::mailbox::{WORDS, encode};
use bench_image::{SUBJECTS, Subject};
use estimator_core::Sample;
use rigless::emulator::{Driver, Hit, Host, Settled, Start, Stop, Watch, run};
use rigless::session::Session;
use rigless::soc::Width;
use rigless::time::VirtualNanos;
use virtual_board::board::{CORE_HZ, ControllerBoard};
use virtual_board::{cycles, thumb};

use crate::image::{Image, subject_path};

/// A trace for a subject.
#[derive(Clone, Debug)]
pub struct Job<'a> {
    /// Index of the subject.
    pub subject: usize,
    /// At most [`bench_image::mailbox::SAMPLES`].
    pub samples: &'a [Sample],
    /// Whether to follow every instruction, for cycles; slow.
    pub follow: bool,
}

/// Results of a job.
#[derive(Clone, Debug, Default)]
pub struct Ran {
    /// Instructions of each update, from its first to its return.
    pub instructions: Vec<u32>,
    /// Estimated cycles of each update, if they were followed.
    pub cycles: Vec<u32>,
    /// Velocity of each update, counts a tick.
    pub velocities: Vec<f32>,
}

/// Entry and return addresses of a subject's update.
struct Places {
    entry: u64,
    returns: Vec<u64>,
    /// First halves of every instruction that an update can reach, by address.
    instructions: BTreeMap<u64, [u16; 2]>,
}

impl Places {
    fn of(image: &Image, subject: &Subject) -> Result<Self, String> {
        let runner = image.function(&subject_path(subject, "run"))?;
        let entry = image.update(subject)?;
        Ok(Self {
            entry,
            instructions: image.code.instructions(entry),
            returns: thumb::after_indirect_calls(runner, image.code.function(runner)),
        })
    }

    fn watches(&self, follow: bool) -> impl Iterator<Item = Watch> {
        let followed = self.instructions.keys().filter(move |_| follow);
        let places = self.returns.iter().chain([&self.entry]);
        places.chain(followed).map(|at| Watch::Instruction(*at))
    }
}

/// A job in the format of the board.
struct Order {
    subject: usize,
    follow: bool,
    words: Vec<[u32; WORDS]>,
}

struct Bench {
    /// Jobs still to do, last first.
    jobs: Vec<Order>,
    places: Vec<Places>,
    ready: u64,
    job: u64,
    trace: u64,
    velocities: u64,
    /// The running job, and its results so far.
    running: Option<(Order, Ran)>,
    /// Instruction count at the update's entry.
    since: Option<u64>,
    /// Cycles of the update so far, and the instruction that comes next.
    cycles: u32,
    at: Option<u64>,
    done: Vec<Ran>,
    finished: bool,
    problem: Option<String>,
}

impl Bench {
    fn finish(&mut self, host: &mut dyn Host) -> Result<(), rigless::emulator::Error> {
        let Some((order, mut ran)) = self.running.take() else {
            return Ok(());
        };
        for watch in self.places[order.subject].watches(order.follow) {
            host.unwatch(watch);
        }
        for k in 0..order.words.len() as u64 - 1 {
            let word = host.read(self.velocities + 4 * k, Width::W32)?;
            ran.velocities.push(f32::from_bits(word as u32));
        }
        self.done.push(ran);
        Ok(())
    }

    fn begin(&mut self, host: &mut dyn Host) -> Result<(), rigless::emulator::Error> {
        let Some(order) = self.jobs.pop() else {
            self.finished = true;
            return Ok(());
        };
        for (k, word) in order.words.as_flattened().iter().enumerate() {
            host.write(self.trace + 4 * k as u64, Width::W32, u64::from(*word))?;
        }
        host.write(self.job, Width::W32, order.subject as u64)?;
        host.write(self.job + 4, Width::W32, order.words.len() as u64)?;
        for watch in self.places[order.subject].watches(order.follow) {
            host.watch(watch);
        }
        self.running = Some((order, Ran::default()));
        Ok(())
    }

    fn hit(&mut self, hit: &Hit, host: &mut dyn Host) -> Result<(), rigless::emulator::Error> {
        if hit.address == self.ready {
            self.finish(host)?;
            return self.begin(host);
        }
        let Some((order, ran)) = &mut self.running else {
            return Ok(());
        };
        let places = &self.places[order.subject];
        if hit.address == places.entry {
            self.since = Some(hit.instruction_count);
            self.cycles = 0;
            self.at = None;
        }
        let Some(since) = self.since else {
            return Ok(());
        };
        if let Some(at) = self.at.replace(hit.address)
            && let Some([first, second]) = places.instructions.get(&at)
        {
            let next = at + if thumb::is_wide(*first) { 4 } else { 2 };
            self.cycles += cycles::of(*first, *second, hit.address != next);
        }
        if places.returns.contains(&hit.address) {
            ran.instructions
                .push((hit.instruction_count - since) as u32);
            if order.follow {
                ran.cycles.push(self.cycles);
            }
            self.since = None;
            // The other calls of the loop are ignored.
            for other in places.returns.iter().filter(|other| **other != hit.address) {
                host.unwatch(Watch::Instruction(*other));
            }
        }
        Ok(())
    }
}

impl Driver<ControllerBoard> for Bench {
    fn on_settled(
        &mut self,
        _: &mut Session<ControllerBoard>,
        host: &mut dyn Host,
        settled: Settled,
    ) {
        if let Settled::Hit(hit) = settled
            && let Err(error) = self.hit(&hit, host)
        {
            self.problem = Some(error.to_string());
            self.finished = true;
        }
    }

    fn on_stop(
        &mut self,
        _: &mut Session<ControllerBoard>,
        stop: Stop,
        _: &mut dyn Host,
    ) -> Option<VirtualNanos> {
        // A stop only decides whether the run continues.
        (!self.finished).then_some(VirtualNanos(stop.at.0 + 1_000_000))
    }
}

/// Runs the jobs on the image, in order.
///
/// # Errors
/// One line on an image with a missing symbol, or an error of the emulator.
pub fn on_board(image: &Image, jobs: &[Job<'_>]) -> Result<Vec<Ran>, String> {
    let emulator = |error: &dyn std::fmt::Display| format!("emulator: {error}");
    let rate = NonZeroU64::new(CORE_HZ).expect("not zero");
    let board = ControllerBoard::new(8_000_000, rate).map_err(|error| emulator(&error))?;
    let mut session =
        Session::new(Box::new(board), 0, VirtualNanos(0)).map_err(|error| emulator(&error))?;
    let mailbox = |name| image.datum(&["bench_image", "mailbox", name]);
    let places: Result<_, String> = SUBJECTS.iter().map(|one| Places::of(image, one)).collect();
    let bench = Bench {
        jobs: jobs
            .iter()
            .rev()
            .map(|job| Order {
                subject: job.subject,
                follow: job.follow,
                words: job.samples.iter().map(encode).collect(),
            })
            .collect(),
        places: places?,
        ready: image.function(&["bench_image", "ready"])?,
        job: mailbox("JOB")?,
        trace: mailbox("TRACE")?,
        velocities: mailbox("VELOCITIES")?,
        running: None,
        since: None,
        cycles: 0,
        at: None,
        done: Vec::new(),
        finished: false,
        problem: None,
    };
    session.watch(Watch::Instruction(bench.ready));
    let images = [image.placed.clone()];
    let finished = run(session, &Start::new(&images), bench).map_err(|error| emulator(&error))?;
    match finished.driver.problem {
        Some(problem) => Err(emulator(&problem)),
        None => Ok(finished.driver.done),
    }
}
