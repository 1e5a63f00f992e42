// mujoco.mjs - MuJoCo's WebAssembly build, for `contact --results-of "node mujoco.mjs FOLDER"`; FOLDER/node_modules
// has @mujoco/mujoco. It writes its name in a line, then answers messages: a letter and numbers, all of them doubles.
//   m: length of the text, bodies, solver, cone, iterations, those of noslip, tolerance; then the MJCF text.
//      Answer: nq, nv, then for each body the places of its joint's qpos and qvel, -1 if it has none.
//   b: qpos, qvel: begins anew.
//   s: qfrc_applied: a step. Answer: qpos, qvel, M qacc - qfrc_smooth - qfrc_constraint, force of the ground along
//      the normal, iterations.
// SPDX-License-Identifier: MIT
import fs from 'node:fs';
import path from 'node:path';

const load = (await import(path.resolve(process.argv[2], 'node_modules/@mujoco/mujoco/mujoco.js'))).default;
const mujoco = await load();
let model, data;

// NULL at the end of the input.
function read(bytes) {
    const buffer = Buffer.alloc(bytes);
    for (let done = 0; done < bytes;) {
        const more = fs.readSync(0, buffer, done, bytes - done);
        if (more === 0) return null;
        done += more;
    }
    return buffer;
}

function readNumbers(n) {
    const bytes = read(8 * n);
    return new Float64Array(bytes.buffer, bytes.byteOffset, n);
}

function write(bytes) {
    for (let done = 0; done < bytes.length;) done += fs.writeSync(1, bytes, done);
}

const writeNumbers = (numbers) => write(new Uint8Array(Float64Array.from(numbers).buffer));

function makeModel() {
    const [length, bodies, solver, cone, iterations, noslip, tolerance] = readNumbers(7);
    const text = read(length).toString();
    data?.delete();
    model?.delete();
    model = mujoco.MjModel.from_xml_string(text);

    const option = model.opt, bit = mujoco.mjtDisableBit;
    option.solver = solver;
    option.cone = cone;
    option.iterations = iterations;
    option.noslip_iterations = noslip;
    option.noslip_tolerance = tolerance;
    for (const name of ['EQUALITY', 'FRICTIONLOSS', 'LIMIT', 'ACTUATION', 'SENSOR'])
        option.disableflags |= bit['mjDSBL_' + name].value;
    data = new mujoco.MjData(model);

    const places = [model.nq, model.nv];
    for (let i = 0; i < bodies; i++) {
        const joint = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT.value, 'j' + i);
        places.push(joint < 0 ? -1 : model.jnt_qposadr[joint], joint < 0 ? -1 : model.jnt_dofadr[joint]);
    }
    writeNumbers(places);
}

function begin() {
    mujoco.mj_resetData(model, data);
    data.qpos.set(readNumbers(model.nq));
    data.qvel.set(readNumbers(model.nv));
}

function groundForce() {
    const force = new mujoco.DoubleBuffer(6), contacts = data.contact;
    let sum = 0;
    for (let i = 0; i < data.ncon; i++) {
        const contact = contacts.get(i);
        const among = model.geom_bodyid[contact.geom1] && model.geom_bodyid[contact.geom2];
        contact.delete();
        if (among) continue;
        mujoco.mj_contactForce(model, data, i, force);
        sum += force.GetView()[0];
    }
    contacts.delete();
    force.delete();
    return sum;
}

function unsolved() {
    const inertia = new mujoco.DoubleBuffer(model.nv);
    mujoco.mj_mulM(model, data, inertia, data.qacc);
    const rest = inertia.GetView().map((x, i) => x - data.qfrc_smooth[i] - data.qfrc_constraint[i]);
    inertia.delete();
    return rest;
}

function step() {
    data.qfrc_applied.set(readNumbers(model.nv));
    mujoco.mj_step(model, data);
    writeNumbers([...data.qpos, ...data.qvel, ...unsolved(), groundForce(), data.solver_niter[0]]);
}

write(Buffer.from('MuJoCo ' + mujoco.mj_versionString() + '\n'));
for (let letter; (letter = read(1)) !== null;) ({m: makeModel, b: begin, s: step})[letter.toString()]();
