#!/usr/bin/env python3
"""Record and replay (examples/firmware): a dump, whole, damaged, altered, and from other programs.

    replay.py REPLAY RECORDER           programs: examples/firmware/replay.c, tests/recorder.c; CC is the compiler
    replay.py REPLAY --emulated TARGET  records on a microcontroller under QEMU and replays; recorded_servos.c too, with
                                        RBD_ALL_TESTS=yes; skipped (77) without QEMU
    replay.py REPLAY --record           on a Cortex-M7, and writes tests/data/recorded_iiwa.txt: where rbd's bits moved

SPDX-License-Identifier: MIT"""
import os
import pathlib
import random
import shlex
import shutil
import struct
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
EXAMPLES = ROOT / "examples/firmware"
DUMP = ROOT / "tests/data/recorded_iiwa.txt"
SAME, DIFFERS, DAMAGED, UNUSABLE = range(4)
INPUTS, STATES, OUTPUTS = 28, 7, 7
KEPT = 64  # ticks of the dump in tests/data

failures = 0


def checksum(text):
    """FNV-1a of 64 bits."""
    value = 0xcbf29ce484222325
    for byte in text.encode():
        value = (value ^ byte) * 0x100000001b3 % 2**64
    return value


def sealed(text):
    """A line with its checksum, in place of one that it has."""
    body = text.rstrip("\n").rpartition(" ")[0] + " "
    return f"{body}{checksum(body):016x}\n"


