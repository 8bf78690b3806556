// The page's loop: what came is drawn once a frame, what is wanted is sent once a frame.

const scope = { frames: 0, store: null, plots: null, view: null, controls: null, errors: [] };
window.scope = scope;
addEventListener("error", (e) => scope.errors.push(String(e.message)));

const link = connect({
  opened() { $("notice").hidden = true; scope.ended = null; setText("mode", ""); $("mode").className = "pill"; },
  closed() {
    const ended = scope.ended && `${scope.ended}. The server has ended; when it is started again, this page connects to it at the same --port.`;
    notice(ended ?? "No connection to the server; the device goes safe by itself. Connecting again …");
    scope.controls?.lost();
  },
  // The source has failed, and the server ends.
  ended({ why }) { scope.ended = why; notice(`${why}.`); scope.controls?.lost(); },
  rows(buffer) { scope.store?.take(buffer); },
  facts(facts) {
    if (scope.store) { scope.store.clear(); scope.store.next = null; scope.store.epoch = null; return; }
    scope.facts = facts;
    scope.store = new Store(facts.channels, facts.estimators, facts.source.gap);
    scope.plots = new Plots($("plots"), facts, scope.store);
    scope.view = new DeviceView($("device"), facts, scope.store, (order) => link.send(order));
    scope.controls = new Controls(facts, link, scope.view, scope.plots);
    scope.controls.showScene(0);
    scope.bench = new Bench(facts, link);
    requestAnimationFrame(frame);
  },
  role(role) {
    // The token of a server that has started again is another one.
    if (!role.known) { location.reload(); return; }
    scope.role = role;
    scope.controls.role(role);
  },
  status(status) {
    scope.status = status; scope.controls.status(status);
    if (scope.facts.source.kind !== "recorded") scope.bench.status(status);
  },
  refused({ why }) { $("summary").textContent = `Refused: ${why}.`; },
});
scope.link = link;

function notice(text) { $("notice").hidden = false; setText("notice", text); }

const PLOT_MS = 30;
let plotted = 0;

function frame() {
  requestAnimationFrame(frame);
  const { store, view, controls, plots } = scope;
  view.flush(); controls.flush();
  if (!store.count) return;
  view.draw();
  // Half of the frames of a fast screen: the board may run on the same processor.
  if (performance.now() - plotted >= PLOT_MS) { plotted = performance.now(); plots.draw(); }
  showNumbers(store, controls);
  scope.frames++;
}

function showNumbers(store, controls) {
  const force = store.latest("force"), limit = scope.facts.device.threshold_mn;
  setText("force", Number.isFinite(force) ? force.toFixed(Math.abs(force) < 100 ? 1 : 0) : "–");
  $("meter").value = Math.min(40, Math.abs(force) || 0);
  const parasitic = store.latest("parasitic"), tactile = store.latest("tactile");
  const words = (value) => `${value.toFixed(1)} mN (${Math.abs(value) < limit ? "below" : "above"} the ${limit} mN that a fingertip notices)`;
  const isBoard = scope.facts.source.kind === "board";
  setText("felt-words", isBoard ? "A board does not report the force at the fingertip. The torque that its scene wants has a plot." : Number.isFinite(parasitic) ? `Not commanded by the scene: ${words(parasitic)}${Number.isFinite(tactile) ? `; roughness ${tactile.toFixed(1)} mN` : ""}.` : "");
  const number = store.latest("estimator");
  const buttons = [...$("estimators").children];
  buttons.forEach((b, k) => {
    const is = String(k === number), tab = k === (number in buttons ? number : 0) ? 0 : -1;
    if (b.getAttribute("aria-checked") !== is) b.setAttribute("aria-checked", is);
    if (b.tabIndex !== tab) b.tabIndex = tab;
  });
  const c = controls.counts;
  setText("lost", `Frames lost: ${store.lost} on the way here${Number.isFinite(store.latest("drops")) ? `, ${store.latest("drops")} by the board` : ""}` +
    (c && (c.garbage || c.flooded) ? `; not followed: ${c.garbage} unreadable, ${c.flooded} too many` : ""));
}

function setText(id, text) { if ($(id).textContent !== text) $(id).textContent = text; }
