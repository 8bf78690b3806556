//! The page in a real browser, with the flash image behind it: the handle, recordings, and several pages.

mod common;

use common::devtools::{Browser, Tab};
use common::page::{drag, page, ready, run_scene, select};
use common::{Server, get, image};
use serde_json::json;

/// Largest change of the force at the fingertip between two frames since `window.at`, mN.
fn largest_step(browser: &mut Browser, tab: &Tab) -> f64 {
    let step = browser.value(
        tab,
        "(() => { const s = scope.store, f = s.values[s.column.force]; let most = 0; \
         for (let k = s.search(window.at) + 1; k < s.count; k++) \
         most = Math.max(most, Math.abs(f[k % KEPT] - f[(k - 1) % KEPT])); return most; })()",
    );
    step.as_f64().expect("a force")
}

#[test]
fn handle_is_dragged_into_the_wall_and_the_estimator_changes_without_a_step() {
    let Some((server, mut browser, tab)) = page() else {
        return;
    };
    run_scene(&mut browser, &tab, "wall");
    // The first moments are slow motion: the emulator translates the image. A press would end by overload
    // after some seconds, and begins after them.
    browser.wait(&tab, "scope.store.end > 1");
    let force = |browser: &mut Browser| {
        browser
            .value(&tab, "scope.store.latest('force')")
            .as_f64()
            .expect("a force")
    };
    assert!(force(&mut browser).abs() < 30.0);
    drag(&mut browser, &tab, 1.0, 20);
    // In the wall and at rest: it pushes back, and the number on the page says so.
    browser.wait(
        &tab,
        "scope.store.latest('handle_angle') > 0.2 && Math.abs(scope.store.latest('true_handle')) < 0.02 \
         && scope.store.latest('force') < -300 && Number($('force').textContent) < -300",
    );
    browser.picture(&tab, "wall.png");

    // The other estimator takes over without a step of the force. The large motor turns, so that a velocity
    // that starts at zero would be felt.
    let (now, other) = (0, 1);
    browser.wait(
        &tab,
        &format!("scope.store.latest('estimator') === {now} && Math.abs(scope.store.latest('velocity_large')) > 10"),
    );
    browser.value(&tab, "window.at = scope.store.end, 0");
    browser.wait(&tab, "scope.store.end > window.at + 0.2");
    let before = largest_step(&mut browser, &tab);
    browser.value(&tab, "window.at = scope.store.end, 0");
    browser.click(&tab, &format!("#estimator-{other}"));
    browser.wait(
        &tab,
        &format!(
            "scope.store.latest('estimator') === {other} && scope.store.end > window.at + 0.2"
        ),
    );
    let after = largest_step(&mut browser, &tab);
    println!("force between two frames: at most {before} mN, with the change {after} mN");
    assert!(before > 0.0, "the force is that of a running board");
    assert!(after < before + 10.0, "{before} mN, {after} mN");

    // The hand lets go, and the keys move the handle too. A wall would throw the handle, and the firmware
    // would stop.
    select(&mut browser, &tab, "free-air");
    browser.wait(&tab, "Math.abs(scope.store.latest('force')) < 30");
    browser.mouse(&tab, "mouseReleased", 10.0, 10.0);
    browser.wait(&tab, "!Number.isFinite(scope.store.latest('hand_angle'))");
    browser.value(&tab, "$('device').focus()");
    browser.key(&tab, "ArrowLeft");
    browser.wait(&tab, "Number.isFinite(scope.store.latest('hand_angle'))");
    browser.key(&tab, "Escape");
    browser.wait(&tab, "!Number.isFinite(scope.store.latest('hand_angle'))");

    // A fault ends in the safe state, with its explanation.
    browser.click(&tab, "[data-fault=emergency-stop]");
    browser.wait(&tab, "scope.status.mode === 'safe' && /off after [0-9.]+ ms.*interlock.*Largest force/.test($('result').textContent)");
    browser.value(&tab, "$('fault-card').scrollIntoView()");
    browser.picture(&tab, "fault.png");

    assert_eq!(browser.complaints, [""; 0]);
    let own = [
        server.url(),
        format!("ws://127.0.0.1:{}/", server.port),
        "data:".to_owned(),
        "about:".to_owned(),
    ];
    let foreign = browser
        .requests
        .iter()
        .filter(|url| !own.iter().any(|own| url.starts_with(own)));
    assert_eq!(foreign.collect::<Vec<_>>(), [""; 0]);
}

