//! Lines of C that initialise an estimator of `limpid.h`.

use std::fmt::Write as _;

use device_files::decimal;
use estimator_catalogue::{CType, design};
use estimator_core::{DesignError, Hertz, Memory};
use terminal::failure::Failure;

use super::{Kind, Setup, Values, check};

/// The parameters of an estimator in C: their bytes and their alignment.
type Bytes = (Vec<u8>, usize);

/// Designs the type of this length; `None` if the row has no type of this length.
type Design = fn(&Setup, Hertz, &Values, usize) -> Option<Result<Bytes, DesignError>>;

macro_rules! initialisers {
    ($(
        $id:ident, $name:literal, $reports:ident,
        ($($parameter:ident: $range:tt),*),
        ($($variant:ident: $hertz:literal, $capacity:literal;)*),
        { $($fact:tt)* },
        |$c:ident, $motor:ident, $rate:ident, $clock:ident, $p:ident, $N:ident| $type:ty => $make:expr;
    )*) => {
        $(
            #[allow(dead_code, unused_variables, reason = "not every design uses everything")]
            fn $id(
                setup: &Setup,
                edge_clock: Hertz,
                values: &Values,
                capacity: usize,
            ) -> Option<Result<Bytes, DesignError>> {
                use estimator_core as $c;
                let $p = design::$id::Parameters::from_values(values);
                let motor = setup.stages.coupled_motor();
                let ($motor, $rate, $clock) = (&motor, setup.rate, edge_clock);
                $(
                    if capacity == $capacity {
                        const $N: usize = $capacity;
                        let designed: Result<$type, DesignError> = $make;
                        return Some(designed.map(|estimator| {
                            let mut bytes = Vec::new();
                            estimator.bytes(&mut |byte| bytes.push(byte));
                            (bytes, align_of::<$type>())
                        }));
                    }
                )*
                None
            }
        )*

        /// The designs, in the order of the rows.
        static DESIGNS: &[Design] = &[$($id),*];
    };
}

estimator_catalogue::estimators!(initialisers);

impl Kind {
    /// A C header: the parameters of the estimator as a `constant`, or as `limpid_NAME_parameters`, with what they are
    /// made for. A row with several lengths has the shortest that is sufficient.
    ///
    /// # Errors
    /// [`Failure::Input`] that names the parameter or the reason of a refused design.
    pub fn c(
        &self,
        setup: &Setup,
        edge_clock: Hertz,
        values: &Values,
        constant: Option<&str>,
    ) -> Result<String, Failure> {
        for (parameter, &value) in self.parameters.iter().zip(values) {
            check(parameter, self.name, value)?;
            if parameter.name == "literal" && value != 0.0 {
                return Err(Failure::Input(format!(
                    "{}.literal = {}: C has no estimator that delays the current; pass the current of the \
                     tick before, and leave this parameter 0",
                    self.name,
                    decimal(value)
                )));
            }
        }
        let mut lengths = Vec::new();
        let mut why = None;
        for c in CType::of(self.row) {
            match self.c_of(&c, setup, edge_clock, values, constant) {
                Ok(header) => return Ok(header),
                Err(error) => why = Some(error),
            }
            lengths.extend((c.capacity > 0).then(|| c.capacity.to_string()));
        }
        let why = why.map_or_else(String::new, |error| error.to_string());
        let lengths = match &lengths[..] {
            [] => String::new(),
            some => format!(
                "; N in limpid.h is {}{}",
                some.join(" or "),
                self.longest(values, some[some.len() - 1].as_str())
            ),
        };
        Err(Failure::Input(format!(
            "{} at {} Hz: {why}{lengths}",
            self.name,
            decimal(setup.rate.0)
        )))
    }

    /// The option for the `most` intervals of limpid.h, where these are too few for `values`.
    fn longest(&self, values: &Values, most: &str) -> String {
        let window = self.parameters.iter().zip(values);
        let mut window = window.filter(|(parameter, _)| parameter.name == "n");
        let option = window.next().map(|(_, n)| {
            format!(
                ", and n is {}: write --set {}.n={most} or a smaller one",
                decimal(*n),
                self.name
            )
        });
        option.unwrap_or_default()
    }

