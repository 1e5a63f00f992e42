// What goes home: the files that rbd-model and rbd-codegen write, by these commands themselves, and a main for firmware.
import { command } from "./module.js";
import { $, element } from "./panels.js";
import { save } from "./files.js";

const algorithms = [["id", "inverse dynamics", true], ["mm", "mass matrix", true], ["fd", "forward dynamics", true],
  ["minv", "inverse of the mass matrix"], ["id_derivatives", "derivatives of inverse dynamics"], ["fd_derivatives", "derivatives of forward dynamics"]];
const flags = ["f-ext", "gravity-argument", "bounded-angles", "short-sums"];

export const identifier = (s) => s.replace(/\.[^.]*$/, "").replace(/[^A-Za-z0-9_]/g, "_").replace(/^(?=\d|$)/, "_");

// How the file is read, as the page reads it.
const reading = (source) => [...(source.floating ? ["--floating"] : []), ...(source.massless ? ["--lock-massless"] : [])];
const modelOptions = (source) => [...reading(source), "--c-model", $("name").value];

function codeOptions(source) {
  const chosen = algorithms.map(([id]) => id).filter((id) => $(`algorithm-${id}`).checked);
  return [...reading(source), "--name", $("name").value, "--algorithm", chosen.join(","),
    ...($("scalar").value === "float" ? ["--scalar", "float"] : []), ...($("limbs").value === "1" ? [] : ["--limbs", $("limbs").value]),
    ...flags.filter((f) => $(f).checked).map((f) => `--${f}`)];
}

// Whoever pastes it into a shell: what is not plain stands in quotes.
const quoted = (s) => (/^[\w.\/=,:+@%-]+$/.test(s) ? s : `'${s.replaceAll("'", "'\\''")}'`);

function firmwareMain(robot) {
  const name = $("name").value, NAME = name.toUpperCase(), { nq, nv } = robot.model;
  const pose = [...robot.q()].map((x) => Number(x.toPrecision(6))).join(", ");
  return `/* Gravity torques of ${name}, from the model in flash: no heap. Beside it: rbd.h, ${name}_model.h. */
#define RBD_REAL ${$("scalar").value}
#define RBD_CONST ${$("scalar").value}
#define RBD_IMPLEMENTATION
#include "rbd.h"
#include "${name}_model.h"
#include <stdio.h>

static unsigned char memory[${NAME}_WORK_SIZE];

int main(void) {
    static const rbd_real q[${nq}] = {${pose}};
    static rbd_real tau[${nv}];
    rbd_work *w;
    if (rbd_work_init(&${name}_model, memory, sizeof memory, &w) != RBD_OK) return 1;
    if (rbd_gravity_torque(&${name}_model, w, q, tau) != RBD_OK) return 1;
    for (int i = 0; i < ${nv}; i++) printf("%.6g\\n", (double)tau[i]);
    return 0;
}
`;
}

export function buildDownloads(current, tell) {
  for (const [id, label, chosen] of algorithms) {
    $("algorithms").append(element("label", { title: label }, element("input", { type: "checkbox", id: `algorithm-${id}`, checked: Boolean(chosen) }), ` ${id}`));
  }
  const showCommands = () => {
    const { source } = current(), file = quoted(source.name), name = $("name").value;
    $("commands").textContent = `rbd-model ${modelOptions(source).map(quoted).join(" ")} ${file} >${name}_model.h\n`
      + `rbd-codegen ${codeOptions(source).map(quoted).join(" ")} ${file}`;
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
  $("take").addEventListener("input", showCommands);
  return showCommands;
}
