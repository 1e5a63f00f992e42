// The page: which robot, and what changes when it moves.
import iiwa from "../../../models/iiwa.urdf";
import hyq from "../../../models/hyq.urdf";
import atlas from "../../../models/atlas.urdf";
import cartPole from "../../../models/cart_pole.urdf";
import licences from "./licences.txt";
import { Model } from "./module.js";
import { Robot } from "./robot.js";
import { View } from "./view.js";
import { Motion } from "./motion.js";
import { readFiles } from "./files.js";
import { buildDownloads, identifier } from "./downloads.js";
import { readLink, writeLink } from "./link.js";
import { drawPlot } from "./plots.js";
import * as panels from "./panels.js";

const { $, element } = panels;
// Built in: title, text, whether it floats, a pose by joint, and corners of soles by link, which their files do not have.
const sole = [-0.08, 0.17].flatMap((x) => [-0.06, 0.06].map((y) => [x, y, -0.08]));
const builtIn = {
  iiwa: ["KUKA iiwa", iiwa, false, (name) => ({ 2: 0.6, 4: -1.2, 6: 0.9 })[name.at(-1)]],
  hyq: ["HyQ", hyq, true, (name) => (/^.[fh]_hfe/.test(name) ? (name[1] === "f" ? 0.75 : -0.75) : /kfe/.test(name) ? (name[1] === "f" ? -1.5 : 1.5) : 0)],
  atlas: ["Atlas", atlas, true, (name) => (/leg_hpy/.test(name) ? -0.35 : /leg_kny/.test(name) ? 0.7 : /leg_aky/.test(name) ? -0.35 : name === "l_arm_shx" ? -1.2 : name === "r_arm_shx" ? 1.2 : 0), { l_foot: sole, r_foot: sole }],
  cart_pole: ["cart-pole", cartPole, false, (name) => (name === "hinge" ? 2.6 : 0)],
};

let robot, view, update = [], costs = 0, due = 0, grabbed = null, fading;
const motion = new Motion();

// A message, above all else in the window, so that it is seen wherever the page is scrolled to. Most go by themselves.
function tell(text, stay = false) {
  $("status").textContent = text;
  $("message").hidden = text === "";
  clearTimeout(fading);
  if (text && !stay) fading = setTimeout(() => tell(""), 8000);
}
const many = (n, one, more) => `${n} ${n === 1 ? one : more}`;
const current = () => ({ robot, source: robot.source });
const showCommands = buildDownloads(current, tell);

// ---- opening ----

function showFindings(source, findings) {
  panels.showProblems(findings, panels.goToLine);
  panels.showText(source.text, findings);
  $("floating").checked = Boolean(source.floating);
  $("massless").checked = Boolean(source.massless);
}

// Reads a source and shows it; one that has an error leaves the robot that was there. Resolves to whether it was read.
async function open(source, pose) {
  if (motion.running) setRunning(false);
  source = { files: {}, ...source };
  let model;
  source.kinematic = !Robot.hasMass(source.text);
  try { model = await Model.load(source.text, source); } catch (error) {
    tell(`The module stopped: ${error.message}`, true);
    return false;
  }
  const errors = model.build ? [{ line: 0, status: -15, text: model.build }] : model.errors;
  showFindings(source, [...errors, ...model.warnings]);
  if (model.status) {
    const [first] = [...errors, { text: "" }], before = robot ? " The picture is of the robot before." : "";
    tell(`${source.name} has an error${first.line > 0 ? ` in line ${first.line}` : ""}: ${first.text}${before}`, true);
    $("problems").scrollIntoView({ block: "nearest" });
    return false;
  }
  robot = new Robot(model, source);
  if (pose?.length === model.nq) robot.setPose(pose);
  else startPose();
  $("floor").checked = robot.floor;
  $("robot").value = source.id ?? "";
  $("name").value = identifier(source.name);
  $("facts").textContent = `${model.name}: ${many(model.nb, "body", "bodies")}, `
    + `${many(model.nv, "degree", "degrees")} of freedom, ${source.kinematic ? "no masses" : `${model.mass.toPrecision(4)} kg`}`;
  document.title = `${model.name} · rbd playground`;
  tell("");
  build();
  tellMissing();
  ask();
  showDynamics(!source.kinematic);
  if (source.kinematic) tell("No link has mass: the page shows poses and inverse kinematics of this robot, no torques and no motion.", true);
  return true;
}

