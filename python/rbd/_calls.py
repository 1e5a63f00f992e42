# SPDX-License-Identifier: MIT. Copyright (c) 2026 the rbd authors.
"""Methods that call C: made of their signatures; of one state, of many, and of batches."""
from __future__ import annotations

import ctypes
import functools
import inspect
import math
from collections import namedtuple

import numpy as np

from ._arguments import (_Declared, _GAINS, _INTEGERS, _MASKS, _QUANTITIES, _SCALARS, _array, _axes, _broadcast, _finite,
                         _flag, _ndim, _number, _numbers, _shape)
from ._headers import RbdError, Status


def _c(memory, gives="", batch=False, struct=False, c_name="", c_inputs="", **shapes):
    """Makes a method from its signature and docstring: it calls the C function of that name, after `rbd_`.

    The method's parameters are the inputs, in C's order, and then keywords that leave results out.
    c_name   the C function, where the method has another name
    c_inputs the inputs in C's order, where the method has another
    memory   the memory that C computes in, besides the model
    gives    the results in C's order; "dtau_dq?" is left out where the keyword dtau_dq is False, "A_dot_v?v"
             where v is None
    batch    whether C has the call for n states, as rbd_batch_...; or the name of one that gives the same of q, v = 0
             and no f_ext
    struct   whether C takes the results as a struct of pointers
    shapes   of quantities that have another shape here than in the table; behind two blanks another meaning
    """
    def make(method):
        call = _Call(method, memory, gives, batch, struct, c_name, c_inputs, shapes)
        parameters = ", ".join(list(inspect.signature(method).parameters)[1:])
        # A lambda with this signature: Python itself then sorts out the arguments.
        source = (f"lambda {str(inspect.signature(method))[1:-1]}: "
                  f"(self._calls.get('{method.__name__}') or self._bind(call))({parameters})")
        wrapper = functools.update_wrapper(eval(source, {"call": call}), method)
        wrapper.__doc__ = call.documentation(method)
        wrapper._rbd_call = call
        return wrapper
    return make


RESULTS = {}  # the named tuples by their names, which the package has too, so that they can be pickled


def _results(call, *names):
    """A named tuple for the results of a call."""
    kind = RESULTS[f"{call}_results"] = namedtuple(f"{call}_results", names, module=__package__)
    return kind


class _Call:
    """A method's call of C: memory, inputs, outputs."""

    def __init__(self, method, memory, gives, batch, struct, c_name, c_inputs, shapes):
        self.name = method.__name__
        self.c_name = c_name or self.name
        self.memory = memory.split()
        self.batch = batch
        self.struct = struct
        parameters = list(inspect.signature(method).parameters.values())[1:]
        self.inputs = [p.name for p in parameters if p.kind is not p.KEYWORD_ONLY]
        self.c_inputs = c_inputs.split() or self.inputs
        self.optional = {p.name for p in parameters
                         if p.default is None or "None = " in _QUANTITIES.get(p.name, ("", ""))[1]}
        names = [p.name for p in parameters]
        self.keywords = dict(list(enumerate(names))[len(self.inputs):])  # parameters that leave results out
        self.outputs, self.flags = [], []  # names, and the parameter that decides on each, None: always there
        for item in gives.split():
            name, question, flag = item.partition("?")
            self.outputs.append(name)
            self.flags.append(names.index(flag or name) if question else None)
        own = {name: [*text.split("  "), _QUANTITIES[name][1]][:2] for name, text in shapes.items()}
        self.shapes, self.meanings = ({name: own.get(name, _QUANTITIES[name])[k] for name in self.inputs + self.outputs}
                                      for k in (0, 1))
        self.symbols = {name: tuple(shape.replace("-", "").split()) for name, shape in self.shapes.items()}
        self.tuple = _results(self.c_name, *self.outputs) if len(self.outputs) > 1 else None

    def results(self, values):
        """One result, or a named tuple of several, or None."""
        return self.tuple(*values) if self.tuple else next(iter(values), None)

    def documentation(self, method):
        """The method's docstring, with shape and meaning of the arguments and results."""
        def lines(names):
            for name in names:
                shape = self.shapes[name].replace(" ", " x ").replace("-", "")
                yield f"    {name:<12}  {shape:<9}  {self.meanings[name]}"
        text = [inspect.getdoc(method), "", *lines(self.inputs)]
        if self.outputs:
            text += ["gives", *lines(self.outputs)]
            if set(self.inputs) - set(_INTEGERS):
                text += ["Axes before these count states, and are broadcast: " +
                         ("C computes them together." if self.batch else "one call of C for each state.")]
        return "\n".join(text)


