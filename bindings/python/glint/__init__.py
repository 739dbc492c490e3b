"""Glint: specular-shading hardware and fixed-point functions, bit-exact in NumPy.

    >>> import glint
    >>> core = glint.Core(device="cosine-power")
    >>> out = core(cos_gamma=[0.9, 0.99, 1.0], exponent=100, red=255, green=128, blue=0)
    >>> out["red_out"].tolist()
    [0.0, 136.0, 255.0]
    >>> core.bound < 1
    True

A core is a configuration: a TOML file, as `glint new` writes it, or a device with keys. It computes arrays by the golden model,
which the Verilog equals bit by bit, states the proved bound of its error, and gives the Verilog.
"""

import numbers
import json
import os
import re
import sys
from decimal import Decimal
from fractions import Fraction
from math import isfinite, ldexp

import numpy as np

from . import _glint

__all__ = ["Core", "Port", "UnitFunction", "devices", "expression", "function", "unit"]
__version__ = _glint.__version__


class Port:
    """An operand or an output: a name with a fixed-point format. A value is the raw integer times 2^-fraction."""

    def __init__(self, facts):
        self.name = facts["name"]
        self.width = facts["width"]
        self.fraction = facts["fraction"]
        self.signed = facts["signed"]
        #: The smallest and the largest raw integer for which the bound is stated; none of an output.
        self.domain = facts.get("domain")
        #: Whether the operand multiplies a reflectance.
        self.colour = facts.get("colour", False)
        self.doc = facts.get("doc", "")

    @property
    def limits(self):
        """The domain in values; none of an output."""
        return self.domain and tuple(ldexp(raw, -self.fraction) for raw in self.domain)

    def __repr__(self):
        integer = self.width - self.fraction - self.signed
        return f"<{self.name}: {'s' if self.signed else 'u'}{integer}.{self.fraction}>"


