# SPDX-License-Identifier: MIT
"""What is wrapped, what is refused and how, memory, threads and processes."""
import copy
import ctypes
import inspect
import math
import multiprocessing
import os
import pickle
import re
import subprocess
import sys
import threading
import warnings
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

import rbd
from rbd._compiling import _compile
from rbd._headers import _HEADERS, _TEXT, _python_words
from rbd._urdf import _urdf_library

HERE = Path(rbd.__file__).resolve().parent

# Public functions of the headers that Python has no call of, and why.
NOT_WRAPPED = {
    "rbd_keep_zeros": "results are new arrays each time, which C has to write whole",
    "rbd_urdf_status_string": "the sentence of a finding says more; UrdfStatus has the names",
    "rbd_urdf_joint_index": "Urdf.bodies and Urdf.frames are lists to look in",
    "rbd_urdf_link_index": "likewise",
    "rbd_mjcf_status_string": "as of URDF",
    "rbd_mjcf_convert": "an mjModel of Python's package mujoco has no address that is public",
    "rbd_ik_size": "Model.ik makes its memory",
    "rbd_actuators_derivatives": "Actuators.step has no place between both halves of a step",
    "rbd_ik_text": "an RbdError has the sentence, and IkResult the numbers",
    "rbd_tasks_size": "Tasks makes its memory",
    "rbd_tasks_text": "an RbdError has the sentence",
    "rbd_vec3_of": "three numbers are an array",
    "rbd_rotation_identity": "numpy.eye(3)",
    "rbd_placement_of": "a pair",
    "rbd_placement_from_arrays": "a pair, as body_pose gives it",
    "rbd_placement_identity": "numpy.eye(3), numpy.zeros(3)",
    "rbd_motion_of": "six numbers are an array; numpy adds and scales them",
    "rbd_motion_add": "+",
    "rbd_motion_scale": "*",
    "rbd_force_of": "as of motions",
    "rbd_force_add": "+",
    "rbd_force_scale": "*",
    "rbd_inertia_add": "+",
    "rbd_inertia_from_parameters": "an inertia is its ten parameters",
    "rbd_inertia_to_parameters": "likewise",
    **{f"rbd_{what}_{way}_array": "quantities are arrays" for what in ("vec3", "rotation", "motion", "force")
       for way in ("from", "to")},
}
# Those that have another name or place here.
ELSEWHERE = {
    "rbd_model_build": "Model", "rbd_model_build_kinematic": "Model", "rbd_model_size": "Model", "rbd_work_init": "Model", "rbd_work_size": "Model",
    "rbd_derivatives_init": "Model", "rbd_derivatives_size": "Model", "rbd_batch_init": "Model",
    "rbd_batch_size": "Model", "rbd_batch_derivatives_init": "Model", "rbd_batch_derivatives_size": "Model",
    "rbd_constraint_set_init": "ConstraintSet", "rbd_constraint_set_size": "ConstraintSet",
    "rbd_batch_constraint_set_init": "ConstraintSet", "rbd_batch_constraint_set_size": "ConstraintSet",
    "rbd_constraint_rows": "ConstraintSet.rows", "rbd_constraint_first": "ConstraintSet.first",
    "rbd_constraint_rank": "ConstraintSet.rank",
    "rbd_nb": "Model.nb", "rbd_nq": "Model.nq", "rbd_nv": "Model.nv",
    "rbd_batch_lanes": "Library.lanes", "rbd_batch_set_gravity": "Model.set_gravity",
    "rbd_constraint_finding_text": "ConstraintSet",
    "rbd_contact_set_init": "ContactSet", "rbd_contact_set_size": "ContactSet",
    "rbd_contact_finding_text": "ContactSet", "rbd_contact_solve_size": "Library.contact_solve",
    **{f"rbd_contact_{name}": f"ContactSet.{name}" for name in
       ("step", "fd", "plane", "friction", "row_set", "row_get", "inertia", "reset", "get", "last")},
    "rbd_contact_step_derivatives": "ContactSet.step_derivatives",
    "rbd_tasks_velocity": "Tasks.velocity", "rbd_tasks_acceleration": "Tasks.acceleration",
    "rbd_urdf_load": "load_urdf", "rbd_urdf_parse": "parse_urdf",
    "rbd_mjcf_load": "load_mjcf", "rbd_mjcf_parse": "parse_mjcf",
    **{f"rbd_mjcf_{name}": f"Mjcf.{name}" for name in ("q_of_qpos", "v_of_qvel", "qpos_of_q", "qvel_of_v")},
    "rbd_qp_solve": "qp", "rbd_qp_text": "qp",
    **{f"rbd_observer_{name}": f"Observer.{name}" for name in ("init", "size")},
    **{f"rbd_estimate_{name}": f"Estimator.{name}" for name in ("init", "size", "text", "add", "solve", "deviations", "grip",
                                                                "release")},
    **{f"rbd_actuators_{name}": "Actuators" for name in ("init", "size", "finding_text", "fault")},
    **{f"rbd_actuators_{name}": f"Actuators.{name}" for name in ("map", "inverse", "reset", "get")},
    "rbd_actuators_begin": "Actuators.step", "rbd_actuators_again": "Actuators.step",
    "rbd_friction_level": "Actuators.friction",
}


def public_functions():
    """Declared in the public parts of the headers."""
    found = set()
    for name, text in _HEADERS.items():
        text = re.sub(r"/\*.*?\*/", "", text.partition("Stop here if you only use it.")[0], flags=re.S)
        if name == "rbd_spatial.h":
            found |= set(re.findall(r"^(?:RBDI_INLINE|RBDI_PART) \w+ (rbd_\w+)\(", text, re.M))
        elif name in ("rbd_urdf.h", "rbd_mjcf.h"):
            text = _HEADERS[name].partition("Implementation\n")[0]
            found |= set(re.findall(r"^(?:const char \*|int |void |rbd_\w+_status )(rbd_(?:urdf|mjcf)_\w+)\(", text, re.M))
        else:
            found |= set(re.findall(r"^RBDI_(?:BATCH_)?API [\w ]*?\*?(rbd_\w+)\(", text, re.M))
    return found


def test_every_public_function_is_wrapped_or_excused():
    functions = public_functions()
    assert len(functions) > 150
    assert {"rbd_rnea", "rbd_batch_crba", "rbd_constrained_fd", "rbd_urdf_load", "rbd_motion_up"} <= functions
    methods = {name for owner in (rbd.Model, rbd.ConstraintSet, rbd.ContactSet, rbd.Library, rbd.Spatial)
               for name, method in inspect.getmembers(owner, callable) if not name.startswith("_")}
    batches = {f"rbd_batch_{call.name}" for call in table_calls() if call.batch}
    wrapped = {f"rbd_{name}" for name in methods} | batches
    wrapped |= {f"rbd_{kind}_{name}" for kind, owner in {"observer": rbd.Observer, "estimate": rbd.Estimator}.items()
                for name in vars(owner) if not name.startswith("_")}
    missing = functions - wrapped - set(NOT_WRAPPED) - set(ELSEWHERE)
    assert not missing, f"neither wrapped nor excused: {sorted(missing)}"
    stale = (set(NOT_WRAPPED) | set(ELSEWHERE)) - functions | set(NOT_WRAPPED) & wrapped
    assert not stale, f"excused, but not there, or wrapped: {sorted(stale)}"


def table_calls():
    """The calls that the decorator made."""
    return [method._rbd_call for owner in (rbd.Model, rbd.ConstraintSet, rbd.ContactSet)
            for _, method in inspect.getmembers(owner) if hasattr(method, "_rbd_call")]


# Names of one letter are spelled out in C, where a macro may have that name; "lambda" is a keyword of Python.
IN_C = {"lambda_": "lambda", "M": "mass_matrix", "H": "packed", "L": "factor", "J": "jacobian", "R": "rotation",
        "Y": "regressor", "A": "matrix", "C": "matrix", "B": "b", "X": "x"}


def test_arguments_are_those_of_the_header():
    """Inputs and results of each call stand in C's order: its last arguments, but for what it computes in."""
    text = re.sub(r"/\*.*?\*/", "", _TEXT, flags=re.S)
    assert len(table_calls()) >= 50
    for call in table_calls():
        expected = [IN_C.get(x, x) for x in call.c_inputs + (["out"] if call.struct else call.outputs)]
        for prefix in ["rbd_", "rbd_batch_"] if call.batch is True else ["rbd_"]:
            declared = re.search(rf"^RBDI_(?:BATCH_)?API\b[^;({{]*\b{prefix}{call.c_name}\(([^;{{]*)\);", text, re.M)[1]
            arguments = [re.search(r"(\w+)(\[\d+\])?$", item.strip())[1] for item in declared.split(",")]
            first = len(arguments) - len(expected)
            assert arguments[first:] == expected, call.name
            assert sorted(call.inputs) == sorted(call.c_inputs), call.name
            assert first == 1 + len(call.memory) + (prefix == "rbd_batch_"), call.name
        if call.struct:
            kind = re.search(rf"const (\w+) \*out\);", text[text.index(f"rbd_{call.c_name}("):])[1]
            members = re.search(rf"typedef struct {kind} \{{(.*?)\}}", text, re.S)[1]
            assert re.findall(r"\*(\w+)", members) == [x.rstrip("_") for x in call.outputs], call.name


def test_help_shows_signature_shapes_and_units():
    assert str(inspect.signature(rbd.Model.rnea)) == "(self, q, v, a, f_ext=None)"
    for words in ("Inverse dynamics", "nb x 6", "in its axes", "N m", "count states"):
        assert words in rbd.Model.rnea.__doc__


