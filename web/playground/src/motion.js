// Time goes on in steps of 1 ms, as near to the clock as the machine can.
import { $ } from "./panels.js";

const dt = 1e-3;

export class Motion {
  constructor() { this.steps = 0; this.history = []; this.running = false; }

  start(robot) {
    this.robot = robot;
    this.grip = null;
    this.push = null;
    this.steps = 0;
    this.history = [];
    this.last = null;
    this.forces = [];
    this.rate = null;
    this.place = robot.model.copy(new Array(8).fill(0));
    this.setMotors();
  }

  // Damping of the joints; motors as springs that are stiff beside the weight, where they hold the pose.
  setMotors() {
    const { robot } = this, damping = robot.model.array("damping"), stiffness = robot.model.array("stiffness");
    const weight = 9.81 * robot.model.mass * robot.size, hold = $("hold").checked;
    damping.fill(0);
    stiffness.fill(0);
    for (const b of robot.motors()) {
      stiffness[b.iv] = hold ? (b.type === 4 ? (10 * weight) / robot.size ** 2 : 5 * weight) : 0;
      damping[b.iv] = Math.max(0, Number($("damping").value) || 0) + 0.03 * stiffness[b.iv];
    }
    if (hold) robot.model.array("wanted").set(robot.q());
  }

  // A pull by the mouse: a spring that carries the robot's weight over a fifth of its size.
  pull(body, point, place) {
    this.grip = [body, ...point, ...place, (9.81 * this.robot.model.mass) / (0.2 * this.robot.size)];
  }

  // A push of so many newtons along a direction, for 0.1 s: a spring to a place far away.
  pushLink(frame, direction, newton) {
    const far = 1e4, { body, position } = this.robot.frames[frame];
    const place = this.robot.world(body, position).map((x, k) => x + far * direction[k]);
    this.push = { grip: [body, ...position, ...place, newton / far], until: this.steps + 100 };
  }

  // Steps up to the time of a frame; gives up what the machine cannot do in 20 ms. Returns 0, or a status.
  frame(time) {
    const { exports } = this.robot.model, wanted = Math.min(34, Math.round(time - (this.last ?? time - 16)));
    this.last = time;
    const begin = performance.now();
    for (let done = 0; done < wanted && performance.now() - begin < 20; ) {
      if (this.push && this.steps >= this.push.until) this.push = null;
      const grip = this.push?.grip ?? this.grip, n = Math.min(4, wanted - done);
      if (grip) new Float64Array(exports.memory.buffer, this.place, 8).set(grip);
      const status = exports.web_step(n, dt, grip ? this.place : 0);
      if (status) return status;
      done += n;
      this.steps += n;
    }
    this.robot.updatePose();
    this.record(time);
    return 0;
  }

  // What the curves show, and how much of the clock's time passes for the robot: of the last second.
  record(time) {
    const { robot, history } = this, [kinetic, potential] = robot.energy, t = this.steps * dt;
    this.forces = robot.floorForces();
    const up = this.forces.reduce((sum, { force }) => sum + force[2], 0);
    history.push({ t, time, kinetic, potential, up, joints: robot.motors().map((b) => robot.q()[b.iq]), torques: this.torques() });
    if (history.length > 600) history.shift();
    const first = history.find((h) => time - h.time < 1000);
    this.rate = time > first.time ? (1e3 * (t - first.t)) / (time - first.time) : null;
  }

  // What the springs that hold the pose give, N m or N.
  torques() {
    const [k, d, wanted, v] = ["stiffness", "damping", "wanted", "v"].map((name) => this.robot.model.array(name)), q = this.robot.q();
    return this.robot.motors().map(({ iq, iv }) => k[iv] * (wanted[iq] - q[iq]) - Math.min(d[iv], 0.03 * k[iv]) * v[iv]);
  }
}
