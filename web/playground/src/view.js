// The picture: links as the file draws them, or as rods between joints; and the mouse in it.
import * as THREE from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import URDFLoader from "urdf-loader";
import { meshLoader, textureManager } from "./meshes.js";
import { eigen, PRISMATIC, FLOATING } from "./robot.js";

const rod = new THREE.CylinderGeometry(1, 1, 1, 12), ball = new THREE.SphereGeometry(1, 24, 16), coarseBall = new THREE.SphereGeometry(1, 10, 7);
const paint = (color, opacity = 1) => new THREE.MeshStandardMaterial({
  color, roughness: 0.55, transparent: opacity < 1, opacity, depthWrite: opacity === 1,
});
const colours = { link: paint(0xe8862e), joint: paint(0x3d4a57), inertia: paint(0x2f6fde, 0.16), com: paint(0xc02626),
  reach: paint(0x7b4fc7, 0.35), support: paint(0x128a4a, 0.3), grip: paint(0xc02626), contact: paint(0x128a4a), force: paint(0xc2187a) };
colours.support.side = THREE.DoubleSide;
const mostForces = 100; // arrows
const vector = (x) => new THREE.Vector3(...x);

// Makes a cylinder, or what stands for one, reach from one place to another.
function between(from, to, radius, object = new THREE.Object3D()) {
  const along = to.clone().sub(from), length = along.length();
  object.position.copy(from).addScaledVector(along, 0.5);
  if (length > 0) object.quaternion.setFromUnitVectors(new THREE.Vector3(0, 1, 0), along.divideScalar(length));
  object.scale.set(radius, length || radius, radius);
  return object;
}

function placeEllipsoid(object, place, axes, lengths) {
  const [x, y, z] = axes.map((a) => vector(a.axis));
  if (x.clone().cross(y).dot(z) < 0) z.negate();
  object.quaternion.setFromRotationMatrix(new THREE.Matrix4().makeBasis(x, y, z));
  object.position.set(...place);
  object.scale.set(...lengths);
  return object;
}

// Of the same mass and inertia, with its mass evenly spread.
function inertiaEllipsoid(b) {
  const [xx, xy, xz, yy, yz, zz] = b.inertia;
  const axes = eigen([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]), [a, c, e] = axes.map((p) => p.value);
  const half = (x) => Math.sqrt(Math.max(1e-6, (2.5 / b.mass) * x));
  return placeEllipsoid(new THREE.Object3D(), b.com, axes, [half(c + e - a), half(a + e - c), half(a + c - e)]);
}

// One shape at many places of bodies, [body, object] each: one call draws them, however many links there are.
function everywhere(shape, material, places) {
  const mesh = new THREE.InstancedMesh(shape, material, places.length);
  mesh.frustumCulled = false;
  mesh.userData.places = places.map(([body, object]) => (object.updateMatrix(), { body, matrix: object.matrix }));
  return mesh;
}

function hasSurface(object) {
  let found = false;
  object.traverse((o) => { found ||= Boolean(o.isMesh); });
  return found;
}

