/* Runs a command that was compiled for WASI (preview 1), in node and in the browser alike, with files in memory.
   SPDX-License-Identifier: MIT */

const ok = 0, badFile = 8, exists = 20, invalid = 28, isFolder = 31, missing = 44, notFolder = 54; // WASI's errno
const folderType = 3, fileType = 4;
const creates = 1, wantsFolder = 2, exclusive = 4, truncates = 8; // flags of path_open
const appends = 1;
const root = 3; // the descriptor of the folder /

class Exit {
    constructor(status) {
        this.status = status;
    }
}

/* A file's bytes, which grow. */
class Content {
    constructor(bytes) {
        this.memory = bytes;
        this.size = bytes.length;
    }
    get bytes() {
        return this.memory.subarray(0, this.size);
    }
    write(at, bytes) {
        const end = at + bytes.length;
        if (end > this.memory.length) {
            const more = new Uint8Array(Math.max(2 * this.memory.length, end));
            more.set(this.bytes);
            this.memory = more;
        }
        this.memory.set(bytes, at);
        this.size = Math.max(this.size, end);
    }
}

const toBytes = data => typeof data === 'string' ? new TextEncoder().encode(data) : new Uint8Array(data);
const toText = content => new TextDecoder().decode(content.bytes);

/* The path from /, without `.`, `..` and doubled slashes. */
function normal(path) {
    const names = [];
    for (const name of path.split('/')) {
        if (name === '..') names.pop();
        else if (name !== '' && name !== '.') names.push(name);
    }
    return names.join('/');
}

class Files {
    constructor(files) {
        this.contents = new Map();
        this.folders = new Set(['']);
        for (const [path, data] of Object.entries(files)) {
            const names = normal(path).split('/');
            const isFile = !path.endsWith('/');
            for (let n = 1; n < names.length + (isFile ? 0 : 1); n++) this.folders.add(names.slice(0, n).join('/'));
            if (isFile) this.contents.set(names.join('/'), new Content(toBytes(data)));
        }
    }
    has(path) {
        return this.folders.has(path) || this.contents.has(path);
    }
    open(path, flags) {
        if (this.has(path) && flags & creates && flags & exclusive) return {error: exists};
        if (this.folders.has(path)) return flags & creates ? {error: isFolder} : {path, folder: true};
        if (flags & wantsFolder) return {error: this.has(path) ? notFolder : missing};
        if (!this.has(path)) {
            const folder = path.slice(0, Math.max(path.lastIndexOf('/'), 0));
            if (!(flags & creates) || !this.folders.has(folder)) return {error: missing};
            this.contents.set(path, new Content(new Uint8Array(0)));
        }
        const content = this.contents.get(path);
        if (flags & truncates) content.size = 0;
        return {content, at: 0};
    }
}

