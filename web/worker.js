// worker.js: the simulation, beside the page, so that pictures come as fast as they can. It runs slices and posts what
// the page shows.
"use strict";
let c, memory, wanted = null, running = true, asked = true, changed = null, lastFit = 0, fits = null;

const text = at => {
    const bytes = new Uint8Array(memory.buffer);
    let end = at;
    while (bytes[end]) end++;
    return new TextDecoder().decode(bytes.slice(at, end));
};
const doubles = (at, n) => Array.from(new Float64Array(memory.buffer, at, n));
const hex = hash => BigInt.asUintN(64, hash).toString(16).padStart(16, "0");

function start(s) {
    const status = c.web_start(s.amplitude, s.frequency, s.moisture, s.aperture, ...s.diameters);
    wanted = s, changed = null, fits = null, lastFit = performance.now();
    if (status) postMessage({failed: text(c.web_status_text(status))}), wanted = null;
}

function fit() {
    const model = [];
    for (let m = 0; m < 3; m++) {
        const classes = c.web_fit(m), curves = [];
        for (let k = 0; k < classes; k++) curves.push(doubles(c.web_curve(m, k), 100));
        model.push({curves, deviation: c.web_deviation(m)});
    }
    fits = {time: doubles(c.web_curve_times(), 100), model};
    lastFit = performance.now();
}

function tell() {
    const samples = c.web_samples(), count = c.web_count(),
          points = new Float32Array(memory.buffer, c.web_points(), 5 * count).slice();
    const retained = [0, 1, 2].map(k => doubles(c.web_retained(k), samples));
    const state = {
        points, count, sampled: doubles(c.web_sample_times(), samples), retained, fits,
        deck: c.web_deck(), time: c.web_time(), bridges: c.web_bridges()
    };
    postMessage(state, [points.buffer]);
}

function slice() {
    if (changed) start(changed);
    if (wanted && running) {
        const began = performance.now();
        let status = 0;
        while (!status && performance.now() - began < 20) status = c.web_run(5e-4, wanted.amplitude, wanted.frequency);
        if (status) postMessage({failed: text(c.web_status_text(status))}), wanted = null;
        if (c.web_samples() > 12 && performance.now() - lastFit > 1500) fit();
        if (asked) tell(), asked = false; // a page that is slow to draw is not buried under messages
    }
    setTimeout(slice, wanted && running ? 0 : 50);
}

onmessage = event => {
    const m = event.data;
    if (m.start) changed = m.start;
    if (m.shake && wanted) wanted.amplitude = m.shake.amplitude, wanted.frequency = m.shake.frequency;
    if ("running" in m) running = m.running;
    if (m.asked) asked = true;
};

(async () => {
    postMessage({loading: "Loading the program ..."});
    const bytes = await (await fetch("scene.wasm")).arrayBuffer();
    postMessage({loading: "Running the first batch ..."});
    const {instance} = await WebAssembly.instantiate(bytes, {});
    c = instance.exports, memory = c.memory;
    postMessage({hash: hex(c.web_check()), radius: c.web_radius(), wire: c.web_wire()});
    slice();
})().catch(e => postMessage({failed: String(e)}));
