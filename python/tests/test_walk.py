# SPDX-License-Identifier: MIT
"""A walk over the public surface, made from its signatures: each argument of each call and each field of each dataclass
gets every slip that its kind allows. A new argument is walked without a line here if a right value of it is known by its
name; else `test_all_arguments` asks for one."""
import copy
import dataclasses
import functools
import inspect
import re
import warnings

import numpy as np
import pytest

import rbd
from rbd._arguments import _MASKS, _QUANTITIES, _SCALARS, _shape
from rbd._spatial import _KINDS, _SPATIAL

# ---- slips, by what an argument is ----

NAN, INF, HUGE = float("nan"), float("inf"), 10**400
THINGS = b"knee", {"knee": 1}, object(), 1j
SLIPS = {
    "flag": ("knee", 5, 2, -1, 0.5, NAN, [True], np.array([True]), *THINGS),
    "number": ("1", True, np.True_, [1.0], np.array([1.0]), [[1], [1, 2]], NAN, INF, -INF, HUGE, np.array(HUGE), *THINGS),
    "numbers": ("1", True, np.True_, [[1], [1, 2]], NAN, INF, -INF, HUGE, np.array(HUGE), *THINGS),
    "count": ("1", True, np.True_, 1.5, NAN, [1], np.array([1]), *THINGS),
    "array": ("knee", True, [[1], [1, 2]], [HUGE] * 2, [None, None], np.array(["a", "b"]), np.array([1j, 2j]),
              np.ma.masked_array([1.0], [True]), *THINGS),
    "text": (3, 1.5, NAN, True, [], ["knee"], np.array(["knee", "hip"]), *THINGS),
    "choice": (3, True, NAN, "", "wrld", ["world"], *THINGS),
    "place": ("xyzzy", 2.5, NAN, True, 99, -7, [1], *THINGS),
    "places": ("xyzzy", 2.5, NAN, True, 99, -7, [99], ["xyzzy"], [None], *THINGS),
    "list": (5, NAN, True, "knee", [None], [5], ["xyzzy"], np.array(5), *THINGS),
    "object": (5, True, "knee", [1], np.zeros(2), *THINGS),
}
KINDS = {  # of annotations; "?" stands where None is right
    "bool": "flag", "float": "number", "int": "count", "str": "text", "ArrayLike": "array", "Numbers": "array",
    "Numbers | Matrix": "array", "Numbers | float": "array", "Matrix | Array": "array", "Sequence[int]": "whole",
    "int | str": "place", "int | str | Iterable[int | str]": "places", "Sequence[str]": "list", "Sequence[Rod]": "list",
    "IkTarget | Iterable[IkTarget]": "list", "Literal['rows', 'blocks']": "choice", "Literal['world', 'link']": "choice",
    **{f"Iterable[{kind}]": "list" for kind in ("Body", "Motor", "Transmission", "Rotor", "Contact", "Constraint", "Task",
                                                "TaskContact", "str")},
    "Urdf | Iterable[Body]": "list", "str | Iterable[str]": "list", "str | Iterable[str] | Mapping[str, float]": "list",
    **{kind: "object" for kind in ("Model", "Library", "Body", "ContactSet", "ContactOptions", "Friction", "QpSolution")},
}


def array_slips(right):
    """Slips that show beside a right array: wrong lengths, turned axes, and numbers that are none."""
    right = np.array(right, float)
    yield from (np.append(right, 0.0), np.append(right, right), right.reshape(-1)[:-1])
    if right.ndim > 1 and right.shape != right.T.shape:
        yield right.T
    for odd in (NAN, INF, -INF):
        wrong = right.copy()
        wrong.flat[-1] = odd
        yield wrong


# ---- a robot, what is made of it, and right arguments ----

LINK = {"mass": 1.0, "com": (0, 0, -0.2), "inertia": (0.1, 0, 0, 0.1, 0, 0.1)}
LEG = {"type": "revolute", "axis": (0, 1, 0), "lower": -2.0, "upper": 2.0, "friction": 0.1, **LINK}
ROD = {"zero": (-1, 0, 0), "axis": (0, 1, 0), "place": (0, 0.05, -0.1), "crank": 0.03, "length": 0.285, "point": (-0.05, 0.05, 0)}
STATE = 0.01 * np.arange(1, 9)


def robot(library, **foot):
    """A floating base and a leg: nb, nq and nv differ."""
    return rbd.Model([rbd.Body("base", "root", type="floating", **LINK), rbd.Body("thigh", "hip", "base", **LEG),
                      rbd.Body("shank", "knee", "thigh", **{**LEG, "position": (0, 0, -0.4), **foot})], library=library)


