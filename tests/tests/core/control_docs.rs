//! Figures and names of haptic-control in docs/.

use estimator_core::Hertz;
use haptic_control::{DualStage, LoopPoles, Mode, RstDesign};
use measured::digits::rounded;
use measured::tables::VELOCITY_LOOP;

const BOARD: &str = include_str!("../../../docs/board.md");

#[test]
fn margins_of_the_velocity_loop_agree_with_the_table() {
    let row = |khz: f64| {
        let rate = Hertz(1e3 * khz);
        let design = RstDesign::new(&DualStage::DEFAULT, rate, LoopPoles::DEFAULT).unwrap();
        let margins = design.margins;
        let figures = [
            margins.modulus,
            margins.gain,
            margins.phase_deg(),
            1e3 * margins.delay_s,
            margins.crossover_hz,
        ];
        let figures = figures.map(|figure| rounded(figure, 6));
        [&[khz.to_string()], &figures[..]].concat()
    };
    let rows = [1.0, 10.0, 11.6, 20.0].map(row);
    let same = |_: &str, then: f64, now: f64| (then / now - 1.0).abs() < 0.02;
    let checked = VELOCITY_LOOP.check(&[], &rows, same);
    checked.unwrap_or_else(|error| panic!("{error}"));
}

#[test]
fn numbers_and_names_of_modes_agree_with_the_page() {
    let named: Vec<_> = (0..=4)
        .map(|code| format!("{code} {}", Mode::from_code(code).unwrap().as_str()))
        .collect();
    assert!(BOARD.contains(&format!("states are {}.", named.join(", "))));
}