def test_structures_are_those_of_the_header(double):
    assert {f.name for f in fields(rbd.Body)} == {name for name, _ in rbd.structure("rbd_body")._fields_}
    for kind, name in ((rbd.Constraint, "rbd_constraint"), (rbd.Contact, "rbd_contact"),
                       (rbd.ContactOptions, "rbd_contact_options")):
        assert [f.name for f in fields(kind)] == [member for member, _ in rbd.structure(name)._fields_
                                                  if member != "on_body"]  # which follows from body2
    assert rbd.ContactSolution._fields == tuple(n for n, _ in rbd.structure("rbd_contact_solution")._fields_)
    for kind, name, missing in (rbd.Task, "rbd_task", {"rows"}), (rbd.TaskContact, "rbd_task_contact", set()):
        assert {f.name for f in fields(kind)} | missing == {member for member, _ in rbd.structure(name)._fields_}
    assert [f.name for f in fields(rbd.IkTarget)] == [name for name, _ in rbd.structure("rbd_ik_target")._fields_]
    assert rbd.JointInfo._fields == tuple(name for name, _ in rbd.structure("rbd_joint_info")._fields_)
    for kind, name in ((rbd.Friction, "rbd_gear_friction"), (rbd.Motor, "rbd_motor"), (rbd.Rod, "rbd_rod"),
                       (rbd.Rotor, "rbd_rotor")):
        assert {f.name for f in fields(kind)} == {member for member, _ in rbd.structure(name)._fields_}
    assert set(rbd.Drives._fields) == {name for name, _ in rbd.structure("rbd_drive")._fields_}
    assert set(rbd.ActuatorStates._fields) == {name for name, _ in rbd.structure("rbd_actuator_state")._fields_}
    names = ["rbd_body", "rbd_finding", "rbd_report", "rbd_joint_info", "rbd_constraint",
             "rbd_contact", "rbd_contact_options", "rbd_contact_problem", "rbd_contact_solution",
             "rbd_ik_target", "rbd_ik_options", "rbd_ik_result",
             "rbd_task", "rbd_task_contact", "rbd_tasks", "rbd_tasks_result",
             "rbd_joint_friction", "rbd_estimate_fault", "rbd_observer_options", "rbd_estimate_options",
             "rbd_gear_friction", "rbd_motor", "rbd_rod", "rbd_transmission", "rbd_drive", "rbd_command",
             "rbd_actuator_state", "rbd_rotor",
             "rbd_urdf_options", "rbd_urdf_lock", "rbd_urdf_frame", "rbd_urdf_finding", "rbd_urdf",
             "rbd_mjcf_options", "rbd_mjcf_lock", "rbd_mjcf_frame", "rbd_mjcf_place", "rbd_mjcf_finding", "rbd_mjcf"]
    unit = '#include "rbd_contact.h"\n#include "rbd_tasks.h"\n#include "rbd_estimate.h"\n#include "rbd_actuator.h"\n#include "rbd_urdf.h"\n#include "rbd_mjcf.h"\nconst size_t sizes[] = {%s};' % ", ".join(
        f"sizeof({name})" for name in names)
    sizes = (ctypes.c_size_t * len(names)).in_dll(_compile([unit], ["cc"]), "sizes")
    assert list(sizes) == [ctypes.sizeof(rbd.structure(name)) for name in names]
    assert rbd.Status.ERR_SINGULAR == -6 and rbd.JointType.FLOATING == 15 and rbd.UrdfStatus.ERR_XML == -6


# ---- what is refused ----

q = v = a = np.zeros(7)
masked = np.ma.masked_array(q, mask=[True] + [False] * 6)
WRONG = [
    (lambda m: m.rnea(q, v, a[:6]), ValueError, r"rnea: a must have the shape \(nv,\) = \(7,\), not \(6,\): "
     "axis 0 is 6 long, not 7"),
    (lambda m: m.rnea(q, v, a.reshape(7, 1)), ValueError,
     r"a must have the shape \(\.\.\., nv\) = .*: axis 1 is 1"),
    (lambda m: m.rnea(q, v, 0), ValueError, r"rnea: a must have the shape \(nv,\) = \(7,\), not \(\)"),
    (lambda m: m.rnea(q, v, a, f_ext=np.zeros(6)), ValueError,
     r"f_ext must .* \(nb, 6\) = \(7, 6\), not \(6,\)"),
    (lambda m: m.rnea(q, v, a, np.zeros((7, 6, 1))), ValueError,
     r"f_ext must .*, not \(7, 6, 1\): axis 1 is 6 long"),
    (lambda m: m.rnea(np.zeros((3, 7)), np.zeros((2, 7)), a), ValueError,
     r"rnea: the numbers of states differ: q "
     r"\(3, 7\) has 3 in axis 0, v \(2, 7\) has 2 in axis 0"),
    (lambda m: m.rnea(np.zeros((4, 3, 7)), v, np.zeros((4, 1, 1, 7)) + np.zeros((5, 1, 7))), ValueError,
     r"q \(4, 3, 7\) has 4 in axis 0, a \(4, 5, 1, 7\) has 5 in axis 1"),
    (lambda m: m.rnea(np.zeros((3, 8)), v, a), ValueError,
     r"rnea: q must .* \(..., nq\) = \(..., 7\), not \(3, 8\)"),
    (lambda m: m.kinematics(np.zeros((3, 7))), ValueError, r"kinematics: q has the shape \(3, 7\): this call"),
    (lambda m: m.integrate(np.zeros((3, 7)), v, [0.1, 0.2]), ValueError,
     r"q \(3, 7\) has 3 .*, dt \(2,\) has 2 in axis 0"),
    (lambda m: m.hybrid(np.zeros((3, 7)), np.zeros((2, 7)), q.astype(int), a, a), ValueError,
     "hybrid: the numbers of st"),
    (lambda m: m.rnea(masked, v, a), TypeError, "rnea: q is a masked array, and its mask would be lost"),
    (lambda m: m.rnea(np.ma.masked_array(q), v, a), TypeError, "rnea: q is a masked array"),
    (lambda m: m.rnea([masked, masked], v, a), TypeError, "rnea: q is a masked array"),
    (lambda m: m.rnea([0.0] * 6 + [np.ma.masked], v, a), TypeError, "rnea: q is a masked array"),
    (lambda m: m.integrate(q, v, np.ma.masked_array([0.1])), TypeError, "integrate: dt is a masked array"),
    (lambda m: m.library.spatial.rotation_exp(masked[:3]), TypeError, "rotation_exp: turn is a masked array"),
    (lambda m: m.set_gravity(masked[:3]), TypeError, "set_gravity: gravity is a masked array"),
    (lambda m: m.rnea(q, v, None), TypeError, "rnea: a is missing"),
    (lambda m: m.rnea(q, v), TypeError, "missing 1 required positional argument: 'a'"),
    (lambda m: m.rnea(q, v, a, tau=1), TypeError, "unexpected keyword argument 'tau'"),
    (lambda m: m.rnea(q, v, a * 1j), TypeError, "rnea: a must be real numbers, not complex128"),
    (lambda m: m.rnea(q, v, "seven77"), TypeError, "rnea: a must be real numbers, not text"),
    (lambda m: m.rnea(q, v, [b"1"] * 7), TypeError, "rnea: a must be real numbers, not bytes"),
    (lambda m: m.rnea(q, v, [None] * 7), TypeError,
     "rnea: a must be real numbers, not Python objects .*None"),
    (lambda m: m.rnea(q, v, (x for x in a)), TypeError, "rnea: a must be .*, not Python objects .*generator"),
    (lambda m: m.rnea(q, v, np.zeros(7, "m8[s]")), TypeError, "rnea: a must be real numbers, not timedelta"),
    (lambda m: m.rnea(q, v, [1, [2]]), TypeError, "rnea: a"),
    (lambda m: m.rnea(q, v, a.astype(object)), TypeError, "rnea: a must be real numbers, not Python objects"),
    (lambda m: m.rnea(q, [0, 0, np.nan, 0, 0, 0, 0], a), ValueError, r"rnea: v\[2\] is nan"),
    (lambda m: m.rnea(q, v, a, np.full((7, 6), np.inf)), ValueError, r"rnea: f_ext\[0, 0\] is inf"),
    (lambda m: m.rnea([q, q], [v, v], [a, a + np.nan]), ValueError, r"rnea: a\[1, 0\] is nan"),
    (lambda m: m.kinematics(q, v * np.nan), ValueError, r"kinematics: v\[0\] is nan"),
    (lambda m: m.rnea(q, v, [1e308] * 7), FloatingPointError, r"rnea: tau\[\d\] is"),
    (lambda m: m.rnea(*np.full((3, 2, 7), 1e308)), FloatingPointError, r"rnea: tau\[\d, \d\] is"),
    (lambda m: m.integrate(q, v, "soon"), TypeError, "integrate: dt must be a number, not 'soon'"),
    (lambda m: m.integrate(q, v, float("nan")), ValueError, "integrate: dt is nan"),
    (lambda m: m.hybrid(q, v, q + 0.5, a, a), TypeError, "hybrid: given must be whole numbers"),
    (lambda m: m.hybrid(q, v, q.astype(int), a, a[1:]), ValueError, "hybrid: tau must have the shape"),
    (lambda m: m.set_gravity([0, 0]), ValueError, r"set_gravity: gravity must have the shape \(3,\)"),
    (lambda m: m.cholesky_solve_many(np.ones(28), np.ones((6, 2))), ValueError, r"B must .* \(7, n\)"),
    (lambda m: m.jacobian(0, axes="body"), ValueError, "jacobian: axes must be 'world' or 'link', not 'b"),
    (lambda m: m.hybrid(q, v, [2] + [0] * 6, a, a), ValueError,
     r"hybrid: given must be 0 or 1 .*, not 2 as at \[0\]"),
    (lambda m: m.hybrid(q, v, [256] + [0] * 6, a, a), ValueError, "hybrid: given must be 0 or 1"),
    (lambda m: m.constraint_set([]).constrained_id(q, v, a, actuated=np.full(7, 3, np.uint8)), ValueError,
     "constrained_id: actuated must be 0 or 1"),
    (lambda m: m.fd_derivatives(q, v, a, Minv="no"), TypeError,
     "fd_derivatives: Minv must be True or False, not 'no'"),
    (lambda m: m.jacobian(0.5), TypeError, "jacobian: body must be an index or a name, not 0.5"),
    (lambda m: m.jacobian("lbr_iiwa_link_9"), KeyError, "jacobian: no link .* did you mean 'lbr_iiwa_link_"),
    (lambda m: m.jacobian("lbr_iiwa_joint_3"), KeyError,
     "the joint 'lbr_iiwa_joint_3' belongs to link 'lbr_iiwa_link_3'"),
    (lambda m: m.joint("elbow"), KeyError,
     "joint: no joint is called 'elbow'. There are: lbr_iiwa_joint_1, .*_7"),
    (lambda m: m.joint("lbr_iiwa_joint3"), KeyError, "joint: no joint .* did you mean 'lbr_iiwa_joint_3'?"),
    (lambda m: m.body_index("hand"), KeyError, "body_index: no link is called 'hand'. There are: .*keep="),
    (lambda m: m.body_index(3), TypeError, "body_index: a name must be text, not 3"),
    (lambda m: m.body_name("x"), TypeError, "body_name: body must be a whole number, not 'x'"),
    (lambda m: m.packed_index(0.5, 0), TypeError, "packed_index: i must be a whole number, not 0.5"),
    (lambda m: m.dof_body("x"), TypeError, "dof_body: dof must be a whole number, not 'x'"),
    (lambda m: m.random("x"), TypeError, "random: seed must be a whole number, not 'x'"),
    (lambda m: m.random(1, -1), ValueError, "random: n must not be negative"),
    (lambda m: m.batch_set_layout("columns"), ValueError, "layout must be 'rows' or 'blocks', not 'columns'"),
    (lambda m: m.lock_joints("lbr_iiwa_joint_8", q), KeyError, "lock_joints: .*did you mean 'lbr_iiwa_joint_"),
    (lambda m: m.lock_joints(0, q[:6]), ValueError, r"lock_joints: q must have the shape \(7,\), not \(6,\)"),
    (lambda m: m.lock_joints(0, q * np.nan), ValueError, r"lock_joints: q\[0\] is nan"),
    (lambda m: m.add_payload(0, "heavy"), TypeError, "add_payload: mass must be a number"),
    (lambda m: m.c_model("two words"), ValueError, "'two words' is not a C identifier"),
    (lambda m: m.constraint_set(["foot"]), TypeError, "constraint 0 must be a Constraint"),
    (lambda m: m.constraint_set([rbd.Constraint("tip", None)]), TypeError, "'tip', field 'body1' must be an index"),
    (lambda m: m.constraint_set(m.point_contact(6)), TypeError,
     "rows must be a list of Constraint, not Constraint"),
    (lambda m: m.c_model("iiwa", None), TypeError, "source must be text, not None"),
    (lambda m: rbd.Model("robot.urdf"), TypeError,
     "a list of Body.*, not str; Model.from_urdf takes the name of a file"),
    (lambda m: rbd.Model(None), TypeError, "a list of Body.*, not NoneType"),
    (lambda m: rbd.Model(m.bodies, library="float"), TypeError, "library must be a Library"),
    (lambda m: m.library.set_parameters(None, np.ones(10)), TypeError, "body must be a Body, not NoneType"),
    (lambda m: m.library.spatial.placement_inverse(5), TypeError, "x must be a pair"),
    (lambda m: m.constraint_set([rbd.Constraint(body1=1, axes=[0.5] * 6)]), ValueError, "'axes': .* whole"),
    (lambda m: m.ball_loop(0, (0, 0), 1, (0, 0, 0)), ValueError, "ball_loop: point1 must have the shape"),
    (lambda m: m.library.finding_text(7), TypeError, "finding must be a rbd_finding, not int"),
    (lambda m: m.library.finding_text(np.ones(5)), TypeError, "finding must be a rbd_finding, not ndarray"),
    (lambda m: m.library.finding_text(None), TypeError, "finding must be a rbd_finding, not NoneType"),
    (lambda m: m.library.finding_text(rbd.structure("rbd_body")()), TypeError, "not rbd_body"),
    (lambda m: m.library.finding_text(rbd.structure("rbd_finding")(), "aba"), ValueError, "not 'aba'"),
    (lambda m: rbd.Model(m.bodies, library=""), TypeError, "library must be a Library, as .*, not ''"),
    (lambda m: m.constraint_set(""), TypeError, "rows must be a list of Constraint, not str"),
    (lambda m: rbd.Model([rbd.Body("rod\0", type="floating", mass=1)]), ValueError, "'name': 'rod.x00' has a NUL"),
    (lambda m: rbd.Model([rbd.Body("\ud800", type="floating", mass=1)]), ValueError, "'name': .* is not text"),
    (lambda m: rbd.Model([rbd.Body(5, type="floating", mass=1)]), TypeError, "'name': must be text, not 5"),
    (lambda m: m.body_index(m.body_names[0] + "\0"), KeyError, "no link is called .*x00"),
    (lambda m: m.body_pose("\ud800"), KeyError, "no link is called .*ud800"),
    (lambda m: rbd.parse_urdf(URDF.format(mass=1), keep="rod\0"), ValueError, "parse_urdf: keep: .* has a NUL"),
    (lambda m: rbd.parse_urdf(URDF.format(mass=1), root="\ud800"), ValueError, "parse_urdf: root: .* is not text"),
]


