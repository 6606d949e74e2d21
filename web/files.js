// files.js: the files of a program in WebAssembly (WASI, preview 1), in memory: what it reads and writes, its clock,
// its lines. It runs beside the page, in a worker, or under node.
"use strict";
const OK = 0, BAD_FILE = 8, EXISTS = 20, IS_FOLDER = 31, NOT_THERE = 44, NOT_EMPTY = 55, NO_SEEK = 70, FOLDER = 3,
      FILE = 4, TERMINAL = 2;

class Files {
    constructor(say) { // say(line, isError) is told each line that the program prints
        this.say = say, this.file = new Map(), this.folders = new Set([""]), this.line = ["", "", ""];
        this.open = [{kind: TERMINAL}, {kind: TERMINAL}, {kind: TERMINAL}, {kind: FOLDER, name: ""}]; // 3: the root
        this.decode = new TextDecoder();
    }
    put(name, text) {
        const bytes = typeof text === "string" ? new TextEncoder().encode(text) : text;
        this.file.set(name, {bytes, size: bytes.length});
    }
    get(name) {
        const f = this.file.get(name);
        return f && f.bytes.slice(0, f.size);
    }
    text(name) {
        const bytes = this.get(name);
        return bytes && this.decode.decode(bytes);
    }
    names(folder) { return [...this.file.keys()].filter(name => name.startsWith(folder + "/")).sort(); }

    // ---- what the program sees
    attach(memory) { this.memory = memory; }
    get view() { return new DataView(this.memory.buffer); }
    bytes(at, n) { return new Uint8Array(this.memory.buffer, at, n); }
    path(fd, at, n) {
        const given = this.decode.decode(this.bytes(at, n).slice()).split("/").filter(part => part && part !== ".");
        return [...(this.open[fd].name ? [this.open[fd].name] : []), ...given].join("/");
    }
    append(d, bytes) {
        const f = d.file, end = d.at + bytes.length;
        if (end > f.bytes.length) {
            const more = new Uint8Array(Math.max(end, 2 * f.bytes.length, 4096));
            more.set(f.bytes.subarray(0, f.size)), f.bytes = more;
        }
        f.bytes.set(bytes, d.at), d.at = end, f.size = Math.max(f.size, end);
    }
    print(fd, bytes) {
        this.line[fd] += this.decode.decode(bytes.slice());
        const lines = this.line[fd].split(/[\n\r]/);
        this.line[fd] = lines.pop();
        for (const line of lines)
            if (line) this.say(line, fd === 2);
    }
    stat(at, kind, size) {
        this.bytes(at, 64).fill(0), this.view.setUint8(at + 16, kind), this.view.setBigUint64(at + 24, 1n, true),
            this.view.setBigUint64(at + 32, BigInt(size), true);
        return OK;
    }
    imports() {
        const all = {
            clock_time_get: (id, precision, out) => {
                const now = id === 0 ? Date.now() : performance.now();
                this.view.setBigUint64(out, BigInt(Math.round(1e6 * now)), true);
                return OK;
            },
            fd_prestat_get: (fd, out) => {
                if (fd !== 3) return BAD_FILE;
                this.view.setUint32(out, 0, true), this.view.setUint32(out + 4, 1, true);
                return OK;
            },
            fd_prestat_dir_name: (fd, at) => {
                this.bytes(at, 1)[0] = 47;
                return OK;
            },
            fd_fdstat_get: (fd, out) => {
                const d = this.open[fd];
                if (!d) return BAD_FILE;
                this.bytes(out, 24).fill(0), this.view.setUint8(out, d.kind);
                for (const rights of [8, 16])
                    this.view.setBigUint64(out + rights, d.kind === TERMINAL ? 0x40n : 0x1fffffffn, true); // write; all
                return OK;
            },
            fd_fdstat_set_flags: () => OK,
            fd_filestat_get: (fd, out) =>
                !this.open[fd] ? BAD_FILE
                               : this.stat(out, this.open[fd].kind, this.open[fd].file ? this.open[fd].file.size : 0),
            fd_close: fd => {
                if (!this.open[fd]) return BAD_FILE;
                this.open[fd] = undefined;
                return OK;
            },
            fd_seek: (fd, offset, whence, out) => {
                const d = this.open[fd];
                if (!d) return BAD_FILE;
                if (!d.file) return NO_SEEK;
                d.at = Number(offset) + [0, d.at, d.file.size][whence];
                this.view.setBigUint64(out, BigInt(d.at), true);
                return OK;
            },
            fd_read: (fd, list, n, out) => this.each(fd, list, n, out, (d, to) => {
                const from = d.file ? d.file.bytes.subarray(d.at, Math.min(d.at + to.length, d.file.size)) : [];
                to.set(from), d.at += from.length;
                return from.length;
            }),
            fd_write: (fd, list, n, out) => this.each(fd, list, n, out, (d, from) => {
                if (d.file) this.append(d, from);
                else this.print(fd, from);
                return from.length;
            }),
            path_create_directory: (fd, at, n) => {
                const name = this.path(fd, at, n);
                if (this.folders.has(name) || this.file.has(name)) return EXISTS;
                this.folders.add(name);
                return OK;
            },
            path_filestat_get: (fd, flags, at, n, out) => {
                const name = this.path(fd, at, n), f = this.file.get(name);
                return f                        ? this.stat(out, FILE, f.size)
                       : this.folders.has(name) ? this.stat(out, FOLDER, 0)
                                                : NOT_THERE;
            },
            path_open: (fd, how, at, n, flags, rights, inherited, mode, out) => {
                const name = this.path(fd, at, n),
                      [create, folder, exclusive, truncate] = [1, 2, 4, 8].map(bit => (flags & bit) !== 0);
                let f = this.file.get(name);
                if (!f && this.folders.has(name)) f = null;
                else if (f && create && exclusive) return EXISTS;
                else if (!f && (!create || folder)) return NOT_THERE;
                else if (!f || truncate) this.file.set(name, f = {bytes: new Uint8Array(0), size: 0});
                const d = f ? {kind: FILE, file: f, at: mode & 1 ? f.size : 0} : {kind: FOLDER, name};
                let free = 4;
                while (this.open[free]) free++;
                this.open[free] = d;
                this.view.setUint32(out, free, true);
                return OK;
            },
            path_remove_directory: (fd, at, n) => {
                const name = this.path(fd, at, n);
                if (this.names(name).length) return NOT_EMPTY;
                return this.folders.delete(name) ? OK : NOT_THERE;
            },
            path_rename: (fd, from, n, to, at, m) => {
                const old = this.path(fd, from, n), name = this.path(to, at, m), f = this.file.get(old);
                if (!f) return this.folders.has(old) ? IS_FOLDER : NOT_THERE;
                this.file.delete(old), this.file.set(name, f);
                return OK;
            },
            path_unlink_file: (fd, at, n) => this.file.delete(this.path(fd, at, n)) ? OK : NOT_THERE,
            proc_exit: status => { throw new Error("the program ended with " + status); },
        };
        return {wasi_snapshot_preview1: all};
    }
    each(fd, list, n, out, move) { // over the pieces of a read or write
        const d = this.open[fd];
        let done = 0;
        if (!d || d.kind === FOLDER) return BAD_FILE;
        for (let k = 0; k < n; k++) {
            const at = this.view.getUint32(list + 8 * k, true), size = this.view.getUint32(list + 8 * k + 4, true),
                  moved = move(d, this.bytes(at, size));
            done += moved;
            if (moved < size) break;
        }
        this.view.setUint32(out, done, true);
        return OK;
    }
}

