"""Registers around a core, driven by the bus models of cocotbext-axi or cocotbext-wishbone.

    python registers.py NAME axil|wb

in a directory that has rtl_out/NAME/ and software/NAME/. Where a register is, is read from the SystemRDL.
"""

import json
import os
import random
import sys
from pathlib import Path

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, RisingEdge

NAME = os.environ.get("GLINT_NAME") or sys.argv[1]
BUS = os.environ.get("GLINT_BUS") or sys.argv[2]
PLACE = Path(os.environ.get("GLINT_PLACE") or Path.cwd())
MANIFEST = json.loads((PLACE / f"rtl_out/{NAME}/{NAME}.json").read_text())
POINTS = MANIFEST["computations"]["points"]
OPERANDS = MANIFEST["computations"]["operands"]
RESULTS = MANIFEST["computations"]["results"]


def offsets():
    """Offsets of registers and, for each, its fields with their bits, as the SystemRDL compiler reads them."""
    from systemrdl import RDLCompiler

    compiler = RDLCompiler()
    compiler.compile_file(str(PLACE / f"software/{NAME}/{NAME}.rdl"))
    registers = compiler.elaborate().top.registers()
    return {
        register.inst_name: (
            register.absolute_address,
            {field.inst_name: (field.low, field.width) for field in register.fields()},
        )
        for register in registers
    }


MAP = offsets()
START, START_ON_WRITE = 1, 2


class Error(Exception):
    """The bus answered with an error."""


class AxiLite:
    def __init__(self, dut, randomly):
        from cocotbext.axi import AxiLiteBus, AxiLiteMaster

        self.master = AxiLiteMaster(
            AxiLiteBus.from_prefix(dut, "s_axil"), dut.aclk, dut.aresetn, reset_active_level=False
        )
        if randomly:
            for channel in (
                self.master.write_if.aw_channel,
                self.master.write_if.w_channel,
                self.master.write_if.b_channel,
                self.master.read_if.ar_channel,
                self.master.read_if.r_channel,
            ):
                channel.set_pause_generator(iter(lambda: randomly.random() < 0.6, None))

    async def write(self, address, value, strobes=0xF):
        if strobes == 0xF:
            answer = await self.master.write(address, value.to_bytes(4, "little"))
        else:
            # Bytes beside each other, as the master gives strobes.
            low = (strobes & -strobes).bit_length() - 1
            count = strobes.bit_count()
            data = value.to_bytes(4, "little")[low : low + count]
            answer = await self.master.write(address + low, data)
        if answer.resp != 0:
            raise Error(answer.resp)

    async def read(self, address):
        answer = await self.master.read(address, 4)
        if answer.resp != 0:
            raise Error(answer.resp)
        return int.from_bytes(answer.data, "little")


class Wishbone:
    def __init__(self, dut, randomly):
        from cocotbext.wishbone import driver
        from cocotbext.wishbone.driver import WBOp, WishboneMaster

        # Icarus Verilog 11 does not pass on what is written to a port with no delay at time 0.
        driver.set_immediate = lambda signal, value: setattr(signal, "value", value)
        self.operation = WBOp
        self.random = randomly
        signals = {
            "cyc": "cyc_i", "stb": "stb_i", "we": "we_i", "adr": "adr_i", "datwr": "dat_i",
            "datrd": "dat_o", "ack": "ack_o", "err": "err_o", "sel": "sel_i",
        }  # fmt: skip
        self.master = WishboneMaster(
            dut, "wb", dut.wb_clk_i, timeout=2000, signals_dict=signals
        )

    async def cycle(self, **operation):
        if self.random:
            operation["idle"] = self.random.randint(0, 4)
        (answer,) = await self.master.send_cycle([self.operation(**operation)])
        if answer.ack != 1:
            raise Error(answer.ack)
        return answer

    async def write(self, address, value, strobes=0xF):
        await self.cycle(adr=address, dat=value, sel=strobes)

    async def read(self, address):
        return int((await self.cycle(adr=address)).datrd)