// A robot without masses has poses: where numbers of its dynamics would stand, the page says why there are none.
function showDynamics(there) {
  document.body.classList.toggle("kinematic", !there);
  for (const id of ["move", "floor", "hold", "functions"]) $(id).disabled = !there;
}

// Meshes that the file names and that were not given.
function tellMissing() {
  const missing = [...view.missing], names = missing.slice(0, 6).map(([uri, why]) => `${uri.split("/").pop()} (${why})`);
  $("missing").hidden = missing.length === 0;
  $("missing").textContent = missing.length === 0 ? "" : `${missing.length} of the file's meshes ${missing.length === 1 ? "is" : "are"} not drawn: `
    + `${names.join(", ")}${missing.length > 6 ? ", …" : ""}. Rods stand for links without one. Drop a zip with the URDF and its meshes.`;
}

// Only who knows the robot knows whether a root link with mass floats: asked of a dropped file, whose source says nothing of it.
function ask() {
  const root = robot.source.floating === undefined ? Robot.rootHasMass(robot.source.text) : null;
  $("ask").hidden = root === null;
  if (root !== null) $("asked").textContent = `The root link ${root} has mass. Is it fixed to the world, as an arm's, or does it float, as a walking robot's?`;
}

function startPose() {
  const joint = builtIn[robot.source.id]?.[3], q = [...robot.neutral];
  if (joint) for (const b of robot.motors()) q[b.iq] = joint(b.joint) ?? 0;
  robot.setPose(q);
  robot.stand();
  robot.model.array("wanted").set(robot.q());
}

function build() {
  for (const id of ["joints", "gravity", "cost"]) $(id).replaceChildren();
  view.show(robot);
  panels.buildLinks(robot, refresh);
  panels.buildContacts(robot, setContacts);
  update = [panels.buildJoints(robot, moved), panels.buildTorques(robot), panels.buildMatrix(robot)];
  motion.start(robot);
  refresh();
  showCommands();
  cost();
}

async function cost() {
  const turn = ++costs, rows = await panels.measureCost(robot);
  if (turn === costs) panels.showCost(rows);
}

// ---- changes ----

// Shows the robot as it is.
function refresh() {
  robot.update();
  const ellipsoid = $("at").value ? robot.ellipsoid(Number($("at").value)) : null;
  update.forEach((f) => f());
  panels.updateCom(robot);
  panels.updateReach(ellipsoid);
  view.update();
  view.showEllipsoid(ellipsoid);
  view.showForces(motion.running ? motion.forces : robot.rest.forces);
  drawPlot(motion.history, robot);
  $("rate").textContent = motion.running && motion.rate ? `${motion.rate.toFixed(2)} × real time` : "";
  $("canvas").setAttribute("aria-label", `${robot.model.name}, ${motion.running ? "moving" : "at rest"}`);
}

// After a slider or the mouse changed q.
function moved() {
  robot.model.array("v").fill(0);
  robot.model.array("wanted").set(robot.q());
  refresh();
}

// After the floor, or a link that may touch it, was chosen.
function setContacts() {
  robot.makeContacts($("floor").checked);
  view.drawContacts();
  refresh();
}

function setRunning(on) {
  motion.running = on;
  motion.last = null;
  $("move").setAttribute("aria-pressed", String(on));
  $("move").textContent = on ? "Stop" : "Let it move";
  if (!on && robot) refresh();
}

// While the robot moves the picture follows in each frame, the numbers ten times a second, or in a fifth of the time.
function animate(time) {
  if (motion.running) {
    const status = motion.frame(time);
    if (status) {
      setRunning(false);
      tell(`The motion stopped: ${robot.model.statusText(status)}`, true);
    }
    if (status || time > due) {
      const start = performance.now();
      refresh();
      due = time + Math.max(100, 5 * (performance.now() - start));
    } else {
      view.update();
      view.showForces(motion.forces);
    }
    view.showGrip();
  }
  view.draw();
  requestAnimationFrame(animate);
}

// ---- the mouse in the picture ----

// A link is dragged: while the robot moves it is pulled; at rest its point follows by inverse kinematics, or one joint turns.
function dragged(body, point, place) {
  if (motion.running) {
    motion.pull(body, point, place);
    return "pull";
  }
  const floats = grabbed.holdRoot && body === 0; // nothing holds it: it goes along
  if ($("drag").value === "joint" || floats) return "turn";
  tell(robot.reach(grabbed, point, place));
  return "reach";
}

