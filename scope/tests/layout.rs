//! Layout of the page in a real browser.

mod common;

use common::page::page;
use serde_json::json;

/// Widths of the page, CSS pixels: a window of 1280 pixels at 100, 150, 200 and 400 %, and narrow windows.
const WIDTHS: [u32; 6] = [1280, 853, 640, 480, 320, 280];

/// Parts of the page that are wider than the window or reach out of it.
const TOO_WIDE: &str = "(() => { const w = document.documentElement.clientWidth; \
    const out = [...document.body.querySelectorAll('*')].filter((e) => e.getClientRects().length \
    && !e.closest('.u-over, .u-under, canvas') && e.getBoundingClientRect().right > w + 0.5); \
    return document.documentElement.scrollWidth > w || out.length ? \
    [document.documentElement.scrollWidth, ...out.map((e) => e.id || e.className || e.tagName)] : null; })()";

#[test]
fn zoomed_page_and_narrow_window_need_no_horizontal_scrolling() {
    let Some((_server, mut browser, tab)) = page() else {
        return;
    };
    // Everything that can be opened, and a long line of a procedure.
    browser.value(
        &tab,
        "(() => { for (const d of document.querySelectorAll('details')) d.open = true; \
         $('guide').textContent = 'FAIL  ' + 'a_word_without_a_space'.repeat(9); \
         $('notice').hidden = false; $('notice').textContent = 'tcp:127.0.0.1:12345/'.repeat(9); })()",
    );
    for width in WIDTHS {
        let size = json!({"width": width, "height": 700, "deviceScaleFactor": 2, "mobile": false});
        browser.tell(&tab, "Emulation.setDeviceMetricsOverride", &size);
        browser.wait(
            &tab,
            &format!("innerWidth === {width} && scope.plots.plots.every(({{ plot, card }}) => plot.width <= card.clientWidth)"),
        );
        let wide = browser.value(&tab, TOO_WIDE);
        assert!(wide.is_null(), "{width}: {wide}");
        let apart = browser.value(
            &tab,
            "(() => { const { x, radius, motor, coupler } = scope.view.geometry(); \
             return motor.x >= motor.radius && motor.x + motor.radius < coupler.x - coupler.radius \
             && coupler.x + coupler.radius < x - radius && x + radius < scope.view.width; })()",
        );
        assert_eq!(apart, true, "parts of the drawing at {width}");
        if [853, 640, 320].contains(&width) {
            browser.picture(&tab, &format!("width-{width}.png"));
        }
    }
    assert_eq!(browser.complaints, [""; 0]);
}
