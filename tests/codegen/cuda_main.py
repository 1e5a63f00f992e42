#!/usr/bin/env python3
"""What the headers NAME_code.h say as C++: thunks of the functions in C and of their kernels, and a table of them for
cuda_check.h; or, with --instances LAYOUTS, kernels for a compiler of device code.
usage: cuda_main.py [--instances rows,blocks,columns] NAME_code.h..."""
import re
import sys
from pathlib import Path

DECLARATION = re.compile(r"^(int|void) (\w+)\(((?:int stance, )?)(const (?:float|double) [^\n]*)\);$", re.M)
ARGUMENT = re.compile(r"(const )?(float|double) \w+\[(\d+)\]")


def functions(header):
    """(robot, function, has a status, has a stance, scalar, sizes of inputs, sizes of results) of each declaration"""
    name = header.name.removesuffix("_code.h")
    for result, full, stance, arguments in DECLARATION.findall(header.read_text()):
        found = ARGUMENT.findall(arguments)
        sizes = [[size for const, _, size in found if bool(const) == is_input] for is_input in (True, False)]
        yield name, full.removeprefix(name + "_"), result == "int", bool(stance), found[0][1], *sizes


def instances(header, layouts):
    for robot, name, has_status, has_stance, scalar, inputs, results in functions(header):
        types = ["int"] + ["const int *"] * has_stance + [f"const {scalar} *"] * len(inputs) + \
            [f"{scalar} *"] * len(results) + ["int *"] * has_status
        for layout in layouts:
            yield f"template RBD_KERNEL {robot}::{name}_kernel<rbd::{layout}>({', '.join(types)});"


def thunks(header):
    rows = []
    for robot, name, has_status, has_stance, scalar, inputs, results in functions(header):
        arrays = ", ".join([f"x[{k}]" for k in range(len(inputs))] + [f"y[{k}]" for k in range(len(results))])
        status, stance = ["", ", status"][has_status], ["", "stance, "][has_stance]
        of_state = ["", "*stance, "][has_stance]
        full = f"{robot}_{name}"
        yield f"""static int c_{full}(const int *stance, const {scalar} *const *x, {scalar} *const *y) {{
    (void)stance;
    {"return " if has_status else ""}{full}({of_state}{arrays});{"" if has_status else " return 0;"}
}}
template <class L>
void kernel_{full}(int n, const int *stance, const {scalar} *const *x, {scalar} *const *y, int *status) {{
    (void)stance, (void)status;
    {robot}::{name}_kernel<L>(n, {stance}{arrays}{status});
}}"""
        kernels = ", ".join(f"kernel_{full}<rbd::{layout}>" for layout in ("rows", "blocks", "columns"))
        rows.append(f'    {{"{full}", {int(has_status)}, {len(inputs)}, {len(results)}, '
                    f"{{{', '.join(inputs + results)}}}, c_{full}, {{{kernels}}}}},")
    yield f"static const checked<{scalar}> {robot}_functions[] = {{"
    yield from rows
    yield "};"


arguments = sys.argv[1:]
layouts = arguments.pop(1).split(",") if arguments[0] == "--instances" else None
headers = [Path(path) for path in arguments[layouts is not None:]]
for header in headers:
    print(f'#include "{header.with_suffix(".cuh").name}"')
if layouts:
    for header in headers:
        print("\n".join(instances(header, layouts)))
else:
    print("".join(f'#include "{header.name}"\n' for header in headers) + '#include "cuda_check.h"')
    for header in headers:
        print("\n".join(thunks(header)))
    print("int main() {\n    int failures = 0;")
    for header in headers:
        print(f"    failures += check_all({header.name.removesuffix('_code.h')}_functions);")
    print("    return failures > 0;\n}")
