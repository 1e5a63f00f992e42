# SPDX-License-Identifier: MIT
"""The package rbd with its type stubs and the headers that it compiles, copied from the repository's root."""
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from setuptools import setup
from setuptools.command.build_py import build_py

ROOT = Path(__file__).resolve().parent.parent
SOURCES = ["LICENSE", "rbd*.h", "models/*.h", "models/*.urdf", "tools/print*.[ch]", "tools/robot.h"]


class BuildWithSources(build_py):
    def run(self):
        super().run()
        for path in (path for pattern in SOURCES for path in ROOT.glob(pattern)):
            target = Path(self.build_lib, "rbd/sources", path.relative_to(ROOT))
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(path, target)
        stubs = Path(self.build_lib, "rbd/__init__.pyi")
        subprocess.run([sys.executable, str(ROOT / "python/stubs.py"), str(stubs)], check=True)


if not (ROOT / "rbd.h").is_file():
    raise SystemExit(f"{ROOT} has no rbd.h: this is built within rbd's repository")
scratch = tempfile.TemporaryDirectory()  # nothing is left in the repository
setup(version=re.search(r'#define RBD_VERSION "(.*)"', (ROOT / "rbd.h").read_text())[1],
      cmdclass={"build_py": BuildWithSources},
      options={"build": {"build_base": scratch.name}, "egg_info": {"egg_base": scratch.name}})
