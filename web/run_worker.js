// run_worker.js: one scene, beside the page. It is begun anew for each run.
"use strict";
importScripts("files.js");
let program, running = true, stopped = false, ended = false, wanted = [], asked = true, drawn = 0;

const say = (line, error) => postMessage({line, error});
const numbers = (at, n) => new Float32Array(program.call.memory.buffer, at, n).slice();

function tell() {
    const c = program.call, points = numbers(c.page_points(), 5 * c.page_point_count()),
          corners = numbers(c.page_corners(), 4 * c.page_corner_count());
    postMessage({points, corners, time: c.page_time(), particles: c.page_particles()}, [points.buffer, corners.buffer]);
    asked = false;
}
function send(name, as) { // a file for the page
    const bytes = program.files.get(name);
    if (bytes) postMessage({file: as || name.slice(4), bytes}, [bytes.buffer]);
}
function answer() { // what the page has asked for: csv, frame
    for (const what of wanted.splice(0)) {
        if (what === "csv") program.call.page_so_far(), send("out/measured.csv", "save measured.csv");
        else
            program.call.page_frame(),
                program.files.names("out").filter(n => /\/frame_/.test(n)).forEach(n => send(n, "save " + n.slice(4)));
    }
}
async function end() {
    const status = program.call.page_end();
    await drawPictures(program.files);
    tell();
    for (const name of program.files.names("out"))
        if (!/frame_|\.pvd$|_\d{4}\.vtp$|scene\.state$/.test(name)) send(name);
    for (const name of program.files.names("out"))
        if (/\.pvd$|scene_\w*\d{4}\.vtp$/.test(name)) send(name);
    ended = true;
    postMessage({ended: status, hash: hashOf(program)});
}
function slice() {
    let more = true;
    if (stopped) more = false;
    else if (running) more = program.call.page_run(0.03) === 1;
    answer();
    if (!more) return void end().catch(failed);
    if (asked) tell();
    if (running && performance.now() - drawn > 1000)
        program.call.page_so_far(), send("out/curves.svg"), drawn = performance.now();
    setTimeout(() => {
        try {
            slice();
        } catch (e) {
            failed(e);
        }
    }, running ? 0 : 50);
}
function failed(e) { postMessage({line: String(e.message || e), error: true, ended: 1}); }

onmessage = event => {
    const m = event.data;
    if (m.start) start(m).catch(failed);
    if ("running" in m) running = m.running;
    if (m.want) wanted.push(m.want), ended && answer();
    if (m.asked) asked = true;
    if (m.end) stopped = true;
};

async function start(m) {
    program = await loadProgram(m.bytes, say);
    for (const [name, bytes] of m.files) program.files.put(name, bytes);
    program.files.put("scene.yaml", m.text);
    if (program.call.page_open(m.quick ? 1 : 0)) return void postMessage({ended: 2});
    const c = program.call, groups = [];
    const colour = number => "#" + number.toString(16).padStart(6, "0");
    for (let k = 0; k < Math.min(c.page_groups(), 8); k++)
        groups.push({name: program.text(c.page_group(k)), colour: colour(c.page_group_colour(k))});
    postMessage({
        begun: {
            duration: c.page_duration(),
            groups,
            view: [0, 1, 2].map(k => c.page_view(k)),
            speed: c.page_top_speed(),
            scale: [0, 0.25, 0.5, 0.75, 1].map(v => colour(c.page_speed_colour(v)))
        }
    });
    slice();
}
