//! What must not compile, and with which words; the cases stand in `tests/cases`.
