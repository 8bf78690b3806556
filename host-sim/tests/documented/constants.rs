//! The table of wrong constants.

use catalogue::estimators::Kind;
use catalogue::parameters::{Parameters, PlantKind};
use experiments::compare::{Case, Settings};
use experiments::sensitivity::{self, sensitivity};
use measured::tables::WRONG_CONSTANTS;
use scoring::score::Wanted;
use simulation::device::{Device, Disc};
use simulation::scenario::ScenarioName;

use crate::check;

/// The table that the program prints for a device with this disc at 1 kHz.
fn printed(disc: Disc) -> String {
    let settings = Settings {
        device: Device {
            disc,
            ..Device::default()
        },
        estimators: Kind::all().iter().collect(),
        parameters: Parameters::default(),
        wanted: Wanted::NONE,
    };
    use ScenarioName::{Creep, FreeAir, Hold, Permanent, Step, Texture, Track, Wall};
    let scenarios = [Step, Permanent, Track, FreeAir, Wall, Texture, Creep, Hold];
    let of = |scenario: ScenarioName| {
        [1, 2, 3].map(|seed| Case {
            scenario,
            rate_hz: 1e3,
            plant: PlantKind::Friction,
            seed,
            seconds: scenario.default_seconds(),
            keep: false,
        })
    };
    let cases: Vec<_> = scenarios.into_iter().flat_map(of).collect();
    let rows = sensitivity(&cases, &settings, &|| ()).unwrap();
    sensitivity::table::table(&rows, usize::MAX)
}

#[test]
fn errors_with_wrong_constants() {
    let errors = Disc {
        phase_counts: 0.06,
        line_counts: 0.25,
        random_counts: 0.02,
    };
    let tables = [Disc::default(), errors].map(printed);
    let row = |name: &str| {
        let figures = tables.iter().flat_map(|text| {
            let cells = text.lines().map(|line| line.split_whitespace().collect());
            let is = |cells: &Vec<&str>| cells.first() == Some(&name);
            let cells: Vec<&str> = cells.into_iter().find(is).expect(name);
            // With right constants, over all scenarios. With the worst ones: before the two shares
            // outside the interval.
            [cells[1], cells[cells.len() - 3]].map(str::to_owned)
        });
        [name.to_owned()].into_iter().chain(figures).collect()
    };
    let rows: Vec<_> = Kind::all().iter().map(|kind| row(kind.name)).collect();
    check(&WRONG_CONSTANTS, &[], &rows);
}
