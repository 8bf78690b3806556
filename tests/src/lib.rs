//! Acceptance tests over the whole project; the tests themselves stand in `tests/`.

#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
struct Readme;
