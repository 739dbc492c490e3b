"""An AXI4-Stream wrapper between the source and the sink of cocotbext-axi.

    python stream.py NAME

in a directory that has rtl_out/NAME/. Both sides pause at random, operands are unknown while tvalid is low, and
every transfer is compared with the computations of the manifest.
"""

import importlib
import itertools
import json
import os
import random
import sys
from pathlib import Path

import cocotb
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, RisingEdge
from cocotbext.axi import AxiStreamBus, AxiStreamFrame, AxiStreamSink, AxiStreamSource

NAME = os.environ.get("GLINT_NAME") or sys.argv[1]
PLACE = Path(os.environ.get("GLINT_PLACE") or Path.cwd())
MANIFEST = json.loads((PLACE / f"rtl_out/{NAME}/{NAME}.json").read_text())
USER_BITS = 9
PACKETS = 60


STREAM = MANIFEST["stream"]
# As software has the transfers.
sys.path.insert(0, str(PLACE / "software" / NAME))
transfers = importlib.import_module(f"{NAME}_stream")


def packed(names, values):
    """The bytes of a transfer to the core."""
    return transfers.pack({name: [value] for name, value in zip(names, values)}).tobytes()


def unpacked(data):
    """The results in the bytes of a transfer from the core."""
    return {name: int(values[0]) for name, values in transfers.unpack(bytes(data)).items()}


class Bench:
    """The wrapper with its source and its sink."""

    computations = MANIFEST["computations"]
    operands = computations["operands"]
    is_line = any(len(point["results"]) > 1 for point in computations["points"])

    def __init__(self, dut, seed):
        self.dut = dut
        self.random = random.Random(seed)
        cocotb.start_soon(Clock(dut.aclk, 10, "ns").start())
        self.source = AxiStreamSource(
            AxiStreamBus.from_prefix(dut, "s_axis"), dut.aclk, dut.aresetn, reset_active_level=False
        )
        self.sink = AxiStreamSink(
            AxiStreamBus.from_prefix(dut, "m_axis"), dut.aclk, dut.aresetn, reset_active_level=False
        )

    async def reset(self):
        self.dut.aresetn.value = 0
        await ClockCycles(self.dut.aclk, 3)
        self.dut.aresetn.value = 1
        await RisingEdge(self.dut.aclk)

    def pauses(self, share):
        return (self.random.random() < share for _ in itertools.count())

    def draw(self):
        """A packet that is sent, and the packets that come of it: bytes and tuser of each transfer."""
        points = [
            self.random.choice(self.computations["points"])
            for _ in range(1 if self.is_line else self.random.randint(1, 4))
        ]
        users = [self.random.getrandbits(USER_BITS) for _ in points]
        sent = [(packed(self.operands, point["operands"]), user) for point, user in zip(points, users)]
        wanted = [
            (dict(zip(self.computations["results"], result)), user)
            for point, user in zip(points, users)
            for result in point["results"]
        ]
        return sent, wanted

    async def run(self, packets):
        drawn = [self.draw() for _ in range(packets)]
        for sent, _ in drawn:
            # cocotbext-axi has a tuser for every byte.
            data = b"".join(data for data, _ in sent)
            user = [user for data, user in sent for _ in data]
            await self.source.send(AxiStreamFrame(data, tuser=user))
        for _, wanted in drawn:
            got = await self.sink.recv(compact=False)
            transfer = transfers.RECEIVED_BYTES
            assert len(got.tdata) == transfer * len(wanted), f"{len(got.tdata)} bytes"
            assert list(got.tuser) == [user for _, user in wanted for _ in range(transfer)]
            for at, (values, _) in enumerate(wanted):
                seen = unpacked(got.tdata[at * transfer : (at + 1) * transfer])
                # A core that shows its reflectance has a result more; which value that has is proved, not known here.
                seen = {name: seen[name] for name in values}
                assert seen == values, f"{seen}, not {values}"
        await ClockCycles(self.dut.aclk, 200)
        assert self.sink.empty(), "a packet that nobody sent"
        return sum(len(wanted) for _, wanted in drawn)


async def with_pauses(dut, source, sink, seed):
    bench = Bench(dut, seed)
    await bench.reset()
    bench.source.set_pause_generator(bench.pauses(source))
    bench.sink.set_pause_generator(bench.pauses(sink))
    await bench.run(PACKETS)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def nobody_pauses(dut):
    bench = Bench(dut, 1)
    await bench.reset()
    await bench.run(PACKETS)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def the_source_pauses(dut):
    await with_pauses(dut, 0.8, 0.0, 2)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def the_sink_pauses(dut):
    await with_pauses(dut, 0.0, 0.8, 3)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def both_pause(dut):
    await with_pauses(dut, 0.5, 0.5, 4)


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def a_pipeline_takes_and_gives_a_point_as_often_as_it_can(dut):
    if "pipeline" not in MANIFEST:
        return
    bench = Bench(dut, 5)
    await bench.reset()
    points = bench.random.choices(bench.computations["points"], k=100)
    data = b"".join(packed(bench.operands, point["operands"]) for point in points)
    await bench.source.send(AxiStreamFrame(data, tuser=[0] * len(data)))
    taken, given = [], []
    interval = MANIFEST["pipeline"]["interval"]
    for clock in range(100 * interval + MANIFEST["pipeline"]["latency"] + 10):
        await RisingEdge(dut.aclk)
        taken += [clock] * (dut.s_axis_tvalid.value == 1 and dut.s_axis_tready.value == 1)
        given += [clock] * (dut.m_axis_tvalid.value == 1 and dut.m_axis_tready.value == 1)
    assert taken == list(range(taken[0], taken[0] + 100 * interval, interval)), taken
    assert given == list(range(given[0], given[0] + 100 * interval, interval)), given


