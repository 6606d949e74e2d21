// page.js: sliders, picture (WebGL 2), curves. What moves is computed in worker.js.
"use strict";
const byId = id => document.getElementById(id);
const COLOURS = ["#0072b2", "#d55e00", "#009e73"];
const MODELS = ["first order", "Dong", "Subasinghe"], DASHES = [[3, 4], [12, 6], []];

// ---- sliders: key, text, unit, low, high, step, value, factor to SI
const SLIDERS = [
    ["amplitude", "amplitude", "mm", 0.2, 2.5, 0.05, 1, 1e-3], ["frequency", "frequency", "Hz", 10, 50, 1, 25, 1],
    ["moisture", "moisture", "%", 0, 6, 0.25, 2, 0.01], ["aperture", "aperture", "mm", 3, 10, 0.25, 6, 1e-3],
    ["d0", "small class", "mm", 3, 5, 0.1, 3.5, 1e-3], ["d1", "middle class", "mm", 4, 7, 0.1, 5, 1e-3],
    ["d2", "large class", "mm", 6, 9, 0.1, 8, 1e-3]
];
const slider = {}, shown = {};
for (const [key, name, unit, low, high, step, value] of SLIDERS) {
    const line = document.createElement("label");
    const range = `id="${key}" min="${low}" max="${high}" step="${step}" value="${value}"`;
    line.innerHTML = `<span>${name}</span><input type="range" ${range}><output></output>`;
    byId("sliders").append(line);
    slider[key] = line.children[1], shown[key] = line.children[2];
}
const value = key => Number(slider[key].value) * SLIDERS.find(s => s[0] === key)[7];
function settings() { // classes from small to large
    const d = [value("d0"), value("d1"), value("d2")].sort((a, b) => a - b);
    for (let k = 1; k < 3; k++)
        if (d[k] - d[k - 1] < 1e-4) d[k] = d[k - 1] + 1e-4;
    return {
        amplitude: value("amplitude"),
        frequency: value("frequency"),
        moisture: value("moisture"),
        aperture: value("aperture"),
        diameters: d
    };
}
function showValues() {
    for (const [key, , unit] of SLIDERS) shown[key].textContent = slider[key].value + " " + unit;
}

// ---- the worker
const worker = new Worker("worker.js");
const page = {
    state: null,
    made: null,
    radius: 0.07,
    wire: 1.5e-3,
    hash: "",
    native: "",
    frames: 0,
    told: 0,
    since: performance.now(),
    fps: 0
};
window.riddle = page; // for tests
let waiting = 0;
function begin() {
    page.made = settings();
    worker.postMessage({start: page.made});
}
for (const [key] of SLIDERS)
    slider[key].addEventListener("input", () => {
        showValues();
        if (key === "amplitude" || key === "frequency") worker.postMessage({shake: settings()});
        else clearTimeout(waiting), waiting = setTimeout(begin, 250);
    });
byId("again").onclick = begin;
byId("pause").onclick = event => {
    const pause = event.target.textContent === "Pause";
    event.target.textContent = pause ? "Go on" : "Pause";
    worker.postMessage({running: !pause});
};
worker.onmessage = async event => {
    const m = event.data;
    if (m.failed) byId("failed").textContent = m.failed + ": begin a new batch";
    if (m.loading) byId("now").textContent = m.loading;
    if (m.hash) {
        page.radius = m.radius, page.wire = m.wire, page.hash = m.hash;
        try {
            page.native = (await (await fetch("native_hash.txt")).text()).trim();
        } catch (e) {
            page.native = "";
        }
        const verdict = m.hash === page.native ? "the same bits" : "NOT the same";
        byId("bits").textContent = page.native
            ? `After 1000 steps: here ${m.hash}, native ${page.native}: ${verdict}.`
            : `Hash after 1000 steps: ${m.hash}; native_hash.txt is missing.`;
        begin();
    }
    if (m.points) {
        for (let k = 4; k < m.points.length; k += 5) m.points[k] = parseInt(COLOURS[m.points[k]].slice(1), 16);
        page.state = m;
        if (performance.now() - page.told < 250) return;
        page.told = performance.now();
        byId("failed").textContent = "";
        byId("now").textContent = `t = ${m.time.toFixed(2)} s, ${m.count} on the screen, ${m.bridges} bridges, ` +
            `${page.fps.toFixed(0)} frames/s`;
        curves();
    }
};