class Computation:
    """What a core and a function of a unit share: they compute arrays of points with a golden model, and know the proved bound.

    `_core` is the object of the extension module.
    """

    #: The operand that says how many results a computation has; only cores that walk lines have one.
    length = None

    def _set_ports(self):
        self.operands = {facts["name"]: Port(facts) for facts in self._core.operands()}
        self.outputs = {facts["name"]: Port(facts) for facts in self._core.outputs()}

    @property
    def bound(self):
        """The largest of `bounds`: no output is off by more, in units of its last place."""
        return max(self.bounds.values())

    @property
    def bounds(self):
        """The proved bound of each output's error by the output's name, in units of its last place."""
        return self._core.bound()["outputs"]

    @property
    def terms(self):
        """The terms of the bound that is nearest to its limit: key, what it is, units."""
        return self._core.bound()["terms"]

    def __call__(self, *columns, raw=False, **operands):
        """Computes many points by the golden model.

        An operand is a number or an array; what is not given is an error. Arrays are broadcast. The last axis of the array of a list has
        its numbers. They hold values, which are rounded to
        the format, or with `raw=True` raw integers, and so do the results: an array (of numbers alone, a number) of a core with one
        output, or a dictionary by output. Where an element of an operand is masked (`numpy.ma`), so are the results.
        Of a device that walks lines (`core.length`) a call is one line.
        """
        if self.length is not None:
            return self._line(self._columns(columns, operands, raw)[0], raw, False)
        return self._of_points("golden", columns, operands, raw)

    def exact(self, *columns, raw=False, **operands):
        """The formula in float64 at the operands after they are rounded to their formats; NaN where it has no value."""
        return self._of_points("exact", columns, operands, raw)

    def error(self, *columns, raw=False, **operands):
        """How far results are from the formula, in units of the outputs' last place: at most `bound` within the domain.

        NaN outside the condition `where` of an expression, where any result may come out."""
        return self._of_points("error", columns, operands, raw)

    def _of_points(self, what, columns, operands, raw):
        if self.length is not None:
            raise TypeError(f"{self.device} walks lines: its formula is that of their points")
        columns, shape, mask = self._columns(columns, operands, raw)
        return self._shaped(self._core.compute(columns, what, raw), shape, mask)

    def _columns(self, columns, operands, raw):
        """A number or a contiguous array for each operand, and the shape and the mask of the results."""
        names = list(self.operands)
        if len(columns) > len(names):
            raise TypeError(f"there are {len(columns)} operands; {self.name} has {', '.join(names)}")
        given = dict(zip(names, columns))
        for name, column in self._numbers(operands).items():
            if name not in self.operands:
                raise TypeError(f"there is no operand {name!r}; the operands are {', '.join(names)}")
            if name in given:
                raise TypeError(f"operand {name!r} is given twice")
            given[name] = column
        missing = [name for name in names if name not in given]
        if missing:
            raise TypeError(f"give {', '.join(missing)}: the operands are {', '.join(names)}")
        kind = np.int64 if raw else np.float64
        arrays = {name: _array(name, given[name], raw) for name in names}
        shape = np.broadcast_shapes(*(array.shape for array in arrays.values()))
        mask = None
        for name, array in arrays.items():
            if isinstance(array, np.ma.MaskedArray):
                hidden = np.broadcast_to(np.ma.getmaskarray(array), shape)
                mask = hidden if mask is None else mask | hidden
                # What a masked element holds is of no account; 0 is a number of every format.
                arrays[name] = array.filled(0)

        def column(array):
            if array.ndim == 0:
                return kind(array).item()
            whole = np.broadcast_to(array, shape) if array.shape != shape else array
            return np.require(whole, kind, ["C_CONTIGUOUS", "ALIGNED"]).reshape(-1)

        return [column(arrays[name]) for name in names], shape, mask

    def _numbers(self, operands):
        """The operands with a column for each number of a list: `v`, whose last axis has the numbers, becomes `v_0`, `v_1` and so on."""
        columns = {}
        for name, column in operands.items():
            ports = self._ports_of_list(name)
            if not ports:
                columns[name] = column
                continue
            array = np.asanyarray(column)
            if array.ndim == 0 or array.shape[-1] != len(ports):
                raise ValueError(f"operand {name!r}: the list has {len(ports)} numbers, and the array the shape {array.shape}")
            for at, port in enumerate(ports):
                if port in operands:
                    raise TypeError(f"operand {port!r} is given twice")
                columns[port] = array[..., at]
        return columns

    def _ports_of_list(self, name):
        """The operands that are the numbers of the list `name`; none if it is no list."""
        return [] if name in self.operands else _ports_of_list(name, self.operands)

    def _values(self, results):
        return [np.ldexp(raw.astype(np.float64), -port.fraction) for raw, port in zip(results, self.outputs.values())]

    def _shaped(self, results, shape, mask=None):
        results = [array.reshape(shape) if shape else array.item() for array in results]
        if mask is not None:
            results = [np.ma.array(array, mask=mask) for array in results]
        return results[0] if len(results) == 1 else Results(zip(self.outputs, results))


class Results(dict):
    """Results by output. The name of a list gives an array whose last axis has its numbers: `w_out`, for `w_0_out`, `w_1_out` and so on."""

    def __missing__(self, name):
        ports = _ports_of_list(name, self)
        if not ports:
            raise KeyError(f"there is no output {name!r}; the outputs are {', '.join(self)}")
        columns = [self[port] for port in ports]
        masked = any(isinstance(column, np.ma.MaskedArray) for column in columns)
        return (np.ma if masked else np).stack(columns, axis=-1)


