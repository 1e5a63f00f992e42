// bundle.mjs WASM OUT: the page in one file, OUT/index.html, from src/ and the three modules in the folder WASM.
import { build } from "esbuild";
import { createHash } from "node:crypto";
import { existsSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { gzipSync } from "node:zlib";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const here = dirname(fileURLToPath(import.meta.url)), [wasm, out] = process.argv.slice(2);

// The licences of the packages that the page holds, and of what the modules are made of.
function licences() {
  const packages = Object.keys(JSON.parse(readFileSync(join(here, "package.json"))).dependencies);
  const texts = packages.map((name) => {
    const folder = join(here, "node_modules", name), { version, license } = JSON.parse(readFileSync(join(folder, "package.json")));
    const own = join(folder, "LICENSE"); // urdf-loader only names its licence: Debian has the text
    return `==== ${name} ${version}, ${license}\n\n${readFileSync(existsSync(own) ? own : `/usr/share/common-licenses/${license}`, "utf8")}`;
  });
  return ["==== rbd", "", readFileSync(join(here, "../../LICENSE"), "utf8"), ...texts, readFileSync(join(wasm, "licences.txt"), "utf8")].join("\n");
}

// An import by a name that is made here or lies in WASM.
const made = {
  name: "made",
  setup(context) {
    context.onResolve({ filter: /\.wasm\.gz$|licences\.txt$/ }, ({ path }) => ({ path, namespace: "made" }));
    context.onLoad({ filter: /\.wasm\.gz$/, namespace: "made" }, ({ path }) => ({
      contents: gzipSync(readFileSync(join(wasm, path.replace(/\.gz$/, ""))), { level: 9 }), loader: "binary",
    }));
    context.onLoad({ filter: /licences\.txt$/, namespace: "made" }, () => ({ contents: licences(), loader: "text" }));
  },
};

const { outputFiles } = await build({
  entryPoints: [join(here, "src/main.js")], bundle: true, minify: true, format: "iife", target: "es2022", write: false,
  legalComments: "none", charset: "utf8", loader: { ".urdf": "text", ".csv": "text", ".c": "text", ".md": "text" }, plugins: [made],
});
const script = outputFiles[0].text.trimEnd(), style = readFileSync(join(here, "src/style.css"), "utf8");
if (/<\/script/i.test(script)) throw new Error("the script would end its element");

// Nothing but this script runs, and nothing is asked of any server.
const hash = (text) => `'sha256-${createHash("sha256").update(text).digest("base64")}'`;
const policy = `default-src 'none'; script-src ${hash(script)} 'wasm-unsafe-eval'; style-src ${hash(style)}; `
  + "img-src data: blob:; connect-src data: blob:; base-uri 'none'; form-action 'none'";
// Where the page is part of the site, its title leads there: RBD_HOME is the way.
const home = process.env.RBD_HOME ? `<a href="${process.env.RBD_HOME}">rbd</a> · ` : "";
const parts = { POLICY: policy, STYLE: style, SCRIPT: script, HOME: home };
const page = readFileSync(join(here, "src/index.html"), "utf8").replace(/POLICY|STYLE|SCRIPT|HOME/g, (name) => parts[name]);
mkdirSync(out, { recursive: true });
writeFileSync(join(out, "index.html"), page);
writeFileSync(join(out, "LICENCES.txt"), licences());
