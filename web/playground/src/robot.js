// A robot that was read: its module, and what picture, panels and motion take from it.
export const FIXED = 0, PRISMATIC = 4, PLANAR = 13, FLOATING = 15; // rbd_joint_type; module.c compares

// Eigenvalues and unit eigenvectors of a symmetric 3 x 3 matrix, by Jacobi's rotations: A = sum e x x'.
export function eigen(matrix) {
  const A = matrix.map((row) => [...row]), X = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
  for (let sweep = 0; sweep < 12; sweep++) {
    for (const [i, j] of [[0, 1], [0, 2], [1, 2]]) {
      if (A[i][j] === 0) continue;
      const angle = 0.5 * Math.atan2(2 * A[i][j], A[j][j] - A[i][i]), c = Math.cos(angle), s = Math.sin(angle);
      const turn = (M, a, b) => { const [x, y] = [M[a], M[b]]; [M[a], M[b]] = [c * x - s * y, s * x + c * y]; };
      for (const row of A) turn(row, i, j);
      for (let k = 0; k < 3; k++) [A[i][k], A[j][k]] = [c * A[i][k] - s * A[j][k], s * A[i][k] + c * A[j][k]];
      for (const row of X) turn(row, i, j);
    }
  }
  return [0, 1, 2].map((k) => ({ value: A[k][k], axis: X.map((row) => row[k]) }));
}

const times = (R, x) => [0, 1, 2].map((i) => R[3 * i] * x[0] + R[3 * i + 1] * x[1] + R[3 * i + 2] * x[2]);
const plus = (a, b) => a.map((x, i) => x + b[i]);
const timesBack = (R, x) => [0, 1, 2].map((i) => R[i] * x[0] + R[3 + i] * x[1] + R[6 + i] * x[2]);
const POINT = 1, POSE = 2; // rbd_ik_kind; module.c compares
const near = 0.01;         // m: a ball that is this near to the floor touches it

function quaternion(roll, pitch, yaw) {
  const [cr, sr, cp, sp, cy, sy] = [roll, pitch, yaw].flatMap((a) => [Math.cos(a / 2), Math.sin(a / 2)]);
  return [sr * cp * cy - cr * sp * sy, cr * sp * cy + sr * cp * sy, cr * cp * sy - sr * sp * cy, cr * cp * cy + sr * sp * sy];
}
function angles([x, y, z, w]) {
  const n = Math.hypot(x, y, z, w) || 1;
  [x, y, z, w] = [x / n, y / n, z / n, w / n];
  return [Math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)), Math.asin(Math.max(-1, Math.min(1, 2 * (w * y - z * x)))),
    Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))];
}

export class Robot {
  // source: { name (of the file), text, files, floating, massless, soles }
  constructor(model, source) {
    Object.assign(this, { model, source, bodies: model.bodies, frames: model.frames });
    this.neutral = [...this.q()];
    this.collectTips();
    this.collectCoordinates();
    this.update();
    this.size = this.extent();
    this.findBalls();
    this.makeContacts();
  }

  q() { return this.model.array("q"); }

  // Where links end: the origins of what they carry, and, of a last link, a rod of its mass would end at twice its
  // centre of mass.
  collectTips() {
    this.tips = this.bodies.map(() => []);
    for (const b of this.bodies) if (b.parent >= 0) this.tips[b.parent].push(b.position);
    for (const f of this.frames) if (f.body >= 0 && Math.hypot(...f.position) > 0) this.tips[f.body].push(f.position);
    this.bodies.forEach((b, i) => { if (this.tips[i].length === 0) this.tips[i].push(b.com.map((x) => 2 * x)); });
  }

