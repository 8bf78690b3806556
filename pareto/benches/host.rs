//! Time on the host: `cargo bench --package pareto`.
//!
//! Times vary with the machine and its load: only ratios of one run say something.
#![allow(missing_docs, reason = "a program")]

use std::sync::OnceLock;

use bench_image::{SUBJECTS, Subject};
use divan::counter::ItemsCount;
use divan::{Bencher, black_box, black_box_drop};
use estimator_core::Sample;
use haptic_control::SceneKind;
use pareto::traces::{self, BenchTrace};
use simulation::device::Device;
use simulation::scenario::ScenarioName;
use simulation::simulate::simulate;
use simulation::trace::Columns;
use virtual_board::image::Image;
use virtual_board::run::{Setup, on_board};

fn main() {
    divan::main();
}

/// What chirps and reverses.
fn track(rate_hz: u32) -> &'static [Sample] {
    static TRACES: OnceLock<Vec<BenchTrace>> = OnceLock::new();
    let traces = TRACES.get_or_init(|| traces::all().expect("traces"));
    let mut fitting = traces.iter().filter(|trace| trace.rate_hz == rate_hz);
    let track = fitting.find(|trace| trace.name == "chirp and reversals");
    &track.expect("a trace").samples
}

/// Subjects at 10 kHz, and of every rate.
fn subjects() -> impl Iterator<Item = String> {
    let fast = SUBJECTS.iter().filter(|subject| subject.rate_hz != 1000);
    fast.map(Subject::to_string)
}

/// One update of each estimator and peer, through the calls of the bench image.
#[divan::bench(args = subjects())]
fn update(bencher: Bencher<'_, '_>, name: &str) {
    let find = |subject: &&Subject| subject.rate_hz != 1000 && subject.to_string() == name;
    let subject = SUBJECTS.iter().find(find).expect("a subject");
    let samples = track(10_000);
    bencher
        .counter(ItemsCount::new(samples.len() - 1))
        .bench_local(|| {
            (subject.run)(&mut samples.iter().copied(), &mut |velocity| {
                black_box_drop(velocity);
            });
        });
}

/// Ticks of the host simulation: plant, encoder and the steady motor filter.
#[divan::bench(args = [1000, 10_000])]
fn host_sim(bencher: Bencher<'_, '_>, rate_hz: u32) {
    let device = Device::default();
    let rate = f64::from(rate_hz);
    let kind = catalogue::estimators::Kind::named("kalman-motor-steady").expect("an estimator");
    let setup = catalogue::estimators::Setup::of(&device, rate);
    let estimator = kind.build(&setup, &vec![0.1, 0.0]).expect("a filter");
    bencher.counter(ItemsCount::new(rate_hz)).bench_local(|| {
        let columns = Columns::default();
        let trace = simulate(&device, ScenarioName::Track, rate, 1, 1.0, columns);
        estimator.run(black_box(&trace.expect("a trace")))
    });
}

/// A second of the virtual board: the flash image in closed loop, 10 000 ticks.
#[divan::bench(sample_count = 5, sample_size = 1)]
fn virtual_board(bencher: Bencher<'_, '_>) {
    let image = Image::build("").expect("the firmware builds");
    let scene = SceneKind::FreeAir;
    bencher
        .counter(ItemsCount::new(10_000_u32))
        .bench_local(|| on_board(&image, &Setup::playing(scene, 1.0), |_| ()).expect("a run"));
}