@pytest.mark.parametrize("number", range(len(WRONG)))
def test_wrong_arguments_are_refused_by_name(iiwa, number):
    call, error, text = WRONG[number]
    iiwa.kinematics(q)
    with pytest.raises(error, match=text):
        call(iiwa)
    assert np.isfinite(iiwa.rnea(q, v, a)).all()  # and nothing of it stays


FAILING = [
    (lambda m: m.body_pose(7), "ERR_INDEX", "body_pose: no such body: 7; the model has 0 to 6"),
    (lambda m: m.body_pose(-1), "ERR_INDEX", "body_pose: "),
    (lambda m: m.relative_jacobian(0, reference=-2), "ERR_INDEX", "and -1 for the world"),
    (lambda m: m.relative_jacobian_derivative(0, reference=-2), "ERR_INDEX", "and -1 for the world"),
    (lambda m: m.distance(q, q, -np.ones(7)), "ERR_RANGE", "distance: weight: "),
    (lambda m: m.body_pose(2**40), "ERR_INDEX", "body_pose: "),
    (lambda m: m.copy().body_pose(0), "ERR_ORDER", "body_pose: kinematics must be called first"),
    (lambda m: m.joint(7), "ERR_INDEX", "joint: "),
    (lambda m: m.describe(2**33), "ERR_INDEX", "describe: "),
    (lambda m: m.add_payload(2, -100), "ERR_MASS", "add_payload: "),
    (lambda m: m.lock_joints([0, 7], q), "ERR_INDEX", "lock_joints: joints: no such body: 7"),
    (lambda m: m.batch_jacobian(np.zeros((2, 7)), 99), "ERR_INDEX", "batch_jacobian: "),
    (lambda m: m.constraint_set([m.point_contact(6)]).impact(q, v, 2), "ERR_RANGE", "impact: restitution: "),
    (lambda m: m.constraint_set([rbd.Constraint("tip", 1, 0)]), "ERR_AXIS", "constraint 0 'tip', field 'axes'"),
    (lambda m: m.constraint_set([rbd.Constraint("tip", 2**32, axes=[1] * 6)]), "ERR_INDEX", "0 'tip'"),
    (lambda m: m.library.check_parameters([-1] + [0] * 9), "ERR_MASS", "check_parameters: "),
]


@pytest.mark.parametrize("number", range(len(FAILING)))
def test_errors_of_the_library_are_exceptions(iiwa, number):
    call, status, text = FAILING[number]
    iiwa.kinematics(q)
    with pytest.raises(rbd.RbdError, match=text) as caught:
        call(iiwa)
    assert caught.value.status == rbd.Status[status]


DESCRIPTIONS = [
    ([], rbd.RbdError, "number of bodies"),
    ([rbd.Body("rod", None, -1, "revolute", (0, 1, 0), mass=-1)], rbd.RbdError, "'rod', field 'mass': neg"),
    ([rbd.Body("rod", None, -1, "revolute", (0, 1, 0), mass=np.nan)], rbd.RbdError, "'rod', field 'mass'"),
    ([rbd.Body("rod", type="revolute", mass=1)], rbd.RbdError, "body 0 'rod', field 'axis'"),
    ([rbd.Body("rod", parent="arm")], ValueError, "'rod', field 'parent': no earlier body is called 'arm'"),
    ([rbd.Body("rod", parent=2**32)], rbd.RbdError, "body 0 'rod', field 'parent'"),
    ([rbd.Body("rod", type="hinge")], ValueError, "body 0 'rod', field 'type': unknown joint type 'hinge'"),
    ([rbd.Body("rod", type=99)], ValueError, "body 0 'rod', field 'type'"),
    ([rbd.Body("rod", mass="7 kg")], TypeError, "body 0 'rod', field 'mass'"),
    ([rbd.Body("rod", axis=(0, 1))], ValueError, "body 0 'rod', field 'axis': has 2 numbers instead of 3"),
    ([rbd.Body("rod", damping=(1,) * 7)], ValueError, "body 0 'rod', field 'damping'"),
    ([rbd.Body("rod", com=masked[:3])], TypeError, "'rod', field 'com': it is a masked array"),
    ([rbd.Body("rod", com=("1", "2", "3"))], TypeError, "field 'com': it must be real numbers, not text"),
    ([rbd.Body("rod", axis="z")], TypeError, "'rod', field 'axis': it must be real numbers, not text"),
    ([rbd.Body("rod", axis=(0, 0, 1j))], TypeError, "field 'axis': it must be real numbers, not complex"),
    ([rbd.Body("rod", inertia=np.eye(3))], ValueError, r"has 9 numbers instead of 6 \(xx xy xz yy yz zz\)"),
    ([rbd.Body("rod", parent=0.0)], TypeError, "'rod', field 'parent': must be an index or a name, not 0.0"),
    ([rbd.Body("arm"), rbd.Body("rod", parent="arn")], ValueError, "'arn'; did you mean 'arm'?"),
    ([rbd.Body(7)], (TypeError, AttributeError), "body 0 '7', field 'name'"),
    (["rod"], TypeError, "body 0: must be a Body, not str"),
]