export class View {
  constructor(canvas, events) {
    this.canvas = canvas;
    this.events = events; // moved(), taken(body), pulled(body, point, place), released(), hover(body or null, event)
    this.drawn = {
      links: { label: "links", colour: 0xe8862e, on: true },
      joints: { label: "joint axes", colour: 0x3d4a57, on: true },
      inertia: { label: "inertia, as an ellipsoid of the same mass", colour: 0x9db8ea, on: true },
      com: { label: "centre of mass, and below it", colour: 0xc02626, on: true },
      contacts: { label: "points that may touch the floor", colour: 0x128a4a, on: true },
      support: { label: "what it stands on", colour: 0xa6cfb6, on: true },
      forces: { label: "forces of the floor", colour: 0xc2187a, on: true },
      reach: { label: "Jacobian's ellipsoid", colour: 0x7b4fc7, on: true },
      frames: { label: "link frames: x red, y green, z blue", colour: 0x888888, on: false },
    };
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.renderer.setPixelRatio(Math.min(2, devicePixelRatio));
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(40, 1, 0.01, 500);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener("change", () => { this.dirty = true; });
    const sun = new THREE.DirectionalLight(0xffffff, 2);
    sun.position.set(2, -3, 5);
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0x8899aa, 2), sun);
    this.ray = new THREE.Raycaster();
    this.frames = 0;
    this.listen();
  }

  show(robot) {
    if (this.root) this.scene.remove(this.root, this.grid);
    for (const mesh of [...(this.rods ?? []), this.contacts, this.arrows]) mesh?.dispose();
    this.contacts = null;
    this.robot = robot;
    this.root = new THREE.Group();
    this.groups = robot.bodies.map((b, i) => this.bodyGroup(i));
    this.base = new THREE.Group();
    this.marks = new THREE.Group();
    const shaped = this.drawShapes();
    this.rods = this.drawRods(shaped);
    this.root.add(this.base, this.marks, ...this.groups, ...this.rods);
    this.drawMarks();
    this.drawContacts();
    this.axes = robot.bodies.map((_, i) => this.groups[i].add(new THREE.AxesHelper(0.12 * robot.size)).children.at(-1));
    this.choose();
    const cells = Math.ceil(robot.size * 4);
    this.grid = new THREE.GridHelper(cells, 4 * cells, 0x8899aa, 0xbcc6d0);
    this.grid.rotation.x = Math.PI / 2;
    this.scene.add(this.root, this.grid);
    this.update();
    this.controls.target.set(0, 0, 0);
    this.camera.position.set(1.1, -1.3, 0.5);
    this.frame();
  }

  // Shows what is chosen of `drawn`.
  choose() {
    const { drawn } = this, [links, joints, inertias] = this.rods;
    const set = (on, ...objects) => { for (const o of objects) o.visible = on; };
    set(drawn.links.on, links, ...this.shapes);
    set(drawn.joints.on, joints);
    set(drawn.inertia.on, inertias);
    set(drawn.com.on, this.com, this.plumb);
    set(drawn.contacts.on, this.contacts);
    set(drawn.forces.on, this.arrows);
    set(drawn.frames.on, ...this.axes);
    this.support.visible = drawn.support.on && this.stands;
    this.reach.visible = drawn.reach.on && this.reaches;
    this.dirty = true;
  }

  bodyGroup(index) {
    const group = new THREE.Group();
    group.matrixAutoUpdate = false;
    group.userData.body = index;
    return group;
  }

  // Rods to where links end, a cylinder along each joint's axis, and ellipsoids of inertia: of bodies without shapes.
  drawRods(shaped) {
    const { robot } = this, thick = 0.013 * robot.size * Math.min(1, Math.sqrt(12 / robot.bodies.length));
    const links = [], joints = [], inertias = [];
    robot.bodies.forEach((b, i) => {
      if (shaped.has(i)) return;
      for (const tip of robot.tips[i]) {
        if (Math.hypot(...tip) > 1e-4) links.push([i, between(new THREE.Vector3(), vector(tip), thick)]);
      }
      if (b.nv === 1) {
        const half = vector(b.axis).normalize().multiplyScalar(2.2 * thick);
        joints.push([i, between(half.clone().negate(), half, 1.7 * thick)]);
      }
      if (b.mass > 0) inertias.push([i, inertiaEllipsoid(b)]);
    });
    return [everywhere(rod, colours.link, links), everywhere(rod, colours.joint, joints),
      everywhere(inertias.length > 50 ? coarseBall : ball, colours.inertia, inertias)];
  }

  // The points that may touch the floor.
  drawContacts() {
    const { robot } = this, least = 0.008 * robot.size;
    if (this.contacts) {
      this.root.remove(this.contacts);
      this.contacts.dispose();
    }
    this.contacts = everywhere(coarseBall, colours.contact, robot.floor ? robot.balls.map(([body, x, y, z, radius]) => {
      const object = new THREE.Object3D();
      object.position.set(x, y, z);
      object.scale.setScalar(Math.max(radius, least));
      return [body, object];
    }) : []);
    this.contacts.visible = this.drawn.contacts.on;
    this.root.add(this.contacts);
  }

  // Arrows from where the floor pushes: a third of the robot's size for its weight.
  showForces(forces) {
    const { robot, arrows } = this, scale = robot.size / 3 / (9.81 * robot.model.mass), object = new THREE.Object3D();
    arrows.count = Math.min(mostForces, forces.length);
    forces.slice(0, arrows.count).forEach(({ place, force }, k) => {
      const from = vector(place);
      between(from, from.clone().addScaledVector(vector(force), scale), 0.008 * robot.size, object).updateMatrix();
      arrows.setMatrixAt(k, object.matrix);
    });
    arrows.instanceMatrix.needsUpdate = true;
    this.dirty = true;
  }

  // The file's visual shapes in place of rods, where at least one of a body can be drawn. A name or a number that
  // urdf-loader does not take: rods stay. Returns the bodies that have some; this.missing names the meshes that are not drawn.
  drawShapes() {
    const { source, frames } = this.robot, shaped = new Set();
    this.shapes = [];
    this.missing = new Map();
    let drawn;
    try {
      const loader = new URDFLoader(textureManager(source.files));
      loader.loadMeshCb = meshLoader(source.files, () => { this.dirty = true; }, (uri, why) => this.missing.set(uri, why));
      loader.packages = (name) => name;
      drawn = loader.parse(source.text);
    } catch { return shaped; }
    for (const f of frames) {
      const shapes = drawn.links[f.link]?.children.filter((c) => c.isURDFVisual && hasSurface(c)) ?? [];
      if (shapes.length === 0) continue;
      const [a, b, c, d, e, g, h, i, j] = f.rotation, link = new THREE.Group();
      link.matrixAutoUpdate = false;
      link.matrix.set(a, b, c, f.position[0], d, e, g, f.position[1], h, i, j, f.position[2], 0, 0, 0, 1);
      link.add(...shapes);
      (this.groups[f.body] ?? this.base).add(link);
      this.shapes.push(link);
      shaped.add(f.body);
    }
    return shaped;
  }

  drawMarks() {
    const { size } = this.robot;
    this.com = new THREE.Mesh(ball, colours.com);
    this.com.scale.setScalar(0.02 * size);
    this.plumb = between(new THREE.Vector3(), new THREE.Vector3(0, 0, 1), 0.003 * size, new THREE.Mesh(rod, colours.com));
    this.reach = new THREE.Mesh(ball, colours.reach);
    this.support = new THREE.Mesh(new THREE.BufferGeometry(), colours.support);
    this.arrow = new THREE.Mesh(rod, colours.grip);
    this.arrow.visible = false;
    this.arrows = new THREE.InstancedMesh(rod, colours.force, mostForces);
    this.arrows.frustumCulled = false;
    this.arrows.count = 0;
    this.marks.add(this.arrows, this.com, this.plumb, this.reach, this.support, this.arrow);
  }

  // After the robot has a new pose.
  update() {
    const { robot } = this;
    this.groups.forEach((group, i) => {
      const R = robot.rotation(i), p = robot.origin(i);
      group.matrix.set(R[0], R[1], R[2], p[0], R[3], R[4], R[5], p[1], R[6], R[7], R[8], p[2], 0, 0, 0, 1);
    });
    const matrix = new THREE.Matrix4();
    for (const mesh of [...this.rods, this.contacts]) {
      mesh.userData.places.forEach((p, k) => mesh.setMatrixAt(k, matrix.multiplyMatrices(this.groups[p.body].matrix, p.matrix)));
      mesh.instanceMatrix.needsUpdate = true;
      mesh.boundingBox = mesh.boundingSphere = null;
    }
    const [x, y, z] = robot.com;
    this.com.position.set(x, y, z);
    this.plumb.position.set(x, y, z / 2);
    this.plumb.scale.y = Math.abs(z) || 1e-6;
    const hull = robot.isFloating() ? robot.support() : [];
    this.stands = hull.length > 2;
    this.support.visible = this.drawn.support.on && this.stands;
    if (this.stands) {
      const corners = hull.slice(1, -1).flatMap((c, i) => [hull[0], hull[i + 1], hull[i + 2]]).flatMap((c) => [c[0], c[1], 0.002]);
      this.support.geometry.dispose();
      this.support.geometry = new THREE.BufferGeometry().setAttribute("position", new THREE.Float32BufferAttribute(corners, 3));
      this.support.geometry.computeVertexNormals();
    }
    this.dirty = true;
  }

  showEllipsoid(e) {
    this.reaches = Boolean(e);
    this.reach.visible = this.drawn.reach.on && this.reaches;
    this.dirty = true;
    if (!e) return;
    const lengths = e.axes.map((a) => Math.sqrt(Math.max(0, a.value))), scale = (0.17 * this.robot.size) / (Math.max(...lengths) || 1);
    placeEllipsoid(this.reach, e.place, e.axes, lengths.map((l) => Math.max(l * scale, 0.003 * this.robot.size)));
  }

  // The whole robot in the picture, from the direction in which one looks.
  frame() {
    this.resize();
    this.root.updateMatrixWorld(true);
    const box = new THREE.Box3();
    for (const group of [this.base, ...this.groups, ...this.rods]) box.expandByObject(group, true);
    if (box.isEmpty()) box.set(new THREE.Vector3(-0.5, -0.5, 0), new THREE.Vector3(0.5, 0.5, 1));
    const { center, radius } = box.getBoundingSphere(new THREE.Sphere()), half = (this.camera.fov / 2) * (Math.PI / 180);
    const away = this.camera.position.clone().sub(this.controls.target).normalize();
    const corner = (k) => new THREE.Vector3(...["x", "y", "z"].map((c, i) => (k & (1 << i) ? box.max : box.min)[c]));
    let distance = radius / Math.sin(Math.atan(Math.tan(half) * Math.min(1, this.camera.aspect)));
    for (let turn = 0; turn < 4; turn++) { // nearer, until the box just fits
      this.camera.position.copy(center).addScaledVector(away, distance);
      this.camera.lookAt(center);
      this.camera.updateMatrixWorld();
      const seen = [0, 1, 2, 3, 4, 5, 6, 7].map((k) => corner(k).project(this.camera));
      distance *= 1.12 * Math.max(...seen.flatMap((p) => [Math.abs(p.x), Math.abs(p.y)]));
    }
    this.controls.target.copy(center);
    this.controls.update();
    this.dirty = true;
  }

  // Turns (rad) and zooms about the target, for keys.
  turn(right, up, zoom = 1) {
    const s = new THREE.Spherical(), y = new THREE.Quaternion().setFromUnitVectors(this.camera.up, new THREE.Vector3(0, 1, 0));
    const from = this.camera.position.clone().sub(this.controls.target).applyQuaternion(y);
    s.setFromVector3(from);
    s.theta += right;
    s.phi = Math.min(3.1, Math.max(0.04, s.phi - up));
    s.radius *= zoom;
    this.camera.position.copy(from.setFromSpherical(s).applyQuaternion(y.invert())).add(this.controls.target);
    this.controls.update();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (!width || !height) return;
    const ratio = this.renderer.getPixelRatio();
    if (this.canvas.width === Math.floor(width * ratio) && this.canvas.height === Math.floor(height * ratio)) return;
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.dirty = true;
  }

  draw() {
    this.resize();
    this.look();
    if (!this.dirty) return;
    this.dirty = false;
    this.renderer.render(this.scene, this.camera);
    this.frames++;
  }

  // ---- the mouse ----

  aim(event) {
    const box = this.canvas.getBoundingClientRect();
    this.ray.setFromCamera(new THREE.Vector2(((event.clientX - box.left) / box.width) * 2 - 1,
      1 - ((event.clientY - box.top) / box.height) * 2), this.camera);
  }

  // Before OrbitControls, which must not turn the view when a link is taken.
  listen() {
    this.canvas.addEventListener("pointerdown", (event) => this.take(event), { capture: true });
    this.canvas.addEventListener("pointermove", (event) => {
      if (this.taken) this.drag(event);
      else if (event.buttons === 0 && event.pointerType === "mouse") this.pointed = event; // looked at in the next frame
    });
    this.canvas.addEventListener("pointerleave", () => {
      this.pointed = null;
      this.events.hover(null);
    });
    for (const end of ["pointerup", "pointercancel"]) {
      this.canvas.addEventListener(end, () => {
        if (this.taken) this.events.released();
        this.taken = null;
        this.arrow.visible = false;
        this.controls.enabled = this.dirty = true;
      });
    }
    this.canvas.addEventListener("keydown", (event) => {
      const turns = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1], "+": [0, 0, 0.9], "-": [0, 0, 1.1] };
      if (!turns[event.key]) return;
      this.turn(...turns[event.key]);
      event.preventDefault();
    });
  }

  // The link under the mouse: { body, point (world) }, or null. What is not shown is not there.
  hit(event) {
    this.aim(event);
    const seen = [...this.groups, ...this.rods].filter((o) => o.visible);
    const found = this.ray.intersectObjects(seen, true).find(({ object }) => object.isMesh && object.visible && object.parent.visible);
    if (!found) return null;
    let at = found.object, body = at.userData.places?.[found.instanceId].body;
    for (; body === undefined; at = at.parent) body = at.userData.body;
    return { body, point: found.point };
  }

  // Tells which link the mouse is over.
  look() {
    if (!this.pointed || !this.robot) return;
    const event = this.pointed, hit = this.hit(event);
    this.pointed = null;
    this.canvas.style.cursor = hit ? "grab" : "";
    this.events.hover(hit, event);
  }

  take(event) {
    if (!this.robot) return;
    const hit = this.hit(event);
    this.events.hover(null);
    if (!hit) return;
    const { body } = hit;
    const point = hit.point.clone().applyMatrix4(this.groups[body].matrix.clone().invert());
    const plane = new THREE.Plane().setFromNormalAndCoplanarPoint(this.camera.getWorldDirection(new THREE.Vector3()), hit.point);
    this.taken = { body, point, plane };
    this.events.taken(body);
    this.controls.enabled = false;
    this.canvas.setPointerCapture(event.pointerId);
    this.canvas.focus();
    event.preventDefault();
  }

  drag(event) {
    this.aim(event);
    const { body, point, plane } = this.taken, place = this.ray.ray.intersectPlane(plane, new THREE.Vector3());
    if (!place) return;
    const way = this.events.pulled(body, point.toArray(), place.toArray());
    if (way === "pull") this.taken.place = place;
    if (way === "turn") this.turnJoint(body, point, place);
    if (way !== "pull") this.events.moved();
  }

  // Moves the joint above the taken link so that the point follows as near as this joint lets it.
  turnJoint(body, point, place) {
    const { robot } = this, at = vector(robot.world(body, point.toArray())), step = place.clone().sub(at);
    for (let i = body; i >= 0; i = robot.bodies[i].parent) {
      const b = robot.bodies[i], q = robot.q();
      if (b.type === FLOATING) return step.toArray().forEach((x, k) => { q[b.iq + k] += x; });
      if (b.nv !== 1) continue;
      const R = robot.rotation(i), [x, y, z] = vector(b.axis).normalize();
      const axis = new THREE.Vector3(R[0] * x + R[1] * y + R[2] * z, R[3] * x + R[4] * y + R[5] * z, R[6] * x + R[7] * y + R[8] * z);
      const column = b.type === PRISMATIC ? axis : axis.cross(at.clone().sub(vector(robot.origin(i))));
      const coordinate = robot.coordinates.find((c) => c.body === b), size = column.lengthSq();
      if (size < 1e-4 * robot.size ** 2 && b.type !== PRISMATIC) continue; // the point lies on the axis
      const dq = Math.max(-0.3, Math.min(0.3, column.dot(step) / size));
      return coordinate.set(Math.min(coordinate.high, Math.max(coordinate.low, coordinate.get() + dq)));
    }
  }

  // The arrow of a pull, while the robot moves.
  showGrip() {
    const { taken, robot } = this;
    this.arrow.visible = Boolean(taken?.place);
    if (!this.arrow.visible) return;
    const from = vector(robot.world(taken.body, taken.point.toArray()));
    between(from, taken.place, 0.006 * robot.size, this.arrow);
  }
}
