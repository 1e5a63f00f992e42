/* The commands as WebAssembly do what the native ones do: the same files, output, messages and exit statuses.
   usage: node test.mjs FOLDER_OF_WASM FOLDER_OF_NATIVE
   SPDX-License-Identifier: MIT */
import {spawnSync} from 'node:child_process';
import {copyFileSync, mkdtempSync, readdirSync, readFileSync, rmSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {dirname, join, resolve} from 'node:path';
import {fileURLToPath} from 'node:url';
import {run} from './wasi.mjs';

const [wasm, native] = process.argv.slice(2).map(a => resolve(a));
const root = join(dirname(fileURLToPath(import.meta.url)), '../..');
const modules = {};
for (const name of ['rbd-model', 'rbd-codegen'])
    modules[name] = await WebAssembly.compile(readFileSync(join(wasm, `${name}.wasm`)));
const scratch = mkdtempSync(join(tmpdir(), 'rbd-wasm-'));
let compared = 0, failed = 0;

/* name: the command's; file: the path of what it reads. */
async function compare(name, args, file) {
    const base = file.split('/').pop();
    const found = await run(modules[name], [name, ...args, base], {[base]: readFileSync(file)});
    copyFileSync(file, join(scratch, base));
    const expected = spawnSync(join(native, name), [...args, base], {cwd: scratch, encoding: 'utf8', maxBuffer: 1 << 30});
    const differ = ['status', 'stdout', 'stderr'].filter(what => found[what] !== expected[what]);
    for (const path of readdirSync(scratch)) {
        if (!found.files[path] || Buffer.compare(readFileSync(join(scratch, path)), found.files[path])) differ.push(path);
        rmSync(join(scratch, path));
    }
    compared++;
    if (differ.length === 0) return;
    failed++;
    console.log(`FAILED: ${differ.join(', ')}: ${name} ${args.join(' ')} ${base}`);
    if (differ.includes('stderr')) console.log(`native: ${expected.stderr}wasm: ${found.stderr}`);
}

const models = readdirSync(join(root, 'models')).filter(f => f.endsWith('.urdf')).map(f => join(root, 'models', f));
const all = 'id,bias,gravity_torque,mm,mm_packed,minv,fd,fd_cholesky,id_derivatives,fd_derivatives,' +
    'gravity_torque_derivatives,coriolis,momentum_matrix,com_jacobian';
for (const file of models) {
    const floating = /hyq|atlas/.test(file) ? ['--floating'] : [];
    for (const args of [['--c-model', 'robot'], ['--c', 'robot'], ['--dot'], []])
        await compare('rbd-model', [...floating, ...args], file);
    await compare('rbd-codegen', [...floating, '--name', 'robot', '--algorithm', all], file);
    await compare('rbd-codegen', [...floating, '--name', 'robot', '--limbs', '4', '--scalar', 'float', '--f-ext'], file);
    await compare('rbd-codegen', ['--name', 'robot', '--bounded-angles', '--short-sums', '--gravity-argument'], file);
}
const broken = join(root, 'tests/urdf/broken');
for (const file of readdirSync(broken).filter(f => f.endsWith('.urdf') && f !== 'mujoco.urdf'))
    await compare('rbd-model', [], join(broken, file));

// The native commands may have been built with MuJoCo; these never are, and say so.
const mjcf = await run(modules['rbd-model'], ['rbd-model', 'mujoco.urdf'],
    {'mujoco.urdf': readFileSync(join(broken, 'mujoco.urdf'))});
if (mjcf.status !== 1 || !mjcf.stderr.includes('built without MuJoCo')) {
    failed++;
    console.log(`FAILED: an MJCF file: status ${mjcf.status}: ${mjcf.stderr}`);
}
await compare('rbd-codegen', ['--algorithm', 'jacobian:nowhere'], models[0]);
rmSync(scratch, {recursive: true});
console.log(`${compared} runs compared, ${failed} differ`);
process.exitCode = failed > 0 || compared < 100 ? 1 : 0;