// ---- curves: dots of what is left, lines of the models
function curves() {
    const s = page.state, canvas = byId("curves"), g = canvas.getContext("2d"), left = 80, right = 885, top = 64,
          bottom = 490;
    const end = Math.max(2 * s.time, 0.2), x = t => left + (right - left) * Math.min(t / end, 1),
          y = v => bottom + (top - bottom) * v / 1.02;
    g.fillStyle = "#fff", g.fillRect(0, 0, canvas.width, canvas.height);
    g.font = "22px system-ui, sans-serif", g.fillStyle = "#334", g.strokeStyle = "#ccd", g.lineWidth = 1;
    for (let v = 0; v <= 1.001; v += 0.2) {
        g.beginPath(), g.moveTo(left, y(v)), g.lineTo(right, y(v)), g.stroke();
        g.textAlign = "right", g.fillText(v.toFixed(1), left - 10, y(v) + 7);
    }
    const ten = 10 ** Math.floor(Math.log10(end)),
          step = [0.1, 0.2, 0.5, 1].map(f => f * ten).find(f => end / f <= 6) || ten;
    for (let k = 0; k * step <= end; k++)
        g.textAlign = "center", g.fillText(String(Number((k * step).toPrecision(3))), x(k * step), bottom + 30);
    g.textAlign = "center", g.fillText("time [s]", (left + right) / 2, bottom + 60);
    g.save(), g.translate(22, (top + bottom) / 2), g.rotate(-Math.PI / 2),
        g.fillText("fraction retained, by number [-]", 0, 0), g.restore();
    g.save(), g.beginPath(), g.rect(left, top - 8, right - left, bottom - top + 12), g.clip();
    for (let m = 0; s.fits && m < s.fits.model.length; m++)
        s.fits.model[m].curves.forEach((curve, k) => {
            g.strokeStyle = COLOURS[k], g.lineWidth = 2.5, g.setLineDash(DASHES[m]), g.beginPath();
            curve.forEach((v, n) => g[n ? "lineTo" : "moveTo"](x(s.fits.time[n]), y(v)));
            g.stroke();
        });
    g.setLineDash([]);
    for (let k = 0; k < 3; k++) {
        g.fillStyle = COLOURS[k];
        for (let n = 0; n < s.sampled.length; n++)
            g.beginPath(), g.arc(x(s.sampled[n]), y(s.retained[k][n]), 3.5, 0, 7), g.fill();
    }
    g.restore();
    g.textAlign = "left", g.font = "20px system-ui, sans-serif";
    for (let k = 0; k < 3; k++)
        g.fillStyle = COLOURS[k],
        g.fillText("● " + (1e3 * page.made.diameters[k]).toFixed(1) + " mm", left + 112 * k, 28);
    for (let m = 0; m < 3; m++) { // the lines of the models
        const at = left + 350 + [0, 160, 255][m];
        g.strokeStyle = g.fillStyle = "#334", g.lineWidth = 2.5, g.setLineDash(DASHES[m]);
        g.beginPath(), g.moveTo(at, 21), g.lineTo(at + 30, 21), g.stroke(), g.setLineDash([]),
            g.fillText(MODELS[m], at + 36, 28);
    }
    byId("models").textContent = s.fits
        ? "Fitted to what passes, mean deviation: " + s.fits.model.map(fitted).join(", ") + "."
        : "Models (screen_models.h) are fitted as soon as there is something to fit.";
}
function fitted(model, k) {
    const deviation = isFinite(model.deviation) ? model.deviation.toFixed(4) : "-";
    return `${MODELS[k]} (${["dotted", "dashed", "full"][k]}) ${deviation}`;
}

