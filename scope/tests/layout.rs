//! Layout and colours of the page in a real browser.

mod common;

use common::devtools::{Browser, Tab};
use common::page::page;
use serde_json::{Value, json};

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

/// Chooses so many estimators of the page.
fn choose(browser: &mut Browser, tab: &Tab, number: usize) {
    browser.value(tab, &format!(
        "(() => {{ $('more').open = true; [...$('others').querySelectorAll('input')].forEach((box, k) => \
         {{ if (box.checked !== k < {number}) box.click(); }}); }})()"
    ));
}

/// The visible series of each plot: plot, name, and colour with dash.
fn series(browser: &mut Browser, tab: &Tab) -> Vec<[String; 3]> {
    let list = browser.value(
        tab,
        "scope.plots.plots.flatMap(({ spec, plot }) => plot.series.slice(1).filter((s) => s.label && s.stroke() !== 'transparent') \
         .map((s) => [spec.id, s.label, s.stroke() + ' ' + JSON.stringify(s.dash ?? [])]))",
    );
    let text = |value: &Value| value.as_str().expect("a text").to_owned();
    let list = list.as_array().expect("series").iter();
    list.map(|row| [0, 1, 2].map(|column| text(&row[column])))
        .collect()
}

/// Relative luminance of a colour #rrggbb, as WCAG 2 defines it.
fn luminance(colour: &str) -> f64 {
    let channel = |at: usize| {
        let value = u8::from_str_radix(&colour[at..at + 2], 16).expect("#rrggbb");
        let value = f64::from(value) / 255.0;
        match value <= 0.04045 {
            true => value / 12.92,
            false => ((value + 0.055) / 1.055).powf(2.4),
        }
    };
    0.2126 * channel(1) + 0.7152 * channel(3) + 0.0722 * channel(5)
}

/// Contrast of two colours by WCAG 2, which asks for 3 for parts of figures.
fn contrast(one: &str, other: &str) -> f64 {
    let [a, b] = [luminance(one), luminance(other)].map(|luminance| luminance + 0.05);
    a.max(b) / a.min(b)
}

#[test]
fn series_of_a_plot_have_colours_of_their_own_that_stand_out_from_both_backgrounds() {
    let Some((_server, mut browser, tab)) = page() else {
        return;
    };
    for (scheme, card) in [("light", "#ffffff"), ("dark", "#1d2226")] {
        let media = json!({"features": [{"name": "prefers-color-scheme", "value": scheme}]});
        browser.tell(&tab, "Emulation.setEmulatedMedia", &media);
        browser.wait(
            &tab,
            &format!("getComputedStyle(document.documentElement).getPropertyValue('--card').trim() === '{card}' \
                      && scope.plots.plots[0].plot.axes[0].stroke() === getComputedStyle(document.documentElement).getPropertyValue('--muted').trim()"),
        );
        for number in [8, 99] {
            choose(&mut browser, &tab, number);
            let list = series(&mut browser, &tab);
            for [plot, name, style] in &list {
                let (colour, _) = style.split_once(' ').expect("a colour");
                let contrast = contrast(colour, card);
                assert!(
                    contrast >= 3.0,
                    "{scheme}: {plot}: {name}: {colour}: {contrast:.2}"
                );
                let is_same = |other: &&[String; 3]| {
                    let same = match number {
                        8 => other[2].split_once(' ').map(|it| it.0) == Some(colour),
                        _ => other[2] == *style,
                    };
                    other[0] == *plot && other[1] != *name && same
                };
                let other = list.iter().find(is_same);
                assert!(
                    other.is_none(),
                    "{scheme}: {plot}: {name} and {other:?}: {style}"
                );
            }
        }
        browser.picture(&tab, &format!("colours-{scheme}.png"));
    }
    // The mark beside its name has the colour of the line.
    let marks = browser.value(
        &tab,
        "(() => { const list = [...$('others').querySelectorAll('label')]; const { plot } = scope.plots.plots[0]; \
         const probe = document.createElement('i'); document.body.append(probe); \
         return list.filter((label) => { const s = plot.series.find((s) => s.label === label.textContent); \
         probe.style.color = s.stroke(); return getComputedStyle(label.querySelector('i')).backgroundColor !== getComputedStyle(probe).color; }) \
         .map((label) => label.textContent); })()",
    );
    assert_eq!(marks, json!([]));
    assert_eq!(browser.complaints, [""; 0]);
}
