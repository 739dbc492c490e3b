"""A system of LiteX around a core of Glint, as Verilog with a bench.

    python system.py DIRECTORY NAME FACE

DIRECTORY is where `glint generate` wrote; FACE is `core`, `stream`, `registers`, or `cpu`: registers with a processor in
place of the bench's accesses. In the current directory this writes soc.v, tb.v and sources.txt, a path a line. The bench
computes the points of the manifest.
"""

import importlib.util
import json
import re
import sys
from pathlib import Path

from litex.build.generic_platform import Pins, Subsignal
from litex.build.io import CRG
from litex.build.sim import SimPlatform
from litex.soc.integration.soc import SoCRegion
from litex.soc.integration.soc_core import SoCMini
from litex.soc.interconnect import wishbone
from litex.soc.interconnect.csr import CSRStorage

POINTS = 12


def generated(directory: Path, name: str):
    """The module that Glint wrote."""
    path = directory / "software" / name / f"{name}_litex.py"
    spec = importlib.util.spec_from_file_location("generated", path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def pads(face: str, widths: tuple[int, int, int]) -> list:
    """The pins of the system: a Wishbone master, or two streams."""
    bus = [
        Subsignal("adr", Pins(32)), Subsignal("dat_w", Pins(32)), Subsignal("dat_r", Pins(32)),
        Subsignal("sel", Pins(4)), Subsignal("cyc", Pins(1)), Subsignal("stb", Pins(1)),
        Subsignal("we", Pins(1)), Subsignal("ack", Pins(1)), Subsignal("err", Pins(1)),
    ]
    one = [Subsignal(name, Pins(1)) for name in ("valid", "ready", "last")]
    data, user, out = widths
    return [
        ("sys_clk", 0, Pins(1)),
        ("sys_rst", 0, Pins(1)),
        ("verdict", 0, Pins(2)),
        ("host", 0, *bus),
        ("sink", 0, *one, Subsignal("data", Pins(data)), Subsignal("user", Pins(user))),
        ("source", 0, *one, Subsignal("data", Pins(out)), Subsignal("user", Pins(user))),
    ]


class System(SoCMini):
    """The core as a user of LiteX would have it."""

    def __init__(self, platform, make, face: str, program: list[int]) -> None:
        self.crg = CRG(platform.request("sys_clk"), rst=platform.request("sys_rst"))
        processor = {"cpu_type": "picorv32", "integrated_rom_size": 0x4000, "integrated_rom_init": program}
        super().__init__(platform, clk_freq=int(1e6), ident="", **(processor if program else {}))
        self.core = make(platform)
        if face in ("registers", "cpu"):
            # Without a processor LiteX takes any place for one of peripherals, its own too.
            origin = 0x1000_0000 if face == "registers" else None
            region = SoCRegion(origin=origin, size=0x1000, cached=False)
            self.bus.add_slave("core", self.core.bus, region)
        if face == "cpu":
            self.irq.add("core")
            self.verdict = CSRStorage(2)
            self.comb += platform.request("verdict").eq(self.verdict.storage)
            return
        if face == "stream":
            sink, source = platform.request("sink"), platform.request("source")
            for name in ("valid", "data", "user", "last"):
                self.comb += getattr(self.core.sink, name).eq(getattr(sink, name))
                self.comb += getattr(source, name).eq(getattr(self.core.source, name))
            self.comb += [
                sink.ready.eq(self.core.sink.ready),
                self.core.source.ready.eq(source.ready),
            ]
            return
        host = platform.request("host")
        master = wishbone.Interface(data_width=32, address_width=32, addressing="byte")
        self.bus.add_master("host", master)
        for name in ("adr", "dat_w", "sel", "cyc", "stb", "we"):
            self.comb += getattr(master, name).eq(getattr(host, name))
        for name in ("dat_r", "ack", "err"):
            self.comb += getattr(host, name).eq(getattr(master, name))


HEAD = """`timescale 1ns/1ns
module tb;
    reg clk = 0, rst = 1;
    always #5 clk = ~clk;
    integer failures = 0;
    initial begin #2000000; $display("FAIL: no end"); $fatal; end
"""

BUS = """
    reg [31:0] adr = 0, dat_w = 0, got;
    wire [31:0] dat_r;
    reg cyc = 0, we = 0;
    wire ack, err;
    {top} dut (.sys_clk(clk), .sys_rst(rst), .host_adr(adr), .host_dat_w(dat_w), .host_dat_r(dat_r),
        .host_sel(4'hf), .host_cyc(cyc), .host_stb(cyc), .host_we(we), .host_ack(ack), .host_err(err));
    task access(input [31:0] at, input writes, input [31:0] word);
        begin
            @(negedge clk); adr = at; we = writes; dat_w = word; cyc = 1;
            @(posedge clk);
            while (!ack) @(posedge clk);
            got = dat_r;
            @(negedge clk); cyc = 0;
        end
    endtask
    task expect_word(input [31:0] at, input [31:0] word);
        begin
            access(at, 0, 0);
            if (got !== word) begin
                failures = failures + 1;
                $display("at %h: %h, not %h", at, got, word);
            end
        end
    endtask
    initial begin
        repeat (4) @(negedge clk);
        rst = 0;
"""

STREAM = """
    reg [{inputs}:0] data = 0;
    reg [{users}:0] user = 0;
    reg offered = 0, last = 0;
    reg taken = 1;
    wire accepted, valid, out_last;
    wire [{outputs}:0] out;
    wire [{users}:0] out_user;
    {top} dut (.sys_clk(clk), .sys_rst(rst), .sink_valid(offered), .sink_ready(accepted), .sink_data(data),
        .sink_user(user), .sink_last(last), .source_valid(valid), .source_ready(taken),
        .source_data(out), .source_user(out_user), .source_last(out_last));
    task send(input [{inputs}:0] word, input ends);
        begin
            @(negedge clk); data = word; user = ~user; last = ends; offered = 1;
            @(posedge clk);
            while (!accepted) @(posedge clk);
            @(negedge clk); offered = 0;
        end
    endtask
    task receive(input [{outputs}:0] word, input ends);
        begin
            @(posedge clk);
            while (!valid) @(posedge clk);
            if (out !== word || out_last !== ends || out_user !== user) begin
                failures = failures + 1;
                $display("%h, not %h", out, word);
            end
        end
    endtask
    initial begin
        repeat (4) @(negedge clk);
        rst = 0;
"""

CPU = """
    wire [1:0] verdict;
    {top} dut (.sys_clk(clk), .sys_rst(rst), .verdict(verdict));
    initial begin
        repeat (4) @(negedge clk);
        rst = 0;
        wait (verdict[0]);
        failures = verdict[1];
"""

TAIL = """
        if (failures != 0) begin $display("FAIL: %0d", failures); $fatal; end
        $display("PASS: {points} points");
        $finish;
    end
endmodule
"""


def packed(ports: list[dict], values: list[int]) -> int:
    """Values side by side in whole bytes, the first in the lowest."""
    word, low = 0, 0
    for port, value in zip(ports, values, strict=True):
        bytes_ = (port["width"] + 7) // 8
        word |= (value & ((1 << 8 * bytes_) - 1)) << low
        low += 8 * bytes_
    return word


def li(register: int, word: int) -> list[int]:
    """Puts a constant into a register of RV32I: lui, addi."""
    return [(word + 0x800) & 0xFFFFF000 | register << 7 | 0x37,
            (word & 0xFFF) << 20 | register << 15 | register << 7 | 0x13]


def program(accesses: list[tuple[str, int, int]], interrupt: int, verdict: int) -> list[int]:
    """Does the accesses, waits for an interrupt where they say so, and tells whether all was right."""
    words = li(8, 0)
    for what, at, word in accesses:
        if what == "wait":
            # waitirq x7, an instruction of PicoRV32
            words += [0x0800_0000 | 7 << 7 | 0x0B, *li(6, 1 << interrupt)]
        else:
            words += [*li(5, at), *li(6, word)]
            # sw x6, 0(x5), or lw x7, 0(x5)
            words += [6 << 20 | 5 << 15 | 2 << 12 | 0x23] if what == "write" else []
            words += [5 << 15 | 2 << 12 | 7 << 7 | 0x03] if what == "read" else []
        if what != "write":
            # xor x7, x7, x6; or x8, x8, x7
            words += [6 << 20 | 7 << 15 | 4 << 12 | 7 << 7 | 0x33,
                      7 << 20 | 8 << 15 | 6 << 12 | 8 << 7 | 0x33]
    # sltu x6, x0, x8: 1 where anything was wrong; bit 1 of the verdict, of which bit 0 is set.
    words += [8 << 20 | 3 << 12 | 6 << 7 | 0x33, 1 << 20 | 6 << 15 | 1 << 12 | 6 << 7 | 0x13,
              1 << 20 | 6 << 15 | 6 << 12 | 6 << 7 | 0x13]
    # sw x6, 0(x5); the jump to itself ends it.
    return [*words, *li(5, verdict), 6 << 20 | 5 << 15 | 2 << 12 | 0x23, 0x6F]


def main() -> None:
    """Write the system and its bench."""
    directory, name, face = Path(sys.argv[1]), sys.argv[2], sys.argv[3]
    facts = json.loads((directory / "rtl_out" / name / f"{name}.json").read_text())
    ports = {port["name"]: port for port in facts["ports"]}
    table = facts["computations"]
    operands = [ports[name] for name in table["operands"]]
    results = [ports[name] for name in table["results"]]
    bits = [sum((p["width"] + 7) // 8 * 8 for p in side) for side in (operands, results)]
    module = generated(directory, name)
    kind = {"core": "Core", "stream": "Stream"}.get(face, "Registers")
    (make,) = [getattr(module, it) for it in dir(module) if re.fullmatch(rf"[A-Z]\w+{kind}", it)
               and getattr(module, it).__module__ == "generated"]
    points = table["points"][:POINTS]

    def build(program: list[int]) -> System:
        platform = SimPlatform("SIM", pads(face, (bits[0], 1, bits[1])))
        system = System(platform, make, face, program)
        system.finalize()
        verilog = platform.get_verilog(system, name="soc")
        Path("soc.v").write_text(verilog.main_source)
        for name, data in verilog.data_files.items():
            Path(name).write_text(data)
        sources = [source[0] for source in platform.sources] + list(verilog.data_files)
        Path("sources.txt").write_text("".join(f"{source}\n" for source in sources))
        return system

    # What it is made of does not depend on the program.
    system = build([0x6F] if face == "cpu" else [])
    lines = []
    at = {}
    if face == "core":
        region = system.csr.regions["core"]
        at = {csr.name: region.origin + 4 * index for index, csr in enumerate(region.obj)}
    elif face in ("registers", "cpu"):
        base = system.bus.regions["core"].origin
        header = (directory / "software" / name / f"{name}_registers.h").read_text()
        prefix = name.upper()
        for found in re.finditer(rf"#define {prefix}_REG_(\w+) (0x[0-9a-f]+)u", header):
            at[found[1].lower()] = base + int(found[2], 16)
    if face == "cpu":
        accesses = [("read", at["id"], 0x474C_4E54), ("write", at["interrupt_enable"], 1)]
        for point in points:
            values = zip(operands, point["operands"], strict=True)
            accesses += [("write", at[port["name"]], value & 0xFFFF_FFFF) for port, value in values]
            accesses += [("write", at["control"], 1), ("wait", 0, 0)]
            accesses += [("read", at["results"], packed(results, point["results"][0]))]
        verdict = next(region for region in system.csr.regions.values()
                       if any(csr.name == "verdict" for csr in region.obj))
        build(program(accesses, system.irq.locs["core"], verdict.origin))
    for point in points if face != "cpu" else []:
        if face == "stream":
            lines.append(f"send({bits[0]}'h{packed(operands, point['operands']):x}, 1'b1);")
            lines.append(f"receive({bits[1]}'h{packed(results, point['results'][0]):x}, 1'b1);")
            continue
        for port, value in zip(operands, point["operands"], strict=True):
            word = value & 0xFFFF_FFFF
            place = at[("operand_" if face == "core" else "") + port["name"]]
            lines.append(f"access(32'h{place:x}, 1, 32'h{word:x});")
        lines.append(f"access(32'h{at['control']:x}, 1, 32'h1);")
        if face == "core":
            lines.append(f"got = 1; while (got != 0) access(32'h{at['status']:x}, 0, 0);")
            for port, value in zip(results, point["results"][0], strict=True):
                place = at["result_" + port["name"]]
                lines.append(f"expect_word(32'h{place:x}, 32'h{value & 0xFFFF_FFFF:x});")
        else:
            word = packed(results, point["results"][0])
            lines.append(f"expect_word(32'h{at['results']:x}, 32'h{word:x});")
    body = "".join(f"        {line}\n" for line in lines)
    head = STREAM.format(top="soc", inputs=bits[0] - 1, outputs=bits[1] - 1, users=0)
    head = head if face == "stream" else (CPU if face == "cpu" else BUS).format(top="soc")
    Path("tb.v").write_text(HEAD + head + body + TAIL.format(points=len(points)))


main()