class _Bound:
    """A call of one object, with memory: inputs are copied into one array, results out of another, so that
    all of C's arguments but numbers and NULL are the same each time."""

    def __init__(self, call, owner):
        self.call, self.owner, self.lock = call, owner, owner._lock
        library = owner.library
        self.cores = {name: _shape(shape, owner._dims) for name, shape in call.shapes.items()}
        self.function = library.function(call.c_name, arguments=[
            library.scalar if name in _SCALARS else ctypes.c_int if name in _INTEGERS else ctypes.c_void_p
            for name in ["model", *call.memory, *call.c_inputs, *(["out"] if call.struct else call.outputs)]])
        arrays = [name for name in call.inputs if name not in _SCALARS + _INTEGERS]
        self.arena, views = self._carve([name for name in arrays if name != "actuated"])
        if "actuated" in arrays:
            views["actuated"] = np.zeros(owner.nv, np.uint8)
        self.output, results = self._carve(call.outputs)
        self.views = list(results.values())
        self.arguments = [owner._address(kind).value for kind in ["model", *call.memory]]
        self.inputs = [(len(self.arguments) + call.c_inputs.index(name), name, views.get(name),
                        name in call.optional) for name in call.inputs]
        self.arguments += [views[name].ctypes.data if name in views else None for name in call.c_inputs]
        self.results_at = len(self.arguments)
        self.arguments += [view.ctypes.data for view in self.views]
        self.flagged = [(place, flag) for place, flag in enumerate(call.flags, self.results_at)
                        if flag is not None]
        self.plain = len(self.views) == 1 and self.views[0].ndim > 0

    def _carve(self, names):
        """An array of numbers, and the part of it for each name."""
        shapes = {name: self.cores[name] for name in names}
        arena, start, views = np.zeros(sum(map(math.prod, shapes.values())), self.owner.library.dtype), 0, {}
        for name, shape in shapes.items():
            views[name] = arena[start:start + math.prod(shape)].reshape(shape)
            start += math.prod(shape)
        return arena, views

    def __call__(self, *values):
        arguments = self.arguments.copy()
        with self.lock:
            for (place, name, view, optional), value in zip(self.inputs, values):
                if value is None and optional:
                    arguments[place] = None
                elif view is None:
                    if name in _SCALARS and isinstance(value, (np.ndarray, list, tuple)) and _ndim(self.call.name, name, value):
                        return self._many(values)
                    arguments[place] = self._convert(name, value)
                else:
                    if (type(value) is not np.ndarray or value.dtype is not view.dtype
                            or value.shape != view.shape or name in _MASKS):
                        value = _array(self.call.name, name, value, view.dtype)
                        if value.ndim > view.ndim:
                            return self._many(values)
                        value = _numbers(self.call.name, name, value, view.shape, view.dtype,
                                         self.call.symbols[name])
                    view[...] = value
            if not math.isfinite(self.arena.dot(self.arena)):
                self._refuse()
            for place, flag in self.flagged:
                if not self._wanted(flag, values[flag]):
                    arguments[place] = None
            results = arguments[self.results_at:]
            if self.call.struct:
                results = [(ctypes.c_void_p * len(results))(*results)]
            status = self.function(*arguments[:self.results_at], *results)
            if status or not math.isfinite(self.output.dot(self.output)):
                self._fail(status, arguments)
            return self.views[0].copy() if self.plain else self._results(arguments)

    def _convert(self, name, value):
        """An argument that is a number."""
        call = self.call.name
        return (_number(call, name, value) if name in _SCALARS else
                _axes(call, value) if name == "axes" else self.owner._body(value, call, name, name == "reference"))

    def _wanted(self, place, value):
        """Whether this value of a parameter asks for the results that it decides on."""
        if place not in self.call.keywords:
            return value is not None
        return value is True or _flag(self.call.name, self.call.keywords[place], value)

    def _results(self, arguments):
        """The results in memory of their own; None for those not wanted."""
        return self.call.results([None if argument is None else view.copy() if view.ndim else view.item()
                                  for argument, view in zip(arguments[self.results_at:], self.views)])

    def _refuse(self):
        """Names an input that is not finite, and forgets it."""
        try:
            for _, name, view, _ in self.inputs:
                if view is not None:
                    _finite(self.call.name, name, view)
        except ValueError:
            self.arena[...] = 0
            raise

    def _fail(self, status, arguments):
        """Raises the error of the call, if there is one, and forgets the results."""
        label = self.call.name
        if status == Status.ERR_RANGE:
            label += "".join(f": {name}" for name in self.call.inputs if name in _GAINS)
        try:
            if status:
                raise self.owner._error(label, status, self._results(arguments))
            for name, view in zip(self.call.outputs, self.views):
                _finite(self.call.name, name, view, FloatingPointError)
        except (RbdError, FloatingPointError):
            self.output[...] = 0
            raise

    def _many(self, values):
        """The same for many states: the arrays' axes before those of one state, broadcast. C computes them
        together where it has a batch of the call; else it is called for each."""
        call, owner = self.call, self.owner
        if not call.outputs:
            name, shape = next((name, np.shape(value)) for name, value in zip(call.inputs, values)
                               if np.ndim(value) > len(self.cores[name]))
            raise ValueError(f"{call.name}: {name} has the shape {shape}: this call takes one state, and "
                             "other calls read its results")
        blocks = bool(call.batch) and owner._layout() == "blocks"
        lanes = (owner.library.lanes,) if blocks else ()
        cores = {name: core + lanes for name, core in self.cores.items()}
        dtype, given = owner.library.dtype, dict(zip(call.inputs, values))
        loop, arrays = _broadcast(call.name, [
            (name, value, cores[name], call.symbols[name] + ("lanes",) * blocks)
            for name, value in given.items()
            if name not in _INTEGERS and (value is not None or name not in call.optional)], dtype)
        n = math.prod(loop)
        outputs = {name: np.zeros((n, *cores[name]), dtype) if flag is None or self._wanted(flag, values[flag])
                   else None for name, flag in zip(call.outputs, call.flags)}

        def results(found):
            return call.results([None if x is None else x.reshape(loop + x.shape[1:]) for x in found])

        if call.batch:
            return self._batch(arrays, outputs, loop, blocks, results)

        def one(k):
            found = self(*({**given, **{name: array[k] for name, array in arrays.items()}}).values(),
                         *values[len(given):])
            for array, result in zip(outputs.values(), found if call.tuple else [found]):
                if array is not None:
                    array[k] = result
        _for_each_state(loop, one)
        return results(outputs.values())

    def _batch(self, arrays, outputs, loop, blocks, results):
        """Calls C's batch."""
        call, owner = self.call, self.owner
        states = loop + (owner.library.lanes,) if blocks else loop
        inputs, function = [arrays.get(name) for name in call.inputs], call.name
        if isinstance(call.batch, str):
            function, v = call.batch, np.zeros((math.prod(states), owner.nv), owner.library.dtype)
            inputs += [v, None]
        memory = ["batch" if kind == "work" else f"batch_{kind}" for kind in call.memory]
        with owner._lock:
            layout = functools.partial(owner.library.call, "batch_set_layout", owner._address("batch"))
            layout(int(blocks))
            try:
                return owner._run(f"batch_{function}", memory, [math.prod(states), *inputs], outputs,
                                  results, call.name, states)
            finally:
                layout(0)


