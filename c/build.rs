//! Writes the functions of the library from the catalogue of estimators.
//!
//! `types.rs` has the types as Rust compiles them, `storage.rs` the same types as C has them: storage.
//! `functions.rs` and `designs.rs` have the functions, from which the generator of `limpid.h` also reads the
//! declarations.

use std::fmt::Write as _;
use std::path::PathBuf;
use std::{env, fs};

use estimator_catalogue::{CType, Parameter, Reports, Row};
use estimator_core::{DesignError, VelocityEstimator};

/// Size and alignment of a type.
#[derive(Clone, Copy)]
struct Size {
    bytes: usize,
    alignment: usize,
}

impl Size {
    const fn of<T>() -> Self {
        Self {
            bytes: size_of::<T>(),
            alignment: align_of::<T>(),
        }
    }

    /// Words of storage. C has no empty structure.
    fn words(self) -> String {
        let (word, bits) = if self.alignment > 4 { (8, 64) } else { (4, 32) };
        format!("[u{bits}; {}]", self.bytes.div_ceil(word).max(1))
    }
}

/// A type of the library: an estimator with the length of its window or table.
struct Type {
    c: CType,
    parameters: Size,
    state: Size,
}

macro_rules! types {
    ($(
        $id:ident, $name:literal, $reports:ident,
        ($($parameter:tt)*),
        ($($variant:ident: $hertz:literal, $capacity:literal;)*),
        { $($fact:tt)* },
        |$c:ident, $motor:ident, $rate:ident, $clock:ident, $p:ident, $N:ident| $type:ty => $make:expr;
    )*) => {
        fn types() -> Vec<Type> {
            use estimator_core as c;
            let mut types = Vec::new();
            $(
                for c in CType::of(&estimator_catalogue::design::$id::ROW) {
                    $(
                        if c.capacity == $capacity {
                            #[allow(dead_code, reason = "not every type has a length")]
                            const $N: usize = $capacity;
                            types.push(Type {
                                c,
                                parameters: Size::of::<$type>(),
                                state: Size::of::<<$type as VelocityEstimator>::State>(),
                            });
                            continue;
                        }
                    )*
                }
            )*
            types
        }
    };
}

estimator_catalogue::estimators!(types);

/// The parameters that C has: a caller who wants a late current passes the one before.
fn parameters(row: &Row) -> impl Iterator<Item = &'static Parameter> {
    let late = row.reports == Reports::LateCurrent;
    row.parameters
        .iter()
        .filter(move |parameter| !(late && parameter.name == "literal"))
}

/// The text of a macro's argument, with the macro's names.
fn code(text: &str) -> String {
    text.replace("$crate", "estimator_catalogue")
        .replace("$ crate", "estimator_catalogue")
}

/// A number as a person writes it.
fn number(value: f64) -> String {
    if (1e-3..1e6).contains(&value) || value == 0.0 {
        format!("{value}")
    } else {
        format!("{value:e}")
    }
}

#[derive(Default)]
struct Files {
    types: String,
    storage: String,
    functions: String,
    designs: String,
    names: String,
}

impl Files {
    fn add(&mut self, one: &Type) {
        let Type { c, .. } = one;
        self.names.push_str(&format!("\"{c}\","));
        self.type_of(one);
        self.functions_of(c);
        self.design_of(c);
    }

