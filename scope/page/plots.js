// The plots: what each one shows, and their common window.

// The colours of series: --s0 is that of the estimate in charge, the others are for those that are chosen. From the
// second round on the lines are dashed.
const COLOURS = 10, DASHES = [[], [10, 5], [2, 3], [8, 3, 2, 3]];

function plotList(facts, store, chosen) {
  const at = (name) => { const values = store.values[store.column[name]]; return (k) => values[k]; };
  const times = (name, factor) => { const get = at(name); return (k) => get(k) * factor; };
  const truth = at("true_omega"), { weber, floor, mn_per_rad_s: force } = facts.interval;
  const edge = (side) => (k) => truth(k) + side * (weber * Math.abs(truth(k)) + floor);
  const error = (name) => { const get = at(name); return (k) => (get(k) - truth(k)) * force; };
  const others = facts.estimators.filter((e) => chosen.has(e.name))
    .map((e) => ({ name: e.name, colour: chosenColour(chosen.get(e.name)), dash: chosenDash(chosen.get(e.name)) }));
  const line = (label, colour, get, more) => ({ label, colour, get, ...more });
  const { kind } = facts.source, has = kind === "emulated";
  // What a simulation alone knows, or a recording may have.
  const known = (is, ...lines) => (is ? lines : []);
  const limit = facts.device.threshold_mn;
  const list = [
    { id: "velocity", title: "Velocity of the large motor, rad/s", height: 230, least: 0.1, series: [
      ...known(kind !== "board", line("interval", "--band", edge(1), { edge: true }), line("", "--band", edge(-1), { edge: true })),
      ...others.map((e) => line(e.name, e.colour, at("estimate:" + e.name), { dash: e.dash })),
      line("in charge", "--s0", at("velocity_large"), { width: 1.6 }),
      ...known(kind !== "board", line("true", "--ink", truth, { width: 1.6 })),
    ] },
    { id: "error", title: `Force of each estimator's error through the coupler, mN (a fingertip notices ${limit} mN)`, height: 170, least: 1, hidden: kind === "board", mark: limit, series: [
      ...others.map((e) => line(e.name, e.colour, error("estimate:" + e.name), { dash: e.dash })),
      line("in charge", "--s0", error("velocity_large"), { width: 1.6 }),
    ] },
    { id: "force", title: "Force at the fingertip, mN", height: 170, least: 1, hidden: kind === "board", mark: limit, series: [
      line(has ? "felt" : "of the torque wanted", "--s1", at("force"), { width: 1.6 }),
      ...known(has, line("parasitic", "--s0", at("parasitic")), line("50–500 Hz RMS", "--s3", at("tactile"))),
    ] },
    { id: "torque", title: "Torque on the handle, mN·m", height: 150, least: 0.1, series: [
      line("wanted", "--ink", times("torque", 1e3)), ...known(has, line("felt", "--s1", times("felt", 1e3))),
    ] },
    { id: "current", title: "Currents, A", height: 150, least: 0.01, series: [
      line("large commanded", "--s4", at("current")), ...known(has, line("large", "--s0", at("current_large_true"))),
      line("small commanded", "--s2", at("current_small")), ...known(has, line("small", "--s1", at("current_small_true"))),
    ] },
    { id: "cost", title: has ? "Instructions per control tick, most of a frame" : "Cycles of the longest control tick", height: 120, least: 10, series: [
      line(has ? "instructions" : "cycles", "--s3", at(has ? "instructions" : "cycles")),
    ] },
  ];
  return list.filter((plot) => !plot.hidden);
}

function chosenColour(place) { return `--s${1 + (place % (COLOURS - 1))}`; }
function chosenDash(place) { return DASHES[Math.floor(place / (COLOURS - 1)) % DASHES.length]; }