def world(library):
    """Objects of all classes."""
    model = robot(library)
    options = rbd.ContactOptions(derivatives=True, rows=1, joint_friction=True)
    made = {"Model": model, "Library": library, "Spatial": library.spatial,
            "ConstraintSet": model.constraint_set([model.point_contact(2)]),
            "ContactSet": model.contacts([rbd.Contact("tip", 2)], options=options),
            "Actuators": model.actuators([rbd.Motor("M", "knee", 50.0, 1.0)]), "Observer": rbd.Observer(model, 9.0),
            "Estimator": rbd.Estimator(model, 2), "Tasks": rbd.Tasks(model, [rbd.Task("posture", q=configuration(), gain=1.0)])}
    return made


def configuration():
    return np.array([0, 0, 0, 0, 0, 0, 1, 0.3, -0.5])


PLAIN = {  # right values by the argument's name
    "q": configuration(), "q0": configuration(), "q1": configuration(), "rates": 0 * configuration(), "body": 2,
    "reference": 0, "axes": "world", "row": 0, "contact": 0, "constraint": 0, "motor": 0, "seed": 1, "joint": "knee",
    "status": 0, "i": 1, "j": 0, "dof": 7, "dt": 1e-3, "height": 0.1, "bound": 1.0, "normal": (0, 0, 1), "mass": 1.0,
    "com": (0, 0.1, 0), "body1": 1, "body2": 2, "inertia": (1, 0, 0, 1, 0, 1), "gravity": (0, 0, -9), "joints": ["knee"],
    "point1": (0, 0, 0.1), "point2": (0, 0, 0.1), "axis1": (0, 1, 0), "axis2": (0, 1, 0), "place": (0.1, 0.2, 0.3),
    "layout": "rows", "gain": 9.0, "pi": (1, 0, 0, 0, 1, 0, 0, 1, 0, 1), "qpos": np.zeros(9), "qvel": np.zeros(8),
    "damping": np.ones(8), "given": np.zeros(8, int), "weight": np.ones(8), "n": 2, "M": np.eye(8),
    "motors": [rbd.Motor("M", "knee", 50.0, 1.0)], "rows": [], "targets": rbd.IkTarget("point", 2), "rotors": [],
    "bodies": [rbd.Body("thigh", "hip", **LEG)], "speed": 0.1, "torque": 0.2, "added": np.eye(8)[np.tril_indices(8)],
    "actuated": np.ones(8, int), "lock": {"knee": 0.1}, "keep": ["base"], "held": np.zeros(8), "times": None, "file": None}
RIGHT = {  # and where another call has another
    "body_index.name": "shank", "joint_index.name": "knee", "c_model.name": "leg", "c_table.name": "leg",
    "friction.joint": 0.3, "ConstraintSet.constrained_id.weight": np.ones(3), "row_set.dofs": [7], "row_set.jacobian": [1.0],
    "qp.H": np.eye(2), "qp.f": np.zeros(2), "qp.C": np.ones((1, 2)), "qp.lower": -np.ones(3), "qp.upper": np.ones(3),
    "qp.soft": np.zeros(3), "contact_solve.delta": np.eye(4), "contact_solve.b": np.zeros(4), "contact_solve.friction": [1.0],
    "contact_solve.lower": [0.0], "contact_solve.upper": [1.0], "contact_solve.start": np.zeros(4),
    "set_parameters.body": rbd.Body("b"), "Observer.friction": np.zeros((8, 3)), "Estimator.noise": np.ones(8),
    "Estimator.left_out": np.zeros(8), "Estimator.friction": 100.0, "Observer.step.tau": STATE,
    "cholesky_factor_packed.H": np.eye(8)[np.tril_indices(8)], "cholesky_solve_many.L": np.eye(8)[np.tril_indices(8)],
    "Tasks.tasks": [rbd.Task("posture", q=configuration(), gain=1.0)], "cholesky_solve_many.B": np.ones((8, 2)),
    "Tasks.lower": -np.ones(8), "Tasks.upper": np.ones(8), "Tasks.speed": np.ones(8), "Tasks.torque": 1e3 * np.ones(8),
    "Tasks.acceleration": np.ones(8), "Tasks.passive": np.zeros(8), "Tasks.contacts": (), "contacts.held": (),
    "ContactSet.held": (), "Actuators.step.contacts": None, "Actuators.step.torque": [0.1], "Actuators.step.speed": [0.1],
    "Actuators.step.position": [0.1], "Actuators.step.kp": [0.1], "Actuators.step.kd": [0.1], "Actuators.step.voltage": [0.0],
    "parse_urdf.gravity": (0, 0, -9)}
