//! The options of an image, as bits.

/// Calls the macro `$then` with the names of the features of the firmware, one row `"name";` per bit
/// from bit 0. The order never changes, and a new name is added at the end.
///
/// The firmware makes its bits from the list:
///
/// ```
/// # #![allow(unexpected_cfgs, reason = "the features are those of the firmware")]
/// use drivers::link::Features;
/// macro_rules! bits {
///     ($($name:literal;)+) => {
///         Features::from_flags(&[$(cfg!(feature = $name)),+])
///     };
/// }
/// const FEATURES: Features = drivers::link_features!(bits);
/// assert_eq!(FEATURES, Features(0));
/// ```
#[macro_export]
macro_rules! link_features {
    ($then:ident) => {
        $then! {
            "auto-arm";
            "reference";
            "edge-capture";
            "large-foaw";
            "large-kalman";
            "large-adaptive";
            "current-monitor";
            "index-pulse";
            "supply-monitor";
            "handle-imm";
        }
    };
}

macro_rules! names {
    ($($name:literal;)+) => {
        /// Names of the features of the firmware, each at the number of its bit.
        pub const FEATURES: &[&str] = &[$($name),+];
    };
}
crate::link_features!(names);

/// The features of an image: bit `n` is number `n` of [`FEATURES`].
///
/// ```
/// use drivers::link::Features;
/// let features = Features::from_flags(&[true, false, true]);
/// assert_eq!(features, Features(0b101));
/// assert!(features.names().eq(["auto-arm", "edge-capture"]));
/// assert!(features.has("edge-capture") && !features.has("reference"));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Features(pub u32);

impl Features {
    /// The features whose flags are true, each flag at the number of its bit.
    #[must_use]
    pub const fn from_flags(flags: &[bool]) -> Self {
        let (mut bits, mut bit, mut rest) = (0, 1_u32, flags);
        while let [flag, others @ ..] = rest {
            if *flag {
                bits |= bit;
            }
            (bit, rest) = (bit.wrapping_shl(1), others);
        }
        Self(bits)
    }

    /// Names of the features that are set. Bits without a name are left out.
    pub fn names(self) -> impl Iterator<Item = &'static str> {
        let set = move |bit: u32| self.0.checked_shr(bit).is_some_and(|bits| bits & 1 == 1);
        (0..)
            .zip(FEATURES)
            .filter_map(move |(bit, name)| set(bit).then_some(*name))
    }

    /// Whether the feature of this name is set.
    #[must_use]
    pub fn has(self, name: &str) -> bool {
        self.names().any(|set| set == name)
    }
}
