//! Designs that must not compile, and the compiler's messages; the cases are in `tests/cases`.
