//! The page of a board in a browser.

use super::Server;
use super::devtools::{Browser, Tab};

/// A page that commands the emulated board of a server; `None` without a browser.
pub(crate) fn page() -> Option<(Server, Browser, Tab)> {
    let server = Server::emulated();
    let mut browser = Browser::start()?;
    let tab = browser.open(&server.url(), 1300, 900);
    ready(&mut browser, &tab);
    Some((server, browser, tab))
}

/// The page is loaded, and this page commands a board that sends frames.
pub(crate) fn ready(browser: &mut Browser, tab: &Tab) {
    browser.wait(
        tab,
        "scope.role?.commands === true && scope.status?.mode === 'boot' && scope.frames > 2",
    );
}

/// Arms the board and selects the scene of this name.
pub(crate) fn run_scene(browser: &mut Browser, tab: &Tab, name: &str) {
    browser.click(tab, "#arm");
    browser.wait(tab, "scope.status.mode === 'armed'");
    select(browser, tab, name);
    browser.wait(tab, "scope.status.mode === 'running'");
}

/// Selects the scene of this name.
pub(crate) fn select(browser: &mut Browser, tab: &Tab, name: &str) {
    browser.value(tab, &format!(
        "(() => {{ const s = $('scene'); s.value = [...s.options].find((o) => o.text === '{name}').value; s.onchange(); }})()"
    ));
}

/// Presses the mouse on the handle, and moves it by this angle around its axis, rad.
pub(crate) fn drag(browser: &mut Browser, tab: &Tab, by: f64, steps: u32) {
    let place = browser.value(
        tab,
        "(() => { const b = $('device').getBoundingClientRect(), g = scope.view.geometry(); \
        return [b.left + g.x, b.top + g.y, g.radius, scope.store.latest('handle_angle')]; })()",
    );
    let number = |k: usize| place[k].as_f64().expect("a number");
    let (x, y, radius, from) = (number(0), number(1), number(2), number(3));
    let at = |angle: f64| {
        (
            x + 0.9 * radius * angle.sin(),
            y - 0.9 * radius * angle.cos(),
        )
    };
    let (px, py) = at(from);
    browser.mouse(tab, "mousePressed", px, py);
    for step in 1..=steps {
        let (px, py) = at(from + by * f64::from(step) / f64::from(steps));
        browser.mouse(tab, "mouseMoved", px, py);
    }
}
