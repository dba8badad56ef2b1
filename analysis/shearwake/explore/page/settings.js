"use strict";
// The settings of the page and the job that they stand for. The job is the only thing that is computed and copied.
const MODULATIONS = {"STM": "STM, unmodulated", "AM-STM": "AM-STM, amplitude-modulated",
  "SM-STM": "SM-STM, speed-modulated", "AM": "AM at rest", "LM": "LM, oscillating"};
const PATHS = {line: "line", circle: "circle", drawn: "drawn by hand"};
const FOCI = {gaussian: "Gaussian", array: "array of 16 x 16"};
const WIDTH_mm = 128, HEIGHT_mm = 96;  // of the view; the grid is at least as large

// The focus of the first picture is faster than the waves of the palm and draws 125 circles per second.
const DEFAULTS = {preset: "palm", base: "rigid", layers: null, kind: "AM-STM", path: "circle", speed: 7.06858347058, radius: 9, length: 60,
  drawn: null, am: 200, depth: 1, dv: 2, lm: 2, focus: "gaussian", fwhm: 4.5, peak: 100, distance: 200, pressure: 3.4,
  spacing: 1, steady: true, duration: 12, receptors: false};

const SWEPT_FREQUENCY = {"AM": "load.modulation.am_frequency_Hz", "AM-STM": "load.modulation.am_frequency_Hz",
  "SM-STM": "load.modulation.sm_frequency_Hz", "LM": "load.modulation.lm_frequency_Hz"};

// One entry per slider; `shows` decides whether the setting has an effect.
const MOVES = s => s.kind.includes("STM");
const SLIDERS = limited({
  speed: {unit: "m/s", min: 0.5, max: 15, step: 0.1, shows: MOVES, key: "load.modulation.speed_m_s"},
  radius: {label: "Radius of the circle", unit: "mm", min: 3, max: 30, step: 0.5, shows: s => MOVES(s) && s.path === "circle",
    key: "load.modulation.path.radius_mm", alternative: "circle"},
  length: {label: "Length of the line", unit: "mm", min: 10, max: 90, step: 1, shows: s => MOVES(s) && s.path === "line"},
  am: {label: "Modulation frequency", unit: "Hz", min: 20, max: 1000, step: 5, shows: s => s.kind !== "STM"},
  depth: {unit: "", min: 0, max: 1, step: 0.05, shows: s => s.kind.startsWith("AM"),
    key: "load.modulation.am_depth"},
  dv: {unit: "m/s", min: 0, max: 5, step: 0.1, shows: s => s.kind === "SM-STM",
    key: "load.modulation.speed_deviation_m_s"},
  lm: {unit: "mm", min: 0.5, max: 10, step: 0.1, shows: s => s.kind === "LM",
    key: "load.modulation.lm_amplitude_mm"},
  fwhm: {unit: "mm", min: 3, max: 15, step: 0.1, shows: s => s.focus === "gaussian",
    key: "load.footprint.fwhm_mm", alternative: "gaussian"},
  peak: {unit: "Pa", min: 10, max: 300, step: 5, shows: s => s.focus === "gaussian",
    key: "load.peak_Pa"},
  distance: {label: "Distance of the array", unit: "mm", min: 120, max: 300, step: 5, shows: s => s.focus === "array",
    key: "load.footprint.distance_mm", alternative: "array"},
  pressure: {label: "Pressure of a transducer", unit: "Pa m", min: 0.5, max: 5, step: 0.1, shows: s => s.focus === "array",
    key: "load.footprint.pressure_Pa_m", alternative: "array"},
  duration: {label: "Duration", unit: "ms", min: 4, max: 40, step: 1, shows: s => !s.steady},
}, (name, slider) => name === "am" ? Object.values(SWEPT_FREQUENCY) : slider.key ? [slider.key] : []);
const LAYER_SLIDERS = limited({
  thickness_mm: {unit: "mm", min: 0.1, max: 40, step: 0.1},
  c_s_m_s: {unit: "m/s", min: 1, max: 40, step: 0.1},
  viscosity_Pa_s: {unit: "Pa s", min: 0, max: 10, step: 0.1},
}, name => [`medium.layer.${name}`]);

const exact = value => {  // a TOML float
  const text = String(Number(value));
  return /[.e]/.test(text) ? text.replace("e+", "e") : text + ".0";
};
const number = value => exact(Number(value).toPrecision(12));  // without the rounding errors of products
const pair = (x, y) => `[${number(x)}, ${number(y)}]`;

