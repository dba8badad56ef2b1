"use strict";
// The media that the program has names for, as layers that can be edited, and the limits of its keys: both from its schema.
const LABELS = {"thesis-tissue": "Tissue of the thesis", "forearm": "Forearm", "three-layer-skin": "Skin of three layers",
  "ecoflex": "Ecoflex phantom", "palm": "Palm", "fingertip": "Fingertip"};
const PRESETS = Object.fromEntries(Object.entries(CONFIGURATION.presets).map(([name, {base, layer}]) => [name, {label: LABELS[name] ?? name,
  base, layers: layer.map(({loss, ...rest}) => loss ? {...rest, tau_us: loss.tau_us, exponent: loss.exponent} : rest)}]));

// A slider stays within the limits of its keys. Some exist only with one alternative, such as the shape of a path.
function limited(sliders, keysOf) {
  for (const [name, slider] of Object.entries(sliders))
    for (const key of keysOf(name, slider)) {
      const [least, most] = CONFIGURATION.ranges[key][slider.alternative ?? ""];
      slider.min = Math.max(slider.min, least ?? slider.min);
      slider.max = Math.min(slider.max, most ?? slider.max);
    }
  return sliders;
}
