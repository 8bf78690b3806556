//! Control rates of the option `--rate`: range, default, and both in help texts.

use experiments::closed_loop::LOWEST_RATE_HZ;
use recordings::recording::SLOWEST_HZ;
use simulation::simulate::RATES_HZ;

/// The default of a command that runs one rate, Hz.
pub(super) const USUAL_HZ: [f64; 1] = [1e3];

/// The rates of the paper's experiments, Hz.
pub(super) const PAPER_HZ: [f64; 2] = [1e3, 11.6e3];

/// The rates of the paper and that of the firmware, Hz. The shipped presets are for these.
pub(super) const TUNED_HZ: [f64; 3] = [1e3, 10e3, 11.6e3];

/// Help text of a `--rate`, with the range.
pub(super) fn rate_help() -> String {
    format!("Control rate, {} to {} Hz", RATES_HZ.0, RATES_HZ.1)
}

/// Help text of a `--rate` of closed loops, with the range.
pub(super) fn loop_rate_help() -> String {
    format!("Control rate, {LOWEST_RATE_HZ} to {} Hz", RATES_HZ.1)
}

/// Help text of a rate of recordings, `what`, with the range, and with what is `more`.
pub(super) fn recording_rate_help(what: &str, more: &str) -> String {
    format!("{what}, {SLOWEST_HZ} to {} Hz{more}", RATES_HZ.1)
}

/// The end of a help text: the option is repeatable, and has this default.
pub(super) fn repeatable(default: &[f64]) -> String {
    let rates: Vec<_> = default.iter().map(f64::to_string).collect();
    let listed = match &rates[..] {
        [others @ .., last] if !others.is_empty() => format!("{} and {last}", others.join(", ")),
        rates => rates.concat(),
    };
    format!("; repeatable [default: {listed}]")
}

#[cfg(test)]
mod tests {
    use catalogue::parameters::Presets;

    use super::*;

    #[test]
    fn help_has_the_range_and_the_default() {
        for (default, end) in [
            (&USUAL_HZ[..], "1000"),
            (&PAPER_HZ, "1000 and 11600"),
            (&TUNED_HZ, "1000, 10000 and 11600"),
        ] {
            let help = rate_help() + &repeatable(default);
            let said = format!("Control rate, 100 to 100000 Hz; repeatable [default: {end}]");
            assert_eq!(help, said);
        }
        let help = recording_rate_help("Rate of the ticks", ", one");
        assert_eq!(help, "Rate of the ticks, 5 to 100000 Hz, one");
    }

    #[test]
    fn shipped_presets_are_for_the_tuned_rates() {
        let mut rates: Vec<_> = (Presets::shipped().preset.iter())
            .map(|preset| preset.rate_hz)
            .collect();
        rates.sort_by(f64::total_cmp);
        rates.dedup();
        assert_eq!(rates, TUNED_HZ);
    }
}