@pytest.mark.parametrize("number", range(len(DESCRIPTIONS)))
def test_wrong_descriptions_are_refused_by_body_and_field(double, number):
    bodies, error, text = DESCRIPTIONS[number]
    with pytest.raises(error, match=text):
        rbd.Model(bodies, library=double)


def test_singular_systems_name_state_and_degree_of_freedom(double):
    """Two gimbals in a row: at q = 0 the first and the last axis coincide."""
    m = rbd.Model([rbd.Body("a", "outer", -1, "revolute", (1, 0, 0)),
                   rbd.Body("b", "middle", 0, "revolute", (0, 1, 0)),
                   rbd.Body("c", "inner", 1, "revolute", (1, 0, 0), mass=1, inertia=(1, 0, 0, 1, 0, 1))],
                  library=double)
    z = np.zeros(3)
    assert np.isfinite(m.aba([0, 1, 0], z, z)).all()
    with pytest.raises(rbd.RbdError, match=r"aba: .*singular.*freedom \d, '(outer|inner)'") as caught:
        m.aba(z, z, z)
    assert caught.value.status == rbd.Status.ERR_SINGULAR and m.singular_dof() in (0, 2)
    states = np.array([[0, 1, 0], [0, 2, 0], [0, 0, 0], [0, 1, 0]], float)
    with pytest.raises(rbd.RbdError, match="state 2; degree of freedom") as caught:
        m.aba(states, 0 * states, np.ones((4, 3)))
    assert m.batch_singular()[0] == 2
    stands = m.aba(states[3], z, np.ones(3))
    np.testing.assert_allclose(caught.value.results[3], stands, rtol=1e-12)
    with pytest.raises(rbd.RbdError, match="minverse"):
        m.minverse(z)


def test_odd_bodies_warn(double):
    with pytest.warns(rbd.RbdWarning, match="body 0 'rod', field 'inertia'"):
        m = rbd.Model([rbd.Body("rod", None, -1, "revolute", (0, 0, 1), mass=1, inertia=(1, 0, 0, 1, 0, 5))],
                      library=double)
    assert len(m.warnings) == 1


# ---- arrays ----

def test_any_array_of_numbers_will_do(iiwa):
    x = iiwa.random(5)
    expected = iiwa.rnea(x, v + 1, a + 2)
    strided = np.zeros((7, 3))
    strided[:, 1] = x
    for q1, v1, a1 in ((list(x), [1] * 7, (2,) * 7), (strided[:, 1], np.ones(7, int), np.full(7, 2, np.int8)),
                       (x[::-1].copy()[::-1], np.ones(7, np.float32), np.full(7, 2, ">f8")),
                       (np.asfortranarray(x), np.ones(7, bool), np.full(7, 2.0))):
        np.testing.assert_array_equal(iiwa.rnea(q1, v1, a1), expected)
    many = np.repeat(x[None], 5, 0)
    for Q in many, np.asfortranarray(many), np.repeat(many, 2, 0)[::2], many.tolist():
        found = iiwa.rnea(Q, np.ones((5, 7)), np.full((5, 7), 2))
        np.testing.assert_allclose(found, np.repeat(expected[None], 5, 0), rtol=1e-12)
    assert iiwa.rnea(np.zeros((0, 7)), np.zeros((0, 7)), np.zeros((0, 7))).shape == (0, 7)


def test_blocks_of_lanes_are_not_transposed(iiwa):
    lanes = iiwa.library.lanes
    rows = [iiwa.random(8, n=3 * lanes), *np.random.default_rng(1).uniform(-2, 2, (2, 3 * lanes, 7))]
    f = np.random.default_rng(2).uniform(-9, 9, (3 * lanes, iiwa.nb, 6))

    def blocks(x):
        return np.moveaxis(x.reshape(3, lanes, *x.shape[1:]), 1, -1)

    constraints = iiwa.constraint_set([rbd.Constraint(body1=iiwa.nb - 1, axes=(0, 0, 0, 1, 0, 0))])
    for call, inputs in ((iiwa.rnea, [*rows, f]), (iiwa.aba, rows), (iiwa.crba, rows[:1]), (iiwa.gravity_torque, rows[:1]),
                         (iiwa.id_derivatives, rows), (constraints.constrained_fd, rows)):
        expected = call(*inputs)
        iiwa.batch_set_layout("blocks")
        found, one = call(*map(blocks, inputs)), call(*(blocks(x)[0] for x in inputs))
        iiwa.batch_set_layout("rows")
        for x, y, z in zip(*[[r] if isinstance(r, np.ndarray) else r for r in (expected, found, one)]):
            np.testing.assert_array_equal(blocks(x), y)
            np.testing.assert_array_equal(z, y[0])
        np.testing.assert_array_equal(call(*inputs)[0], expected[0])  # and the rows after them are rows
    iiwa.batch_set_layout("blocks")
    with pytest.raises(ValueError, match=r"rnea: q must have the shape \(..., nq, lanes\) = .*: axis 2 is"):
        iiwa.rnea(*np.zeros((3, 2, 7, lanes + 1)))
    copy = iiwa.copy()
    np.testing.assert_array_equal(copy.rnea(*map(blocks, rows)), iiwa.rnea(*map(blocks, rows)))


def test_axes_before_those_of_a_state_are_broadcast(iiwa, library):
    """As in numpy's generalized functions: the same results as a loop, with and without a batch in C."""
    rng = np.random.default_rng(3)
    Q, V = iiwa.random(1, 12).reshape(4, 3, 7), rng.uniform(-1, 1, (3, 7))
    u, f = rng.uniform(-1, 1, 7), rng.uniform(-9, 9, (4, 1, 7, 6))
    held = iiwa.constraint_set([iiwa.point_contact("lbr_iiwa_link_6")])
    given = np.array([[1, 0, 1, 0, 1, 0, 1]] * 3)
    steps = np.array([[0.1], [0.2], [0.3], [0.4]])
    weight = rng.uniform(1, 2, (4, 1, 3))
    calls = [
        (iiwa.rnea, [Q, V, u], (1, 1, 1)), (iiwa.aba, [Q, V, u, f], (1, 1, 1, 2)),
        (iiwa.rnea, [u, u, u, f], (1, 1, 1, 2)), (iiwa.crba, [Q], (1,)),
        (iiwa.id_derivatives, [Q, u, V], (1, 1, 1)), (iiwa.gravity_torque, [Q], (1,)),
        (iiwa.integrate, [Q, V, 0.1], (1, 1, 0)), (iiwa.integrate, [u, V, steps], (1, 1, 0)),
        (iiwa.difference, [Q, u], (1, 1)), (iiwa.cholesky_factor, [iiwa.crba(Q)], (2,)),
        (iiwa.cholesky_factor_packed, [iiwa.crba_packed(Q)], (1,)),
        (iiwa.hybrid, [Q, u, given, V, u, f], (1, 1, 1, 1, 1, 2)),
        (iiwa.id_free_base, [Q, V, u, u], (1, 1, 1, 1)),
        (iiwa.batch_momentum, [Q, V], (1, 1)), (iiwa.joint_wrench, [Q, V, u], (1, 1, 1)),
        (iiwa.energy_regressors, [Q, V], (1, 1)), (held.constrained_fd, [Q, V, u], (1, 1, 1)),
        (held.constrained_id, [Q, V, u, None, given, weight], (1, 1, 1, 0, 1, 1)),
        (held.constraint_jacobian, [Q, V], (1, 1)), (held.impact, [Q, u, steps], (1, 1, 0)),
        (iiwa.library.spatial.rotate, [iiwa.library.spatial.rotation_exp(Q[..., :3]), V[:, :3]], (2, 1)),
    ]
    for call, inputs, cores in calls:
        loops = [x if x is None else np.shape(x)[:np.ndim(x) - core] for x, core in zip(inputs, cores)]
        loop = np.broadcast_shapes(*(x for x in loops if x is not None))
        spread = [x if x is None else np.broadcast_to(x, loop + np.shape(x)[np.ndim(x) - core:])
                  for x, core in zip(inputs, cores)]
        found = call(*inputs)
        found = found if isinstance(found, tuple) else (found,)
        for index in np.ndindex(*loop):
            expected = call(*(x if x is None else x[index] for x in spread))
            for x, y in zip(found, expected if isinstance(expected, tuple) else (expected,)):
                assert x.shape[:len(loop)] == loop
                np.testing.assert_allclose(x[index], y, rtol=1e-9, atol=1e-9 * max(1, np.abs(y).max()),
                                           err_msg=call.__name__)
    iiwa.kinematics(Q[0, 0])
    points = rng.uniform(-1, 1, (5, 3))
    for k, point in enumerate(points):
        np.testing.assert_array_equal(iiwa.point_position(6, points)[k], iiwa.point_position(6, point))
        np.testing.assert_array_equal(iiwa.jacobian(6, points)[k], iiwa.jacobian(6, point))
    s = library.spatial
    pose = s.placement_exp(rng.uniform(-1, 1, (2, 1, 6)))
    both = s.placement_compose(pose, s.placement_exp(rng.uniform(-1, 1, (3, 6))))
    assert both.rotation.shape == (2, 3, 3, 3) and both.position.shape == (2, 3, 3)
    assert s.rotation_to_axis_angle(pose.rotation).angle.shape == (2, 1)
    assert iiwa.rnea(np.zeros((0, 7)), v, np.zeros((4, 1, 7))).shape == (4, 0, 7)
    assert iiwa.gravity_torque(np.zeros((0, 7))).shape == (0, 7)
    assert s.rotation_log(np.zeros((0, 3, 3))).shape == (0, 3)
    assert iiwa.fd_derivatives(Q, V, u, a=0, Minv=np.False_).a is None