// ---- picture: spheres (gl.js), wires as tubes
const canvas = byId("scene"), gl = canvas.getContext("webgl2", {antialias: false});
const WIRE = [
    `#version 300 es
in vec3 corner; in vec3 side; uniform mat4 view, lens; uniform float deck; out vec3 n;
void main() { n = mat3(view) * side; gl_Position = lens * view * vec4(corner.xy, corner.z + deck, 1.0); }`,
    `#version 300 es
precision highp float;
in vec3 n; out vec4 pixel;
void main() {
    float light = max(dot(normalize(n), normalize(vec3(-0.4, 0.75, 0.6))), 0.0);
    pixel = vec4(vec3(0.62, 0.65, 0.70) * (0.35 + 0.65 * light), 1.0);
}`
];
function tube(out, from, to, radius, sides) { // between two points, [corner, side] by triangle
    const axis = to.map((v, k) => v - from[k]), up = Math.abs(axis[2]) < 1e-9 ? [0, 0, 1] : [1, 0, 0],
          length = Math.hypot(...axis);
    const across =
        [axis[1] * up[2] - axis[2] * up[1], axis[2] * up[0] - axis[0] * up[2], axis[0] * up[1] - axis[1] * up[0]].map(
            v => v / length);
    const point = (end, k) => {
        const a = 2 * Math.PI * k / sides, n = up.map((u, i) => Math.cos(a) * u + Math.sin(a) * across[i]);
        out.push(...end.map((v, i) => v + radius * n[i]), ...n);
    };
    for (let k = 0; k < sides; k++)
        for (const [end, side] of [[from, k], [to, k], [to, k + 1], [from, k], [to, k + 1], [from, k + 1]])
            point(end, side);
}
function deckMesh(aperture) {
    const out = [], pitch = aperture + page.wire, R = page.radius;
    for (let k = 0.5; k * pitch < R; k++)
        for (const at of [-k * pitch, k * pitch]) {
            const half = Math.sqrt(R * R - at * at);
            tube(out, [-half, at, 0], [half, at, 0], 0.5 * page.wire, 6),
                tube(out, [at, -half, 0], [at, half, 0], 0.5 * page.wire, 6);
        }
    for (let k = 0; k < 48; k++) {
        const a = 2 * Math.PI * k / 48, b = 2 * Math.PI * (k + 1) / 48;
        for (const z of [0, 0.07])
            tube(out, [R * Math.cos(a), R * Math.sin(a), z], [R * Math.cos(b), R * Math.sin(b), z], 6e-4, 5);
    }
    return new Float32Array(out);
}
const spheres = linked(gl, SPHERE), wires = linked(gl, WIRE), sphereData = gl.createBuffer(),
      wireData = gl.createBuffer();
let turn = 0.5, tilt = 0.62, wireCorners = 0, wireAperture = 0;
canvas.onpointerdown = e => canvas.setPointerCapture(e.pointerId);
canvas.onpointermove = e => {
    if (e.buttons) turn += 0.006 * e.movementX, tilt = Math.min(Math.max(tilt + 0.006 * e.movementY, -0.5), 1.5);
};

