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
use virtual_board::pieces::{Path, Pieces};
use virtual_board::thumb;

use crate::image::{Image, subject_path};

/// A trace for a subject.
#[derive(Clone, Debug)]
pub struct Job<'a> {
    /// Index of the subject.
    pub subject: usize,
    /// At most [`bench_image::mailbox::SAMPLES`].
    pub samples: &'a [Sample],
    /// Number of updates at the end that are followed instruction by instruction, for cycles; slow.
    pub follow: usize,
}

/// Results of a job.
#[derive(Clone, Debug, Default)]
pub struct Ran {
    /// Instructions of each update, from its first to its return.
    pub instructions: Vec<u32>,
    /// Estimated cycles of each followed update.
    pub cycles: Vec<u32>,
    /// Velocity of each update, counts a tick.
    pub velocities: Vec<f32>,
}

/// Entry and return addresses of a subject's update.
struct Places {
    entry: u64,
    returns: Vec<u64>,
    /// What an update can reach.
    code: Pieces,
}

impl Places {
    fn of(image: &Image, subject: &Subject) -> Result<Self, String> {
        let runner = image.function(&subject_path(subject, "run"))?;
        Ok(Self::between(image, runner, image.update(subject)?))
    }

    /// `runner` calls `entry` through a pointer.
    fn between(image: &Image, runner: u64, entry: u64) -> Self {
        Self {
            entry,
            code: Pieces::reached(&image.code, entry, &[]),
            returns: thumb::after_indirect_calls(runner, image.code.function(runner)),
        }
    }

    /// Entry and returns.
    fn ends(&self) -> impl Iterator<Item = u64> {
        self.returns.iter().copied().chain([self.entry])
    }

    /// Every other start of a piece.
    fn inside(&self) -> impl Iterator<Item = u64> {
        let all = self.code.starts().iter().copied();
        all.filter(|at| *at != self.entry && !self.returns.contains(at))
    }
}

/// A job in the format of the board.
struct Order {
    subject: usize,
    /// Number of the first update that is followed.
    follow_from: usize,
    words: Vec<[u32; WORDS]>,
}

impl Order {
    fn new(job: &Job<'_>) -> Self {
        // The first sample starts the estimator.
        let updates = job.samples.len() - 1;
        Self {
            subject: job.subject,
            follow_from: updates - job.follow,
            words: job.samples.iter().map(encode).collect(),
        }
    }
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
    /// The update so far.
    path: Path,
    done: Vec<Ran>,
    finished: bool,
    problem: Option<String>,
}

impl Bench {
    fn finish(&mut self, host: &mut dyn Host) -> Result<(), rigless::emulator::Error> {
        let Some((order, mut ran)) = self.running.take() else {
            return Ok(());
        };
        let places = &self.places[order.subject];
        for at in places.ends().chain(places.inside()) {
            host.unwatch(Watch::Instruction(at));
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
        for at in self.places[order.subject].ends() {
            host.watch(Watch::Instruction(at));
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
            if ran.instructions.len() == order.follow_from {
                for at in places.inside() {
                    host.watch(Watch::Instruction(at));
                }
            }
            self.since = Some(hit.instruction_count);
            self.path = Path::default();
        }
        let Some(since) = self.since else {
            return Ok(());
        };
        self.path.reach(&places.code, hit.address);
        if places.returns.contains(&hit.address) {
            let instructions = (hit.instruction_count - since) as u32;
            if ran.instructions.len() >= order.follow_from {
                let seen = self.path.instructions();
                if seen != instructions {
                    let subject = SUBJECTS[order.subject];
                    self.problem = Some(format!(
                        "{subject}: {seen} of {instructions} instructions of an update were followed"
                    ));
                    self.finished = true;
                }
                ran.cycles.push(self.path.cycles());
            }
            ran.instructions.push(instructions);
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

/// The mailbox of an image, and the places of what it runs.
struct Program<'a> {
    image: &'a Image,
    places: Vec<Places>,
    ready: u64,
    job: u64,
    trace: u64,
    velocities: u64,
}

/// Runs the jobs on the image, in order.
///
/// # Errors
/// One line on an image with a missing symbol, or an error of the emulator.
pub fn on_board(image: &Image, jobs: &[Job<'_>]) -> Result<Vec<Ran>, String> {
    let mailbox = |name| image.datum(&["bench_image", "mailbox", name]);
    let places: Result<_, String> = SUBJECTS.iter().map(|one| Places::of(image, one)).collect();
    let program = Program {
        image,
        places: places?,
        ready: image.function(&["bench_image", "ready"])?,
        job: mailbox("JOB")?,
        trace: mailbox("TRACE")?,
        velocities: mailbox("VELOCITIES")?,
    };
    program.run(jobs)
}

/// As [`on_board`] for an image in C, whose subjects are functions `limpid_NAME_update`, called by
/// `run_NAME`; the index in a job is that of the name. Its mailbox has the names of Rust's in lower case.
///
/// # Errors
/// As [`on_board`].
pub fn on_board_in_c(
    image: &Image,
    names: &[String],
    jobs: &[Job<'_>],
) -> Result<Vec<Ran>, String> {
    let place = |name: &String| -> Result<Places, String> {
        let runner = image.symbol(&format!("run_{name}"))?;
        let entry = image.symbol(&format!("limpid_{name}_update"))?;
        Ok(Places::between(image, runner, entry))
    };
    let places: Result<_, String> = names.iter().map(place).collect();
    let program = Program {
        image,
        places: places?,
        ready: image.symbol("ready")?,
        job: image.symbol("job")?,
        trace: image.symbol("trace")?,
        velocities: image.symbol("velocities")?,
    };
    program.run(jobs)
}

impl Program<'_> {
    fn run(self, jobs: &[Job<'_>]) -> Result<Vec<Ran>, String> {
        let emulator = |error: &dyn std::fmt::Display| format!("emulator: {error}");
        let rate = NonZeroU64::new(CORE_HZ).expect("not zero");
        let board = ControllerBoard::new(8_000_000, rate).map_err(|error| emulator(&error))?;
        let mut session =
            Session::new(Box::new(board), 0, VirtualNanos(0)).map_err(|error| emulator(&error))?;
        let bench = Bench {
            jobs: jobs.iter().rev().map(Order::new).collect(),
            places: self.places,
            ready: self.ready,
            job: self.job,
            trace: self.trace,
            velocities: self.velocities,
            running: None,
            since: None,
            path: Path::default(),
            done: Vec::new(),
            finished: false,
            problem: None,
        };
        session.watch(Watch::Instruction(bench.ready));
        let images = [self.image.placed.clone()];
        let finished =
            run(session, &Start::new(&images), bench).map_err(|error| emulator(&error))?;
        match finished.driver.problem {
            Some(problem) => Err(emulator(&problem)),
            None => Ok(finished.driver.done),
        }
    }
}
