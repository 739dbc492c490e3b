#!/usr/bin/env python3
"""Five pipelines on each FPGA family, measured and estimated: the table of docs/targets.md.

    target/tools/venv/bin/python benches/targets/table.py                       the table on the screen
    target/tools/venv/bin/python benches/targets/table.py --write               and its rows in docs/targets.md
    target/tools/venv/bin/python benches/targets/table.py --target gatemate     one family

Each core is a pipeline that takes a point every clock, scheduled for the family and for the clock that docs/targets.md
recommends. `glint synth` measures the look-up tables, and with three seeds the frequency between registers around the core;
`glint estimate` estimates both. The configurations and the cache of the measurements are in `target/targets/`.
Needs `cargo build --release` and the tools of `bash tools/install`.
"""

import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
GLINT = ROOT / "target/release/glint"
PAGE = ROOT / "docs/targets.md"
START, END = "<!-- measured families -->\n", "<!-- end -->"
CORES = ["divide", "hypot", "sincos", "atan2", "gauss"]
# The clock in MHz that the page recommends for each family.
CLOCKS = {"ecp5": 100, "ice40": 35, "ice40-hx": 45, "xilinx7": 100, "gowin": 80, "gowin-gw1n": 50, "nexus": 95, "gatemate": 35}


class Failed(Exception):
    """The program failed; the text is its message."""


def glint(*arguments):
    """The output of the program, with the installed tools in its PATH."""
    search = os.pathsep.join([str(ROOT / "target/tools/venv/bin"), os.environ["PATH"]])
    run = subprocess.run([GLINT, *map(str, arguments)], capture_output=True, text=True, env={**os.environ, "PATH": search})
    if run.returncode:
        raise Failed(run.stdout + run.stderr)
    return run.stdout


def configuration(core, target, clock):
    """The path of the configuration of a pipeline, which is written anew."""
    directory = ROOT / "target/targets"
    directory.mkdir(parents=True, exist_ok=True)
    name = f"{core}_{target}".replace("-", "_")
    path = directory / f"{name}.toml"
    path.write_text(glint("new", core, "--name", name, "--pipelined", "--target", target, "--clock", clock))
    return path


def measured(path, target, seeds):
    """Look-up tables and frequency, each as the measured and the estimated number. The frequency is None if the family is not timed, and
    if nextpnr ends with a fault of its own, as nextpnr-himbaechel 0.11 does for some netlists of GateMate."""
    command = ["synth", path, "--target", target, "--json", "--quiet", "--seeds"]
    try:
        found = json.loads(glint(*command, seeds))
    except Failed as error:
        if "memory fault" not in str(error) and "assertion_failure" not in str(error):
            raise
        print(f"nextpnr ends with a fault for {path.stem}", file=sys.stderr)
        found = json.loads(glint(*command, 0))
    figures = found["synthesis"][0]["targets"][0]
    estimates = json.loads(glint("estimate", path, "--json"))["estimates"][0]["targets"]
    estimate = next(it["cost"] for it in estimates if it["target"] == target)
    luts = (figures["area"]["luts"], estimate["luts"])
    if "frequency" not in figures:
        return luts, None
    return luts, (figures["frequency"]["median"], estimate["mhz"])


def cell(luts, mhz, clock):
    """The text of a cell: `367 (350), 113 (118)`. A frequency below the clock that was asked for is in bold type."""
    text = f"{luts[0]} ({luts[1]:.0f})"
    if mhz is None:
        return text
    speed = f"{mhz[0]:.0f} ({mhz[1]:.0f})"
    return f"{text}, {speed}" if mhz[0] >= clock else f"{text}, **{speed}**"


def offsets(pairs):
    """How far estimates are from measurements: `6 %, 16 %`, the median and the worst; `–` without measurements."""
    if not pairs:
        return "–"
    off = [abs(estimate / value - 1) for value, estimate in pairs]
    return f"{100 * statistics.median(off):.0f} %, {100 * max(off):.0f} %"


def row(target, cores, clock, seeds):
    """The row of a family."""
    cells, luts_of_all, mhz_of_all = [], [], []
    for core in cores:
        luts, mhz = measured(configuration(core, target, clock), target, seeds)
        luts_of_all.append(luts)
        if mhz is not None:
            mhz_of_all.append(mhz)
        cells.append(cell(luts, mhz, clock))
    cells += [offsets(luts_of_all), offsets(mhz_of_all)]
    return f"| `{target}` | {clock} | " + " | ".join(cells) + " |\n"


def write(rows):
    """Puts rows, by family, in place of those that the page has."""
    before, rest = PAGE.read_text().split(START)
    old, after = rest.split(END, 1)
    kept = {line.split("`")[1]: line + "\n" for line in old.splitlines() if line.startswith("| `")}
    kept.update(rows)
    lines = [kept[target] for target in CLOCKS if target in kept]
    PAGE.write_text(before + START + head(CORES) + "".join(lines) + END + after)


def head(cores):
    """The first two lines of the table."""
    titles = ["target", "clock, MHz", *cores, "look-up tables off by", "frequency off by"]
    return "| " + " | ".join(titles) + " |\n|---|--:|" + "---|" * (len(cores) + 2) + "\n"


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--target", nargs="*", default=list(CLOCKS), choices=list(CLOCKS), help="families")
    arguments.add_argument("--core", nargs="*", default=CORES, help="presets or devices that can be pipelines")
    arguments.add_argument("--clock", type=float, help="another clock in MHz than the recommended one")
    arguments.add_argument("--seeds", type=int, default=3, help="runs of place and route, of which the median counts")
    arguments.add_argument("--write", action="store_true", help="write the rows into docs/targets.md")
    given = arguments.parse_args()
    if given.write and (given.core != CORES or given.seeds != 3 or given.clock):
        sys.exit("--write needs all cores, three seeds and the recommended clocks")
    print(head(given.core), end="")
    rows = {}
    for target in given.target:
        rows[target] = row(target, given.core, given.clock or CLOCKS[target], given.seeds)
        print(rows[target], end="", flush=True)
        if given.write:
            write(rows)


if __name__ == "__main__":
    try:
        main()
    except Failed as error:
        sys.exit(str(error))
