//! The tables of the pages for the maintainers of other projects.

mod statements;

use std::path::Path;
use std::sync::LazyLock;

use catalogue::estimators::Kind;
use catalogue::parameters::Parameters;
use experiments::distinct::distinct;
use experiments::real::cases::{Case, Recordings};
use experiments::real::peers::{self, PEERS, PLL, Peer};
use experiments::real::pool::{mean, on};
use experiments::real::run::{Row, Settings};
use experiments::real::sources::Role;
use measured::Table;
use measured::tables::{
    EVIDENCE_COST, EVIDENCE_DVRK, EVIDENCE_MOTEUS, EVIDENCE_ODRIVE, EVIDENCE_OPENFFBOARD,
    EVIDENCE_SIMPLEFOC, EVIDENCE_VESC, PARETO,
};
use simulation::device::Device;

use crate::{cell, check};

/// Rate of the ticks at which all velocities are scored, Hz.
const TICKS_HZ: f64 = 1000.0;

/// A page.
struct Project {
    table: Table,
    /// What the names of its peers begin with.
    peers: &'static str,
    /// Resolutions: that of the other pages, then the default of the project, if it has one.
    counts_per_rev: &'static [u32],
    /// The rate at which estimators of this project run in addition to that of the ticks, Hz.
    rate_hz: Option<f64>,
    /// Whether the project has edge time stamps.
    edges: bool,
}

const PROJECTS: [Project; 6] = [
    Project {
        table: EVIDENCE_MOTEUS,
        peers: "peer:moteus",
        counts_per_rev: &[4096, 16_384],
        rate_hz: Some(30_000.0),
        edges: false,
    },
    Project {
        table: EVIDENCE_ODRIVE,
        peers: "peer:odrive",
        counts_per_rev: &[4096, 8192],
        rate_hz: Some(8000.0),
        edges: false,
    },
    Project {
        table: EVIDENCE_VESC,
        peers: "peer:vesc",
        counts_per_rev: &[4096, 8192],
        rate_hz: Some(12_500.0),
        edges: false,
    },
    Project {
        table: EVIDENCE_SIMPLEFOC,
        peers: "peer:simplefoc",
        counts_per_rev: &[4096],
        rate_hz: None,
        edges: true,
    },
    Project {
        table: EVIDENCE_OPENFFBOARD,
        peers: "peer:openffboard",
        counts_per_rev: &[4096, 10_000],
        rate_hz: None,
        edges: false,
    },
    Project {
        table: EVIDENCE_DVRK,
        peers: "peer:dvrk",
        counts_per_rev: &[4096],
        rate_hz: None,
        edges: true,
    },
];

/// Estimators of this project that read counts alone, as shipped, and those with edge time stamps.
const COUNTS: [&str; 5] = [
    "finite-difference",
    "imm",
    "imm-pair",
    "kalman-triple-steady",
    "pll",
];
const EDGES: [&str; 2] = ["imm-edge", "m-over-t"];

/// A line of a table: name, resolution, rate, values of the parameters, rows of the runs.
struct Line {
    name: &'static str,
    counts_per_rev: u32,
    rate_hz: f64,
    parameters: String,
    rows: Vec<Row>,
}

static RECORDINGS: LazyLock<Recordings> = LazyLock::new(|| {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../tests/data/real");
    Recordings::read(Path::new(folder), &Device::default(), 10.0).expect("the shipped recordings")
});

fn settings(project: &Project) -> Settings {
    let edges = if project.edges { &EDGES[..] } else { &[] };
    let names = COUNTS.iter().chain(edges);
    Settings {
        estimators: names.map(|name| Kind::named(name).expect(name)).collect(),
        parameters: Parameters::default(),
        device: Device::default(),
        counts_per_rev: project.counts_per_rev.to_vec(),
        rates_hz: vec![TICKS_HZ],
        // As `cargo sim real`.
        phases: vec![0.37, 0.81],
        seconds: 10.0,
    }
}

