#!/usr/bin/env python3
"""Writes a version to all places that state it: version.py X.Y.Z

The first of them is src/api/configuration.h, which becomes rbd.h: CMake and Python read it there, Meson refuses another
one, and the test 'package manifests' compares the manifests. CHANGELOG.md is yours. SPDX-License-Identifier: MIT"""
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
HEADERS = (ROOT / "src/headers.txt").read_text().split()


def places(version, number):
    """File, what stands there, and what shall."""
    yield "src/api/configuration.h", r'(#define RBD_VERSION )"[^"]*"', rf'\1"{version}"'
    yield "src/api/configuration.h", r"(#define RBD_VERSION_NUMBER )\d+", rf"\g<1>{number}"
    yield "src/rbd_qp.h", r"(in one C99 header\. Version )[\d.]*\d\.", rf"\g<1>{version}."
    yield "src/rbd.h", r"(in one C99 header\. Version )[\d.]*\d\.", rf"\g<1>{version}."
    for header in HEADERS:
        if "RBD_VERSION_NUMBER" in (ROOT / "src" / header).read_text():
            yield f"src/{header}", r"(RBD_VERSION_NUMBER < )\d+", rf"\g<1>{number}"
    yield "docs/install.md", r"(find_package\(rbd )\d+\.\d+", rf"\g<1>{version.rpartition('.')[0]}"
    yield "meson.build", r"(\n  version: )'[^']*'", rf"\1'{version}'"
    yield "library.json", r'("version": )"[^"]*"', rf'\1"{version}"'
    yield "library.properties", r"(\nversion=)\S+", rf"\g<1>{version}"
    yield "idf_component.yml", r'(^version: )"[^"]*"', rf'\1"{version}"'


def main():
    if len(sys.argv) != 2 or not re.fullmatch(r"\d+\.\d+\.\d+", sys.argv[1]):
        sys.exit(__doc__)
    version = sys.argv[1]
    major, minor, patch = map(int, version.split("."))
    for name, pattern, text in places(version, 10000 * major + 100 * minor + patch):
        path = ROOT / name
        changed, count = re.subn(pattern, text, path.read_text(encoding="utf-8"))
        if count != 1:
            sys.exit(f"{name}: the version stands {count} times, not once")
        path.write_text(changed, encoding="utf-8")
    subprocess.run([sys.executable, ROOT / "src/amalgamate.py", "--write"], check=True)


if __name__ == "__main__":
    main()
