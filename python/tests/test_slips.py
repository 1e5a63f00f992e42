# SPDX-License-Identifier: MIT
"""A misspelt attribute is refused with the name that was meant; it changed nothing, and nobody was told."""
import copy
import dataclasses
import functools
import importlib
import pickle
import re
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


# Slips of the keyboard, by what an argument must be.
LISTS = None, 5, float("nan"), "knee", b"knee", {"knee": 1}, np.array(5), object(), [5], ["knee"], [None], [[1], [1, 2]]
ARRAYS = ("ab", {"a": 1}, object(), [[1], [1, 2]], [10**400] * 2, np.array([1j, 2j]), np.array(["a", "b"]), [None, None],
          [np.nan, 0], [1.0] * 9, np.zeros((2, 3, 4)))
NUMBERS = None, "1", [1, 2], [[1], [1, 2]], np.nan, np.inf, 10**400, np.array(10**400), 1j, {"a": 1}, object()
COUNTS = None, "1", 1.5, np.nan, [1, 2], object()
NAMES = 5, np.nan, b"knee", {"knee": 1}, np.array(5), object()
OBJECTS = 5, "m", [1, 2], {"a": 1}, np.zeros(2), object()
TEXTS = 3, 1.5, [], ["knee"], np.array(["knee", "hip"]), b"knee", object()


def pendulum(library):
    """Two links in a row."""
    link = {"type": "revolute", "axis": (0, 1, 0), "mass": 1, "com": (0, 0, -0.2), "inertia": (0.1, 0, 0, 0.1, 0, 0.1)}
    return rbd.Model([rbd.Body("thigh", "hip", **link), rbd.Body("shank", "knee", "thigh", position=(0, 0, -0.4), **link)],
                     library=library)


def numbers(names):
    """Slips of arguments that are numbers."""
    return dict.fromkeys(names.split(), NUMBERS)


def arrays(names):
    """Slips of arrays that may be None."""
    return dict.fromkeys(names.split(), ARRAYS)


def need(names):
    """Slips of arrays that must be given."""
    return dict.fromkeys(names.split(), (None, *ARRAYS))


# Calls whose arguments are right, and slips of each: (name in messages, call, right arguments, slips).

def of_actuators(model):
    two, motor, twice = [0.1, 0.2], rbd.Motor("M", "knee", 50, 1), [rbd.Motor(gear=1, constant=1)] * 2
    hip_and_knee = {"joint": ["hip", "knee"], "matrix": np.eye(2)}
    rod = {"zero": (-1, 0, 0), "axis": (0, 1, 0), "place": (0, 0.05, -0.1), "crank": 0.03, "length": 0.285, "point": (-0.05, 0.05, 0)}
    arm, state = model.actuators([motor]), {"q": two, "v": two}
    return [
        ("actuators", model.actuators, {"motors": [motor]}, {"motors": LISTS, "transmissions": LISTS}),
        ("actuators", rbd.Actuators, {"model": model, "motors": [motor]}, {"model": (None, *OBJECTS)}),
        ("actuators", lambda **k: model.actuators([replaced(motor, k)]), {},
         {**numbers("gear current inertia stiffness"), "delay": COUNTS, "sampled": COUNTS, "name": TEXTS, "joint": TEXTS,
          "friction": OBJECTS}),
        ("actuators", lambda **k: model.actuators([replaced(motor, {"friction": rbd.Friction(**k)})]), {}, numbers("coulomb speed")),
        ("actuators", lambda **k: model.actuators(twice, [rbd.Transmission(**k)]), hip_and_knee,
         {"motor": COUNTS, "joint": NAMES, "matrix": (None, *ARRAYS), "name": TEXTS, "rod": LISTS[1:]}),
        ("actuators", lambda **k: model.actuators(twice[:1], [rbd.Transmission(0, "knee", rod=[rbd.Rod(**k)])]), rod,
         {**need("place axis zero point"), **numbers("crank length"), "elbow": COUNTS}),
        ("map", arm.map, state, {"q": (None, *ARRAYS), "v": ARRAYS}),
        ("inverse", arm.inverse, {**state, "a": two, "tau": two}, need("q v a tau")),
        ("reset", arm.reset, {"q": two}, {**need("q"), "air": (*NUMBERS, -300, 1e30)}),
        ("step", arm.step, {**state, "dt": 1e-3},
         {**need("q v"), "dt": (*NUMBERS, 0, -1, 1e30), **arrays("tau f_ext"), "contacts": (*OBJECTS, model),
          **dict.fromkeys("torque position speed kp kd voltage".split(), (*NUMBERS[:4], *ARRAYS, 1e30))}),
        ("friction", arm.friction, {"motor": 0, "speed": 0, "torque": 0, "joint": 0},
         {"motor": COUNTS, **numbers("speed torque joint")}),
        ("rotor_torque", model.rotor_torque, {**state, "rotors": [], "a": two}, {**need("q v a"), **arrays("f_ext"), "rotors": LISTS}),
    ]