class Core(Computation):
    """A configuration of a device.

    `Core("core.toml")` reads a file; `Core(device="lyon", **{"cosine.fraction": 16})` takes a device with keys, the others at
    their defaults. A key takes a number of Python, NumPy, `fractions` or `decimal`, exactly as it is, a text, a flag or a list.
    Raises ValueError with what is wrong and the remedy.

    A core can be copied and pickled: the copy is made of the same configuration.
    """

    def __init__(self, config=None, *, device=None, **keys):
        path = None if config is None else os.fspath(config)
        self._set(_glint.Core(path, device, {key: _plain(key, value) for key, value in keys.items()}))

    def _set(self, core, image=None):
        self._core = core
        # Of an image: the configuration of the core whose table it was made for, the formula and the error.
        self._image = image
        self._set_ports()
        #: The functions of a unit by name; none of another device.
        self.functions = {name: UnitFunction(function) for name, function in self._core.functions()}

    def __getstate__(self):
        return self._image or self.toml()

    def __setstate__(self, state):
        if isinstance(state, str):
            self._set(_glint.Core.from_toml(state))
            return
        toml, formula, error = state
        self._set(_glint.Core.from_toml(toml).image(formula, error), state)

    @property
    def name(self):
        """The name of the Verilog module."""
        return self._core.name

    @property
    def device(self):
        """The device, as `glint.devices()` lists it."""
        return self._core.device

    @property
    def latency(self):
        """Clocks from a start, or from a point that a pipeline takes, to the first results."""
        return self._core.clocks()[0]

    @property
    def interval(self):
        """Clocks from a point to the next."""
        return self._core.clocks()[1]

    def simulate(self, *columns, raw=False, **operands):
        """Computes as a call does, but by simulation of the netlist, clock by clock."""
        columns, shape, mask = self._columns(columns, operands, raw)
        if self.length is not None:
            return self._line(columns, raw, True)
        results = self._core.run(columns, True, raw)
        return self._shaped(results if raw else self._values(results), shape, mask)

    def cosim(self, points=10_000, seed=1):
        """Golden model against the simulated netlist on every clock of so many results; the first difference, or none."""
        return self._core.cosim(points, seed)

    def image(self, formula, error=None):
        """The core with another function of x in its table: the same datapath, other words in `table`, and a proved bound of its own.

        The table must be writable (`approximation.tables`). An error is raised if it cannot hold the function with an error below
        `error` units, or below `result.error` of the configuration.
        """
        core = Core.__new__(Core)
        toml = self._image[0] if self._image else self.toml()
        core._set(self._core.image(formula, error), (toml, formula, error))
        return core

    @property
    def table(self):
        """The words of a writable table: an array with the raw coefficients of each address, the constant first."""
        return np.array(self._core.table(), dtype=np.int64)

    def verilog(self):
        """The Verilog and the contents of the memories, by file name."""
        return self._core.verilog()

    def schedule(self):
        """A dictionary for each stage of a pipeline, or for each microinstruction."""
        return self._core.schedule()

    def estimate(self, target="ecp5"):
        """An estimate of look-up tables, DSP blocks, block RAMs and MHz on `ice40`, `ecp5` or `xilinx7`."""
        return self._core.estimate(target)

    def render(self, size=256, exponent=None, samples=2):
        """A lit sphere as an array of height, width and colour (uint8), its highlights by the golden model."""
        width, height = (size, size) if np.isscalar(size) else size
        return self._core.render((width, height), exponent, samples)

    def toml(self):
        """The configuration with all its keys."""
        return self._core.toml()

    @property
    def length(self):
        """The operand that says how many results a computation has, of a device that walks lines; otherwise none."""
        return self._core.length

    def __repr__(self):
        return f"<glint.Core {self.name}: {self.device}>"

    def __getattr__(self, name):
        """A function of a unit: `sfu.log2(2.0)`."""
        functions = self.__dict__.get("functions", {})
        if name in functions:
            return functions[name]
        raise AttributeError(f"{type(self).__name__!r} has no attribute {name!r}")

    def _line(self, columns, raw, simulated):
        if not all(np.isscalar(column) for column in columns):
            raise TypeError(f"{self.device} walks a line a call: give numbers")
        results = self._core.run(columns, simulated, raw)
        return self._shaped(results if raw else self._values(results), (-1,))


class UnitFunction(Computation):
    """A function of a unit, `sfu.functions["log2"]` or `sfu.log2`, with its own names and formats of operands and results.

    It computes as a core does. Its results equal those of the unit for its opcode, bit by bit.
    """

    def __init__(self, function):
        self._core = function
        self._set_ports()

    @property
    def name(self):
        """The name of the function."""
        return self._core.name

    @property
    def opcode(self):
        """The value of the unit's operand `opcode` that selects the function."""
        return self._core.opcode

    def simulate(self, *columns, raw=False, **operands):
        """Computes as a call does, but by simulation of the unit's netlist."""
        columns, shape, mask = self._columns(columns, operands, raw)
        results = self._core.simulate(columns, raw)
        return self._shaped(results if raw else self._values(results), shape, mask)

    def __repr__(self):
        return f"<glint.UnitFunction {self.name}: opcode {self.opcode}>"


