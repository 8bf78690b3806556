//! Controls and plots of the page in a real browser.

mod common;

use std::path::PathBuf;
use std::sync::OnceLock;

use common::devtools::{Browser, Tab};
use common::page::{drag, page, run_scene, select};
use common::{ATTEMPTS, Server, is_stalled, scratch};
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

/// A page that plays a recording of a minute, which needs no board; `None` without a browser.
fn recorded() -> Option<(Server, Browser, Tab)> {
    // Written once for all tests of this process.
    static PATH: OnceLock<PathBuf> = OnceLock::new();
    let path = PATH.get_or_init(|| {
        let path = scratch("played.csv");
        let rows = (0..12_000).map(|k| format!("{:.3},{}\n", f64::from(k) / 200.0, k / 3));
        let text = format!("t,counts_large\n{}", rows.collect::<String>());
        std::fs::write(&path, text).expect("a file in the folder of the build");
        path
    });
    let server = Server::start(&["--recording", path.to_str().expect("a path in UTF-8")]);
    let mut browser = Browser::start()?;
    let tab = browser.open(&server.url(), 1300, 900);
    browser.wait(&tab, "scope.status?.plays && scope.frames > 2");
    Some((server, browser, tab))
}

#[test]
fn recording_is_paused_and_sought_and_plots_are_held() {
    let Some((_server, mut browser, tab)) = recorded() else {
        return;
    };
    browser.click(&tab, "#pause");
    browser.value(&tab, "window.held = scope.plots.shown[1], 0");
    browser.wait(
        &tab,
        "scope.store.end > window.held + 0.3 && scope.plots.shown[1] === window.held && $('pause').textContent === 'Follow'",
    );
    browser.click(&tab, "#pause");
    browser.wait(&tab, "scope.plots.shown[1] === scope.store.end");

    // Before its end, at which it does not play either.
    browser.click(&tab, "#play");
    browser.wait(
        &tab,
        "!scope.status.plays && scope.status.t < 50 && $('play').textContent === 'Play'",
    );
    browser.value(&tab, "$('seek').value = 12, $('seek').oninput(), 0");
    browser.wait(
        &tab,
        "Math.abs(scope.status.t - 12) < 0.1 && /^1[12]\\.\\d\\d s$/.test($('at').textContent)",
    );
    browser.click(&tab, "#play");
    browser.wait(
        &tab,
        "scope.status.plays && scope.status.t > 12.2 && $('play').textContent === 'Pause'",
    );
    assert_eq!(browser.complaints, [""; 0]);
}

/// Of rows that are made for the test: a row each millisecond of a store of one channel beside the time.
#[test]
fn curve_has_its_peaks_in_their_order_and_rows_that_are_missing_are_counted() {
    let Some((_server, mut browser, tab)) = recorded() else {
        return;
    };
    browser.value(
        &tab,
        "(() => { window.made = new Store([{ name: 't' }, { name: 'x' }], [], 0.01); \
         window.take = (epoch, first, rows) => { const buffer = new ArrayBuffer(16 + 16 * rows.length), head = new DataView(buffer); \
         head.setUint32(0, rows.length, true); head.setUint32(4, epoch, true); head.setFloat64(8, first, true); \
         new Float64Array(buffer, 16).set(rows.flat()); made.take(buffer); }; \
         const peaks = { 417: 5, 421: -7, 803: -3, 805: 4 }; \
         take(1, 0, Array.from({ length: 1000 }, (_, k) => [k / 1000, peaks[k] ?? 0])); })()",
    );
    // Ten buckets of a hundred rows: one has its highest value first, one its lowest.
    let peaks = browser.value(
        &tab,
        "made.decimate([(k) => made.values[1][k]], 0, 1, 10)[1].filter((x) => x !== 0)",
    );
    assert_eq!(peaks, json!([5, -7, -3, 4]));
    // Rows 1000 to 1011 did not come.
    let state = "[made.count, made.lost, made.latest('x')]";
    browser.value(&tab, "take(1, 1012, [[1.012, 2]]), 0");
    assert_eq!(browser.value(&tab, state), json!([1001, 12, 2]));
    // Another board begins, whose rows have other numbers.
    browser.value(&tab, "take(2, 7000, [[7, 9]]), 0");
    assert_eq!(browser.value(&tab, state), json!([1, 12, 9]));
    assert_eq!(browser.complaints, [""; 0]);
}

