"""Drives a core that Glint generated from Python. All facts come from the manifest of the core.

`Manifest` reads rtl_out/<name>/<name>.json. `Core` drives a core with a microprogram, and
`Pipeline` drives a pipeline. Both check the handshake in every clock. `Stream` and `Registers`
drive the cores with these interfaces. The tests below apply to every core of their kind. A bench,
such as testbench/<name>/test_<name>.py, imports the tests, adds its own, and calls `run`.

Inputs change after the falling edge of the clock. Outputs are read at the rising edge, with their
values before the edge. The module needs cocotb 2.1 and Icarus Verilog; cocotb 2.1 refuses Verilator
before 5.036.

Generated files belong to their user, without conditions.
"""

from __future__ import annotations

import json
import math
import random
import shutil
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, RisingEdge

ROOT = Path(__file__).resolve().parents[1]
"""The directory with rtl_out/ and testbench/."""

LONGEST = 1 << 16
"""A number of clocks within which every computation ends."""

Raw = dict[str, int]
"""The raw integer on each port, by name."""


@dataclass
class Computation:
    """The outputs of one computation. Clock 0 is the clock in which the core accepts `start`."""

    valid: list[int]
    """The clocks in which `valid` is high."""
    results: list[Raw]
    """The outputs in each clock of `valid`."""
    done: int
    """The clock in which `done` is high."""


class Manifest:
    """The manifest of a core: ports, timing, accuracy, and computations with their results."""

    def __init__(self, name: str) -> None:
        """Reads the manifest of core `name`."""
        self.directory = ROOT / "rtl_out" / name
        facts = json.loads((self.directory / f"{name}.json").read_text(encoding="utf-8"))
        self.ports: dict[str, dict[str, Any]] = {port["name"]: port for port in facts["ports"]}
        self.sources = [self.directory / file for file in facts["files"]["rtl"]]
        self.wrappers = [self.directory / file for file in facts["files"].get("wrappers", [])]
        self.memories = [self.directory / file for file in facts["files"]["memories"]]
        self.registers: dict[str, dict[str, Any]] = {
            register["name"]: register for register in facts.get("registers", [])
        }
        self.timing: dict[str, int | None] = facts["timing"]
        self.overlaps: bool = facts.get("control", {}).get("operands_buffered", False)
        """Whether the core accepts `start` in the clock of `done` too."""
        self.latency: int | None = facts.get("pipeline", {}).get("latency")
        self.interval: int = facts.get("pipeline", {}).get("interval", 1)
        """The least number of clocks from one point to the next."""
        accuracy = facts["accuracy"]
        self.domain: dict[str, dict[str, int]] = accuracy["domain"]
        self.outputs: dict[str, str | None] = accuracy["outputs"]
        self.length: str | None = accuracy.get("length")
        self.bounds: dict[str, float] = accuracy["bounds"]
        self.computations: list[tuple[Raw, Computation]] = [
            self._computation(facts["computations"], point)
            for point in facts["computations"]["points"]
        ]
        expressions: list[str] = accuracy["f"]
        self._f = [compile(text, f"f of {name}", "eval") for text in expressions]
        self._where = {
            output: compile(text, f"condition of {output}", "eval")
            for output, text in accuracy.get("where", {}).items()
        }
        self._names: dict[str, Any] = {"__builtins__": {}, **vars(math)}
        self._names.update(min=min, max=max, abs=abs, int=int, ln=math.log)
        for rom in facts["roms"]:
            if any(rom["name"] in code.co_names for code in self._f):
                self._names[rom["name"]] = self._words(rom)

    def _computation(self, table: dict[str, Any], point: dict[str, Any]) -> tuple[Raw, Computation]:
        operands = dict(zip(table["operands"], point["operands"], strict=True))
        results = [dict(zip(table["results"], row, strict=True)) for row in point["results"]]
        return operands, Computation(point["valid"], results, point["done"])

    def _words(self, rom: dict[str, Any]) -> list[float]:
        """Returns the words of a ROM as numbers. `format` is u<integer bits>.<fraction bits>."""
        fraction_bits = int(rom["format"].rpartition(".")[2])
        if "words" in rom:  # The contents of this ROM are in the Verilog.
            return [word / 2**fraction_bits for word in rom["words"]]
        lines = (self.directory / rom["file"]).read_text(encoding="utf-8").splitlines()
        words = [line.partition("//")[0].replace("_", "").strip() for line in lines]
        return [int(word, rom["radix"]) / 2**fraction_bits for word in words if word]

    def named(self, role: str) -> str:
        """Returns the name of the only port with a role."""
        (name,) = (name for name, port in self.ports.items() if port["role"] == role)
        return name

    def value(self, name: str, raw: int) -> float:
        """Returns the value of a raw integer on a port."""
        return raw / 2 ** self.ports[name]["fraction_bits"]

    def result_count(self, operands: Mapping[str, int]) -> int:
        """Returns the number of results of a computation."""
        return 1 if self.length is None else operands[self.length] + 1

    def f(self, operands: Mapping[str, int], index: int) -> list[float]:
        """Returns the right values of f in result number `index`: one, or two at a jump of f."""
        return [self._evaluated(code, operands, index) for code in self._f]

    def _evaluated(self, code: Any, operands: Mapping[str, int], index: int) -> Any:
        values = {name: self.value(name, raw) for name, raw in operands.items()}
        return eval(code, self._names, values | {"index": index})

    def _right(
        self, number: int, operands: Mapping[str, int], index: int, values: list[float]
    ) -> list[float]:
        """Returns the right values of output `number` in units, or an empty list if none is promised."""
        output = list(self.outputs)[number]
        operand = self.outputs[output]
        if operand is not None:
            return [operands[operand] * f for f in values]
        where = self._where.get(output)
        if where is not None and not self._evaluated(where, operands, index):
            return []
        value = self._evaluated(self._f[number], operands, index)
        return [value * 2 ** self.ports[output]["fraction_bits"]]

    def error(self, operands: Mapping[str, int], index: int, result: Raw) -> float:
        """Returns the largest error of an output in result number `index`, as a part of its bound.

        For example, 0.5 means that the error is half of the bound. Raises AssertionError if an
        error exceeds the bound of its output in the manifest.
        """
        is_highlight = any(operand is not None for operand in self.outputs.values())
        values, worst = self.f(operands, index) if is_highlight else [], 0.0
        for number, output in enumerate(self.outputs):
            right = self._right(number, operands, index, values)
            if not right:
                continue
            error = min(abs(result[output] - value) for value in right)
            bound = self.bounds[output]
            assert error <= bound, (
                f"{output} is {result[output]}, off by {error} units at {operands}, "
                f"result {index}; the bound is {bound}"
            )
            worst = max(worst, error / bound if bound else 0.0)
        return worst

    def draw(self, source: random.Random) -> Raw:
        """Draws operands of the domain. The length of a line is at most 12 above its minimum.

        For most operands of a domain f is 0. Therefore three of four draws start from a
        computation of the manifest and change each operand by a random amount, until f is between
        0 and 1.
        """
        if source.randrange(4) == 0:
            return self._anywhere(source)
        for _ in range(8):
            operands, _ = source.choice(self.computations)
            drawn = self._near(source, operands)
            if None in self.outputs.values() or any(0 < f < 1 for f in self.f(drawn, 0)):
                break
        return drawn

    def _near(self, source: random.Random, operands: Raw) -> Raw:
        """Draws operands near the given ones."""
        drawn = {}
        for name, raw in operands.items():
            low, high = self.domain[name]["low"], self.domain[name]["high"]
            if name == self.length:
                high = min(high, low + 12)
            off = source.randrange(1 << source.randint(0, (high - low).bit_length()))
            drawn[name] = min(max(raw + source.choice((-off, 0, off)), low), high)
        return drawn

    def _anywhere(self, source: random.Random) -> Raw:
        """Draws each operand independently, about half of them near 0 or an end of the domain."""
        operands = {}
        for name, domain in self.domain.items():
            low, high = domain["low"], domain["high"]
            if name == self.length:
                high = min(high, low + 12)
            off = source.randrange(1 << source.randint(0, (high - low).bit_length()))
            near = [low + off, high - off, off, -off]
            chosen = source.choice(near + 4 * [source.randint(low, high)])
            operands[name] = min(max(chosen, low), high)
        return operands