def test_errors_of_many_states_name_the_state(double):
    m = rbd.Model([rbd.Body("slider", "rail", -1, "prismatic", (1, 0, 0), mass=1,
                            inertia=(1, 0, 0, 1, 0, 1))],
                  library=double)
    Q = np.zeros((2, 3, 1))
    heavy = rbd.Model([replace(m.bodies[0], mass=1e10)], library=double)
    fast = np.zeros((2, 3, 1))
    fast[1, 0] = 1e300
    with pytest.raises(FloatingPointError, match=r"generalized_momentum: p\[0\] is inf; state \(1, 0\)"):
        heavy.generalized_momentum(Q, fast)
    held = m.constraint_set([rbd.Constraint("wall", "slider", axes=(0, 0, 0, 1, 0, 0))])
    tau = np.zeros((2, 3, 1))
    np.testing.assert_allclose(held.constrained_fd(Q, Q, tau).a, 0)
    with pytest.raises(rbd.RbdError, match=r"impact: restitution: .*; state \(1, 2\)") as caught:
        held.impact(Q, Q, [[1, 1, 1], [1, 1, 7]])
    assert caught.value.status == rbd.Status.ERR_RANGE and caught.value.results is None


def test_results_are_arrays_of_their_own(iiwa):
    x = iiwa.random(6)
    first = iiwa.id_derivatives(x, v, a)
    kept = [array.copy() for array in first]
    iiwa.id_derivatives(iiwa.random(7), v + 1, a)
    for array, copy in zip(first, kept):
        np.testing.assert_array_equal(array, copy)
    M = iiwa.crba(x)
    M[...] = 0
    assert iiwa.crba(x)[0, 0] > 0
    L = iiwa.crba_packed(x)
    before = L.copy()
    iiwa.cholesky_factor_packed(L)
    np.testing.assert_array_equal(L, before)


def test_float_is_float(library):
    m = rbd.Model(rbd.load_table(rbd.SOURCES / "models/iiwa.h"), library=library)
    assert m.rnea(q, v, a).dtype == library.dtype == m.get_gravity().dtype
    assert m.rnea(np.zeros((2, 7)), np.zeros((2, 7)), np.zeros((2, 7))).dtype == library.dtype
    if library.real == "float":
        assert library.lanes == 4
        with pytest.raises(ValueError, match=r"rnea: a\[0\] is inf"):
            m.rnea(q, v, np.full(7, 1e300))


# ---- models ----

def test_gravity(iiwa):
    x, moon = iiwa.random(1), (0, 0, -1.62)
    on_earth = iiwa.gravity_torque(x)
    iiwa.bias(x[None], v[None])
    iiwa.set_gravity(moon)
    np.testing.assert_allclose(iiwa.gravity_torque(x), on_earth * 1.62 / 9.81, atol=1e-12)
    np.testing.assert_allclose(iiwa.bias(x[None], v[None])[0], on_earth * 1.62 / 9.81, atol=1e-12)
    np.testing.assert_allclose(iiwa.copy().gravity_torque(x), iiwa.gravity_torque(x))
    np.testing.assert_allclose(iiwa.copy().bias(x[None], v[None])[0], iiwa.gravity_torque(x), atol=1e-12)
    there = rbd.Model(iiwa.bodies, gravity=moon, library=iiwa.library)
    np.testing.assert_array_equal(there.get_gravity(), moon)


def test_payload_is_that_of_a_new_build(iiwa):
    x, u = iiwa.random(2), v + 1
    before = iiwa.fd_derivatives(x, u, a)
    batch = [x[None], u[None], a[None]]
    iiwa.fd_derivatives(*batch)
    held = iiwa.constraint_set([iiwa.point_contact("lbr_iiwa_link_6")])
    held.constrained_fd(x, u, a)
    iiwa.add_payload("lbr_iiwa_link_7", 3, com=(0, 0.1, 0.2), inertia=(0.1, 0, 0, 0.1, 0, 0.1))
    fresh = iiwa.copy()
    for loaded in iiwa.fd_derivatives(x, u, a), [array[0] for array in iiwa.fd_derivatives(*batch)]:
        for found, expected, old in zip(loaded, fresh.fd_derivatives(x, u, a), before):
            np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())
            assert np.abs(found - old).max() > 1e-3 * np.abs(old).max()
    fresh_held = fresh.constraint_set([fresh.point_contact("lbr_iiwa_link_6")])
    for found, expected in zip(held.constrained_fd(x, u, a), fresh_held.constrained_fd(x, u, a)):
        np.testing.assert_allclose(found, expected, rtol=1e-7, atol=1e-7 * np.abs(expected).max())
    assert abs(iiwa.describe(6).mass - iiwa.bodies[6].mass) < 1e-12
    np.testing.assert_allclose(iiwa.describe(6).inertia, fresh.bodies[6].inertia, atol=1e-12)


def test_locked_joints_are_those_of_the_whole_robot_at_rest(hyq):
    x, names = hyq.random(3), ["root", "lf_lowerleg", 12]
    hyq.set_gravity([1, 2, -3])
    held = hyq.lock_joints(names, x)
    assert held.nb == hyq.nb and held.nv == hyq.nv - 8 and held.body_names == hyq.body_names
    assert held.bodies[1] == hyq.bodies[1] and held.bodies[0].type == "fixed"
    stays = [hyq.dof_names.index(name) for name in held.dof_names]
    left = x[[hyq.q_names.index(name) for name in held.q_names]]
    np.testing.assert_allclose(held.crba(left), hyq.crba(x)[np.ix_(stays, stays)], rtol=0, atol=1e-12)
    u, whole = np.arange(1.0, held.nv + 1), np.zeros(hyq.nv)
    whole[stays] = u
    np.testing.assert_allclose(held.bias(left, u), hyq.bias(x, whole)[stays], rtol=0, atol=1e-10)
    assert hyq.lock_joints("root", x).nv == hyq.lock_joints(0, x).nv == hyq.nv - 6 and hyq.lock_joints([], x).nv == hyq.nv


def test_names(hyq):
    assert hyq.body_names[0] == "base_link_0" and hyq.joint_names[0] == "root"
    assert hyq.dof_names[:7] == [f"root[{k}]" for k in range(6)] + ["lf_haa_joint"]
    assert hyq.q_names[6:8] == ["root[6]", "lf_haa_joint"]
    assert hyq.body_index("lf_upperleg") == 5 == hyq.joint_index("lf_hfe_joint")
    assert hyq.joint("lf_hfe_joint") == hyq.joint("lf_upperleg") == hyq.joint(5) and hyq.joint("root").nv == 6
    assert hyq.joint("lf_upperleg").iv == 10 and hyq.dof_body(10) == 5 and hyq.dof_body(99) == -1
    assert hyq.body_name(99) is None
    joint = hyq.joint("lf_hipassembly")
    assert joint.type == rbd.JointType.REVOLUTE and joint.lower < joint.upper


def test_random_is_within_limits_and_repeats(hyq):
    many = hyq.random(3, 50)
    np.testing.assert_array_equal(many[0], hyq.random(3))
    joint = hyq.joint("lf_hipassembly")
    angles = many[:, joint.iq]
    assert joint.lower <= angles.min() < angles.max() <= joint.upper
    np.testing.assert_allclose(np.linalg.norm(many[:, 3:7], axis=1), 1)


def test_describe_builds_the_same(hyq):
    again = rbd.Model([hyq.describe(body) for body in range(hyq.nb)], library=hyq.library)
    x = hyq.random(4)
    np.testing.assert_allclose(again.crba(x), hyq.crba(x), atol=1e-12)


def test_passive_mass_and_parameters(double):
    m = rbd.Model([rbd.Body("rod", "hinge", -1, "revolute", (0, 0, 1), mass=2, com=(1, 0, 0),
                            inertia=(1, 0, 0, 1, 0, 1), damping=3, friction=0.5)], library=double)
    np.testing.assert_allclose(m.passive([2.0]), [-6.5])
    ball = replace(m.bodies[0], type="spherical", axis=(0, 0, 0), friction=(0.5,))
    ball = rbd.Model([ball], library=double)
    np.testing.assert_allclose(ball.passive([1.0, 2.0, 0.0]), [-3.5, -6, 0])
    assert m.mass() == 2
    pi = m.body_parameters("rod")
    np.testing.assert_allclose(pi, [2, 2, 0, 0, 1, 0, 0, 3, 0, 3])
    double.check_parameters(pi)
    twice = double.set_parameters(m.bodies[0], 2 * pi)
    assert twice.mass == 4 and twice.name == "rod"
    np.testing.assert_allclose(twice.inertia, [2, 0, 0, 2, 0, 2], atol=1e-15)


