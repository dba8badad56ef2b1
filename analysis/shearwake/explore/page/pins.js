"use strict";
// Settings that are kept next to the current one, each with its surface at the same time and on the same scale.
const MOST_PINS = 4;

// The worded results: a label, the columns of which the first with a value is shown, and how it is written.
const RESULTS = [["Energy at the focus", ["eta_period_1", "eta_at_1"], value => `${(100 * value).toPrecision(3)} %`],
  ["Strength at the focus (RMS)", ["focal_rms_um", "peak_um"], value => `${value.toPrecision(3)} µm`],
  ["Spread (vibrating area)", ["participation_period_mm2", "participation_at_mm2"], value => `${value.toPrecision(3)} mm²`],
  ["Level of sensation on the shape", ["felt_path_dB"], value =>
    `${Math.abs(value).toPrecision(3)} dB ${value < 0 ? "below" : "above"} threshold`]];

// Label, column, value and text of the results that a setting has.
function resultsOf(result) {
  const mark = result.header.warnings.some(w => w.severity === "error") ? " (not valid)" : "";
  return RESULTS.map(([label, names, text]) => [label, names.find(name => isNumber(result.column(name).value)), text])
    .filter(([, name]) => name).map(([label, name, text]) => ({label, name, value: result.column(name).value, text: text(result.column(name).value) + mark}));
}

const digits = value => value === null || value === undefined ? "–" : Number(value).toPrecision(4);

class Pins {
  // `restore` is called with settings to use, `changed` when a pin is added or removed.
  constructor(box, restore, changed) { Object.assign(this, {box, restore, changed, all: []}); }
  add(settings, result) {
    if (this.all.length === MOST_PINS) return `${MOST_PINS} settings are pinned; remove one of them first`;
    const title = this.title(settings), canvas = element("canvas");
    const remove = element("button", {type: "button", textContent: "Remove", ariaLabel: `Remove ${title}`});
    const use = element("button", {type: "button", textContent: "Use", ariaLabel: `Use ${title}`});
    const card = element("article", {className: "pinned", ariaLabel: `Pinned: ${title}`}, canvas, element("p", {textContent: title}),
      element("dl", {}, ...resultsOf(result).flatMap(({label, text}) => [element("dt", {textContent: label}), element("dd", {textContent: text})])),
      use, " ", remove);
    const pin = {settings: structuredClone(settings), result, card};
    this.box.append(card);
    pin.surface = new Surface(canvas);
    remove.addEventListener("click", () => {
      pin.surface.gl?.getExtension("WEBGL_lose_context")?.loseContext();
      this.all = this.all.filter(other => other !== pin);
      card.remove();
      this.changed();
    });
    use.addEventListener("click", () => this.restore(structuredClone(pin.settings)));
    this.all.push(pin);
    this.changed();
    return `pinned: ${title}`;
  }
  title(s) {
    const parts = [s.layers ? "edited layers" : PRESETS[s.preset].label, s.kind];
    if (MOVES(s)) parts.push(`${s.speed} m/s`, s.path);
    if (s.kind !== "STM") parts.push(`${s.am} Hz`);
    parts.push(s.focus === "array" ? "array" : `${s.fwhm} mm`);
    return parts.join(", ");
  }
  get level() { return Math.max(0, ...this.all.map(pin => pin.result.column("felt_peak_dB").value)); }
  get wake() { return Math.max(0, ...this.all.map(pin => pin.result.wake)); }
  draw(time_s, scale, style) {
    for (const {surface, result} of this.all) {
      const n = Math.min(result.frames - 1, Math.max(0, Math.round(time_s / result.time[0]) - 1));
      surface.fit(400);
      surface.draw(result, n, scale, style);
    }
  }
}