  // The coordinates that sliders move: { label, joint, low, high, unit, get, set }.
  collectCoordinates() {
    this.coordinates = [];
    const plain = (b, k, label, low, high, unit) => this.coordinates.push({
      label, body: b, low, high, unit, get: () => this.q()[b.iq + k], set: (x) => { this.q()[b.iq + k] = x; },
    });
    for (const b of this.bodies) {
      const name = b.joint ?? "root";
      if (b.type === FLOATING) {
        ["x", "y", "z"].forEach((c, k) => plain(b, k, `${name} ${c}`, -2, 2, "m"));
        ["roll", "pitch", "yaw"].forEach((c, k) => this.coordinates.push({
          label: `${name} ${c}`, body: b, low: -Math.PI, high: Math.PI, unit: "rad",
          get: () => angles([...this.q().slice(b.iq + 3, b.iq + 7)])[k],
          set: (x) => {
            const a = angles([...this.q().slice(b.iq + 3, b.iq + 7)]);
            a[k] = x;
            this.q().set(quaternion(...a), b.iq + 3);
          },
        }));
      } else if (b.type === PLANAR) {
        ["x", "y"].forEach((c, k) => plain(b, k, `${name} ${c}`, -2, 2, "m"));
        plain(b, 2, `${name} angle`, -Math.PI, Math.PI, "rad");
      } else if (b.nq === 1) {
        const limited = b.lower < b.upper, free = b.type === PRISMATIC ? 1 : Math.PI;
        plain(b, 0, name, limited ? b.lower : -free, limited ? b.upper : free, b.type === PRISMATIC ? "m" : "rad");
      }
    }
  }

  motors() { return this.bodies.filter((b) => b.nv === 1 && b.nq === 1); }
  isFloating() { return this.bodies[0].type === FLOATING; }

  setPose(q) {
    this.q().set(q);
    for (const c of this.coordinates) if (c.body.nq === 1) c.set(Math.min(c.high, Math.max(c.low, c.get())));
    this.model.array("v").fill(0);
    this.model.array("wanted").set(this.q());
    this.update();
  }

  // For the picture: poses, centre of mass, energy.
  updatePose() {
    this.model.exports.web_pose();
    this.poses = this.model.array("poses").slice();
    this.com = [...this.model.array("com")];
    this.energy = [...this.model.array("energy")];
  }

  // For the panels: gravity torques, mass matrix.
  update() {
    this.updatePose();
    this.model.exports.web_dynamics();
    this.gravity = this.model.array("gravity").slice();
    this.matrix = this.model.array("mass_matrix").slice();
    this.rest = this.atRest();
  }

  rotation(body) { return body < 0 ? [1, 0, 0, 0, 1, 0, 0, 0, 1] : this.poses.subarray(12 * body, 12 * body + 9); }
  origin(body) { return body < 0 ? [0, 0, 0] : [...this.poses.subarray(12 * body + 9, 12 * body + 12)]; }
  world(body, point) { return plus(this.origin(body), times(this.rotation(body), point)); }

  // Length of the box that holds all links.
  extent() {
    const points = this.bodies.flatMap((b, i) => [this.origin(i), ...this.tips[i].map((t) => this.world(i, t))]);
    const range = (k) => Math.max(...points.map((p) => p[k])) - Math.min(...points.map((p) => p[k]));
    return Math.hypot(range(0), range(1), range(2)) || 0.5;
  }

  // Balls that may touch the floor: [body, x, y, z, radius]. Of collision shapes where the file has them.
  findBalls() {
    const shapes = this.collisionBalls();
    this.guessed = shapes.length === 0;
    this.found = this.guessed ? this.guessedBalls() : shapes;
    this.touching = new Set(this.found.map(([body]) => body));
  }

  // Those of the links that the user lets touch.
  get balls() { return this.found.filter(([body]) => this.touching.has(body)); }

  guessedBalls() {
    const balls = [], radius = 0.012 * this.size, seen = new Set(), { soles = {} } = this.source;
    this.bodies.forEach((b, i) => {
      if (Object.hasOwn(soles, b.name)) return balls.push(...soles[b.name].map((p) => [i, ...p, 0]));
      for (const tip of this.tips[i]) {
        const key = `${i} ${tip.map((x) => x.toFixed(4))}`;
        if (!seen.has(key)) balls.push([i, ...tip, radius]);
        seen.add(key);
      }
    });
    return balls.slice(0, 300);
  }

  collisionBalls() {
    const balls = [], numbers = (s) => (s ?? "0 0 0").trim().split(/\s+/).map(Number);
    const places = new Map(this.frames.map((f) => [f.link, f]));
    for (const shape of new DOMParser().parseFromString(this.source.text, "text/xml").querySelectorAll("link > collision")) {
      const frame = places.get(shape.parentElement.getAttribute("name"));
      const kind = shape.querySelector("geometry")?.firstElementChild, origin = shape.querySelector("origin");
      if (!frame || frame.body < 0 || !kind) continue;
      const at = numbers(origin?.getAttribute("xyz")), R = rotationOf(...numbers(origin?.getAttribute("rpy")));
      for (const [point, radius] of roundPoints(kind, numbers)) {
        const inLink = plus(at, times(R, point));
        balls.push([frame.body, ...plus(frame.position, times(frame.rotation, inLink)), radius]);
      }
    }
    return balls.filter((b) => b.every(Number.isFinite)).slice(0, 300);
  }

