// The controls: made from the facts of the source, set from its status.

const $ = (id) => document.getElementById(id);

// Time after an edit in which a slider keeps its value: the answer of the board comes within it.
const EDITED_MS = 1000;

class Controls {
  constructor(facts, link, view, plots) {
    Object.assign(this, { facts, link, view, plots, pending: new Map(), edited: new Map(), tuned: {}, sliders: [], scene: null });
    const { source } = facts;
    $("source").textContent = `${source.title}: ${source.text}`;
    $("source").title = source.from;
    $("footer").textContent = `Hand: a spring of ${facts.hand.stiffness} N·m/rad and a damper of ${facts.hand.damping} N·m·s/rad between the handle and a target, which is followed at ${facts.hand.following} 1/s and at most ${facts.hand.fastest} rad/s. A positive force pushes the hand clockwise. Source: ${source.from}`;
    const isRecorded = source.kind === "recorded";
    $("commands").hidden = $("record-card").hidden = isRecorded;
    $("transport").hidden = !isRecorded;
    $("fault-card").hidden = !facts.faults.length;
    // A board does not report the force.
    $("force").parentElement.hidden = $("meter").hidden = source.kind === "board";
    $("hint").hidden = $("restart").hidden = source.kind !== "emulated";
    this.makeScenes(); this.makeEstimators(); this.makeFaults(); this.makeOthers(); this.makeTransport();
    this.makePlotBar();
  }

  on(id, event, handler) { $(id)["on" + event] = handler; }

  makeScenes() {
    const { scenes } = this.facts;
    $("scene").replaceChildren(...scenes.map((s) => new Option(s.name, s.number)));
    this.on("scene", "change", () => {
      this.pending.clear();
      this.link.send({ do: "scene", number: Number($("scene").value) });
      this.showScene(Number($("scene").value));
    });
    this.on("arm", "click", () => this.link.send({ do: "arm" }));
    this.on("disarm", "click", () => this.link.send({ do: "disarm" }));
    this.on("restart", "click", () => this.link.send({ do: "restart" }));
    this.on("take", "click", () => this.link.join());
    this.on("record", "click", () => this.link.send({ do: "record", on: $("record").textContent === "Record" }));
    for (const kind of ["csv", "mcap"]) $(kind).href = `/recording.${kind}?token=${TOKEN}`;
  }

