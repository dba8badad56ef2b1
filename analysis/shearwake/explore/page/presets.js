"use strict";
// The media that the program has names for, as layers that can be edited, its classes of receptors and the limits of its keys: all from its
// schema.
const LABELS = {"thesis-tissue": "Tissue of the thesis", "forearm": "Forearm", "three-layer-skin": "Skin of three layers",
  "ecoflex": "Ecoflex phantom", "palm": "Palm (assumed)", "fingertip": "Fingertip"};
const PRESETS = Object.fromEntries(Object.entries(CONFIGURATION.presets).map(([name, {base, layer}]) => [name, {label: LABELS[name] ?? name,
  base, layers: layer.map(({loss, ...rest}) => loss ? {...rest, tau_us: loss.tau_us, exponent: loss.exponent} : rest)}]));

// In the order of their numbers, and those that the page computes: they respond to vibration.
const RECEPTORS = Object.entries(CONFIGURATION.receptors).map(([name, properties]) => ({name, ...properties}));
const VIBRATION = RECEPTORS.filter(one => !one.feels_static);
const VIBRATION_NAMES = VIBRATION.map(one => one.name).join(" and ");

// The label of a key or of a column, as in tables and figures.
const labelOf = name => CONFIGURATION.labels[name].replace(/^./, letter => letter.toUpperCase());

// A slider stays within the limits of its keys. Some exist only with one alternative, such as the shape of a path.
function limited(sliders, keysOf) {
  for (const [name, slider] of Object.entries(sliders))
    for (const key of keysOf(name, slider)) {
      const [least, most] = CONFIGURATION.ranges[key][slider.alternative ?? ""];
      slider.min = Math.max(slider.min, least ?? slider.min);
      slider.max = Math.min(slider.max, most ?? slider.max);
      slider.label ??= labelOf(key);
    }
  return sliders;
}

// Media that nobody has measured, and the presets whose sources they are chosen from.
const ASSUMED = {"palm": ["thesis-tissue", "forearm"]};
function assumption(names) {
  const range = (key, unit) => {
    const values = names.flatMap(name => PRESETS[name].layers.map(layer => layer[key])).sort((a, b) => a - b);
    return `${Number(values[0].toPrecision(2))} to ${Number(values.at(-1).toPrecision(2))} ${unit}`;
  };
  return `Assumed, not measured: sources of similar tissue (${names.map(name => LABELS[name]).join(", ")}) have shear-wave speeds of ${range("c_s_m_s", "m/s")} and viscosities of ${range("viscosity_Pa_s", "Pa s")}.`;
}