def _for_each_state(loop, one):
    """Calls one(k) for all states; an error says which state it was."""
    for k in range(math.prod(loop)):
        try:
            one(k)
        except (RbdError, FloatingPointError) as error:
            if loop:
                error.args, error.results = (f"{error}; state {_state(k, loop)}",), None
            raise


def _state(number, loop):
    """The index of a state, for messages."""
    return number if len(loop) < 2 else tuple(map(int, np.unravel_index(number, loop)))


class _Owner(_Declared):
    """What Model, ConstraintSet and ContactSet have in common: memory for C, and the calls in it."""

    def __init__(self, library, lock):
        self.library, self._lock = library, lock
        self._calls, self._memories, self._addresses = {}, {}, {}

    def _address(self, kind):
        """Where this part of memory is; prepared when it is first asked for."""
        if kind not in self._addresses:
            with self._lock:
                if kind not in self._addresses:
                    self._prepare(kind)
        return self._addresses[kind]

    def _bind(self, call):
        """A method's call, made when it is first asked for."""
        with self._lock:
            if call.name not in self._calls:
                self._calls[call.name] = _Bound(call, self)
        return self._calls[call.name]

    def _run(self, function, memory, inputs, outputs, results=tuple, call=None, states=None, pointers=None):
        """Calls C with arrays that are right: whole numbers and inputs, then outputs by name. Gives
        results(outputs), checked. call: the name for messages; states: of a batch, the axes of its states;
        pointers: what C takes behind the inputs, if not all outputs."""
        call = call or function
        with self._lock:
            addresses = map(self._address, ["model", *memory])
            status = self.library.call(function, *addresses, *inputs,
                                       *(outputs.values() if pointers is None else pointers))
            if status:
                raise self._error(call, status, results(outputs.values()), states)
        for name, array in outputs.items():
            if array is not None:
                _finite(call, name, array, FloatingPointError)
        return results(outputs.values())
