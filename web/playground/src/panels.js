// The numbers beside the picture. Text of a file goes into the page as text, never as markup.
import keptTable from "../../../bench/instructions.csv";

export const $ = (id) => document.getElementById(id);
export function element(name, properties = {}, ...children) {
  const e = Object.assign(document.createElement(name), properties);
  e.append(...children);
  return e;
}
const digits = (x) => (Math.abs(x) >= 1000 ? x.toFixed(0) : Math.abs(x) >= 10 ? x.toFixed(1) : x.toFixed(3));

// ---- joints ----

export function buildJoints(robot, moved) {
  const rows = robot.coordinates.map((c) => {
    const slider = element("input", { type: "range", min: c.low, max: c.high, step: "any" });
    const value = element("input", { type: "number", step: 0.01 });
    slider.dataset.joint = c.label;
    value.dataset.value = c.label;
    value.setAttribute("aria-label", `${c.label}, ${c.unit}`);
    slider.addEventListener("input", () => { c.set(Number(slider.value)); moved(); });
    // What is typed is taken as it is within the joint's limits; a coordinate without limits takes any number.
    const bounded = c.body.lower < c.body.upper;
    value.addEventListener("change", () => {
      const x = Number(value.value);
      if (value.value !== "" && Number.isFinite(x)) c.set(bounded ? Math.min(c.high, Math.max(c.low, x)) : x);
      moved();
    });
    $("joints").append(element("label", {}, element("span", { textContent: c.label, title: c.label }), slider, value,
      element("small", { textContent: c.unit })));
    return { c, slider, value };
  });
  return () => {
    for (const { c, slider, value } of rows) {
      const x = c.get(), shown = x.toFixed(3);
      if (document.activeElement !== slider || Math.abs(slider.value - x) > 1e-3) slider.value = x;
      slider.setAttribute("aria-valuetext", `${shown} ${c.unit}`);
      if (document.activeElement !== value || Math.abs(value.value - x) > 1e-3) value.value = shown;
    }
  };
}

// ---- torques at rest ----

const ways = {
  fixed: "",
  massless: "No link has mass: there are none.",
  standing: "It stands: the floor pushes with the least squares of forces, drawn as arrows.",
  hanging: "Nothing carries it: these are the torques if it hung by its root. Put at least three points on the floor.",
  tipping: "It tips over: the centre of mass is not above what it stands on. These are the torques if it hung by its root.",
};

export function buildTorques(robot) {
  const rows = robot.motors().map((b) => {
    const fill = element("i"), value = element("td");
    $("gravity").append(element("tr", {}, element("th", { textContent: b.joint ?? "", title: b.joint ?? "", scope: "row" }),
      element("td", {}, element("meter-bar", {}, fill)), value));
    return { b, fill, value, unit: b.type === 4 ? "N" : "N m" };
  });
  return () => {
    const { torques, how } = robot.rest, most = Math.max(1e-9, ...rows.map(({ b }) => Math.abs(torques[b.iv])));
    $("how").textContent = ways[how];
    for (const { b, fill, value, unit } of rows) {
      const x = torques[b.iv], share = 50 * Math.min(1, Math.abs(x) / (b.effort > 0 ? b.effort : most));
      fill.style.left = `${x < 0 ? 50 - share : 50}%`;
      fill.style.width = `${share}%`;
      fill.classList.toggle("over", b.effort > 0 && Math.abs(x) > b.effort);
      value.textContent = b.effort > 0 ? `${digits(x)} / ${digits(b.effort)} ${unit}` : `${digits(x)} ${unit}`;
    }
  };
}

// ---- mass matrix ----

