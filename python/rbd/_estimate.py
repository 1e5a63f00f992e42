# SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors.
"""What a robot learns about itself: rbd_estimate.h."""
from __future__ import annotations

import ctypes
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from ._arguments import _Declared, _instance, _mask, _number, _numbers
from ._headers import Array, RbdError, Status, structure
from ._model import Model


class Felt(NamedTuple):
    """What Observer.step has found."""
    r: Array        #: nv: torque that acts beside motors and friction, N m; an alarm is |r| > band
    band: Array     #: nv: how much of r may be friction, N m


class Estimate(NamedTuple):
    """What Estimator.solve has found."""
    payload: Array      #: 10: parameters as those of Library.set_parameters
    friction: Array     #: nv x 3: coulomb, viscous, offset
    misfit: float       #: what is left of the samples over their noise: near 1 if the model is right


class Deviations(NamedTuple):
    """Standard deviations of an Estimate."""
    payload: Array      #: 10
    friction: Array     #: nv x 3


class _Kept(_Declared):
    """An object of C in memory of its own, whose calls name what they refuse."""
    model: Model

    def __init__(self, model, kind, *arguments):
        self.model = model
        self._kind, self._address = kind, ctypes.c_void_p()
        library = model.library
        self._fault = structure("rbd_estimate_fault", library.scalar)()
        size = library.call(f"{kind}_size", model._address("model"), result=ctypes.c_size_t)
        self._memory = ctypes.create_string_buffer(size)
        self._run("init", model._address("model"), *arguments, self._memory, ctypes.c_size_t(size),
                  ctypes.byref(self._address), self._fault)

    def _run(self, name, *arguments):
        library = self.model.library
        with self.model._lock:
            status = library.call(f"{self._kind}_{name}", *arguments)
        if status:
            text = ctypes.create_string_buffer(200)
            library.call("estimate_text", status, self._fault, text, ctypes.c_size_t(len(text)),
                         result=ctypes.c_void_p)
            raise RbdError(Status(status), f"{self._kind}_{name}: {text.value.decode()}")

    def _state(self, call, **arrays):
        """Arrays of one state each, checked."""
        sizes = {"q": self.model.nq}
        return [_numbers(call, name, value, (sizes.get(name, self.model.nv),), self.model.library.dtype)
                for name, value in arrays.items()]


class Observer(_Kept):
    """Feels the torques that act on the joints beside the motors: De Luca and Mattone (2005). rbd_observer_step

    gain      1/s: the felt torque follows with a time constant of 1 / gain
    friction  nv x 3: coulomb, viscous, offset; None = none. `observer.friction` may be changed between steps
    share     of the friction that may be wrong, 0 to 1
    least     N m: of the band, for what the model and the sensors lack
    slow      rad/s or m/s: a slower degree of freedom counts as at rest; 0 = 0.02

    A copy, or what was pickled, has the options and the friction: its next step begins anew, as after `reset`."""

    friction: Array     #: nv x 3: coulomb, viscous, offset, as the next step takes it

    def __init__(self, model: Model, gain: float, friction: ArrayLike | None = None, share: float = 0.0,
                 least: float = 0.0, slow: float = 0.0):
        real = _instance("Observer", "model", model, Model).library.dtype
        self.friction = np.zeros((model.nv, 3), real) if friction is None else _numbers(
            "Observer", "friction", friction, (model.nv, 3), real).copy()
        self._used, self._options = self.friction.copy(), (gain, share, least, slow)
        options = structure("rbd_observer_options", model.library.scalar)(
            _number("Observer", "gain", gain), _number("Observer", "slow", slow), _number("Observer", "share", share),
            _number("Observer", "least", least), self._used.ctypes.data)
        super().__init__(model, "observer", options)

    def __reduce__(self):
        gain, *others = self._options
        return Observer, (self.model, gain, self.friction, *others)

    def step(self, q: ArrayLike, v: ArrayLike, tau: ArrayLike, dt: float) -> Felt:
        """One tick: q and v at its end, tau of the motors in it. The first one begins, with r = 0."""
        model = self.model
        arrays = self._state("observer_step", q=q, v=v, tau=tau)
        self._used[:] = _numbers("observer_step", "friction", self.friction, (model.nv, 3), model.library.dtype)
        r, band = np.zeros((2, model.nv), model.library.dtype)
        self._run("step", model._address("model"), model._address("work"), self._address, *arrays,
                  model.library.scalar(_number("observer_step", "dt", dt)), r, band, self._fault)
        return Felt(r, band)

    def reset(self) -> None:
        """Forgets the past: the next step begins anew."""
        self._run("reset", self._address)