SPATIAL = {"number": 0.5, "rotation": np.eye(3), "placement": (np.eye(3), np.zeros(3)), "inertia": np.ones(10), "quaternion":
           np.array([0, 0, 0, 1.0]), "array6": np.array([1, 0, 0, 1, 0, 1.0])}


def right_value(name, parameter, objects):
    """A right value of a parameter, None if it may be left out and none is known."""
    call, last = name.rsplit(".", 1)[-1], parameter.name
    for known, key in ((RIGHT, f"{name}.{last}"), (RIGHT, f"{call}.{last}"), (objects, last.capitalize()), (PLAIN, last)):
        if key in known:
            return known[key]
    if last in _QUANTITIES and not name.startswith("Spatial"):
        shape = _shape(_QUANTITIES[last][0], {**objects["Model"]._dims, "rows": 3})
        return 0.01 * np.ones(shape) if shape else 0.5
    if parameter.default is not inspect.Parameter.empty:
        return parameter.default
    raise KeyError(f"{name}: no right value of '{last}' is known: add it to RIGHT")


class Walk:
    """A call with right arguments, and the kinds of its arguments."""

    def __init__(self, name, use, function, objects):
        self.name, self.use, self.right, self.kinds = name, use, {}, {}
        call = getattr(function, "_rbd_call", None)
        spatial = dict(_SPATIAL[name[8:]][0]) if name.startswith("Spatial.") else {}
        for parameter in inspect.signature(function).parameters.values():
            key, annotation = parameter.name, str(parameter.annotation)
            if key == "self":
                continue
            optional = parameter.default is None or annotation.endswith("| None")
            if spatial:
                self.kinds[key] = "numbers" if spatial[key] == "number" else "pair" if spatial[key] == "placement" else "array"
                self.right[key] = SPATIAL.get(spatial[key], 0.1 * np.ones(_KINDS[spatial[key]][1]))
                continue
            if call:
                optional = key in call.optional
                kind = ("flag" if parameter.kind is parameter.KEYWORD_ONLY else "choice" if key == "axes" else
                        "place" if key in ("body", "reference") else "numbers" if key in _SCALARS else "array")
            else:
                kind = KINDS[annotation.replace(" | None", "")]
            self.right[key] = True if kind == "flag" and call else right_value(name, parameter, objects)
            kind = "mask" if kind == "array" and key in FLAGS and self.right[key] is not None else kind
            self.kinds[key] = kind + "?" * optional

    def slips(self, key):
        """All slips of an argument."""
        kind = self.kinds[key].rstrip("?")
        yield from SLIPS.get("array" if kind in ("mask", "whole") else kind, (5, "knee", [1, 2, 3], object()))
        if not self.kinds[key].endswith("?"):
            yield None
        if kind in ("array", "mask", "whole") and self.right[key] is not None:
            for slip in array_slips(self.right[key]):
                length = slip.shape != np.shape(self.right[key])
                if not (f"{self.name}.{key}" in SIZES and length or f"{self.name}.{key}" in SIDES and np.isinf(slip).any()):
                    yield slip
            yield from [2 * np.ones_like(self.right[key])] * (kind == "mask")

    def run(self, **changed):
        return self.use(**{**self.right, **changed})


FLAGS = "given", "actuated", "passive", "held", "left_out"     # arrays of 0 and 1, or of False and True
# These say how long others are, and infinite sides are none.
SIZES = "Library.contact_solve.friction", "Library.contact_solve.lower", "ContactSet.row_set.dofs", "qp.f"
SIDES = "qp.lower", "qp.upper"
LEFT_OUT = {"Library.call", "Library.function", "Library.finding_text"}  # doors to C
FILES = {"load_table", "load_urdf", "load_mjcf", "parse_mjcf", "Model.show"}  # test_calls.py, test_mjcf.py, ...


def walks(library):
    """All calls: methods of the objects, classes that are made with arguments, and functions."""
    objects = world(library)
    model = objects["Model"]
    for kind, thing in objects.items():
        for name, function in inspect.getmembers(type(thing), inspect.isfunction):
            if not name.startswith("_") and f"{kind}.{name}" not in LEFT_OUT | FILES:
                def use(*, call=name, thing=thing, **arguments):
                    if thing is model:
                        model.kinematics(configuration(), STATE, STATE)
                    return getattr(thing, call)(**arguments)
                yield Walk(f"{kind}.{name}", use, function, objects)
        if kind not in ("Library", "Spatial"):
            yield Walk(kind, functools.partial(made, type(thing)), type(thing).__init__, objects)
    yield Walk("qp", rbd.qp, rbd.qp, objects)