function pathOf(s) {
  if (s.path === "circle") return `{ shape = "circle", radius_mm = ${number(s.radius)} }`;
  if (s.path === "drawn" && s.drawn) {
    const points = s.drawn.map(p => pair(...p)).join(", ");
    return `{ shape = "polyline", points_mm = [${points}], at_end = "back-and-forth" }`;
  }
  return `{ shape = "line", from_mm = ${pair(-0.5 * s.length, 0)}, to_mm = ${pair(0.5 * s.length, 0)}, at_end = "back-and-forth" }`;
}

// The keys of a kind of modulation in addition to the path and the speed.
function keysOfKind(s, kind) {
  return {"STM": {}, "AM": {am_frequency_Hz: s.am, am_depth: s.depth}, "AM-STM": {am_frequency_Hz: s.am, am_depth: s.depth},
    "SM-STM": {sm_frequency_Hz: s.am, speed_deviation_m_s: Math.min(s.dv, 0.9 * s.speed)},
    "LM": {lm_frequency_Hz: s.am, lm_amplitude_mm: s.lm}}[kind];
}

// `kinds`: those for which the keys are needed.
function modulationOf(s, kinds) {
  let text = `[load.modulation]\nkind = "${kinds[0]}"\n`;
  if (kinds.some(kind => MOVES({kind}))) text += `path = ${pathOf(s)}\nspeed_m_s = ${number(s.speed)}\n`;
  for (const [key, value] of Object.entries(Object.assign({}, ...kinds.map(kind => keysOfKind(s, kind))))) text += `${key} = ${number(value)}\n`;
  return text;
}

// The length in mm after which a path repeats.
function cycle_mm(s) {
  if (s.path === "circle") return 2 * Math.PI * s.radius;
  if (s.path === "line" || !s.drawn) return 2 * s.length;
  return 2 * s.drawn.slice(1).reduce((sum, [x, y], i) => sum + Math.hypot(x - s.drawn[i][0], y - s.drawn[i][1]), 0);
}

// The frequencies with which the load repeats, in Hz, by the settings that change them.
function frequenciesOf(s) {
  const found = {};
  if (MOVES(s)) found.speed = 1e3 * s.speed / cycle_mm(s);
  if (s.kind !== "STM") found.am = s.am;
  return found;
}

// The least common period in ms of up to 1 s, or undefined: that of the regime "periodic".
const LONGEST_ms = 1000;
function period_ms(s) {
  const all = Object.values(frequenciesOf(s)), least = Math.min(...all);
  for (let n = 1; n <= 1e-3 * LONGEST_ms * least * (1 + 1e-9); ++n)
    if (all.every(f => Math.abs(f * n / least - Math.round(f * n / least)) <= 1e-6)) return 1e3 * n / least;
  return undefined;
}
const isSteady = s => s.steady && period_ms(s) !== undefined;

// The nearest values of the speed and of the modulation frequency with a common period: the shortest one for which the value changes
// by at most 1 %, as in the message of `check`.
function usableValues(s) {
  const {speed, am} = frequenciesOf(s), all = [];
  if (speed === undefined || am === undefined) return all;
  for (const [name, given, other] of [["speed", speed, am], ["am", am, speed]]) {
    let best;
    for (let n = 1; n <= 1e-3 * LONGEST_ms * other * (1 + 1e-9) && !(best && Math.abs(best.found - given) <= 0.01 * given); ++n) {
      const found = Math.max(1, Math.round(given * n / other)) * other / n;
      if (!best || Math.abs(found - given) < Math.abs(best.found - given)) best = {found, period_ms: 1e3 * n / other};
    }
    if (best) all.push({name, value: Number((s[name] * best.found / given).toPrecision(12)), period_ms: best.period_ms});
  }
  return all;
}

// The value of a setting that is nearest to this one and leaves a steady state possible.
function steadyValue(s, name, value) {
  const changed = {...s, [name]: value};
  if (!isSteady(s) || isSteady(changed)) return value;
  const usable = usableValues(changed).find(found => found.name === (name === "am" ? "am" : "speed"));
  return !usable ? value : name === "radius" ? value * changed.speed / usable.value : usable.value;
}

// Short enough for the frequencies of the load, and the same for all kinds of modulation.
function interval_us(s) {
  const width_mm = s.focus === "array" ? 8 : s.fwhm, most_Hz = 1350 * (s.speed + s.dv) / width_mm + s.am;
  const resolved = Math.min(250, Math.max(60, 10 * Math.floor(5e4 / most_Hz)));
  const longest_ms = period_ms({...s, kind: "AM-STM"}) ?? period_ms(s);
  return isSteady(s) ? Math.max(resolved, Math.ceil(0.5 * longest_ms)) : 1e3 * s.duration / 120;
}

function timeOf(s) {
  const time = isSteady(s) ? 'regime = "periodic"' : `duration_ms = ${number(s.duration)}`;
  return `[time]\n${time}\noutput_interval_us = ${number(interval_us(s))}\n`;
}

