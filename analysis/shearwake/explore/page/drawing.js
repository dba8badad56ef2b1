"use strict";
// Drawing a path by hand on the overlay. The path is reduced to points that are some millimetres apart.
function thinned(points, step_mm) {
  const kept = [points[0]];
  for (const point of points)
    if (Math.hypot(point[0] - kept.at(-1)[0], point[1] - kept.at(-1)[1]) >= step_mm) kept.push(point);
  return kept.slice(0, 200).map(point => point.map(value => Math.round(10 * value) / 10));
}

// Calls `done` with the points, or with nothing if the drawing is cancelled by Escape. With the keyboard, Enter adds the place of the
// probe, and the space bar ends the path.
function drawByHand(overlay, redraw, done) {
  const canvas = overlay.canvas, points = [];
  overlay.sketch = points;
  const add = event => { points.push(overlay.place(event)); redraw(); };
  const down = event => { canvas.setPointerCapture(event.pointerId); add(event); };
  const move = event => { if (event.buttons && points.length) add(event); };
  const end = found => {
    for (const [name, listener] of listeners) (name === "keydown" ? window : canvas).removeEventListener(name, listener, true);
    overlay.sketch = null;
    done(found);
  };
  const up = () => {
    const kept = points.length ? thinned(points, 2) : [];
    if (kept.length >= 2) end(kept); else points.length = 0;
  };
  const key = event => {
    if (event.key === "Escape") end(null);
    if (event.key === "Enter") { points.push([...overlay.probe]); redraw(); }
    if (event.key === " ") up();
    if (event.key === "Enter" || event.key === " ") { event.preventDefault(); event.stopPropagation(); }
  };
  const listeners = [["pointerdown", down], ["pointermove", move], ["pointerup", up], ["keydown", key]];
  for (const [name, listener] of listeners) (name === "keydown" ? window : canvas).addEventListener(name, listener, true);
}