def test_from_urdf_is_the_table(double, hyq):
    urdf = rbd.load_urdf(rbd.SOURCES / "models/hyq.urdf", floating=True, gravity=(0, 0, -1))
    assert urdf.bodies == hyq.bodies and urdf.name == "hyq" and urdf.fixed_mass == 0
    assert [frame.link for frame in urdf.frames] == hyq.body_names
    m = rbd.Model(urdf, library=double)
    np.testing.assert_array_equal(m.get_gravity(), [0, 0, -1])
    x = hyq.random(8)
    np.testing.assert_array_equal(rbd.Model.from_urdf(rbd.SOURCES / "models/hyq.urdf", floating=True,
                                                      library=double).crba(x), hyq.crba(x))


URDF = """<robot name="arm"><link name="base"/><link name="rod"><inertial><mass value="{mass}"/>
<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link><link name="tool"/>
<joint name="hinge" type="revolute"><parent link="base"/><child link="rod"/><axis xyz="0 1 0"/>
<limit lower="-1" upper="1" velocity="1" effort="1"/></joint>
<joint name="flange" type="fixed"><parent link="rod"/><child link="tool"/><origin xyz="0 0 1"/></joint>
</robot>"""


def test_urdf_options():
    text = URDF.format(mass=1)
    assert [body.name for body in rbd.parse_urdf(text).bodies] == ["rod"]
    assert [body.name for body in rbd.parse_urdf(text.encode(), keep=["tool"]).bodies] == ["rod", "tool"]
    assert len(rbd.parse_urdf(text, keep_all=True).bodies) == 3
    tool = rbd.parse_urdf(text).frames[2]
    assert (tool.link, tool.joint, tool.body) == ("tool", "flange", 0)
    np.testing.assert_array_equal(tool.position, [0, 0, 1])
    with pytest.raises(rbd.RbdError, match="nothing moves|no joint"):
        rbd.parse_urdf(text, lock={"hinge": 0.5})
    with pytest.raises(rbd.RbdError) as caught:
        rbd.parse_urdf(text.replace("</robot>", ""))
    assert caught.value.status == rbd.UrdfStatus.ERR_XML
    with pytest.raises(rbd.RbdError, match="elbow") as caught:
        rbd.parse_urdf(text, lock={"elbow": 0.5})
    assert caught.value.status == rbd.UrdfStatus.ERR_OPTION
    assert rbd.parse_urdf(text, floating=True, root_joint="free").bodies[0].joint == "free"
    part = rbd.parse_urdf(text, floating=True, root="rod", keep="tool")
    assert [body.name for body in part.bodies] == ["rod", "tool"]
    locked = rbd.parse_urdf(text, floating=True, lock={"hinge": 0.5})
    np.testing.assert_allclose(locked.frames[1].rotation[0, 0], np.cos(0.5))
    for names in "hinge", ["hinge"], {"hinge"}:
        assert rbd.parse_urdf(text, floating=True, lock=names).frames[1].rotation[0, 0] == 1
    with pytest.raises(rbd.RbdError, match=r"let the root link float \(floating=True\)"):
        rbd.parse_urdf(text, lock="hinge")
    massless = re.sub(r'(value|i[xyz]{2})="1"', r'\1="0"', text)
    with pytest.raises(rbd.RbdError, match="no link that moves has mass: dynamics needs <inertial>"):
        rbd.parse_urdf(massless)
    with pytest.raises(TypeError, match="parse_urdf: there is no option 'flaoting'; did you mean 'floating'"):
        rbd.parse_urdf(text, flaoting=True)
    with pytest.raises(TypeError, match="floating must be True or False, not 'yes'"):
        rbd.parse_urdf(text, floating="yes")
    with pytest.raises(rbd.RbdError, match="there is no link '' to be the root"):
        rbd.parse_urdf(text, root="")
    with pytest.raises(TypeError, match="root must be a name or None, not 3"):
        rbd.parse_urdf(text, root=3)
    with pytest.raises(TypeError, match="keep must be a name or a list of names, not 3"):
        rbd.parse_urdf(text, keep=[3])
    with pytest.raises(TypeError, match="text must be str or bytes, not int"):
        rbd.parse_urdf(5)
    with pytest.raises(ValueError, match="'arm.urdf'; load_urdf takes the name of a file"):
        rbd.parse_urdf("arm.urdf")
    with pytest.warns(rbd.RbdWarning, match="name"):
        rbd.parse_urdf(text.replace(' name="arm"', ""))


def test_names_of_a_urdf_that_are_not_read_are_warned_of():
    """With the line; before the error that they lead to; and as that error, if warnings are errors."""
    text = URDF.format(mass=1).replace("</robot>", "<loop_joint/></robot>")
    told = "URDF:6: <loop_joint> is not read; the loop stays open: constraints can close it"
    with pytest.warns(rbd.RbdWarning) as caught:
        robot = rbd.parse_urdf(text)
    assert robot.warnings == [told] == [str(warning.message) for warning in caught]
    with pytest.raises(rbd.RbdError) as error:
        rbd.parse_urdf(text, strict=True)
    assert error.value.status == rbd.UrdfStatus.WARN_UNREAD and told in str(error.value)
    misspelt = URDF.format(mass=1).replace('<link name="tool"/>', '<lnk name="tool"/>')
    with pytest.warns(rbd.RbdWarning, match="URDF:2: <lnk> is not read; did you mean <link>?") as caught:
        with pytest.raises(rbd.RbdError, match="its child link 'tool' is missing"):
            rbd.parse_urdf(misspelt)
    assert len(caught) == 1


def test_options_of_urdf_are_in_the_signatures_and_those_of_the_tools():
    """Each option of rbd-model that says how a URDF is read is a keyword of the same name, and none else."""
    tool = (rbd.SOURCES / "tools/robot.c").read_text()
    help_text = re.search(r"settings_help\[\] =\n(.*?)\";\n", tool, re.S)[1]
    options = set(re.findall(r'^    "  --([a-z-]+)', help_text, re.M)) - {"help"}
    assert len(options) >= 10
    expected = {name.replace("-", "_") for name in options}
    for function, others in ((rbd.load_urdf, {"path"}), (rbd.parse_urdf, {"text"}),
                             (rbd.Model.from_urdf, {"path", "library"})):
        parameters = inspect.signature(function).parameters
        assert set(parameters) - others == expected, function
        assert all(name in function.__doc__ for name in expected)
        assert parameters["floating"].default is False and parameters["floating"].kind.name == "KEYWORD_ONLY"


def test_files_that_cannot_be_read_are_os_errors(tmp_path, double):
    """As of open(), with the name of the file."""
    for read in rbd.load_urdf, rbd.load_table, rbd.Model.from_urdf:
        with pytest.raises(FileNotFoundError) as caught:
            read(tmp_path / "nowhere.urdf")
        assert caught.value.filename == str(tmp_path / "nowhere.urdf")
        with pytest.raises(IsADirectoryError):
            read(tmp_path)
        with pytest.raises(TypeError):
            read(3)
    secret = tmp_path / "secret.urdf"
    secret.write_text(URDF.format(mass=1))
    secret.chmod(0)
    if not os.access(secret, os.R_OK):  # root reads all
        with pytest.raises(PermissionError):
            rbd.load_urdf(secret)


def test_warnings_come_once_and_at_the_callers_line(double, tmp_path):
    """The loader and the build see the same odd body: one warning, of the loader, with file and line."""
    path = tmp_path / "odd.urdf"
    path.write_text(URDF.format(mass=1).replace('izz="1"', 'izz="5"'))
    for make in (lambda: rbd.Model.from_urdf(path, library=double),
                 lambda: rbd.Model(rbd.load_urdf(path), library=double),
                 lambda: rbd.Model(rbd.parse_urdf(path.read_text()), library=double),
                 lambda: rbd.Model([rbd.Body("rod", "hinge", -1, "revolute", (0, 0, 1), mass=1,
                                             inertia=(1, 0, 0, 1, 0, 5))], library=double)):
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            model = make()
            model.copy(), pickle.loads(pickle.dumps(model))
        assert [w.category for w in caught] == [rbd.RbdWarning] and caught[0].filename == __file__
        assert model.warnings == [str(caught[0].message)] and "inertia" in model.warnings[0]
        assert pickle.loads(pickle.dumps(model)).warnings == model.copy().warnings == model.warnings
        urdf = "body" not in model.warnings[0]
        assert not urdf or re.match(r".*:\d+: link 'rod'", model.warnings[0])


def test_copies_are_of_what_was_built(double):
    """Not of rows that the caller has changed since, in place or otherwise."""
    com = np.array([0.0, 0.0, -0.5])
    row = rbd.Body("rod", "hinge", -1, "revolute", (0, 1, 0), mass=2, com=com, inertia=(1, 0, 0, 1, 0, 1))
    hold = rbd.Constraint("pin", "rod", axes=[0, 1, 0, 0, 0, 0])
    model = rbd.Model([row], library=double)
    held = model.constraint_set([hold])
    row.mass, com[2], hold.axes[1], hold.axes[0] = 5, -3, 0, 1
    assert b"rbd._" not in pickle.dumps([model, held], 0)  # the files of the package may change
    for other in model.copy(), copy.copy(model), copy.deepcopy(model), pickle.loads(pickle.dumps(model)):
        assert other.mass() == 2 and abs(abs(other.gravity_torque([math.pi / 2])[0]) - 9.81) < 1e-12
    for other in held, copy.copy(held), copy.deepcopy(held), pickle.loads(pickle.dumps(held)):
        assert np.abs(np.abs(other.constraint_jacobian([0.3]).J) - 1).max() < 1e-12


