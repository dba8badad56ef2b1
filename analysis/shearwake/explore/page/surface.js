"use strict";
// Draws one frame of the surface as a colour map, with WebGL2 also with its slopes. Unknown values, NaN, are grey and hatched.
const UNKNOWN = 1e30;  // stands for NaN in textures, for which shaders need not support NaN
const HATCH = [0.55, 0.75];  // greys

// Blue, white, red: equal lightness on both sides of rest.
function colour(level) {
  const t = Math.min(1, Math.max(-1, level)), a = Math.abs(t);
  const end = t < 0 ? [0.13, 0.33, 0.66] : [0.70, 0.13, 0.17];
  return end.map(channel => 0.97 + (channel - 0.97) * a ** 0.8);
}

const VERTEX = `#version 300 es
in vec2 corner; out vec2 at;
void main() { at = 0.5 * (corner + 1.0); gl_Position = vec4(corner, 0.0, 1.0); }`;

const FRAGMENT = `#version 300 es
precision highp float;
in vec2 at; out vec4 shown;
uniform highp sampler2D field;  // y along rows of x: texel (j, i) is u(x_i, y_j)
uniform vec2 points, view;  // of the grid, and of the part that is shown
uniform float scale, relief;  // value at the ends of the scale; points per mm if slopes are shown, otherwise 0
uniform bool contour;  // a line at 0
float raw(ivec2 p) { return texelFetch(field, clamp(p, ivec2(0), ivec2(points) - 1).yx, 0).r; }
float known(ivec2 p) { return raw(p) < 1e29 ? 1.0 : 0.0; }
float u(ivec2 p) { return known(p) * raw(p) / scale; }
vec2 gradient(ivec2 p) { return 0.5 * vec2(u(p + ivec2(1, 0)) - u(p - ivec2(1, 0)), u(p + ivec2(0, 1)) - u(p - ivec2(0, 1))); }
void main() {
  vec2 p = (at - 0.5) * view + 0.5 * points; vec2 base = floor(p); vec2 w = p - base; ivec2 i = ivec2(base);
  // A point is as known as its nearest sample; unknown samples have no weight.
  vec4 share = vec4((1.0 - w.x) * (1.0 - w.y), w.x * (1.0 - w.y), (1.0 - w.x) * w.y, w.x * w.y)
    * vec4(known(i), known(i + ivec2(1, 0)), known(i + ivec2(0, 1)), known(i + ivec2(1, 1)));
  float sum = dot(share, vec4(1.0));
  float value = dot(share, vec4(u(i), u(i + ivec2(1, 0)), u(i + ivec2(0, 1)), u(i + ivec2(1, 1)))) / max(sum, 1e-6);
  float t = clamp(value, -1.0, 1.0);
  vec3 end = t < 0.0 ? vec3(0.13, 0.33, 0.66) : vec3(0.70, 0.13, 0.17);
  vec3 colour = mix(vec3(0.97), end, pow(abs(t), 0.8));
  // Steep places are darker, whatever their direction: half of the shade at a slope of the scale per 5 mm.
  vec2 slope = mix(mix(gradient(i), gradient(i + ivec2(1, 0)), w.x), mix(gradient(i + ivec2(0, 1)), gradient(i + ivec2(1, 1)), w.x), w.y);
  float steep = 5.0 * relief * length(slope);
  shown = vec4(colour * (1.0 - 0.3 * steep / (1.0 + steep)), 1.0);
  if (contour && sum > 0.999 && abs(value) < min(fwidth(value), 0.04)) shown.rgb = vec3(0.0);
  if (known(ivec2(floor(p + 0.5))) < 0.5) shown.rgb = vec3(mod(gl_FragCoord.x + gl_FragCoord.y, 8.0) < 4.0 ? ${HATCH[0]} : ${HATCH[1]});
}`;

