"use strict";
// The dialog that computes all kinds of modulation of a setting, as a table and a strip of pictures on one scale.
const COMPARED = ["STM", "AM-STM", "SM-STM", "LM", "AM"];

// The setting from which a comparison begins: in the steady state, if necessary with the nearest speed that has one.
function comparable(s) {
  const base = {...structuredClone(s), kind: "AM-STM", receptors: true};
  if (base.steady && !isSteady(base)) base.speed = steadyNear(base);
  return base;
}
const steadyNear = s => usableValues(s).find(found => found.name === "speed")?.value ?? s.speed;

class CompareDialog {
  // `current` gives the shown settings, `use` loads settings.
  constructor(source, current, use) {
    Object.assign(this, {source, current, use, surface: new Surface(document.createElement("canvas"))});
    const part = name => document.getElementById("compare-" + name);
    this.parts = Object.fromEntries(["dialog", "state", "strip", "table", "png", "csv", "job", "map", "low", "high"].map(name => [name, part(name)]));
    drawScale(this.parts.map);
    this.parts.png.addEventListener("click", () => savePicture("modulations", this.picture()));
    this.parts.csv.addEventListener("click", () => download("modulations.csv", this.csv(), "text/csv"));
    this.parts.job.addEventListener("click", () => download("modulations.toml", jobText(this.base, COMPARED), "text/plain"));
    this.parts.dialog.addEventListener("close", () => { this.base = null; });
  }
  // Answers to the requests of this dialog, see Explorer.receive.
  takes(message, result) {
    if (message.id === undefined || message.id !== this.number) return false;
    this.number = undefined;
    this.resolve({message, result});
    return true;
  }
  compute(settings) {
    return new Promise(resolve => {
      this.resolve = resolve;
      this.number = this.source.compute(settings);
      if (this.number < 0) resolve({message: {type: "error", message: "The engine is not connected."}});
    });
  }
  async open() {
    const given = this.current(), base = this.base = comparable(given), {state, dialog, strip, table} = this.parts;
    this.rows = [];
    strip.replaceChildren();
    table.replaceChildren();
    for (const name of ["png", "csv", "job"]) this.parts[name].disabled = true;
    dialog.showModal();
    for (const kind of COMPARED) {
      state.textContent = `Computing ${kind}, ${this.rows.length + 1} of ${COMPARED.length} …`;
      const settings = {...base, kind}, {message, result} = await this.compute(settings);
      if (this.base !== base) return;  // closed
      if (result) result.settings = settings;
      this.rows.push({kind, settings, result, error: result ? "" : message.message ?? message.reason});
      this.show();
    }
    const changed = base.speed === given.speed ? "" : ` Speed ${rounded(base.speed, 4)} m/s, the nearest to ${rounded(given.speed)} m/s with a common period.`;
    state.textContent = `${settingLines(base).at(-1)}${changed} ${this.answer()}`;
    for (const name of ["png", "csv", "job"]) this.parts[name].disabled = false;
  }
  get results() { return this.rows.filter(row => row.result); }
  // The values of a result of all rows, and how each is marked.
  marks(spec) {
    const values = this.rows.map(({result}) => result && isValid(result) ? spec.value(result) : undefined), found = values.filter(isNumber);
    const best = spec.best && found.length > 1 ? spec.best(...found) : undefined;
    return values.map(value => value === undefined || best === undefined ? "" : value === best ? "best"
      : spec.noticeable && Math.abs(value - best) < spec.noticeable ? "no noticeable difference from the best" : "");
  }
  table() {
    const specs = RESULTS.filter(spec => spec.best && this.results.some(({result}) => spec.value(result) !== undefined));
    return {specs, marks: specs.map(spec => this.marks(spec))};
  }
  // The best kinds of each column in a sentence.
  answer() {
    const {specs, marks} = this.table(), kinds = (k, is) => this.rows.flatMap(({kind}, i) => is(marks[k][i]) ? [kind] : []).join(", ");
    const found = specs.flatMap((spec, k) => {
      const best = kinds(k, mark => mark === "best"), equal = kinds(k, mark => mark && mark !== "best");
      return best ? [`${spec.label}: ${best}${equal && ` (no noticeable difference: ${equal})`}`] : [];
    });
    return found.length ? `Best kinds. ${found.join("; ")}.` : "";
  }
  show() {
    const {specs, marks} = this.table(), cell = (spec, i, {result}) => {
      const value = result && spec.value(result), mark = marks[specs.indexOf(spec)][i];
      return element("td", {className: mark === "best" ? "best" : ""}, value === undefined ? "–" : `${mark === "best" ? "★ " : ""}${spec.text(value)}`,
        ...(mark && mark !== "best" ? [element("small", {textContent: mark})] : []), ...(result && !isValid(result) ? [element("small", {textContent: "not valid"})] : []));
    };
    const head = element("tr", {}, ...["Modulation", ...specs.map(spec => spec.label), ""].map(text => element("th", {scope: "col", textContent: text})));
    const body = this.rows.map((row, i) => element("tr", {}, element("th", {scope: "row", textContent: row.kind}),
      ...(row.result ? specs.map(spec => cell(spec, i, row)) : [element("td", {colSpan: specs.length || 1, textContent: row.error})]),
      element("td", {}, element("button", {type: "button", textContent: "Use", ariaLabel: `Use ${row.kind}`,
        onclick: () => { const settings = {...row.settings, receptors: this.current().receptors}; this.parts.dialog.close(); this.use(settings); }}))));
    this.parts.table.replaceChildren(element("table", {}, element("thead", {}, head), element("tbody", {}, ...body)));
    this.parts.strip.replaceChildren(...this.rows.map(row => element("figure", {}, row.canvas ??= element("canvas"), element("figcaption", {textContent: row.kind}))));
    this.draw();
  }
  // Levels of sensation if all kinds have them, otherwise displacements at the end.
  draw() {
    const results = this.results.map(row => row.result);
    if (!results.length) return;
    const peaks = results.map(result => result.column("felt_peak_dB").value), is_level = peaks.every(isNumber);
    const scale = is_level ? levelScale(Math.max(...peaks)) : roundScale(Math.max(...results.map(result => result.wake)));
    for (const {canvas, result} of this.results) this.surface.drawOn(canvas, result, result.frames - 1, scale, is_level ? "level" : "map");
    [this.parts.low.textContent, this.parts.high.textContent] = scaleTexts(scale, is_level);
  }
  picture() {
    const {specs} = this.table(), marks = specs.map(spec => this.marks(spec));
    const tiles = this.rows.flatMap((row, i) => !row.result ? [] : [{layers: [row.canvas], text: [row.kind, ...specs.filter(spec => spec.value(row.result) !== undefined)
      .map(spec => `${marks[specs.indexOf(spec)][i] === "best" ? "★ " : ""}${spec.label}: ${spec.text(spec.value(row.result))}`)]}]);
    return composed(`Kinds of modulation: ${titleOf(this.base, "all kinds")}`, tiles,
      {map: this.parts.map, low: this.parts.low.textContent, high: this.parts.high.textContent},
      [this.answer(), ...settingLines(this.base), `Each picture shows ${WIDTH_mm} mm x ${HEIGHT_mm} mm of the skin. ★ best; levels that differ by less than ${JND_dB} dB are no noticeable difference.`]);
  }
  csv() {
    const {specs, marks} = this.table(), quoted = text => `"${text}"`;
    return [["modulation", ...specs.flatMap(spec => [quoted(spec.label), quoted(`${spec.label}: mark`)])],
      ...this.rows.map(({kind, result}, i) => [kind, ...specs.flatMap((spec, k) => [result ? spec.value(result) ?? "" : "", marks[k][i]])])]
      .map(row => row.join(",")).join("\n") + "\n";
  }
}
