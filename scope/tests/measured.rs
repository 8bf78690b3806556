//! Figures of the live page, printed and not judged, because they are those of a machine:
//! `cargo test --release -p scope --test measured -- --ignored --nocapture`. `MINUTES=60` watches the memory for
//! an hour.

mod common;

use std::fs;
use std::thread::sleep;
use std::time::{Duration, Instant};

use common::page::page;
use serde_json::json;

/// Time for the frames.
const FRAMES: Duration = Duration::from_secs(10);
/// Variable of the environment with the minutes for the memory, and its default.
const MINUTES: (&str, u32) = ("MINUTES", 2);
/// Ticks of a second in `/proc`.
const TICKS: f64 = 100.0;

/// Processor time of each thread of a process, s.
fn threads(id: u32) -> Vec<(String, f64)> {
    let tasks = fs::read_dir(format!("/proc/{id}/task")).expect("the process runs");
    let of = |task: fs::DirEntry| {
        let text = fs::read_to_string(task.path().join("stat")).ok()?;
        let (head, rest) = text.rsplit_once(')')?;
        let fields: Vec<&str> = rest.split_whitespace().collect();
        let ticks = fields.get(11)?.parse::<f64>().ok()? + fields.get(12)?.parse::<f64>().ok()?;
        Some((head.split_once('(')?.1.to_owned(), ticks / TICKS))
    };
    tasks.filter_map(|task| of(task.ok()?)).collect()
}

/// Memory of a process, MB.
fn memory(id: u32) -> f64 {
    let text = fs::read_to_string(format!("/proc/{id}/status")).expect("the process runs");
    let line = text
        .lines()
        .find(|line| line.starts_with("VmRSS"))
        .expect("a line");
    line.split_whitespace()
        .nth(1)
        .and_then(|kb| kb.parse::<f64>().ok())
        .expect("kB")
        / 1e3
}

#[test]
#[ignore = "measures for minutes"]
fn frames_latency_processor_and_memory() {
    let Some((server, mut browser, tab)) = page() else {
        return;
    };
    let id = server.child.id();
    browser.value(&tab, "scope.link.send({ do: 'arm' }), 0");
    browser.wait(&tab, "scope.status.mode === 'armed'");
    browser.value(&tab, "scope.link.send({ do: 'scene', number: 1 }), 0");
    browser.wait(&tab, "scope.status.mode === 'running'");
    let before = threads(id);
    let (start, frames) = (Instant::now(), browser.value(&tab, "scope.frames").as_f64());
    let from = browser.value(&tab, "scope.store.end").as_f64();
    sleep(FRAMES);
    let (end, seconds) = (
        browser.value(&tab, "scope.frames").as_f64(),
        start.elapsed().as_secs_f64(),
    );
    let to = browser.value(&tab, "scope.store.end").as_f64();
    let rate =
        |from: Option<f64>, to: Option<f64>| to.zip(from).map(|(to, from)| (to - from) / seconds);
    println!(
        "{:.1} frames/s over {seconds:.1} s",
        rate(frames, end).unwrap_or_default()
    );
    println!("{:.2} of real time", rate(from, to).unwrap_or_default());
    for (name, after) in threads(id) {
        let first = before
            .iter()
            .find(|(other, _)| *other == name)
            .map_or(0.0, |(_, s)| *s);
        println!("thread {name}: {:.2} of a core", (after - first) / seconds);
    }
    // The handle is moved again and again; the page measures until a drawn row has it.
    let place = browser.value(&tab, "(() => { const b = $('device').getBoundingClientRect(), g = scope.view.geometry(); return [b.left + g.x, b.top + g.y - g.radius]; })()");
    let (x, y) = (place[0].as_f64().expect("x"), place[1].as_f64().expect("y"));
    browser.mouse(&tab, "mousePressed", x, y);
    for step in 0..40 {
        sleep(Duration::from_millis(150));
        browser.mouse(&tab, "mouseMoved", x + 6.0 * f64::from(step % 5), y);
    }
    let latency = browser.value(&tab, "[...scope.view.latency].sort((a, b) => a - b)");
    let latency: Vec<f64> = latency
        .as_array()
        .expect("numbers")
        .iter()
        .filter_map(serde_json::Value::as_f64)
        .collect();
    let at = |share: f64| {
        latency
            .get((share * latency.len() as f64) as usize)
            .copied()
            .unwrap_or(f64::NAN)
    };
    println!(
        "mouse to drawn force: {} times, median {:.0} ms, 90 % {:.0} ms",
        latency.len(),
        at(0.5),
        at(0.9)
    );
    let minutes = std::env::var(MINUTES.0).map_or(MINUTES.1, |text| text.parse().expect(MINUTES.0));
    let (since, time) = (Instant::now(), 60 * Duration::from_secs(minutes.into()));
    for _ in 0..=6 {
        browser.tell(&tab, "HeapProfiler.collectGarbage", &json!({}));
        let page = browser.value(&tab, "performance.memory.usedJSHeapSize / 1e6");
        println!(
            "memory after {:.0} s: server {:.1} MB, scripts of the page {:.1} MB",
            since.elapsed().as_secs_f64(),
            memory(id),
            page.as_f64().unwrap_or(f64::NAN)
        );
        // What the browser tells is read, so that it does not wait in the browser.
        let part = Instant::now();
        while part.elapsed() < time / 6 {
            sleep(Duration::from_millis(200));
            browser.value(&tab, "0");
        }
    }
}
