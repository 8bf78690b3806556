//! The paper's tables: constants of the device, and velocity and force of one count.

use device_files::six_digits;
use maud::{Markup, html};
use std::f64::consts::TAU;

use super::text::{number, rate};
use experiments::compare::interval;
use simulation::device::Device;

/// Lines a revolution and rates of the paper's Table II, Hz.
const LINES: [u32; 2] = [1024, 5000];
const RATES_HZ: [f64; 2] = [1000.0, 11_600.0];

/// Velocity of one count per tick, rad/s; `edges_per_line` is 4 if every edge of both channels
/// counts.
pub(super) fn velocity_step(lines: u32, edges_per_line: u32, rate_hz: f64) -> f64 {
    TAU * rate_hz / f64::from(lines * edges_per_line)
}

/// Table I.
pub(super) fn constants(name: &str, device: &Device) -> Markup {
    let haptic = interval(device);
    let threshold = html! { "F" sub { "shd" } };
    let rows = [
        (
            html! { "coupler damping b" },
            format!(
                "{} mN\u{b7}m\u{b7}s/rad",
                six_digits(1e3 * device.stages.damping)
            ),
        ),
        (
            html! { "handle diameter D" },
            format!("{} mm", six_digits(1e3 * device.handle.diameter_m)),
        ),
        (
            html! { "force threshold of a fingertip, " (threshold) },
            format!("{} mN", six_digits(1e3 * device.interval.threshold_n)),
        ),
        (
            html! { "Weber fraction k" },
            format!("{}\u{a0}%", six_digits(100.0 * device.interval.weber)),
        ),
        (
            html! { "encoder of the large motor" },
            format!(
                "{} counts per revolution",
                device.stages.large.counts_per_rev
            ),
        ),
        (
            html! { "haptic interval at rest, " (threshold) " D / 2b" },
            format!("\u{b1}{} rad/s", number(haptic.floor_rad_s)),
        ),
        (
            html! { "force at the fingertip for an error of 1 rad/s, 2b / D" },
            format!("{} mN", number(haptic.force_mn_per_rad_s)),
        ),
    ];
    html! {
        table.facts {
            caption { "Table I: device constants (" (name) ")" }
            tbody {
                @for (what, value) in rows {
                    tr { th scope="row" { (what) } td { (value) } }
                }
            }
        }
    }
}

/// Table II with four counts and with one count per line.
pub(super) fn count_worth(device: &Device) -> Markup {
    let force = interval(device).force_mn_per_rad_s;
    html! {
        table.facts {
            caption { "Table II: one count per tick with finite difference" }
            thead {
                tr {
                    th rowspan="2" { "encoder" }
                    th rowspan="2" { "sample rate" }
                    th colspan="2" { "4 counts per line: 2\u{3c0} / 4NT" }
                    th colspan="2" { "1 count per line: 2\u{3c0} / NT" }
                }
                tr { th { "rad/s" } th { "mN" } th { "rad/s" } th { "mN" } }
            }
            tbody {
                @for (lines, rate_hz) in LINES.into_iter().flat_map(|n| RATES_HZ.map(|hz| (n, hz))) {
                    tr {
                        th scope="row" { (lines) " lines" }
                        td { (rate(rate_hz)) }
                        @for step in [4, 1].map(|edges| velocity_step(lines, edges, rate_hz)) {
                            td { (number(step)) }
                            td { (number(step * force)) }
                        }
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_count_of_1024_lines_is_42_mn() {
        let step = velocity_step(1024, 4, 1000.0);
        assert!((step - 1.53).abs() < 0.005, "{step}");
        let force = step * interval(&Device::default()).force_mn_per_rad_s;
        assert!((force - 42.0).abs() < 0.1, "{force}");
    }

    #[test]
    fn table_two_has_four_counts_and_one_count_per_line() {
        let html = count_worth(&Device::default()).into_string();
        for row in [
            "1024 lines</th><td>1 kHz</td><td>1.53</td><td>42.1</td><td>6.14</td><td>168</td>",
            "1024 lines</th><td>11.6 kHz</td><td>17.8</td><td>488</td><td>71.2</td><td>1952</td>",
            "5000 lines</th><td>1 kHz</td><td>0.314</td><td>8.62</td><td>1.26</td><td>34.5</td>",
            "5000 lines</th><td>11.6 kHz</td><td>3.64</td><td>100</td><td>14.6</td><td>400</td>",
        ] {
            assert!(html.contains(row), "{row} in {html}");
        }
    }

    #[test]
    fn table_one_has_the_paper_s_values_and_an_escaped_name() {
        let html = constants("J <large>", &Device::default()).into_string();
        for value in [
            "0.96 mN",
            "70 mm",
            "10 mN",
            "5\u{a0}%",
            "\u{b1}0.365",
            "27.4 mN",
        ] {
            assert!(html.contains(value), "{value} in {html}");
        }
        assert!(html.contains("J &lt;large&gt;"));
    }
}
