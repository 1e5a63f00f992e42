// To take home: the files that rbd-model and rbd-codegen write, by these commands themselves, and a main for firmware.
import { command } from "./module.js";
import { $, element } from "./panels.js";
import { save } from "./files.js";
import template from "../../../examples/firmware/robot_main.c";
import guide from "../../../docs/first_minutes.md";

const algorithms = [["id", "inverse dynamics", true], ["mm", "mass matrix", true], ["fd", "forward dynamics", true],
  ["minv", "inverse of the mass matrix"], ["id_derivatives", "derivatives of inverse dynamics"], ["fd_derivatives", "derivatives of forward dynamics"]];
const flags = ["f-ext", "gravity-argument", "bounded-angles", "short-sums", "reproducible"];

export const identifier = (s) => s.replace(/\.[^.]*$/, "").replace(/[^A-Za-z0-9_]/g, "_").replace(/^(?=\d|$)/, "_");

// How the file is read, as the page reads it.
const reading = (source) => [...(source.floating ? ["--floating"] : []), ...(source.massless ? ["--lock-massless"] : []),
  ...(source.kinematic ? ["--kinematic"] : [])];
const modelOptions = (source) => [...reading(source), "--c-model", $("name").value];

// Of a robot without masses: the pose and the Jacobian of the link that is chosen.
function functionsOf(source) {
  if (!source.kinematic) return algorithms.map(([id]) => id).filter((id) => $(`algorithm-${id}`).checked);
  const link = $("at").selectedOptions[0].textContent;
  return [`pose:${link}`, `jacobian:${link}`];
}

function codeOptions(source) {
  const chosen = functionsOf(source);
  return [...reading(source), "--name", $("name").value, "--algorithm", chosen.join(","),
    ...($("scalar").value === "float" ? ["--scalar", "float"] : []), ...($("limbs").value === "1" ? [] : ["--limbs", $("limbs").value]),
    ...flags.filter((f) => $(f).checked).map((f) => `--${f}`)];
}

// Whoever pastes it into a shell: what is not plain stands in quotes.
const quoted = (s) => (/^[\w.\/=,:+@%-]+$/.test(s) ? s : `'${s.replaceAll("'", "'\\''")}'`);

// examples/firmware/robot_main.c with this robot's name, scalar and pose, and zeros or gravity where robot_id asks for more.
function firmwareMain(robot) {
  if (robot.source.kinematic) throw new Error("The main calls inverse dynamics, and no link of this robot has mass.");
  if (!$("algorithm-id").checked) throw new Error("The main calls inverse dynamics: choose the function id.");
  const name = $("name").value, scalar = $("scalar").value, literal = (x) => `${x}${scalar === "float" ? "f" : ""}`;
  const real = (x) => literal(Number.isInteger(x) ? x.toFixed(1) : String(x));
  const more = [["f-ext", "f_ext", "[6 * ROBOT_NB]"], ["gravity-argument", "gravity", `[3] = {0, 0, ${real(-9.81)}}`]].filter(([id]) => $(id).checked);
  const pose = [...robot.q()].map((x) => real(Number(x.toPrecision(6)))).join(", ");
  return template.replace(/RBD_REAL float(.*\n)/, (all, rest) => `RBD_REAL ${scalar}${rest}${$("reproducible").checked ? "#define RBD_REPRODUCIBLE\n" : ""}`)
    .replace(", half[ROBOT_NV];", ";").replace(/ *\/\* The pose:[^]*?rbd_integrate.*\n\n/, "")
    .replace("static rbd_real q[ROBOT_NQ]", (found) => `static const ${found.slice(7)} = {${pose}}`)
    .replace("still[ROBOT_NV];", (found) => `${found}${more.map(([, n, length]) => `\nstatic const rbd_real ${n}${length};`).join("")}`)
    .replace("still, by_code", () => ["still", ...more.map(([, n]) => n), "by_code"].join(", "))
    .replaceAll("robot_", () => `${name}_`).replaceAll("ROBOT_", () => `${name.toUpperCase()}_`);
}

// The guide's lines that compile the main for a Cortex-M4F and run it.
const onBoard = guide.match(/^ {4}arm-none-eabi-gcc[^]*?(?=\n\n)/m)[0].replace(/^ {4}/gm, "");

export function buildDownloads(current, tell) {
  for (const [id, label, chosen] of algorithms) {
    $("algorithms").append(element("label", { title: label }, element("input", { type: "checkbox", id: `algorithm-${id}`, checked: Boolean(chosen) }), ` ${id}`));
  }
  const showCommands = () => {
    const { source } = current(), file = quoted(source.name), name = $("name").value;
    $("commands").textContent = `rbd-model ${modelOptions(source).map(quoted).join(" ")} ${file} >${name}_model.h\n`
      + `rbd-codegen ${codeOptions(source).map(quoted).join(" ")} ${file}`;
    $("board").textContent = onBoard.replaceAll("robot_", () => `${name}_`);
    $("save-model").textContent = `${name}_model.h`;
    $("save-code").textContent = `${name}_code.c and .h`;
    $("save-main").textContent = `${name}_main.c`;
  };
  const taking = (id, make) => $(id).addEventListener("click", async (event) => {
    event.preventDefault();
    if (!$("take").reportValidity()) return;
    tell("Writing …");
    try {
      const files = await make(current());
      for (const [name, text] of Object.entries(files)) save(name, text);
      tell(`Saved: ${Object.keys(files).join(", ")}.`);
    } catch (error) { tell(error.message); }
  });
  const finish = ({ status, stderr }, files) => {
    if (status !== 0) throw new Error(stderr);
    return files;
  };
  taking("save-model", async ({ source }) => {
    const r = await command("rbd-model", modelOptions(source), source.name, source.text);
    return finish(r, { [`${$("name").value}_model.h`]: r.stdout });
  });
  taking("save-code", async ({ source }) => {
    const r = await command("rbd-codegen", codeOptions(source), source.name, source.text);
    return finish(r, r.files);
  });
  taking("save-main", async ({ robot }) => ({ [`${$("name").value}_main.c`]: firmwareMain(robot) }));
  for (const id of ["take", "at"]) $(id).addEventListener("input", showCommands);
  return showCommands;
}