/* The functions that the command imports. `memory()` is its memory now: it moves when it grows. */
function imports(args, files, standard, memory) {
    const open = [...standard.map(content => ({content, at: 0})), {path: '', folder: true}];
    const view = () => new DataView(memory());
    const bytes = (at, length) => new Uint8Array(memory(), at, length);
    const set32 = (at, value) => view().setUint32(at, value, true);
    const set64 = (at, value) => view().setBigUint64(at, BigInt(value), true);
    const pathAt = (at, length) => new TextDecoder().decode(bytes(at, length).slice());
    const vectors = (at, count) => Array.from({length: count}, (_, i) =>
        bytes(view().getUint32(at + 8 * i, true), view().getUint32(at + 8 * i + 4, true)));
    const inFolder = (folder, path) => normal(`${folder.path}/${path}`);
    const argv = args.map(a => toBytes(`${a}\0`));

    // Calls f with the open file, or says that there is none.
    const onFile = f => (fd, ...rest) => open[fd]?.content ? f(open[fd], ...rest) : open[fd] ? isFolder : badFile;
    const stat = (at, entry) => {
        bytes(at, 64).fill(0);
        view().setUint8(at + 16, entry.folder ? folderType : fileType);
        set64(at + 24, 1);
        set64(at + 32, entry.content ? entry.content.size : 0);
        return ok;
    };

    return {
        args_sizes_get(count, size) {
            set32(count, argv.length);
            set32(size, argv.reduce((sum, a) => sum + a.length, 0));
            return ok;
        },
        args_get(pointers, at) {
            for (const a of argv) {
                bytes(at, a.length).set(a);
                set32(pointers, at);
                pointers += 4;
                at += a.length;
            }
            return ok;
        },
        environ_sizes_get(count, size) {
            set32(count, 0);
            set32(size, 0);
            return ok;
        },
        environ_get: () => ok,
        proc_exit(status) {
            throw new Exit(status);
        },
        clock_time_get(clock, precision, at) {
            set64(at, Math.round(1e6 * Date.now()));
            return ok;
        },
        fd_prestat_get(fd, at) {
            if (fd !== root) return badFile;
            set32(at, 0);
            set32(at + 4, 1);
            return ok;
        },
        fd_prestat_dir_name(fd, at) {
            bytes(at, 1)[0] = '/'.charCodeAt(0);
            return ok;
        },
        fd_fdstat_get(fd, at) {
            if (!open[fd]) return badFile;
            bytes(at, 24).fill(0);
            view().setUint8(at, open[fd].folder ? folderType : fileType);
            view().setUint16(at + 2, open[fd].append ? appends : 0, true);
            bytes(at + 8, 16).fill(0xff); // all rights
            return ok;
        },
        fd_fdstat_set_flags(fd, flags) {
            if (!open[fd]) return badFile;
            open[fd].append = (flags & appends) !== 0;
            return ok;
        },
        fd_filestat_get: (fd, at) => open[fd] ? stat(at, open[fd]) : badFile,
        path_filestat_get(fd, flags, path, length, at) {
            if (!open[fd]?.folder) return notFolder;
            const entry = files.open(inFolder(open[fd], pathAt(path, length)), 0);
            return entry.error ?? stat(at, entry);
        },
        path_open(fd, follow, path, length, flags, rights, inherited, fdFlags, at) {
            if (!open[fd]?.folder) return notFolder;
            const entry = files.open(inFolder(open[fd], pathAt(path, length)), flags);
            if (entry.error) return entry.error;
            entry.append = (fdFlags & appends) !== 0;
            let free = root + 1;
            while (open[free]) free++;
            open[free] = entry;
            set32(at, free);
            return ok;
        },
        fd_close(fd) {
            if (!open[fd]) return badFile;
            open[fd] = undefined;
            return ok;
        },
        fd_renumber(from, to) {
            if (!open[from] || !open[to]) return badFile;
            open[to] = open[from];
            open[from] = undefined;
            return ok;
        },
        fd_read: onFile((file, at, count, done) => {
            let sum = 0;
            for (const room of vectors(at, count)) {
                const part = file.content.bytes.subarray(file.at, file.at + room.length);
                room.set(part);
                file.at += part.length;
                sum += part.length;
            }
            set32(done, sum);
            return ok;
        }),
        fd_write: onFile((file, at, count, done) => {
            let sum = 0;
            for (const part of vectors(at, count)) {
                if (file.append) file.at = file.content.size;
                file.content.write(file.at, part);
                file.at += part.length;
                sum += part.length;
            }
            set32(done, sum);
            return ok;
        }),
        fd_seek: onFile((file, offset, whence, done) => {
            const base = [0, file.at, file.content.size][whence];
            const to = base + Number(offset);
            if (base === undefined || to < 0) return invalid;
            file.at = to;
            set64(done, to);
            return ok;
        }),
    };
}

/* Runs a WebAssembly.Module. args: the program's name and its arguments. files: path -> text or bytes; a path that
   ends with / is an empty folder. stdin: text or bytes. Gives {status, stdout, stderr, files}: files are all that are
   there at the end, path -> bytes. A trap or an exception that nobody catches gives the status 134, as abort does,
   with its message at the end of stderr. */
export async function run(module, args, files = {}, stdin = '') {
    const standard = [new Content(toBytes(stdin)), new Content(new Uint8Array(0)), new Content(new Uint8Array(0))];
    const tree = new Files(files);
    let instance = null;
    const system = imports(args, tree, standard, () => instance.exports.memory.buffer);
    // An import that is not here fails with ENOSYS.
    const wanted = WebAssembly.Module.imports(module).map(({name}) => [name, system[name] ?? (() => 52)]);
    instance = await WebAssembly.instantiate(module, {wasi_snapshot_preview1: Object.fromEntries(wanted)});
    let status = 0, trap = '';
    try {
        instance.exports._start();
    } catch (e) {
        if (e instanceof Exit) {
            status = e.status;
        } else {
            status = 134;
            trap = `${e}\n`;
        }
    }
    return {
        status,
        stdout: toText(standard[1]),
        stderr: toText(standard[2]) + trap,
        files: Object.fromEntries([...tree.contents].map(([path, content]) => [path, content.bytes.slice()])),
    };
}