def _ports_of_list(name, ports):
    """The ports that are the numbers of the list `name`; none if it is no list. The list `w_out` has `w_0_out`, `w_1_out` and so on."""
    whole = re.fullmatch("(.+?)(_out)?", name)
    base, end = whole[1], whole[2] or ""
    numbers = [port for port in ports if re.fullmatch(f"{re.escape(base)}(_[0-9]+|[a-z]){end}", port)]
    return numbers if len(numbers) > 1 else []


def _array(name, operand, raw):
    """An operand as an array of integers or of numbers that 64 bits hold."""
    array = np.asanyarray(operand)
    if array.dtype.kind == "O" and all(isinstance(number, numbers.Integral) for number in array.flat):
        first = next((number for number in array.flat if not -(2**63) <= number < 2**63), None)
        raise ValueError(f"operand {name!r}: {first} has more than 64 bits")
    if raw and array.dtype.kind not in "iub":
        raise TypeError(f"operand {name!r}: raw integers are wanted, not {array.dtype}")
    if array.dtype.kind not in "iubf":
        raise TypeError(f"operand {name!r}: numbers are wanted, not {array.dtype}")
    if raw and array.dtype.kind == "u" and array.size and np.max(array) >= 2**63:
        raise ValueError(f"operand {name!r}: {np.max(array)} has more than 63 bits")
    return array


#: The most fraction bits that an operand has: a float that is a multiple of their last place may be an operand.
_FRACTION = 40


def _plain(key, value):
    """The value of a key as an integer, a float, a text, a flag or a list; a number that decimals state exactly as it is."""
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if isinstance(value, (list, tuple)):
        return [_plain(key, each) for each in value]
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if isinstance(value, (bool, np.bool_)):
        return bool(value)
    if isinstance(value, numbers.Integral):
        return int(value)
    if isinstance(value, (float, np.floating)):
        if isfinite(value) and float(value) != value:
            raise ValueError(f"key {key!r}: {value!r} has more than 53 bits; give a fractions.Fraction")
        return _decimal(float(value)) if isfinite(value) else float(value)
    if isinstance(value, Fraction):
        exact = Decimal(value.numerator) / Decimal(value.denominator)
        if Fraction(exact) == value:
            return exact
        # A quotient is a formula; a key that takes numbers alone says so.
        return f"{value.numerator}/{value.denominator}"
    return value


def _decimal(value):
    """A float, or where its shortest digits would miss an operand that it is, all its digits."""
    exact = Decimal(value)
    is_operand = ldexp(value, _FRACTION) == int(ldexp(value, _FRACTION)) if abs(value) < 2**53 else False
    return exact if is_operand and Decimal(repr(value)) != exact else value


def devices():
    """The devices, by name, with what they compute."""
    return dict(_glint.devices())


def function(formula, low, high, *, fraction=None, error=None, **keys):
    """A core for a formula of `x` from `low` to `high`: `glint.function("1/sqrt(x)", 1, 4, fraction=16)(2.0)`.

    `fraction` is that of operand and result, `error` the largest error in units of the result's last place; other keys are
    those of the device `function`.
    """
    given = {"function.formula": formula, "function.from": low, "function.to": high}
    if fraction is not None:
        given |= {"operand.fraction": fraction, "result.fraction": fraction}
    if error is not None:
        given["result.error"] = error
    return Core(device="function", **{**given, **keys})


def expression(
    results,
    *,
    let=None,
    fraction=None,
    error=None,
    error_relative=None,
    where=None,
    keys=None,
    operands=None,
    **named_operands,
):
    """A core for formulas of several operands: `glint.expression("x / y", x=(0, 1, 16), y=(0.5, 1, 16), fraction=15)`.

    An operand is a domain with its fraction bits, `x=(-1, 1, 15)`, or its fields, `x={"bits": 16, "fraction": 15, "signed": True}`.
    `results` is a formula, whose result is named `r`, or a dictionary of formulas by name. A core with several results gives them
    under the names of their ports, `core(x, y)["r_out"]`. In place of a formula a result can have its fields, `{"formula": "x / y", "fraction": 15, "where": "y > x"}`; `fraction`, `where` and
    `error` or `error_relative` are for the results that do not state them. `let` has named parts, and `keys` any other keys, `{"architecture": "pipelined"}`.
    An operand whose name is a parameter of this function, such as `error`, goes into the dictionary `operands`: `operands={"error": (-1, 1, 15)}`.
    """
    tables = _statement(results, let, fraction, error, error_relative, where, operands, named_operands)
    lines = ['device = "expression"', 'name = "expression"']
    lines += [f"{key} = {_toml(key, value)}" for key, value in (keys or {}).items()]
    core = Core.__new__(Core)
    core._set(_glint.Core.from_toml("\n".join(lines + tables) + "\n"))
    return core