    /// As [`Kind::c`] for one type of the row, without a check of the ranges of the values.
    ///
    /// # Errors
    /// The reason of a refused design.
    pub fn c_of(
        &self,
        c: &CType,
        setup: &Setup,
        edge_clock: Hertz,
        values: &Values,
        constant: Option<&str>,
    ) -> Result<String, DesignError> {
        let index = Self::all().iter().position(|kind| kind.name == self.name);
        let design = DESIGNS[index.unwrap_or_default()];
        let designed =
            design(setup, edge_clock, values, c.capacity).unwrap_or(Err(DesignError::TABLE));
        Ok(self.header(c, &designed?, setup, edge_clock, values, constant))
    }

    fn header(
        &self,
        c: &CType,
        (bytes, alignment): &Bytes,
        setup: &Setup,
        edge_clock: Hertz,
        values: &Values,
        constant: Option<&str>,
    ) -> String {
        let motor = setup.stages.coupled_motor();
        let mut made_for = vec![
            format!("{} counts per revolution", motor.motor.counts_per_rev),
            format!("{} Hz", decimal(setup.rate.0)),
        ];
        if self.needs.edge {
            made_for.push(format!("edges stamped at {} Hz", decimal(edge_clock.0)));
        }
        if self.needs_device() {
            made_for.push(format!("J = {} kg m^2", decimal(motor.motor.inertia)));
            made_for.push(format!(
                "Kt = {} N m/A",
                decimal(motor.motor.torque_constant)
            ));
            made_for.push(format!("b = {} N m s/rad", decimal(motor.motor.damping)));
        }
        for (parameter, value) in self.parameters.iter().zip(values) {
            let text = format!(
                "{} = {} {}",
                parameter.name,
                decimal(*value),
                parameter.unit
            );
            made_for.push(text.trim_end().to_owned());
        }
        let usual = format!("limpid_{c}");
        let (constant, prefix) = match constant {
            Some(constant) => (constant.to_owned(), constant),
            None => (format!("{usual}_parameters"), usual.as_str()),
        };
        let prefix = prefix.to_uppercase();
        let guard = format!("{}_H", constant.to_uppercase());
        let content = format!(
            "#define {prefix}_COUNTS_PER_REV {}u\n\
             #define {prefix}_RATE_HZ {:?}\n\n\
             static const {usual}_t {constant} = {{{{\n{}}}}};\n",
            motor.motor.counts_per_rev,
            setup.rate.0,
            words(bytes, *alignment),
        );
        let checksum = crc32fast::hash(content.as_bytes());
        // A guard alone would pass over the parameters of a second encoder.
        format!(
            "/* {}: {}.\n   For {}.\n   Written by host-sim {}. */\n\
             #if defined({guard}) && {guard} != {checksum:#010x}u\n\
             #error \"two headers define {constant}: export one of them with --constant NAME\"\n\
             #endif\n\
             #ifndef {guard}\n\
             #define {guard} {checksum:#010x}u\n\n\
             #include \"limpid.h\"\n\n\
             {content}\n\
             #endif\n",
            self.name,
            self.summary,
            made_for.join(",\n   "),
            env!("CARGO_PKG_VERSION"),
        )
    }
}

/// The value of a word. A word that would be no number, or one smaller than those of parameters, is an integer.
fn value(word: u32) -> String {
    const SMALLEST: f32 = 1e-30;
    let number = f32::from_bits(word);
    match number == 0.0 || number.abs() >= SMALLEST {
        true => format!("{number:?}"),
        false => word.cast_signed().to_string(),
    }
}

