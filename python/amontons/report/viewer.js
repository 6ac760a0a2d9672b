// A view of the deformed bodies: WebGL 2, no library. Data comes from the page itself, nothing is fetched.
// SPDX-License-Identifier: GPL-3.0-or-later
"use strict";
(function () {
  const box = document.getElementById("view"), canvas = box.querySelector("canvas");
  const job = JSON.parse(document.getElementById("job").textContent);
  const bytes = text => { const raw = atob(text), out = new Uint8Array(raw.length);
    for (let i = 0; i < raw.length; i++) out[i] = raw.charCodeAt(i); return out.buffer; };
  const points = new Float32Array(bytes(job.points)), triangles = new Uint32Array(bytes(job.triangles));
  const edges = new Uint32Array(bytes(job.edges)), moves = new Float32Array(bytes(job.displacement));
  const nodes = new Uint32Array(bytes(job.nodes));
  job.fields.forEach(f => { f.values = new Float32Array(bytes(f.data)); f.data = null; });
  const n = points.length / 3, gl = canvas.getContext("webgl2", { antialias: true, alpha: false, preserveDrawingBuffer: true });
  const find = id => box.querySelector("#" + id);
  if (!gl) { find("nogl").hidden = false; canvas.hidden = true; return; }

  const scale = job.colours.map(c => [1, 3, 5].map(i => parseInt(c.slice(i, i + 2), 16) / 255));
  const vertex = `#version 300 es
    in vec3 place; in vec3 move; in float value; uniform mat3 turn; uniform vec3 middle; uniform vec2 pan; uniform vec2 zoom;
    uniform float factor; uniform float lift; uniform float size; out float v; out vec3 eye;
    void main() { vec3 p = turn * (place + factor * move - middle); eye = p; v = value;
      gl_Position = vec4((p.xy + pan) * zoom, -p.z * ${(0.25 / job.radius).toExponential(6)} - lift, 1.0); gl_PointSize = size; }`;
  const fragment = `#version 300 es
    precision highp float; in float v; in vec3 eye; uniform vec2 range; uniform vec3 colours[${scale.length}]; uniform int kind; out vec4 c;
    void main() {
      if (kind == 1) { c = vec4(1.0, 1.0, 1.0, ${Math.min(0.8, Math.max(0.22, 18 / Math.sqrt(job.n_sides + 1))).toFixed(3)}); return; }
      if (kind == 4) { c = vec4(0.55, 0.6, 0.65, 0.35); return; }
      if (kind == 3) { c = vec4(0.1, 0.13, 0.16, 1.0); return; }
      if (kind == 2) { vec2 q = gl_PointCoord - 0.5; if (dot(q, q) > 0.25) discard;
        c = dot(q, q) > 0.13 ? vec4(1.0, 1.0, 1.0, 1.0) : vec4(0.84, 0.12, 0.2, 1.0); return; }
      float t = clamp((v - range.x) / max(range.y - range.x, 1e-30), 0.0, 1.0) * ${(scale.length - 1).toFixed(1)};
      int i = min(int(t), ${scale.length - 2}); vec3 base = mix(colours[i], colours[i + 1], t - float(i));
      vec3 normal = normalize(cross(dFdx(eye), dFdy(eye)));
      c = vec4(base * (0.55 + 0.45 * abs(normal.z)), 1.0); }`;
  function shader(type, text) { const s = gl.createShader(type); gl.shaderSource(s, text); gl.compileShader(s);
    if (!gl.getShaderParameter(s, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(s)); return s; }
  const program = gl.createProgram();
  gl.attachShader(program, shader(gl.VERTEX_SHADER, vertex)); gl.attachShader(program, shader(gl.FRAGMENT_SHADER, fragment));
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
  gl.useProgram(program);
  const at = name => gl.getUniformLocation(program, name);
  const where = {}; ["turn", "middle", "pan", "zoom", "factor", "lift", "size", "range", "kind"].forEach(k => where[k] = at(k));
  gl.uniform3fv(at("colours"), scale.flat());
  function attribute(name, width) { const buffer = gl.createBuffer(), slot = gl.getAttribLocation(program, name);
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer); gl.enableVertexAttribArray(slot); gl.vertexAttribPointer(slot, width, gl.FLOAT, false, 0, 0);
    return data => { gl.bindBuffer(gl.ARRAY_BUFFER, buffer); gl.bufferData(gl.ARRAY_BUFFER, data, gl.DYNAMIC_DRAW); }; }
  attribute("place", 3)(points);
  const setMove = attribute("move", 3), setValue = attribute("value", 1);
  function indices(data) { const b = gl.createBuffer(); gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, b);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, data, gl.STATIC_DRAW); return b; }
  const triangleBuffer = indices(triangles), edgeBuffer = indices(edges), one = indices(new Uint32Array([0]));
  gl.enable(gl.DEPTH_TEST); gl.enable(gl.BLEND); gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA); gl.clearColor(1, 1, 1, 1);

  const state = { frame: job.times.length - 1, field: 0, factor: job.factor, pan: [0, 0], zoom: 1, turn: null, chosen: -1, timer: 0 };
  const product = (a, b) => a.map((_, i) => { const r = Math.floor(i / 3), c = i % 3;
    return a[3 * r] * b[c] + a[3 * r + 1] * b[3 + c] + a[3 * r + 2] * b[6 + c]; });   // row by row
  const about = (axis, t) => { const c = Math.cos(t), s = Math.sin(t);
    return axis === 0 ? [1, 0, 0, 0, c, -s, 0, s, c] : axis === 1 ? [c, 0, s, 0, 1, 0, -s, 0, c] : [c, -s, 0, s, c, 0, 0, 0, 1]; };
  const VIEWS = { iso: product(about(0, -1.15), about(2, 0.5)), x: [0, 1, 0, 0, 0, 1, 1, 0, 0], y: [-1, 0, 0, 0, 0, 1, 0, 1, 0],
    z: [1, 0, 0, 0, 1, 0, 0, 0, 1], front: [1, 0, 0, 0, 0, 1, 0, -1, 0] };
  function look(name) { state.turn = VIEWS[name].slice(); state.zoom = 1; fit(); draw(); }
  function fit() {                                     // all of the present frame into the picture, as it is turned now
    const low = [Infinity, Infinity], high = [-Infinity, -Infinity], t = state.turn;
    for (let i = 0; i < n; i++) { const k = 3 * (state.frame * n + i);
      const p = [0, 1, 2].map(d => points[3 * i + d] + state.factor * moves[k + d] - job.middle[d]);
      for (let r = 0; r < 2; r++) { const q = t[3 * r] * p[0] + t[3 * r + 1] * p[1] + t[3 * r + 2] * p[2];
        low[r] = Math.min(low[r], q); high[r] = Math.max(high[r], q); } }
    state.pan = [0, 1].map(r => -(low[r] + high[r]) / 2); state.size = [0, 1].map(r => Math.max(high[r] - low[r], job.radius * 1e-6)); }

  function take() {                                    // the present frame to the graphics card
    const f = job.fields[state.field], k = state.frame, v = f.values.subarray(k * n, (k + 1) * n);
    setMove(moves.subarray(3 * k * n, 3 * (k + 1) * n)); setValue(v);
    const all = find("all").checked ? f.values : v;
    let low = Infinity, high = -Infinity;
    for (let i = 0; i < all.length; i++) { if (all[i] < low) low = all[i]; if (all[i] > high) high = all[i]; }
    state.range = [low, high];
    find("low").textContent = low.toPrecision(4); find("high").textContent = high.toPrecision(4);
    find("time").textContent = "time " + job.times[k].toPrecision(6) + "  (frame " + job.frames[k] + ")";
    find("unit").textContent = f.unit; show();
  }
  function draw() {
    const w = canvas.clientWidth, h = canvas.clientHeight, ratio = window.devicePixelRatio || 1;
    if (canvas.width !== Math.round(w * ratio)) { canvas.width = Math.round(w * ratio); canvas.height = Math.round(h * ratio); }
    gl.viewport(0, 0, canvas.width, canvas.height); gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const near = 1.8 * state.zoom * Math.min(w / h / state.size[0], 1 / state.size[1]), zoom = [near * h / w, near], t = state.turn;
    gl.uniformMatrix3fv(where.turn, false, [t[0], t[3], t[6], t[1], t[4], t[7], t[2], t[5], t[8]]);
    gl.uniform3fv(where.middle, job.middle); gl.uniform2fv(where.pan, state.pan); gl.uniform2fv(where.zoom, zoom);
    gl.uniform1f(where.factor, state.factor); gl.uniform2fv(where.range, state.range);
    gl.uniform1i(where.kind, 0); gl.uniform1f(where.lift, 0); gl.uniform1f(where.size, 1);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, triangleBuffer); gl.drawElements(gl.TRIANGLES, 3 * job.n_bodies, gl.UNSIGNED_INT, 0);
    gl.uniform1i(where.kind, 1); gl.uniform1f(where.lift, 0.0015);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, edgeBuffer);
    if (find("edges").checked) gl.drawElements(gl.LINES, 2 * job.n_sides, gl.UNSIGNED_INT, 0);
    gl.uniform1i(where.kind, 3);                         // trusses and springs are always drawn
    gl.drawElements(gl.LINES, edges.length - 2 * job.n_sides, gl.UNSIGNED_INT, 8 * job.n_sides);
    gl.uniform1i(where.kind, 4); gl.uniform1f(where.lift, 0); gl.depthMask(false);   // analytic surfaces, seen through
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, triangleBuffer);
    gl.drawElements(gl.TRIANGLES, triangles.length - 3 * job.n_bodies, gl.UNSIGNED_INT, 12 * job.n_bodies); gl.depthMask(true);
    if (state.chosen >= 0) { gl.uniform1i(where.kind, 2); gl.uniform1f(where.lift, 0.9); gl.uniform1f(where.size, 14 * ratio);
      gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, one); gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, new Uint32Array([state.chosen]), gl.DYNAMIC_DRAW);
      gl.drawElements(gl.POINTS, 1, gl.UNSIGNED_INT, 0); }
    state.px = zoom; box.dataset.drawn = String(Number(box.dataset.drawn || 0) + 1);
  }
  function onScreen(i) { const k = 3 * (state.frame * n + i), t = state.turn, p = [0, 1, 2].map(d =>
      points[3 * i + d] + state.factor * moves[k + d] - job.middle[d]);
    const q = [0, 3, 6].map(r => t[r] * p[0] + t[r + 1] * p[1] + t[r + 2] * p[2]);
    return [((q[0] + state.pan[0]) * state.px[0] + 1) / 2 * canvas.clientWidth, (1 - (q[1] + state.pan[1]) * state.px[1]) / 2 * canvas.clientHeight, q[2]]; }
  function pick(x, y) { let best = -1, least = 14 * 14, front = -Infinity;
    for (let i = 0; i < n; i++) { const s = onScreen(i), d = (s[0] - x) ** 2 + (s[1] - y) ** 2;
      if (d < least - 9 || (d < least + 9 && s[2] > front)) { best = i; least = Math.min(d, least); front = s[2]; } }
    choose(best); }
  function choose(i) { state.chosen = i; show(); draw(); }
  function show() { const out = find("chosen"), i = state.chosen;
    if (i < 0) { out.textContent = "A click chooses a node."; return; }
    const k = 3 * (state.frame * n + i), f = job.fields[state.field];
    out.textContent = "node " + job.labels[i] + " at (" + [0, 1, 2].map(d => points[3 * i + d].toPrecision(4)).join(", ") + "), U (" +
      [0, 1, 2].map(d => moves[k + d].toPrecision(4)).join(", ") + "), " + f.name + " " + f.values[state.frame * n + i].toPrecision(5); }

  const select = find("field");
  job.fields.forEach((f, i) => select.add(new Option(f.name, i)));
  select.onchange = () => { state.field = Number(select.value); take(); draw(); };
  const slider = find("frame"); slider.max = job.times.length - 1; slider.value = state.frame;
  slider.oninput = () => { state.frame = Number(slider.value); take(); draw(); };
  const factor = find("factor"); factor.value = state.factor;
  factor.oninput = () => { const v = Number(factor.value); if (Number.isFinite(v)) { state.factor = v; fit(); draw(); } };
  find("edges").onchange = draw; find("all").onchange = () => { take(); draw(); };
  find("play").onclick = event => { if (state.timer) { clearInterval(state.timer); state.timer = 0; event.target.textContent = "play"; return; }
    event.target.textContent = "stop";
    state.timer = setInterval(() => { state.frame = (state.frame + 1) % job.times.length; slider.value = state.frame; take(); draw(); }, 180); };
  box.querySelectorAll("[data-view]").forEach(b => b.onclick = () => look(b.dataset.view));
  document.querySelectorAll("button.node").forEach(b => b.onclick = () => {
    const i = nodes.indexOf(Number(b.dataset.node)); choose(i); box.scrollIntoView({ block: "center" });
    if (i < 0) find("chosen").textContent = "Node " + b.textContent + " is inside a body: the view shows the outer faces alone."; });
  let drag = null;
  canvas.onpointerdown = e => { drag = { x: e.clientX, y: e.clientY, far: 0, pans: e.button === 2 || e.shiftKey }; canvas.setPointerCapture(e.pointerId); };
  canvas.onpointermove = e => { if (!drag) return;
    const dx = e.clientX - drag.x, dy = e.clientY - drag.y; drag.x = e.clientX; drag.y = e.clientY; drag.far += Math.abs(dx) + Math.abs(dy);
    if (drag.pans) { state.pan[0] += 2 * dx / canvas.clientWidth / state.px[0]; state.pan[1] -= 2 * dy / canvas.clientHeight / state.px[1]; }
    else state.turn = product(about(0, dy * 0.008), product(about(1, dx * 0.008), state.turn));
    draw(); };
  canvas.onpointerup = e => { if (drag && drag.far < 4) { const r = canvas.getBoundingClientRect(); pick(e.clientX - r.left, e.clientY - r.top); } drag = null; };
  canvas.oncontextmenu = e => e.preventDefault();
  canvas.addEventListener("wheel", e => { e.preventDefault(); state.zoom *= Math.exp(-e.deltaY * 0.0015); draw(); }, { passive: false });
  window.addEventListener("resize", draw);
  take(); look(job.view);
  box.dataset.requests = String(performance.getEntriesByType("resource").filter(r => !r.name.startsWith("data:")).length);
})();