class Estimator(_Kept):
    """Learns the friction of each joint and the payload of a body, sample by sample; every payload is one that a body
    can have. rbd_estimate_add

    body        that carries the payload, index or name; None = friction alone
    mass        kg: as heavy as a payload may be; 0 = 5, and so on: defaults of rbd_estimate_options
    reach       m: as far as it may be from the body's origin; 0 = 0.2
    friction    N m, N m s/rad: as large as friction and offset may be; 0 = 100
    forgetting  what a sample leaves of the weight of those before, 0.5 to 1; 0 = 0.998
    slow        rad/s or m/s: a slower degree of freedom tells nothing; 0 = 0.03
    noise       nv, N m: standard deviations of tau; None = 0.1
    left_out    nv: 1 where tau is not known; None = none

    It cannot be copied or pickled: what it has learnt stays where it is."""

    def __init__(self, model: Model, body: int | str | None = None, mass: float = 0.0, reach: float = 0.0,
                 friction: float = 0.0, forgetting: float = 0.0, slow: float = 0.0, noise: ArrayLike | None = None,
                 left_out: ArrayLike | None = None):
        _instance("Estimator", "model", model, Model)
        index = -1 if body is None else model._body(body, "Estimator")
        numbers = [_number("Estimator", name, value) for name, value in
                   (("mass", mass), ("reach", reach), ("friction", friction), ("forgetting", forgetting), ("slow", slow))]
        sure = None if noise is None else _numbers("Estimator", "noise", noise, (model.nv,), model.library.dtype)
        flags = None if left_out is None else _mask("Estimator", "left_out", left_out, model.nv)
        options = structure("rbd_estimate_options", model.library.scalar)(
            *numbers, None if sure is None else sure.ctypes.data, None if flags is None else flags.ctypes.data)
        super().__init__(model, "estimate", index, options)

    def __reduce__(self):
        raise TypeError("Estimator: it cannot be copied or pickled, since what it has learnt would be lost; make another with "
                        "the same options")

    def add(self, q: ArrayLike, v: ArrayLike, a: ArrayLike, tau: ArrayLike) -> None:
        """Takes in one sample: tau of the motors at a state and its acceleration."""
        model = self.model
        self._run("add", model._address("model"), model._address("derivatives"), self._address,
                  *self._state("estimate_add", q=q, v=v, a=a, tau=tau), self._fault)

    def _results(self):
        real = self.model.library.dtype
        return np.zeros(10, real), np.zeros((self.model.nv, 3), real)

    def solve(self) -> Estimate:
        """The estimate from all samples so far."""
        (payload, friction), misfit = self._results(), np.zeros(1, self.model.library.dtype)
        self._run("solve", self._address, payload, friction, misfit)
        return Estimate(payload, friction, float(misfit[0]))

    def deviations(self) -> Deviations:
        """Standard deviations of the estimate, from the noise of tau alone."""
        payload, friction = self._results()
        self._run("deviations", self._address, payload, friction)
        return Deviations(payload, friction)

    def grip(self) -> None:
        """The hand took something, or changed it: the payload is unknown from here on; friction stays known."""
        self._run("grip", self._address)

    def release(self) -> None:
        """The hand is empty: the payload is 0, and samples tell of friction alone."""
        self._run("release", self._address)