export function buildMatrix(robot) {
  const canvas = $("matrix"), n = robot.model.nv, names = [], at = { i: 0, j: 0 };
  for (const b of robot.bodies) {
    for (let k = 0; k < b.nv; k++) names.push((b.joint ?? b.name ?? "") + (b.nv > 1 ? ` ${k + 1}` : ""));
  }
  canvas.width = canvas.height = n;
  const show = () => {
    $("entry").textContent = `${names[at.i]}, ${names[at.j]}: ${robot.matrix[at.i * n + at.j].toPrecision(4)} kg m², kg m or kg`;
  };
  const choose = (i, j) => {
    at.i = Math.min(n - 1, Math.max(0, i));
    at.j = Math.min(n - 1, Math.max(0, j));
    show();
  };
  canvas.onkeydown = (event) => {
    const step = { ArrowUp: [-1, 0], ArrowDown: [1, 0], ArrowLeft: [0, -1], ArrowRight: [0, 1] }[event.key];
    if (!step) return;
    choose(at.i + step[0], at.j + step[1]);
    event.preventDefault();
  };
  canvas.onpointermove = (event) => {
    const box = canvas.getBoundingClientRect();
    choose(Math.floor(((event.clientY - box.top) / box.height) * n), Math.floor(((event.clientX - box.left) / box.width) * n));
  };
  return () => {
    const context = canvas.getContext("2d"), image = context.createImageData(n, n), M = robot.matrix;
    const scale = Math.log1p(1e3 * M.reduce((most, x) => Math.max(most, Math.abs(x)), 1e-12));
    M.forEach((x, i) => {
      const depth = Math.log1p(1e3 * Math.abs(x)) / scale, colour = x < 0 ? [215, 80, 50] : [40, 100, 210];
      colour.forEach((c, k) => { image.data[4 * i + k] = 255 - depth * (255 - c); });
      image.data[4 * i + 3] = 255;
    });
    context.putImageData(image, 0, 0);
    show();
  };
}

// ---- centre of mass, reach ----

export function updateCom(robot) {
  const [x, y, z] = robot.com.map((c) => c.toFixed(3)), margin = robot.isFloating() ? robot.margin() : null;
  const support = margin === null ? "The root link is fixed to the world." : margin === -Infinity
    ? "Fewer than three points touch the floor: there is nothing to stand on."
    : margin < 0 ? `${(-margin).toFixed(3)} m outside what it stands on: it tips over.`
      : `${margin.toFixed(3)} m within what it stands on.`;
  $("com").textContent = `${x}, ${y}, ${z} m; ${robot.model.mass.toPrecision(4)} kg. ${support}`;
}

export function buildLinks(robot, changed) {
  $("at").replaceChildren(...robot.frames.map((f, i) => ({ f, i })).filter(({ f }) => f.body >= 0)
    .map(({ f, i }) => element("option", { value: i, textContent: f.link })));
  $("at").selectedIndex = $("at").options.length - 1;
  $("at").onchange = changed;
}

export function updateReach(ellipsoid) {
  $("axes").textContent = ellipsoid
    ? "Speed of the link's origin, in m/s, where the motors' speeds have length 1: "
      + ellipsoid.axes.map((a) => Math.sqrt(Math.max(0, a.value)).toFixed(3)).sort().reverse().join(", ") + "."
    : "";
}

// ---- what is drawn: its colours, and which of it is ----

export function buildLegend(drawn, changed) {
  $("legend").replaceChildren(...Object.entries(drawn).map(([key, { label, colour, on }]) => {
    const box = element("input", { type: "checkbox", checked: on }), swatch = element("i");
    box.dataset.drawn = key;
    swatch.style.background = `#${colour.toString(16).padStart(6, "0")}`;
    box.addEventListener("change", () => { drawn[key].on = box.checked; changed(); });
    return element("label", {}, box, swatch, label);
  }));
}

// ---- what may touch the floor ----

export function buildContacts(robot, changed) {
  $("guessed").textContent = robot.guessed
    ? "The file has no collision shape that is a box, a ball or a cylinder: the points are guessed, at the ends of links. Choose the links that touch the floor:"
    : "The points are of the file's collision shapes: balls, corners of boxes, rims of cylinders. Links that touch the floor:";
  $("touching").replaceChildren(...[...robot.touching].map((body) => {
    const box = element("input", { type: "checkbox", checked: true });
    box.addEventListener("change", () => {
      robot.touching[box.checked ? "add" : "delete"](body);
      changed();
    });
    return element("label", {}, box, ` ${robot.bodies[body].name}`);
  }));
}

// ---- cost ----

const calls = [["inverse dynamics", "id"], ["mass matrix", "mm"], ["forward dynamics", "fd"], ["inverse of the mass matrix", "minv"],
  ["derivatives of inverse dynamics", "id_derivatives"]];
const kept = new Map(keptTable.trim().split("\n").map((line) => line.split(","))
  .filter((row) => row[0].startsWith("gcc") && row[3] === "double" && row[7] === "run-time").map((row) => [`${row[1]} ${row[2]}`, Number(row[4])]));