def unit(functions, *, keys=None):
    """A core of several functions, one at a time by an opcode: `glint.unit({"rcp": {"results": "1 / x", "x": (0.5, 1, 16), "fraction": 15}})`.

    A function is a dictionary of the parameters of `glint.expression`, or the path of a configuration of the device `expression`. The
    order of the dictionary is the order of the opcodes. `keys` has any other keys, `{"architecture": "pipelined"}`. Each function is an
    attribute of the core: `sfu.rcp(0.75)`, `sfu.rcp.bound`.
    """
    lines = ['device = "unit"', 'name = "unit"']
    lines += [f"{key} = {_toml(key, value)}" for key, value in (keys or {}).items()]
    for name, function in functions.items():
        if isinstance(function, (str, os.PathLike)):
            path = os.path.abspath(os.fspath(function))
            lines.append(f"functions.{name}.file = {_toml(f'functions.{name}.file', path)}")
            continue
        lines += [f"functions.{name}.{line}" for line in _statement_of(name, function)]
    core = Core.__new__(Core)
    core._set(_glint.Core.from_toml("\n".join(lines) + "\n"))
    return core


def _statement_of(name, function):
    """The tables of a function of a unit, from a dictionary of the parameters of `expression`."""
    shared = ("let", "fraction", "error", "error_relative", "where", "operands")
    given = dict(function)
    if "results" not in given:
        raise TypeError(f"function {name!r} has no results: give a formula, {{'results': '1 / x', 'x': (0.5, 1, 16)}}")
    results = given.pop("results")
    parameters = [given.pop(parameter, None) for parameter in shared]
    return _statement(results, *parameters, given)


def _statement(results, let, fraction, error, error_relative, where, operands, named_operands):
    """The tables `operands`, `let` and `results` of an expression, a line each entry."""
    if isinstance(results, str):
        results = {"r": results}
    shared = {"fraction": fraction, "error": error, "error_relative": error_relative, "where": where}
    shared = {field: value for field, value in shared.items() if value is not None}
    lines = []
    both = [name for name in operands or {} if name in named_operands]
    if both:
        raise TypeError(f"operand {both[0]!r} is given twice")
    for name, domain in {**(operands or {}), **named_operands}.items():
        if not isinstance(domain, dict):
            try:
                low, high, bits = domain
            except (TypeError, ValueError):
                words = f"operand {name!r} is {domain!r}; give (from, to, fraction bits), or a dictionary of its fields"
                raise TypeError(words) from None
            domain = {"from": low, "to": high, "fraction": bits}
        lines.append(f"operands.{name} = {_table(f'operands.{name}', domain)}")
    for name, formula in (let or {}).items():
        lines.append(f"let.{name} = {_toml(f'let.{name}', formula)}")
    for name, result in results.items():
        fields = {"formula": result} if isinstance(result, str) else result
        # A result that states an error, in units or as a part of its value, gets neither from the call.
        states_error = "error" in fields or "error_relative" in fields
        left_out = ("error", "error_relative") if states_error else ()
        given = {field: value for field, value in shared.items() if field not in left_out}
        lines.append(f"results.{name} = {_table(f'results.{name}', {**given, **fields})}")
    return lines


def _table(key, fields):
    """The fields of an entry as a table of TOML."""
    return "{ " + ", ".join(f"{name} = {_toml(f'{key}.{name}', value)}" for name, value in fields.items()) + " }"


def _toml(key, value):
    """The value of a key as TOML."""
    plain = _plain(key, value)
    if isinstance(plain, bool):
        return "true" if plain else "false"
    if isinstance(plain, str):
        return json.dumps(plain, ensure_ascii=False)
    if isinstance(plain, (int, float)):
        return repr(plain)
    if isinstance(plain, Decimal):
        # All digits, as a formula of a number.
        return json.dumps(format(plain, "f"))
    raise ValueError(f"key {key!r}: {value!r} is no value of a key")


def main():
    """The command `glint`."""
    sys.exit(_glint.run_command(["glint", *sys.argv[1:]]))
