#!/usr/bin/env python3
"""Makes a wheel with compiled libraries: its users need numpy alone, no compiler.

usage: make_wheel.py [--quick] PLATFORM FOLDER

PLATFORM  linux-x86-64, linux-aarch64 or windows-x86-64; compilers of Debian's names. On x86-64 there are libraries for three
          generations of processors, of which the fastest that runs is taken. The loaders of URDF and MJCF files come with
          urdfdom and MuJoCo for the platform that this machine is.
--quick   hardly optimised, for the oldest processors, in double alone: for tests
SPDX-License-Identifier: MIT"""
import argparse
import platform
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "python"))
from rbd import _compiled, _library, _mjcf, _tables, _urdf  # noqa: E402

X86_64 = ["-march=x86-64", "-march=x86-64-v3", "-march=x86-64-v4"]
PLATFORMS = {  # prefix of the tools, flags of each level, ending, and the wheel's tag
    "linux-x86-64": ("x86_64-linux-gnu-", X86_64, ".so", "manylinux_{}_x86_64"),
    "linux-aarch64": ("aarch64-linux-gnu-", ["-march=armv8-a"], ".so", "manylinux_{}_aarch64"),
    "windows-x86-64": ("x86_64-w64-mingw32-", X86_64, ".dll", "win_amd64"),
}
# What loaders stand on beside the system's libraries: those that stand on others first.
BEHIND = {
    "urdf": ["liburdfdom_sensor", "liburdfdom_model_state", "liburdfdom_model", "liburdfdom_world", "libconsole_bridge", "libtinyxml"],
    "mjcf": ["libmujoco", "libccd", "liblodepng", "libqhull_r", "libtinyxml2"],
}


def run(*command):
    return subprocess.run([str(word) for word in command], check=True, stdout=subprocess.PIPE, text=True).stdout


class Compiler:
    """Of a platform, into a folder."""

    def __init__(self, name, folder):
        self.prefix, self.levels, self.ending, self.tag = PLATFORMS[name]
        self.folder = folder
        self.static = ["-static-libgcc"] if self.ending == ".dll" else []

    def library(self, name, units, flags, language="c", libraries=("-lm",)):
        """Compiles units, texts of C or C++, into the library of this name."""
        compiler = self.prefix + {"c": "gcc", "c++": "g++"}[language]
        with tempfile.TemporaryDirectory() as scratch:
            sources = [Path(scratch, f"{k}.{language}") for k in range(len(units))]
            for source, unit in zip(sources, units):
                source.write_text(unit)
            run(compiler, *flags, "-Wno-psabi", "-fPIC", "-shared", "-s", "-I", ROOT, *sources, *self.static, *libraries, "-o",
                self.folder / (name + self.ending))

    def oldest_system(self):
        """The wheel's tag; on Linux with the version of glibc that the libraries need."""
        needed = [(2, 17)]
        for path in self.folder.glob("*.so*"):
            needed += [(int(a), int(b)) for a, b in re.findall(r"GLIBC_(\d+)\.(\d+)", run(self.prefix + "objdump", "-T", path))]
        return self.tag.format("{}_{}".format(*max(needed)))


def libraries_behind(loader):
    """Libraries that the loader stands on, those that stand on none first, as the system's loader finds them."""
    found = dict(re.findall(r"(lib\S+) => (\S+)", run("ldd", loader)))
    return [Path(found[name]) for start in reversed(BEHIND[loader.stem]) for name in found if name.startswith(start + ".so")]


def bring_loader(compiler, name, unit, words):
    """The loader of a kind of files with the libraries behind it and their licences. words: of compiler and linker."""
    libraries = [word for word in words if word.startswith(("-l", "-L"))]
    flags = ["-O1", "-std=c++17", *(word for word in words if word not in libraries)]
    compiler.library(name, [unit], flags, "c++", libraries)

    behind = libraries_behind(compiler.folder / f"{name}.so")
    for path in behind:
        shutil.copy(path, compiler.folder / path.name)
        package = run("dpkg", "-S", path.resolve().name).splitlines()[0].split(":")[0]
        shutil.copy(f"/usr/share/doc/{package}/copyright", compiler.folder / f"LICENSE.{package}")
    (compiler.folder / f"{name}.txt").write_text("\n".join(path.name for path in behind) + "\n")


def compile_all(compiler, quick, loaders):
    fast = ["-O1", "-Dalways_inline=unused"] if quick else ["-O3"]
    levels = compiler.levels[:1] if quick else compiler.levels
    compiler.library("machine", [_compiled._MACHINE], ["-O1"])
    for real in ["double"] if quick else ["double", "float"]:
        for level, march in enumerate(levels):
            flags = [*fast, march, "-ffp-contract=fast", f"-DRBD_REAL={real}"]
            compiler.library(f"{real}-{level}", _library._library_units(real), flags)
    compiler.library("print", _tables._print_units(), _tables._print_flags())
    if loaders:
        bring_loader(compiler, "urdf", _urdf._URDF, run("pkg-config", "--cflags", "--libs", "urdfdom").split())
        bring_loader(compiler, "mjcf", _mjcf._MJCF, ["-lmujoco"])
    (compiler.folder / "headers.sha256").write_text(_compiled._stamp())


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("platform", choices=PLATFORMS)
    parser.add_argument("folder", type=Path)
    options = parser.parse_args()

    here = f"{platform.system()}-{platform.machine()}".lower().replace("_", "-")
    with tempfile.TemporaryDirectory() as scratch:
        run(sys.executable, "-m", "pip", "wheel", "-q", "--no-deps", "--no-build-isolation", "-w", scratch, ROOT / "python")
        run(sys.executable, "-m", "wheel", "unpack", next(Path(scratch).glob("*.whl")), "-d", scratch)
        package = next(path for path in Path(scratch).iterdir() if path.is_dir())
        compiler = Compiler(options.platform, package / "rbd/compiled")
        compiler.folder.mkdir()
        compile_all(compiler, options.quick, here == options.platform)

        said = next(package.glob("*.dist-info")) / "WHEEL"
        text = said.read_text().replace("Root-Is-Purelib: true", "Root-Is-Purelib: false")
        tag = f"py3-none-{compiler.oldest_system()}"
        said.write_text(text.replace("py3-none-any", tag))
        options.folder.mkdir(parents=True, exist_ok=True)
        run(sys.executable, "-m", "wheel", "pack", package, "-d", options.folder)
    print(options.folder / f"{package.name}-{tag}.whl")


if __name__ == "__main__":
    main()