function hover(hit, event) {
  const box = $("hover");
  box.hidden = !hit;
  if (!hit) return;
  const b = robot.bodies[hit.body], frame = $("view").getBoundingClientRect(), near = (x) => x.toFixed(3);
  const value = b.nq === 1 ? ` = ${near(robot.q()[b.iq])} ${b.type === 4 ? "m" : "rad"}` : "";
  box.textContent = `${b.name ?? "link"}: ${b.mass.toPrecision(3)} kg; ${b.joint ?? "root"}${value}; at ${hit.point.toArray().map(near).join(", ")} m`;
  box.style.left = `${Math.min(event.clientX - frame.left + 14, frame.width - box.offsetWidth - 6)}px`;
  box.style.top = `${event.clientY - frame.top + 16}px`;
}

// ---- controls ----

const openBuiltIn = (id, pose) => open({ id, name: `${id}.urdf`, text: builtIn[id][1], floating: builtIn[id][2], soles: builtIn[id][4] }, pose);

async function openFiles(list) {
  try { await open(await readFiles(list)); } catch (error) { tell(error.message, true); }
}

async function openLink() {
  const link = await readLink(location.hash);
  if (link?.source) return open(link.source, link.q);
  return openBuiltIn(Object.hasOwn(builtIn, link?.id ?? "") ? link.id : "iiwa", link?.q);
}

function listen() {
  $("robot").append(element("option", { value: "", textContent: "your file", disabled: true }),
    ...Object.entries(builtIn).map(([value, [textContent]]) => element("option", { value, textContent })));
  $("robot").addEventListener("change", () => openBuiltIn($("robot").value));
  $("open").addEventListener("click", () => $("file").click());
  $("file").addEventListener("change", () => openFiles($("file").files));
  $("link").addEventListener("click", async () => {
    history.replaceState(null, "", await writeLink(robot));
    try { await navigator.clipboard.writeText(location.href); } catch { /* the address bar has it */ }
    tell(robot.source.id || location.hash.includes("urdf=") ? "The address carries robot and pose." : "The address carries the pose; the robot is too large for it.");
  });
  $("move").addEventListener("click", () => { motion.setMotors(); setRunning(!motion.running); });
  $("reset").addEventListener("click", () => { setRunning(false); startPose(); motion.start(robot); setContacts(); });
  $("frame").addEventListener("click", () => view.frame());
  $("floor").addEventListener("change", setContacts);
  for (const id of ["hold", "damping"]) $(id).addEventListener("change", () => motion.setMotors());
  for (const button of document.querySelectorAll("[data-push]")) {
    button.addEventListener("click", () => {
      motion.pushLink(Number($("at").value), button.dataset.push.split(",").map(Number), Number($("force").value) || 0);
      if (!motion.running) setRunning(true);
    });
  }
  $("curves").addEventListener("change", () => drawPlot(motion.history, robot));
  panels.buildLegend(view.drawn, () => view.choose());
  $("shown").open = innerWidth > 1100;
  $("close").addEventListener("click", () => tell(""));
  for (const [id, floating] of [["floats", true], ["fixed", false]]) {
    $(id).addEventListener("click", () => open({ ...robot.source, floating }));
  }
  $("again").addEventListener("click", cost);
  const readText = () => open({ ...robot.source, id: $("text").value === robot.source.text ? robot.source.id : undefined, text: $("text").value,
    floating: $("floating").checked, massless: $("massless").checked });
  $("read").addEventListener("click", readText);
  for (const id of ["floating", "massless"]) $(id).addEventListener("change", readText);
  addEventListener("hashchange", openLink);
  addEventListener("dragover", (event) => { event.preventDefault(); $("drop").hidden = false; });
  addEventListener("dragleave", (event) => { if (!event.relatedTarget) $("drop").hidden = true; });
  addEventListener("drop", (event) => { event.preventDefault(); $("drop").hidden = true; openFiles(event.dataTransfer.files); });
}

async function start() {
  view = new View($("canvas"), {
    moved,
    taken: (body) => { grabbed = robot.grab(body); },
    pulled: dragged,
    released: () => { motion.grip = null; },
    hover,
  });
  $("licences").textContent = licences;
  listen();
  await openLink();
  requestAnimationFrame(animate);
  // For tests: what the page knows.
  window.playground = { current, motion, view, ready: true };
}
start();
