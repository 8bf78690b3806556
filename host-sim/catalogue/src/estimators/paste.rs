//! Lines of Rust that use an estimator in a program of the user, made from its row of the catalogue.

use std::collections::BTreeSet;
use std::fmt::Write as _;

use estimator_core::{CoupledMotor, Signals};
use simulation::trace::EDGE_CLOCK_HZ;

use super::build::capacity;
use super::{Kind, Setup, Values};

/// The counts per revolution in a design.
const COUNTS: &str = "motor.motor.counts_per_rev";

impl Kind {
    /// Whether the design reads constants of the device other than the counts per revolution.
    #[must_use]
    pub fn needs_device(&self) -> bool {
        spaced(self.rust_design)
            .replace(COUNTS, "")
            .contains("motor")
    }

    /// A module that imports `estimator-core` alone: the estimator with these parameter values as a
    /// constant, and a state with the functions `start` and `update`.
    #[must_use]
    pub fn rust(&self, setup: &Setup, values: &Values) -> String {
        let motor = setup.stages.coupled_motor();
        let counts_per_rev = motor.motor.counts_per_rev;
        let of_type = self.type_of(values);
        let design = self.design_of(counts_per_rev, values);
        let used = self.imports(&of_type, &design).join(", ");
        let [of_type, design] = [&of_type, &design].map(|text| text.replace(CRATE, ""));
        let estimator = match design
            .strip_prefix("Ok(")
            .and_then(|rest| rest.strip_suffix(')'))
        {
            Some(estimator) => estimator.to_owned(),
            None => format!("preset!({design})"),
        };

        let mut text = format!("use estimator_core::{{{used}}};\n\n");
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "/// Rate at which `update` is called.\nconst RATE: Hertz = Hertz({:?});",
            setup.rate.0
        );
        let _ = writeln!(
            text,
            "/// Counts per revolution: four times the lines of the encoder.\nconst SCALE: Scale = preset!(Scale::new({counts_per_rev}, RATE));"
        );
        if design.contains("EDGE_CLOCK") {
            let _ = writeln!(
                text,
                "/// Clock of the edges' time stamps.\nconst EDGE_CLOCK: Hertz = Hertz({EDGE_CLOCK_HZ:?});"
            );
        }
        if self.needs_device() {
            text += &constants(&motor);
        }
        let _ = writeln!(
            text,
            "type Estimator = {of_type};\nconst ESTIMATOR: Estimator = {estimator};\n"
        );
        text + &functions(self.needs)
    }

    /// The type of the estimator with its length, where it has one. Names of `estimator-core` begin with
    /// [`CRATE`].
    fn type_of(&self, values: &Values) -> String {
        let window = self.parameters.iter().position(|p| p.name == "n");
        let length = window.map_or(capacity(self.row) as f64, |i| values[i]);
        let of_type = with_name(&spaced(self.rust_type), "N", &format!("{length}"));
        with_name(&of_type, "c", "estimator_core")
    }

    /// The design with these parameter values. Names of `estimator-core` begin with [`CRATE`].
    fn design_of(&self, counts_per_rev: u32, values: &Values) -> String {
        let mut design = spaced(self.rust_design);
        if let Some((first, then)) = design
            .strip_prefix("$crate::then!(")
            .and_then(|rest| rest.strip_suffix(')')?.split_once(", | model | "))
        {
            design = format!("match {first} {{ Ok(model) => {then}, Err(error) => Err(error) }}");
        }
        design = design.replace("$crate::uncertainty!(c, p)", UNCERTAINTY);
        for (parameter, value) in self.parameters.iter().zip(values) {
            design = with_value(&design, parameter.name, *value);
        }
        design = design
            .replace(COUNTS, &counts_per_rev.to_string())
            .replace("motor.motor", "MOTOR.motor")
            .replace("(motor,", "(&MOTOR,");
        for (name, constant) in [
            ("rate", "RATE"),
            ("clock", "EDGE_CLOCK"),
            ("c", "estimator_core"),
        ] {
            design = with_name(&design, name, constant);
        }
        design
    }

    /// The names of `estimator-core` that the module uses, in order.
    fn imports<'a>(&self, of_type: &'a str, design: &'a str) -> Vec<&'a str> {
        let mut used: BTreeSet<&str> = [
            "Count",
            "Hertz",
            "Sample",
            "Scale",
            "VelocityEstimator",
            "preset",
        ]
        .into();
        for text in [of_type, design] {
            let names = text.split(CRATE).skip(1);
            used.extend(names.map(|rest| rest.split(|c: char| !is_name(c)).next().unwrap_or(rest)));
        }
        let by_signal = [
            (self.needs.current, &["Amps"][..]),
            (self.needs.edge, &["Edge"]),
            (self.needs_device(), &["CoupledMotor", "MotorModel"]),
        ];
        used.extend(
            by_signal
                .iter()
                .filter(|(needed, _)| *needed)
                .flat_map(|(_, names)| *names),
        );
        used.into_iter().collect()
    }
}

