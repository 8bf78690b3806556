//! Expressions of C in the place of the values on WebAssembly's stack.

use std::collections::BTreeSet;

use wasmparser::ValType;

/// A type of values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    U32,
    U64,
    F32,
}

impl Kind {
    /// The type of WebAssembly.
    ///
    /// # Errors
    /// The type's name if no estimator should need it.
    pub(super) fn of(of: ValType) -> Result<Self, String> {
        match of {
            ValType::I32 => Ok(Self::U32),
            ValType::I64 => Ok(Self::U64),
            ValType::F32 => Ok(Self::F32),
            other => Err(format!("has the type {other}, which is not translated")),
        }
    }

    /// The type in C.
    pub(super) fn c(self) -> &'static str {
        match self {
            Self::U32 => "uint32_t",
            Self::U64 => "uint64_t",
            Self::F32 => "float",
        }
    }
}

/// An expression without side effects.
#[derive(Clone, Debug)]
pub(super) struct Value {
    pub(super) text: String,
    pub(super) kind: Kind,
    /// Whether the text is a condition, of the type `int`.
    pub(super) is_condition: bool,
    /// Locals that it reads.
    pub(super) locals: BTreeSet<u32>,
    /// Whether it reads the memory.
    pub(super) loads: bool,
}

impl Value {
    /// A value that depends on nothing that changes.
    pub(super) fn new(kind: Kind, text: String) -> Self {
        Self {
            text,
            kind,
            is_condition: false,
            locals: BTreeSet::new(),
            loads: false,
        }
    }

    /// A local.
    pub(super) fn local(kind: Kind, k: u32) -> Self {
        Self {
            locals: BTreeSet::from([k]),
            ..Self::new(kind, format!("l{k}"))
        }
    }

    /// A value of the `text` that contains those of `parts`.
    pub(super) fn of(kind: Kind, text: String, parts: &[&Self]) -> Self {
        Self {
            locals: parts
                .iter()
                .flat_map(|part| part.locals.iter().copied())
                .collect(),
            loads: parts.iter().any(|part| part.loads),
            ..Self::new(kind, text)
        }
    }

    /// The expression as a number.
    pub(super) fn number(&self) -> String {
        match self.is_condition {
            true => format!("(uint32_t){}", self.text),
            false => self.text.clone(),
        }
    }

    /// The expression as a condition.
    pub(super) fn condition(&self) -> String {
        match self.is_condition {
            true => self.text.clone(),
            false => format!("{} != 0", self.text),
        }
    }

    /// The number 1 where the condition `text` of `parts` holds, else 0.
    pub(super) fn condition_of(text: String, parts: &[&Self]) -> Self {
        Self {
            is_condition: true,
            ..Self::of(Kind::U32, text, parts)
        }
    }
}

/// A float as C writes it, to the last bit.
pub(super) fn float(bits: u32) -> String {
    let (negative, exponent, fraction) = (bits >> 31 == 1, bits >> 23 & 0xff, bits & 0x7f_ffff);
    let sign = if negative { "-" } else { "" };
    match (exponent, fraction) {
        (0, 0) => format!("{sign}0.0f"),
        (0 | 255, _) => format!("of_bits(UINT32_C({bits}))"),
        // Seven digits of hexadecimal have 24 bits.
        _ => format!("{sign}0x1.{:06x}p{}f", fraction << 1, exponent as i32 - 127),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn floats_are_written_to_the_last_bit() {
        for (number, text) in [
            (0.0f32, "0.0f"),
            (-0.0, "-0.0f"),
            (1.0, "0x1.000000p0f"),
            (-2.5, "-0x1.400000p1f"),
            (f32::MAX, "0x1.fffffep127f"),
            (f32::INFINITY, "of_bits(UINT32_C(2139095040))"),
            (1e-45, "of_bits(UINT32_C(1))"),
        ] {
            assert_eq!(float(number.to_bits()), text);
        }
    }
}