#[test]
fn downloaded_recording_replays_to_the_estimates_of_the_page() {
    let Some((server, mut browser, tab)) = page() else {
        return;
    };
    run_scene(&mut browser, &tab, "free-air");
    browser.click(&tab, "#record");
    browser.wait(&tab, "scope.status.recording > 0");
    drag(&mut browser, &tab, 1.5, 30);
    browser.wait(&tab, "scope.status.recording > 1500");
    browser.click(&tab, "#record");
    browser.wait(
        &tab,
        "!$('csv').hidden && $('csv').getAttribute('href').includes('recording.csv')",
    );
    let path = browser.value(&tab, "$('csv').getAttribute('href')");
    let (status, answer) = get(server.port, path.as_str().expect("a path"), &[]);
    assert_eq!(status, 200);
    let (_, csv) = answer.split_once("\r\n\r\n").expect("a body");
    let csv = csv[csv.find("t,").expect("a header")..].to_owned();
    let recording = recordings::recording::Recording::parse(csv.as_bytes(), "recording.csv")
        .expect("a recording");
    let rows = recording.t.len();
    assert!(
        rows > 1500 && recording.trace.true_omega.is_some(),
        "{rows} rows"
    );

    let kinds: Vec<_> = catalogue::estimators::Kind::all()
        .iter()
        .filter(|kind| !kind.needs.edge)
        .collect();
    let replayed = experiments::replay::replay(
        &recording,
        "recording.csv",
        &kinds,
        &simulation::device::Device::default(),
        &catalogue::parameters::Parameters::default(),
        &|| (),
    );
    let estimates = replayed.expect("a replay").estimates;
    assert_eq!(estimates.len(), kinds.len());
    // The rows of the page with the truth of the recording: the page has all, from before to after.
    let truth = recording.trace.true_omega.as_ref().expect("the truth");
    // A shaft at rest is found in many places, one that moves in one.
    let moving = truth.iter().position(|omega| omega.abs() > 1.0);
    let moving = moving.expect("the motor moves");
    let begin = format!(
        "{:?}",
        truth[moving..moving + 50]
            .iter()
            .map(|omega| *omega as f32)
            .collect::<Vec<_>>()
    );
    let found = browser.value(&tab, &format!(
        "(() => {{ const s = scope.store, v = s.values[s.column.true_omega], want = new Float32Array({begin}); \
         for (let k = s.first; k < s.count; k++) if (want.every((w, j) => v[(k + j) % KEPT] === w)) return k; return -1; }})()"
    ));
    let found = found.as_i64().expect("a number") - moving as i64;
    assert!(found >= 0, "the recording is not on the page");
    for estimate in &estimates {
        let name = estimate.estimator;
        let shown = browser.value(
            &tab,
            &format!(
                "(() => {{ const s = scope.store, v = s.values[s.column['estimate:{name}']]; \
             return Array.from({{ length: {rows} }}, (_, j) => v[({found} + j) % KEPT]); }})()"
            ),
        );
        let shown: Vec<f32> = shown
            .as_array()
            .expect("numbers")
            .iter()
            .map(|v| v.as_f64().expect("a number") as f32)
            .collect();
        assert_eq!(shown, estimate.velocity, "{name}");
    }
    assert_eq!(browser.complaints, [""; 0]);
}

#[test]
fn second_tab_watches_and_a_page_connects_again_to_a_new_server() {
    let Some((server, mut browser, first)) = page() else {
        return;
    };
    let second = browser.open(&server.url(), 390, 844);
    browser.wait(&second, "scope.role?.commands === false && $('commands').disabled && !$('role').hidden && !$('take').hidden && scope.frames > 2");
    // The narrow page needs no horizontal scroll.
    browser.wait(&second, "document.documentElement.scrollWidth <= 390");
    let wide = "[...document.querySelectorAll('main *')].filter((e) => e.getBoundingClientRect().right > 391 && !e.closest('.u-legend, .uplot')).map((e) => e.id || e.className)";
    assert_eq!(browser.value(&second, wide), json!([]));
    run_scene(&mut browser, &first, "wall");
    browser.wait(
        &second,
        "scope.status.mode === 'running' && $('scene').selectedOptions[0].text === 'wall'",
    );
    browser.picture(&second, "narrow.png");
    // The page that commands is closed: the board is disarmed, and the other page takes over.
    browser.close(&first);
    browser.wait(&second, "scope.status.mode === 'boot'");
    browser.click(&second, "#take");
    ready(&mut browser, &second);

    let port = server.port;
    drop(server);
    browser.wait(&second, "!$('notice').hidden && $('commands').disabled");
    browser.value(&second, "window.old = true, 0");
    let image = image();
    let image = image.to_str().expect("a path in UTF-8");
    let _server = Server::start(&["--image", image, "--port", &port.to_string()]);
    // The new server has another token: the page loads itself again.
    browser.wait(
        &second,
        "window.old === undefined && document.readyState === 'complete'",
    );
    ready(&mut browser, &second);
    let unexpected: Vec<_> = browser
        .complaints
        .iter()
        .filter(|line| !line.contains("ERR_CONNECTION_REFUSED"))
        .collect();
    assert_eq!(unexpected, [""; 0]);
}
