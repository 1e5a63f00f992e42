# SPDX-License-Identifier: MIT
import sys
from pathlib import Path

import pytest

sys.path[:0] = [str(Path(__file__).resolve().parents[1]), str(Path(__file__).resolve().parent)]
import rbd  # noqa: E402

# Compiled in a second: what is tested here is rbd.py; what the optimiser makes of the headers, elsewhere.
FLAGS = "-O0 -march=native -ffp-contract=off"


@pytest.fixture(scope="session", params=["double", "float"])
def library(request):
    lanes = {"double": None, "float": 4}[request.param]  # as the machine has, and as told
    return rbd.Library(request.param, flags=FLAGS, lanes=lanes)


@pytest.fixture(scope="session")
def double():
    return rbd.Library("double", flags=FLAGS)


@pytest.fixture(scope="session", autouse=True)
def quick():
    """These flags for libraries that take the default, also of programs and of fixtures of any scope: -O3 takes half a
    minute of a processor."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("RBD_FLAGS", FLAGS)
        yield


@pytest.fixture
def iiwa(double):
    return rbd.Model(rbd.load_table(rbd.SOURCES / "models/iiwa.h"), library=double)


@pytest.fixture
def hyq(double):
    return rbd.Model(rbd.load_table(rbd.SOURCES / "models/hyq.h"), library=double)