class Surface {
  constructor(canvas) {
    this.canvas = canvas;
    this.widest = 1000;  // pixels
    this.gl = canvas.getContext("webgl2", {antialias: false, alpha: false, preserveDrawingBuffer: true});
    if (this.gl) this.prepare(); else this.flat = canvas.getContext("2d");
  }
  prepare() {
    const gl = this.gl, program = gl.createProgram();
    for (const [kind, text] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    gl.useProgram(program);
    this.places = Object.fromEntries(["points", "view", "scale", "relief", "contour"].map(name => [name, gl.getUniformLocation(program, name)]));
    gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array([-1, -1, 1, -1, -1, 1, 1, 1]), gl.STATIC_DRAW);
    const corner = gl.getAttribLocation(program, "corner");
    gl.enableVertexAttribArray(corner);
    gl.vertexAttribPointer(corner, 2, gl.FLOAT, false, 0, 0);
    gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
    for (const name of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, name, gl.NEAREST);
    for (const name of [gl.TEXTURE_WRAP_S, gl.TEXTURE_WRAP_T]) gl.texParameteri(gl.TEXTURE_2D, name, gl.CLAMP_TO_EDGE);
  }
  // Fits the pixels of the canvas to its size on the page.
  fit(limit = this.widest) {
    const box = this.canvas.getBoundingClientRect(), factor = Math.min(window.devicePixelRatio || 1, limit / Math.max(1, box.width));
    const width = Math.max(1, Math.round(factor * box.width)), height = Math.max(1, Math.round(factor * box.height));
    if (this.canvas.width !== width || this.canvas.height !== height) Object.assign(this.canvas, {width, height});
  }
  // Without a graphics processor the time of a picture follows from the number of its pixels: fewer keep the playback smooth.
  coarsen() { this.widest = Math.max(350, Math.round(0.8 * Math.min(this.widest, this.canvas.width))); }
  // `scale` is the value at the ends of the scale.
  draw(result, n, scale, style) {
    if (this.gl) this.drawWithShader(result, result.shown(n, style), scale, style);
    else this.drawFlat(result, result.shown(n, style), scale);
  }
  // The same on another canvas, so that many pictures share one context of WebGL.
  drawOn(canvas, ...what) {
    const width = Math.round(Math.min(480, (window.devicePixelRatio || 1) * (canvas.clientWidth || 240))), height = Math.round(0.75 * width);
    for (const each of [this.canvas, canvas]) if (each.width !== width || each.height !== height) Object.assign(each, {width, height});
    this.draw(...what);
    canvas.getContext("2d").drawImage(this.canvas, 0, 0);
  }
  drawWithShader(result, values, scale, style) {
    const gl = this.gl, {nx, ny} = result, texels = values.map(value => Number.isNaN(value) ? UNKNOWN : value);
    if (this.nx !== nx || this.ny !== ny) {
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.R32F, ny, nx, 0, gl.RED, gl.FLOAT, texels);
      Object.assign(this, {nx, ny});
    } else {
      gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, ny, nx, gl.RED, gl.FLOAT, texels);
    }
    gl.viewport(0, 0, this.canvas.width, this.canvas.height);
    gl.uniform2f(this.places.points, nx, ny);
    gl.uniform1f(this.places.scale, scale || 1);
    gl.uniform2f(this.places.view, WIDTH_mm / result.spacing, HEIGHT_mm / result.spacing);
    gl.uniform1f(this.places.relief, style === "slopes" ? 1 / result.spacing : 0);
    gl.uniform1i(this.places.contour, style === "level");
    gl.drawArrays(gl.TRIANGLE_STRIP, 0, 4);
  }
  drawFlat(result, values, scale) {
    const {nx, ny} = result, image = new ImageData(nx, ny);
    for (let i = 0; i < nx; ++i)
      for (let j = 0; j < ny; ++j) {
        const value = values[i * ny + j], rgb = Number.isNaN(value) ? Array(3).fill(HATCH[(i + j) >> 1 & 1]) : colour(value / (scale || 1));
        image.data.set([...rgb.map(c => Math.round(255 * c)), 255], 4 * ((ny - 1 - j) * nx + i));
      }
    const small = document.createElement("canvas");
    Object.assign(small, {width: nx, height: ny});
    small.getContext("2d").putImageData(image, 0, 0);
    const width = WIDTH_mm / result.spacing, height = HEIGHT_mm / result.spacing;
    this.flat.drawImage(small, 0.5 * (nx - width), 0.5 * (ny - height), width, height, 0, 0, this.canvas.width, this.canvas.height);
  }
}

// The scale is a round number, so that it stays the same while a setting changes little.
function roundScale(peak_m) {
  if (!(peak_m > 0)) return 1e-6;
  const power = 10 ** Math.floor(Math.log10(peak_m));
  return power * [1, 1.5, 2, 3, 5, 7, 10].find(step => step * power >= 0.999 * peak_m);
}

// Levels: 0 dB, the threshold, is in the middle.
const levelScale = most_dB => 10 * Math.max(1, Math.ceil(0.1 * most_dB));

// What the two ends of the scale are.
function scaleTexts(scale, is_level) {
  const size = `${Number((1e6 * scale).toPrecision(2))} µm`;
  return is_level ? [`below the threshold −${scale} dB`, `${scale} dB above it`] : [`out of the skin −${size}`, `${size} into the skin`];
}

function drawScale(canvas) {
  const context = canvas.getContext("2d"), image = new ImageData(256, 1);
  for (let i = 0; i < 256; ++i) image.data.set([...colour((i - 127.5) / 127.5).map(c => Math.round(255 * c)), 255], 4 * i);
  context.putImageData(image, 0, 0);
}