def of_control(model):
    two, library, wish = [0.1, 0.2], model.library, rbd.Task("posture", q=[0.1, 0.2], gain=1)
    tasks, state = rbd.Tasks(model, [wish]), {"q": two, "v": two}
    return [
        ("ik", model.ik, {"targets": rbd.IkTarget("point", 1)},
         {"targets": LISTS, **arrays("q held"), "starts": COUNTS, "evaluations": COUNTS, **numbers("metres radians length")}),
        ("ik", lambda **k: model.ik(rbd.IkTarget(**k)), {"kind": "point"},
         {"kind": (None, "", "pint", [1, 2], {"a": 1}), "body": COUNTS[:1] + COUNTS[2:], **numbers("weight"),
          **need("point position axis direction"), "rotation": ARRAYS[:-2]}),
        ("qp", functools.partial(rbd.qp, library=library), {"H": np.eye(2), "f": two, "lower": two, "upper": [1, 1]},
         {"H": (None, *ARRAYS), "f": (None, *ARRAYS[:-2]), "C": ARRAYS, "lower": ARRAYS[:-1], "upper": ARRAYS[:-1], "soft": ARRAYS,
          "warm": OBJECTS, "steps": COUNTS, "rounds": COUNTS, **numbers("accuracy")}),
        ("qp", rbd.qp, {"H": np.eye(2), "f": two, "library": library}, {"library": OBJECTS}),
        ("Tasks", lambda **k: rbd.Tasks(**k).velocity(two), {"model": model},
         {"model": (None, *OBJECTS), "tasks": LISTS, "contacts": LISTS, "without": LISTS, "steps": COUNTS,
          **arrays("lower upper speed torque acceleration passive"), **numbers("dt braking limit_weight force_cost")}),
        ("Tasks", lambda **k: replaced(rbd.Tasks(model), k).acceleration(two, two), {},
         {"tasks": LISTS, "contacts": LISTS, "without": LISTS, **numbers("dt")}),
        ("Tasks", tasks.velocity, state, {"q": (None, *ARRAYS), "v": ARRAYS}),
        ("Tasks", tasks.acceleration, state, {**need("q v"), **arrays("f_ext")}),
        ("Tasks", lambda **k: rbd.Tasks(model, [replaced(wish, k)]).velocity(two), {},
         {"kind": (None, "", "pint", *OBJECTS), "level": COUNTS, **numbers("weight gain"), **arrays("q v a weights"),
          **need("point position velocity loose"), "rotation": ARRAYS[:-2]}),
        ("Tasks", lambda **k: rbd.Tasks(model, [rbd.Task("rows", **k)]).velocity(two), {"jacobian": np.eye(2), "y": two},
         {"jacobian": (None, *ARRAYS), "y": ARRAYS}),
        ("Tasks", lambda **k: rbd.Tasks(model, [rbd.Task("relative", **k)]).velocity(two), {"body": 1},
         {"body": COUNTS[2:], "reference": (None, *COUNTS[2:])}),
        ("Tasks", lambda **k: rbd.Tasks(model, [], [rbd.TaskContact(1, **k)]).velocity(two), {"friction": 1},
         {**need("point normal"), **numbers("friction least"), "open": (None, "x", 5), "sides": COUNTS}),
    ]


