// The device: drawn from the latest row, and its handle moved by mouse, touch or keys.

const KEY_RAD = 0.02, KEY_FAST_RAD = 0.1;

class DeviceView {
  constructor(canvas, facts, store, send) {
    this.canvas = canvas; this.facts = facts; this.store = store; this.send = send;
    this.target = null; this.pending = null; this.dragged = null; this.wall = null;
    this.latency = []; this.moved = null; this.enabled = false;
    canvas.addEventListener("pointerdown", (e) => this.grab(e));
    canvas.addEventListener("pointermove", (e) => this.drag(e));
    for (const end of ["pointerup", "pointercancel", "lostpointercapture"]) canvas.addEventListener(end, () => this.release());
    canvas.addEventListener("keydown", (e) => this.key(e));
    canvas.addEventListener("blur", () => this.release(true));
  }

  geometry() {
    const { width, height } = this;
    const radius = Math.min(height * 0.36, width * 0.25), y = height * 0.53;
    // In a narrow card all parts are smaller, and stay beside each other.
    const scale = Math.min(1, width / 380), x = width - radius - 34 * scale;
    const motor = { x: 56 * scale, y, radius: 40 * scale };
    const coupler = { x: (motor.x + motor.radius + x - radius) / 2, y, radius: 22 * scale };
    return { x, y, radius, motor, coupler };
  }

  pointer(e) {
    const box = this.canvas.getBoundingClientRect(), g = this.geometry();
    return Math.atan2(e.clientX - box.left - g.x, -(e.clientY - box.top - g.y));
  }

  grab(e) {
    if (!this.enabled) return;
    this.canvas.focus({ preventScroll: true });
    try { this.canvas.setPointerCapture(e.pointerId); } catch { /* a pointer that has gone */ }
    const handle = this.store.latest("handle_angle") || 0;
    this.dragged = { last: this.pointer(e) };
    this.move(this.target ?? handle);
  }

  drag(e) {
    if (!this.dragged || !this.enabled) return;
    const now = this.pointer(e);
    let step = now - this.dragged.last;
    step -= 2 * Math.PI * Math.round(step / (2 * Math.PI));
    this.dragged.last = now;
    this.move(this.target + step);
  }

  release(all = false) {
    if (!this.dragged && !all) return;
    this.dragged = null;
    if (this.target !== null) this.move(null);
  }

  key(e) {
    if (!this.enabled) return;
    const by = (e.shiftKey ? KEY_FAST_RAD : KEY_RAD) * ({ ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 }[e.key] ?? 0);
    if (by) this.move((this.target ?? this.store.latest("handle_angle")) + by);
    else if (e.key === "Escape") this.release(true);
    else return;
    e.preventDefault();
  }

  move(to) {
    if (to !== null && !Number.isFinite(to)) return;
    // From the first motion until a drawn row has it: the delay that a person sees.
    if (to !== null && this.moved === null && this.target !== null && Math.abs(to - this.target) > 2e-3) {
      this.moved = { at: performance.now(), force: this.store.latest("force"), hand: this.store.latest("hand_angle") };
    }
    this.target = to;
    this.pending = { do: "hand", at: to };
  }

  // Once a frame: the latest order, not each motion of the mouse.
  flush() {
    if (this.pending) { this.send(this.pending); this.pending = null; }
  }

  draw() {
    const canvas = this.canvas, scale = devicePixelRatio || 1;
    this.width = canvas.clientWidth; this.height = canvas.clientHeight;
    if (canvas.width !== Math.round(this.width * scale)) {
      canvas.width = Math.round(this.width * scale); canvas.height = Math.round(this.height * scale);
    }
    const c = canvas.getContext("2d"), style = getComputedStyle(document.documentElement);
    const ink = (name) => style.getPropertyValue(name).trim();
    c.setTransform(scale, 0, 0, scale, 0, 0);
    c.clearRect(0, 0, this.width, this.height);
    const value = (name) => this.store.latest(name);
    const handle = value("handle_angle") || 0, large = value("large_angle") || 0, force = value("force");
    const g = this.geometry(), { motor, coupler } = g;
    c.font = "12px system-ui, sans-serif"; c.textAlign = "center"; c.lineWidth = 1.5;
    // Shaft, large motor, coupler.
    c.strokeStyle = ink("--shade"); c.fillStyle = ink("--metal");
    c.fillRect(motor.x, g.y - 4, g.x - motor.x, 8);
    disc(c, motor.x, motor.y, motor.radius, large, ink("--metal"), ink("--accent"), 3);
    disc(c, coupler.x, coupler.y, coupler.radius, large, ink("--metal"), ink("--accent"), 4);
    disc(c, coupler.x, coupler.y, 0.6 * coupler.radius, handle, ink("--card"), ink("--warm"), 2);
    c.fillStyle = ink("--muted");
    c.fillText("large motor", motor.x, motor.y + motor.radius + 16);
    c.fillText("coupler", coupler.x, coupler.y + coupler.radius + 16);
    this.drawWall(c, g, ink);
    c.strokeStyle = ink("--shade"); c.lineWidth = 1.5;
    disc(c, g.x, g.y, g.radius, handle, ink("--card"), ink("--line"), 0);
    this.drawWallEdge(c, g, ink);
    // The lever with the fingertip.
    const tip = on(g, handle);
    c.strokeStyle = ink("--ink"); c.lineWidth = 5; c.lineCap = "round";
    c.beginPath(); c.moveTo(g.x, g.y); c.lineTo(tip.x, tip.y); c.stroke();
    c.lineWidth = 1.5; c.fillStyle = ink("--ink");
    circle(c, g.x, g.y, 6); c.fill();
    const hand = this.target !== null ? this.target : value("hand_angle");
    if (Number.isFinite(hand)) this.drawSpring(c, g, handle, hand, ink);
    c.fillStyle = ink("--warm"); circle(c, tip.x, tip.y, 9); c.fill();
    if (Number.isFinite(force)) this.drawForce(c, g, handle, force, ink);
    canvas.setAttribute("aria-valuenow", handle.toFixed(3));
    canvas.setAttribute("aria-valuetext", `handle at ${handle.toFixed(2)} rad, force ${Number.isFinite(force) ? force.toFixed(0) : "unknown"} mN`);
    this.measure();
  }

