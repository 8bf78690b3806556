//! The bytes of an estimator in memory, for initialisers in other languages.

use core::marker::PhantomData;

/// A design whose bytes in memory are defined: those of `repr(C)`, little endian, with numbers of eight bytes
/// aligned to eight. So they are on the targets of the library for C.
///
/// A design has no pointer and no field that depends on the target. [`Memory::bytes`] writes its bytes, so
/// that a constant of another language can have them, and a program that reads this constant as a design
/// has the design.
///
/// ```
/// use estimator_core::{Hertz, Memory, Pll, preset};
/// const PLL: Pll = preset!(Pll::new(Hertz(59.0), Hertz(1000.0)));
/// let mut bytes = Vec::new();
/// PLL.bytes(&mut |byte| bytes.push(byte));
/// // Two parameters of four bytes.
/// assert_eq!(bytes.len(), size_of::<Pll>());
/// ```
pub trait Memory {
    /// Passes the bytes of the value to `each`, in the order of their addresses. Padding is zero.
    fn bytes(&self, each: &mut dyn FnMut(u8))
    where
        Self: Sized,
    {
        self.write(&mut Writer { each, length: 0 });
    }

    /// Writes the value after what has been written.
    #[doc(hidden)]
    fn write(&self, to: &mut Writer<'_>);
}

/// Counts the bytes that it passes on, so that each value begins at a multiple of its alignment.
#[doc(hidden)]
pub struct Writer<'a> {
    each: &'a mut dyn FnMut(u8),
    length: usize,
}

impl Writer<'_> {
    fn byte(&mut self, byte: u8) {
        (self.each)(byte);
        self.length += 1;
    }

    /// Pads with zeros to a multiple of the alignment of `T`.
    pub(crate) fn align<T>(&mut self) {
        while self.length % align_of::<T>() != 0 {
            self.byte(0);
        }
    }
}

macro_rules! numbers {
    ($($number:ty)*) => {
        $(
            impl Memory for $number {
                fn write(&self, to: &mut Writer<'_>) {
                    to.align::<Self>();
                    for byte in self.to_le_bytes() {
                        to.byte(byte);
                    }
                }
            }
        )*
    };
}

numbers!(u8 u16 u32 i32 i64 f32);

impl<T: Memory, const N: usize> Memory for [T; N] {
    fn write(&self, to: &mut Writer<'_>) {
        for element in self {
            element.write(to);
        }
    }
}

impl<T> Memory for PhantomData<T> {
    fn write(&self, _: &mut Writer<'_>) {}
}

/// Implements [`Memory`] for a structure that is `repr(C)`, with its fields in the order of their
/// declaration: `memory!([parameters] Type { fields })`. A field that is left out is a build error.
macro_rules! memory {
    ([$($parameters:tt)*] $type:ty { $($field:tt),* }) => {
        impl<$($parameters)*> $crate::memory::Memory for $type {
            fn write(&self, to: &mut $crate::memory::Writer<'_>) {
                let Self { $($field: _),* } = self;
                to.align::<Self>();
                $($crate::memory::Memory::write(&self.$field, to);)*
                to.align::<Self>();
            }
        }
    };
    ($type:ty { $($field:tt),* }) => {
        $crate::memory::memory!([] $type { $($field),* });
    };
}

pub(crate) use memory;
