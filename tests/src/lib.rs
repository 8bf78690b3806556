//! Acceptance tests over the whole project; the tests themselves stand in `tests/`.
