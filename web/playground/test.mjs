// Opens the playground in Chromium, uses it as people do, and compares what it writes with the native tools.
// test.mjs PAGE TOOLS [PICTURES]: PAGE is index.html, TOOLS the folder of rbd-model and rbd-codegen. Ends with 77 where
// Chromium or puppeteer-core is missing. ONLY=REGEX: the tests of such a name.
import assert from "node:assert/strict";
import { execFileSync, spawn, spawnSync } from "node:child_process";
import { copyFileSync, existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath, pathToFileURL } from "node:url";

const [pageFile, tools, pictures] = process.argv.slice(2).map((a) => resolve(a));
const root = join(dirname(fileURLToPath(import.meta.url)), "../..");
const chromium = [process.env.CHROMIUM, "/usr/bin/chromium", "/usr/bin/chromium-browser"].find((p) => p && existsSync(p));
const { default: puppeteer } = await import("puppeteer-core").catch(() => ({}));
if (!chromium || !puppeteer) {
  console.log(`skipped: there is no ${chromium ? "puppeteer-core (npm ci in web/playground)" : "chromium (apt-get install chromium)"}`);
  process.exit(77);
}
const scratch = mkdtempSync(join(tmpdir(), "rbd-web-"));
const browser = await puppeteer.launch({ executablePath: chromium, headless: true, timeout: 600000, protocolTimeout: 7200000, userDataDir: join(scratch, "profile"), defaultViewport: { width: 820, height: 500 },
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"] });
let page;
const complaints = [], begin = Date.now();

async function visit(address) {
  page = await browser.newPage();
  page.on("pageerror", (e) => complaints.push(`error: ${e.message}`));
  page.on("dialog", (d) => { complaints.push(`dialog: ${d.message()}`); d.dismiss(); });
  page.on("console", (m) => { if (["error", "warning", "warn"].includes(m.type()) && !/GPU stall|GL Driver/.test(m.text())) complaints.push(`console: ${m.text()}`); });
  page.on("request", (r) => {
    const url = r.url();
    if (!/^(data|blob):/.test(url) && url.split("#")[0] !== address.split("#")[0]) complaints.push(`request: ${url}`);
  });
  const client = await page.createCDPSession();
  await client.send("Browser.setDownloadBehavior", { behavior: "allow", downloadPath: scratch });
  await page.goto(address);
  await page.waitForFunction("window.playground?.ready", { timeout: 600000 });
}

const text = (id) => page.$eval(`#${id}`, (e) => e.textContent);
const numbers = (expression) => page.evaluate(`Array.from(${expression})`);
const gravity = () => numbers("playground.current().robot.gravity");
const q = () => numbers("playground.current().robot.q()");
const until = (condition) => page.waitForFunction(condition, { timeout: 600000 });
// To look at, if pictures are asked for: as large as on a desk, or as on a phone.
async function picture(name, width = 1360, height = 860) {
  if (!pictures) return;
  const before = page.viewport();
  await page.setViewport({ ...before, width, height });
  await page.evaluate(() => playground.view.frame());
  await new Promise((r) => setTimeout(r, 400));
  await page.screenshot({ path: join(pictures, `${name}.png`) });
  await page.setViewport(before);
  await page.evaluate(() => playground.view.frame());
}
async function choose(id) {
  await page.select("#robot", id);
  await until(`playground.current().source.id === "${id}"`);
}
async function drop(name, content) {
  writeFileSync(join(scratch, name), content);
  await (await page.$("#file")).uploadFile(join(scratch, name));
}
async function download(button, names) {
  for (const name of names) rmSync(join(scratch, name), { force: true });
  await page.$eval(button, (b) => b.click());
  for (let i = 0; i < 300 && !names.every((n) => existsSync(join(scratch, n))); i++) await new Promise((r) => setTimeout(r, 50));
  return names.map((n) => readFileSync(join(scratch, n), "utf8"));
}
// The output of a firmware main: each torque by the model and by the code.
async function torques(printed) {
  const rows = printed.trim().split("\n").map((line) => line.split(" ").map(Number)), shown = await gravity();
  assert.equal(rows.length, shown.length);
  shown.forEach((g, k) => assert.ok(rows[k].length === 2 && rows[k].every((x) => Math.abs(x - g) < 1e-4 * 60), `${rows[k]} where the page shows ${g}`));
}
// Where a point of a body is in the window, and what is pulled there.
const spotOf = (body, tip = 0) => page.evaluate((b, t) => {
  const { robot } = playground.current(), { camera, canvas } = playground.view, box = canvas.getBoundingClientRect();
  const p = playground.view.com.position.clone().set(...robot.world(b, robot.tips[b][t])).project(camera);
  return [box.left + ((p.x + 1) / 2) * box.width, box.top + ((1 - p.y) / 2) * box.height];
}, body, tip);
// All of the robot is in the picture.
async function framed() {
  const ends = await page.evaluate(() => {
    const { robot } = playground.current(), { camera, com } = playground.view;
    return robot.bodies.flatMap((b, i) => [robot.origin(i), ...robot.tips[i].map((t) => robot.world(i, t))])
      .map((p) => com.position.clone().set(...p).project(camera).toArray());
  });
  for (const [x, y] of ends) assert.ok(Math.abs(x) < 1 && Math.abs(y) < 1, `${x}, ${y} is outside the picture`);
}
const address = pathToFileURL(pageFile).href;

const tests = {
  async "iiwa is there at once, framed whole, with gravity torques in their limits"() {
    await visit(address);
    assert.match(await text("facts"), /iiwa: 7 bodies, 7 degrees of freedom/);
    assert.equal((await gravity()).length, 7);
    await framed();
    await picture("iiwa");
  },
  async "the work of the gravity torques is the potential energy"() {
    const change = await page.evaluate(() => {
      const { robot } = playground.current(), h = 1e-5, energy = (k, x) => {
        const q = robot.q(), kept = q[k];
        q[k] += x;
        robot.update();
        const e = robot.energy[1];
        robot.q()[k] = kept;
        robot.update();
        return e;
      };
      return [...robot.q()].map((_, k) => (energy(k, h) - energy(k, -h)) / (2 * h));
    });
    (await gravity()).forEach((g, k) => assert.ok(Math.abs(g - change[k]) < 1e-6 * 60, `joint ${k}: ${g}, ${change[k]}`));
  },
  async "a slider turns a joint, by mouse and by key"() {
    const before = await gravity(), slider = '[data-joint="lbr_iiwa_joint_2"]';
    await page.$eval(slider, (s) => { s.value = -1.5; s.dispatchEvent(new Event("input")); });
    assert.equal((await q())[1], -1.5);
    assert.notEqual((await gravity())[1], before[1]);
    await page.focus(slider);
    await page.keyboard.press("ArrowRight");
    assert.ok((await q())[1] > -1.5);
  },
  async "dragging a link in the picture turns a joint, and beside it the view"() {
    await page.click("#reset");
    const spot = await spotOf(5);
    const before = await q(), camera = () => numbers("playground.view.camera.position.toArray()"), seen = await camera();
    await page.mouse.move(...spot);
    await page.mouse.down();
    await page.mouse.move(spot[0] + 30, spot[1] - 60, { steps: 4 });
    await page.mouse.up();
    assert.notDeepEqual(await q(), before);
    assert.deepEqual(await camera(), seen);
    await page.mouse.move(60, 420);
    await page.mouse.down();
    await page.mouse.move(160, 400, { steps: 3 });
    await page.mouse.up();
    assert.notDeepEqual(await camera(), seen);
    await page.focus("#canvas");
    const turned = await camera();
    await page.keyboard.press("ArrowLeft");
    assert.notDeepEqual(await camera(), turned);
  },
  async "a hand that is dragged follows the mouse by inverse kinematics; by one joint it does not"() {
    const distance = async (way) => {
      await page.click("#reset");
      await page.select("#drag", way);
      const spot = await spotOf(6), before = await q();
      await page.mouse.move(...spot);
      await page.mouse.down();
      await page.mouse.move(spot[0] - 25, spot[1] - 25, { steps: 5 });
      const [taken, shown, changed] = await page.evaluate(() => {
        const { view } = playground, { robot } = playground.current(), { body, point } = view.taken;
        return [view.taken.body, view.com.position.clone().set(...robot.world(body, point.toArray())).project(view.camera).toArray(), [...robot.q()]];
      });
      await page.mouse.up();
      assert.ok(taken >= 5, `body ${taken} is taken`);
      const box = await page.$eval("#canvas", (c) => { const b = c.getBoundingClientRect(); return [b.left, b.top, b.width, b.height]; });
      const at = [box[0] + ((shown[0] + 1) / 2) * box[2], box[1] + ((1 - shown[1]) / 2) * box[3]];
      return [Math.hypot(at[0] - spot[0] + 25, at[1] - spot[1] + 25), changed.filter((x, k) => Math.abs(x - before[k]) > 1e-6).length];
    };
    const [near, joints] = await distance("reach"), [far, one] = await distance("joint");
    await page.select("#drag", "reach");
    assert.ok(near < 0.5 && joints > 2, `${near} pixels off, ${joints} joints moved`);
    assert.ok(far > 3 && one === 1, `${far} pixels off, ${one} joints moved`);
  },
  async "what is out of reach is said, with the distance"() {
    await page.click("#reset");
    await page.evaluate(() => {
      const { robot } = playground.current();
      playground.view.events.taken(6);
      playground.view.events.pulled(6, [0, 0, 0], [3, 0, 0.5]);
      window.left = Math.hypot(...robot.world(6, [0, 0, 0]).map((x, k) => x - [3, 0, 0.5][k]));
    });
    const [, said] = /Out of reach by ([\d.]+) cm/.exec(await text("status"));
    await page.evaluate(() => { playground.current().robot.update(); });
    const left = await page.evaluate(() => Math.hypot(...playground.current().robot.world(6, [0, 0, 0]).map((x, k) => x - [3, 0, 0.5][k])));
    assert.ok(left > 1 && Math.abs(100 * left - said) < 0.1, `${left} m, said ${said} cm`);
    await page.click("#reset");
  },
  async "a joint takes a typed value, within its limits"() {
    const type = (value) => page.$eval('[data-value="lbr_iiwa_joint_2"]', (e, v) => { e.value = v; e.dispatchEvent(new Event("change")); }, value);
    await type("0.25");
    assert.equal((await q())[1], 0.25);
    await type("9");
    const { upper } = await page.evaluate(() => playground.current().robot.bodies[1]);
    assert.equal((await q())[1], upper);
    await type("");
    assert.equal((await q())[1], upper);
    await page.click("#reset");
  },
  async "the mouse over a link tells its name and its joint's position; what is not shown is not there"() {
    const [x, y] = await spotOf(4), hover = () => page.$eval("#hover", (e) => (e.hidden ? "" : e.textContent));
    await page.mouse.move(x, y);
    await until("!document.getElementById('hover').hidden");
    assert.match(await hover(), /link_\d: .* kg; lbr_iiwa_joint_\d = -?\d/);
    await page.$eval("#shown", (e) => { e.open = true; });
    for (const key of ["links", "joints", "inertia"]) await page.$eval(`[data-drawn="${key}"]`, (box) => box.click());
    assert.deepEqual(await page.evaluate(() => playground.view.rods.map((r) => r.visible)), [false, false, false]);
    await page.mouse.move(x + 1, y);
    await until("document.getElementById('hover').hidden");
    for (const key of ["links", "joints", "inertia"]) await page.$eval(`[data-drawn="${key}"]`, (box) => box.click());
    assert.deepEqual(await page.evaluate(() => playground.view.rods.map((r) => r.visible)), [true, true, true]);
  },
  async "the iiwa that moves loses energy by its damping only"() {
    await page.click("#reset");
    await page.click("#move");
    await until("playground.motion.steps > 800");
    await page.click("#move");
    const sums = await page.evaluate(() => playground.motion.history.map((h) => h.kinetic + h.potential));
    assert.ok(sums.at(-1) < sums[0] - 0.5 && sums.every((x, i) => i === 0 || x < sums[i - 1] + 0.05), String(sums));
  },
  async "pulled by the mouse while it moves, the link follows and is let go"() {
    await page.click("#reset");
    const spot = await spotOf(5), begin = await q();
    await page.mouse.move(...spot);
    await page.mouse.down();
    await page.$eval("#move", (button) => button.click());
    await page.mouse.move(spot[0] + 40, spot[1] - 40, { steps: 3 });
    const grip = await numbers("playground.motion.grip");
    assert.ok(grip[0] >= 5, `body ${grip[0]} is taken`);
    // How near it came in half a second, in whatever pieces the machine computes that; and left alone.
    const nearest = () => page.waitForFunction(([body, x, y, z, ...place]) => {
      const at = playground.current().robot.world(body, [x, y, z]), far = Math.hypot(...at.map((c, k) => c - place[k]));
      const { steps } = playground.motion;
      if (steps > 100) window.near = Math.min(window.near, far); // it begins near, and falls first
      return steps > 500 && [window.near];
    }, { timeout: 600000 }, grip).then((found) => found.evaluate(([near]) => near));
    await page.evaluate("window.near = Infinity");
    const pulled = await nearest();
    assert.equal(await page.evaluate(() => playground.view.arrow.visible), true);
    await page.mouse.up();
    await page.click("#move");
    assert.deepEqual(await page.evaluate(() => [playground.motion.grip, playground.view.arrow.visible]), [null, false]);
    await page.click("#reset");
    assert.deepEqual(await q(), begin);
    await page.evaluate("window.near = Infinity");
    await page.click("#move");
    const fallen = await nearest();
    await page.click("#move");
    assert.ok(pulled < 0.6 * fallen, `pulled it comes to ${pulled} m off the mouse, left alone to ${fallen}`);
  },
  async "HyQ stands on the floor by its motors, and comes to lie on it without"() {
    await choose("hyq");
    const begin = await q();
    assert.match(await text("com"), /within what it stands on/);
    await framed();
    await picture("hyq");
    await page.click("#hold");
    await page.click("#move");
    await until("playground.motion.steps > 400");
    assert.ok((await q())[2] > 0.4, "it stands");
    await page.click("#hold");
    await until("playground.motion.steps > 1600");
    await page.click("#move");
    const low = await page.evaluate(() => {
      const { robot } = playground.current();
      return Math.min(...robot.balls.map(([b, x, y, z, r]) => robot.world(b, [x, y, z])[2] - r));
    });
    await picture("hyq_fallen");
    assert.ok((await q())[2] < 0.4 && low > -0.005, `it lies, ${low} m above the floor`);
    await page.click("#reset");
    (await q()).forEach((x, k) => assert.ok(Math.abs(x - begin[k]) < 1e-12, "starting again, it stands as before"));
  },
  async "standing, the forces of the floor carry the weight, and the torques of the motors do the work of sinking"() {
    await page.click("#reset");
    const { forces, how, com, weight, torques } = await page.evaluate(() => {
      const { robot } = playground.current();
      return { ...robot.rest, torques: [...robot.rest.torques], com: robot.com, weight: 9.81 * robot.model.mass };
    });
    assert.equal(how, "standing");
    assert.equal(forces.length, 4);
    const sum = forces.reduce((s, { force }) => s.map((x, k) => x + force[k]), [0, 0, 0]);
    sum.forEach((x, k) => assert.ok(Math.abs(x - [0, 0, weight][k]) < 1e-9 * weight, String(sum)));
    for (const k of [0, 1]) { // about the centre of mass
      const other = 1 - k, moment = forces.reduce((s, { place, force }) => s + (place[k] - com[k]) * force[2] - place[2] * force[k], 0)
        + com[2] * sum[k];
      assert.ok(Math.abs(moment) < 1e-9 * weight, `${moment} N m about axis ${other}`);
    }
    assert.match(await text("how"), /stands/);
    // The trunk sinks by 1 mm over feet that stay: work of the motors = change of the potential energy.
    const work = await page.evaluate(() => {
      const { robot } = playground.current(), before = [...robot.q()], energy = robot.energy[1], trunk = robot.world(0, [0, 0, 0]);
      const feet = robot.footing();
      const grab = robot.grab(0);
      robot.reach(grab, [0, 0, 0], [trunk[0], trunk[1], trunk[2] - 1e-3]);
      robot.update();
      const dq = robot.motors().map((b) => robot.q()[b.iq] - before[b.iq]);
      const slid = Math.max(...robot.footing().map((p, i) => Math.hypot(...[0, 1, 2].map((k) => p[k] - feet[i][k]))));
      return { dq, iv: robot.motors().map((b) => b.iv), change: robot.energy[1] - energy, slid };
    });
    const done = work.dq.reduce((s, x, k) => s + x * torques[work.iv[k]], 0);
    assert.ok(work.change < -0.5 && work.slid < 1e-5, JSON.stringify(work));
    assert.ok(Math.abs(done - work.change) < 0.02 * Math.abs(work.change), `${done} J of work, ${work.change} J`);
    await page.click("#reset");
  },
  async "the trunk is dragged and the feet stay; balls of the floor are drawn once, however often one starts again"() {
    await page.click("#reset");
    const feet = () => page.evaluate(() => playground.current().robot.footing().map((p) => p.slice(0, 3)));
    const before = await feet(), spot = await spotOf(0), height = (await q())[2];
    await page.mouse.move(...spot);
    await page.mouse.down();
    await page.mouse.move(spot[0], spot[1] + 25, { steps: 5 });
    await page.mouse.up();
    const after = await feet();
    assert.ok((await q())[2] < height - 0.01, `${height} m, then ${(await q())[2]} m`);
    assert.equal(after.length, 4);
    after.forEach((p, i) => assert.ok(Math.hypot(...p.map((x, k) => x - before[i][k])) < 1e-3, `${p} was ${before[i]}`));
    const instanced = () => page.evaluate(() => playground.view.root.children.filter((c) => c.isInstancedMesh).length), n = await instanced();
    for (let k = 0; k < 3; k++) await page.click("#reset");
    assert.equal(await instanced(), n);
  },
  async "curves over time: the floor carries the weight of what stands; another robot begins with none"() {
    await page.click("#hold");
    await page.select("#curves", "force");
    await page.click("#move");
    await until("playground.motion.steps > 1500");
    assert.match(await text("rate"), /^\d+\.\d\d × real time$/);
    await page.click("#move");
    const [up, weight] = await page.evaluate(() => [playground.motion.history.at(-1).up, 9.81 * playground.current().robot.model.mass]);
    assert.ok(Math.abs(up - weight) < 0.05 * weight, `${up} N of ${weight} N`);
    assert.match(await text("plotted"), /of the floor, upwards \d+/);
    const inked = () => page.$eval("#plot", (c) => c.toDataURL() !== Object.assign(document.createElement("canvas"), { width: c.width, height: c.height }).toDataURL());
    for (const kind of ["energy", "joints", "torques"]) {
      await page.select("#curves", kind);
      assert.match(await text("plotted"), kind === "energy" ? /kinetic .*J$/ : /_joint -?\d.* or /);
      assert.equal(await inked(), true);
    }
    await page.select("#curves", "energy");
    await page.click("#hold");
    await choose("cart_pole");
    assert.equal(await text("plotted"), "");
    assert.equal(await inked(), false);
    await choose("hyq");
  },
  async "points that touch are guessed where the file has no shapes, and can be chosen"() {
    await page.click("#reset");
    assert.match(await text("guessed"), /guessed/);
    const shown = () => page.evaluate(() => playground.view.contacts.count), all = await shown();
    assert.match(await text("com"), /within what it stands on/);
    for (const leg of ["lf", "rf"]) {
      await page.evaluate((name) => [...document.querySelectorAll("#touching label")].find((l) => l.textContent.trim() === name).click(), `${leg}_lowerleg`);
    }
    assert.ok((await shown()) < all);
    assert.match(await text("com"), /nothing to stand on/);
    await page.click("#floor");
    assert.equal(await shown(), 0);
    const box = '<collision><geometry><box size="0.2 0.2 0.1"/></geometry></collision><inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>';
    await drop("box.urdf", `<robot name="box"><link name="base">${box}</link><link name="lid">${box}</link>
<joint name="hinge" type="continuous"><parent link="base"/><child link="lid"/><origin xyz="0 0 0.2"/></joint></robot>`);
    await until("playground.current().source.name === 'box.urdf'");
    assert.match(await text("guessed"), /collision shapes/);
    assert.equal(await page.evaluate(() => playground.current().robot.found.length), 8); // of the lid: the base is fixed
    await choose("hyq");
    assert.equal(await shown(), all);
  },
  async "the push button moves it"() {
    await page.click("#reset");
    const before = await q();
    await page.$eval('[data-push="0,1,0"]', (b) => b.click());
    await until("playground.motion.steps > 120");
    await page.click("#move");
    assert.ok(Math.abs((await q())[1] - before[1]) > 1e-3);
  },
  async "Atlas and the cart-pole: their numbers fit"() {
    for (const [id, nv] of [["atlas", 36], ["cart_pole", 2]]) {
      await choose(id);
      assert.equal((await gravity()).length, nv);
      await framed();
      await until("document.querySelectorAll('#cost td').length === 10");
      await picture(id);
    }
    await choose("hyq");
    await until("document.querySelectorAll('#cost td').length === 10");
    const [, ...rows] = readFileSync(join(root, "bench/instructions.csv"), "utf8").trim().split("\n").map((line) => line.split(","));
    const ofGcc = (id) => rows.find((r) => r[0].startsWith("gcc") && r[1] === "hyq" && r[2] === id && r[3] === "double" && r[7] === "run-time")[4];
    assert.deepEqual(await page.$$eval("#cost td:nth-child(3)", (cells) => cells.map((c) => c.textContent)), ["id", "mm", "fd", "minv", "id_derivatives"].map(ofGcc));
    await choose("cart_pole");
    await until("document.querySelectorAll('#cost td').length === 10");
    const times = await page.$$eval("#cost td:nth-child(2)", (cells) => cells.map((c) => c.textContent));
    assert.ok(times.length === 5 && times.every((t) => /µs$/.test(t) && parseFloat(t) > 0), String(times)); // of two bodies
  },
  async "downloads are the bytes of the commands"() {
    for (const [id, floating] of [["iiwa", false], ["hyq", true]]) {
      await choose(id);
      const [model] = await download("#save-model", [`${id}_model.h`]);
      assert.equal(model, readFileSync(join(root, `models/${id}_model.h`), "utf8"));
      const code = await download("#save-code", [`${id}_code.c`, `${id}_code.h`]);
      const native = join(scratch, `native_${id}`);
      mkdirSync(native);
      const options = await page.evaluate(() => document.getElementById("commands").textContent.split("\n")[1].split(" ").slice(1));
      copyFileSync(join(root, `models/${id}.urdf`), join(native, `${id}.urdf`));
      execFileSync(join(tools, "rbd-codegen"), options, { cwd: native, stdio: "pipe" });
      for (const [i, ending] of ["c", "h"].entries()) {
        const written = readFileSync(join(native, `${id}_code.${ending}`), "utf8");
        assert.ok(code[i] === written, `${id}_code.${ending} is not the command's`);
      }
      assert.equal(options.includes("--floating"), floating);
    }
  },
  async "the firmware main compiles with table and code, whatever the options, and prints what the page shows"() {
    await choose("iiwa");
    const set = (id, value) => page.$eval(`#${id}`, (e, v) => { e[typeof v === "boolean" ? "checked" : "value"] = v; e.form.dispatchEvent(new Event("input")); }, value);
    for (const [scalar, chosen] of [["double", ["f-ext", "gravity-argument"]], ["double", []], ["double", ["reproducible"]], ["float", ["bounded-angles", "short-sums"]]]) {
      await set("scalar", scalar);
      for (const option of ["f-ext", "gravity-argument", "bounded-angles", "short-sums", "reproducible"]) await set(option, chosen.includes(option));
      await download("#save-model", ["iiwa_model.h"]);
      const [, header] = await download("#save-code", ["iiwa_code.c", "iiwa_code.h"]);
      assert.match(header, new RegExp(`${scalar} tau\\[7\\]`));
      const [main] = await download("#save-main", ["iiwa_main.c"]);
      assert.equal(main.includes("#define RBD_REPRODUCIBLE"), chosen.includes("reproducible"));
      execFileSync("cc", ["-std=c99", "-pedantic", "-Wall", "-Wextra", "-Wconversion", "-Werror", "-Dalways_inline=unused", `-I${root}`,
        "iiwa_main.c", "iiwa_code.c", "-lm", "-o", "main"], { cwd: scratch });
      await torques(execFileSync(join(scratch, "main"), { encoding: "utf8" }));
    }
    // The last of them, in float, on a Cortex-M4F; ends with 77 where its compiler or QEMU is missing.
    const { status, stdout, stderr } = spawnSync("sh", [join(root, "tests/firmware/robot_main.sh"), root, "--run", "iiwa"], { cwd: scratch, encoding: "utf8" });
    assert.ok(status === 0 || status === 77, stderr);
    if (status === 0) await torques(stdout);
    else console.log("    left out: no arm-none-eabi-gcc or no QEMU");
    await set("algorithm-id", false);
    await page.$eval("#save-main", (button) => button.click());
    await until("/choose the function id/.test(document.getElementById('status').textContent)");
    await set("algorithm-id", true);
  },
  async "a broken file: its problem has a line, a remedy, and a mark; mended it opens"() {
    await drop("broken.urdf", "<robot name='x'>\n<link name='a'/>\n<joint name='j' type='revolute'/>\n</robot>");
    await until("!document.getElementById('problems').hidden");
    assert.match(await text("findings"), /line 3.*error:.*j.*parent.*<child>/s);
    assert.equal(await page.$eval("#marks b", (m) => m.dataset.line), "3");
    assert.equal(await page.evaluate(() => playground.current().source.id), "iiwa");
    await page.click("#findings button");
    assert.match(await page.evaluate(() => getSelection().toString() || document.getElementById("text").value.slice(...["selectionStart", "selectionEnd"].map((k) => document.getElementById("text")[k]))), /type='revolute'/);
    await picture("broken");
    const seen = await page.$eval("#message", (e) => { const b = e.getBoundingClientRect(); return !e.hidden && b.top >= 0 && b.bottom <= innerHeight && /line 3.*picture is of the robot before/.test(e.textContent); });
    assert.equal(seen, true);
    const urdf = readFileSync(join(root, "models/double_pendulum.urdf"), "utf8");
    await page.$eval("#text", (t, value) => { t.value = value; }, urdf);
    await page.$eval("#read", (b) => b.click());
    await until("playground.current().robot.model.nv === 2");
    assert.equal(await page.$eval("#problems", (p) => p.hidden), true);
  },
  async "a file of another format is named"() {
    for (const [name, root] of [["robot.xml", "mujoco"], ["robot.urdf", "sdf"]]) {
      await drop(name, `<?xml version="1.0"?>\n<${root} name="x"></${root}>`);
      await until(`document.getElementById("status").textContent.includes(${root === "sdf" ? '"SDF"' : '"MJCF"'})`);
    }
    await page.click("#close");
    assert.equal(await page.$eval("#message", (e) => e.hidden), true);
  },
  async "a hostile file: its text is never markup, and nothing is fetched"() {
    const bad = "&lt;img src=x onerror=alert(1)&gt;&lt;script&gt;alert(2)&lt;/script&gt;&quot;'";
    await drop("hostile.urdf", `<robot name="${bad}"><material name="m"><texture filename="http://example.com/t.png"/></material>
<link name="base"/><link name="${bad}"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<visual><geometry><mesh filename="http://example.com/x.stl"/></geometry><material name="m"/></visual></link>
<joint name="${bad}" type="continuous"><parent link="base"/><child link="${bad}"/><axis xyz="0 2 0"/></joint></robot>`);
    await until("playground.current().source.name === 'hostile.urdf'");
    assert.match(await text("joints"), /<img src=x/);
    assert.match(await text("findings"), /<script>/);
    assert.equal(await page.$$eval("aside img, aside script, header img", (e) => e.length), 0);
  },
  async "meshes that are not there are named, and rods are drawn for them; a root with mass is asked whether it floats"() {
    const link = (name, mesh) => `<link name="${name}"><inertial><mass value="2"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
<visual><geometry><mesh filename="${mesh}"/></geometry></visual></link>`;
    await drop("bare.urdf", `<robot name="bare">${link("trunk", "package://bare/meshes/trunk.stl")}${link("leg", "leg.ply")}
<joint name="hip" type="continuous"><parent link="trunk"/><child link="leg"/><origin xyz="0 0 0.4"/><axis xyz="0 1 0"/></joint></robot>`);
    await until("playground.current().source.name === 'bare.urdf'");
    assert.match(await text("missing"), /2 of the file's meshes are not drawn: trunk.stl \(it is not there\), leg.ply \(only STL/);
    assert.equal(await page.evaluate(() => playground.view.rods[1].count), 1); // the hip
    assert.equal(await page.$eval("#ask", (e) => e.hidden), false);
    assert.match(await text("asked"), /trunk has mass/);
    await picture("missing");
    await page.click("#floats");
    await until("playground.current().robot.model.nv === 7");
    assert.equal(await page.$eval("#ask", (e) => e.hidden), true);
    assert.equal(await page.$eval("#floating", (e) => e.checked), true);
    await choose("hyq");
    assert.deepEqual(await page.evaluate(() => ["ask", "missing"].map((id) => document.getElementById(id).hidden)), [true, true]);
  },
  async "a robot without masses has poses and inverse kinematics"() {
    const joint = (i) => `<link name="l${i}"/><joint name="j${i}" type="revolute"><parent link="${i ? `l${i - 1}` : "base"}"/><child link="l${i}"/><origin xyz="0 0 0.3"/>
<axis xyz="${i % 2} ${1 - (i % 2)} 0"/><limit lower="-2" upper="2" effort="9" velocity="9"/></joint>`;
    await drop("bones.urdf", `<robot name="bones"><link name="base"/>${[0, 1, 2, 3].map(joint).join("\n")}</robot>`);
    await until("playground.current().source.name === 'bones.urdf'");
    assert.match(await text("status"), /No link has mass/);
    assert.equal(await page.$eval("#move", (b) => b.disabled), true);
    assert.match(await text("facts"), /4 degrees of freedom, no masses/);
    const shown = await page.$$eval(".dynamic", (parts) => parts.map((e) => e.innerText.trim().split("\n").filter((line) => line).slice(1).join(" ")));
    assert.equal(shown.length, 5);
    for (const part of shown) assert.match(part, /^No link of this robot has mass\. [^0-9]*$/); // a reason, and no number
    const [code] = await download("#save-code", ["bones_code.h"]);
    assert.match(code, /bones_pose_l3/);
    await page.$eval("#save-main", (b) => b.click());
    await until('document.getElementById("status").textContent.includes("no link of this robot has mass")');
    const far = await page.evaluate(() => {
      const { robot } = playground.current(), pose = (x) => { robot.q().set([0.3 + x, 0.4, 0.5 - x, 0.2]); robot.update(); };
      pose(0);
      const place = robot.world(3, [0, 0, 0.2]);
      pose(0.2);
      const said = robot.reach(robot.grab(3), [0, 0, 0.2], place);
      robot.update();
      return [said, Math.hypot(...robot.world(3, [0, 0, 0.2]).map((x, k) => x - place[k]))];
    });
    assert.ok(far[0] === "" && far[1] < 1e-4, String(far));
    await choose("hyq");
    assert.equal(await page.$eval("#move", (b) => b.disabled), false);
  },
  async "a zip with a xacro, an include and a mesh"() {
    const { zipSync, strToU8 } = await import("fflate");
    const triangle = "solid t\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 0.3 0 0\nvertex 0 0.3 0\nendloop\nendfacet\nendsolid t\n";
    const macros = `<robot xmlns:xacro="http://ros.org/wiki/xacro"><xacro:macro name="arm" params="n parent length:=\${2*0.25} *at">
<link name="l\${n}"><inertial><origin xyz="0 0 \${length/2}"/><mass value="\${1+n}"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
<visual><geometry><mesh filename="package://arm/meshes/t.stl"/></geometry></visual></link>
<joint name="j\${n}" type="continuous"><parent link="\${parent}"/><child link="l\${n}"/><xacro:insert_block name="at"/><axis xyz="0 1 0"/></joint></xacro:macro></robot>`;
    const main = `<robot name="arm" xmlns:xacro="http://ros.org/wiki/xacro"><xacro:include filename="$(find arm)/urdf/macros.xacro"/><link name="base"/>
<xacro:property name="up" value="\${pi/10}"/><xacro:arm n="1" parent="base"><origin xyz="0 0 \${up}"/></xacro:arm>
<xacro:if value="\${up &gt; 0}"><xacro:arm n="2" parent="l1" length="1"><origin xyz="0 0 0.5"/></xacro:arm></xacro:if></robot>`;
    await drop("arm.zip", zipSync({ "arm/urdf/arm.urdf.xacro": strToU8(main), "arm/urdf/macros.xacro": strToU8(macros), "arm/meshes/t.stl": strToU8(triangle) }));
    await until("playground.current().source.name === 'arm.urdf'");
    const [first, second] = await page.evaluate(() => playground.current().robot.bodies.map((b) => ({ mass: b.mass, z: b.position[2], com: b.com[2] })));
    assert.deepEqual([first.mass, first.com, second.mass, second.com], [2, 0.25, 3, 0.5]);
    assert.ok(Math.abs(first.z - Math.PI / 10) < 1e-12);
    assert.equal(await page.evaluate(() => { let n = 0; playground.view.root.traverse((o) => { n += o.geometry?.type === "BufferGeometry" && o.geometry.attributes.position?.count === 3 ? 1 : 0; }); return n; }), 2);
    const normals = await page.evaluate(() => playground.view.shapes.map((link) => { let n; link.traverse((o) => { if (o.isMesh) n = [...o.geometry.attributes.normal.array]; }); return n; }));
    for (const normal of normals) assert.deepEqual(normal, [0, 0, 1, 0, 0, 1, 0, 0, 1]); // the file says 0 0 0
  },
  async "meshes of Collada and Wavefront, dropped on the page"() {
    const { zipSync, strToU8 } = await import("fflate");
    const dae = `<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="a" count="12">0 0 0 0.3 0 0 0 0.3 0 0.3 0.3 0</float_array>
<technique_common><accessor source="#a" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices><triangles count="2"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2 1 3 2</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node id="n"><instance_geometry url="#g"/></node></visual_scene></library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>`;
    const obj = "v 0 0 0\nv 0.2 0 0\nv 0 0.2 0\nv 0 0 0.2\nf 1 2 3\nf 1 2 4\nf 1 3 4\n";
    const link = (name, mesh) => `<link name="${name}"><inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
<visual><geometry><mesh filename="package://two/${mesh}"/></geometry></visual></link>`;
    const urdf = `<robot name="two"><link name="base"/>${link("one", "m/a.dae")}${link("other", "m/b.obj")}
<joint name="j" type="continuous"><parent link="base"/><child link="one"/><axis xyz="0 1 0"/></joint>
<joint name="k" type="continuous"><parent link="one"/><child link="other"/><origin xyz="0 0 0.5"/><axis xyz="0 1 0"/></joint></robot>`;
    const zip = [...zipSync({ "two/two.urdf": strToU8(urdf), "two/m/a.dae": strToU8(dae), "two/m/b.obj": strToU8(obj) })];
    await page.evaluate((bytes) => {
      const dataTransfer = new DataTransfer();
      dataTransfer.items.add(new File([new Uint8Array(bytes)], "two.zip"));
      const fire = (type) => document.getElementById("canvas").dispatchEvent(new DragEvent(type, { dataTransfer, bubbles: true, cancelable: true }));
      fire("dragover");
      window.hinted = !document.getElementById("drop").hidden;
      fire("drop");
    }, zip);
    assert.equal(await page.evaluate("hinted"), true);
    await until("playground.current().source.name === 'two.urdf' && document.getElementById('drop').hidden");
    const meshes = await page.evaluate(() => playground.view.groups.map((group) => {
      const sizes = [];
      group.traverse((o) => { if (o.isMesh) sizes.push(o.geometry.attributes.position.count); });
      return sizes;
    }));
    assert.deepEqual(meshes, [[6], [9]]);
    // Vertices are in the link's axes, as RViz takes them, whatever Collada's up_axis says.
    const corner = await page.evaluate(() => {
      let mesh;
      playground.view.groups[0].traverse((o) => { mesh = o.isMesh ? o : mesh; });
      return mesh.localToWorld(playground.view.com.position.clone().set(0, 0.3, 0)).toArray();
    });
    corner.forEach((x, k) => assert.ok(Math.abs(x - [0, 0.3, 0][k]) < 1e-6, String(corner)));
    await picture("meshes");
  },
  async "a robot of 200 links"() {
    const link = (i) => `<link name="l${i}"><inertial><origin xyz="0 0 0.02"/><mass value="0.1"/><inertia ixx="1e-4" iyy="1e-4" izz="1e-4" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="j${i}" type="revolute"><parent link="${i ? `l${i - 1}` : "base"}"/><child link="l${i}"/><origin xyz="0 0 0.04"/><axis xyz="${i % 2} ${1 - (i % 2)} 0"/><limit lower="-2" upper="2" effort="9" velocity="9"/></joint>`;
    await drop("large.urdf", `<robot name="large"><link name="base"/>${Array.from({ length: 200 }, (_, i) => link(i)).join("\n")}</robot>`);
    await until("playground.current().robot.model.nv === 200");
    await framed();
    const start = Date.now(), frames = await page.evaluate("playground.view.frames");
    await page.click("#move");
    await until(`playground.view.frames > ${frames + 15}`);
    // How many frames come in a second is the graphics' affair; how much it is told to draw is ours.
    const { calls, triangles } = await page.evaluate(() => ({ ...playground.view.renderer.info.render }));
    assert.ok(calls < 20 && triangles < 60000, `${calls} calls of the graphics, ${triangles} triangles`);
    const seconds = (Date.now() - start) / 1000, drawn = (await page.evaluate("playground.view.frames")) - frames;
    await page.click("#move");
    console.log(`    200 links: ${(drawn / seconds).toFixed(1)} frames a second with software graphics, ${await page.evaluate("playground.motion.steps")} steps in ${seconds.toFixed(1)} s`);
    await picture("large");
  },
  async "a link carries robot and pose, also of an own robot"() {
    await choose("hyq");
    await page.$eval('[data-joint="lf_kfe_joint"]', (s) => { s.value = -1; s.dispatchEvent(new Event("input")); });
    const pose = await q();
    await page.click("#link");
    await until("location.hash.includes('robot=hyq')");
    const link = page.url();
    await page.close();
    await visit(link);
    (await q()).forEach((x, k) => assert.ok(Math.abs(x - pose[k]) < 1e-4));
    await drop("mine.urdf", readFileSync(join(root, "models/pendulum.urdf"), "utf8"));
    await until("playground.current().source.name === 'mine.urdf'");
    await page.click("#link");
    await until("location.hash.includes('urdf=')");
    const own = page.url();
    await page.close();
    await visit(own);
    assert.equal(await page.evaluate(() => playground.current().source.name), "mine.urdf");
  },
  async "licences are shipped whole, in the page and beside it"() {
    const shipped = readFileSync(join(dirname(pageFile), "LICENCES.txt"), "utf8");
    assert.equal(await page.$eval("#licences", (e) => e.textContent), shipped);
    for (const part of [/==== rbd\n/, /==== three .*MIT/, /==== urdf-loader .*Apache-2.0/, /==== fflate .*MIT/, /END OF TERMS AND CONDITIONS/,
      /==== urdfdom /, /==== tinyxml /, /==== console-bridge /, /==== wasi-libc /, /==== libc\+\+-19-dev-wasm32 /]) assert.match(shipped, part);
  },
  async "every control has a name, and the keyboard reaches it"() {
    const nameless = await page.evaluate(() => [...document.querySelectorAll("button, input:not([hidden]), select, textarea, canvas")]
      .filter((e) => !(e.labels?.length || e.textContent.trim() || e.getAttribute("aria-label"))).map((e) => e.outerHTML));
    assert.deepEqual(nameless, []);
    assert.equal(await page.$$eval("[tabindex='-1']", (e) => e.length), 0);
  },
  async "on a phone nothing is wider than the screen"() {
    await page.setViewport({ width: 400, height: 800, hasTouch: true, isMobile: true });
    await choose("hyq");
    assert.ok((await page.evaluate(() => document.documentElement.scrollWidth)) <= 400);
    assert.ok(await page.evaluate(() => { // a message is seen wherever the page is scrolled to
      scrollTo(0, 900);
      document.getElementById("link").click();
      const b = document.getElementById("message").getBoundingClientRect();
      return new Promise((done) => setTimeout(() => { const c = document.getElementById("message").getBoundingClientRect(); done(c.height > 0 && c.bottom <= innerHeight && c.left >= 0 && c.right <= innerWidth); }, 300));
    }));
    await picture("phone", 400, 800);
    await page.evaluate(() => scrollTo(0, 560));
    await picture("phone_numbers", 400, 800);
    await page.close();
  },
  async "from a static server it is the same"() {
    const server = spawn("python3", ["-u", "-m", "http.server", "0", "-d", dirname(pageFile), "-b", "127.0.0.1"], { stdio: ["ignore", "pipe", "ignore"] });
    try {
      const port = await new Promise((found) => server.stdout.on("data", (line) => found(/port (\d+)/.exec(line)?.[1])));
      await visit(`http://127.0.0.1:${port}/index.html`);
      assert.match(await text("facts"), /iiwa/);
    } finally { server.kill(); }
  },
};

let failed = 0;
try {
  for (const [name, test] of Object.entries(tests)) {
    if (process.env.ONLY && !name.startsWith("iiwa is there") && !new RegExp(process.env.ONLY).test(name)) continue;
    const start = Date.now();
    try {
      await test();
      assert.deepEqual(complaints.splice(0), []);
      console.log(`ok      ${name} (${((Date.now() - start) / 1000).toFixed(1)} s)`);
    } catch (error) {
      failed++;
      console.log(`failed  ${name}\n${error.message}\n${error.stack.split("\n").find((l) => l.includes("test.mjs")) ?? ""}`);
      complaints.splice(0);
    }
  }
} finally {
  await browser.close();
  rmSync(scratch, { recursive: true, force: true });
}
console.log(`${failed} failed, ${((Date.now() - begin) / 1000).toFixed(1)} s`);
process.exitCode = failed ? 1 : 0;
