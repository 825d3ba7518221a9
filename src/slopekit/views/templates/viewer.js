/* slopekit's rotatable view: WebGL 1, no library, no network. MIT licence, as slopekit.
   slopekitView(box, say) makes it in an element: the page of a report, the app, a notebook. A box without a canvas gets
   one with its controls. `show(data)` draws a scene and may be called again, any number of times: buffers are filled
   anew, the eye and the boxes stay as they were set. `picture()` is what is seen, on a canvas; `stop()` ends it.
   `say(text)` is told in words what cannot be shown. */
function slopekitView(box, say) {
  "use strict";
  var undo = [], ended = false, data = null, parts = {};
  function made(tag, name, text, look) {
    var element = document.createElement(tag);
    if (name) { element.className = name; }
    if (text) { element.textContent = text; }
    Object.assign(element.style, look || {});
    return element;
  }
  var own = !box.querySelector("canvas");
  if (own) { furnish(); }
  var canvas = box.querySelector("canvas"), stage = box.querySelector(".stage");
  function part(name) {  // by its id on a page, by its class where several views may stand
    if (parts[name] === undefined) { parts[name] = box.querySelector("#" + name + ", ." + name); }
    return parts[name];
  }
  say = say || function (text) { var p = part("view-none"); if (p) { p.textContent = text; p.hidden = !text; } };
  var gl = null;
  try { gl = canvas.getContext("webgl", { antialias: true, preserveDrawingBuffer: true }); } catch (error) { gl = null; }
  if (!gl) {
    if (own) { box.querySelectorAll(".stage, .controls, .legend").forEach(function (it) { it.style.display = "none"; }); }
    else { box.hidden = true; }
    say("This browser shows no WebGL: the scene cannot be turned here." + (own ? "" : " The pictures below show it."));
    return { works: false, show: function () { return false; }, picture: function () { return null; }, stop: function () {} };
  }
  function listen(name, act) {
    window.addEventListener(name, act);
    undo.push(function () { window.removeEventListener(name, act); });
  }

  // -- a box of its own: canvas, axes, scale, controls; looks are set by script, so that no page's rule forbids them --
  function furnish() {
    var SVG = "http://www.w3.org/2000/svg";
    var stage = made("div", "stage", "", { position: "relative", overflow: "hidden" });
    var surface = made("canvas", "", "", { display: "block", width: "100%", height: "var(--view-height, 420px)",
      touchAction: "none", cursor: "grab" });
    surface.tabIndex = 0; surface.setAttribute("role", "img"); surface.setAttribute("aria-label", "The scene");
    stage.appendChild(surface);
    var svg = document.createElementNS(SVG, "svg");
    [["width", 90], ["height", 90], ["viewBox", "0 0 90 90"], ["aria-hidden", "true"]].forEach(function (pair) {
      svg.setAttribute(pair[0], pair[1]);
    });
    Object.assign(svg.style, { position: "absolute", left: "4px", bottom: "4px", pointerEvents: "none" });
    [["east", "E", "#888", 1.5], ["north", "N", "#d0450a", 3], ["up", "up", "#888", 1.5]].forEach(function (axis) {
      var line = document.createElementNS(SVG, "line"), name = document.createElementNS(SVG, "text");
      line.setAttribute("class", "axis-" + axis[0]); name.setAttribute("class", "axis-" + axis[0] + "-name");
      [["x1", 45], ["y1", 45], ["x2", 45], ["y2", 45], ["stroke", axis[2]], ["stroke-width", axis[3]],
        ["stroke-linecap", "round"]].forEach(function (pair) { line.setAttribute(pair[0], pair[1]); });
      [["x", 45], ["y", 45], ["font-size", 12], ["font-weight", axis[1] === "N" ? 700 : 400], ["fill", axis[2]],
        ["text-anchor", "middle"]].forEach(function (pair) { name.setAttribute(pair[0], pair[1]); });
      name.textContent = axis[1];
      svg.appendChild(line); svg.appendChild(name);
    });
    stage.appendChild(svg);
    var bar = made("div", "scalebar", "", { position: "absolute", right: "14px", bottom: "12px", textAlign: "center",
      fontSize: "12px", pointerEvents: "none" });
    bar.appendChild(made("span", "scale-text"));
    bar.appendChild(made("i", "scale-bar", "", { display: "block", height: "5px", border: "1.5px solid currentColor",
      borderTop: "0" }));
    stage.appendChild(bar);
    var buttons = made("div", "view-buttons", "", { position: "absolute", right: "8px", top: "8px", display: "flex", gap: "4px" });
    [["v-reset", "reset", "reset the view"], ["v-top", "top", "from above"], ["v-side", "side", "turn by 90 degrees"],
      ["v-in", "+", "nearer"], ["v-out", "\u2212", "farther"]].forEach(function (one) {
      var button = made("button", one[0], one[1]);
      button.type = "button"; button.title = one[2]; button.setAttribute("aria-label", one[2]);
      buttons.appendChild(button);
    });
    stage.appendChild(buttons);
    box.appendChild(stage);
    var none = made("p", "view-none"); none.hidden = true; box.appendChild(none);
    var legend = made("div", "legend view-legend", "", { display: "flex", flexWrap: "wrap", gap: "2px 14px", fontSize: "12px",
      minHeight: "18px", margin: "4px 0" });
    box.appendChild(legend);
    var more = made("details", "controls", "", { fontSize: "13px" });
    more.appendChild(made("summary", "", "What is shown"));
    var row = made("div", "view-row", "", { display: "flex", flexWrap: "wrap", gap: "4px 14px", alignItems: "center" });
    [["blocks", "blocks"], ["clear", "see through"], ["edges", "edges"], ["names", "names"], ["rock", "bedrock"],
      ["joints", "joints"], ["stick", "stick"], ["slip", "slip"], ["open", "open"], ["bolts", "bolts"],
      ["numbers", "their numbers"], ["loads", "loads"], ["contact", "contact forces"]].forEach(function (one) {
      var label = made("label"), tick = made("input", "v-" + one[0]);
      tick.type = "checkbox"; label.appendChild(tick); label.appendChild(document.createTextNode(" " + one[1]));
      row.appendChild(label);
    });
    [["v-pair", "pairs by", [["mode", "contact mode"], ["kpa", "normal traction"]]], ["v-colour", "blocks by", [
      ["plain", "plain"], ["face", "joint face"], ["block", "block"], ["factor", "factor of safety"],
      ["order", "order of failure"]]]].forEach(function (one) {
      var label = made("label", "", one[1] + " "), list = made("select", one[0]);
      one[2].forEach(function (pair) { var item = made("option", "", pair[1]); item.value = pair[0]; list.appendChild(item); });
      label.appendChild(list); row.appendChild(label);
    });
    [["v-explode", "apart"], ["v-along", "along the mechanism"]].forEach(function (one) {
      var label = made("label", "", one[1] + " "), slider = made("input", one[0], "", { verticalAlign: "middle" });
      slider.type = "range"; slider.min = 0; slider.max = 1; slider.step = 0.01; slider.value = 0;
      label.appendChild(slider); row.appendChild(label);
    });
    more.appendChild(row);
    box.appendChild(more);
  }
  // -- data ---------------------------------------------------------------------------------------------------------
  function unpack(packed) {
    var text = atob(packed.base64), bytes = new Uint8Array(text.length);
    for (var i = 0; i < text.length; i++) { bytes[i] = text.charCodeAt(i); }
    return packed.type === "f32" ? new Float32Array(bytes.buffer) : new Int32Array(bytes.buffer);
  }
  var count, size, moving;
  function vec(array, i) { return [array[3 * i], array[3 * i + 1], array[3 * i + 2]]; }
  function add(a, b) { return [a[0] + b[0], a[1] + b[1], a[2] + b[2]]; }
  function sub(a, b) { return [a[0] - b[0], a[1] - b[1], a[2] - b[2]]; }
  function mul(a, s) { return [a[0] * s, a[1] * s, a[2] * s]; }
  function dot(a, b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
  function cross(a, b) { return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]; }
  function unit(a) { var l = Math.sqrt(dot(a, a)); return l > 0 ? mul(a, 1 / l) : [0, 0, 1]; }
  function away(block) { return block < 0 ? [0, 0, 0] : vec(data.explode, block); }
  function moves(block, p) {  // u + w x (p - c)
    if (block < 0) { return [0, 0, 0]; }
    var v = data.velocity, k = 6 * block;
    return add([v[k], v[k + 1], v[k + 2]], cross([v[k + 3], v[k + 4], v[k + 5]], sub(p, vec(data.centroids, block))));
  }

  // -- colours: those of the other pictures -------------------------------------------------------------------------
  var PALETTE, ROCK, BLOCK, GREY, MODE;
  var RAMP = { factor: ["#c8500a", "#f2d58a", "#0064a4"], order: ["#c8500a", "#e69f00", "#f0e442", "#56b4e9"],
    kpa: ["#fff7bc", "#fe9929", "#8c2d04"] };
  function rgb(hex) {
    return [1, 3, 5].map(function (i) { return parseInt(hex.substr(i, 2), 16) / 255; });
  }
  function ramp(stops, t) {
    t = Math.min(Math.max(t, 0), 1) * (stops.length - 1);
    var i = Math.min(Math.floor(t), stops.length - 2), a = rgb(stops[i]), b = rgb(stops[i + 1]);
    return add(a, mul(sub(b, a), t - i));
  }
  function css(colour) {
    return "rgb(" + colour.map(function (part) { return Math.round(255 * part); }).join(",") + ")";
  }
  function figure(value) {
    var size = Math.abs(value);
    return size >= 1e5 || (size > 0 && size < 1e-3) ? value.toExponential(2) : String(Number(value.toPrecision(4)));
  }
  function range(values) {
    var low = Infinity, high = -Infinity;
    for (var i = 0; i < values.length; i++) {
      if (values[i] !== null && isFinite(values[i])) { low = Math.min(low, values[i]); high = Math.max(high, values[i]); }
    }
    return [low, high];
  }

  // -- what is drawn ------------------------------------------------------------------------------------------------
  var PARTS = ["p", "n", "c", "e", "m"];
  function Group(mode) {
    this.mode = mode; this.count = 0; this.clear();
    this.buffers = PARTS.map(function () { return gl.createBuffer(); });
  }
  Group.prototype.clear = function () { var self = this; PARTS.forEach(function (name) { self[name] = []; }); };
  Group.prototype.put = function (p, n, colour, block) {
    var e = away(block), m = moves(block, p);
    this.p.push(p[0], p[1], p[2]); this.n.push(n[0], n[1], n[2]); this.c.push(colour[0], colour[1], colour[2]);
    this.e.push(e[0], e[1], e[2]); this.m.push(m[0], m[1], m[2]);
  };
  Group.prototype.load = function () {  // what is with the card is not kept here
    var self = this;
    self.count = self.p.length / 3;
    PARTS.forEach(function (name, j) {
      gl.bindBuffer(gl.ARRAY_BUFFER, self.buffers[j]);
      gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(self[name]), gl.STATIC_DRAW);
    });
    self.clear();
  };
  Group.prototype.recolour = function (colours) {
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffers[2]);
    gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(colours), gl.STATIC_DRAW);
  };

  var groups = {}, owner = {}, pairsOf = [], longestLoad = 0, longestContact = 0, bolts = 0;
  var KINDS = { rock: gl.TRIANGLES, blocks: gl.TRIANGLES, edges: gl.LINES, rockEdges: gl.LINES, joints: gl.TRIANGLES,
    outline: gl.LINES, loads: gl.TRIANGLES, contact: gl.TRIANGLES, bolts: gl.TRIANGLES };
  Object.keys(KINDS).forEach(function (name) { groups[name] = new Group(KINDS[name]); });
  function arrow(group, tail, force, length, colour, block) {
    var way = unit(force), side = unit(cross(way, Math.abs(way[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0])), up = cross(side, way);
    var normal;
    var thick = Math.min(0.0035 * size, 0.06 * length), head = Math.min(0.3 * length, 9 * thick);
    var neck = add(tail, mul(way, length - head)), tip = add(tail, mul(way, length)), ring = [], n = 8, j;
    for (j = 0; j < n; j++) {
      ring.push(add(mul(side, Math.cos(2 * Math.PI * j / n)), mul(up, Math.sin(2 * Math.PI * j / n))));
    }
    function at(centre, j, radius) { return add(centre, mul(ring[j % n], radius)); }
    function face(a, b, c, normal) { [a, b, c].forEach(function (p) { group.put(p, normal, colour, block); }); }
    for (j = 0; j < n; j++) {
      normal = ring[j];
      face(at(tail, j, thick), at(tail, j + 1, thick), at(neck, j, thick), normal);
      face(at(tail, j + 1, thick), at(neck, j + 1, thick), at(neck, j, thick), normal);
      face(at(neck, j, 3 * thick), at(neck, j + 1, 3 * thick), tip, normal);
    }
  }
  function arrows(group, at, force, blocks, into, colours, what) {
    var longest = 0, i, own;
    for (i = 0; i < force.length / 3; i++) { longest = Math.max(longest, Math.sqrt(dot(vec(force, i), vec(force, i)))); }
    for (i = 0; i < force.length / 3; i++) {
      own = Math.sqrt(dot(vec(force, i), vec(force, i)));
      if (own > 1e-3 * longest) {
        var length = 0.25 * size * own / longest, tail = vec(at, i);
        if (into) { tail = sub(tail, mul(unit(vec(force, i)), length)); }
        arrow(group, tail, vec(force, i), length, rgb(colours[what ? what[i] % colours.length : 0]), blocks[i]);
      }
    }
    return longest;
  }
  var LOADS = ["#333333", "#0072b2", "#009e73", "#cc79a7", "#e69f00"];
  function square(way) {  // two ways square to one
    var side = unit(cross(Math.abs(way[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0], way));
    return [side, cross(way, side)];
  }
  function prism(group, from, to, ring, colour, block) {  // between two rings about two points, closed at its far end
    var n = ring.length, j;
    function face(a, b, c, normal) { [a, b, c].forEach(function (p) { group.put(p, normal, colour, block); }); }
    for (j = 0; j < n; j++) {
      var a = ring[j], b = ring[(j + 1) % n], normal = unit(add(a, b));
      face(add(from, a), add(from, b), add(to, a), normal);
      face(add(from, b), add(to, b), add(to, a), normal);
      face(add(to, a), add(to, b), to, unit(sub(to, from)));
    }
  }
  function fill() {
    data.modes.forEach(function (mode) { if (!groups["pairs-" + mode]) { groups["pairs-" + mode] = new Group(gl.POINTS); } });
    owner = { rock: [], blocks: [] };  // triangle of each drawn one
    var i, k, block, corners, normal, colour;
    for (i = 0; i < data.triangle_block.length; i++) {
      block = data.triangle_block[i];
      corners = [0, 1, 2].map(function (j) { return vec(data.vertices, data.triangles[3 * i + j]); });
      normal = unit(cross(sub(corners[1], corners[0]), sub(corners[2], corners[0])));
      k = data.fixed[block] ? "rock" : "blocks";
      owner[k].push(i);
      corners.forEach(function (corner) { groups[k].put(corner, normal, rgb(ROCK), block); });
    }
    var blockOf = new Int32Array(data.vertices.length / 3);
    for (i = 0; i < data.triangles.length; i++) { blockOf[data.triangles[i]] = data.triangle_block[Math.floor(i / 3)]; }
    for (i = 0; i < data.edges.length; i++) {
      block = blockOf[data.edges[i]];
      groups[data.fixed[block] ? "rockEdges" : "edges"].put(
        vec(data.vertices, data.edges[i]), [0, 0, 0], data.fixed[block] ? [0.55, 0.53, 0.5] : [0.15, 0.15, 0.15], block);
    }
    for (i = 0; i < data.joint_of.length; i++) {
      corners = [0, 1, 2].map(function (j) { return vec(data.joint_corners, 3 * i + j); });
      normal = unit(cross(sub(corners[1], corners[0]), sub(corners[2], corners[0])));
      colour = rgb(PALETTE[data.joint_of[i] % PALETTE.length]);
      corners.forEach(function (corner) { groups.joints.put(corner, normal, colour, data.joint_block[i]); });
    }
    for (i = 0; i < data.joint_outline.length / 3; i++) {
      groups.outline.put(vec(data.joint_outline, i), [0, 0, 0], [0.3, 0.3, 0.3], -1);
    }
    pairsOf = data.modes.map(function () { return []; });
    for (i = 0; i < data.pair_mode.length; i++) {
      pairsOf[data.pair_mode[i]].push(i);
      groups["pairs-" + data.modes[data.pair_mode[i]]].put(
        vec(data.pairs, i), [0, 0, 0], rgb(MODE[data.pair_mode[i]]), data.pair_block[i]);
    }
    longestLoad = arrows(groups.loads, data.load_at, data.load_kn, data.load_block, true, LOADS, data.load_what);
    longestContact = arrows(groups.contact, data.pairs, data.pair_kn, data.pair_block, false, ["#8a1a6b"], null);
    bolts = data.bolt_number.length;
    for (i = 0; i < bolts; i++) {
      var head = vec(data.bolt_heads, i), end = vec(data.bolt_ends, i), out = vec(data.bolt_plates, i);
      var steel = rgb(data.bolt_colours[data.bolt_passive[i]]), wide = data.bolt_plate_m, about, ring = [];
      about = square(unit(sub(end, head)));
      for (k = 0; k < 6; k++) {
        ring.push(mul(add(mul(about[0], Math.cos(Math.PI * k / 3)), mul(about[1], Math.sin(Math.PI * k / 3))), wide / 6));
      }
      prism(groups.bolts, head, end, ring, steel, data.bolt_block[i]);
      about = square(out);
      ring = [[1, 1], [-1, 1], [-1, -1], [1, -1]].map(function (at) {
        return mul(add(mul(about[0], at[0]), mul(about[1], at[1])), wide / 2);
      });
      prism(groups.bolts, head, add(head, mul(out, 0.2 * wide)), ring, steel, data.bolt_block[i]);
    }
    Object.keys(groups).forEach(function (name) { groups[name].load(); });
  }

  // -- shaders ------------------------------------------------------------------------------------------------------
  var VERTEX = "attribute vec3 p, n, c, e, m; uniform mat4 look; uniform vec3 eye; uniform float explode, along, lit," +
    " bias, spot; varying vec3 colour; void main() { gl_Position = look * vec4(p + explode * e + along * m, 1.0);" +
    " gl_Position.z -= bias; gl_PointSize = spot;" +
    " colour = lit > 0.5 ? c * (0.5 + 0.5 * abs(dot(n, eye))) : c; }";
  var FRAGMENT = "precision mediump float; varying vec3 colour; uniform float alpha, round; void main() {" +
    " if (round > 0.5) { float r = length(gl_PointCoord - 0.5); if (r > 0.5) discard;" +
    " gl_FragColor = vec4(r > 0.36 ? vec3(0.1) : colour, 1.0); } else gl_FragColor = vec4(colour, alpha); }";
  function compiled(kind, source) {
    var shader = gl.createShader(kind);
    gl.shaderSource(shader, source); gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) { throw new Error(gl.getShaderInfoLog(shader)); }
    return shader;
  }
  var program = gl.createProgram();
  gl.attachShader(program, compiled(gl.VERTEX_SHADER, VERTEX));
  gl.attachShader(program, compiled(gl.FRAGMENT_SHADER, FRAGMENT));
  gl.linkProgram(program); gl.useProgram(program);
  var slots = PARTS.map(function (name) { return gl.getAttribLocation(program, name); });
  var uniform = {};
  ["look", "eye", "explode", "along", "lit", "bias", "spot", "alpha", "round"].forEach(function (name) {
    uniform[name] = gl.getUniformLocation(program, name);
  });

  // -- the eye: orthographic, so that the scale bar holds everywhere -------------------------------------------------
  var start = { bearing: 0, above: 0 }, eye = { bearing: 0, above: 0, zoom: 1, pan: [0, 0, 0] }, waiting = false;
  function reset() { eye = { bearing: start.bearing, above: start.above, zoom: 1, pan: [0, 0, 0] }; ask(); }
  function axes() {
    var a = eye.bearing * Math.PI / 180, e = eye.above * Math.PI / 180;
    var back = [Math.sin(a) * Math.cos(e), Math.cos(a) * Math.cos(e), Math.sin(e)];
    var right = [-Math.cos(a), Math.sin(a), 0];
    return { right: right, up: cross(back, right), back: back };
  }
  var reach = [1, 1];  // how far the scene goes to the side and up, seen as at first
  function measure() {
    var was = eye, axis, i, p;
    eye = start;
    axis = axes(); reach = [1e-3 * size, 1e-3 * size];
    for (i = 0; i < data.vertices.length / 3; i++) {
      p = vec(data.vertices, i);
      reach[0] = Math.max(reach[0], Math.abs(dot(p, axis.right))); reach[1] = Math.max(reach[1], Math.abs(dot(p, axis.up)));
    }
    eye = was;
  }
  var paper = [1, 1, 1];
  function half() {  // metres from the middle of the view to its upper edge
    var tall = Math.max(canvas.clientHeight, 1), free = Math.max(tall - 80, tall / 2, 1);  // below the buttons
    return Math.max(1.05 * reach[1] * tall / free, 1.2 * reach[0] * tall / Math.max(canvas.clientWidth, 1)) / eye.zoom;
  }
  function ticked(id) { var input = part(id); return !!input && input.checked; }
  function value(id) { var input = part(id); return input ? Number(input.value) : 0; }
  function ask() { if (!waiting) { waiting = true; window.requestAnimationFrame(draw); } }

  function put(name, options) {
    var group = groups[name];
    if (!group.count) { return; }
    slots.forEach(function (slot, j) {
      if (slot < 0) { return; }
      gl.bindBuffer(gl.ARRAY_BUFFER, group.buffers[j]);
      gl.enableVertexAttribArray(slot); gl.vertexAttribPointer(slot, 3, gl.FLOAT, false, 0, 0);
    });
    gl.uniform1f(uniform.lit, options.lit ? 1 : 0); gl.uniform1f(uniform.bias, options.bias || 0);
    gl.uniform1f(uniform.alpha, options.alpha || 1); gl.uniform1f(uniform.round, group.mode === gl.POINTS ? 1 : 0);
    var clear = options.alpha && options.alpha < 1;
    if (clear) { gl.enable(gl.BLEND); gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA); gl.depthMask(false); }
    gl.drawArrays(group.mode, 0, group.count);
    gl.disable(gl.BLEND); gl.depthMask(true);
  }

  function draw() {
    waiting = false;
    if (ended || !data) { return; }
    var sharp = Math.min(window.devicePixelRatio || 1, 2);
    var width = Math.max(Math.round(canvas.clientWidth * sharp), 1);
    var height = Math.max(Math.round(canvas.clientHeight * sharp), 1);
    if (canvas.width !== width || canvas.height !== height) { canvas.width = width; canvas.height = height; }
    gl.viewport(0, 0, width, height);
    gl.clearColor(paper[0], paper[1], paper[2], 1); gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT); gl.enable(gl.DEPTH_TEST);
    var axis = axes(), h = half(), w = h * width / height, deep = 4 * size;
    var r = mul(axis.right, 1 / w), u = mul(axis.up, 1 / h), b = mul(axis.back, -1 / deep), c = eye.pan;
    gl.uniformMatrix4fv(uniform.look, false, new Float32Array([
      r[0], u[0], b[0], 0, r[1], u[1], b[1], 0, r[2], u[2], b[2], 0, -dot(r, c), -dot(u, c), -dot(b, c), 1]));
    gl.uniform3fv(uniform.eye, new Float32Array(unit(add(axis.back, mul(axis.up, 0.5)))));
    gl.uniform1f(uniform.explode, value("v-explode")); gl.uniform1f(uniform.along, value("v-along"));
    gl.uniform1f(uniform.spot, (data.pair_mode.length > 400 ? 5 : 9) * sharp);
    var clear = ticked("v-clear");
    if (ticked("v-rock")) { put("rock", { lit: true }); if (ticked("v-edges")) { put("rockEdges", { bias: 1e-3 }); } }
    if (ticked("v-blocks") && !clear) { put("blocks", { lit: true }); }
    if (ticked("v-joints")) { put("joints", { lit: true, bias: 3e-4 }); put("outline", { bias: 1e-3 }); }
    if (ticked("v-blocks") && ticked("v-edges")) { put("edges", { bias: 1.2e-3 }); }
    if (ticked("v-loads")) { put("loads", { lit: true }); }
    if (ticked("v-contact")) { put("contact", { lit: true }); }
    if (ticked("v-bolts")) { put("bolts", { lit: true, bias: 0.3 }); }  // before all else: rock hides no rod
    data.modes.forEach(function (mode) { if (ticked("v-" + mode)) { put("pairs-" + mode, { bias: 2e-3 }); } });
    if (ticked("v-blocks") && clear) { put("blocks", { lit: true, alpha: 0.28 }); }
    marks(axis, h);
    canvas.setAttribute("data-drawn", String(Number(canvas.getAttribute("data-drawn") || 0) + 1));
    canvas.setAttribute("aria-label", "The scene, seen from " + Math.round((eye.bearing + 360) % 360) + " degrees, " +
      Math.round(eye.above) + " degrees above the horizon");
  }

  // north arrow, scale bar, names
  var axisLines = ["east", "north", "up"].map(function (name) { return part("axis-" + name); });
  var axisNames = ["east", "north", "up"].map(function (name) { return part("axis-" + name + "-name"); });
  var tags = [], boltTags = [];
  function tagOf(text, hidden) {
    var tag = made("span", "tag", text, own ? { position: "absolute", transform: "translate(-50%, -50%)", fontSize: "11px",
      background: "rgba(255,255,255,.8)", color: "#1c1c1c", padding: "0 2px", borderRadius: "2px", pointerEvents: "none" } : {});
    tag.hidden = hidden;
    stage.appendChild(tag);
    return tag;
  }
  function label() {
    tags.concat(boltTags).forEach(function (tag) { if (tag) { tag.remove(); } });
    tags = data.names.map(function (name, j) { return data.fixed[j] || moving > 60 ? null : tagOf(name, false); });
    boltTags = [];
    for (var i = 0; i < bolts && bolts <= 1000; i++) { boltTags.push(tagOf(String(data.bolt_number[i]), true)); }
  }
  function markBolts(axis, perPixel, explode, along) {  // a number that would lie on another, or on the axes, is left out
    var taken = [], wide = canvas.clientWidth, high = canvas.clientHeight;
    boltTags.forEach(function (tag, j) {
      tag.hidden = !ticked("v-numbers");
      if (tag.hidden) { return; }
      var c = vec(data.bolt_heads, j), block = data.bolt_block[j];
      var p = sub(add(add(c, mul(away(block), explode)), mul(moves(block, c), along)), eye.pan);
      var x = wide / 2 + dot(p, axis.right) / perPixel, y = high / 2 - dot(p, axis.up) / perPixel - 12;
      var free = x > 8 && x < wide - 8 && y > 8 && !(x < 108 && y > high - 108) && !(x > wide - 180 && y > high - 44);
      tag.hidden = !free || taken.some(function (at) { return Math.abs(at[0] - x) < 22 && Math.abs(at[1] - y) < 14; });
      if (tag.hidden) { return; }
      taken.push([x, y]); tag.style.left = x + "px"; tag.style.top = y + "px";
    });
  }
  function marks(axis, h) {
    var places = [];
    [[1, 0, 0], [0, 1, 0], [0, 0, 1]].forEach(function (way, j) {
      var x = 45 + 30 * dot(way, axis.right), y = 45 - 30 * dot(way, axis.up);
      axisLines[j].setAttribute("x2", x); axisLines[j].setAttribute("y2", y);
      var at = [45 + 1.3 * (x - 45), 45 + 1.3 * (y - 45) + 4];
      axisNames[j].setAttribute("x", at[0]); axisNames[j].setAttribute("y", at[1]);
      places[j] = at;
    });
    [1, 0, 2].forEach(function (j, turn, order) {  // north first; what would lie on another name is left out
      var free = order.slice(0, turn).every(function (i) {
        return axisNames[i].style.display === "none" || Math.abs(places[i][0] - places[j][0]) > 17 ||
          Math.abs(places[i][1] - places[j][1]) > 14;
      });
      axisNames[j].style.display = free ? "" : "none";
    });
    var perPixel = 2 * h / Math.max(canvas.clientHeight, 1), wide = 110 * perPixel;
    var power = Math.pow(10, Math.floor(Math.log(wide) / Math.LN10)), first = wide / power;
    var length = power * (first >= 5 ? 5 : first >= 2 ? 2 : 1);
    part("scale-bar").style.width = length / perPixel + "px";
    part("scale-text").textContent = length >= 1 ? length + " m" : figure(length * 1000) + " mm";
    var named = ticked("v-names"), explode = value("v-explode"), along = value("v-along");
    markBolts(axis, perPixel, explode, along);
    tags.forEach(function (tag, j) {
      if (!tag) { return; }
      tag.hidden = !named;
      if (!named) { return; }
      var c = vec(data.centroids, j), p = sub(add(add(c, mul(away(j), explode)), mul(moves(j, c), along)), eye.pan);
      tag.style.left = canvas.clientWidth / 2 + dot(p, axis.right) / perPixel + "px";
      tag.style.top = canvas.clientHeight / 2 - dot(p, axis.up) / perPixel + "px";
    });
  }

  // -- colour by ----------------------------------------------------------------------------------------------------
  var legend = part("view-legend");
  function key(colour, text) {
    var item = document.createElement("span"), spot = document.createElement("i");
    spot.style.background = colour;
    if (own) { Object.assign(spot.style, { display: "inline-block", width: "11px", height: "11px", marginRight: "4px" }); }
    item.appendChild(spot); item.appendChild(document.createTextNode(text));
    return item;
  }
  function scale(stops, low, high, unit) {
    if (low === high) { return key(css(ramp(stops, 0)), figure(low) + unit); }
    var item = document.createElement("span"), bar = document.createElement("b");
    bar.style.background = "linear-gradient(to right," + stops.join(",") + ")";
    if (own) { Object.assign(bar.style, { display: "inline-block", width: "80px", height: "10px", margin: "0 5px" }); }
    item.appendChild(document.createTextNode(figure(low))); item.appendChild(bar);
    item.appendChild(document.createTextNode(figure(high) + unit));
    return item;
  }
  function colours() {
    var by = part("v-colour").value, last = Math.max.apply(null, data.order.concat([0]));
    var ends = range(data.factor), parts = [];
    function of(triangle) {
      var block = data.triangle_block[triangle], face = data.triangle_face[triangle];
      if (by === "face") { return face < 0 ? rgb(BLOCK) : rgb(faceColour(face)); }
      if (by === "block") { return rgb(PALETTE[block % PALETTE.length]); }
      if (by === "factor") {
        var own = data.factor[block];
        if (data.unsettled[block]) { return rgb(data.unsettled_colour); }
        if (own === null && data.falls[block]) { return rgb(data.falls_colour); }
        return own === null ? rgb(GREY) : ramp(RAMP.factor, ends[1] > ends[0] ? (own - ends[0]) / (ends[1] - ends[0]) : 0);
      }
      if (by === "order") {
        var place = data.order[block];
        if (data.unsettled[block]) { return rgb(data.unsettled_colour); }
        return place ? ramp(RAMP.order, last > 1 ? (place - 1) / (last - 1) : 0) : rgb(GREY);
      }
      return rgb(data.plain[block]);
    }
    function any(wanted) { return data.fixed.some(function (fixed, j) { return !fixed && wanted(j); }); }
    function special(falls) {
      if (falls && any(function (j) { return data.falls[j] && data.factor[j] === null; })) {
        parts.push(key(data.falls_colour, "fails whatever the strength"));
      }
      if (any(function (j) { return data.unsettled[j]; })) { parts.push(key(data.unsettled_colour, "not settled")); }
    }
    var list = [];
    owner.blocks.forEach(function (triangle) { var c = of(triangle); for (var j = 0; j < 3; j++) { list.push(c[0], c[1], c[2]); } });
    groups.blocks.recolour(list);
    if (by === "face") {
      data.faces.forEach(function (name, j) { parts.push(key(faceColour(j), name)); });
    } else if (by === "factor") {
      if (isFinite(ends[0])) { parts.push(scale(RAMP.factor, ends[0], ends[1], " factor of safety")); }
      special(true);
      if (any(function (j) { return data.factor[j] === null && !data.falls[j] && !data.unsettled[j]; })) {
        parts.push(key(GREY, "no factor: stable, or not analysed"));
      }
    } else if (by === "order") {
      if (last > 1) { parts.push(scale(RAMP.order, 1, last, " (1 fails first)")); }
      if (last === 1) { parts.push(key(css(ramp(RAMP.order, 0)), "fails first")); }
      special(false);
      if (any(function (j) { return !data.order[j]; })) { parts.push(key(GREY, last ? "stable, or not analysed" : "no mechanism")); }
    } else if (by === "plain" && moving > 1) {
      if (any(function (j) { return data.order[j] === 1; })) { parts.push(key(BLOCK, "moves first")); }
      if (any(function (j) { return data.order[j] !== 1; })) { parts.push(key(GREY, "other blocks")); }
    }
    if (ticked("v-joints")) {
      data.joints.forEach(function (name, j) {
        if (by !== "face" || data.faces.indexOf(name) < 0) { parts.push(key(PALETTE[j % PALETTE.length], "joint " + name)); }
      });
    }
    parts = parts.concat(pairColours());
    [0, 1].forEach(function (passive) {
      var own = Array.prototype.filter.call(data.bolt_kn, function (_, j) { return data.bolt_passive[j] === passive; });
      if (!ticked("v-bolts") || !own.length) { return; }
      var ends = range(own), low = figure(ends[0]), high = figure(ends[1]);
      parts.push(key(data.bolt_colours[passive], own.length + (passive ? " passive" : " active") + " bolt" +
        (own.length > 1 ? "s, " : ", ") + (low === high ? low : low + " to " + high) + " kN"));
    });
    if (ticked("v-loads") && longestLoad) { parts.push(key(LOADS[0], "loads (longest " + figure(longestLoad) + " kN): " + loadNames())); }
    if (ticked("v-contact") && longestContact) { parts.push(key("#8a1a6b", "contact forces (longest " + figure(longestContact) + " kN)")); }
    legend.textContent = "";
    parts.forEach(function (part) { legend.appendChild(part); });
  }
  function loadNames() {  // many bolts or forces in one word
    var many = {}, names = [];
    data.load_names.forEach(function (name) {
      var found = /^(active bolt|passive bolt|force) \d+/.exec(name), word = found ? found[1] : name;
      if (!many[word]) { names.push(word); }
      many[word] = { count: (many[word] ? many[word].count : 0) + 1, name: name };
    });
    return names.map(function (word) {
      return many[word].count > 1 ? many[word].count + " " + word + "s" : many[word].name;
    }).join(", ");
  }
  function faceColour(face) {
    var joint = data.joints.indexOf(data.faces[face]);
    return joint >= 0 ? PALETTE[joint % PALETTE.length] : face % 2 ? "#f0d3a8" : "#e8bd88";
  }
  function pairColours() {
    var by = part("v-pair").value, ends = range(data.pair_kpa), parts = [], any = false;
    data.modes.forEach(function (mode, j) {
      var list = [];
      pairsOf[j].forEach(function (pair) {
        var c = by === "mode" ? rgb(MODE[j]) : ramp(RAMP.kpa, ends[1] > ends[0] ? (data.pair_kpa[pair] - ends[0]) / (ends[1] - ends[0]) : 0);
        list.push(c[0], c[1], c[2]);
      });
      groups["pairs-" + mode].recolour(list);
      if (ticked("v-" + mode) && pairsOf[j].length) { any = true; if (by === "mode") { parts.push(key(MODE[j], "pairs: " + mode)); } }
    });
    if (any && by !== "mode" && isFinite(ends[0])) { parts.push(scale(RAMP.kpa, ends[0], ends[1], " kPa normal traction")); }
    return parts;
  }

  // -- hands --------------------------------------------------------------------------------------------------------
  function turn(dx, dy) {
    eye.bearing = (eye.bearing + 0.5 * dx + 360) % 360;
    eye.above = Math.min(Math.max(eye.above + 0.5 * dy, -90), 90);
    ask();
  }
  function shift(dx, dy) {
    var axis = axes(), perPixel = 2 * half() / canvas.clientHeight;
    eye.pan = add(eye.pan, add(mul(axis.right, -dx * perPixel), mul(axis.up, dy * perPixel)));
    ask();
  }
  function zoom(by) { eye.zoom = Math.min(Math.max(eye.zoom * by, 0.2), 50); ask(); }
  var fingers = {}, apart = 0;
  function spread() {
    var ids = Object.keys(fingers), a = fingers[ids[0]], b = fingers[ids[1]];
    return Math.hypot(a.x - b.x, a.y - b.y);
  }
  canvas.addEventListener("pointerdown", function (event) {
    try { canvas.setPointerCapture(event.pointerId); } catch (error) { /* a made-up pointer */ }
    fingers[event.pointerId] = { x: event.clientX, y: event.clientY };
    if (Object.keys(fingers).length === 2) { apart = spread(); }
  });
  canvas.addEventListener("pointermove", function (event) {
    var finger = fingers[event.pointerId];
    if (!finger) { return; }
    var dx = event.clientX - finger.x, dy = event.clientY - finger.y, held = Object.keys(fingers).length;
    finger.x = event.clientX; finger.y = event.clientY;
    if (held === 1 && !event.shiftKey && event.buttons !== 2) { turn(dx, dy); return; }
    shift(dx / held, dy / held);
    if (held === 2) { var now = spread(); if (apart > 0 && now > 0) { zoom(now / apart); } apart = now; }
  });
  ["pointerup", "pointercancel"].forEach(function (name) {
    canvas.addEventListener(name, function (event) { delete fingers[event.pointerId]; });
  });
  canvas.addEventListener("contextmenu", function (event) { event.preventDefault(); });
  canvas.addEventListener("wheel", function (event) {
    event.preventDefault(); zoom(Math.exp(-0.001 * event.deltaY));
  }, { passive: false });
  canvas.addEventListener("keydown", function (event) {
    var step = { ArrowLeft: [-20, 0], ArrowRight: [20, 0], ArrowUp: [0, 20], ArrowDown: [0, -20] }[event.key];
    if (step) { if (event.shiftKey) { shift(step[0], -step[1]); } else { turn(step[0], step[1]); } }
    else if (event.key === "+" || event.key === "=") { zoom(1.2); }
    else if (event.key === "-") { zoom(1 / 1.2); }
    else if (event.key === "0") { reset(); }
    else { return; }
    event.preventDefault();
  });
  function on(id, act) { part(id).addEventListener("click", act); }
  on("v-reset", function () {
    ["v-explode", "v-along"].forEach(function (id) { part(id).value = 0; });
    reset();
  });
  on("v-in", function () { zoom(1.25); });
  on("v-out", function () { zoom(0.8); });
  on("v-top", function () { eye.bearing = 180; eye.above = 90; ask(); });
  on("v-side", function () { eye.bearing = (eye.bearing + 90) % 360; eye.above = 0; ask(); });
  box.querySelectorAll("input, select").forEach(function (input) {
    input.addEventListener("input", function () { if (data) { colours(); ask(); } });
  });
  listen("resize", ask);
  if (window.ResizeObserver) {
    var watch = new ResizeObserver(ask);
    watch.observe(canvas);
    undo.push(function () { watch.disconnect(); });
  }
  canvas.addEventListener("webglcontextlost", function () {
    if (!ended) { say("The browser has taken the view's memory away: load the page again to turn it."); }
  });

  // what is seen, with its arrows, names and scale: a report prints it
  function picture() {
    draw();
    var sheet = document.createElement("canvas"), pen = sheet.getContext("2d");
    sheet.width = canvas.width; sheet.height = canvas.height;
    pen.drawImage(canvas, 0, 0);
    var wide = canvas.clientWidth, high = canvas.clientHeight, sharp = canvas.width / Math.max(wide, 1);
    pen.scale(sharp, sharp);
    function write(text, x, y, colour, font) {
      pen.font = font; pen.textAlign = "center"; pen.lineWidth = 3; pen.strokeStyle = "#fff"; pen.fillStyle = colour;
      pen.strokeText(text, x, y); pen.fillText(text, x, y);
    }
    function line(points, colour, width) {
      pen.beginPath(); pen.strokeStyle = colour; pen.lineWidth = width;
      points.forEach(function (p, j) { if (j) { pen.lineTo(p[0], p[1]); } else { pen.moveTo(p[0], p[1]); } });
      pen.stroke();
    }
    var left = 4, top = high - 94, name, length;
    axisLines.forEach(function (own, j) {
      var colour = own.getAttribute("stroke");
      line([[left + 45, top + 45], [left + Number(own.getAttribute("x2")), top + Number(own.getAttribute("y2"))]],
        colour, Number(own.getAttribute("stroke-width")));
      name = axisNames[j];
      if (name.style.display !== "none") {
        write(name.textContent, left + Number(name.getAttribute("x")), top + Number(name.getAttribute("y")), colour,
          (j === 1 ? "bold " : "") + "12px sans-serif");
      }
    });
    tags.concat(boltTags).forEach(function (tag) {
      if (tag && !tag.hidden) { write(tag.textContent, parseFloat(tag.style.left), parseFloat(tag.style.top) + 4, "#1c1c1c", "11px sans-serif"); }
    });
    length = parseFloat(part("scale-bar").style.width);
    line([[wide - 14 - length, high - 17], [wide - 14 - length, high - 12], [wide - 14, high - 12], [wide - 14, high - 17]], "#1c1c1c", 1.5);
    write(part("scale-text").textContent, wide - 14 - length / 2, high - 21, "#1c1c1c", "12px sans-serif");
    return sheet;
  }

  // -- a scene, at first and again ----------------------------------------------------------------------------------
  function set(id, checked) { var input = part(id); if (input) { input.checked = checked; } }
  var settled = "";  // the sort of scene that the boxes were set for
  function settle() {
    var alone = moving <= 1, hasFaces = data.faces.length > 0;
    var sort = alone ? (hasFaces ? "faces" : "one") : moving <= 20 ? "few" : moving <= 60 ? "more" : "many";
    part("v-names").disabled = moving > 60;
    part("v-along").disabled = !data.velocity.some(function (v) { return v !== 0; });
    part("v-colour").querySelector('option[value="face"]').disabled = !hasFaces;
    var steel = part("v-of-bolts");
    if (steel) { steel.hidden = !data.bolt_number.length; }
    data.modes.forEach(function (mode, j) {
      var label = part("v-" + mode).parentNode, counted = label.querySelector(".counted");
      if (!counted) { counted = made("span", "counted"); label.appendChild(counted); }
      counted.textContent = "\u00a0(" + pairsOf[j].length + ")";
    });
    if (sort === settled) { return; }
    settled = sort;
    ["blocks", "rock", "edges"].forEach(function (name) { set("v-" + name, true); });
    ["clear", "joints", "loads"].concat(data.modes).forEach(function (name) { set("v-" + name, alone); });
    set("v-contact", false); set("v-bolts", true); set("v-numbers", false); set("v-names", moving > 1 && moving <= 20);
    part("v-colour").value = alone ? (hasFaces ? "face" : "plain") :
      range(data.factor)[1] > 1.02 * range(data.factor)[0] ? "factor" : "order";
    part("v-pair").value = "mode";
  }
  function show(given) {
    if (ended) { return false; }
    var again = data !== null && settled !== "", was = start;
    data = {};
    Object.keys(given).forEach(function (key) {
      data[key] = given[key] && given[key].base64 !== undefined ? unpack(given[key]) : given[key];
    });
    count = data.names.length; size = data.size_m;
    moving = data.fixed.filter(function (fixed) { return !fixed; }).length;
    PALETTE = data.palette; ROCK = data.rock_colour; BLOCK = data.block_colour; GREY = data.stands_colour;
    MODE = data.mode_colours;
    start = { bearing: data.look_from[0], above: data.look_from[1], zoom: 1, pan: [0, 0, 0] };
    fill(); label(); settle(); measure();
    if (!again) { reset(); } else if (eye.bearing === was.bearing && eye.above === was.above) {
      eye.bearing = start.bearing; eye.above = start.above;  // not turned by hand: the way that this scene is looked at
    }
    colours(); ask();
    return true;
  }
  return {
    works: true, show: show, picture: picture,
    paper: function (hex) { paper = rgb(hex); ask(); },
    stop: function () {
      ended = true;
      undo.forEach(function (act) { act(); });
      tags.concat(boltTags).forEach(function (tag) { if (tag) { tag.remove(); } });
      var end = gl.getExtension("WEBGL_lose_context");
      if (end) { end.loseContext(); }
      data = null;
    }
  };
}
