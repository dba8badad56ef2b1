"use strict";
// Connects the parts: settings to requests, results to the pictures.
const PATIENCE_ms = 250;  // a request that takes longer gives way to a newer one
const SHORT_ms = 100;  // longer periods take longer than a second
const PICTURES = 12, SLOW_MS = 31;  // playback is slow if so many pictures take longer than this each

class Explorer {
  constructor() {
    const get = id => document.getElementById(id);
    this.parts = Object.fromEntries(["state", "play", "time", "now", "slow", "style", "show-focus", "show-mach", "show-receptors",
      "scale-low", "scale-high", "scale-unknown", "period", "numbers", "warnings", "probe-at"].map(id => [id, get(id)]));
    this.settings = settingsFrom(location.hash);
    this.frame = 0;
    this.clock_s = 0;
    this.slow = 300;
    this.is_playing = !matchMedia("(prefers-reduced-motion: reduce)").matches;
    this.waits_ms = [];   // from a change to the first picture of its result
    this.draws = [];      // times of the last pictures
    this.since_change = 0;  // pictures since playback began or the resolution changed
    this.surface = new Surface(get("surface"));
    this.overlay = new Overlay(get("overlay"), () => this.moveProbe());
    this.plots = new Plots();
    this.pins = new Pins(get("pins"), settings => this.use(settings), () => { if (this.result) { this.showNumbers(); this.draw(); } });
    this.tour = new Tour();
    const receive = (message, result) => this.receive(message, result);
    this.source = new EngineSource(receive);
    this.sweeps = new SweepDialog(this.source, () => ({settings: this.shown ?? this.settings, job: this.job}),
      settings => this.use(settings), settings => this.comparison.compute(settings));
    this.comparison = new CompareDialog(this.source, () => this.settings, settings => this.use(settings));
    this.controls = new Controls(get("controls"), this.settings, () => this.change(), () => this.sketch());
    drawScale(get("scale-map"));
    for (const {name, label, colour_on_map} of VIBRATION) {
      const dot = element("span", {textContent: "\u25cf"});
      dot.style.color = colour_on_map;
      get("receptor-key").append(" ", dot, element("span", {textContent: ` ${name}`, title: label}));
    }
    if (!this.is_playing) this.play(false);
    this.listen(get);
    new ResizeObserver(() => { this.plots.fit(); this.draw(); }).observe(document.querySelector("main"));
    requestAnimationFrame(now => this.tick(now));
  }
  listen(get) {
    for (const factor of [100, 300, 1000, 3000]) this.parts.slow.add(new Option(`${factor} times`, factor, false, factor === this.slow));
    this.parts.slow.addEventListener("change", () => { this.slow = Number(this.parts.slow.value); });
    this.parts.play.addEventListener("click", () => this.play(!this.is_playing));
    this.parts.time.addEventListener("input", () => { this.play(false); this.show(Number(this.parts.time.value)); });
    for (const name of ["style", "show-focus", "show-mach", "show-receptors"]) this.parts[name].addEventListener("change", () => this.draw());
    get("pin").addEventListener("click", () => { if (this.result) this.report(this.pins.add(this.shown, this.result)); });
    get("compare").addEventListener("click", () => this.comparison.open());
    get("save").addEventListener("click", () => { if (this.result) savePicture(`shearwake-${this.result.header.case.slice(0, 8)}`, this.picture()); });
    get("reset").addEventListener("click", () => this.use(structuredClone(DEFAULTS)));
    for (const button of document.querySelectorAll("[data-curve]"))
      button.addEventListener("click", () => download(`${button.dataset.curve}.svg`, svgOf(this.plots[button.dataset.curve], titleOf(this.shown)), "image/svg+xml"));
    get("link").addEventListener("click", () => this.copy("Link", location.href.split("#")[0] + linkText(this.settings)));
    get("copy").addEventListener("click", () => this.copy("Job", this.job ?? jobText(this.settings)));
    get("to-sweep").addEventListener("click", () => this.sweeps.open());
    window.addEventListener("hashchange", () => this.use(settingsFrom(location.hash)));
    document.addEventListener("keydown", event => this.key(event));
  }
  key(event) {
    if (event.target.closest("input, select, textarea, button, dialog") || event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === " ") { event.preventDefault(); this.play(!this.is_playing); }
    if (event.key === "," || event.key === ".") { this.play(false); this.show(this.frame + (event.key === "." ? 1 : -1)); }
  }
  use(settings) {
    for (const key of Object.keys(this.settings)) delete this.settings[key];
    Object.assign(this.settings, settings);
    this.controls.build();
    this.change();
  }
  sketch() {
    this.play(false);
    this.report("Draw the path on the surface with the pointer, or move the probe with the arrow keys, add points with Enter and end with "
      + "the space bar. Escape cancels.");
    document.querySelector("header").scrollIntoView();
    this.overlay.canvas.focus({preventScroll: true});
    drawByHand(this.overlay, () => this.draw(), points => {
      if (points) this.settings.drawn = points; else if (!this.settings.drawn) this.settings.path = "line";
      this.play(true);
      this.controls.build();
      this.change();
    });
  }
  // Requests. At most one is active; a change replaces it if it takes long, but never two in a row, so that a slider that is dragged
  // yields results steadily.
  change() {
    this.changed_ms ??= performance.now();
    this.showState();
    this.pump();
  }
  // Results that do not belong to the settings, or to no engine, are dimmed.
  showState() {
    const outdated = this.result && (this.is_offline || this.changed_ms !== undefined || this.active && performance.now() - this.active.sent_ms > PATIENCE_ms);
    document.querySelector("main").classList.toggle("outdated", Boolean(outdated));
    if (!this.is_offline && this.active && performance.now() - this.active.sent_ms > PATIENCE_ms) this.report("Computing …");
  }
  pump() {
    if (this.changed_ms === undefined) return;
    const active_ms = this.active ? performance.now() - this.active.sent_ms : Infinity;
    if (this.active && (active_ms < PATIENCE_ms || this.has_replaced)) {
      clearTimeout(this.timer);
      if (!this.has_replaced) this.timer = setTimeout(() => this.pump(), PATIENCE_ms - active_ms + 1);
      return;  // otherwise the result calls it again
    }
    this.has_replaced = Boolean(this.active);
    const settings = structuredClone(this.settings), id = this.source.compute(settings);
    if (id < 0) return;  // the connection will open again
    this.active = {id, settings, sent_ms: performance.now(), changed_ms: this.changed_ms};
    this.changed_ms = undefined;
    setTimeout(() => this.showState(), PATIENCE_ms + 1);
  }
  receive(message, result) {
    if (message.type === "open" || message.type === "closed") {
      this.is_offline = message.type === "closed";
      this.active = undefined;
      this.has_replaced = false;
      if (this.is_offline) { this.report("Not connected to the engine; the page tries again. Is shearwake explore still running?", true); this.showState(); }
      else this.change();
      return;
    }
    if (this.comparison.takes(message, result)) return;
    if (message.type === "sweep") { this.sweeps.receive(message); return; }
    if (message.type === "error" && message.id !== undefined && message.id === this.sweeps.number) {
      this.sweeps.receive({...message, state: "failed"});
      return;
    }
    const active = this.active;
    if (active && message.id !== active.id) return;  // of an older request
    this.active = undefined;
    this.has_replaced = false;
    if (message.type === "result" && active) { this.accept(active, result); this.has_ended = false; }
    if (message.type === "error") this.report(message.message, true);
    if (message.type === "error" && message.code === "ended" && !this.has_ended) {  // the request was lost with the engine
      this.has_ended = true;
      this.changed_ms ??= performance.now();
    }
    this.showState();
    this.pump();
  }
  accept(active, result) {
    this.result = Object.assign(result, {settings: active.settings});
    this.shown = active.settings;
    this.job = jobText(active.settings);
    this.parts.time.max = result.frames - 1;
    this.showNumbers();
    this.plots.show(result, this.overlay.probe);
    const begins = !this.waits_ms.length && !this.is_playing;  // the first frame would be empty
    this.show(begins ? Math.round(0.8 * result.frames) : Math.min(this.frame, result.frames - 1));
    this.waits_ms.push(performance.now() - active.changed_ms);
    this.report(`Computed in ${(1e3 * result.header.seconds).toFixed(0)} ms`);
  }
  // Whether the result is the steady state, and otherwise what would make it one.
  showPeriod() {
    const s = this.shown, has_period = period_ms(s) !== undefined, {period} = this.parts;
    period.replaceChildren(settingLines(s).at(-1));
    if (!s.steady || has_period && period_ms(s) <= SHORT_ms) return;
    const shorter = usableValues(s).filter(found => found.period_ms < (period_ms(s) ?? Infinity));
    period.append(!has_period ? ` ${s.kind === "STM" ? "The path has" : `${rounded(s.speed, 4)} m/s and ${rounded(s.am, 4)} Hz have`} no${s.kind === "STM" ? "" : " common"} period of up to ${LONGEST_ms} ms. `
      : shorter.length ? " A shorter period is faster: " : "", ...shorter.flatMap(found => [element("button", {type: "button",
      textContent: `Use ${rounded(found.value, 4)} ${SLIDERS[found.name].unit} (period ${rounded(found.period_ms)} ms)`,
      onclick: () => this.use({...this.settings, [found.name]: found.value})}), " "]));
  }
  showNumbers() {
    this.showPeriod();
    const rows = resultsOf(this.result).map(found => {
      const shown = element("dd", {}, element("b", {textContent: found.shown}), this.pins.difference(this.result, found));
      shown.dataset.column = found.column;
      return [element("dt", {textContent: found.label}), shown];
    });
    const {value: level, note} = this.result.column("felt_path_dB");
    if (!isNumber(level) && note) {
      const unknown = element("dd", {textContent: `unknown: ${note}`});
      unknown.dataset.column = "felt_path_dB";
      rows.push([element("dt", {textContent: labelOf("felt_path_dB")}), unknown]);
    }
    const [fitted, theory] = ["mach_angle_deg", "mach_angle_theory_deg"].map(name => this.result.column(name).value);
    if (isNumber(fitted) && isNumber(theory))
      rows.push([element("dt", {textContent: "Mach angle"}), element("dd", {textContent: `${fitted.toFixed(1)}°, theory ${theory.toFixed(1)}°`})]);
    this.parts.numbers.replaceChildren(...rows.flat());
    const others = this.result.header.warnings.filter(w => isNumber(level) || !note || !w.message.endsWith(note));
    this.parts.warnings.replaceChildren(...others.map(w => element("li", {textContent: `${w.severity === "error" ? "not valid: " : ""}${w.key}: ${w.message}`})));
  }
  // Pictures.
  tick(now) {
    if (this.is_playing && this.result && this.last_ms !== undefined) {
      const step_s = this.result.time[0], duration_s = step_s * this.result.frames;
      this.clock_s = (this.clock_s + 1e-3 * Math.min(100, now - this.last_ms) / this.slow) % duration_s;
      const frame = Math.min(this.result.frames - 1, Math.floor(this.clock_s / step_s));
      if (frame !== this.frame) this.show(frame);
      this.draws.push(now);
      if (this.draws.length > 200) this.draws.shift();
      if (++this.since_change >= PICTURES && now - this.draws.at(-PICTURES) > (PICTURES - 1) * SLOW_MS) {
        this.surface.coarsen();
        this.since_change = 0;
      }
    }
    this.last_ms = now;
    requestAnimationFrame(later => this.tick(later));
  }
  play(on) {
    this.is_playing = on;
    this.draws.length = this.since_change = 0;
    this.parts.play.textContent = on ? "❚❚" : "▶";
    this.parts.play.setAttribute("aria-label", on ? "Pause" : "Play");
    if (on && this.result) this.clock_s = this.frame * this.result.time[0];
  }
  show(frame) {
    if (!this.result) return;
    this.frame = Math.min(this.result.frames - 1, Math.max(0, frame));
    this.parts.time.value = this.frame;
    this.parts.now.value = `${(1e3 * this.result.time[this.frame]).toFixed(2)} ms`;
    this.parts.time.setAttribute("aria-valuetext", this.parts.now.value);
    this.draw();
    this.plots.showTime(this.frame);
  }
  draw() {
    const felt = this.result?.column("felt_peak_dB") ?? {value: null, note: ""};
    const has_level = felt.value !== null, wants_level = this.parts.style.value === "level";
    const is_level = wants_level && has_level, style = wants_level && !has_level ? "map" : this.parts.style.value;
    const scale = is_level ? levelScale(Math.max(felt.value, this.pins.level))
      : roundScale(Math.max(this.result?.wake ?? 0, this.pins.wake));
    this.colours = Array.from(this.parts.style.options).find(option => option.value === style).text;
    this.overlay.fit();
    if (this.result) {
      this.surface.fit();
      this.surface.draw(this.result, this.frame, scale, style);
      this.pins.draw(this.result.time[this.frame], scale, style);
      const [low, high] = scaleTexts(scale, is_level);
      this.parts["scale-low"].textContent = (wants_level && !has_level ? "no level of sensation, instead: " : "") + low;
      this.parts["scale-low"].title = wants_level ? felt.note : "";
      this.parts["scale-high"].textContent = high;
      this.parts["scale-unknown"].hidden = !this.result.hasUnknown(this.frame, style);
    }
    this.overlay.draw(this.result, this.frame, {focus: this.parts["show-focus"].checked, mach: this.parts["show-mach"].checked,
      receptors: this.parts["show-receptors"].checked});
  }
  // The surface as it is shown, with its title, scale, settings and results.
  picture() {
    const text = name => this.parts[name].textContent;
    const unknown = this.parts["scale-unknown"].hidden ? [] : ["Hatched: unknown."];
    return composed(titleOf(this.shown), [{layers: [this.surface.canvas, this.overlay.canvas], text: []}],
      {map: document.getElementById("scale-map"), low: text("scale-low"), high: text("scale-high")},
      [`Colours: ${this.colours}, at ${this.parts.now.value}.`, ...unknown, resultsOf(this.result).map(({label, shown}) => `${label}: ${shown}`).join("; ") + ".",
        ...settingLines(this.shown), `shearwake, case ${this.result.header.case}`]);
  }
  moveProbe() {
    const [x, y] = this.overlay.probe;
    this.parts["probe-at"].value = `(${x.toFixed(0)} mm, ${y.toFixed(0)} mm)`;
    if (this.result) this.plots.showProbe(this.result, this.overlay.probe);
    this.draw();
  }
  report(text, is_error = false) {
    this.parts.state.textContent = text;
    this.parts.state.classList.toggle("error", is_error);
  }
  copy(what, text) {
    const show = () => {
      document.getElementById("text-title").textContent = what;
      document.getElementById("text").value = text;
      document.getElementById("text-dialog").showModal();
      document.getElementById("text").select();
    };
    this.copied = text;
    if (!navigator.clipboard) { show(); return; }
    navigator.clipboard.writeText(text).then(() => this.report(`${what} copied to the clipboard`), show);
  }
}

if (location.search) history.replaceState(null, "", location.pathname + location.hash);  // keeps the token out of copied links
const explorer = new Explorer();
explorer.moveProbe();
explorer.tour.startOnFirstVisit();
