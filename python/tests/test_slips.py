# SPDX-License-Identifier: MIT
"""A misspelt attribute is refused with the name that was meant; it changed nothing, and nobody was told."""
import copy
import dataclasses
import importlib
import pickle
from pathlib import Path

import numpy as np
import pytest

import rbd

PACKAGE = Path(rbd.__file__).parent
MODULES = [importlib.import_module(f"rbd.{path.stem}") for path in sorted(PACKAGE.glob("_[!_]*.py"))]
CLASSES = {thing for module in MODULES for thing in vars(module).values()
           if isinstance(thing, type) and thing.__module__.partition(".")[0] == "rbd"}
RECORDS = sorted((kind for kind in CLASSES if dataclasses.is_dataclass(kind)), key=lambda kind: kind.__name__)


def example(kind):
    """One of this class, with zeros for what must be given."""
    needed = [f.name for f in dataclasses.fields(kind) if f.default is f.default_factory is dataclasses.MISSING]
    return kind(**dict.fromkeys(needed, 0))


def test_these_are_all():
    """Every dataclass of the package is among them, also those of modules that others wrote."""
    written = sum(path.read_text().count("\n@dataclass") for path in PACKAGE.glob("*.py"))
    assert len(RECORDS) == written > 12
    assert {kind.__name__ for kind in RECORDS} >= {"Body", "Motor", "Task", "ContactOptions", "IkTarget", "Mjcf", "Log"}


@pytest.mark.parametrize("kind", RECORDS, ids=lambda kind: kind.__name__)
def test_dataclasses(kind):
    """Each field can be set, and no misspelt one; copies and pickles are as before."""
    made = example(kind)
    for field in dataclasses.fields(kind):
        setattr(made, field.name, getattr(made, field.name))
        for wrong in (field.name + "z", field.name[::-1] + "q"):
            with pytest.raises(AttributeError, match=f"^{kind.__name__}: '{wrong}' is no attribute"):
                setattr(made, wrong, 1)
            assert not hasattr(made, wrong)
    assert copy.deepcopy(made) == made == dataclasses.replace(made)
    if getattr(rbd, kind.__name__, None) is kind:
        assert pickle.loads(pickle.dumps(made)) == made


def test_the_message_names_the_nearest():
    motor, options = rbd.Motor(), rbd.ContactOptions()
    with pytest.raises(AttributeError, match="Motor: 'curent' is no attribute; did you mean 'current'?"):
        motor.curent = 3
    with pytest.raises(AttributeError, match="ContactOptions: 'rws' is no attribute; did you mean 'rows'?"):
        options.rws = 3
    with pytest.raises(AttributeError, match="Contact: .on_body. cannot be set"):
        rbd.Contact().on_body = True
    with pytest.raises(AttributeError, match="IkTarget: 'xyz' is no attribute; there are: kind, body, point, position"):
        rbd.IkTarget("point").xyz = (0, 0, 1)
    kept = rbd.Urdf("name", [], [], [], (0, 0, 0), 0.0)
    kept.kinematic = True  # an attribute of the class, which is no field


def test_objects(double, iiwa):
    """The same of what computes: each of its attributes is declared."""
    posture = rbd.Task("posture", q=np.zeros(7), gain=10)
    control = rbd.Tasks(iiwa, [posture], dt=1e-3)
    made = [double, double.spatial, iiwa, control, iiwa.contacts([rbd.Contact("tip", 6)]),
            iiwa.constraint_set([iiwa.point_contact(6)]), rbd.Observer(iiwa, 10), rbd.Estimator(iiwa, 6),
            iiwa.actuators([rbd.Motor(joint=iiwa.joint_names[0], gear=50, constant=1)])]
    for thing in made:
        with pytest.raises(AttributeError, match=f"^{type(thing).__name__}: 'xyzzy' is no attribute"):
            thing.xyzzy = 1
    control.dt, control.steps, control.speed = 2e-3, 50, np.ones(7)
    with pytest.raises(AttributeError, match="'motion_costs' is no attribute; did you mean 'motion_cost'"):
        control.motion_costs = 1
    with pytest.raises(AttributeError, match="'acceleration' cannot be set"):
        control.acceleration = np.ones(7)
    with pytest.raises(AttributeError, match="'gravity' is no attribute; did you mean '[gs]et_gravity'"):
        iiwa.gravity = (0, 0, -1.62)
    copies = copy.copy, copy.deepcopy, lambda thing: pickle.loads(pickle.dumps(thing))
    for thing in made:  # each is copied with memory of its own, or refuses with its name
        for again in copies:
            try:
                other = again(thing)
            except TypeError as error:
                assert isinstance(thing, rbd.Estimator) and "Estimator: it cannot be copied or pickled" in str(error)
                continue
            assert type(other) is type(thing) and other is not thing and not isinstance(thing, rbd.Estimator)
            for name in ("_memory", "_address", "_memories"):
                assert not hasattr(thing, name) or getattr(other, name) is not getattr(thing, name)


def test_classes_of_a_user():
    """A class that inherits may have attributes of its own."""
    class Leg(rbd.Contact):
        pass

    leg = Leg("left")
    leg.hip = 3
    assert leg.hip == 3 and leg.friction == 0