def made(kind, **arguments):
    """An object; Tasks look at their arguments when they are used."""
    thing = kind(**arguments)
    return thing.acceleration(configuration(), STATE) if kind is rbd.Tasks else thing


def message(use):
    """What is said: "" if nothing."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", rbd.RbdWarning)
            use()
    except (TypeError, ValueError, LookupError, rbd.RbdError) as error:
        return str(error)
    except Exception as error:
        return f"raises {error!r}"
    return ""


def is_named(text, key):
    """Whether a message has an argument's name, the singular of it, or the word for it."""
    words = {"rows": "contact|constraint", "bodies": "body", "body": "link", "joint": "link", "joints": "link"}.get(key, "(?!)")
    return re.search(rf"\b({re.escape(key.rstrip('s_'))}|{words})", text) and not text.startswith("raises ")


def test_all_arguments(double):
    found = {walk.name: walk for walk in walks(double)}
    assert len(found) > 150 and sum(len(walk.right) for walk in found.values()) > 400
    for walk in found.values():
        walk.run()


def test_slips_of_arguments(double):
    """Each slip is refused by a sentence with the argument's name."""
    bad = []
    for walk in walks(double):
        for key in walk.right:
            for slip in walk.slips(key):
                text = message(lambda: walk.run(**{key: slip}))
                if not is_named(text, key):
                    bad.append(f"{walk.name}, {key} = {slip!r:.50}: {text[:100] or 'nothing is said'}")
    assert not bad, f"{len(bad)} slips\n" + "\n".join(bad)


# What may be negative, and indices of which -1 is none.
SIGNED = set("""Model.add_payload.mass Model.body_name.body Model.joint_name.body Model.dof_body.dof Model.integrate.dt
Model.free_step.dt Model.integrate_derivatives.dt Model.step.dt Model.interpolate.s Model.packed_index.i Model.packed_index.j
Model.random.seed Library.status_string.status Spatial.inertia_of.mass Spatial.rotation_from_axis_angle.angle
Spatial.rotation_from_rpy.roll Spatial.rotation_from_rpy.pitch Spatial.rotation_from_rpy.yaw ConstraintSet.first.constraint
ContactSet.plane.height ContactSet.row_set.lower ContactSet.row_set.bias Actuators.friction.speed Actuators.friction.torque
Actuators.friction.joint Actuators.reset.air Body.pitch Body.lower Body.upper Body.mimic_ratio Body.mimic_offset Contact.height
Motor.gear Motor.phase Motor.offset Rod.elbow Rotor.gear""".split())


def test_negative_numbers(double):
    """A number that must not be negative is refused by name, and no number is silently so but those of SIGNED."""
    bad, signed = [], set()
    uses = [(walk.name, name, lambda name=name, walk=walk: walk.run(**{name: -1})) for walk in walks(double)
            for name, kind in walk.kinds.items() if kind.rstrip("?") in ("number", "numbers", "count")]
    uses += [(kind.__name__, field.name, lambda kind=kind, use=use, row={**right, field.name: -1}: use(kind(**row)))
             for kind, use, right in fields_of(double) for field in dataclasses.fields(kind)
             if (WITH.get(field.name) or KINDS[field.type.replace(" | None", "")]) in ("number", "count")]
    for owner, name, use in uses:
        text = message(use)
        if f"{owner}.{name}" in SIGNED:
            signed.add(f"{owner}.{name}")
        elif not is_named(text, name):
            bad.append(f"{owner}.{name}: {text[:100] or 'nothing is said'}")
    assert not bad and signed == SIGNED, "\n".join(bad)


# ---- right arguments in other forms ----

def forms(right):
    """The same numbers as other arrays; all are left as they are."""
    right = np.array(right, float)
    wide = np.zeros((*right.shape[:-1], 2 * right.shape[-1]))
    wide[..., ::2] = right
    backwards = np.ascontiguousarray(right[..., ::-1])[..., ::-1]
    fixed = right.copy()
    fixed.setflags(write=False)
    yield from (right.tolist(), wide[..., ::2], backwards, np.asfortranarray(right), fixed, right.astype(">f8"),
                right.astype("f4"), right.astype(np.longdouble))


