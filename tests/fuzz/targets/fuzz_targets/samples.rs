#![no_main]
use fuzz_bodies::samples;

thread_local! {
    static CONTESTANTS: Vec<stress::contestants::Contestant> = samples::contestants();
}

libfuzzer_sys::fuzz_target!(|data: &[u8]| CONTESTANTS.with(|all| samples::run(all, data)));