def test_errors_are_pickled_whole(double):
    """With the results that are valid all the same."""
    gimbals = [rbd.Body("a", "outer", -1, "revolute", (1, 0, 0)), rbd.Body("b", "middle", 0, "revolute", (0, 1, 0)),
               rbd.Body("c", "inner", 1, "revolute", (1, 0, 0), mass=1, inertia=(1, 0, 0, 1, 0, 1))]
    model = rbd.Model(gimbals, library=double)
    states = np.array([[0, 1, 0], [0, 0, 0]], float)
    with pytest.raises(rbd.RbdError) as caught:
        model.fd_derivatives(states, 0 * states, np.ones(3))
    for other in copy.copy(caught.value), pickle.loads(pickle.dumps(caught.value)):
        assert other.status == rbd.Status.ERR_SINGULAR and str(other) == str(caught.value)
        assert type(other.results) is type(caught.value.results)
        np.testing.assert_allclose(other.results.a[0], model.aba(states[0], np.zeros(3), np.ones(3)), rtol=1e-12)


def test_a_status_may_be_any_whole_number(double):
    for number in 10**30, -10**30, 2**31, 7:
        assert double.status_string(number) == double.status_string(-10**6)
    assert double.status_string(rbd.Status.ERR_SINGULAR) != double.status_string(7)


def test_c_tables_are_those_of_rbd_model(hyq):
    def without_command(file):
        return re.sub(r"\n       rbd-model .*", "", (rbd.SOURCES / "models" / file).read_text())
    assert hyq.c_model("hyq", "hyq.urdf") == without_command("hyq_model.h")
    assert hyq.c_table("hyq", "hyq.urdf") == without_command("hyq.h")


def test_c_tables_of_all_joint_types(double, tmp_path):
    """Also those that URDF lacks, and followers: the tables compile, and compute what the models do."""
    solid = dict(mass=1, com=(0.1, 0.2, 0.3), inertia=(1, 0, 0, 1, 0, 1))
    bodies = [rbd.Body(f"b{t.value}", f"j{t.value}", t.value - 2, t.name.lower(), (0, 0, 1), (0, 1, 0),
                       pitch=0.1, position=(0, 0, 1), **solid)
              for t in rbd.JointType if t.name not in ("FIXED", "JOINT_TYPES")]
    for body in bodies:
        if body.type in ("spherical", "planar", "translation", "floating") or body.type.startswith("euler"):
            body.axis = (0, 0, 0)
        if body.type != "universal":
            body.axis2 = (0, 0, 0)
    bodies += [rbd.Body("f1", "k1", 0, "revolute", (0, 1, 0), **solid),
               rbd.Body("f2", "k2", "f1", "revolute", (0, 1, 0), position=(1, 0, 0),
                        mimic="k1", mimic_ratio=2, **solid)]
    m = rbd.Model(bodies, gravity=(1, 2, -3), library=double)
    table = m.c_model("all")
    for constant in "Q_J3_COS", "Q_J6_LENGTH", "Q_J8_QW", "DOF_J8_WZ", "Q_J9_Z", "DOF_J14_Z":
        assert f"ALL_{constant} =" in table
    unit = f"""#define RBD_IMPLEMENTATION
#include "rbd.h"
{table}
rbd_status from_table(const double *q, const double *v, const double *tau, double *a) {{
    static unsigned char memory[ALL_WORK_SIZE];
    rbd_work *w;
    rbd_status status = rbd_work_init(&all_model, memory, sizeof memory, &w);
    return status ? status : rbd_aba(&all_model, w, q, v, tau, NULL, a);
}}"""
    call = _compile([unit], ["cc", "-O0"], ["-lm"]).from_table
    x, u, found = m.random(1), np.linspace(-1, 1, m.nv), np.zeros(m.nv)
    assert call(*(ctypes.c_void_p(array.ctypes.data) for array in (x, u, u, found))) == 0
    expected = m.aba(x, u, u)
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())
    (tmp_path / "all.h").write_text(m.c_table("all"))
    again = rbd.Model(rbd.load_table(tmp_path / "all.h"), library=double)
    np.testing.assert_allclose(again.crba(x), m.crba(x), atol=1e-12)


def test_load_table_says_what_it_lacks(tmp_path):
    (tmp_path / "empty.h").write_text("int x;\n")
    with pytest.raises(ValueError, match="has no array of rbd_body"):
        rbd.load_table(tmp_path / "empty.h")
    (tmp_path / "broken.h").write_text("static const rbd_body x_bodies[1] = {{nonsense}};\n")
    with pytest.raises(RuntimeError, match="nonsense"):
        rbd.load_table(tmp_path / "broken.h")
    with pytest.raises(FileNotFoundError):
        rbd.load_table(tmp_path / "nowhere.h")


# ---- spatial algebra ----

def test_spatial(library):
    s, eps = library.spatial, 100 * np.finfo(library.dtype).eps
    rng = np.random.default_rng(1)
    turn, v6, f6, point = rng.normal(size=3), rng.normal(size=6), rng.normal(size=6), rng.normal(size=3)

    def same(found, expected):
        np.testing.assert_allclose(found, expected, atol=20 * eps)

    def skew(x):
        return np.array([[0, -x[2], x[1]], [x[2], 0, -x[0]], [-x[1], x[0], 0]])

    R = s.rotation_exp(turn)
    angle = np.linalg.norm(turn)
    k = skew(turn / angle)
    same(R, np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k)  # Rodrigues
    same(s.rotation_log(R), turn)
    same(s.rotation_from_quaternion(2 * s.rotation_to_quaternion(R)), R)
    same(s.rotation_from_rpy(*s.rotation_to_rpy(R)), R)
    same(s.rotation_from_axis_angle(*s.rotation_to_axis_angle(R)), R)
    same(s.rotation_product(R, R), R @ R)
    same(s.rotation_inverse(R), R.T)
    same(s.rotate(R, point), R @ point)
    same(s.rotate_back(R, point), R.T @ point)
    x = s.placement_exp(v6)
    same(s.placement_log(x), v6)
    up = np.block([[x.rotation, np.zeros((3, 3))], [skew(x.position) @ x.rotation, x.rotation]])
    same(s.motion_up(x, f6), up @ f6)
    same(s.motion_down(x, f6), np.linalg.solve(up, f6))
    same(s.force_up(x, f6), np.linalg.inv(up).T @ f6)
    same(s.force_down(x, f6), up.T @ f6)
    cross = np.block([[skew(v6[:3]), np.zeros((3, 3))], [skew(v6[3:]), skew(v6[:3])]])
    same(s.motion_cross(v6, f6), cross @ f6)
    same(s.force_cross(v6, f6), -cross.T @ f6)
    same(s.power(v6, f6), v6 @ f6)
    same(s.point_up(x, point), x.rotation @ point + x.position)
    same(s.point_down(x, s.point_up(x, point)), point)
    both = s.placement_compose(x, x)
    same(both.position, x.rotation @ x.position + x.position)
    same(s.placement_compose(x, s.placement_inverse(x)).rotation, np.eye(3))
    i = s.inertia_of(2, point, [3, 0.1, 0.2, 4, 0.3, 5])
    I_com = np.array([[3, 0.1, 0.2], [0.1, 4, 0.3], [0.2, 0.3, 5]])
    c = skew(point)
    matrix = np.block([[I_com - 2 * c @ c, 2 * c], [-2 * c, 2 * np.eye(3)]])
    same(s.inertia_times(i, v6), matrix @ v6)
    same(s.inertia_times(s.inertia_up(x, i), v6), np.linalg.inv(up).T @ matrix @ np.linalg.inv(up) @ v6)
    same(s.inertia_down(x, s.inertia_up(x, i)), i)
    with pytest.raises(ValueError, match=r"motion_up: x.rotation must have the shape \(3, 3\)"):
        s.motion_up((np.eye(2), point), v6)
    with pytest.raises(ValueError, match="rotation_exp: turn.* is nan"):
        s.rotation_exp([0, np.nan, 0])


# ---- threads and processes ----