// Microseconds of each call: the least of several runs, each long enough for the browser's clock.
export async function measureCost(robot) {
  const rows = [], exports = robot.exports();
  if (robot.source.kinematic) return rows; // these calls are refused
  robot.model.array("v").fill(0);
  for (const [k, [label, id]] of calls.entries()) {
    let best = Infinity, n = 200;
    for (let run = 0; run < 4; ) {
      const start = performance.now();
      exports.web_repeat(k, n);
      const time = performance.now() - start;
      if (time < 3) n *= 3; // too short for the clock
      else {
        best = Math.min(best, (1e3 * time) / n);
        run++;
      }
    }
    rows.push({ label, id, time: best, kept: kept.get(`${robot.source.id} ${id}`) });
    await new Promise((next) => setTimeout(next));
  }
  return rows;
}

export function showCost(rows) {
  const head = element("tr", {}, ...["", "here, now", "kept: instructions, gcc, x86-64"].map((t) => element("th", { textContent: t, scope: "col" })));
  $("cost").replaceChildren(element("thead", {}, head), element("tbody", {}, ...rows.map((r) => element("tr", {},
    element("th", { textContent: r.label, scope: "row" }), element("td", { textContent: `${r.time.toFixed(2)} µs` }),
    element("td", { textContent: r.kept ? String(r.kept) : "–" })))));
}

// ---- problems ----

// Remedies for an error or a warning of rbd_urdf.h, by its number.
const remedies = {
  "-6": "Mend the XML at this line: a tag that is not closed, or a character that must be written as an entity.",
  "-7": "The file must hold one <robot> with links, and a joint that moves. A xacro is expanded here if its name ends in .xacro.",
  "-8": "Give each link and joint a name of its own.",
  "-9": "Write finite numbers, as many as the attribute has components, with blanks between.",
  "-10": "An <inertial> needs <mass> and <inertia> with all six numbers.",
  "-11": "Use revolute, continuous, prismatic, fixed, floating or planar, with <parent> and <child>.",
  "-12": "Give <axis> an xyz that is not zero.",
  "-13": "<mimic> must name a joint of one degree of freedom, and not in a circle.",
  "-14": "Each link but one must be the child of one joint.",
  "-15": "Where a joint moves no mass: give its links mass, or choose “hold joints still that move no mass” below.",
  "-16": "The parser refuses it: compare the element with the URDF specification.",
  1: "Check mass and inertia: about the centre of mass, in kg m², each moment at most the sum of the others.",
  2: "Write lower below upper, or leave the limits out.",
  3: "Give the root link mass, or fix it to the world.",
  4: "Nothing to do, if that is meant.",
  5: "Write <axis xyz=\"...\">, of length 1.",
  6: "Write <robot name=\"...\">.",
  7: "Take <mimic> out, or make the joint one that moves.",
  8: "Give the links that it moves mass.",
  9: "Angles are in rad: 90 degrees are 1.5708.",
  10: "Mend the name, or take it out: what is not read changes nothing.",
  11: "Give the link its <inertial>, or write one of mass 0 if none is meant.",
};

export function showProblems(findings, go) {
  $("problems").hidden = findings.length === 0;
  $("findings").replaceChildren(...findings.map((f) => {
    const item = element("li", {}, element("strong", { textContent: f.status < 0 ? "error: " : "warning: " }), f.text);
    if (f.line > 0) {
      const button = element("button", { textContent: `line ${f.line}` });
      button.addEventListener("click", () => go(f.line));
      item.prepend(button, " ");
    }
    if (remedies[f.status]) item.append(element("span", { className: "remedy", textContent: remedies[f.status] }));
    return item;
  }));
}

// ---- the text, with marks behind the lines that problems name ----

const line = 16; // pixels, as in style.css
export function showText(text, findings) {
  if ($("text").value !== text) $("text").value = text;
  $("marks").replaceChildren(...findings.filter((f) => f.line > 0).map((f) => {
    const mark = element("b", { title: f.text });
    mark.dataset.line = f.line;
    mark.style.top = `${4 + line * (f.line - 1)}px`;
    return mark;
  }));
  scrollMarks();
}
function scrollMarks() {
  for (const mark of $("marks").children) mark.style.transform = `translateY(${-$("text").scrollTop}px)`;
}
$("text").addEventListener("scroll", scrollMarks);

export function goToLine(number) {
  $("source").open = true;
  const area = $("text"), lines = area.value.split("\n"), start = lines.slice(0, number - 1).reduce((n, l) => n + l.length + 1, 0);
  area.focus();
  area.setSelectionRange(start, start + (lines[number - 1]?.length ?? 0));
  area.scrollTop = Math.max(0, line * (number - 6));
  area.scrollIntoView({ block: "nearest" });
}