/// The initialisers of the words, one a line.
fn words(bytes: &[u8], alignment: usize) -> String {
    let mut lines = String::new();
    let mut line =
        |word: std::fmt::Arguments<'_>| writeln!(lines, "    {word},").expect("a string");
    if alignment > 4 {
        for word in bytes.as_chunks().0 {
            line(format_args!(
                "UINT64_C({:#018x})",
                u64::from_le_bytes(*word)
            ));
        }
    } else {
        let mut padded = bytes.to_vec();
        padded.resize(bytes.len().next_multiple_of(4).max(4), 0);
        for word in padded.as_chunks().0 {
            let word = u32::from_le_bytes(*word);
            line(format_args!("UINT32_C({word:#010x}) /* {} */", value(word)));
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameters::{Parameters, PlantKind};

    const CLOCK: Hertz = Hertz(84e6);

    fn header(name: &str, change: &str) -> Result<String, String> {
        let (kind, setup) = (Kind::named(name).unwrap(), Setup::default());
        let mut parameters = Parameters::default();
        if !change.is_empty() {
            parameters.set(change).unwrap();
        }
        let values = parameters.values(kind, &setup, PlantKind::Friction);
        let header = kind.c(&setup, CLOCK, &values, None);
        header.map_err(|error| error.to_string())
    }

    #[test]
    fn words_are_little_endian_and_padded() {
        let lines = |bytes: &[u8], alignment| -> Vec<String> {
            words(bytes, alignment).lines().map(str::to_owned).collect()
        };
        assert_eq!(
            lines(&[0, 0, 0x80, 0x3f, 1], 4),
            [
                "    UINT32_C(0x3f800000) /* 1.0 */,",
                "    UINT32_C(0x00000001) /* 1 */,"
            ]
        );
        assert_eq!(
            lines(&[0xfe, 0xff, 0xff, 0xff], 4),
            ["    UINT32_C(0xfffffffe) /* -2 */,"]
        );
        // An estimator without parameters has one word, because an array of C has an element.
        assert_eq!(lines(&[], 1), ["    UINT32_C(0x00000000) /* 0.0 */,"]);
        assert_eq!(
            lines(&[1, 2, 3, 4, 5, 6, 7, 8], 8),
            ["    UINT64_C(0x0807060504030201),"]
        );
    }

    #[test]
    fn header_says_what_the_parameters_are_made_for() {
        let said = header("low-pass", "low-pass.cutoff_hz=30").unwrap();
        for line in [
            "/* low-pass: first-order low-pass over the finite difference.",
            "   For 4096 counts per revolution,",
            "   1000 Hz,",
            "   cutoff_hz = 30 Hz.",
            "#define LIMPID_LOW_PASS_COUNTS_PER_REV 4096u",
            "#define LIMPID_LOW_PASS_RATE_HZ 1000.0",
            "static const limpid_low_pass_t limpid_low_pass_parameters = {{",
        ] {
            assert!(said.lines().any(|other| other == line), "{line}: {said}");
        }
        assert!(!said.contains("J = ") && !said.contains("edges"), "{said}");
        let said = header("observer-edge", "").unwrap();
        assert!(
            said.contains("edges stamped at 84000000 Hz,\n   J = "),
            "{said}"
        );
    }

    #[test]
    fn header_has_the_constants_of_the_device_in_si_units_and_the_edge_clock() {
        let kind = Kind::named("observer-edge").unwrap();
        let mut setup = Setup::default();
        setup.stages.large.inertia = 0.00025;
        setup.stages.large.torque_constant = 0.03;
        setup.stages.damping = 0.002;
        let values = Parameters::default().values(kind, &setup, PlantKind::Friction);
        let header = |clock| kind.c(&setup, Hertz(clock), &values, None).unwrap();
        let [slow, fast] = [1e6, 2e6].map(header);
        let said = "   edges stamped at 1000000 Hz,\n   J = 0.00025 kg m^2,\n   Kt = 0.03 N m/A,\n   b = 0.002 N m s/rad,\n";
        assert!(slow.contains(said), "{slow}");
        // Ages of edges are in other units.
        let words = |header: &str| -> Vec<_> {
            let lines = header.lines().filter(|line| line.contains("UINT32_C"));
            lines.map(str::to_owned).collect()
        };
        assert_ne!(words(&slow), words(&fast));
    }

    #[test]
    fn shortest_length_that_is_sufficient_is_taken() {
        for (n, capacity) in [("4", "15"), ("15", "15"), ("16", "64"), ("64", "64")] {
            let said = header("foaw-end-fit", &format!("foaw-end-fit.n={n}"));
            let said = said.unwrap();
            assert!(
                said.contains(&format!("limpid_foaw_end_fit_{capacity}_t ")),
                "{n}: {said}"
            );
        }
    }

    #[test]
    fn header_that_c_cannot_have_is_refused() {
        assert!(header("kalman-motor", "kalman-motor.literal=0").is_ok());
        let error = header("kalman-motor", "kalman-motor.literal=1").unwrap_err();
        assert!(
            error.starts_with("kalman-motor.literal = 1: C has no estimator that delays"),
            "{error}"
        );
        let error = header("foaw-end-fit", "foaw-end-fit.n=128").unwrap_err();
        let said = "; N in limpid.h is 15 or 64, and n is 128: write --set foaw-end-fit.n=64 or a smaller one";
        assert!(error.ends_with(said), "{error}");
        let said = "intervals); N in limpid.h is 64, and n is 128: write --set robust-exact.n=64 or a smaller one";
        let error = header("robust-exact", "").unwrap_err();
        assert!(error.ends_with(said), "{error}");
        assert!(header("robust-exact", "robust-exact.n=64").is_ok());
    }
}