/// Of a row that is made for the test: the motor turns at -20 rad/s, and the estimate is 1 rad/s off.
#[test]
fn plots_and_words_are_those_of_the_interval_and_of_the_threshold() {
    let Some((_server, mut browser, tab)) = recorded() else {
        return;
    };
    let list = browser.value(
        &tab,
        "(() => { const s = scope.store, set = (name, value) => { s.values[s.column[name]][(s.count - 1) % KEPT] = value; }; \
         set('true_omega', -20); set('velocity_large', -19); \
         const of = (id, label) => plotList(scope.facts, s, new Map()).find((plot) => plot.id === id).series \
         .filter((line) => line.label === label).map((line) => line.get((s.count - 1) % KEPT)); \
         const words = [9, -9, 11, -11].map((force) => { set('parasitic', force); showNumbers(s, scope.controls); \
         return /below|above/.exec($('felt-words').textContent)[0]; }); \
         return { high: of('velocity', 'interval'), low: of('velocity', ''), error: of('error', 'in charge'), \
         words }; })()",
    );
    let series = |name: &str| list[name][0].as_f64().expect("a series");
    // A damping of 0.96 mN·m·s/rad at a radius of 35 mm; 10 mN and 5 % of the velocity are not noticed.
    let force = 0.96 / 0.035;
    let width = 0.05 * 20.0 + 10.0 / force;
    for (found, wanted) in [
        (series("high"), -20.0 + width),
        (series("low"), -20.0 - width),
        (series("error"), force),
    ] {
        assert!((found - wanted).abs() < 1e-4, "{found} {wanted}");
    }
    assert_eq!(list["words"], json!(["below", "below", "above", "above"]));
    assert_eq!(browser.complaints, [""; 0]);
}

/// The angles of the hand, as they would be sent to a board.
#[test]
fn hand_follows_the_pointer_through_whole_turns_and_steps_of_keys_add_up() {
    let Some((_server, mut browser, tab)) = recorded() else {
        return;
    };
    browser.value(
        &tab,
        "scope.view.enabled = true, scope.view.send = (order) => { window.sent = order; }, 0",
    );
    let place = browser.value(
        &tab,
        "(() => { const b = $('device').getBoundingClientRect(), g = scope.view.geometry(); return [b.left + g.x, b.top + g.y, g.radius]; })()",
    );
    let [x, y, radius] = [0, 1, 2].map(|k| place[k].as_f64().expect("a number"));
    let point = |browser: &mut Browser, kind: &str, angle: f64| {
        let (px, py) = (x + radius * angle.sin(), y - radius * angle.cos());
        browser.mouse(&tab, kind, px, py);
        browser.value(&tab, "scope.view.target").as_f64()
    };
    let start = point(&mut browser, "mousePressed", 2.5).expect("the hand takes hold");
    // Twice over the bottom, where the angle of the pointer goes round; to and fro.
    for turned in (1..=20).chain((0..20).rev()).map(|k| 0.5 * f64::from(k)) {
        let angle = point(&mut browser, "mouseMoved", 2.5 + turned).expect("an angle");
        // A pixel of some 100.
        assert!((angle - start - turned).abs() < 0.03, "{turned}: {angle}");
    }
    assert_eq!(point(&mut browser, "mouseReleased", 2.5), None);
    browser.wait(&tab, "window.sent.do === 'hand' && window.sent.at === null");

    browser.value(&tab, "$('device').focus(), scope.view.move(0.5), 0");
    for (key, angle) in [
        ("ArrowRight", 0.52),
        ("ArrowRight", 0.54),
        ("ArrowUp", 0.56),
        ("ArrowLeft", 0.54),
        ("ArrowDown", 0.52),
    ] {
        browser.key(&tab, key);
        let target = browser.value(&tab, "scope.view.target").as_f64();
        let off = target.map(|target| (target - angle).abs());
        assert!(off.is_some_and(|off| off < 1e-9), "{key}: {target:?}");
    }
    // Who goes on to another control lets go.
    browser.value(&tab, "$('device').blur(), 0");
    assert_eq!(browser.value(&tab, "scope.view.target"), json!(null));
    browser.wait(&tab, "window.sent.at === null");
    assert_eq!(browser.complaints, [""; 0]);
}
