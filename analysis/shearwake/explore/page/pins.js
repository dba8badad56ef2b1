"use strict";
// Settings that are kept next to the current one, each with its surface at the same time and on the same scale.
const MOST_PINS_B = 1e9;  // of all their results

const JND_dB = 2.3;  // smaller differences of levels are not noticeable (docs/reference/table-columns.md)

const rounded = (value, count = 3) => Number(value.toPrecision(count));
const first = (...names) => result => names.map(name => result.column(name).value).find(isNumber);
const total = (...names) => result => names.every(name => isNumber(result.column(name).value))
  ? names.reduce((sum, name) => sum + result.column(name).value, 0) : undefined;
const ratio = (value, other) => other ? `${rounded(100 * Math.abs(value / other - 1), 2)} %` : "";

// The worded results: what is read, how it and a difference are written, and which value is best.
const RESULTS = [
  {label: labelOf("eta_period_1"), column: "eta", value: first("eta_period_1", "eta_at_1"), text: value => `${rounded(100 * value)} %`,
    difference: (value, other) => `${(100 * Math.abs(value - other)).toFixed(1)} points`, best: Math.max},
  {label: labelOf("focal_rms_um"), column: "focal_rms", value: first("focal_rms_um", "peak_um"), text: value => `${rounded(value)} µm`,
    difference: ratio},
  {label: labelOf("participation_period_mm2"), column: "participation", value: first("participation_period_mm2", "participation_at_mm2"),
    text: value => `${rounded(value)} mm²`, difference: ratio, best: Math.min},
  {label: labelOf("felt_path_dB"), column: "felt_path_dB", value: first("felt_path_dB"),
    text: value => `${rounded(Math.abs(value))} dB ${value < 0 ? "below" : "above"} threshold`,
    difference: (value, other) => `${Math.abs(value - other).toFixed(1)} dB`, best: Math.max, noticeable: JND_dB},
  {label: `Receptors (${VIBRATION_NAMES})`, column: "rate", value: total(...VIBRATION.map(({name}) => `${name}_total_rate_Hz`)),
    text: value => `${rounded(value)} spikes/s`, difference: ratio, best: Math.max}];

const isValid = result => result.header.warnings.every(w => w.severity !== "error");

// The results that a setting has, with their values and texts.
function resultsOf(result) {
  return RESULTS.map(spec => ({...spec, value: spec.value(result)})).filter(({value}) => value !== undefined)
    .map(spec => ({...spec, shown: spec.text(spec.value) + (isValid(result) ? "" : " (not valid)")}));
}

// Levels of different bands, or from different times, are not comparable.
function comparableLevels(a, b) {
  const times = ({settings}) => isSteady(settings) ? "steady" : settings.duration;
  return a.column("felt_band_Hz").value === b.column("felt_band_Hz").value && times(a) === times(b);
}

const digits = value => value === null || value === undefined ? "–" : Number(value).toPrecision(4);

class Pins {
  // `restore` is called with settings to use, `changed` when pins or the one to compare with change.
  constructor(box, restore, changed) {
    Object.assign(this, {box, restore, changed, all: [], count: 0, surface: new Surface(document.createElement("canvas"))});
  }
  add(settings, result) {
    if (this.all.reduce((sum, pin) => sum + pin.result.u.byteLength, result.u.byteLength) > MOST_PINS_B)
      return "the pinned results fill the memory; remove one of them first";
    const number = ++this.count, title = titleOf(settings), canvas = element("canvas");
    const remove = element("button", {type: "button", textContent: "Remove", ariaLabel: `Remove pin ${number}`});
    const use = element("button", {type: "button", textContent: "Use", ariaLabel: `Use pin ${number}`});
    const compare = element("input", {type: "radio", name: "compared"});
    const card = element("article", {className: "pinned", ariaLabel: `Pin ${number}: ${title}`}, canvas,
      element("p", {}, element("b", {textContent: `Pin ${number}`}), `: ${title}`),
      element("dl", {}, ...resultsOf(result).flatMap(({label, shown}) => [element("dt", {textContent: label}), element("dd", {textContent: shown})])),
      use, " ", remove, " ", element("label", {}, compare, " compare with it"));
    const pin = {number, settings: structuredClone(settings), result, card, canvas, compare};
    remove.addEventListener("click", () => {
      this.all = this.all.filter(other => other !== pin);
      card.remove();
      this.choose(this.compared === pin ? this.all.at(-1) : this.compared);
    });
    use.addEventListener("click", () => this.restore(structuredClone(pin.settings)));
    compare.addEventListener("change", () => this.choose(pin));
    this.box.append(card);
    this.all.push(pin);
    this.choose(pin);
    return `pinned: ${title}`;
  }
  choose(pin) {
    this.compared = pin;
    if (pin) pin.compare.checked = true;
    this.changed();
  }
  // The difference of one of resultsOf() from the pin that was chosen.
  difference(result, {column, value, difference}) {
    const pin = this.compared, other = pin && resultsOf(pin.result).find(found => found.column === column)?.value;
    if (other === undefined) return "";
    if (column === "felt_path_dB" && !comparableLevels(result, pin.result)) return `, in another band or duration than pin ${pin.number}`;
    const text = difference(value, other);
    return !text || !Number.parseFloat(text) ? `, as pin ${pin.number}` : `, ${text} ${value < other ? "less" : "more"} than pin ${pin.number}`;
  }
  get level() { return Math.max(0, ...this.all.map(pin => pin.result.column("felt_peak_dB").value)); }
  get wake() { return Math.max(0, ...this.all.map(pin => pin.result.wake)); }
  draw(time_s, scale, style) {
    for (const {canvas, result} of this.all) {
      const n = Math.min(result.frames - 1, Math.max(0, Math.round(time_s / result.time[0]) - 1));
      this.surface.drawOn(canvas, result, n, scale, style);
    }
  }
}
