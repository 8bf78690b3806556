//! Controls and plots of the page in a real browser.

mod common;

use common::devtools::Browser;
use common::page::{drag, page, run_scene, select};
use common::{ATTEMPTS, Server, is_stalled};
use serde_json::json;

#[test]
fn settings_are_changed_on_the_page_and_the_bring_up_tells_its_lines() {
    let Some((_server, mut browser, tab)) = page() else {
        return;
    };
    browser.value(&tab, "$('bench-card').open = true, 0");
    browser.wait(&tab, "$('setting-current-scale').value === '1'");
    let enter = |browser: &mut Browser, value: &str| {
        browser.value(&tab, &format!(
            "(() => {{ const i = $('setting-current-scale'); i.value = '{value}'; i.oninput(); i.onchange(); }})()"
        ))
    };
    // A value at its bound is within it.
    browser.wait(&tab, "$('settings').querySelector(':invalid') === null");
    // What is out of the bounds stays in its field, and is not sent.
    enter(&mut browser, "1.5");
    browser.value(&tab, "window.at = scope.status.t, 0");
    browser.wait(
        &tab,
        "scope.status.t > window.at && !$('setting-current-scale').checkValidity()",
    );
    enter(&mut browser, "0.5");
    browser.wait(&tab, "$('setting-current-scale').value === '0.5'");
    for attempt in 1.. {
        browser.click(&tab, "[data-guide=bring-up]");
        browser.wait(&tab, "scope.status.guide?.runs && $('store').disabled");
        browser.wait(
            &tab,
            "$('guide').textContent.includes('pass') || !scope.status.guide.runs",
        );
        browser.wait(&tab, "!scope.status.guide.runs");
        let failure = browser.value(&tab, "scope.status.guide.failure");
        if failure.is_null() {
            break;
        }
        assert!(attempt < ATTEMPTS && is_stalled(&failure), "{failure}");
    }
    browser.wait(
        &tab,
        "$('guide').textContent.includes('pass') && $('guide').textContent.endsWith('done')",
    );
    browser.click(&tab, "#store");
    browser.wait(&tab, "$('stored').textContent === 'Settings stored.'");
    browser.wait(&tab, "!$('store').disabled");
    browser.click(&tab, "#arm");
    browser.wait(&tab, "scope.status.on && $('store').disabled");
    assert_eq!(browser.value(&tab, "scope.status.counts.refused"), 0);
    browser.value(&tab, "$('bench-card').scrollIntoView()");
    browser.picture(&tab, "settings.png");
    assert_eq!(browser.complaints, [""; 0]);
}

#[test]
fn gap_of_a_recording_has_no_line_and_an_axis_has_the_width_of_its_labels() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../tests/data/logs/missing-rows.csv"
    );
    let server = Server::start(&["--recording", path]);
    let Some(mut browser) = Browser::start() else {
        return;
    };
    let tab = browser.open(&server.url(), 1300, 900);
    // Its rows, with a point without values in each gap.
    browser.wait(
        &tab,
        "scope.status?.plays === false && scope.store.count > 10",
    );
    let gaps = browser.value(
        &tab,
        "(() => { const s = scope.store; let n = 0; for (let k = 1; k < s.count; k++) n += s.time[k] - s.time[k - 1] > s.gap; return n; })()",
    );
    assert!(gaps.as_u64() > Some(0), "{gaps}");
    for buckets in [10_000, 10] {
        let nulls = browser.value(
            &tab,
            &format!(
                "(() => {{ const s = scope.store; const [t, x] = s.decimate([(k) => s.time[k]], s.time[0], s.end, {buckets}); \
                 return x.filter((value) => value === null).length; }})()"
            ),
        );
        assert_eq!(nulls, gaps, "{buckets}");
    }
    // The axis of six digits is as wide as its labels.
    browser.value(
        &tab,
        "(() => { const { plot } = scope.plots.plots[0]; plot.setData([[0, 1], [1e6, 2e6], ...plot.data.slice(2).map(() => [null, null])]); \
         plot.setScale('y', { min: 1e6, max: 2e6 }); })()",
    );
    browser.wait(
        &tab,
        "(() => { const { plot } = scope.plots.plots[0], axis = plot.axes[1]; plot.ctx.font = axis.font[0]; \
         const widest = Math.max(...axis._values.map((text) => plot.ctx.measureText(text).width)) / devicePixelRatio; \
         return axis._values.some((text) => text.length > 6) && axis._size >= widest + axis.ticks.size + axis.gap; })()",
    );
    assert_eq!(browser.complaints, [""; 0]);
}