class Core:
    """Drives the inputs of a core and checks its handshake."""

    def __init__(self, dut: Any, seed: int = 1) -> None:
        """Prepares to drive the inputs of `dut`. `seed` determines all random choices."""
        self.dut = dut
        self.manifest = Manifest(dut._name)
        self.random = random.Random(seed)
        self.clocks = 0
        self._busy: bool | None = None
        """The value that `busy` must have in the next clock, or None before the first reset."""
        self._age = 0
        """The number of the next clock of the current computation."""
        roles = {port["role"]: name for name, port in self.manifest.ports.items()}
        self._clk = getattr(dut, roles["clock"])
        self._rst_n = getattr(dut, roles["reset"])
        self._start = getattr(dut, roles["start"])
        self._handshake = {role: getattr(dut, roles[role]) for role in ("valid", "busy", "done")}
        self._operands = [
            (name, getattr(dut, name), getattr(dut, self.manifest.ports[name]["strobe"]))
            for name in self.manifest.domain
        ]

    @classmethod
    async def after_reset(cls, dut: Any, seed: int = 1) -> Core:
        """Starts the clock, resets the core, and returns its driver."""
        core = cls(dut, seed)
        Clock(core._clk, 10, unit="ns").start(start_high=False)
        await core.reset()
        return core

    async def reset(self) -> None:
        """Resets the core for one clock."""
        await self.clock(rst_n=0)

    async def clock(
        self, *, start: int = 0, writes: Mapping[str, int] | None = None, rst_n: int = 1
    ) -> dict[str, int]:
        """Runs one clock with these inputs, and returns the handshake outputs in it.

        While the strobe of an operand is low, its input carries random bits.
        """
        writes = writes or {}
        await FallingEdge(self._clk)
        self._rst_n.value = rst_n
        self._start.value = start
        for name, data, strobe in self._operands:
            written = name in writes
            strobe.value = int(written)
            noise = self.random.getrandbits(len(data))
            data.value = writes[name] & ((1 << len(data)) - 1) if written else noise
        await RisingEdge(self._clk)
        self.clocks += 1
        if self._busy is None:
            seen = {"valid": 0, "busy": 0, "done": 0}
        else:
            seen = {name: int(handle.value) for name, handle in self._handshake.items()}
            self._check(seen)
        self._follow(bool(start), bool(rst_n), seen)
        return seen

    def _check(self, seen: Mapping[str, int]) -> None:
        """Checks the handshake of this clock against the clocks before and the manifest."""
        at = f"clock {self.clocks} after the beginning, {self._age} after start"
        assert seen["busy"] == self._busy, f"busy is {seen['busy']}, {at}"
        if not seen["busy"]:
            assert not seen["valid"] and not seen["done"], f"{seen} while idle, {at}"
            return
        latest = self.manifest.timing.get("start_to_done_at_most")
        assert latest is None or self._age <= latest, f"not done by now, {at}"
        done, first = self.manifest.timing["start_to_done"], self.manifest.timing["start_to_valid"]
        if done is not None:
            assert seen["done"] == (self._age == done), f"done is {seen['done']}, {at}"
        if first is not None:
            # There is one result, or one result every `every` clocks.
            every = self.manifest.timing.get("valid_to_valid")
            due = self._age == first
            if every and self._age > first:
                due = bool(seen["valid"]) and (self._age - first) % every == 0
            assert seen["valid"] == due, f"valid is {seen['valid']}, {at}"

    def _follow(self, start: bool, rst_n: bool, seen: Mapping[str, int]) -> None:
        if not rst_n:
            self._busy, self._age = False, 0
        elif not self._busy:
            self._busy, self._age = (start, 1) if self._busy is not None else (None, 0)
        elif seen["done"] and self.manifest.overlaps:
            self._busy, self._age = start, 1
        else:
            self._busy, self._age = not seen["done"], self._age + 1

    def outputs(self) -> Raw:
        """Returns the current values of the outputs."""
        return outputs(self.dut, self.manifest)

    async def write_in_parts(self, operands: Mapping[str, int]) -> Raw:
        """Writes some operands in separate clocks, with pauses. Returns the other operands."""
        left = dict(operands)
        for name in self.random.sample(list(left), self.random.randint(0, len(left))):
            await self.clock(writes={name: left.pop(name)})
            for _ in range(self.random.choice((0, 0, 0, 1, 3))):
                await self.clock()
        return left

    async def compute(self, **operands: int) -> Computation:
        """Writes the operands together with `start`, and waits until the computation ends."""
        await self.clock(start=1, writes=operands)
        return await self.finish()

    async def finish(self, disturbed: bool = False) -> Computation:
        """Waits until the computation ends, and returns its outputs.

        If `disturbed`, writes and starts arrive in every clock, which the core must ignore.
        """
        valid: list[int] = []
        results: list[Raw] = []
        for clock in range(1, LONGEST):
            writes = self.manifest.draw(self.random) if disturbed else {}
            seen = await self.clock(start=int(disturbed), writes=writes)
            if seen["valid"]:
                valid.append(clock)
                results.append(self.outputs())
            if seen["done"]:
                return Computation(valid, results, clock)
        raise AssertionError(f"not done within {LONGEST} clocks")


