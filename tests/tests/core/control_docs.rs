//! Figures and names of haptic-control in docs/.

use estimator_core::Hertz;
use haptic_control::{DualStage, LoopPoles, Mode, RstDesign};

const VELOCITY_LOOP: &str = include_str!("../../../docs/theory/velocity-loop.md");
const BOARD: &str = include_str!("../../../docs/board.md");

#[test]
fn margins_of_the_velocity_loop_are_those_of_the_table() {
    let rows: Vec<Vec<f64>> = VELOCITY_LOOP
        .lines()
        .skip_while(|line| !line.starts_with("| rate, kHz |"))
        .skip(2)
        .take_while(|line| line.starts_with('|'))
        .map(|line| {
            line.trim_matches('|')
                .split('|')
                .map(|c| c.trim().parse().unwrap())
                .collect()
        })
        .collect();
    assert_eq!(rows.len(), 4);
    for row in rows {
        let rate = Hertz(1e3 * row[0]);
        let design = RstDesign::new(&DualStage::DEFAULT, rate, LoopPoles::DEFAULT).unwrap();
        let m = design.margins;
        let computed = [
            m.modulus,
            m.gain,
            m.phase_deg(),
            1e3 * m.delay_s,
            m.crossover_hz,
        ];
        for (written, computed) in row[1..].iter().zip(computed) {
            assert!(
                (written / computed - 1.0).abs() < 0.02,
                "{row:?}: {computed}"
            );
        }
    }
}

#[test]
fn modes_have_the_numbers_and_names_of_the_board_page() {
    let named: Vec<_> = (0..=4)
        .map(|code| format!("{code} {}", Mode::from_code(code).unwrap().as_str()))
        .collect();
    assert!(BOARD.contains(&format!("states are {}.", named.join(", "))));
}
