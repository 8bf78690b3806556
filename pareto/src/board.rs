//! The image on the emulated board, one job after the other.

use std::num::NonZeroU64;

use bench_image::mailbox::{WORDS, encode};
use bench_image::{SUBJECTS, Subject};
use estimator_core::Sample;
use rigless::emulator::{Driver, Hit, Host, Settled, Start, Stop, Watch, run};
use rigless::session::Session;
use rigless::soc::Width;
use rigless::time::VirtualNanos;
use virtual_board::board::{CORE_HZ, ControllerBoard};

use crate::image::Image;

/// A trace for a subject.
#[derive(Clone, Debug)]
pub struct Job<'a> {
    /// Index of the subject.
    pub subject: usize,
    /// At most [`bench_image::mailbox::SAMPLES`].
    pub samples: &'a [Sample],
}

/// What a job showed.
#[derive(Clone, Debug, Default)]
pub struct Ran {
    /// Instructions of each update, from its first to its return.
    pub instructions: Vec<u32>,
    /// Velocity of each update, counts a tick.
    pub velocities: Vec<f32>,
}

/// Where a subject's update begins, and where it comes back to.
struct Places {
    entry: u64,
    returns: Vec<u64>,
}

impl Places {
    fn of(image: &Image, subject: &Subject) -> Result<Self, String> {
        let path = |name| ["bench_image", "estimators", subject.module, name];
        let runner = image.function(&path("run"))?;
        Ok(Self {
            entry: image.function(&path("update"))?,
            returns: crate::thumb::after_indirect_calls(runner, image.code(runner)),
        })
    }

    fn watches(&self) -> impl Iterator<Item = Watch> {
        self.returns
            .iter()
            .chain([&self.entry])
            .map(|at| Watch::Instruction(*at))
    }
}

struct Bench {
    /// Jobs still to do, last first.
    jobs: Vec<(usize, Vec<[u32; WORDS]>)>,
    places: Vec<Places>,
    ready: u64,
    job: u64,
    trace: u64,
    velocities: u64,
    /// Subject, samples and counts of the job that runs.
    running: Option<(usize, usize, Ran)>,
    /// Instruction count at the update's entry.
    since: Option<u64>,
    done: Vec<Ran>,
    finished: bool,
    problem: Option<String>,
}

impl Bench {
    fn finish(&mut self, host: &mut dyn Host) -> Result<(), rigless::emulator::Error> {
        let Some((subject, samples, mut ran)) = self.running.take() else {
            return Ok(());
        };
        for watch in self.places[subject].watches() {
            host.unwatch(watch);
        }
        for k in 0..samples as u64 - 1 {
            let word = host.read(self.velocities + 4 * k, Width::W32)?;
            ran.velocities.push(f32::from_bits(word as u32));
        }
        self.done.push(ran);
        Ok(())
    }

    fn begin(&mut self, host: &mut dyn Host) -> Result<(), rigless::emulator::Error> {
        let Some((subject, words)) = self.jobs.pop() else {
            self.finished = true;
            return Ok(());
        };
        for (k, word) in words.as_flattened().iter().enumerate() {
            host.write(self.trace + 4 * k as u64, Width::W32, u64::from(*word))?;
        }
        host.write(self.job, Width::W32, subject as u64)?;
        host.write(self.job + 4, Width::W32, words.len() as u64)?;
        for watch in self.places[subject].watches() {
            host.watch(watch);
        }
        self.running = Some((subject, words.len(), Ran::default()));
        Ok(())
    }

    fn hit(&mut self, hit: &Hit, host: &mut dyn Host) -> Result<(), rigless::emulator::Error> {
        if hit.address == self.ready {
            self.finish(host)?;
            return self.begin(host);
        }
        let Some((subject, _, ran)) = &mut self.running else {
            return Ok(());
        };
        if hit.address == self.places[*subject].entry {
            self.since = Some(hit.instruction_count);
        } else if let Some(since) = self.since.take() {
            ran.instructions
                .push((hit.instruction_count - since) as u32);
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
        // Nothing happens at a stop but the question whether to go on.
        (!self.finished).then_some(VirtualNanos(stop.at.0 + 1_000_000))
    }
}

/// Runs the jobs on the image, in order.
///
/// # Errors
/// One line on an image that lacks something, or an emulator that gave up.
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
            .map(|job| (job.subject, job.samples.iter().map(encode).collect()))
            .collect(),
        places: places?,
        ready: image.function(&["bench_image", "ready"])?,
        job: mailbox("JOB")?,
        trace: mailbox("TRACE")?,
        velocities: mailbox("VELOCITIES")?,
        running: None,
        since: None,
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