  // The wall of the scene, from its position on.
  drawWall(c, g, ink) {
    if (this.wall === null) return;
    c.fillStyle = ink("--band");
    const from = this.wall - Math.PI / 2;
    c.beginPath(); c.moveTo(g.x, g.y); c.arc(g.x, g.y, g.radius + 14, from, from + 1); c.closePath(); c.fill();
  }

  drawWallEdge(c, g, ink) {
    if (this.wall === null) return;
    const edge = on({ ...g, radius: g.radius + 14 }, this.wall);
    c.strokeStyle = ink("--good"); c.lineWidth = 3;
    c.beginPath(); c.moveTo(g.x, g.y); c.lineTo(edge.x, edge.y); c.stroke();
  }

  // The hand: a spring from the fingertip to the target.
  drawSpring(c, g, handle, hand, ink) {
    const turns = 14, spread = Math.max(-3, Math.min(3, hand - handle));
    c.strokeStyle = ink("--accent"); c.lineWidth = 2; c.beginPath();
    for (let k = 0; k <= turns; k++) {
      const side = k === 0 || k === turns ? 0 : k % 2 ? 6 : -6;
      const p = on({ ...g, radius: g.radius + side }, handle + (spread * k) / turns);
      if (k) c.lineTo(p.x, p.y); else c.moveTo(p.x, p.y);
    }
    c.stroke();
    const end = on(g, handle + spread);
    c.fillStyle = ink("--accent"); circle(c, end.x, end.y, 6); c.fill();
  }

  // The force on the fingertip: an arrow along its path, 1 px for 2 mN up to 120 px.
  drawForce(c, g, handle, force, ink) {
    const length = Math.sign(force) * Math.min(120, Math.abs(force) / 2);
    if (Math.abs(length) < 1.5) return;
    const from = on({ ...g, radius: g.radius + 18 }, handle);
    const dir = { x: Math.cos(handle), y: Math.sin(handle) }, s = Math.sign(length);
    const to = { x: from.x + dir.x * length, y: from.y + dir.y * length };
    c.strokeStyle = c.fillStyle = ink("--warm"); c.lineWidth = 4;
    c.beginPath(); c.moveTo(from.x, from.y); c.lineTo(to.x, to.y); c.stroke();
    c.beginPath(); c.moveTo(to.x + dir.x * 10 * s, to.y + dir.y * 10 * s);
    c.lineTo(to.x - dir.y * 6, to.y + dir.x * 6); c.lineTo(to.x + dir.y * 6, to.y - dir.x * 6); c.fill();
  }

  measure() {
    if (!this.moved) return;
    const { at, force, hand } = this.moved;
    // Before the hand took hold it had no angle.
    const now = this.store.latest("hand_angle");
    const hasMoved = Number.isFinite(now) && !(Math.abs(now - hand) <= 1e-4) && Math.abs(this.store.latest("force") - force) > 0.1;
    const ms = performance.now() - at;
    if (hasMoved) this.latency.push(ms);
    if (hasMoved || ms > 2000) this.moved = null;
    if (this.latency.length > 1000) this.latency.shift();
  }
}

function on(g, angle) { return { x: g.x + g.radius * Math.sin(angle), y: g.y - g.radius * Math.cos(angle) }; }
function circle(c, x, y, radius) { c.beginPath(); c.arc(x, y, radius, 0, 2 * Math.PI); }
function disc(c, x, y, radius, angle, fill, mark, spokes) {
  c.fillStyle = fill; circle(c, x, y, radius); c.fill(); c.stroke();
  c.save(); c.strokeStyle = mark; c.lineWidth = 3;
  for (let k = 0; k < spokes; k++) {
    const a = angle + (2 * Math.PI * k) / spokes;
    c.beginPath(); c.moveTo(x + radius * 0.5 * Math.sin(a), y - radius * 0.5 * Math.cos(a));
    c.lineTo(x + radius * 0.88 * Math.sin(a), y - radius * 0.88 * Math.cos(a)); c.stroke();
  }
  c.restore();
}