@cocotb.test(timeout_time=20, timeout_unit="ms")
async def reset_forgets_what_is_under_way(dut):
    bench = Bench(dut, 6)
    await bench.reset()
    for _ in range(5):
        sent, _ = bench.draw()
        data = b"".join(data for data, _ in sent)
        await bench.source.send(AxiStreamFrame(data, tuser=[0] * len(data)))
        await ClockCycles(dut.aclk, bench.random.randint(1, 30))
        bench.source.clear()
        await bench.reset()
        bench.sink.clear()
        await bench.run(3)


HARNESS = """`default_nettype none
// What the source drives reaches the core while it is valid, and is unknown else.
module harness (
    input wire aclk,
    input wire aresetn,
    input wire [{in_high}:0] s_axis_tdata,
    input wire [{user_high}:0] s_axis_tuser,
    {last_port}
    {keep_ports}
    input wire s_axis_tvalid,
    output wire s_axis_tready,
    output wire [{out_high}:0] m_axis_tdata,
    output wire [{user_high}:0] m_axis_tuser,
    output wire m_axis_tlast,
    output wire m_axis_tvalid,
    input wire m_axis_tready
);
    {name}_axis #(.USER_WIDTH({user_high} + 1)) dut (
        .aclk(aclk),
        .aresetn(aresetn),
        .s_axis_tdata(s_axis_tvalid ? s_axis_tdata : {{{in_high} + 1{{1'bx}}}}),
        .s_axis_tuser(s_axis_tvalid ? s_axis_tuser : {{{user_high} + 1{{1'bx}}}}),
        {last}
        {keep}
        .s_axis_tvalid(s_axis_tvalid),
        .s_axis_tready(s_axis_tready),
        .m_axis_tdata(m_axis_tdata),
        .m_axis_tuser(m_axis_tuser),
        .m_axis_tlast(m_axis_tlast),
        .m_axis_tvalid(m_axis_tvalid),
        .m_axis_tready(m_axis_tready)
    );
endmodule
"""


def main():
    from cocotb_tools.check_results import get_results
    from cocotb_tools.runner import get_runner

    rtl = PLACE / "rtl_out" / NAME
    build = PLACE / "sim_build"
    build.mkdir(exist_ok=True)
    last = "" if Bench.is_line else ".s_axis_tlast(s_axis_tvalid ? s_axis_tlast : 1'bx),"
    keep_ports = (
        f"input wire [{transfers.SENT_BYTES - 1}:0] s_axis_tkeep,"
        f"output wire [{transfers.RECEIVED_BYTES - 1}:0] m_axis_tkeep,"
    )
    keep = ".s_axis_tkeep(s_axis_tkeep), .m_axis_tkeep(m_axis_tkeep),"
    harness = PLACE / "harness.v"
    harness.write_text(
        HARNESS.format(
            name=NAME,
            in_high=STREAM["s_axis_tdata"]["bits"] - 1,
            out_high=STREAM["m_axis_tdata"]["bits"] - 1,
            user_high=USER_BITS - 1,
            last_port="" if Bench.is_line else "input wire s_axis_tlast,",
            last=last,
            keep_ports=keep_ports if STREAM["keep"] else "",
            keep=keep if STREAM["keep"] else "",
        )
    )
    for memory in rtl.glob("*.mem"):
        (build / memory.name).write_bytes(memory.read_bytes())
    runner = get_runner("icarus")
    runner.build(
        sources=[harness, *sorted(rtl.glob("*.v"))],
        hdl_toplevel="harness",
        build_dir=build,
        build_args=["-g2005"],
        timescale=("1ns", "1ps"),
        always=True,
    )
    sys.path.insert(0, str(Path(__file__).parent))
    report = runner.test(
        hdl_toplevel="harness",
        test_module="stream",
        build_dir=build,
        test_dir=build,
        extra_env={"GLINT_NAME": NAME, "GLINT_PLACE": str(PLACE), "COCOTB_LOG_LEVEL": "WARNING"},
    )
    tests, failed = get_results(report)
    print(f"{'FAIL' if failed or not tests else 'PASS'} {NAME}: {tests} tests, {failed} failed")
    sys.exit(1 if failed or not tests else 0)


if __name__ == "__main__":
    main()
