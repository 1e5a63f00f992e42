// Dropped files: a URDF, a xacro, or a zip with one of them and its meshes.
import { unzipSync } from "fflate";
import { expandXacro } from "./xacro.js";
import { element } from "./panels.js";

const decode = (bytes) => new TextDecoder().decode(bytes);
const largest = 300e6; // bytes that a zip may hold

// Of several the one nearest to the top, a .urdf before a .xacro; among xacros one with a robot's name and macros called.
function mainFile(files) {
  const depth = (n) => n.split("/").length, names = Object.keys(files).filter((n) => /\.(urdf|xacro|xml)$/i.test(n) && !n.startsWith("__MACOSX"));
  const rank = (n) => (/\.urdf$/i.test(n) ? 0 : /\.urdf\.xacro$/i.test(n) ? 100 : /\.xacro$/i.test(n) ? 200 : 300) + depth(n)
    + (/<robot[^>]*\sname\s*=/.test(decode(files[n])) ? 0 : 1000);
  return names.sort((a, b) => rank(a) - rank(b))[0];
}

function unzip(bytes) {
  let total = 0;
  return unzipSync(bytes, { filter: (f) => {
    total += f.originalSize;
    if (total > largest) throw new Error("The zip holds more than 300 MB.");
    return !f.name.endsWith("/");
  } });
}

// Of dropped File objects: { name, text, files }. Throws a sentence.
export async function readFiles(list) {
  let files = {};
  for (const file of list) {
    const bytes = new Uint8Array(await file.arrayBuffer());
    if (/\.zip$/i.test(file.name)) Object.assign(files, unzip(bytes));
    else files[file.name] = bytes;
  }
  const path = mainFile(files);
  if (!path) throw new Error("There is no .urdf or .xacro in what was dropped.");
  const text = decode(files[path]), name = path.split("/").pop(), root = /<(mujoco|sdf)[\s>]/.exec(text)?.[1];
  if (root) {
    throw new Error(root === "mujoco" ? `${name} is MJCF, which this page does not read. rbd-model --urdf ${name} makes a URDF of it, with MuJoCo's library.`
      : `${name} is SDF, which rbd does not read: convert it to URDF first.`);
  }
  if (!/\.xacro$/i.test(path) && !/<xacro:/.test(text)) return { name, text, files };
  return { name: name.replace(/(\.urdf)?\.xacro$/i, "") + ".urdf", text: expandXacro(text, files, name), files };
}

export function save(name, text) {
  const url = URL.createObjectURL(new Blob([text], { type: "text/plain" }));
  element("a", { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 10000);
}