class Bench:
    def __init__(self, dut, seed, pauses=False):
        self.dut = dut
        self.random = random.Random(seed)
        self.clock = dut.aclk if BUS == "axil" else dut.wb_clk_i
        cocotb.start_soon(Clock(self.clock, 10, "ns").start())
        kind = AxiLite if BUS == "axil" else Wishbone
        self.bus = kind(dut, self.random if pauses else None)

    async def reset(self):
        reset, active = (
            (self.dut.aresetn, 0) if BUS == "axil" else (self.dut.wb_rst_i, 1)
        )
        reset.value = active
        await ClockCycles(self.clock, 3)
        reset.value = 1 - active
        await RisingEdge(self.clock)

    @classmethod
    async def ready(cls, dut, seed, pauses=False):
        bench = cls(dut, seed, pauses)
        await bench.reset()
        return bench

    async def write(self, register, value, strobes=0xF):
        await self.bus.write(MAP[register][0], value & 0xFFFFFFFF, strobes)

    async def read(self, register):
        return await self.bus.read(MAP[register][0])

    async def write_operand(self, name, value):
        if name in MAP:
            await self.write(name, value)
        else:
            await self.write(f"{name}_0", value)
            await self.write(f"{name}_1", value >> 32)

    async def results(self):
        """The results by name; the read waits for them."""
        if "results" not in MAP:
            return {name: await self.read(name) for name in RESULTS}
        word = await self.read("results")
        fields = MAP["results"][1]
        return {
            name: word >> fields[name][0] & (1 << fields[name][1]) - 1 for name in RESULTS
        }

    async def check(self, point):
        wanted = dict(zip(RESULTS, point["results"][0]))
        seen = await self.results()
        assert seen == wanted, f"{seen}, not {wanted}, of {point['operands']}"

    async def is_error(self, request):
        try:
            await request
        except Error:
            return
        raise AssertionError("an answer without an error")


@cocotb.test(timeout_time=50, timeout_unit="ms")
async def facts_are_there(dut):
    bench = await Bench.ready(dut, 1)
    assert await bench.read("id") == int.from_bytes(b"GLNT", "big")
    capabilities = await bench.read("capabilities")
    assert capabilities & 0xFF == len(OPERANDS)
    assert await bench.read("configuration") != 0
    assert await bench.read("status") == 0
    for name in OPERANDS:
        assert await bench.read(name if name in MAP else f"{name}_0") == 0


async def computations(dut, seed, pauses):
    bench = await Bench.ready(dut, seed, pauses)
    for point in POINTS:
        for name, value in zip(OPERANDS, point["operands"]):
            await bench.write_operand(name, value)
        await bench.write("control", START)
        await bench.check(point)
        assert await bench.read("status") == 2


@cocotb.test(timeout_time=50, timeout_unit="ms")
async def started_by_control(dut):
    await computations(dut, 2, pauses=False)


@cocotb.test(timeout_time=50, timeout_unit="ms")
async def on_a_bus_that_pauses(dut):
    await computations(dut, 3, pauses=True)