function mediumOf(s) {
  if (!s.layers) return `[medium]\npreset = "${s.preset}"\n`;
  return `[medium]\nbase = "${s.base}"\n` + s.layers.map((layer, i) => {
    const last = i === s.layers.length - 1 && s.base === "half-space";
    const loss = layer.tau_us !== undefined
      ? `loss = { law = "fractional", tau_us = ${exact(layer.tau_us)}, exponent = ${exact(layer.exponent)} }`
      : `viscosity_Pa_s = ${exact(layer.viscosity_Pa_s)}`;
    return `\n[[medium.layer]]\nname = ${JSON.stringify(layer.name)}\n`
      + (last ? "" : `thickness_mm = ${exact(layer.thickness_mm ?? 20)}\n`)
      + `density_kg_m3 = ${exact(layer.density_kg_m3)}\nc_p_m_s = ${exact(layer.c_p_m_s)}\n`
      + `c_s_m_s = ${exact(layer.c_s_m_s)}\n${loss}\n`;
  }).join("");
}

// The job of a setting, or of a sweep over kinds of modulation.
function jobText(s, kinds = [s.kind]) {
  const footprint = s.focus === "array"
    ? `footprint = { shape = "array", preset = "array-16x16", distance_mm = ${number(s.distance)}, pressure_Pa_m = ${number(s.pressure)} }\n`
    : `peak_Pa = ${number(s.peak)}\nfootprint = { shape = "gaussian", fwhm_mm = ${number(s.fwhm)} }\n`;
  const receptors = s.receptors
    ? `\n[afferents]\ninput = "stress"\nwhere = "grid"\nextent_mm = ${pair(64, 48)}\npitch_mm = 8.0\nclasses = [${VIBRATION.map(one => JSON.stringify(one.name)).join(", ")}]\n` : "";
  const covering = length => 2 * s.spacing * (1 + Math.ceil(0.5 * length / s.spacing - 1e-9));  // also half a cell around the view
  return `schema = 1\n\n[job]\nname = "explore"\ntitle = "A setting of shearwake explore"\n\n${mediumOf(s)}
[load]\n${footprint}\n${modulationOf(s, kinds)}
[domain]\nextent_mm = ${pair(covering(WIDTH_mm), covering(HEIGHT_mm))}\nspacing_mm = ${number(s.spacing)}\nedges = "open"\n
${timeOf(s)}
[solver]\nengine = "layered"\n
[measure]\nregion_mm = ${pair(WIDTH_mm, HEIGHT_mm)}\nsensation = true\n
[record]\ntraces_mm = [[0.0, 0.0]]\nframes = true\n${receptors}${kinds.length > 1 ? `\n[sweep]\n"load.modulation.kind" = ${JSON.stringify(kinds)}\n\n[table]\nx = "load.modulation.kind"\n` : ""}`;
}

// Settings in the address: what differs from the defaults, as JSON in base64.
function linkText(s) {
  const changed = Object.fromEntries(Object.entries(s).filter(([key, value]) => JSON.stringify(value) !== JSON.stringify(DEFAULTS[key])));
  return "#s=" + btoa(JSON.stringify(changed)).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
}

const isNumber = value => typeof value === "number" && Number.isFinite(value);
function isLayer(layer) {
  return layer && typeof layer.name === "string" && layer.name.length < 60
    && Object.entries(layer).every(([key, value]) => key === "name" || isNumber(value));
}

// The settings of an address. What is not valid keeps its default.
function settingsFrom(hash) {
  const s = structuredClone(DEFAULTS);
  let given = {};
  try {
    if (hash.startsWith("#s=") && hash.length < 20000) given = JSON.parse(atob(hash.slice(3).replaceAll("-", "+").replaceAll("_", "/")));
  } catch { return s; }
  const words = {preset: PRESETS, kind: MODULATIONS, path: PATHS, focus: FOCI, base: {"rigid": 1, "half-space": 1}};
  for (const [key, fallback] of Object.entries(DEFAULTS)) {
    const value = given?.[key];
    if (words[key] ? typeof value === "string" && Object.hasOwn(words[key], value)
      : typeof fallback === "number" ? isNumber(value)
      : typeof fallback === "boolean" && typeof value === "boolean") s[key] = value;
  }
  if (Array.isArray(given?.layers) && given.layers.length >= 1 && given.layers.length <= 4 && given.layers.every(isLayer)) s.layers = given.layers;
  if (Array.isArray(given?.drawn) && given.drawn.length >= 2 && given.drawn.length <= 200
    && given.drawn.every(p => Array.isArray(p) && p.length === 2 && p.every(isNumber))) s.drawn = given.drawn;
  return s;
}
