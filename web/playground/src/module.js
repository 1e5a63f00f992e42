// rbd in WebAssembly: a module of numbers for the page, and the commands rbd-model and rbd-codegen as they are.
import pageModule from "./playground.wasm.gz";
import modelCommand from "./rbd-model.wasm.gz";
import codegenCommand from "./rbd-codegen.wasm.gz";
import { run } from "../../wasm/wasi.mjs";

const compiled = new Map();
function compile(bytes) {
  if (!compiled.has(bytes)) {
    const plain = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
    compiled.set(bytes, new Response(plain).arrayBuffer().then((b) => WebAssembly.compile(b)));
  }
  return compiled.get(bytes);
}

// One robot: an instance of its own, so that nothing is left of the one before.
export class Model {
  // Resolves to { status, errors, warnings } and, where status is 0, a model with its arrays.
  static async load(text, { floating = false, massless = false, kinematic = false } = {}) {
    const module = await compile(pageModule);
    const imports = { wasi_snapshot_preview1: {} };
    for (const { name } of WebAssembly.Module.imports(module)) imports.wasi_snapshot_preview1[name] = () => 8; // EBADF
    const { exports } = await WebAssembly.instantiate(module, imports);
    exports._initialize();
    const model = new Model();
    model.exports = exports;
    const bytes = new TextEncoder().encode(text), at = exports.web_malloc(bytes.length + 1);
    new Uint8Array(exports.memory.buffer, at, bytes.length).set(bytes);
    exports.web_load(at, bytes.length, floating ? 1 : 0, massless ? 1 : 0, kinematic ? 1 : 0);
    return Object.assign(model, JSON.parse(model.string(exports.web_json())));
  }

  string(at) {
    const memory = new Uint8Array(this.exports.memory.buffer);
    return new TextDecoder().decode(memory.slice(at, memory.indexOf(0, at)));
  }

  // Memory may grow at any call: a view is made anew at each use.
  array(name) { return new Float64Array(this.exports.memory.buffer, ...this.arrays[name]); }

  // Doubles in the module's memory, for a call.
  copy(numbers) {
    const at = this.exports.web_malloc(8 * numbers.length);
    new Float64Array(this.exports.memory.buffer, at, numbers.length).set(numbers);
    return at;
  }

  statusText(status) { return this.string(this.exports.web_status_text(status)); }
}

// Runs a command on a file; resolves to { status, stdout, stderr, files }, files as text, without the one given.
export async function command(name, options, path, text) {
  const module = await compile(name === "rbd-model" ? modelCommand : codegenCommand);
  const result = await run(module, [name, ...options, path], { [path]: text });
  const written = Object.entries(result.files).map(([n, bytes]) => [n.replace(/^\/+/, ""), new TextDecoder().decode(bytes)]);
  return { ...result, files: Object.fromEntries(written.filter(([n]) => n !== path)) };
}