  showScene(number) {
    if (this.scene === number) return;
    this.scene = number;
    const scene = this.facts.scenes[number];
    $("scene").value = number;
    $("summary").textContent = scene.summary;
    this.sliders = [];
    $("parameters").replaceChildren(...scene.parameters.map((p, k) => {
      const key = `${number}.${k}`;
      const label = document.createElement("label"), name = document.createElement("span");
      const out = document.createElement("output"), input = document.createElement("input");
      label.className = "parameter";
      name.textContent = p.name;
      input.type = "range"; input.min = p.least; input.max = p.most; input.step = "any";
      input.id = `parameter-${p.name}`;
      // The label names its first control, which is the output.
      input.setAttribute("aria-label", `${p.name} of ${scene.name}`);
      const show = (v) => {
        const text = `${Number(v).toPrecision(3)} ${p.unit}`.trim();
        if (out.textContent === text) return;
        out.textContent = text;
        input.setAttribute("aria-valuetext", text);
      };
      // What the board has, but for a value that is on its way there.
      const follow = () => {
        if (performance.now() - (this.edited.get(key) ?? -Infinity) < EDITED_MS) return;
        const value = this.value(number, k);
        if (input.value !== String(value)) input.value = value;
        show(value);
      };
      follow();
      this.sliders.push(follow);
      input.oninput = () => {
        // An f32 within the bounds, as the firmware compares.
        const set = Math.min(p.most, Math.max(p.least, Math.fround(Number(input.value))));
        const sent = p.unit === "" ? Math.round(set) : set;
        this.edited.set(key, performance.now()); show(sent);
        this.pending.set(key, { do: "tune", scene: number, parameter: k, value: sent });
      };
      // A key moves by a hundredth, which `step=any` does not.
      input.onkeydown = (e) => {
        const by = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 }[e.key];
        if (!by) return;
        e.preventDefault(); input.value = Number(input.value) + (by * (p.most - p.least)) / 100; input.oninput();
      };
      label.append(name, out, input);
      return label;
    }));
    this.wall();
  }

  // The value of a parameter on the board: as set, or as after a start.
  value(scene, k) {
    const { usual, least } = this.facts.scenes[scene].parameters[k];
    return this.tuned[`${scene}.${k}`] ?? usual ?? least;
  }

  // Where the drawing has a wall.
  wall() {
    const scene = this.facts.scenes[this.scene];
    const k = scene.parameters.findIndex((p) => p.name === "position");
    this.view.wall = scene.name === "wall" && k >= 0 ? this.value(this.scene, k) : null;
  }

  makeEstimators() {
    $("estimators").replaceChildren(...this.facts.image_estimators.map((name, number) => {
      const button = document.createElement("button");
      button.type = "button"; button.textContent = name; button.setAttribute("role", "radio");
      button.setAttribute("aria-checked", "false"); button.id = `estimator-${number}`;
      button.onclick = () => this.link.send({ do: "estimator", number });
      return button;
    }));
    // As in a group of radio buttons: an arrow key goes to the next one and chooses it.
    $("estimators").onkeydown = (e) => {
      const by = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[e.key];
      const buttons = [...$("estimators").children], from = buttons.indexOf(e.target);
      if (!by || from < 0) return;
      e.preventDefault();
      const next = buttons[(from + by + buttons.length) % buttons.length];
      next.focus(); next.click();
    };
  }

  makeFaults() {
    $("faults").replaceChildren(...this.facts.faults.map(([name, what]) => {
      const button = document.createElement("button");
      button.type = "button"; button.textContent = what; button.title = name; button.dataset.fault = name;
      button.onclick = () => this.link.send({ do: "fault", name });
      return button;
    }));
  }

  makeOthers() {
    $("others").replaceChildren(...this.facts.estimators.map((e) => {
      const label = document.createElement("label"), box = document.createElement("input"), mark = document.createElement("i");
      box.type = "checkbox"; box.checked = this.plots.chosen.has(e.name); box.dataset.estimator = e.name;
      const paint = () => { mark.style.background = this.plots.colour(e.name); };
      paint();
      label.title = e.summary;
      box.onchange = () => { this.plots.choose(e.name, box.checked); paint(); };
      label.append(box, mark, e.name);
      return label;
    }));
  }

  makeTransport() {
    const { source } = this.facts;
    if (source.kind !== "recorded") return;
    $("seek").min = source.begin; $("seek").max = source.end;
    this.on("play", "click", () => this.link.send({ do: "play", on: $("play").textContent === "Play" }));
    this.on("seek", "input", () => this.pending.set("seek", { do: "seek", to: Number($("seek").value) }));
    this.on("speed", "change", () => this.link.send({ do: "speed", factor: Number($("speed").value) }));
  }

  makePlotBar() {
    const { plots } = this;
    plots.changed = () => {
      $("pause").textContent = plots.range ? "Follow" : "Pause plots";
      $("pause").setAttribute("aria-pressed", plots.range !== null);
    };
    this.on("pause", "click", () => plots.hold(plots.range ? null : plots.shown));
    this.on("window", "change", () => { plots.seconds = Number($("window").value); plots.hold(null); });
  }

  // Once a frame: the latest value of each slider.
  flush() {
    for (const order of this.pending.values()) this.link.send(order);
    this.pending.clear();
  }

  // A page that watches has no controls, nor has one whose board is silent.
  lock() {
    // A new board is the remedy of a silent emulated one.
    const locked = this.watches || (this.silent && this.facts.source.kind !== "emulated");
    $("commands").disabled = $("transport").disabled = $("bench").disabled = locked;
    for (const id of ["record", ...[...document.querySelectorAll("#faults button")]]) (typeof id === "string" ? $(id) : id).disabled = locked;
  }

  // The server, or its connection to the board, is gone: nothing on the page is of now.
  lost() {
    $("mode").className = "pill safe";
    $("mode").textContent = "no connection";
    $("pace").hidden = true;
    this.role({ commands: false, known: true, why: "nothing comes from the board" });
    $("take").hidden = true;
  }

  // The board sends nothing: the text says so, or is null.
  silence(text) {
    if (!text && !this.silent) return;
    this.silent = Boolean(text);
    this.lock();
    $("notice").hidden = !text;
    setText("notice", text ? `${text}. The board gets no command until it sends again.` : "");
  }

  role({ commands, known, why }) {
    this.watches = !commands;
    this.lock();
    this.view.enabled = commands && this.facts.source.kind === "emulated";
    $("role").hidden = commands;
    $("take").hidden = !known;
    $("role-words").textContent = why ? `This page watches: ${why}.` : "";
  }

  status(s) {
    const slow = s.factor !== undefined && s.factor < 0.97;
    $("pace").hidden = s.factor === undefined;
    $("pace").className = slow ? "pill slow" : "pill";
    $("pace").textContent = slow
      ? `slow motion: ${s.factor.toFixed(2)} of real time, this computer is busy or too slow`
      : `real time, ${Math.round(100 * (s.load ?? 0))} % of a core`;
    if (this.facts.source.kind === "recorded") {
      $("play").textContent = s.plays ? "Pause" : "Play";
      if (document.activeElement !== $("seek") || s.plays) $("seek").value = s.t;
      $("at").textContent = `${s.t.toFixed(2)} s`;
      $("seek").setAttribute("aria-valuetext", $("at").textContent);
      return;
    }
    this.silence(s.silent);
    $("mode").className = `pill ${s.silent || s.mode === "safe" ? "safe" : s.on ? "on" : ""}`;
    $("mode").textContent = s.silent ? "no answer" : s.mode === null ? "starting" : `${s.mode}${s.words ? ": " + s.words : ""}`;
    this.tuned = s.tuned;
    if (s.scene !== this.scene && s.scene !== undefined) this.showScene(s.scene);
    for (const follow of this.sliders) follow();
    this.wall();
    const refused = s.refusal ? sentence(s.refusal.words) : "";
    if (refused) $("summary").textContent = refused;
    $("record").textContent = s.recording === null ? "Record" : "Stop";
    $("recorded").textContent = s.recording === null ? "" : `${(s.recording / 1000).toFixed(1)} s`;
    for (const kind of ["csv", "mcap"]) $(kind).hidden = !s.recorded || s.recording !== null;
    if (s.fault) this.fault(s.fault);
    this.counts = s.counts;
  }

  fault(f) {
    const result = $("result"), name = document.createElement("b");
    name.textContent = f.what;
    const cause = f.cause ? ` Cause ${f.cause}: ${lower(f.words)}.` : "";
    const off = !f.was_on ? " The amplifiers were off already."
      : f.off_ms !== null ? ` Amplifiers off after ${f.off_ms.toFixed(2)} ms.`
      : f.is_over ? " The device stays on: nothing dangerous was found within 1 s." : " …";
    const text = `${off}${cause} Largest force ${f.peak_mn.toFixed(0)} mN.`;
    if (result.dataset.text === f.name + text) return;
    result.dataset.text = f.name + text;
    result.replaceChildren(name, ":" + text);
  }
}

function lower(text) { return text ? text[0].toLowerCase() + text.slice(1) : ""; }