@cocotb.test(timeout_time=50, timeout_unit="ms")
async def started_by_a_write(dut):
    """Any operand can be the one whose write starts; those that keep their value are not written again."""
    bench = await Bench.ready(dut, 4)
    last = {}
    for at, point in enumerate(POINTS):
        starter = OPERANDS[at % len(OPERANDS)]
        register = starter if starter in MAP else f"{starter}_1"
        # Without start_on_write nothing starts.
        await bench.write("control", 0)
        values = dict(zip(OPERANDS, point["operands"]))
        for name in OPERANDS:
            if name != starter and last.get(name) != values[name]:
                await bench.write_operand(name, values[name])
        await bench.write("control", START_ON_WRITE | MAP[register][0] // 4 << 8)
        await bench.write_operand(starter, values[starter])
        last = values
        await bench.check(point)


@cocotb.test(timeout_time=50, timeout_unit="ms")
async def the_next_point_is_written_while_one_is_computed(dut):
    bench = await Bench.ready(dut, 5)
    for name, value in zip(OPERANDS, POINTS[0]["operands"]):
        await bench.write_operand(name, value)
    for point, following in zip(POINTS, POINTS[1:]):
        await bench.write("control", START)
        for name, value in zip(OPERANDS, following["operands"]):
            await bench.write_operand(name, value)
        await bench.check(point)


@cocotb.test(timeout_time=50, timeout_unit="ms", skip="waiting" not in MAP["status"][1])
async def results_wait_in_a_queue(dut):
    """Software starts points before it reads the results of earlier ones."""
    bench = await Bench.ready(dut, 9)
    depth = await bench.read("capabilities") >> 16 & 0xFF
    started = []
    for point in POINTS:
        while len(started) > bench.random.randrange(depth):
            await bench.check(started.pop(0))
        for name, value in zip(OPERANDS, point["operands"]):
            await bench.write_operand(name, value)
        await bench.write("control", START)
        started.append(point)
    for _ in range(depth - len(started)):
        await bench.write("control", START)
        started.append(POINTS[-1])
    await bench.is_error(bench.write("control", START))
    for point in started:
        await bench.check(point)
    assert await bench.read("status") == 2


@cocotb.test(timeout_time=50, timeout_unit="ms")
async def bytes_are_written_alone(dut):
    bench = await Bench.ready(dut, 6)
    for name in (register for register in MAP if register in OPERANDS):
        low, width = MAP[name][1]["value"]
        mask = (1 << width) - 1
        kept = 0
        for _ in range(20):
            value = bench.random.getrandbits(32)
            strobes = bench.random.choice([1, 2, 4, 8, 3, 6, 12, 15])
            await bench.write(name, value, strobes)
            lanes = sum(0xFF << 8 * byte for byte in range(4) if strobes >> byte & 1)
            kept = (kept & ~lanes | value & lanes) & mask
            assert await bench.read(name) == kept


@cocotb.test(timeout_time=50, timeout_unit="ms")
async def the_interrupt_is_raised_and_cleared(dut):
    bench = await Bench.ready(dut, 7)
    for enabled in (0, 1):
        await bench.write("interrupt_enable", enabled)
        assert dut.irq.value == 0
        await bench.write("control", START)
        await bench.results()
        assert await bench.read("interrupt_pending") == 1
        assert dut.irq.value == enabled
        await bench.write("interrupt_pending", 0)
        assert await bench.read("interrupt_pending") == 1
        await bench.write("interrupt_pending", 1)
        assert await bench.read("interrupt_pending") == 0
        assert dut.irq.value == 0


@cocotb.test(timeout_time=50, timeout_unit="ms")
async def what_is_not_in_the_map_is_an_error_and_changes_nothing(dut):
    bench = await Bench.ready(dut, 8)
    point = POINTS[-1]
    for name, value in zip(OPERANDS, point["operands"]):
        await bench.write_operand(name, value)
    end = max(offset for offset, _ in MAP.values()) + 4
    space = 1 << len(dut.s_axil_awaddr if BUS == "axil" else dut.wb_adr_i)
    for address in range(end, space, 4):
        await bench.is_error(bench.bus.read(address))
        await bench.is_error(bench.bus.write(address, 0xFFFFFFFF))
    readable = ["id", "version", "configuration", "capabilities", "status"]
    results = [name for name in MAP if MAP[name][0] > MAP[lowest_result()][0] - 4]
    for name in readable + results:
        await bench.is_error(bench.write(name, 0xFFFFFFFF))
    assert await bench.read("status") == 0
    await bench.write("control", START)
    await bench.check(point)


def lowest_result():
    return "results" if "results" in MAP else RESULTS[0]


def main():
    from cocotb_tools.check_results import get_results
    from cocotb_tools.runner import get_runner

    rtl = PLACE / "rtl_out" / NAME
    build = PLACE / f"sim_{BUS}"
    build.mkdir(exist_ok=True)
    for memory in rtl.glob("*.mem"):
        (build / memory.name).write_bytes(memory.read_bytes())
    top = f"{NAME}_{BUS}"
    runner = get_runner("icarus")
    runner.build(
        sources=sorted(rtl.glob("*.v")),
        hdl_toplevel=top,
        build_dir=build,
        build_args=["-g2005"],
        timescale=("1ns", "1ps"),
        always=True,
    )
    sys.path.insert(0, str(Path(__file__).parent))
    report = runner.test(
        hdl_toplevel=top,
        test_module="registers",
        build_dir=build,
        test_dir=build,
        extra_env={
            "GLINT_NAME": NAME,
            "GLINT_BUS": BUS,
            "GLINT_PLACE": str(PLACE),
            "COCOTB_LOG_LEVEL": "WARNING",
        },
    )
    tests, failed = get_results(report)
    print(f"{'FAIL' if failed or not tests else 'PASS'} {NAME}: {tests} tests, {failed} failed")
    sys.exit(1 if failed or not tests else 0)


if __name__ == "__main__":
    main()