#[test]
fn controls_have_names_and_arrow_keys_choose_an_estimator() {
    let Some((_server, mut browser, tab)) = page() else {
        return;
    };
    run_scene(&mut browser, &tab, "wall");
    let tree = browser.tell(&tab, "Accessibility.getFullAXTree", &json!({}));
    let nodes = tree["nodes"].as_array().expect("nodes");
    let named = |role: &str| -> Vec<_> {
        let of_role = nodes.iter().filter(|it| it["role"]["value"] == role);
        of_role.map(|it| it["name"]["value"].to_string()).collect()
    };
    let sliders = named("slider");
    for name in ["position of wall", "stiffness of wall", "damping of wall"] {
        assert!(sliders.contains(&format!("\"{name}\"")), "{sliders:?}");
    }
    assert!(!sliders.contains(&"\"\"".to_owned()), "{sliders:?}");

    browser.wait(&tab, "scope.store.latest('estimator') === 0");
    browser.wait(
        &tab,
        "$('estimator-0').tabIndex === 0 && $('estimator-1').tabIndex === -1",
    );
    browser.value(&tab, "$('estimator-0').focus()");
    browser.key(&tab, "ArrowRight");
    browser.wait(
        &tab,
        "scope.store.latest('estimator') === 1 && document.activeElement.id === 'estimator-1' \
         && $('estimator-1').tabIndex === 0",
    );
    browser.key(&tab, "ArrowLeft");
    browser.wait(&tab, "scope.store.latest('estimator') === 0");
    assert_eq!(browser.complaints, [""; 0]);
}

#[test]
fn sliders_have_the_values_of_the_board() {
    let Some((_server, mut browser, tab)) = page() else {
        return;
    };
    run_scene(&mut browser, &tab, "wall");
    let shown = |value: &str| {
        format!(
            "Math.abs($('parameter-stiffness').value - {value}) < 1e-6 && $('parameter-stiffness').previousSibling.textContent === '{value} N·m/rad'"
        )
    };
    // Whether the value is shown at once.
    let enter = |browser: &mut Browser, value: &str| {
        let shown = shown(value);
        browser.value(&tab, &format!(
            "(() => {{ const i = $('parameter-stiffness'); i.value = '{value}'; i.oninput(); return {shown}; }})()"
        ))
    };
    browser.wait(&tab, &shown("0.300"));
    assert_eq!(enter(&mut browser, "0.125"), true);
    browser.wait(&tab, "scope.status.tuned['2.1'] === 0.125");
    browser.tell(&tab, "Page.reload", &json!({}));
    browser.wait(
        &tab,
        "scope.role?.commands === true && scope.status?.mode === 'boot'",
    );
    select(&mut browser, &tab, "wall");
    browser.wait(&tab, "scope.status.scene === 2");
    browser.wait(&tab, &shown("0.125"));
    // A value that does not come to the board leaves the slider again.
    browser.value(&tab, "scope.link.send = () => {}, 0");
    assert_eq!(enter(&mut browser, "0.250"), true);
    browser.wait(&tab, &shown("0.125"));
    assert_eq!(browser.complaints, [""; 0]);
}

#[test]
fn dark_page_has_dark_plots() {
    let Some((_server, mut browser, tab)) = page() else {
        return;
    };
    let dark = json!({"features": [{"name": "prefers-color-scheme", "value": "dark"}]});
    browser.tell(&tab, "Emulation.setEmulatedMedia", &dark);
    browser.wait(
        &tab,
        "getComputedStyle(document.body).backgroundColor === 'rgb(20, 23, 26)'",
    );
    run_scene(&mut browser, &tab, "detents");
    drag(&mut browser, &tab, 1.0, 40);
    browser.wait(
        &tab,
        "scope.plots.plots[0].plot.axes[0].stroke() === '#9aa6b0'",
    );
    browser.picture(&tab, "dark.png");
    assert_eq!(browser.complaints, [""; 0]);
}
