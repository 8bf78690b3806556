use super::*;

fn without_traces(mut report: ReportInput) -> ReportInput {
    for case in &mut report.cases {
        case.traces = None;
    }
    report
}

/// The environment variable `DEMO_REPORT` names a file to which the page is written.
#[test]
fn full_report_has_every_figure_and_no_broken_number() {
    let page = html(&demo::report(&[])).unwrap();
    if let Some(file) = std::env::var_os("DEMO_REPORT") {
        std::fs::write(file, &page).unwrap();
    }
    for text in [
        "Finite difference at 1 kHz",
        "figure 1)",
        "Step response at 1 kHz",
        "Step response at 11.6 kHz",
        "figure 6)",
        "Permanent regime at 1 kHz",
        "Permanent regime at 11.6 kHz",
        "figure 7)",
        "Mean distance outside the haptic interval at 1 kHz",
        "Mean distance outside the haptic interval at 11.6 kHz",
        "figure 8)",
        "Spectrum of the velocity error",
        "Table I",
        "Table II",
        "velocity, rad/s",
        "time, ms",
        "frequency, Hz",
        "class=\"verdict\"",
        "host-sim compare --seed 1",
        "is 1.53\u{a0}rad/s for a finite difference, or 42.1\u{a0}mN at the fingertip",
        "The threshold of a fingertip is 10.0\u{a0}mN",
        "Spectrum of the velocity error, scenario track, plant with friction",
        "Finite difference at 1 kHz, scenario step, plant with friction",
    ] {
        assert!(page.contains(text), "{text}");
    }
    assert_eq!(page.matches("<svg").count(), 8);
    let outside_script = page.split("<script>").next().unwrap();
    for bad in ["NaN", "inf ", "inf,", "\"inf"] {
        assert!(!outside_script.contains(bad), "{bad}");
    }
    assert!(page.len() < 2_000_000, "{} bytes", page.len());
}

#[test]
fn figure_of_the_quantisation_is_that_of_finite_difference() {
    let page = html(&demo::report(&[])).unwrap();
    let one = figures(&page)
        .find(|svg| svg.contains("figure 1)"))
        .unwrap();
    assert!(
        one.contains("\nfinite-difference\n") && !one.contains("\nlow-pass\n"),
        "{one}"
    );
}

#[test]
fn each_link_of_the_navigation_has_its_section() {
    for report in [demo::report(&[]), ReportInput::default()] {
        let page = html(&report).unwrap();
        let links: Vec<&str> = page
            .split("href=\"#")
            .skip(1)
            .map(|rest| rest.split('"').next().unwrap())
            .collect();
        assert!(!links.is_empty());
        for link in &links {
            assert!(page.contains(&format!("<section id=\"{link}\">")), "{link}");
        }
        assert_eq!(links.len(), page.matches("<section").count());
    }
}

#[test]
fn page_loads_no_other_file() {
    let page = html(&demo::report(&[])).unwrap();
    let page = page.replace("xmlns=\"http://www.w3.org/2000/svg\"", "");
    for load in ["http:", "https:", "src=", "@import", "url(", "<link"] {
        assert!(!page.contains(load), "{load}");
    }
}

#[test]
fn markup_in_names_is_escaped() {
    let mut report = demo::report(&["<script>alert(\"1\")</script> & co"]);
    report.command = "host-sim --device \"<b>.toml\"".into();
    report.device_name = "<i>device</i>".into();
    report.notes = vec!["<u>note</u>".into()];
    for case in &mut report.cases {
        if case.scenario == "hold" {
            case.scenario = "<s>hold".into();
        }
    }
    let page = html(&report).unwrap();
    for raw in [
        "<script>alert",
        "<b>.toml",
        "<i>device",
        "<u>note",
        "<s>hold",
        "</script> &",
    ] {
        assert!(!page.contains(raw), "{raw}");
    }
    assert!(page.contains("&lt;script&gt;alert(&quot;1&quot;)&lt;/script&gt; &amp; co"));
}

#[test]
fn sections_without_data_are_left_out() {
    let page = html(&without_traces(demo::report(&[]))).unwrap();
    assert!(page.contains("figure 8)") && page.contains("Scores"));
    for missing in ["figure 1)", "figure 6)", "figure 7)", "Spectrum of"] {
        assert!(!page.contains(missing), "{missing}");
    }
    let page = html(&ReportInput::default()).unwrap();
    assert!(page.contains("Table II") && !page.contains("<svg") && !page.contains("verdict\""));
}

#[test]
fn single_case_makes_a_page() {
    let mut report = demo::report(&[]);
    report
        .cases
        .retain(|case| case.scenario == "step" && case.rate_hz > 2e3 && !case.friction);
    let page = html(&report).unwrap();
    assert!(page.contains("Step response at 11.6 kHz, plant without friction"));
    assert!(page.contains("in one scenario"));
}

#[test]
fn non_finite_samples_are_not_drawn() {
    let mut report = demo::report(&[]);
    for case in &mut report.cases {
        let traces = case.traces.as_mut().unwrap();
        traces.estimates[1].1[500..].fill(f32::NAN);
        case.rows[1].score.rms_rad_s = Some(f64::INFINITY);
        case.rows[1].score.distance_rad_s = Some(f64::INFINITY);
    }
    let page = html(&report).unwrap();
    let outside_script = page.split("<script>").next().unwrap();
    assert!(!outside_script.contains("NaN") && outside_script.contains('\u{221e}'));
}

#[test]
fn inconsistent_signals_are_an_error() {
    let mut report = demo::report(&[]);
    report.cases[0].traces.as_mut().unwrap().estimates[2]
        .1
        .pop();
    let message = html(&report).unwrap_err();
    assert!(
        message.contains("step") && message.contains("foaw-end-fit"),
        "{message}"
    );
    let mut report = demo::report(&[]);
    report.cases[1].traces.as_mut().unwrap().truth[7] = f64::NAN;
    assert!(html(&report).unwrap_err().contains("not finite"));
    let mut report = demo::report(&[]);
    report.cases[1].traces.as_mut().unwrap().rate_hz = 0.0;
    assert!(html(&report).unwrap_err().contains("sample rate 0"));
}