class Pipeline:
    """Drives a pipeline: offers points, accepts results, and tracks the points in its stages."""

    def __init__(self, dut: Any, seed: int = 1) -> None:
        """Prepares to drive the inputs of `dut`. `seed` determines all random choices."""
        self.dut = dut
        self.manifest = Manifest(dut._name)
        self.random = random.Random(seed)
        self.clocks = 0
        latency = self.manifest.latency
        assert latency is not None, f"the manifest of {dut._name} has no pipeline"
        self._stages: list[tuple[Raw, int] | None] = [None] * latency
        """The point in each stage, with its side value. The outputs belong to the last stage."""
        self._slot = 0
        """The current slot. The pipeline accepts a point only in slot 0."""
        self._known = False
        """Whether the pipeline has been reset."""
        self._waiting: Raw | None = None
        """The results that had to wait in the clock before, or None."""
        ports = {port["role"]: getattr(dut, name) for name, port in self.manifest.ports.items()}
        self._clk, self._rst_n = ports["clock"], ports["reset"]
        self._in_valid, self._out_valid = ports["in_valid"], ports["valid"]
        # Only a pipeline that can stall, or that has a side channel, has these ports.
        self._in_ready, self._out_ready = ports.get("in_ready"), ports.get("out_ready")
        self._side_in, self._side_out = ports.get("side_in"), ports.get("side_out")
        self._operands = [(name, getattr(dut, name)) for name in self.manifest.domain]

    @classmethod
    async def after_reset(cls, dut: Any, seed: int = 1) -> Pipeline:
        """Starts the clock, resets the pipeline, and returns its driver."""
        pipeline = cls(dut, seed)
        Clock(pipeline._clk, 10, unit="ns").start(start_high=False)
        await pipeline.clock(rst_n=0)
        return pipeline

    @property
    def stalls(self) -> bool:
        """Whether the pipeline can stall."""
        return self._out_ready is not None

    @property
    def occupied(self) -> bool:
        """Whether a stage holds a point."""
        return any(point is not None for point in self._stages)

    async def clock(
        self, point: Mapping[str, int] | None = None, *, ready: int = 1, rst_n: int = 1
    ) -> tuple[bool, tuple[Raw, Raw] | None]:
        """Runs one clock that offers `point` and accepts results if `ready` is 1.

        Returns whether the pipeline accepted the point, and the point that left the pipeline with
        its results, or None. Without a point, the operands carry random bits.
        """
        ready = ready if self.stalls else 1
        await FallingEdge(self._clk)
        self._rst_n.value = rst_n
        self._in_valid.value = int(point is not None)
        if self._out_ready is not None:
            self._out_ready.value = ready
        for name, data in self._operands:
            bits = self.random.getrandbits(len(data)) if point is None else point[name]
            data.value = bits & ((1 << len(data)) - 1)
        side = 0
        if self._side_in is not None:
            side = self.random.getrandbits(len(self._side_in))
            self._side_in.value = side
        await RisingEdge(self._clk)
        self.clocks += 1
        shown = self._check(ready) if self._known else None
        moves = bool(ready) or self._stages[-1] is None
        takes = moves and self._slot == 0
        left = self._stages[-1] if moves else None
        if moves:
            taken = (dict(point), side) if takes and point is not None else None
            self._stages = [taken, *self._stages[:-1]]
            self._slot = (self._slot + 1) % self.manifest.interval
        self._waiting = None if moves else shown
        if not rst_n:
            self._stages, self._waiting = [None] * len(self._stages), None
            self._known, self._slot = True, 0
        return takes and bool(rst_n), None if left is None or shown is None else (left[0], shown)

    def _check(self, ready: int) -> Raw | None:
        """Checks the handshake against the tracked points. Returns the results on the outputs."""
        at = f"clock {self.clocks}"
        last = self._stages[-1]
        valid = int(self._out_valid.value)
        assert valid == (last is not None), f"out_valid is {valid}, {at}"
        if self._in_ready is not None:
            in_ready = int(self._in_ready.value)
            takes = (ready or not valid) and self._slot == 0
            assert in_ready == takes, f"in_ready is {in_ready}, {at}"
        if last is None:
            return None
        if self._side_out is not None:
            side = int(self._side_out.value)
            came = last[1]
            assert side == came, f"side_out is {side} with a point that came with {came}, {at}"
        shown = self.outputs()
        assert self._waiting in (None, shown), f"{self._waiting} changed while it waited, {at}"
        return shown

    def outputs(self) -> Raw:
        """Returns the current values of the outputs."""
        return outputs(self.dut, self.manifest)

    async def compute(self, **operands: int) -> Raw:
        """Runs one point alone through the pipeline, and returns its results."""
        taken = False
        for _ in range(self.manifest.interval):
            if not taken:
                taken, _ = await self.clock(operands)
        assert taken, "a pipeline without points takes one"
        while self.occupied:
            _, shown = await self.clock()
            if shown is not None:
                return shown[1]
        raise AssertionError("no results")

    async def through(self, points: list[Raw], offer: int = 1, take: int = 1) -> list[Raw]:
        """Runs points through the pipeline, and returns their results.

        In each clock, a point is offered with probability 1/`offer`, and a result is accepted with
        probability 1/`take`.
        """
        results: list[Raw] = []
        left = list(points)
        offered: Raw | None = None
        while left or offered is not None or self.occupied:
            if offered is None and left and self.random.randrange(offer) == 0:
                offered = left.pop(0)
            ready = int(self.random.randrange(take) == 0)
            taken, shown = await self.clock(offered, ready=ready)
            if taken:
                offered = None
            if shown is not None:
                assert shown[0] == points[len(results)], f"{shown[0]} came out of its turn"
                results.append(shown[1])
        return results