/// The functions of the module: `sample`, which gathers the inputs that the estimator reads, and those of the
/// state.
fn functions(needs: Signals) -> String {
    let inputs = [
        (true, "count: u32"),
        (needs.coupled, "coupled: u32"),
        (needs.current, "amps: f32"),
        (needs.edge, "edge: Option<Edge>"),
    ];
    let inputs: Vec<_> = inputs
        .iter()
        .filter(|(needed, _)| *needed)
        .map(|(_, input)| *input)
        .collect();
    let names: Vec<_> = inputs
        .iter()
        .filter_map(|input| input.split(':').next())
        .collect();
    let fields = [
        (needs.coupled, "    sample.coupled = Count(coupled);\n"),
        (
            needs.current,
            "    // Commanded over the period that ends now.\n    sample.current = Amps::new(amps);\n",
        ),
        (needs.edge, "    sample.edge = edge;\n"),
    ];
    let fields: String = fields
        .iter()
        .filter(|(needed, _)| *needed)
        .map(|(_, line)| *line)
        .collect();
    let mutable = if fields.is_empty() { "" } else { "mut " };
    let (inputs, names) = (inputs.join(", "), names.join(", "));
    format!(
        "fn sample({inputs}) -> Sample {{\n    let {mutable}sample = Sample::new(Count(count));\n{fields}    sample\n}}\n\n\
         /// Velocity of the shaft.\npub struct Velocity(<Estimator as VelocityEstimator>::State);\n\n\
         impl Velocity {{\n\
         \x20   /// At rest at the first count.\n\
         \x20   pub fn start({inputs}) -> Self {{\n        Self(ESTIMATOR.start(&sample({names})))\n    }}\n\n\
         \x20   /// Velocity in rad/s. Call it once per period of RATE.\n\
         \x20   pub fn update(&mut self, {inputs}) -> f32 {{\n\
         \x20       let velocity = ESTIMATOR.update(&mut self.0, &sample({names}));\n\
         \x20       velocity.rad_per_s(&SCALE)\n    }}\n}}\n"
    )
}

/// The crate of the estimators, before a name.
const CRATE: &str = "estimator_core::";

/// What the macro `uncertainty` of the catalogue expands to.
const UNCERTAINTY: &str = "c::Uncertainty { torque_noise: p.torque_noise, disturbance: p.load, \
    disturbance_time: p.load_time, friction_share: p.friction_share, boundary_noise: p.boundary_noise }";

/// The constants of the device.
fn constants(motor: &CoupledMotor) -> String {
    let CoupledMotor {
        motor,
        coulomb_friction,
        amplifier_lag,
        coupled_counts_per_rev,
    } = motor;
    format!(
        "const MOTOR: CoupledMotor = CoupledMotor {{\n    motor: MotorModel {{\n        counts_per_rev: {},\n        \
         inertia: {:?},\n        damping: {:?},\n        torque_constant: {:?},\n    }},\n    \
         coulomb_friction: {coulomb_friction:?},\n    amplifier_lag: {amplifier_lag:?},\n    \
         coupled_counts_per_rev: {coupled_counts_per_rev},\n}};\n",
        motor.counts_per_rev, motor.inertia, motor.damping, motor.torque_constant
    )
}

/// The text of the compiler for code of the catalogue, with the spaces of rustfmt.
fn spaced(code: &str) -> String {
    let words: Vec<_> = code.split_whitespace().collect();
    let mut code = words.join(" ");
    for (from, to) in [
        (" :: ", "::"),
        (" < ", "<"),
        (" >", ">"),
        ("& ", "&"),
        (" : ", ": "),
        ("! (", "!("),
        (", }", " }"),
    ] {
        code = code.replace(from, to);
    }
    code
}

fn is_name(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// `code` with `new` in the place of the name `old`.
fn with_name(code: &str, old: &str, new: &str) -> String {
    let mut text = String::new();
    let mut rest = code;
    while let Some(at) = rest.find(old) {
        let (before, after) = (&rest[..at], &rest[at + old.len()..]);
        let ends = |c: Option<char>| c.is_none_or(|c| !is_name(c));
        let whole = ends(before.chars().next_back()) && ends(after.chars().next());
        text += before;
        text += if whole { new } else { old };
        rest = after;
    }
    text + rest
}

/// `code` with `value` in the place of the parameter `name`. A conversion to an integer becomes an
/// integer.
fn with_value(code: &str, name: &str, value: f64) -> String {
    let mut code = code.to_owned();
    for integer in ["usize", "u16"] {
        code = code.replace(&format!("p.{name} as {integer}"), &format!("{value}"));
    }
    with_name(&code, &format!("p.{name}"), &format!("{value:?}"))
}
