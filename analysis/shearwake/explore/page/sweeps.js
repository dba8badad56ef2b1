"use strict";
// The dialog that sends the shown setting to a sweep.
class SweepDialog {
  constructor(source, current) {
    Object.assign(this, {source, current});
    const part = name => document.getElementById("sweep-" + name);
    this.parts = Object.fromEntries(["dialog", "key", "from", "to", "count", "start", "stop", "state", "table"].map(name => [name, part(name)]));
    this.parts.start.addEventListener("click", () => this.start());
    this.parts.stop.addEventListener("click", () => this.source.stopSweep());
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
    this.parts.key.replaceChildren(...Object.entries(keys).map(([key, spec]) => new Option(`${spec.label} (${key})`, key)));
    this.suggest();
    this.parts.dialog.showModal();
  }
  suggest() {
    const spec = this.keys[this.parts.key.value];
    this.parts.from.value = spec.min;
    this.parts.to.value = spec.max;
  }
  start() {
    const {job} = this.current(), {key, from, to, count} = this.parts;
    if (!job) { this.parts.state.textContent = "Wait for a result first."; return; }
    if (![from, to, count].every(input => input.reportValidity())) return;
    const cases = Number(count.value), a = Number(from.value), b = Number(to.value);
    const values = Array.from({length: cases}, (_, i) => Number((a + (b - a) * i / (cases - 1)).toPrecision(12)));
    this.number = this.source.sweep(job, key.value, values);
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
    if (message.state === "done") this.showTable(table, message);
  }
  showTable(box, {columns, rows}) {
    const head = element("tr", {}, ...columns.map(name => element("th", {scope: "col", textContent: name})));
    const body = rows.map(row => element("tr", {}, ...row.map(value => element("td", {textContent: digits(value)}))));
    box.replaceChildren(element("table", {}, element("thead", {}, head), element("tbody", {}, ...body)));
  }
}
