/* Runs a command that was compiled for WASI: node node.mjs PROGRAM.wasm [ARGUMENT...]. It sees no files.
   SPDX-License-Identifier: MIT */
import {readFileSync} from 'node:fs';
import {run} from './wasi.mjs';

const [program, ...args] = process.argv.slice(2);
const {status, stdout, stderr} = await run(await WebAssembly.compile(readFileSync(program)), [program, ...args]);
process.stdout.write(stdout);
process.stderr.write(stderr);
process.exitCode = status;