def replay(program, dump, *words):
    """Exit status and what is printed; a dump is a list of lines, or bytes."""
    with tempfile.NamedTemporaryFile() as file:
        file.write(dump if isinstance(dump, bytes) else "".join(dump).encode())
        file.flush()
        done = subprocess.run([program, file.name, *words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
    return done.returncode, done.stdout.decode()


def expect(name, got, status, *sentences):
    global failures
    if got[0] != status or not all(s in got[1] for s in sentences):
        print(f"FAILED: {name}: status {got[0]}, wanted {status} and {sentences}:\n{got[1]}")
        failures += 1


# ---- the dump of the repository, and what can be wrong with it ----

def altered(lines, tick, field, scalar, bit):
    """A bit of a scalar of a tick (0: the first) is flipped; field 2 inputs, 3 states, 4 outputs. The checksum is right."""
    words = lines[1 + tick].split()
    at = slice(8 * scalar, 8 * scalar + 8)
    words[field] = words[field][:at.start] + f"{int(words[field][at], 16) ^ 1 << bit:08x}" + words[field][at.stop:]
    return lines[:1 + tick] + [sealed(" ".join(words) + "\n")] + lines[2 + tick:]


def header(lines, old, new):
    assert old in lines[0]
    return [sealed(lines[0].replace(old, new))] + lines[1:]


def check_dumps(program):
    lines = DUMP.read_text().splitlines(keepends=True)
    fields = lines[0].split()
    first, ticks = (int(fields[fields.index(name) + 1], 16) for name in ("first", "ticks"))
    assert ticks == KEPT == len(lines) - 1
    whole = f"{ticks} ticks from tick {first} on: all the same bits"

    expect("the dump", replay(program, lines), SAME, whole)
    expect("text around", replay(program, ["boot\n", "\n", *lines[:20], "tick, tock\n", *lines[20:], "end\n"]), SAME, whole)
    expect("of another terminal", replay(program, [line.replace("\n", "\r\n") for line in lines]), SAME, whole)
    expect("in another order", replay(program, lines[:1] + lines[:0:-1]), SAME, whole)

    text = "".join(lines).encode()
    expect("an empty dump", replay(program, []), UNUSABLE, "the recording is empty: nothing was replayed")
    for length in [5, 100, len(lines[0]) - 2, *range(len(lines[0]) + 5, len(text) - 2, 397), len(text) - 2]:
        there = text[:length + 1].count(b"\n") - 1 if length > len(lines[0]) else 0
        got = replay(program, text[:length])
        if there > 0:
            expect(f"{length} bytes", got, DAMAGED, f"truncated: the first {there} of {ticks} ticks are there",
                   f"{there} ticks from tick {first} on: all the same bits")
        elif length > len(lines[0]):
            expect(f"{length} bytes", got, UNUSABLE, "truncated: the recording has its first line and no whole tick")
        else:
            expect(f"{length} bytes", got, UNUSABLE, "no line begins with rbd-recording" if length < 14 else "cut off")
    expect("a line is gone", replay(program, lines[:8] + lines[9:]), DAMAGED,
           f"damaged: 1 of {ticks} ticks are missing or have a wrong checksum, the first is tick {first + 7}",
           f"{ticks - 1} ticks from")
    for k in (1, 30, ticks):
        broken = lines[:k] + [lines[k].replace(lines[k].split()[2][5], "g" if k == 1 else "0", 1)] + lines[k + 1:]
        expect("a character is wrong", replay(program, broken), DAMAGED, "damaged" if k < ticks else "truncated")
    expect("the first line is damaged", replay(program, [lines[0].replace("model", "modal")] + lines[1:]), UNUSABLE,
           "the first line of the recording is damaged")

    # Bits that changed before the checksum was made.
    for tick, joint, bit in ((0, 1, 22), (31, 4, 20), (ticks - 1, 7, 22)):
        expect("an input", replay(program, altered(lines, tick, 2, joint - 1, bit)), DIFFERS, f"tick {first + tick}, joint ",
               "torque recorded", f"1 of {ticks} ticks differ")
    for tick, joint in ((0, 1), (17, 5), (ticks - 1, 7)):
        recorded = struct.unpack(">f", bytes.fromhex(lines[1 + tick].split()[4][8 * joint - 8:8 * joint]))[0]
        changed = altered(lines, tick, 4, joint - 1, 0)
        bits = changed[1 + tick].split()[4][8 * joint - 8:8 * joint]
        expect("a torque", replay(program, changed), DIFFERS,
               f"tick {first + tick}, joint {joint}: torque recorded ", f"(bits {bits}), computed again {recorded:.9g} (",
               f"1 of {ticks} ticks differ")
    expect("a state", replay(program, altered(lines, 9, 3, 2, 22)), DIFFERS,
           f"tick {first + 8}, joint 3: state after it recorded", f"2 of {ticks} ticks differ")
    expect("two", replay(program, altered(altered(lines, 40, 4, 0, 3), 12, 4, 1, 3)), DIFFERS,
           f"tick {first + 12}, joint 2: torque", f"2 of {ticks} ticks differ")
    expect("altered and cut off", replay(program, altered(lines, 3, 4, 0, 3)[:10]), DIFFERS, "truncated: the first 9 of",
           f"tick {first + 3}, joint 1: torque", "1 of 9 ticks differ")

    # Of another program.
    for old, new, sentence in (
            ("rbd-recording 01", "rbd-recording 02", "a recording of format 2, this program reads 1"),
            (" rbd ", " rbd 9", "recorded with rbd 9"), ("scalar 04", "scalar 08", "recorded with scalars of 8 bytes"),
            ("inputs 001c", "inputs 001d", "recorded with 29 inputs, 7 states and 7 outputs, this program has 28, 7 and 7"),
            ("outputs", "torques", "cannot be read"), ("ticks 000000", "ticks ffffff", "too many for the memory"),
            (f"ticks {ticks:08x}", "ticks 00000000", "0 ticks: none")):
        expect(new, replay(program, header(lines, old, new)), UNUSABLE, sentence, "nothing was replayed")
    expect("a table", replay(program, ["q,v\n", "1,2\n"]), UNUSABLE, "not a recording")
    expect("no such file", replay(program, lines, "/no/such/folder/table.csv"), UNUSABLE,
           "cannot write the table '/no/such/folder/table.csv': No such file or directory: nothing was replayed")
    done = subprocess.run([program, "/no/such/dump"], stdout=subprocess.PIPE, text=True, check=False)
    expect("no such dump", (done.returncode, done.stdout), UNUSABLE,
           "cannot open the recording '/no/such/dump': No such file or directory: nothing was replayed")

    # Whatever is in it, with the right checksums: a status of the four, and a sentence.
    source = random.Random(32)
    for _ in range(200):
        some = list(lines[:12])
        for k in source.sample(range(12), 3):
            at, kind = source.randrange(1, len(some[k]) - 18), source.randrange(3)
            some[k] = sealed(some[k][:at] + ("", " ", "f" * source.randrange(2000))[kind] + some[k][at + (kind == 0):])
        status, printed = replay(program, some)
        if status not in range(4) or not printed:
            expect(f"random: {some}", (status, printed), DAMAGED)

    with tempfile.TemporaryDirectory() as scratch:
        table = pathlib.Path(scratch, "table.csv")
        expect("a table", replay(program, altered(lines, 3, 4, 0, 3), table), DIFFERS)
        rows = [row.split(",") for row in table.read_text().splitlines()]
        unlike = [i for i, row in enumerate(rows) if row[8:15] != row[15:22]]
        if shutil.which("gnuplot"):
            picture = pathlib.Path(scratch, "picture.png")
            subprocess.run(["gnuplot", "-e", f"csv = '{table}'; png = '{picture}'", EXAMPLES / "replay.gp"], check=True)
            assert picture.read_bytes()[1:4] == b"PNG"
        if len(rows) != ticks or any(len(row) != 22 for row in rows) or unlike != [3]:
            expect("a table: a row for each tick, one of them with two torques", (0, str(unlike)), SAME, "[3]")


def check_others(program):
    """A program with another model and one with other gains refuse the dump."""
    for name, old, new, sentence in (
            ("models/iiwa_model.h", "RBD_C(1.60669475)", "RBD_C(1.60669476)", "recorded with another model"),
            ("examples/firmware/recorded_controller.h", "[KD] = 20", "[KD] = 21", "recorded with another configuration")):
        with tempfile.TemporaryDirectory() as scratch:
            for file in ("rbd.h", "models/iiwa_model.h", *(f"examples/firmware/{x}" for x in (
                    "replay.c", "recorder.h", "recorded_controller.h"))):
                there = pathlib.Path(scratch, file)
                there.parent.mkdir(parents=True, exist_ok=True)
                text = (ROOT / file).read_text()
                if file == name:
                    assert old in text
                    text = text.replace(old, new, 1)
                there.write_text(text)
            other = pathlib.Path(scratch, "replay")
            subprocess.run([*shlex.split(os.environ.get("CC", "cc")), "-std=c99", "-O0", "-Dalways_inline=unused", "-I", scratch,
                            f"{scratch}/examples/firmware/replay.c", "-o", other, "-lm"], check=True)
            expect(name, replay(other, DUMP.read_bytes()), UNUSABLE, sentence)


# ---- the recorder alone: tests/recorder.c ----

def check_recorder(program):
    expect("hashes", (subprocess.run([program], check=False).returncode, ""), SAME)
    for pushed in (0, 1, 3, 4, 5, 11):
        lines = subprocess.run([program, str(pushed)], stdout=subprocess.PIPE, text=True, check=True).stdout.splitlines()
        numbers = range(max(0, pushed - 4), pushed)
        wanted = [f"rbd-recording 01 rbd {lines[0].split()[3]} scalar 08 model {0x123:016x} configuration {0x456:016x} inputs 0002 "
                  f"states 0002 outputs 0002 first {numbers.start:016x} ticks {len(numbers):08x} "]
        for k in numbers:
            x = [struct.pack(">d", x).hex() for x in (k + 0.5, -float(k) if k else 0.0, k / 4, k / 8, 8 * k, 16 * k)]
            wanted.append(f"tick {k:016x} {x[0]}{x[1]} {x[2]}{x[3]} {x[4]}{x[5]} ")
        if lines != [line + f"{checksum(line):016x}" for line in wanted]:
            expect(f"{pushed} ticks", (1, "\n".join(lines)), SAME)


# ---- recorded on an emulated microcontroller ----

def cross_words(target):
    """Flags and QEMU's command of the cross files."""
    words = {}
    for name in (target, "riscv" if target.startswith("rv") else "arm"):
        for line in (EXAMPLES / f"cross/{name}.ini").read_text().splitlines():
            name, equals, value = line.partition(" = ")
            if equals and not line.startswith("#"):
                words[name] = eval(value.split(" #")[0], {"false": False, "true": True}, words)  # strings, lists and sums
    return words


def image(name, target, ticks, scratch):
    """What a program of examples/firmware prints on an emulated microcontroller, and its exit status."""
    words = cross_words(target)
    compiler, emulator = words["c"], words["exe_wrapper"]
    lacks = [name for name in (compiler, emulator[2]) if not shutil.which(name)]
    if not pathlib.Path("/usr/lib/picolibc", compiler[:-len("-gcc")]).exists():
        lacks.append("picolibc for " + compiler)
    if lacks:
        print("left out: there is no", ", no ".join(lacks))
        sys.exit(77)
    for source in (name, "board"):
        subprocess.run([compiler, "-std=c99", "-Og", "-Dalways_inline=unused", *words["c_args"], "-DRBD_REAL=float",
                        f"-DRECORDED_TICKS={ticks}", "-DPICOLIBC_INTEGER_PRINTF_SCANF", "-I", ROOT,
                        "-c", EXAMPLES / (source + ".c"), "-o", f"{scratch}/{source}.o"], check=True)
    subprocess.run([compiler, *words["c_link_args"], "-DPICOLIBC_INTEGER_PRINTF_SCANF", f"{scratch}/{name}.o",
                    f"{scratch}/board.o", "-lm", "-o", f"{scratch}/{name}"], check=True)
    done = subprocess.run([*emulator, f"{scratch}/{name}"], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, check=False)
    return done.returncode, done.stdout


def record(program, target, keep):
    ticks = KEPT if keep else 500
    with tempfile.TemporaryDirectory() as scratch:
        status, dump = image("recorded_control", target, ticks, scratch)
    report = dump.decode().partition("\n")[0]
    expect("the robot", (status, report), 0, "recorded control, iiwa")
    got = replay(program, dump)
    print(report, got[1], sep="\n")
    expect("replayed", got, SAME, f"{ticks} ticks from tick ", "all the same bits")
    if keep and not failures:
        DUMP.write_bytes(dump[dump.index(b"rbd-recording"):])


def record_servos(target):
    """An arm of servos with gravity and friction compensation: the currents, to the bit."""
    with tempfile.TemporaryDirectory() as scratch:
        status, dump = image("recorded_servos", target, 500, scratch)
        program = f"{scratch}/replay"
        subprocess.run([*shlex.split(os.environ.get("CC", "cc")), "-std=c99", "-O0", "-Dalways_inline=unused",
                        "-DCONTROLLER=\"servo_controller.h\"", "-I", ROOT, EXAMPLES / "replay.c", "-o", program, "-lm"],
                       check=True)
        report = dump.decode().partition("\n")[0]
        expect("the servos", (status, report), 0, "recorded servos, iiwa")
        got = replay(program, dump)
        print(report, got[1], sep="\n")
        expect("servos replayed", got, SAME, "500 ticks from tick ", "all the same bits")
        lines = dump[dump.index(b"rbd-recording"):].decode().splitlines(keepends=True)
        expect("a current", replay(program, altered(lines, 77, 4, 3, 0)), DIFFERS, "joint 4: current recorded",
               "1 of 500 ticks differ")
        expect("of another controller", replay(program, DUMP.read_bytes()), UNUSABLE, "another configuration")


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    program, what = sys.argv[1:3]
    if what in ("--emulated", "--record"):
        record(program, sys.argv[3] if what == "--emulated" else "cortex-m7", what == "--record")
        if what == "--emulated" and os.environ.get("RBD_ALL_TESTS"):
            record_servos(sys.argv[3])
        elif what == "--emulated":
            print("SKIPPED but by ./run test --all: an arm of servos")
    else:
        check_recorder(what)
        check_dumps(program)
        check_others(program)
    return failures != 0


sys.exit(main())
