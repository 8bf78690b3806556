#![no_main]
use fuzz_bodies::samples;

thread_local! {
    static TESTED: Vec<stress::tested::TestedEstimator> = samples::tested_estimators();
}

libfuzzer_sys::fuzz_target!(|data: &[u8]| TESTED.with(|all| samples::run(all, data)));