  // Whether any link has mass; without, a robot has poses and no dynamics.
  static hasMass(text) {
    const file = new DOMParser().parseFromString(text, "text/xml");
    return file.querySelector("parsererror") !== null || [...file.querySelectorAll("link > inertial > mass")].some((m) => Number(m.getAttribute("value")) !== 0);
  }

  // Whether the file's root link has mass, so that only its user knows if it floats.
  static rootHasMass(text) {
    const file = new DOMParser().parseFromString(text, "text/xml"), name = (e) => e.getAttribute("name");
    const children = new Set([...file.querySelectorAll("robot > joint > child")].map((c) => c.getAttribute("link")));
    const root = [...file.querySelectorAll("robot > link")].find((l) => !children.has(name(l)));
    return root && Number(root.querySelector("inertial > mass")?.getAttribute("value")) > 0 ? name(root) : null;
  }

  // Forces of the floor in the last step: [{ place, force }].
  floorForces() {
    const n = this.exports().web_contact_forces(), f = this.model.array("contact_forces"), { balls } = this;
    return balls.slice(0, n).map(([body, x, y, z, r], i) => ({
      place: plus(this.world(body, [x, y, z]), [0, 0, -r]), force: [...f.subarray(4 * i + 1, 4 * i + 4)],
    })).filter(({ force }) => Math.hypot(...force) > 0);
  }

  makeContacts(floor = this.isFloating(), friction = 0.7) {
    this.floor = floor;
    const balls = floor ? this.balls : [];
    this.exports().web_contacts(this.model.copy(balls.flat()), balls.length, friction, 0);
  }
  exports() { return this.model.exports; }

  // Puts a floating robot on the floor: its lowest ball touches it, or hangs that far above.
  stand(above = 0) {
    if (!this.isFloating() || this.balls.length === 0) return;
    const lowest = Math.min(...this.balls.map(([body, x, y, z, r]) => this.world(body, [x, y, z])[2] - r));
    this.q()[2] += above - lowest;
    this.update();
  }

  // Where balls touch the floor: [x, y, z, body, radius], the lowest point of each.
  footing() {
    if (!this.floor || !this.found) return [];
    return this.balls.map(([body, x, y, z, r]) => [...plus(this.world(body, [x, y, z]), [0, 0, -r]), body, r])
      .filter((p) => p[2] < near);
  }

  // A place of the world in a body's axes.
  local(body, place) { return timesBack(this.rotation(body), plus(place, this.origin(body).map((x) => -x))); }

  // Torques of the motors that hold this pose: { torques, forces: [{ place, force }], how }. A robot that floats stands
  // on what touches the floor, if that pushes only; points that would have to pull are left out, one by one.
  atRest() {
    const hanging = { torques: this.gravity, forces: [], how: this.isFloating() ? "hanging" : "fixed" };
    if (this.source.kinematic) return { ...hanging, how: "massless" };
    if (!this.isFloating() || !this.found) return hanging;
    for (let feet = this.support(); feet.length > 2;) {
      this.model.array("feet").set(feet.flatMap((p) => [p[3], ...this.local(p[3], p.slice(0, 3))]));
      if (this.exports().web_stand(feet.length) !== 0) return hanging;
      const f = this.model.array("foot_forces"), forces = feet.map((place, i) => ({ place, force: [...f.subarray(3 * i, 3 * i + 3)] }));
      const torques = this.model.array("standing").slice(), weight = 9.81 * this.model.mass;
      const missing = Math.hypot(...torques.subarray(0, 6)) / weight, least = Math.min(...forces.map((x) => x.force[2]));
      if (least >= -1e-9 * weight) return missing < 1e-6 ? { torques, forces, how: "standing" } : { ...hanging, how: "tipping" };
      feet = feet.filter((_, i) => forces[i].force[2] > least);
    }
    return this.margin() < 0 && this.margin() > -Infinity ? { ...hanging, how: "tipping" } : hanging;
  }

  // ---- inverse kinematics ----