    fn type_of(&mut self, one: &Type) {
        let Type {
            c,
            parameters,
            state,
        } = one;
        let row = c.row;
        let types = &mut self.types;
        let (bytes, alignment) = (parameters.bytes, parameters.alignment);
        let (state_bytes, state_alignment) = (state.bytes, state.alignment);
        write!(
            types,
            "mod {c} {{
                use estimator_core as c;
                #[allow(dead_code, reason = \"not every type has a length\")]
                const N: usize = {};
                pub(crate) type Parameters = {};
            }}
            /// Parameters of `{}`.
            pub type limpid_{c}_t = {c}::Parameters;
            /// State of `{}`.
            pub type limpid_{c}_state_t = <{c}::Parameters as VelocityEstimator>::State;
            const _: () = assert!(size_of::<limpid_{c}_t>() == {bytes});
            const _: () = assert!(align_of::<limpid_{c}_t>() == {alignment});
            const _: () = assert!(size_of::<limpid_{c}_state_t>() == {state_bytes});
            const _: () = assert!(align_of::<limpid_{c}_state_t>() == {state_alignment});\n",
            c.capacity,
            code(row.rust_type),
            row.name,
            row.name,
        )
        .expect("a string");
        let length = match c.capacity {
            0 => String::new(),
            n if row.settling.is_window() => format!(", up to {n} intervals"),
            n => format!(", table of {n} ticks"),
        };
        write!(
            self.storage,
            "/// `{}`{length}: {}. Parameters, which may be in flash.
            #[repr(C)]
            pub struct limpid_{c}_t {{ words: {} }}
            /// State of `{}`, which the caller owns; valid after `limpid_{c}_start`.
            #[repr(C)]
            pub struct limpid_{c}_state_t {{ words: {} }}\n",
            row.name,
            row.summary,
            parameters.words(),
            row.name,
            state.words(),
        )
        .expect("a string");
    }

    fn functions_of(&mut self, c: &CType) {
        let row = c.row;
        let mut signals = vec!["count"];
        signals.extend(row.needs.coupled.then_some("coupled"));
        signals.extend(row.needs.current.then_some("current"));
        signals.extend(
            row.needs
                .edge
                .then_some("has_edge, edge_boundary, edge_age"),
        );
        let reads = signals.join(", ");
        let needs = format!("<limpid_{c}_t as VelocityEstimator>::NEEDS");
        self.function(
            &format!("`{}`: sets the state to rest at the first sample.", row.name),
            &format!("{c}_start(parameters: &limpid_{c}_t, state: &mut MaybeUninit<limpid_{c}_state_t>, first: &limpid_sample_t)"),
            &format!("state.write(parameters.start(&first.sample({needs})));"),
        );
        self.function(
            &format!("`{}`: processes the sample of one tick. Returns the velocity at that sample, counts per tick. Reads of the sample: {reads}.", row.name),
            &format!("{c}_update(parameters: &limpid_{c}_t, state: &mut limpid_{c}_state_t, sample: &limpid_sample_t) -> f32"),
            &format!("parameters.update_of_memory(state, &sample.sample({needs})).0"),
        );
        if row.varying_period {
            self.function(
                &format!("`{}`: processes a sample that comes `period` control periods after the one before, from 1/1024 to 2^20. Returns the velocity, counts per control period.", row.name),
                &format!("{c}_update_over(parameters: &limpid_{c}_t, state: &mut limpid_{c}_state_t, sample: &limpid_sample_t, period: f32) -> f32"),
                &format!("parameters.update_over(state, &sample.sample({needs}), period).0"),
            );
        }
        if row.reports != Reports::Nothing {
            self.function(
                &format!("`{}`: variance of the latest velocity, (counts per tick)^2; see limpid_std_dev.", row.name),
                &format!("{c}_variance(parameters: &limpid_{c}_t, state: &limpid_{c}_state_t) -> f32"),
                "parameters.variance(state).0",
            );
        }
        if row.reports == Reports::Acceleration {
            self.function(
                &format!(
                    "`{}`: acceleration at the latest sample, counts per tick^2.",
                    row.name
                ),
                &format!(
                    "{c}_acceleration(parameters: &limpid_{c}_t, state: &limpid_{c}_state_t) -> f32"
                ),
                "parameters.acceleration(state).0",
            );
        }
        if row.reports == Reports::Damping {
            self.function(
                &format!("`{}`: ratio of the learned damping to the assumed one.", row.name),
                &format!("{c}_damping_ratio(parameters: &limpid_{c}_t, state: &limpid_{c}_state_t) -> f32"),
                "parameters.parameter_errors(state).damping_ratio()",
            );
        }
    }

    fn function(&mut self, doc: &str, signature: &str, body: &str) {
        let returns = if signature.contains("->") {
            "#[must_use]\n"
        } else {
            ""
        };
        write!(
            self.functions,
            "/// {doc}\n{returns}#[unsafe(no_mangle)]\npub extern \"C\" fn limpid_{signature} {{ {body} }}\n",
        )
        .expect("a string");
    }

    fn design_of(&mut self, c: &CType) {
        let row = c.row;
        let fields =
            |each: &dyn Fn(&Parameter) -> String| -> String { parameters(row).map(each).collect() };
        if parameters(row).next().is_some() {
            let declared = fields(&|one| {
                let unit = if one.unit.is_empty() {
                    "without unit"
                } else {
                    one.unit
                };
                let (lowest, highest) = (number(one.lowest), number(one.highest));
                format!(
                    "/// {}; {unit}, {lowest} to {highest}{}.\npub {}: f64,\n",
                    one.meaning,
                    if one.whole { ", whole" } else { "" },
                    one.name
                )
            });
            if CType::of(row)
                .next()
                .is_some_and(|first| first.capacity == c.capacity)
            {
                write!(
                    self.designs,
                    "/// Parameters of `{}` as a person gives them.\n#[repr(C)]\n#[derive(Clone, Copy, Debug)]\n\
                    pub struct limpid_{}_values_t {{ {declared} }}\n",
                    row.name, row.id,
                )
                .expect("a string");
            }
        }
        let design = code(row.rust_design);
        let value = |one: &Parameter| match parameters(row).any(|p| p.name == one.name) {
            true => format!("values.{}", one.name),
            false => "0.0".to_owned(),
        };
        let given: String = row
            .parameters
            .iter()
            .map(|one| format!("{}, ", value(one)))
            .collect();
        let values = match parameters(row).next() {
            Some(_) => format!(", values: &limpid_{}_values_t", row.id),
            None => String::new(),
        };
        write!(
            self.designs,
            "/// Designs `{}`: writes its parameters. Returns 0, or a status and writes nothing.
            #[unsafe(no_mangle)]
            #[allow(unused_variables, reason = \"not every design uses everything\")]
            pub extern \"C\" fn limpid_{c}_design(into: &mut MaybeUninit<limpid_{c}_t>, setup: &limpid_setup_t{values}) -> i32 {{
                #[allow(dead_code, reason = \"not every type has a length\")]
                const N: usize = {};
                let (motor, rate, clock) = (&setup.motor(), c::Hertz(setup.rate_hz), c::Hertz(setup.edge_clock_hz));
                let values = [{given}];
                let p = estimator_catalogue::design::{}::Parameters::from_values(&values);
                design::write(into, setup, &estimator_catalogue::design::{}::ROW, &values, || {design})
            }}\n",
            row.name, c.capacity, row.id, row.id,
        )
        .expect("a string");
    }

    /// The statuses of a design, with their texts.
    fn statuses(&mut self) {
        let out_of_range =
            "a parameter is outside of its range or not whole; see the type of the values";
        let texts = ["no error", out_of_range].into_iter();
        let all = texts.chain(DesignError::ALL.iter().map(|error| error.message()));
        let texts: String = all.map(|text| format!("c{text:?}, ")).collect();
        let names: String = DesignError::NAMES
            .iter()
            .zip(DesignError::ALL)
            .zip(2..)
            .map(|((name, error), status)| {
                format!(
                    "/// {}.\npub const LIMPID_ERROR_{name}: i32 = {status};\n",
                    error.message()
                )
            })
            .collect();
        write!(
            self.designs,
            "/// No error.\npub const LIMPID_OK: i32 = 0;
            /// {out_of_range}.\npub const LIMPID_ERROR_RANGE: i32 = 1;
            {names}
            /// The text of a status.
            #[must_use]
            #[unsafe(no_mangle)]
            pub extern \"C\" fn limpid_status_text(status: i32) -> *const core::ffi::c_char {{
                const TEXTS: &[&core::ffi::CStr] = &[{texts}];
                let known = usize::try_from(status).ok().and_then(|k| TEXTS.get(k));
                known.map_or(c\"unknown status\", |text| text).as_ptr()
            }}\n",
        )
        .expect("a string");
    }
}

fn main() {
    let mut files = Files::default();
    for one in types() {
        files.add(&one);
    }
    files.statuses();
    files.functions.push_str(
        "/// Standard deviation of a variance, correct to the last digit; at most four divisions for a normal number.
        #[must_use]
        #[unsafe(no_mangle)]
        pub extern \"C\" fn limpid_std_dev(variance: f32) -> f32 { c::Variance(variance).std_dev().0 }\n",
    );
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    for (name, text) in [
        ("types.rs", &files.types),
        ("storage.rs", &files.storage),
        ("functions.rs", &files.functions),
        ("designs.rs", &files.designs),
        ("names.rs", &format!("[{}]", files.names)),
    ] {
        fs::write(out.join(name), text).expect("OUT_DIR is writable");
    }
    println!("cargo:rerun-if-changed=build.rs");
    // What is translated to C is for boards too.
    println!("cargo:rustc-check-cfg=cfg(board)");
    let is = |name: &str, value: &str| env::var(name).is_ok_and(|list| list == value);
    if is("CARGO_CFG_TARGET_OS", "none") || is("CARGO_CFG_TARGET_FAMILY", "wasm") {
        println!("cargo:rustc-cfg=board");
    }
}