// The program in these bytes, ready to be called: {call, files, text}.
async function loadProgram(bytes, say) {
    const files = new Files(say), {instance} = await WebAssembly.instantiate(bytes, files.imports());
    files.attach(instance.exports.memory);
    instance.exports._initialize();
    const text = at => {
        const all = new Uint8Array(instance.exports.memory.buffer);
        let end = at;
        while (all[end]) end++;
        return at ? new TextDecoder().decode(all.slice(at, end)) : null;
    };
    return {call: instance.exports, files, text};
}

// The templates of the program: [{name, text}].
function templatesOf(program) {
    const found = [];
    for (let k = 0, name; (name = program.text(program.call.page_template_name(k))) !== null; k++)
        found.push({name, text: program.text(program.call.page_template(k))});
    return found;
}

function hashOf(program) { return BigInt.asUintN(64, program.call.page_hash()).toString(16).padStart(16, "0"); }

// ---- pictures: the program writes bare pixels (PPM) under the names of PNG files; the compression is the browser's

function crc(bytes) {
    let c = ~0;
    for (const b of bytes) {
        c ^= b;
        for (let k = 0; k < 8; k++) c = c & 1 ? c >>> 1 ^ 0xedb88320 : c >>> 1;
    }
    return ~c >>> 0;
}
function chunk(kind, data) {
    const out = new Uint8Array(12 + data.length), view = new DataView(out.buffer);
    view.setUint32(0, data.length), out.set(new TextEncoder().encode(kind), 4), out.set(data, 8),
        view.setUint32(8 + data.length, crc(out.subarray(4, 8 + data.length)));
    return out;
}
async function pngOf(ppm) {
    const head = new TextDecoder().decode(ppm.slice(0, 40)).match(/^P6\n(\d+) (\d+)\n255\n/);
    if (!head) return ppm;
    const [width, height] = [Number(head[1]), Number(head[2])], rows = new Uint8Array(height * (1 + 3 * width)),
                  size = new Uint8Array(13);
    for (let y = 0; y < height; y++)
        rows.set(ppm.subarray(head[0].length + 3 * width * y, head[0].length + 3 * width * (y + 1)),
                 y * (1 + 3 * width) + 1);
    new DataView(size.buffer).setUint32(0, width), new DataView(size.buffer).setUint32(4, height),
        size.set([8, 2, 0, 0, 0], 8);
    const packed = new Uint8Array(
        await new Response(new Blob([rows]).stream().pipeThrough(new CompressionStream("deflate"))).arrayBuffer());
    const parts = [
        Uint8Array.of(137, 80, 78, 71, 13, 10, 26, 10), chunk("IHDR", size), chunk("IDAT", packed),
        chunk("IEND", new Uint8Array(0))
    ];
    return new Uint8Array(await new Blob(parts).arrayBuffer());
}
async function drawPictures(files) {
    for (const name of files.names("out"))
        if (name.endsWith(".png")) files.put(name, await pngOf(files.get(name)));
}

if (typeof module !== "undefined") module.exports = {Files, loadProgram, templatesOf, hashOf, drawPictures};
