#!/usr/bin/env python3
"""The unit of eight functions beside a core for each function, on ECP5: the table of docs/units.md.

    target/tools/venv/bin/python benches/unit/table.py              the table on the screen
    target/tools/venv/bin/python benches/unit/table.py --write      and in docs/units.md

The functions are those of `glint new unit`. The sequential cores have one multiplier each; the pipelines take a point every clock and are
scheduled for 100 MHz. `glint synth` measures the look-up tables, and with three seeds the frequency between registers around the
core. The configurations and the cache of the measurements are in `target/unit/`.
Needs `cargo build --release` and the tools of `bash tools/install`.
"""

import argparse
import json
import os
import pathlib
import subprocess
import sys
import tomllib

ROOT = pathlib.Path(__file__).resolve().parents[2]
GLINT = ROOT / "target/release/glint"
PAGE = ROOT / "docs/units.md"
PLACE = ROOT / "target/unit"
START, END = "<!-- measured unit -->\n", "<!-- end -->"
ARCHITECTURES = {"sequential": 'architecture = "sequential"\n', "pipelined": 'architecture = "pipelined"\npipeline.clock_mhz = 100\n'}


def glint(*arguments):
    """The output of the program, with the installed tools in its PATH; ends with its message where it fails."""
    search = os.pathsep.join([str(ROOT / "target/tools/venv/bin"), os.environ["PATH"]])
    run = subprocess.run([GLINT, *map(str, arguments)], capture_output=True, text=True, env={**os.environ, "PATH": search})
    if run.returncode:
        sys.exit(run.stdout + run.stderr)
    return run.stdout


def inline(value):
    """A value as TOML on one line."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {inline(each)}" for key, each in value.items()) + " }"
    return json.dumps(value)


def configurations():
    """The paths of the unit's and of each function's configurations, by name and architecture."""
    PLACE.mkdir(parents=True, exist_ok=True)
    functions = tomllib.loads(glint("new", "unit"))["functions"]
    paths = {}
    for architecture, keys in ARCHITECTURES.items():
        texts = {"unit": "".join(f"functions.{name} = {inline(function)}\n" for name, function in functions.items())}
        for name, function in functions.items():
            texts[name] = "".join(f"{table} = {inline(entries)}\n" for table, entries in function.items())
        for name, text in texts.items():
            core = f"{name}_{architecture}"
            path = PLACE / f"{core}.toml"
            device = "unit" if name == "unit" else "expression"
            path.write_text(f'device = "{device}"\nname = "{core}"\n{keys}{text}')
            paths[name, architecture] = path
    return paths


def measured(path, seeds):
    """Look-up tables, multipliers, block memories, MHz, and the clocks from a start to its result: of each function for a sequential unit."""
    found = json.loads(glint("synth", path, "--target", "ecp5", "--seeds", seeds, "--json", "--quiet"))
    figures = found["synthesis"][0]["targets"][0]
    area = figures["area"]
    glint("generate", path, "--out", PLACE / "out", "--force")
    manifest = json.loads((PLACE / f"out/rtl_out/{path.stem}/{path.stem}.json").read_text())
    pipeline = manifest.get("pipeline")
    functions = {function["name"]: function["start_to_done"] for function in manifest.get("functions", [])}
    if pipeline:
        clocks = pipeline["latency"]
    else:
        clocks = functions or manifest["timing"]["start_to_valid"]
    return [area["luts"], area["dsps"], area["block_rams"], round(figures["frequency"]["median"]), clocks]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--write", action="store_true", help="write the table into docs/units.md")
    parser.add_argument("--seeds", type=int, default=3, help="runs of place and route [default: 3]")
    arguments = parser.parse_args()
    paths = configurations()
    names = list(dict.fromkeys(name for name, _ in paths if name != "unit"))
    rows = {}
    for name in [*names, "unit"]:
        rows[name] = [measured(paths[name, architecture], arguments.seeds) for architecture in ARCHITECTURES]
        print(name, rows[name], file=sys.stderr, flush=True)
    in_unit = rows["unit"][0][-1]
    for name in names:
        alone = rows[name][0]
        alone[-1] = f"{alone[-1]}, in the unit {in_unit[name]}"
    rows["unit"][0][-1] = f"{min(in_unit.values())} to {max(in_unit.values())}"
    heads = ["LUT", "DSP", "RAM", "MHz", "clocks"]
    lines = [
        "| core | sequential: " + " | ".join(heads) + " | pipelined: " + " | ".join(heads) + " |",
        "|---|" + "--:|" * 10,
    ]
    for name in names:
        lines.append(f"| {name} | " + " | ".join(str(cell) for side in rows[name] for cell in side) + " |")
    sums = []
    for side in range(2):
        sums += [sum(rows[name][side][column] for name in names) for column in range(3)]
        sums += [min(rows[name][side][3] for name in names), ""]
    lines.append("| the eight cores together | " + " | ".join(map(str, sums)) + " |")
    lines.append("| **the unit** | " + " | ".join(str(cell) for side in rows["unit"] for cell in side) + " |")
    table = "\n".join(lines) + "\n"
    print(table, end="")
    if arguments.write:
        text = PAGE.read_text()
        before, rest = text.split(START)
        _, after = rest.split(END)
        PAGE.write_text(before + START + "\n" + table + "\n" + END + after)


if __name__ == "__main__":
    main()