function frame() {
    requestAnimationFrame(frame);
    page.frames++;
    const now = performance.now();
    if (now - page.since > 1000) page.fps = 1000 * page.frames / (now - page.since), page.frames = 0, page.since = now;
    if (page.state) draw();
}
function draw() {
    const scale = Math.min(window.devicePixelRatio || 1, 2), width = Math.round(canvas.clientWidth * scale),
          height = Math.round(canvas.clientHeight * scale);
    if (canvas.width !== width || canvas.height !== height) canvas.width = width, canvas.height = height;
    const c = Math.cos(turn), s = Math.sin(turn), ct = Math.cos(tilt), st = Math.sin(tilt), far = 0.34;
    // columns: the world's x, y, z as the eye has them (right, up, towards it)
    const view = [c, -s * st, s * ct, 0, s, c * st, -c * ct, 0, 0, ct, st, 0, 0, -0.018 * ct, -far - 0.018 * st, 1];
    const focus = 3.3 * Math.min(1, width / height),
          lens = [focus * height / width, 0, 0, 0, 0, focus, 0, 0, 0, 0, -1.1, -1, 0, 0, -0.105, 0];
    gl.viewport(0, 0, width, height);
    gl.clearColor(0.96, 0.96, 0.975, 1), gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT), gl.enable(gl.DEPTH_TEST);
    if (wireAperture !== page.made.aperture) {
        const mesh = deckMesh(wireAperture = page.made.aperture);
        wireCorners = mesh.length / 6;
        gl.bindBuffer(gl.ARRAY_BUFFER, wireData), gl.bufferData(gl.ARRAY_BUFFER, mesh, gl.STATIC_DRAW);
    }
    const array = (program, name, size, stride, offset) => {
        const at = gl.getAttribLocation(program, name);
        gl.enableVertexAttribArray(at), gl.vertexAttribPointer(at, size, gl.FLOAT, false, stride, offset);
    };
    const use = program => {
        gl.useProgram(program);
        gl.uniformMatrix4fv(gl.getUniformLocation(program, "view"), false, view);
        gl.uniformMatrix4fv(gl.getUniformLocation(program, "lens"), false, lens);
    };
    use(wires);
    gl.bindBuffer(gl.ARRAY_BUFFER, wireData), array(wires, "corner", 3, 24, 0), array(wires, "side", 3, 24, 12);
    gl.uniform1f(gl.getUniformLocation(wires, "deck"), page.state.deck);
    gl.drawArrays(gl.TRIANGLES, 0, wireCorners);
    use(spheres);
    gl.bindBuffer(gl.ARRAY_BUFFER, sphereData), gl.bufferData(gl.ARRAY_BUFFER, page.state.points, gl.STREAM_DRAW);
    array(spheres, "sphere", 4, 20, 0), array(spheres, "kind", 1, 20, 16);
    gl.uniform1f(gl.getUniformLocation(spheres, "height"), height);
    gl.drawArrays(gl.POINTS, 0, page.state.count);
    if (page.drawn !== page.state) page.drawn = page.state, worker.postMessage({asked: true});
}
showValues();
frame();

// ---- a test asks for a report: ?report moves sliders and posts what the page shows
if (new URLSearchParams(location.search).has("report"))
    (async () => {
        const sleep = t => new Promise(done => setTimeout(done, 1000 * t)), until = async f => {
            while (!f()) await sleep(0.1);
        };
        const set = (key, to) => { slider[key].value = to, slider[key].dispatchEvent(new Event("input")); };
        await until(() => page.hash && page.state && page.state.fits);
        curves();
        const first = {...page.state, points: undefined}, shot = (draw(), canvas.toDataURL("image/png")),
              fps = page.fps, models = byId("models").textContent, curve = byId("curves").toDataURL("image/png");
        set("amplitude", 1.5);
        const before = page.state.time;
        await until(() => page.state.time > before + 0.06);
        const shaken = page.state.time;
        set("aperture", 8.5), set("moisture", 0);
        await until(() => page.made.aperture === 0.0085 && page.state.time < shaken && page.state.time > 0.02 &&
                          page.state.bridges === 0);
        await fetch("report", {
            method: "POST",
            body: JSON.stringify({
                hash: page.hash,
                native: page.native,
                bits: byId("bits").textContent,
                fps,
                first,
                shaken,
                second: {time: page.state.time, count: page.state.count, bridges: page.state.bridges},
                models,
                shot,
                curve
            })
        });
    })();