fn lines(project: &Project) -> Vec<Line> {
    let settings = settings(project);
    let cases = RECORDINGS.cases(&settings);
    let rates: Vec<f64> = [Some(TICKS_HZ), project.rate_hz]
        .into_iter()
        .flatten()
        .collect();
    let theirs = PEERS
        .iter()
        .filter(|peer| peer.name.starts_with(project.peers));
    let theirs: Vec<Peer> = theirs.copied().collect();
    let ours = |rate_hz: f64| PLL.at(Some(rate_hz));
    let own: Vec<(f64, Vec<Row>)> = rates
        .iter()
        .map(|rate| {
            let rows = peers::ours_at(&RECORDINGS, &cases, &settings, *rate);
            (*rate, rows.expect("estimators run"))
        })
        .collect();
    let mut lines = Vec::new();
    for &counts_per_rev in project.counts_per_rev {
        let at = |case: &&Case| case.counts_per_rev == counts_per_rev;
        let cases: Vec<Case> = cases.iter().filter(at).cloned().collect();
        let mut add = |peer: &Peer, rate_hz: f64, has_default: bool| {
            let peers = [*peer];
            let tuned = peers::tune(&RECORDINGS, &cases, &settings, &peers).expect("peers run");
            let rows = peers::rows(&RECORDINGS, &cases, &settings, &peers, &tuned);
            let rows = rows.expect("peers run");
            let shown = |values: Vec<f64>| {
                if values.is_empty() {
                    return "none".to_owned();
                }
                let named = peer.parameters.iter().zip(values);
                let named: Vec<_> = named
                    .map(|(one, value)| format!("{} {value}", one.name))
                    .collect();
                named.join("; ")
            };
            let defaults = has_default.then(|| (peer.name, shown(peer.defaults())));
            let tuned = tuned
                .first()
                .map(|one| (peer.tuned, shown(one.values.clone())));
            for (name, parameters) in [defaults, tuned].into_iter().flatten() {
                lines.push(Line {
                    name,
                    counts_per_rev,
                    rate_hz,
                    parameters,
                    rows: rows
                        .iter()
                        .filter(|row| row.estimator == name)
                        .cloned()
                        .collect(),
                });
            }
        };
        for peer in &theirs {
            add(peer, peer.rate_hz.unwrap_or(TICKS_HZ), true);
        }
        for rate_hz in &rates {
            add(&ours(*rate_hz), *rate_hz, false);
        }
        for (rate_hz, rows) in &own {
            for kind in &settings.estimators {
                // At a higher rate the difference of two counts is no reference.
                if kind.name == "finite-difference" && *rate_hz != TICKS_HZ {
                    continue;
                }
                let of =
                    |row: &&Row| row.estimator == kind.name && row.counts_per_rev == counts_per_rev;
                lines.push(Line {
                    name: kind.name,
                    counts_per_rev,
                    rate_hz: *rate_hz,
                    parameters: "as shipped".to_owned(),
                    rows: rows.iter().filter(of).cloned().collect(),
                });
            }
        }
    }
    lines
}

/// Instructions of an update and bytes of state, from the tables of the emulated board.
fn cost(name: &str) -> [String; 2] {
    let name = name.strip_suffix("-tuned").unwrap_or(name);
    let rows = [PARETO, EVIDENCE_COST].map(|table| table.read().expect("a table"));
    let found = rows
        .iter()
        .flatten()
        .find(|row| row.text("estimator") == Ok(name));
    let row = found.unwrap_or_else(|| panic!("{name} is in no table of run time"));
    ["mean_3", "state"].map(|column| row.text(column).expect(column).to_owned())
}

/// The recordings of fine encoders that judge.
fn judging() -> Vec<&'static str> {
    let fine = |name: &&str| !name.starts_with("20");
    let sources = RECORDINGS.sources().filter(|one| one.role == Role::Judges);
    sources.map(|one| one.name()).filter(fine).collect()
}

fn cells(line: &Line, recordings: &[&str]) -> Vec<String> {
    let shown = |figure: Option<f64>| figure.map_or_else(|| "-".to_owned(), cell);
    let each = recordings
        .iter()
        .map(|name| on(line.rows.iter(), name, line.name));
    let each: Vec<_> = each.collect();
    let pooled = mean(&each.iter().flatten().copied().collect::<Vec<_>>());
    let rest = pooled.moving_at_rest.map(|share| 100.0 * share);
    let figures = [
        pooled.rms_pct,
        pooled.rms_rad_s,
        pooled.p99_pct,
        pooled.p99_rad_s,
        pooled.delay_ms,
        rest,
    ];
    let head = [
        line.name.to_owned(),
        line.counts_per_rev.to_string(),
        (1e-3 * line.rate_hz).to_string(),
        line.parameters.clone(),
    ];
    let each = each
        .iter()
        .map(|score| shown(score.and_then(|score| score.rms_pct)));
    head.into_iter()
        .chain(figures.map(shown))
        .chain(cost(line.name))
        .chain(each)
        .collect()
}

/// Measures the table of a page.
fn measure(project: &Project) {
    let recordings = judging();
    assert_eq!(recordings.len(), 4);
    let rows: Vec<_> = lines(project)
        .iter()
        .map(|line| cells(line, &recordings))
        .collect();
    check(&project.table, &recordings, &rows);
}

#[test]
fn evidence_of_every_project() {
    let names = distinct(PROJECTS.iter().map(|project| project.peers));
    let has_page = |peer: &Peer| names.iter().any(|name| peer.name.starts_with(name));
    assert!(PEERS.iter().all(has_page));
    PROJECTS.iter().for_each(measure);
}
