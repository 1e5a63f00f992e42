# SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors.
"""Names of a Model."""
from __future__ import annotations

import ctypes
import difflib
from typing import NamedTuple

from ._arguments import _int, _utf8, _whole
from ._calls import _Owner
from ._descriptions import Body, _from_c
from ._headers import JointType, structure


class JointInfo(NamedTuple):
    """A joint: its type, place in q and in v, and limits.

    A mimic or fixed joint has nq = nv = 0 and iq = iv = -1. No limits if lower >= upper."""
    type: JointType
    iq: int
    nq: int
    iv: int
    nv: int
    lower: float
    upper: float
    velocity: float
    effort: float


class Names(_Owner):
    """The calls of a Model by names: bodies, joints, degrees of freedom."""

    def _index(self, call, function, name):
        """Index of a body by the name of its link or joint; a KeyError says which names there are."""
        if not isinstance(name, str):
            raise TypeError(f"{call}: a name must be text, not {name!r}")
        try:
            index = self.library.call(function, self._address("model"), _utf8(name))
        except ValueError:
            index = -1  # no name of C
        if index >= 0:
            return index
        kind, names, others = "link", self.body_names, self.joint_names
        if function == "joint_index":
            kind, names, others = "joint", others, names
        where = others.index(name) if name in others else None
        text = f"{call}: no {kind} is called " + (f"'{name}'" if name.isprintable() else repr(name))
        if where is not None and names[where]:
            other = {"link": "joint", "joint": "link"}[kind]
            text += f"; the {other} '{name}' belongs to {kind} '{names[where]}'"
        names = [known for known in names if known]
        near = difflib.get_close_matches(name, names, 1)
        text += f"; did you mean '{near[0]}'? " if near and where is None else ". "
        text += f"There are: {', '.join(names[:12])}"
        text += f", ..., {len(names)} in all." if len(names) > 12 else "."
        if kind == "link":
            text += " Links on fixed joints are bodies only if load_urdf(keep=...) names them."
        raise KeyError(text)

    def body_index(self, name: str) -> int:
        """Index of a body by the name of its link; KeyError if there is none."""
        return self._index("body_index", "body_index", name)

    def joint_index(self, name: str) -> int:
        """Index of a body by the name of the joint that carries it; KeyError if there is none."""
        return self._index("joint_index", "joint_index", name)

    def _name(self, function, body):
        body = _int(_whole(function, "body", body))
        name = self.library.call(function, self._address("model"), body, result=ctypes.c_char_p)
        return None if name is None else name.decode("utf-8", "surrogateescape")

    def body_name(self, body: int) -> str | None:
        """Name of a body's link; None if nameless or no such body."""
        return self._name("body_name", body)

    def joint_name(self, body: int) -> str | None:
        """Name of the joint that carries a body; None if nameless or no such body."""
        return self._name("joint_name", body)

    @property
    def body_names(self) -> list[str | None]:
        """Names of all links, by body."""
        return [self.body_name(body) for body in range(self.nb)]

    @property
    def joint_names(self) -> list[str | None]:
        """Names of all joints, by body."""
        return [self.joint_name(body) for body in range(self.nb)]

    @property
    def dof_names(self) -> list[str]:
        """Names of the degrees of freedom: the joint's, with [k] where it has several."""
        return self._coordinates("iv", "nv", self.nv)

    @property
    def q_names(self) -> list[str]:
        """Names of the coordinates, likewise."""
        return self._coordinates("iq", "nq", self.nq)

    def _coordinates(self, first, count, length):
        names = [""] * length
        for body in range(self.nb):
            joint = self.joint(body)
            n, name = getattr(joint, count), self.joint_name(body) or f"joint {body}"
            for k in range(n):
                names[getattr(joint, first) + k] = name if n == 1 else f"{name}[{k}]"
        return names

    def _joint_body(self, joint, call, name="joint"):
        """The body that a joint carries: of its name or, if none has it, of that of the link, or of the index."""
        try:
            body = self._body(joint, call, name)
        except KeyError:
            body = -1
        if isinstance(joint, str) and (body < 0 or joint in self.joint_names):
            body = self._index(call, "joint_index", joint)
        return body

    def joint(self, joint: int | str) -> JointInfo:
        """JointInfo: type, place in q and v, and limits of a joint.

            joint        the name of the joint, or the body that it carries: index, or name of the link
        """
        body = self._joint_body(joint, "joint")
        info = structure("rbd_joint_info", self.library.scalar)()
        status = self.library.call("joint", self._address("model"), body, info)
        if status:
            raise self._error("joint", status)
        return JointInfo(JointType(info.type), *(getattr(info, name) for name in JointInfo._fields[1:]))

    def dof_body(self, dof: int) -> int:
        """The body whose joint has this degree of freedom, -1 if there is none."""
        return self.library.call("dof_body", self._address("model"), _int(_whole("dof_body", "dof", dof)))

    def describe(self, body: int | str) -> Body:
        """A Body read back from the model, from which a build makes the same, to rounding: its parent is the
        body whose joint carries it, axes are of unit length, an added payload is in it."""
        row = structure("rbd_body")()
        status = self.library.call("describe", self._address("model"), self._body(body, "describe"), row)
        if status:
            raise self._error("describe", status)
        return _from_c(row)