class Plots {
  constructor(host, facts, store) {
    this.host = host; this.facts = facts; this.store = store;
    // The estimators that are shown, each with its place among the colours.
    this.chosen = new Map([["finite-difference", 0]]);
    this.seconds = 5; this.range = null; this.plots = []; this.frames = 0;
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.build());
    new ResizeObserver(() => this.resize()).observe(host);
    this.build();
  }

  // Shows an estimator in the first colour that is free, or shows it no more.
  choose(name, is) {
    const taken = new Set(this.chosen.values());
    let place = 0;
    while (taken.has(place)) place++;
    if (is) this.chosen.set(name, place); else this.chosen.delete(name);
    this.build();
  }

  // The colour of an estimator that is shown, as a value of CSS; "" of another one.
  colour(name) { return this.chosen.has(name) ? `var(${chosenColour(this.chosen.get(name))})` : ""; }

  // Pauses at the present window, or at a zoomed one; `null` follows the board again.
  hold(range) { this.range = range; this.changed?.(); }
  get shown() { return this.range ?? [this.store.end - this.seconds, this.store.end]; }

  build() {
    const style = getComputedStyle(document.documentElement);
    const ink = (colour) => (colour.startsWith("--") ? style.getPropertyValue(colour).trim() : colour);
    for (const { plot } of this.plots) plot.destroy();
    this.host.replaceChildren();
    this.plots = plotList(this.facts, this.store, this.chosen).map((spec) => {
      const card = document.createElement("div");
      card.className = spec.series[0].edge ? "card plot banded" : "card plot";
      card.id = "plot-" + spec.id;
      const title = document.createElement("h2");
      title.textContent = spec.title;
      card.append(title);
      this.host.append(card);
      const axis = { stroke: ink("--muted"), grid: { stroke: ink("--grid"), width: 1 }, ticks: { stroke: ink("--grid"), width: 1 } };
      const digits = (_, value) => (value == null ? "–" : value.toPrecision(4));
      const series = spec.series.map((s) => ({
        label: s.label, stroke: s.edge ? "transparent" : ink(s.colour), width: s.width ?? 1, dash: s.dash,
        points: { show: false }, value: digits, spanGaps: false,
      }));
      const bands = spec.series[0].edge ? [{ series: [1, 2], fill: ink("--band") }] : [];
      const plot = new uPlot({
        width: this.width(card), height: spec.height,
        scales: { x: { time: false }, y: { range: (_, low, high) => span(low, high, spec) } },
        axes: [{ ...axis, size: 28 }, { ...axis, size: axisSize }],
        series: [{ label: "t", value: (_, t) => (t == null ? "–" : t.toFixed(3) + " s") }, ...series], bands,
        legend: { live: true }, cursor: { sync: { key: "scope" }, drag: { x: true, y: false, setScale: false } },
        hooks: {
          setSelect: [(u) => {
            if (u.select.width > 4) this.hold([u.posToVal(u.select.left, "x"), u.posToVal(u.select.left + u.select.width, "x")]);
            u.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
          }],
          draw: [(u) => { if (spec.mark) marks(u, spec.mark, ink("--good")); }],
        },
      }, spec.series.map(() => []).concat([[]]), card);
      plot.over.addEventListener("dblclick", () => this.hold(null));
      return { spec, plot, card };
    });
    this.drawn = null;
  }

  width(card) { return Math.max(200, Math.floor(card.clientWidth - 28)); }

  resize() {
    for (const { plot, card, spec } of this.plots) {
      const width = this.width(card);
      if (width !== plot.width) plot.setSize({ width, height: spec.height });
    }
    this.drawn = null;
  }

  draw() {
    const [from, to] = this.shown;
    const state = `${from} ${to} ${this.store.version}`;
    if (state === this.drawn || !this.store.count) return;
    this.drawn = state;
    const visible = this.plots.filter(({ card }) => isVisible(card));
    for (const { spec, plot } of visible) {
      const data = this.store.decimate(spec.series.map((s) => s.get), from, to, Math.max(100, plot.width / 2));
      plot.batch(() => { plot.setData(data, false); plot.setScale("x", { min: from, max: to }); });
    }
  }
}

function isVisible(card) {
  const { top, bottom } = card.getBoundingClientRect();
  return bottom > 0 && top < innerHeight;
}

// The range of an axis: not below the mark to both sides, so that small noise looks small, and with the least
// space around what is constant.
function span(low, high, { mark, least }) {
  if (low == null || high == null) return mark ? [-mark * 1.3, mark * 1.3] : [-1, 1];
  if (mark) { low = Math.min(low, -mark * 1.3); high = Math.max(high, mark * 1.3); }
  const pad = Math.max((high - low) * 0.06, Math.abs(high) * 1e-3, least);
  return [low - pad, high + pad];
}

// The width of an axis: that of its longest label, and not below that of four digits, so that plots stay aligned.
function axisSize(u, values, number, cycle) {
  const axis = u.axes[number], least = 54;
  // The width decides on the labels: it is computed once.
  if (cycle > 1) return axis._size;
  const [font] = axis.font;
  u.ctx.font = font;
  const widths = (values ?? []).map((text) => u.ctx.measureText(text ?? "").width / devicePixelRatio);
  return Math.ceil(Math.max(least, axis.ticks.size + axis.gap + Math.max(0, ...widths)));
}

function marks(u, mark, colour) {
  const { ctx, bbox } = u;
  ctx.save();
  ctx.strokeStyle = colour;
  ctx.setLineDash([6, 5]);
  for (const value of [mark, -mark]) {
    const y = Math.round(u.valToPos(value, "y", true)) + 0.5;
    ctx.beginPath(); ctx.moveTo(bbox.left, y); ctx.lineTo(bbox.left + bbox.width, y); ctx.stroke();
  }
  ctx.restore();
}