class Stream:
    """Sends to and receives from a core with AXI4-Stream interfaces."""

    def __init__(self, dut: Any, seed: int = 1) -> None:
        """Prepares to drive the inputs of `dut`. `seed` determines all random choices."""
        self.dut = dut
        self.manifest = Manifest(dut._name.removesuffix("_axis"))
        self.random = random.Random(seed)
        self._operands = [name for name in self.manifest.ports if name in self.manifest.domain]
        self._results = [
            name for name, port in self.manifest.ports.items() if port["role"] == "result"
        ]

    @classmethod
    async def after_reset(cls, dut: Any, seed: int = 1) -> Stream:
        """Starts the clock, resets the core, and returns its driver."""
        stream = cls(dut, seed)
        Clock(dut.aclk, 10, unit="ns").start(start_high=False)
        await stream.reset()
        return stream

    async def reset(self) -> None:
        """Resets the core for two clocks."""
        for _ in range(2):
            await FallingEdge(self.dut.aclk)
            self.dut.aresetn.value = 0
            self.dut.s_axis_tvalid.value = 0
            self.dut.m_axis_tready.value = 0

    def _bits(self, name: str) -> int:
        """Returns the width of a port, rounded up to whole bytes, in bits."""
        return -(-self.manifest.ports[name]["width"] // 8) * 8

    def packed(self, operands: Mapping[str, int]) -> int:
        """Packs operands into a word, with random bits as padding."""
        word, low = 0, 0
        for name in self._operands:
            width, bits = self.manifest.ports[name]["width"], self._bits(name)
            above = self.random.getrandbits(bits) >> width << width
            word |= (operands[name] & ((1 << width) - 1) | above) << low
            low += bits
        return word | self.random.getrandbits(len(self.dut.s_axis_tdata)) >> low << low

    def unpacked(self, word: int) -> Raw:
        """Unpacks the results of a word. Checks that the padding is 0 or copies of the sign."""
        results = {}
        for name in self._results:
            bits = self._bits(name)
            value = word & ((1 << bits) - 1)
            negative = self.manifest.ports[name]["signed"] and value >> (bits - 1)
            results[name] = value - (1 << bits) if negative else value
            word >>= bits
        assert word == 0, f"{word} above the results"
        return {name: results[name] for name in self.manifest.outputs}

    async def through(
        self, points: list[Raw], offer: int = 1, take: int = 1
    ) -> list[tuple[Raw, int, bool]]:
        """Sends points, and returns the transfers that come back, each with tuser and tlast.

        The tuser of a sent point is its number. In each clock, a point is offered with probability
        1/`offer`, and a transfer is accepted with probability 1/`take`.
        """
        dut, got = self.dut, []
        count = sum(self.manifest.result_count(point) for point in points)
        users = 1 << len(dut.s_axis_tuser)
        at, offered, waiting = 0, False, None
        for _ in range(LONGEST):
            await FallingEdge(dut.aclk)
            dut.aresetn.value = 1
            offered = offered or at < len(points) and self.random.randrange(offer) == 0
            dut.s_axis_tvalid.value = int(offered)
            dut.s_axis_tuser.value = at % users
            if hasattr(dut, "s_axis_tkeep"):
                dut.s_axis_tkeep.value = self.random.getrandbits(len(dut.s_axis_tkeep))
            if offered:
                dut.s_axis_tdata.value = self.packed(points[at])
            else:
                dut.s_axis_tdata.value = self.random.getrandbits(len(dut.s_axis_tdata))
            if self.manifest.length is None:
                dut.s_axis_tlast.value = at % 3 == 0
            ready = self.random.randrange(take) == 0
            dut.m_axis_tready.value = int(ready)
            await RisingEdge(dut.aclk)
            if dut.m_axis_tvalid.value == 1:
                if hasattr(dut, "m_axis_tkeep"):
                    assert int(dut.m_axis_tkeep.value) + 1 == 1 << len(dut.m_axis_tkeep)
                data, user = int(dut.m_axis_tdata.value), int(dut.m_axis_tuser.value)
                shown = (self.unpacked(data), user, bool(dut.m_axis_tlast.value))
                assert waiting in (None, shown), f"{waiting} changed while it waited"
                waiting = None if ready else shown
                if ready:
                    got.append(shown)
            else:
                assert waiting is None, f"{waiting} was not taken"
            if offered and dut.s_axis_tready.value == 1:
                at, offered = at + 1, False
            if len(got) == count:
                return got
        raise AssertionError(f"{len(got)} transfers of {count} within {LONGEST} clocks")


class BusError(Exception):
    """The core answered an access with an error."""


class Registers:
    """The bus master of a core with registers."""

    def __init__(self, dut: Any, seed: int = 1) -> None:
        """Prepares to drive the inputs of `dut`. `seed` determines all random choices."""
        self.dut = dut
        self.wishbone = dut._name.endswith("_wb")
        self.manifest = Manifest(dut._name.rpartition("_")[0])
        self.random = random.Random(seed)
        self._clk = dut.wb_clk_i if self.wishbone else dut.aclk
        self._taken: set[str] = set()
        """The channels of AXI4-Lite that accepted their part of the request."""

    @classmethod
    async def after_reset(cls, dut: Any, seed: int = 1) -> Registers:
        """Starts the clock, resets the core, and returns its driver."""
        registers = cls(dut, seed)
        Clock(registers._clk, 10, unit="ns").start(start_high=False)
        reset, level = (dut.wb_rst_i, 1) if registers.wishbone else (dut.aresetn, 0)
        registers._idle()
        reset.value = level
        for _ in range(3):
            await FallingEdge(registers._clk)
        reset.value = 1 - level
        return registers

    def _idle(self) -> None:
        names = ("wb_cyc_i", "wb_stb_i") if self.wishbone else tuple(
            f"s_axil_{name}" for name in ("awvalid", "wvalid", "bready", "arvalid", "rready")
        )
        for name in names:
            getattr(self.dut, name).value = 0

    async def access(self, offset: int, data: int | None = None, lanes: int = 15) -> int:
        """Writes the byte lanes `lanes` of a register, or reads it if `data` is None.

        Returns the word that was read, or 0. Raises BusError if the core answers with an error.
        """
        one = self._wishbone if self.wishbone else self._axi_lite
        for _ in range(LONGEST):
            await FallingEdge(self._clk)
            answer = await one(offset, data, lanes)
            if answer is not None:
                await FallingEdge(self._clk)
                self._idle()
                if answer < 0:
                    raise BusError(offset)
                return answer
        raise AssertionError(f"no answer within {LONGEST} clocks")

    async def _wishbone(self, offset: int, data: int | None, lanes: int) -> int | None:
        dut = self.dut
        dut.wb_cyc_i.value = dut.wb_stb_i.value = 1
        dut.wb_we_i.value = int(data is not None)
        dut.wb_adr_i.value = offset
        dut.wb_dat_i.value = data or 0
        dut.wb_sel_i.value = lanes
        await RisingEdge(self._clk)
        if dut.wb_err_o.value == 1:
            return -1
        if dut.wb_ack_o.value != 1:
            return None
        return 0 if data is not None else int(dut.wb_dat_o.value)

    async def _axi_lite(self, offset: int, data: int | None, lanes: int) -> int | None:
        dut, writes = self.dut, data is not None
        channels = ("aw", "w") if writes else ("ar",)
        for channel in channels:
            # An accepted request must not be offered again before the answer.
            getattr(dut, f"s_axil_{channel}valid").value = int(channel not in self._taken)
        (dut.s_axil_awaddr if writes else dut.s_axil_araddr).value = offset
        dut.s_axil_awprot.value = dut.s_axil_arprot.value = 0
        dut.s_axil_wdata.value, dut.s_axil_wstrb.value = data or 0, lanes
        ready = self.random.getrandbits(1)
        (dut.s_axil_bready if writes else dut.s_axil_rready).value = ready
        await RisingEdge(self._clk)
        for channel in channels:
            if getattr(dut, f"s_axil_{channel}ready").value == 1:
                self._taken.add(channel)
        if not ready or (dut.s_axil_bvalid if writes else dut.s_axil_rvalid).value != 1:
            return None
        self._taken.clear()
        if (dut.s_axil_bresp if writes else dut.s_axil_rresp).value != 0:
            return -1
        return 0 if writes else int(dut.s_axil_rdata.value)

    async def write(self, name: str, value: int, lanes: int = 15) -> None:
        """Writes a register by name."""
        await self.access(self.manifest.registers[name]["offset"], value & 0xFFFFFFFF, lanes)

    async def read(self, name: str) -> int:
        """Reads a register by name."""
        return await self.access(self.manifest.registers[name]["offset"])

    def parts(self, port: str) -> list[str]:
        """Returns the names of the registers of a port, the lowest bits first."""
        registers = self.manifest.registers
        return [port] if port in registers else [it for it in registers if it[:-2] == port]

    async def write_operands(self, operands: Mapping[str, int]) -> None:
        """Writes every operand."""
        for name, value in operands.items():
            for number, part in enumerate(self.parts(name)):
                await self.write(part, value >> 32 * number)

    async def results(self) -> Raw:
        """Reads the results. The read waits until the computation has ended."""
        ports, registers, results = self.manifest.ports, self.manifest.registers, {}
        for name in self.manifest.outputs:
            if "results" in registers:
                (bits,) = (it for it in registers["results"]["bits"] if it["name"] == name)
                value = await self.read("results") >> bits["low"]
            else:
                words = [await self.read(part) for part in self.parts(name)]
                value = sum(word << 32 * number for number, word in enumerate(words))
            width = ports[name]["width"]
            value &= (1 << width) - 1
            negative = ports[name]["signed"] and value >> (width - 1)
            results[name] = value - (1 << width) if negative else value
        return results


def outputs(dut: Any, manifest: Manifest) -> Raw:
    """Returns the current values of the outputs."""
    results = {}
    for name in manifest.outputs:
        value = getattr(dut, name).value
        signed = manifest.ports[name]["signed"]
        results[name] = value.to_signed() if signed else value.to_unsigned()
    return results


@cocotb.test()
async def computations_are_exact(dut: Any) -> None:
    """Every computation of the manifest has its results, clocks of `valid` and clock of `done`."""
    core = await Core.after_reset(dut)
    for operands, wanted in core.manifest.computations:
        left = await core.write_in_parts(operands)
        assert await core.compute(**left) == wanted, f"{operands}: not {wanted}"
    dut._log.info("%d computations in %d clocks", len(core.manifest.computations), core.clocks)


@cocotb.test()
async def writes_and_starts_while_busy_are_ignored(dut: Any) -> None:
    """Writes and starts during a computation change neither the operands nor the results."""
    core = await Core.after_reset(dut)
    for operands, wanted in core.manifest.computations:
        await core.clock(start=1, writes=operands)
        assert await core.finish(disturbed=True) == wanted, f"{operands}, disturbed: not {wanted}"
        # The operands are unchanged, so a start alone repeats the computation.
        assert await core.compute() == wanted, f"{operands}, a second time: not {wanted}"


@cocotb.test()
async def writes_while_busy_are_for_the_next_computation(dut: Any) -> None:
    """Operands written during a computation belong to the next one, which starts with `done`."""
    core = await Core.after_reset(dut)
    computations = core.manifest.computations
    await core.clock(start=1, writes=computations[0][0])
    for number, (operands, wanted) in enumerate(computations, 1):
        last = number == len(computations)
        left = [] if last else list(computations[number][0].items())
        valid, results = [], []
        for clock in range(1, wanted.done + 1):
            is_done = clock == wanted.done
            now = list(left) if is_done else left[:1]
            del left[: len(now)]
            # The core must ignore a start before the last clock.
            start = not last if is_done else core.random.getrandbits(1)
            seen = await core.clock(start=int(start), writes=dict(now))
            if seen["valid"]:
                valid.append(clock)
                results.append(core.outputs())
        assert Computation(valid, results, clock) == wanted, f"{operands}: not {wanted}"


@cocotb.test()
async def held_start_repeats(dut: Any) -> None:
    """A constant `start` repeats the computation: the core accepts it after or with `done`."""
    core = await Core.after_reset(dut)
    for operands, wanted in core.manifest.computations:
        period = wanted.done if core.manifest.overlaps else wanted.done + 1
        assert core.manifest.timing["start_to_start"] in (None, period)
        await core.clock(writes=operands)
        for clock in range(3 * period):
            seen = await core.clock(start=1)
            age = clock % period
            if core.manifest.overlaps and clock and age == 0:
                age = period
            expected = {
                "valid": int(age in wanted.valid),
                "busy": int(age > 0),
                "done": int(age == wanted.done),
            }
            assert seen == expected, f"{operands}: {seen} in clock {age}"
            if seen["valid"]:
                assert core.outputs() == wanted.results[wanted.valid.index(age)]


@cocotb.test()
async def reset_ends_a_computation(dut: Any) -> None:
    """A reset in any clock makes the core idle, and the next computation is right."""
    core = await Core.after_reset(dut)
    operands, wanted = max(core.manifest.computations, key=lambda pair: len(pair[1].valid))
    for age in range(wanted.done + 1):
        await core.clock(start=1, writes=operands)
        for _ in range(age):
            await core.clock()
        await core.reset()
        for _ in range(3):
            assert not any((await core.clock()).values())
        assert await core.compute(**operands) == wanted, f"after a reset in clock {age}"


@cocotb.test()
async def formula_holds_at_random_points(dut: Any) -> None:
    """At random points, the error against the formula in floats is within the bound."""
    core = await Core.after_reset(dut, seed=2)
    manifest = core.manifest
    worst = 0.0
    for _ in range(250):
        operands = manifest.draw(core.random)
        left = await core.write_in_parts(operands)
        shown = await core.compute(**left)
        assert len(shown.results) == manifest.result_count(operands), f"{operands}: {shown}"
        for index, result in enumerate(shown.results):
            worst = max(worst, manifest.error(operands, index, result))
    dut._log.info("the worst error is %.3f of its bound", worst)


@cocotb.test()
async def points_are_exact(dut: Any) -> None:
    """Every computation of the manifest is exact at the full rate, after the promised latency."""
    pipeline = await Pipeline.after_reset(dut)
    points = [operands for operands, _ in pipeline.manifest.computations]
    before = pipeline.clocks
    results = await pipeline.through(points)
    for (operands, wanted), result in zip(pipeline.manifest.computations, results, strict=True):
        assert [result] == wanted.results, f"{operands}: {result}, not {wanted.results[0]}"
    assert pipeline.manifest.latency is not None
    taken = (len(points) - 1) * pipeline.manifest.interval + 1
    assert pipeline.clocks - before == taken + pipeline.manifest.latency
    dut._log.info("%d points in %d clocks", len(points), pipeline.clocks - before)


@cocotb.test()
async def bubbles_and_stalls_change_nothing(dut: Any) -> None:
    """Pauses between points and stalls of results do not change the results."""
    pipeline = await Pipeline.after_reset(dut)
    points = [operands for operands, _ in pipeline.manifest.computations]
    wanted = [wanted.results[0] for _, wanted in pipeline.manifest.computations]
    for offer, take in ((1, 3), (3, 1), (2, 2), (1, 8), (8, 1)):
        results = await pipeline.through(points, offer, take)
        assert results == wanted, f"a point in {offer} clocks, a result in {take}"


@cocotb.test()
async def reset_drops_every_point(dut: Any) -> None:
    """A reset discards all points in the pipeline, and the next point is right."""
    pipeline = await Pipeline.after_reset(dut)
    assert pipeline.manifest.latency is not None
    operands, wanted = pipeline.manifest.computations[-1]
    for count in range(1, pipeline.manifest.latency + 2):
        for _ in range(count):
            await pipeline.clock(pipeline.manifest.draw(pipeline.random))
        await pipeline.clock(rst_n=0)
        for _ in range(pipeline.manifest.latency + 1):
            await pipeline.clock()
        assert [await pipeline.compute(**operands)] == wanted.results, f"after {count} points"


@cocotb.test()
async def random_points_follow_the_formula(dut: Any) -> None:
    """At random points, the error against the formula in floats is within the bound."""
    pipeline = await Pipeline.after_reset(dut, seed=2)
    manifest = pipeline.manifest
    points = [manifest.draw(pipeline.random) for _ in range(1000)]
    worst = 0.0
    for operands, result in zip(points, await pipeline.through(points, 2, 2), strict=True):
        worst = max(worst, manifest.error(operands, 0, result))
    dut._log.info("the worst error is %.3f of its bound", worst)


@cocotb.test()
async def streams_carry_every_point(dut: Any) -> None:
    """Every computation of the manifest is exact, with and without pauses, and after a reset."""
    stream = await Stream.after_reset(dut)
    is_line = stream.manifest.length is not None
    points = [operands for operands, _ in stream.manifest.computations]
    wanted = []
    for number, (_, computation) in enumerate(stream.manifest.computations):
        user = number % (1 << len(dut.s_axis_tuser))
        for index, result in enumerate(computation.results, 1):
            last = index == len(computation.results) if is_line else number % 3 == 0
            wanted.append((result, user, last))
    for offer, take in ((1, 1), (1, 40), (40, 1), (3, 2), (1, 200)):
        got = await stream.through(points, offer, take)
        assert got == wanted, f"a point in {offer} clocks, a transfer in {take}"
    first = wanted[: len(stream.manifest.computations[0][1].results)]
    for clocks in range(1, 20):
        dut.s_axis_tvalid.value = 1
        for _ in range(clocks):
            await FallingEdge(dut.aclk)
        await stream.reset()
        assert await stream.through(points[:1]) == first, f"a reset after {clocks} clocks"


@cocotb.test()
async def registers_compute_every_point(dut: Any) -> None:
    """Every computation of the manifest is exact, with both kinds of start, and interrupts."""
    registers = await Registers.after_reset(dut)
    assert set((await registers.results()).values()) == {0}
    await registers.write("interrupt_enable", 1)
    for number, (operands, wanted) in enumerate(registers.manifest.computations):
        await registers.write("control", 0)
        await registers.write_operands(operands)
        name = list(operands)[number % len(operands)]
        starter = registers.parts(name)[0]
        if number % 2:
            start = registers.manifest.registers[starter]["offset"] // 4
            await registers.write("control", 2 | start << 8)
            await registers.write(starter, operands[name])
        else:
            await registers.write("control", 1)
        assert [await registers.results()] == wanted.results, f"{operands}: not {wanted.results}"
        assert await registers.read("status") == 2
        assert dut.irq.value == 1
        await registers.write("interrupt_pending", 1)
        assert dut.irq.value == 0


@cocotb.test()
async def registers_keep_what_is_written(dut: Any) -> None:
    """Operands read back byte by byte. A write to a read-only register is an error."""
    registers = await Registers.after_reset(dut)
    for name in registers.manifest.domain:
        for part in registers.parts(name):
            (bits,) = registers.manifest.registers[part]["bits"]
            kept = 0
            for lanes in (1, 2, 4, 8, 0, 15, 6):
                value = registers.random.getrandbits(32)
                mask = sum(0xFF << 8 * lane for lane in range(4) if lanes >> lane & 1)
                await registers.write(part, value, lanes)
                kept = (kept & ~mask | value & mask) & ((1 << bits["width"]) - 1)
                assert await registers.read(part) == kept, f"{part} after bytes {lanes:04b}"
    before = await registers.read("id")
    try:
        await registers.write("id", 0)
    except BusError:
        assert await registers.read("id") == before
        return
    raise AssertionError("a write of `id` is no error")


def run(name: str, wrapper: str = "") -> None:
    """Builds core `name` or its wrapper in sim_build/, runs its bench, and ends the process."""
    from cocotb_tools.check_results import get_results
    from cocotb_tools.runner import get_runner

    manifest = Manifest(name)
    top = f"{name}_{wrapper}" if wrapper else name
    place = Path("sim_build") / top
    place.mkdir(parents=True, exist_ok=True)
    for memory in manifest.memories:
        shutil.copy(memory, place)
    runner = get_runner("icarus")
    runner.build(
        sources=manifest.sources + (manifest.wrappers if wrapper else []),
        hdl_toplevel=top,
        build_dir=place,
        build_args=["-g2005", "-Wall"],
        timescale=("1ns", "1ps"),
        always=True,
    )
    sys.path.insert(0, str(ROOT / "testbench" / name))
    report = runner.test(
        hdl_toplevel=top, test_module=f"test_{top}", build_dir=place, test_dir=place
    )
    tests, failed = get_results(report)
    print(f"{'FAIL' if failed or not tests else 'PASS'} {top}: {tests} tests, {failed} failed")
    sys.exit(1 if failed or not tests else 0)


# sha256 2a89c2dda753ff40e12c4a676a8ef59fcde3f8067add0a08e868424876784eeb
