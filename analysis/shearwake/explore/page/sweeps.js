"use strict";
// The dialog that sends the shown setting to a sweep.
const KIND = "load.modulation.kind";

class SweepDialog {
  // `current` gives the shown settings and job, `use` loads settings, `compute` computes settings.
  constructor(source, current, use, compute) {
    Object.assign(this, {source, current, use, compute});
    const part = name => document.getElementById("sweep-" + name);
    this.parts = Object.fromEntries(["dialog", "key", "range", "from", "to", "count", "start", "stop", "state", "table", "report"].map(name => [name, part(name)]));
    this.parts.start.addEventListener("click", () => this.start());
    this.parts.stop.addEventListener("click", () => this.source.stopSweep());
    this.parts.report.addEventListener("click", () => window.open(`/report/${this.report}`, "_blank", "noopener"));
    this.parts.key.addEventListener("change", () => this.suggest());
  }
  open() {
    const {settings} = this.current(), keys = {};
    for (const [name, spec] of Object.entries(SLIDERS)) {
      const key = name === "am" ? SWEPT_FREQUENCY[settings.kind] : spec.key;
      if (key && spec.shows(settings)) keys[key] = spec;
    }
    settings.layers?.forEach((_, i) => { keys[`medium.layer[${i + 1}].c_s_m_s`] = {...LAYER_SLIDERS.c_s_m_s, label: `Shear-wave speed, layer ${i + 1}`}; });
    this.keys = keys;
    this.parts.key.replaceChildren(...Object.entries(keys).map(([key, spec]) => new Option(`${spec.label} (${key})`, key)),
      new Option(`Kind of modulation (${KIND})`, KIND));
    this.suggest();
    this.parts.dialog.showModal();
  }
  suggest() {
    const spec = this.keys[this.parts.key.value];
    this.parts.range.hidden = !spec;
    if (!spec) return;
    this.parts.from.value = spec.min;
    this.parts.to.value = spec.max;
  }
  async start() {
    const {job} = this.current(), {key, from, to, count} = this.parts;
    if (!job) { this.parts.state.textContent = "Wait for a result first."; return; }
    if (key.value === KIND) { await this.startKinds(); return; }
    if (![from, to, count].every(input => input.reportValidity())) return;
    const cases = Number(count.value), a = Number(from.value), b = Number(to.value);
    this.base = structuredClone(this.current().settings);
    const values = Array.from({length: cases}, (_, i) => steadyValue(this.base, this.setting(key.value), a + (b - a) * i / (cases - 1)));
    this.send(job, key.value, [...new Set(values.map(value => Number(value.toPrecision(12))))]);
  }
  // A kind needs keys that others do not have. The sweep starts from a kind that needs a path.
  async startKinds() {
    this.base = comparable(this.current().settings);
    this.base.receptors = this.current().settings.receptors;
    this.parts.state.textContent = "Computing the first kind …";
    const {message} = await this.compute(this.base);
    if (message.type !== "result") { this.parts.state.textContent = message.message ?? message.reason; return; }
    const keys = Object.assign({}, ...COMPARED.map(kind => keysOfKind(this.base, kind)));
    this.send(jobText(this.base), KIND, COMPARED, Object.fromEntries(Object.entries(keys).map(([key, value]) => [`load.modulation.${key}`, value])));
  }
  send(job, key, values, more = {}) {
    this.number = this.source.sweep(job, key, values, more);
    this.parts.report.hidden = true;
    this.parts.state.textContent = this.number < 0 ? "The engine is not connected." : "The sweep starts …";
  }
  receive(message) {
    const {start, state, table} = this.parts;
    start.disabled = message.state === "running";
    state.textContent = {
      running: `${message.done} of ${message.total} cases are complete.`,
      stopped: "The sweep was stopped. Its complete cases are kept.",
      failed: message.message,
      done: `The sweep is complete: ${message.folder}. For all figures: shearwake report ${message.folder}`,
    }[message.state];
    if (message.rows) { this.showTable(table, message); this.showCurve(message); }
    if (message.state === "done") { this.report = message.report; this.parts.report.hidden = false; }
  }
  // The setting that a key belongs to.
  setting(key) {
    return key === KIND ? "kind" : key === SWEPT_FREQUENCY[this.base.kind] ? "am" : Object.keys(SLIDERS).find(name => SLIDERS[name].key === key);
  }
  // The setting of a row.
  load(key, value) {
    const settings = structuredClone(this.base), name = this.setting(key);
    const layer = key.match(/^medium\.layer\[(\d)\]\.(\w+)$/);
    if (layer) settings.layers[layer[1] - 1][layer[2]] = value; else settings[name] = value;
    this.parts.dialog.close();
    this.use(settings);
  }
  // The efficiency over the key, as far as it is computed.
  showCurve({columns, rows}) {
    const column = ["eta_period_1", "eta_at_1"].map(name => columns.indexOf(name)).find(i => i > 0 && rows.some(row => row[i] !== null));
    if (!column || columns[0] === KIND) return;
    const found = rows.filter(row => row[column] !== null).sort((a, b) => a[0] - b[0]);
    const spec = this.keys[columns[0]], label = spec ? spec.label + (spec.unit ? ` (${spec.unit})` : "") : columns[0], box = document.getElementById("plot-sweep");
    if (this.curve?.across !== label) {
      box.replaceChildren();
      this.curve = new Plot(box, label, CONFIGURATION.labels.eta_period_1, "η", {show: true, size: 6});
    }
    this.curve.fit();
    this.curve.show(found.map(row => row[0]), found.map(row => row[column]));
  }
  showTable(box, {columns, rows}) {
    const head = element("tr", {}, ...columns.map(name => element("th", {scope: "col", textContent: name})), element("th", {scope: "col"}));
    const body = rows.map(row => element("tr", {}, ...row.map(value => element("td", {textContent: typeof value === "string" ? value : digits(value)})),
      element("td", {}, element("button", {type: "button", textContent: "Use", ariaLabel: `Use ${columns[0]} = ${row[0]}`,
        onclick: () => this.load(columns[0], row[0])}))));
    box.replaceChildren(element("table", {}, element("thead", {}, head), element("tbody", {}, ...body)));
  }
}