def arrays(value):
    """All arrays and numbers of a result."""
    if isinstance(value, (tuple, list)):
        return [array for part in value for array in arrays(part)]
    if dataclasses.is_dataclass(value):
        return arrays([getattr(value, field.name) for field in dataclasses.fields(value)])
    return [np.asarray(value)] if isinstance(value, (np.ndarray, float, int)) else []


def equal(one, other):
    return len(one) == len(other) and all(np.array_equal(a, b) for a, b in zip(one, other))


def test_forms_of_arrays(double):
    """Strides, order of bytes, precision and flags of an array do not count; it is only read, and no result stands in it
    or in that of an earlier call."""
    compared = 0
    for walk in walks(double):
        numbers = [key for key, value in walk.right.items() if walk.kinds[key].startswith("array") and value is not None]
        right = {**walk.right, **{key: np.array(walk.right[key], "f4").astype(float) for key in numbers}}
        before, found, again = copy.deepcopy(right), arrays(walk.run(**right)), arrays(walk.run(**right))
        assert equal(arrays(list(right.values())), arrays(list(before.values()))), f"{walk.name} wrote into an argument"
        inside = [value for value in right.values() if isinstance(value, np.ndarray)]
        for array in filter(np.ndim, found):
            shared = any(np.shares_memory(array, other) for other in inside + again)
            assert not shared, f"{walk.name}: a result is in another array"
        if not equal(found, again):
            continue  # it goes on from the last call
        for key in numbers:
            for form in forms(right[key]) if np.ndim(right[key]) else ():
                kept = np.array(form)
                assert equal(found, arrays(walk.run(**{**right, key: form}))), f"{walk.name}: {key} as {type(form)}, {form!r:.60}"
                assert np.array_equal(kept, form), f"{walk.name}: {key} was changed"
                compared += 1
    assert compared > 1000


# ---- fields of dataclasses ----

def fields_of(library):
    """Each dataclass that a user fills: what reads it, and right values of its fields."""
    model, q = robot(library), configuration()
    motor = {"joint": "knee", "gear": 50.0, "constant": 1.0, "resistance": 1.0, "voltage": 24.0, "current": 5.0,
             "heat_winding": 10.0, "heat_case": 10.0, "flow_winding": 1.0, "flow_case": 1.0, "hot": 80.0, "hottest": 100.0,
             "cogging": 1e-3, "teeth": 7.0, "stiffness": 100.0, "damping": 0.1, "name": "M", "inertia": 1e-4,
             "friction": rbd.Friction(coulomb=0.1)}
    plain = [rbd.Motor(gear=1.0, constant=1.0)] * 2
    body = {"name": "foot", "joint": "ankle", "parent": "shank", **LEG, "armature": (0.1, 0, 0, 0, 0, 0), "damping": 0.1}
    return [
        (rbd.Body, lambda row: rbd.Model([*model.bodies, row], library=library), body),
        (rbd.Body, lambda row: rbd.Model([*model.bodies, row], library=library), {
            **body, "type": "universal", "axis2": (0, 0, 1), "lower": 0.0, "upper": 0.0}),
        (rbd.Body, lambda row: rbd.Model([*model.bodies, row], library=library), {
            **body, "mimic": "knee", "mimic_ratio": 0.5, "mimic_offset": 0.1}),
        (rbd.Constraint, lambda row: model.constraint_set([row]), {"body1": "shank", "axes": (1,) * 6, "kp": 1.0, "kd": 1.0}),
        (rbd.Contact, lambda row: model.contacts([row]), {"body1": "shank", "stiffness": 1e3, "damping": 1.0, "friction": 0.5}),
        (rbd.Contact, lambda row: model.contacts([row]), {"body1": "shank", "restitution": 0.5}),
        (rbd.ContactOptions, lambda row: model.contacts([], options=row), {}),
        (rbd.Motor, lambda row: model.actuators([row]), motor),
        (rbd.Friction, lambda row: model.actuators([rbd.Motor(**{**motor, "friction": row})]),
         {"coulomb": 0.1, "viscous": 0.1, "rest": 0.2, "speed": 0.1, "power": 1.0}),
        (rbd.Rod, lambda row: model.actuators(plain[:1], [rbd.Transmission(0, ["knee"], rod=[row])]), ROD),
        (rbd.Transmission, lambda row: model.actuators(plain[:1], [row]), {"joint": ["knee"], "matrix": [[2.0]]}),
        (rbd.Rotor, lambda row: model.rotor_torque([row], q, STATE, STATE),
         {"body": 1, "dof": 7, "axis": (0, 1, 0), "gear": 2.0, "inertia": 0.1}),
        *((rbd.IkTarget, lambda row: model.ik(row), {"kind": kind, "body": "shank", **more}) for kind, more in (
            ("point", {}), ("pose", {}), ("axis", {"axis": (0, 0, 1), "direction": (0, 0, 1)}))),
        (rbd.IkTarget, lambda row: model.ik(row), {"kind": "com"}),
        *((rbd.Task, lambda row: rbd.Tasks(model, [row]).velocity(q), {"kind": kind, **more}) for kind, more in (
            ("pose", {"body": "shank", "gain": 1.0}), ("axis", {"body": "shank", "axis": (0, 0, 1), "direction": (0, 0, 1)}),
            ("relative", {"body": "shank", "reference": "base"}), ("com", {}),
            ("posture", {"q": q, "v": STATE, "a": STATE, "weights": np.ones(8)}),
            ("rows", {"jacobian": np.eye(8)[:2], "y": np.zeros(2)}))),
        (rbd.TaskContact, lambda row: rbd.Tasks(model, [], [row]).acceleration(q, STATE),
         {"body": "shank", "friction": 0.5, "cost": 1.0}),
    ]