def of_contacts(model):
    two, knee, library = [0.1, 0.2], rbd.Contact("tip", 1), model.library
    foot, state = model.contacts([knee]), {"q": two, "v": two}
    row = model.contacts([knee], options=rbd.ContactOptions(rows=1)).row_set
    return [
        ("contacts", model.contacts, {"rows": [knee]}, {"rows": LISTS[:-4], "held": LISTS[:-4], "options": OBJECTS}),
        ("contacts", lambda **k: model.contacts([replaced(knee, k)]), {},
         {"name": TEXTS, "body2": COUNTS[2:], **need("point normal"), **numbers("friction height")}),
        ("contacts", lambda **k: model.contacts([], options=rbd.ContactOptions(**k)), {}, {**numbers("margin slip"), "rows": COUNTS}),
        ("constraint_set", model.constraint_set, {"rows": []}, {"rows": LISTS[:-4]}),
        ("constraint_set", rbd.ConstraintSet, {"model": model, "rows": []}, {"model": (None, *OBJECTS)}),
        ("contacts", rbd.ContactSet, {"model": model, "rows": []}, {"model": (None, *OBJECTS)}),
        ("step", foot.step, {**state, "tau": two, "dt": 1e-3}, {**need("q v tau"), "dt": NUMBERS[:2] + NUMBERS[3:]}),
        ("row_set", row, {"row": 0, "dofs": [0], "jacobian": [1]},
         {"dofs": (None, 5, np.array(5), "1", [None], [[1], [1, 2]]), **need("jacobian"), **numbers("lower bias compliance")}),
        ("contact_solve", library.contact_solve, {"delta": np.eye(4), "b": [0] * 4, "friction": [1], "lower": [0], "upper": [0]},
         {**need("delta b"), "lower": (None, *ARRAYS[:-2]), "upper": (None, *ARRAYS), **numbers("tolerance")}),
    ]


def of_estimates(model):
    two = [0.1, 0.2]
    state = {"q": two, "v": two}
    return [
        ("Observer", rbd.Observer, {"model": model, "gain": 9},
         {"model": (None, *OBJECTS), **arrays("friction"), **numbers("gain share least slow")}),
        ("observer_step", rbd.Observer(model, 9).step, {**state, "tau": two, "dt": 1e-3}, {**need("q v tau"), **numbers("dt")}),
        ("Estimator", rbd.Estimator, {"model": model},
         {"model": (None, *OBJECTS), "body": COUNTS[2:], **numbers("mass reach friction slow"), **arrays("noise left_out")}),
        ("estimate_add", rbd.Estimator(model).add, {**state, "a": two, "tau": two}, need("q v a tau")),
    ]


def replaced(thing, values):
    """A copy with other attributes."""
    thing = copy.copy(thing)
    for name, value in values.items():
        setattr(thing, name, value)
    return thing


@pytest.mark.parametrize("calls", [of_actuators, of_control, of_contacts, of_estimates])
def test_slips_are_named(double, calls):
    """Whatever is given in place of an argument: a sentence says which call refuses it, and which argument."""
    bad = []
    for call, use, right, kinds in calls(pendulum(double)):
        use(**right)
        for name, slips in kinds.items():
            for slip in slips:
                try:
                    use(**{**right, name: slip})
                    found = "nothing is said"
                except (TypeError, ValueError, rbd.RbdError) as error:
                    found = str(error)
                except Exception as error:
                    found = repr(error)
                if not re.match(rf"{call}: .*\b{name.rstrip('s')}", found):
                    bad.append(f"{call} {name}={slip!r:.40}: {found:.120}")
    assert not bad, "\n".join(bad)


def test_misspelt_keywords_are_named(double):
    model = pendulum(double)
    two, arm, foot = [0, 0], model.actuators([rbd.Motor(joint="knee", gear=1, constant=1)]), model.contacts([])
    for call, use in (("Actuators.step", lambda **k: arm.step(two, two, 1e-3, **k)), ("Model.ik", lambda **k: model.ik([], **k)),
                      ("qp", lambda **k: rbd.qp(np.eye(2), two, **k)), ("Tasks.__init__", lambda **k: rbd.Tasks(model, **k)),
                      ("Observer.__init__", lambda **k: rbd.Observer(model, 9, **k)), ("Motor.__init__", rbd.Motor),
                      ("ContactSet.step", lambda **k: foot.step(two, two, two, 1e-3, **k))):
        with pytest.raises(TypeError, match=rf"{call}\(\) got an unexpected keyword argument 'xyzzy'"):
            use(xyzzy=1)


def test_classes_of_a_user():
    """A class that inherits may have attributes of its own."""
    class Leg(rbd.Contact):
        pass

    leg = Leg("left")
    leg.hip = 3
    assert leg.hip == 3 and leg.friction == 0
