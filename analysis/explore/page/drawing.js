"use strict";
// Drawing a path by hand on the overlay. The path is reduced to points that are some millimetres apart.
function thinned(points, step_mm) {
  const kept = [points[0]];
  for (const point of points)
    if (Math.hypot(point[0] - kept.at(-1)[0], point[1] - kept.at(-1)[1]) >= step_mm) kept.push(point);
  return kept.slice(0, 200).map(point => point.map(value => Math.round(10 * value) / 10));
}

// Calls `done` with the points, or with nothing if the drawing is cancelled by Escape.
function drawByHand(overlay, redraw, done) {
  const canvas = overlay.canvas, points = [];
  overlay.sketch = points;
  const add = event => { points.push(overlay.place(event)); redraw(); };
  const down = event => { canvas.setPointerCapture(event.pointerId); add(event); };
  const move = event => { if (event.buttons && points.length) add(event); };
  const end = found => {
    for (const [name, listener] of listeners) (name === "keydown" ? document : canvas).removeEventListener(name, listener);
    overlay.sketch = null;
    done(found);
  };
  const up = () => {
    const kept = points.length ? thinned(points, 2) : [];
    if (kept.length >= 2) end(kept); else points.length = 0;
  };
  const listeners = [["pointerdown", down], ["pointermove", move], ["pointerup", up], ["keydown", e => { if (e.key === "Escape") end(null); }]];
  for (const [name, listener] of listeners) (name === "keydown" ? document : canvas).addEventListener(name, listener);
}
