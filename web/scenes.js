// scenes.js: the page of scenes: a text, a run in run_worker.js, its picture, curves and files.
"use strict";
importTemplates();
const byId = id => document.getElementById(id);
const page = {
    bytes: null,
    templates: [],
    extra: [],
    state: null,
    begun: null,
    files: new Map(),
    ended: null,
    lines: []
};
window.riddle = page; // for tests
let worker = null;

// ---- the program, loaded once
async function importTemplates() {
    try {
        const answer = await fetch("riddle.wasm"), total = Number(answer.headers.get("Content-Length")) || 0,
              parts = [];
        if (!answer.ok) throw new Error("riddle.wasm is not there: " + answer.status);
        let got = 0;
        for (const reader = answer.body.getReader();;) {
            const {done, value} = await reader.read();
            if (done) break;
            parts.push(value), got += value.length;
            byId("now").textContent =
                `Loading the program: ${(got / 1e6).toFixed(1)}${total ? " of " + (total / 1e6).toFixed(1) : ""} MB`;
            if (total) byId("done").value = got / total;
        }
        page.bytes = await new Blob(parts).arrayBuffer();
        page.templates = templatesOf(await loadProgram(page.bytes, () => {}));
    } catch (e) {
        byId("now").textContent = "The program could not be loaded: " + e.message;
        return;
    }
    for (const {name} of page.templates) byId("template").append(new Option(name, name));
    byId("now").textContent = "Ready", byId("done").value = 0, byId("run").disabled = false;
    byId("template").onchange();
}
function busy(is) {
    byId("pause").disabled = byId("end").disabled = !is;
    if (is)
        for (const id of ["csv", "png", "frame"]) byId(id).disabled = false;
    byId("pause").textContent = "Pause";
}
function say(line, error) {
    const row = document.createElement("div");
    row.textContent = line, row.className = error ? "error" : "";
    byId("said").append(row), page.lines.push(line);
}
function download(name, blob) {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(blob), link.download = name, link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

// ---- a run
function run(quick) {
    if (worker) worker.terminate();
    worker = new Worker("run_worker.js");
    for (const url of page.urls || []) URL.revokeObjectURL(url);
    Object.assign(page, {state: null, begun: null, files: new Map(), ended: null, lines: [], urls: [], box: null});
    byId("said").textContent = byId("files").textContent = byId("legend").textContent = "",
    byId("curves").hidden = true;
    worker.onmessage = event => take(event.data);
    worker.onerror = event => (say(event.message, true), busy(false));
    worker.postMessage({start: true, bytes: page.bytes, text: byId("text").value, files: page.extra, quick});
    busy(true);
}
function take(m) {
    if (m.line) say(m.line, m.error);
    if (m.begun) page.begun = m.begun, legend(m.begun), aim(m.begun.view);
    if (m.points) {
        page.state = m;
        byId("done").value = Math.min(m.time / page.begun.duration, 1);
        byId("now").textContent =
            `t = ${m.time.toPrecision(3)} s of ${page.begun.duration} s, ${m.particles} particles`;
    }
    if (m.file) keep(m.file, new Blob([m.bytes], {type: kindOf(m.file)}));
    if ("ended" in m) page.ended = m.ended, page.hash = m.hash, busy(false);
    if (m.ended && !page.begun) byId("now").textContent = "Not run";
}
function kindOf(name) {
    if (name.endsWith(".svg")) return "image/svg+xml";
    return name.endsWith(".png") ? "image/png" : "application/octet-stream";
}
function keep(name, blob) {
    if (name.startsWith("save ")) return download(name.slice(5), blob);
    const before = page.files.has(name), url = URL.createObjectURL(blob);
    page.files.set(name, blob), page.urls.push(url);
    if (name === "curves.svg") byId("curves").src = url, byId("curves").hidden = false;
    if (before) return [...byId("files").children].filter(a => a.download === name).forEach(a => { a.href = url; });
    const link = document.createElement("a");
    link.href = url, link.download = link.textContent = name;
    byId("files").append(link);
}
function legend(begun) {
    if (begun.speed > 0) {
        const bar = `<div class="bar" style="background:linear-gradient(90deg,${begun.scale.join(",")})"></div>`;
        byId("legend").innerHTML = `${bar}0 to ${begun.speed} m/s`;
        return;
    }
    byId("legend").innerHTML = begun.groups.map(g => `<div><i style="background:${g.colour}"></i></div>`).join("");
    begun.groups.forEach((g, k) => byId("legend").children[k].append(g.name)); // names are text, never markup
}
byId("template").onchange =
    () => { byId("text").value = page.templates.find(t => t.name === byId("template").value).text, page.extra = []; };
byId("upload").onchange = async event => {
    for (const file of event.target.files)
        if (/\.(ya?ml|json)$/i.test(file.name)) byId("text").value = await file.text();
        else page.extra.push([file.name, new Uint8Array(await file.arrayBuffer())]);
    say(`${event.target.files.length} file(s) taken`);
};
byId("run").onclick = () => run(false);
byId("pause").onclick = event => {
    const pause = event.target.textContent === "Pause";
    event.target.textContent = pause ? "Go on" : "Pause";
    worker.postMessage({running: !pause});
};
byId("end").onclick = () => (worker.postMessage({end: true}), busy(false));
byId("csv").onclick = () => worker.postMessage({want: "csv"});
byId("frame").onclick = () => worker.postMessage({want: "frame"});
byId("png").onclick = () => (draw(), byId("scene").toBlob(blob => download("scene.png", blob)));

// ---- picture: spheres (gl.js), triangles with their own normals, glass last
const TRIANGLE = [
    `#version 300 es
in vec4 corner; uniform mat4 view, lens; out vec3 at; out float kind;
void main() { vec4 v = view * vec4(corner.xyz, 1.0); at = v.xyz, kind = corner.w, gl_Position = lens * v; }`,
    `#version 300 es
precision highp float;
in vec3 at; in float kind; uniform float glass; out vec4 pixel;
void main() {
    if ((kind < 0.0) != (glass > 0.5)) discard;
    vec3 n = normalize(cross(dFdx(at), dFdy(at)));
    float light = abs(dot(n, normalize(vec3(-0.4, 0.75, 0.6)))), k = floor(kind + 0.5);
    vec3 tint = vec3(floor(k / 65536.0), mod(floor(k / 256.0), 256.0), mod(k, 256.0)) / 255.0;
    pixel = glass > 0.5 ? vec4(0.45, 0.55, 0.68, 0.10 + 0.06 * light) : vec4(tint * (0.35 + 0.65 * light), 1.0);
}`
];
const canvas = byId("scene"), gl = canvas.getContext("webgl2", {antialias: true, alpha: false});
const spheres = linked(gl, SPHERE), triangles = linked(gl, TRIANGLE), sphereData = gl.createBuffer(),
      cornerData = gl.createBuffer();
let turn = 0, tilt = 0.4, zoom = 1;
canvas.onpointerdown = e => canvas.setPointerCapture(e.pointerId);
canvas.onpointermove = e => {
    if (e.buttons) turn += 0.006 * e.movementX, tilt = Math.min(Math.max(tilt + 0.006 * e.movementY, -1.5), 1.5);
};
canvas.onwheel = e => { e.preventDefault(), zoom = Math.min(Math.max(zoom * Math.exp(-0.001 * e.deltaY), 0.2), 20); };
function aim([x, y, z]) { // as the scene's output.view
    turn = -Math.atan2(x, y), tilt = Math.atan2(-z, Math.hypot(x, y)), zoom = 1;
}

function boxOf({points, corners}) { // of what is there at first
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    const add = (at, r) => {
        for (let k = 0; k < 3; k++) low[k] = Math.min(low[k], at[k] - r), high[k] = Math.max(high[k], at[k] + r);
    };
    for (let k = 0; k < points.length; k += 5) add(points.subarray(k, k + 3), points[k + 3]);
    for (let k = 0; k < corners.length; k += 4) add(corners.subarray(k, k + 3), 0);
    const middle = low.map((v, k) => 0.5 * (v + high[k])), radius = 0.5 * Math.hypot(...low.map((v, k) => high[k] - v));
    return Number.isFinite(radius) && radius > 0 ? {middle, radius} : null;
}
function draw() {
    const s = page.state, scale = Math.min(window.devicePixelRatio || 1, 2),
          width = Math.round(canvas.clientWidth * scale), height = Math.round(canvas.clientHeight * scale);
    if (canvas.width !== width || canvas.height !== height) canvas.width = width, canvas.height = height;
    gl.viewport(0, 0, width, height);
    gl.clearColor(0.96, 0.96, 0.975, 1), gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT), gl.enable(gl.DEPTH_TEST);
    if (!s) return;
    page.box = page.box || boxOf(s);
    if (!page.box) return;
    const {middle: [x, y, z], radius} = page.box, c = Math.cos(turn), t = Math.sin(turn), ct = Math.cos(tilt),
                              st = Math.sin(tilt), far = 3.4 * radius / zoom;
    // columns: the world's x, y, z as the eye has them (right, up, towards it)
    const view = [c, -t * st, t * ct, 0, t, c * st, -c * ct, 0, 0, ct, st, 0, 0, 0, 0, 1];
    for (let k = 0; k < 3; k++) view[12 + k] = -(view[k] * x + view[4 + k] * y + view[8 + k] * z) - (k === 2 ? far : 0);
    const focus = 3.1 * Math.min(1, width / height), near = Math.max(far - 2 * radius, 0.05 * radius),
          back = far + 2 * radius;
    const lens = [
        focus * height / width, 0, 0, 0, 0, focus, 0, 0, 0, 0, (back + near) / (near - back), -1, 0, 0,
        2 * back * near / (near - back), 0
    ];
    const array = (program, name, size, stride, offset) => {
        const at = gl.getAttribLocation(program, name);
        gl.enableVertexAttribArray(at), gl.vertexAttribPointer(at, size, gl.FLOAT, false, stride, offset);
    };
    const use = program => {
        gl.useProgram(program);
        gl.uniformMatrix4fv(gl.getUniformLocation(program, "view"), false, view);
        gl.uniformMatrix4fv(gl.getUniformLocation(program, "lens"), false, lens);
    };
    const walls = glass => {
        use(triangles);
        gl.bindBuffer(gl.ARRAY_BUFFER, cornerData), gl.bufferData(gl.ARRAY_BUFFER, s.corners, gl.STREAM_DRAW),
            array(triangles, "corner", 4, 16, 0);
        gl.uniform1f(gl.getUniformLocation(triangles, "glass"), glass);
        gl.drawArrays(gl.TRIANGLES, 0, s.corners.length / 4);
    };
    walls(0);
    use(spheres);
    gl.bindBuffer(gl.ARRAY_BUFFER, sphereData), gl.bufferData(gl.ARRAY_BUFFER, s.points, gl.STREAM_DRAW);
    array(spheres, "sphere", 4, 20, 0), array(spheres, "kind", 1, 20, 16);
    gl.uniform1f(gl.getUniformLocation(spheres, "height"), height);
    gl.drawArrays(gl.POINTS, 0, s.points.length / 5);
    gl.enable(gl.BLEND), gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA), gl.depthMask(false);
    walls(1);
    gl.disable(gl.BLEND), gl.depthMask(true);
    if (page.drawn !== s) page.drawn = s, worker.postMessage({asked: true});
}
(function frame() { requestAnimationFrame(frame), draw(); })();

// ---- a test asks for a report: ?report=NAME runs a tenth of a template and posts what the page has
const reported = new URLSearchParams(location.search).get("report");
if (reported)
    (async () => {
        const until = async f => {
            while (!f()) await new Promise(done => setTimeout(done, 50));
        };
        await until(() => !byId("run").disabled);
        byId("template").value = reported, byId("template").onchange();
        run(true);
        await until(() => page.ended !== null);
        draw();
        const shot = canvas.toDataURL("image/png"), names = [...page.files.keys()],
              csv = page.files.has("measured.csv") ? await page.files.get("measured.csv").text() : "";
        const legend = byId("legend").textContent, hash = page.hash;
        byId("text").value = "title: wrong\nduration: 3 kg\n";
        run(false);
        await until(() => page.ended !== null);
        await fetch("report", {
            method: "POST",
            body:
                JSON.stringify({hash, names, rows: csv.split("\n").length, shot, legend, refused: page.lines.join(" ")})
        });
    })();
