// What a command of WASI needs of a system, with files in memory: runs it once.
const BADF = 8, NOENT = 44, NOSYS = 52;
const CREATE = 1, DIRECTORY = 2, TRUNCATE = 8; // of path_open
const FOLDER = 3, FILE = 4, TERMINAL = 2;      // kinds of file
class Exit { constructor(status) { this.status = status; } }

// A file that grows; bytes() is what is in it.
class Content {
  constructor(bytes = new Uint8Array()) { this.room = bytes; this.length = bytes.length; }
  bytes() { return this.room.subarray(0, this.length); }
  write(at, bytes) {
    if (at + bytes.length > this.room.length) {
      const larger = new Uint8Array(2 * (at + bytes.length));
      larger.set(this.bytes());
      this.room = larger;
    }
    this.room.set(bytes, at);
    this.length = Math.max(this.length, at + bytes.length);
  }
}

// Resolves to { status, output, errors, files }: files by name, as text.
export async function run(module, args, texts) {
  const encoder = new TextEncoder(), decoder = new TextDecoder();
  const contents = new Map(Object.entries(texts).map(([n, t]) => [n, new Content(encoder.encode(t))]));
  const output = new Content(), errors = new Content();
  const open = [{ content: new Content(), at: 0 }, { content: output, at: 0 }, { content: errors, at: 0 }, { folder: true }];
  let memory;
  const view = () => new DataView(memory.buffer);
  const bytes = (at, length) => new Uint8Array(memory.buffer, at, length);
  const word = (at, x) => view().setUint32(at, x, true);
  const long = (at, x) => view().setBigUint64(at, BigInt(x), true);
  const name = (at, length) => decoder.decode(bytes(at, length).slice()).replace(/^(\.?\/)+/, "");

  function strings(list, pointers, buffer) {
    list.forEach((s, i) => {
      const encoded = encoder.encode(s + "\0");
      word(pointers + 4 * i, buffer);
      bytes(buffer, encoded.length).set(encoded);
      buffer += encoded.length;
    });
    return 0;
  }
  // Calls f with each part of memory that a list of buffers names, until one is not filled.
  function parts(list, count, total, f) {
    let sum = 0;
    for (let i = 0; i < count; i++) {
      const at = view().getUint32(list + 8 * i, true), length = view().getUint32(list + 8 * i + 4, true);
      const n = f(bytes(at, length));
      sum += n;
      if (n < length) break;
    }
    word(total, sum);
    return 0;
  }
  function status(at, kind, size) {
    bytes(at, 64).fill(0);
    view().setUint8(at + 16, kind);
    long(at + 32, size);
    return 0;
  }

  const calls = {
    args_sizes_get(count, size) {
      word(count, args.length);
      word(size, args.reduce((n, a) => n + encoder.encode(a).length + 1, 0));
      return 0;
    },
    args_get: (pointers, buffer) => strings(args, pointers, buffer),
    environ_sizes_get(count, size) { word(count, 0); word(size, 0); return 0; },
    environ_get: () => 0,
    fd_prestat_get(fd, at) {
      if (fd !== 3) return BADF;
      word(at, 0);
      word(at + 4, 1);
      return 0;
    },
    fd_prestat_dir_name(fd, at) { bytes(at, 1)[0] = 0x2e; return 0; },
    fd_fdstat_get(fd, at) {
      const f = open[fd];
      if (!f) return BADF;
      bytes(at, 24).fill(0);
      view().setUint8(at, f.folder ? FOLDER : fd < 3 ? TERMINAL : FILE);
      bytes(at + 8, 16).fill(255);
      return 0;
    },
    fd_fdstat_set_flags: () => 0,
    fd_filestat_get: (fd, at) => (open[fd]?.content ? status(at, FILE, open[fd].content.length) : BADF),
    path_filestat_get(fd, flags, path, length, at) {
      const n = name(path, length), content = contents.get(n);
      if (content) return status(at, FILE, content.length);
      return n === "" || n === "." ? status(at, FOLDER, 0) : NOENT;
    },
    path_open(fd, lookup, path, length, flags, rights, inherited, fdflags, result) {
      const n = name(path, length);
      if (flags & DIRECTORY) return NOENT;
      if (!contents.has(n)) {
        if (!(flags & CREATE)) return NOENT;
        contents.set(n, new Content());
      }
      if (flags & TRUNCATE) contents.get(n).length = 0;
      word(result, open.push({ content: contents.get(n), at: 0 }) - 1);
      return 0;
    },
    fd_close(fd) { delete open[fd]; return 0; },
    fd_seek(fd, offset, whence, result) {
      const f = open[fd];
      if (!f?.content || fd < 3) return BADF;
      f.at = Number(offset) + [0, f.at, f.content.length][whence];
      long(result, f.at);
      return 0;
    },
    fd_read(fd, list, count, total) {
      const f = open[fd];
      if (!f?.content) return BADF;
      return parts(list, count, total, (to) => {
        const from = f.content.bytes().subarray(f.at, f.at + to.length);
        to.set(from);
        f.at += from.length;
        return from.length;
      });
    },
    fd_write(fd, list, count, total) {
      const f = open[fd];
      if (!f?.content) return BADF;
      return parts(list, count, total, (from) => {
        f.content.write(f.at, from);
        f.at += from.length;
        return from.length;
      });
    },
    path_unlink_file(fd, path, length) { return contents.delete(name(path, length)) ? 0 : NOENT; },
    proc_exit(code) { throw new Exit(code); },
  };
  const imports = {};
  for (const i of WebAssembly.Module.imports(module)) imports[i.name] = calls[i.name] ?? (() => NOSYS);
  const { exports } = await WebAssembly.instantiate(module, { wasi_snapshot_preview1: imports });
  memory = exports.memory;
  let code = 0;
  try { exports._start(); } catch (e) {
    if (!(e instanceof Exit)) throw e;
    code = e.status;
  }
  for (const n of Object.keys(texts)) contents.delete(n);
  const files = Object.fromEntries([...contents].map(([n, c]) => [n, decoder.decode(c.bytes())]));
  return { status: code, output: decoder.decode(output.bytes()), errors: decoder.decode(errors.bytes()), files };
}
