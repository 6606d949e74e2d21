// The scenes of the page without a browser: node tests/web_scenes.js BUILD-WEB FOLDER [NAME]. Writes each template to
// FOLDER/NAME.yaml and a tenth of its run to FOLDER/NAME/, and prints a line each: name, hash, particles, corners of
// triangles, files.
"use strict";
const fs = require("fs"), path = require("path");
const [web, folder] = process.argv.slice(2);
const {loadProgram, templatesOf, hashOf, drawPictures} = require(path.resolve(web, "files.js"));

async function run(bytes, text) {
    const said = [], program = await loadProgram(bytes, (line, error) => said.push(error ? "! " + line : line));
    program.files.put("scene.yaml", text);
    if (program.call.page_open(1)) return {refused: said.join("; ")};
    while (program.call.page_run(0.2))
        ;
    program.call.page_so_far();
    const live = program.files.names("out");
    program.call.page_points(), program.call.page_corners();
    const status = program.call.page_end();
    program.call.page_frame();
    await drawPictures(program.files);
    return {
        status,
        said,
        live,
        hash: hashOf(program),
        points: program.call.page_point_count(),
        corners: program.call.page_corner_count(),
        files: program.files
    };
}

(async () => {
    const bytes = fs.readFileSync(path.join(web, "riddle.wasm")),
          list = templatesOf(await loadProgram(bytes, () => {}));
    const only = process.argv[4];
    for (const {name, text} of list) {
        if (only && name !== only) continue;
        const r = await run(bytes, text);
        fs.mkdirSync(path.join(folder, name), {recursive: true});
        fs.writeFileSync(path.join(folder, name + ".yaml"), text);
        for (const file of r.files ? r.files.names("out") : [])
            fs.writeFileSync(path.join(folder, name, path.basename(file)), r.files.get(file));
        console.log(JSON.stringify({name, ...r, files: r.files && r.files.names("out").map(f => f.slice(4))}));
    }
    const wrong = await run(bytes, "title: x\nduration: 3 kg\n");
    console.log(JSON.stringify({name: "wrong", ...wrong, files: undefined}));
})().catch(e => {
    console.error(e);
    process.exit(1);
});
