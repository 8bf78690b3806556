//! The C files of the cases of one control rate.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use bench_image::CLOCK;
use catalogue::estimators::{Kind, Setup};
use estimator_catalogue::Reports;
use estimator_core::Hertz;

use crate::reference::Case;

/// The default device at a rate, as the bench image has it.
fn setup(case: &Case) -> Setup {
    Setup {
        rate: Hertz(f64::from(case.rate_hz)),
        ..Setup::default()
    }
}

/// `parameters.h`: the headers that `host-sim export --c` writes, and lists of the cases. Cases of one
/// type are one.
#[must_use]
pub fn parameters(cases: &[&Case]) -> String {
    let mut text = String::new();
    let (mut all, mut varying) = (String::new(), String::new());
    for case in distinct(cases) {
        let kind = Kind::named(case.c.row.name).expect("a row");
        let header = kind.c_of(&case.c, &setup(case), CLOCK, &(case.values)(), None);
        text += &header.expect("the bench image has it");
        let c = case.c;
        let function = |reported: bool, what: &str| match reported {
            true => format!("limpid_{c}_{what}"),
            false => "NONE".to_owned(),
        };
        let reports = c.row.reports;
        let [variance, acceleration, damping] = [
            function(reports != Reports::Nothing, "variance"),
            function(reports == Reports::Acceleration, "acceleration"),
            function(reports == Reports::Damping, "damping_ratio"),
        ];
        write!(all, " EACH({c}, {variance}, {acceleration}, {damping})").expect("a string");
        if c.row.varying_period {
            write!(varying, " EACH({c})").expect("a string");
        }
    }
    text + "#define CASES(EACH)" + &all + "\n#define VARYING(EACH)" + &varying + "\n"
}

/// `designs.h`: a function per case that designs it in C.
#[must_use]
pub fn designs(cases: &[&Case]) -> String {
    let mut text = String::new();
    for case in distinct(cases) {
        let Case { c, .. } = case;
        let setup = setup(case);
        let motor = setup.stages.coupled_motor();
        let mut body = format!(
            "    limpid_setup_t setup = {{{}u, {}u, {:?}, {:?}, {:e}, {:e}, {:e}, {:e}, {:e}}};\n",
            motor.motor.counts_per_rev,
            motor.coupled_counts_per_rev,
            setup.rate.0,
            CLOCK.0,
            motor.motor.inertia,
            motor.motor.damping,
            motor.motor.torque_constant,
            motor.coulomb_friction,
            motor.amplifier_lag,
        );
        let late = c.row.reports == Reports::LateCurrent;
        let parameters: Vec<_> = (c.row.parameters.iter().zip((case.values)()))
            .filter(|(parameter, _)| !(late && parameter.name == "literal"))
            .collect();
        let mut values = "";
        if !parameters.is_empty() {
            writeln!(body, "    limpid_{}_values_t values;", c.row.id).expect("a string");
            for (parameter, value) in parameters {
                writeln!(body, "    values.{} = {value:e};", parameter.name).expect("a string");
            }
            values = ", &values";
        }
        write!(
            text,
            "static int32_t design_{c}(limpid_{c}_t *into)\n{{\n{body}    \
             return limpid_{c}_design(into, &setup{values});\n}}\n",
        )
        .expect("a string");
    }
    text
}

fn distinct<'a>(cases: &[&'a Case]) -> Vec<&'a Case> {
    let mut seen = BTreeSet::new();
    let of_type = |case: &&Case| seen.insert(case.c.to_string());
    cases.iter().copied().filter(of_type).collect()
}