def test_models_of_threads_do_not_disturb_each_other(hyq):
    """One Model for each thread, also while others make theirs; and one for all."""
    states = hyq.random(1, 20)
    expected = [hyq.crba(x) for x in states]
    wrong = []

    def compare(model):
        wrong.extend(x for x, M in zip(states, expected) if not np.array_equal(model.crba(x), M))

    def work(make):
        for _ in range(30):
            compare(make())

    for make in hyq.copy, lambda: hyq:
        threads = [threading.Thread(target=work, args=(make,)) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert not wrong


def test_models_travel_to_processes(iiwa):
    iiwa.set_gravity((0, 0, -1))
    other = pickle.loads(pickle.dumps(iiwa))
    x = iiwa.random(9)
    np.testing.assert_array_equal(other.gravity_torque(x), iiwa.gravity_torque(x))
    with multiprocessing.get_context("fork").Pool(2) as pool:
        np.testing.assert_array_equal(pool.map(iiwa.gravity_torque, [x, x]), [iiwa.gravity_torque(x)] * 2)
        held = iiwa.constraint_set([iiwa.point_contact("lbr_iiwa_link_6")])
        found = pool.apply(held.constrained_fd, (x, v, a))
        np.testing.assert_array_equal(found.a, held.constrained_fd(x, v, a).a)
        found = pool.apply(iiwa.id_derivatives, (x, v, a))
        np.testing.assert_array_equal(found.M, iiwa.id_derivatives(x, v, a).M)
        np.testing.assert_array_equal(pool.apply(iiwa.hybrid, (x, v, v < 1, a, a)).a, a)
        with pytest.raises(rbd.RbdError, match="body_pose") as caught:
            pool.apply(iiwa.body_pose, (99,))
        assert caught.value.status == rbd.Status.ERR_INDEX


def table_for_a_compiler(folder):
    """A table that is not read without one."""
    text = (rbd.SOURCES / "models/pendulum.h").read_text()
    path = folder / "table.h"
    path.write_text(text.replace("_NB] = {\n", "_NB] = {\n#if 1\n#endif\n", 1))
    assert "#if 1" in path.read_text()
    return path


def test_processes_may_compile_at_once(tmp_path):
    """Four with an empty cache: all get the same file, and nothing else stays."""
    program = "import sys; sys.path.insert(0, sys.argv[1]); import rbd; print(len(rbd.load_table(sys.argv[2])))"
    environment = {**os.environ, "RBD_CACHE": str(tmp_path / "cache")}
    table = table_for_a_compiler(tmp_path)
    jobs = [subprocess.Popen([sys.executable, "-c", program, str(HERE.parent), str(table)], env=environment,
                             stdout=subprocess.PIPE, text=True) for _ in range(4)]
    assert [job.communicate()[0] for job in jobs] == ["1\n"] * 4
    assert [path.suffix for path in (tmp_path / "cache").iterdir()] == [".so"]


def test_compilers_and_folders_that_are_not_there(tmp_path, monkeypatch):
    with pytest.raises(RuntimeError, match="rbd needs 'no-such-cc'"):
        rbd.Library(compiler="no-such-cc")
    with pytest.raises(RuntimeError, match="-fno-such-option"):
        rbd.Library(flags="-fno-such-option")
    with pytest.raises(ValueError, match="real must be 'double' or 'float', not 'half'"):
        rbd.Library("half")
    with pytest.raises(ValueError, match="lanes must be"):
        rbd.Library(lanes=3)
    with pytest.raises(TypeError, match="lanes must be a whole number, not '4'"):
        rbd.Library(lanes="4")
    with pytest.raises(TypeError, match="flags must be text"):
        rbd.Library(flags=["-O0"])
    with pytest.raises(RuntimeError, match="^false -.* /dev/null: exit status 1; it printed nothing$"):
        rbd.Library(compiler="false")
    with pytest.raises(RuntimeError, match="killed by SIGTERM; it printed nothing$"):
        rbd.Library(compiler="sh -c 'kill -TERM $$'")
    monkeypatch.delenv("RBD_FLAGS", raising=False)
    default = "^'true -O3 -march=native -ffp-contract=fast .*' wrote no library: is it a compiler?"
    with pytest.raises(RuntimeError, match=default):
        rbd.Library(compiler="true")
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("RBD_CACHE", str(tmp_path / "file/cache"))
    with pytest.raises(RuntimeError, match=r"set \$RBD_CACHE to a folder"):
        rbd.load_table(table_for_a_compiler(tmp_path))


def test_a_long_compile_is_announced_once(tmp_path, monkeypatch, capfd):
    monkeypatch.setenv("RBD_CACHE", str(tmp_path / "cache"))
    monkeypatch.delenv("RBD_QUIET", raising=False)
    _compile(["int x;"], ["cc"], what="x, which takes a minute")
    assert re.fullmatch(r"rbd: compiling x, which takes a minute; .*RBD_QUIET.*\n", capfd.readouterr().err)
    _compile(["int x;"], ["cc"], what="x, which takes a minute")
    assert capfd.readouterr().err == ""
    monkeypatch.setenv("RBD_QUIET", "1")
    _compile(["int y;"], ["cc"], what="y")
    assert capfd.readouterr().err == ""


BARE = """<robot name="bare"><link name="base"/><link name="upper"/><link name="lower"/><link name="tool"/>
<joint name="shoulder" type="continuous"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/></joint>
<joint name="elbow" type="continuous"><parent link="upper"/><child link="lower"/><origin xyz="2 0 0"/>
<axis xyz="0 0 1"/></joint>
<joint name="mount" type="fixed"><parent link="lower"/><child link="tool"/><origin xyz="1 0 0"/></joint></robot>"""


def test_a_robot_without_masses_has_kinematics_alone():
    with pytest.raises(rbd.RbdError, match="no link that moves has mass: .*: kinematic=True$"):
        rbd.parse_urdf(BARE)
    urdf = rbd.parse_urdf(BARE, kinematic=True, keep="tool")
    with pytest.raises(rbd.RbdError, match="a movable leaf needs mass"):
        rbd.Model(urdf.bodies)
    bare = rbd.Model(urdf.bodies, kinematic=True)
    for model in rbd.Model(urdf), bare, bare.copy(), pickle.loads(pickle.dumps(bare)):
        assert model.kinematic
        q = [0, np.pi / 2]
        model.kinematics(q)
        rotation, position = model.body_pose("tool")
        np.testing.assert_allclose(position, [2, 1, 0], atol=1e-12)
        found = model.ik(rbd.IkTarget("point", "tool", position=position), [0.1, 1.2])
        assert found.status == rbd.IkStatus.REACHED
        with pytest.raises(rbd.RbdError, match="^rnea: dynamics needs masses.*; joint 'shoulder', which carries 'upper'$"
                           ) as caught:
            model.rnea(q, q, q)
        assert caught.value.status == rbd.Status.ERR_MASSLESS
        for call in model.crba, model.gravity_torque, model.minverse:
            with pytest.raises(rbd.RbdError, match="joint 'shoulder'"):
                call(np.zeros((5, 2)))
        with pytest.raises(rbd.RbdError, match="joint 'shoulder'"):
            model.com()
    assert not rbd.Model(urdf.bodies[:1] + [replace(urdf.bodies[1], mass=1.0)] + urdf.bodies[2:]).kinematic
    assert "rbd_model_build_kinematic" in bare.c_table("bare")


def test_wrong_mimics_may_move_freely():
    wrong = BARE.replace('<origin xyz="2 0 0"/>', '<mimic joint="sholder"/>')
    with pytest.raises(rbd.RbdError, match="let all such joints move freely: free_mimics=True"):
        rbd.parse_urdf(wrong, kinematic=True)
    with pytest.warns(rbd.RbdWarning, match="it mimics 'sholder', which is missing; .*; it moves freely"):
        urdf = rbd.parse_urdf(wrong, kinematic=True, free_mimics=True)
    assert urdf.bodies[1].mimic is None


def test_names_are_those_of_python():
    assert set(rbd.__all__) <= set(dir(rbd)) and dir(rbd.Model)
    assert {name for name in dir(rbd) if not name.startswith("__")} == set(rbd.__all__)
    public = [getattr(rbd, name) for name in rbd.__all__ if name != "SOURCES"]
    assert {thing.__module__ for thing in public} == {"rbd"}
    for name, method in inspect.getmembers(rbd.Model, inspect.isfunction):
        assert method.__qualname__ == f"Model.{name}" or name.startswith("_"), name
    for sentence, expected in (
            ("rbd_kinematics must be called first", "kinematics must be called first"),
            ("RBD_URDF_ERR_FILE rbd_urdf_load RBD_NO_CHOLESKY", "ERR_FILE load RBD_NO_CHOLESKY"),
            ("link 'rbd_a --keep', joint '--lock': rbd_rnea", "link 'rbd_a --keep', joint '--lock': rnea"),
            ("still: options.lock, rbd-model --lock 'a b', or --lock-massless for all",
             "still: lock='a b', or lock_massless=True for all"),
            ("alone: options.kinematic, rbd-model --kinematic", "alone: kinematic=True"),
            ("freely: options.free_mimics, rbd-model --free-mimics", "freely: free_mimics=True"),
            ("float (options.root, rbd-model --floating)", "float (floating=True)"),
            ("MJCF: rbd_mjcf.h reads it", "MJCF: load_mjcf reads it"),
            ("otherwise: options.root_joint, rbd-model --root-joint", "otherwise: root_joint")):
        assert _python_words(sentence) == expected


def test_without_urdfdom_the_error_says_what_to_do(monkeypatch):
    monkeypatch.setenv("PKG_CONFIG_LIBDIR", "/nowhere")
    monkeypatch.delenv("PKG_CONFIG_PATH", raising=False)
    _urdf_library.cache_clear()
    try:
        with pytest.raises(RuntimeError, match="liburdfdom-dev.*load_table"):
            rbd.parse_urdf(URDF.format(mass=1))
    finally:
        _urdf_library.cache_clear()


def test_flags_and_indices_of_numpy(double):
    """A whole number of numpy, as out of a table, is as good as one of Python; a flag of 2 is named once."""
    arm = rbd.Model(rbd.load_table(rbd.SOURCES / "models/iiwa.h"), library=double)
    q, none = arm.random(seed=1), np.zeros(arm.nv)
    one, zero = np.int64(1), np.uint8(0)
    assert arm.fd_derivatives(q, none, none, Minv=zero).Minv is None
    assert arm.actuators([rbd.Motor(joint=arm.joint_names[0], gear=50, constant=0.03, resistance=1, by_voltage=one)])
    assert rbd.ContactSet(arm, [rbd.Contact(body1=arm.nb - 1, body2=-1)], options=rbd.ContactOptions(joint_limits=one))
    posture = rbd.Task("posture", body=zero, reference=np.int64(-1), q=q, gain=1)
    assert rbd.Tasks(arm, [posture]).velocity(q).v.shape == (arm.nv,)

    with pytest.raises(TypeError, match="^contacts: options, field 'joint_limits': it must be True or False, not 2$"):
        rbd.ContactSet(arm, [rbd.Contact(body1=arm.nb - 1, body2=-1)], options=rbd.ContactOptions(joint_limits=2))
    with pytest.raises(ValueError, match="'posture' has none, but it is False"):
        rbd.Tasks(arm, [replace(posture, body=False)]).velocity(q)