def test_all_fields(double):
    """Every dataclass of the package that a user fills is among them."""
    kinds = {kind for kind, _, _ in fields_of(double)}
    given = {kind for kind in map(vars(rbd).get, rbd.__all__) if dataclasses.is_dataclass(kind)}
    assert given - kinds == {rbd.Urdf, rbd.Mjcf}  # what loaders give
    for kind, use, right in fields_of(double):
        use(kind(**right))


WITH = {"type": "choice", "kind": "choice", "loose": "whole", "axes": "whole"}
UNREAD = "Body.axis2", "Body.mimic_ratio", "Body.mimic_offset"


def test_slips_of_fields(double):
    """Each slip in a field is refused by a sentence with the field's name."""
    bad = []
    for kind, use, right in fields_of(double):
        for field in dataclasses.fields(kind):
            name, annotation = field.name, field.type
            if name not in right and f"{kind.__name__}.{name}" in UNREAD:
                continue  # that type of joint does not read it
            about, value = WITH.get(name) or KINDS[annotation.replace(" | None", "")], right.get(name, field.default)
            slips = list(SLIPS["array" if about == "whole" else about]) + [None] * (field.default is not None)
            if annotation.startswith("ArrayLike") and name not in right:
                slips = [STATE]  # that kind of task has none
            slips = [slip for slip in slips if kind is not rbd.Transmission or slip is not None and not isinstance(slip, str)]
            if about in ("array", "whole") and value is not None and "float" not in annotation:
                slips += array_slips(value)
            for slip in slips:
                text = message(lambda: use(kind(**{**right, name: slip})))
                if not is_named(text, name) and not (about == "place" and "link" in text):
                    bad.append(f"{kind.__name__}.{name} = {slip!r:.50}: {text[:100] or 'nothing is said'}")
    assert not bad, f"{len(bad)} slips\n" + "\n".join(bad)


def test_fields_of_another_kind_are_refused(double):
    """What a kind of task or target does not read was filled in for another kind."""
    model, turn = robot(double), np.eye(3)[[1, 2, 0]]
    filled = {"position": (0, 0, 1), "rotation": turn, "axis": (0, 0, 1), "direction": (0, 0, 1)}
    reads = {"point": {"position"}, "pose": {"position", "rotation"}, "rotation": {"rotation"}, "axis": {"axis", "direction"},
             "com": {"position"}, "relative": {"position", "rotation"}, "momentum": set(), "posture": set(), "rows": set()}
    for kind, fields in reads.items():
        needed = {"axis": {"axis": (0, 0, 1), "direction": (0, 0, 1)}, "posture": {"q": configuration()},
                  "rows": {"jacobian": np.eye(8)[:1], "y": [0.0]}}.get(kind, {})
        for field, value in filled.items():
            given = {"kind": kind, **needed, field: value}
            uses = [lambda: rbd.Tasks(model, [rbd.Task(**given)]).velocity(configuration())]
            if kind.upper() in rbd.IkKind.__members__:
                uses.append(lambda: model.ik(rbd.IkTarget(**given), starts=1))
            for use in uses:
                text = message(use)
                assert not text if field in fields else f"field '{field}': '{kind}' does not read it" in text, (given, text)