  // What stays while a point of this body follows the mouse: the feet on the floor, or the root.
  grab(body) {
    const feet = new Map();
    for (const p of this.isFloating() ? this.footing() : []) {
      const [x, y, z, foot, radius] = p;
      if (foot !== body) feet.set(foot, [...(feet.get(foot) ?? []), [x, y, z + radius]]); // the ball rolls in place
    }
    const stay = [...feet].slice(0, 39).map(([b, points]) => {
      const middle = [0, 1, 2].map((k) => points.reduce((sum, p) => sum + p[k], 0) / points.length);
      return this.target(points.length > 2 ? POSE : POINT, b, 1e4, this.local(b, middle), middle);
    });
    return { body, stay, holdRoot: this.isFloating() && stay.length === 0 };
  }

  target(kind, body, weight, point, place) { return [kind, body, weight, ...point, ...place, ...this.rotation(body)]; }

  // Moves q so that the point comes to the place, or near it. Returns a sentence where it does not.
  reach({ body, stay, holdRoot }, point, place) {
    const list = [this.target(POINT, body, 1, point, place), ...stay];
    this.model.array("targets").set(list.flat());
    const status = this.exports().web_ik(list.length, holdRoot ? 1 : 0);
    const [metres, limit] = this.model.array("reached");
    if (status < 0) return this.model.string(this.exports().web_sentence());
    if (metres < 1e-3) return "";
    const stop = this.bodies.find((b) => b.iv <= limit && limit < b.iv + b.nv);
    return `Out of reach by ${(100 * metres).toFixed(1)} cm${status === 1 && stop ? `: ${stop.joint} is at its limit` : ""}.`;
  }

  // ---- what it stands on ----

  // Corners of the polygon that carries the robot: convex hull of the points on the floor.
  support() {
    const points = this.footing().sort((a, b) => a[0] - b[0] || a[1] - b[1]);
    const left = (a, b, c) => (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 1e-9;
    const half = (list) => list.reduce((hull, p) => {
      while (hull.length > 1 && !left(hull.at(-2), hull.at(-1), p)) hull.pop();
      return [...hull, p];
    }, []).slice(0, -1);
    return points.length < 3 ? points : [...half(points), ...half(points.reverse())];
  }

  // How far the centre of mass is within the polygon's edges, m; below 0 outside.
  margin() {
    const hull = this.support();
    if (hull.length < 3) return -Infinity;
    return Math.min(...hull.map((a, i) => {
      const b = hull[(i + 1) % hull.length], l = Math.hypot(b[0] - a[0], b[1] - a[1]);
      return ((b[0] - a[0]) * (this.com[1] - a[1]) - (b[1] - a[1]) * (this.com[0] - a[0])) / l;
    }));
  }

  // J J' of a frame's origin with the motors' columns of its linear rows.
  ellipsoid(frame) {
    const f = this.frames[frame], nv = this.model.nv;
    if (f.body < 0) return null;
    this.exports().web_pose();
    this.exports().web_jacobian(f.body, ...f.position);
    const J = this.model.array("jacobian"), columns = this.motors().map((b) => b.iv);
    const A = [3, 4, 5].map((i) => [3, 4, 5].map((j) => columns.reduce((s, k) => s + J[i * nv + k] * J[j * nv + k], 0)));
    return { place: this.world(f.body, f.position), axes: eigen(A) };
  }
}

function rotationOf(roll, pitch, yaw) {
  const [x, y, z, w] = quaternion(roll, pitch, yaw);
  return [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), 2 * (x * y + z * w), 1 - 2 * (x * x + z * z),
    2 * (y * z - x * w), 2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)];
}

// Points with a radius that stand for a shape: corners of a box, eight of a cylinder's rims, a ball itself.
function roundPoints(shape, numbers) {
  const signs = [-1, 1], radius = Number(shape.getAttribute("radius")), length = Number(shape.getAttribute("length"));
  if (shape.nodeName === "sphere") return [[[0, 0, 0], radius]];
  if (shape.nodeName === "box") {
    const half = numbers(shape.getAttribute("size")).map((x) => x / 2);
    return signs.flatMap((i) => signs.flatMap((j) => signs.map((k) => [[i * half[0], j * half[1], k * half[2]], 0])));
  }
  if (shape.nodeName !== "cylinder") return [];
  const rim = [[radius, 0], [0, radius], [-radius, 0], [0, -radius]];
  return signs.flatMap((s) => rim.map(([x, y]) => [[x, y, (s * length) / 2], 0]));
}
