"""Draws the cushion of cushion.c with the golden model of `lit`: cushion.py GLINT PICTURE.ppm

The geometry has the same operations on the same binary64 numbers as the C program. `glint eval --batch` computes the colours.
"""

import csv
import io
import math
import pathlib
import subprocess
import sys

SIZE, HALF, EXPONENT = 48, 1.1, 80
ALBEDO = {"kr": 200, "kg": 140, "kb": 60}
BACKGROUND = (13, 15, 20)


def raw(value):
    """A number in s1.8: the nearest, ties up, within the format."""
    return max(-512, min(511, math.floor(value * 256 + 0.5)))


def normal(column, row):
    """The raw normal of a pixel, or None beside the cushion."""
    x = ((2.0 * column + 1.0) / SIZE - 1.0) * HALF
    y = (1.0 - (2.0 * row + 1.0) / SIZE) * HALF
    above = 1.0 - x * x * x * x - y * y * y * y
    if above < 0.0:
        return None
    return raw(2.0 * (x * x * x)), raw(2.0 * (y * y * y)), raw(math.sqrt(above))


def colours(glint, normals):
    """The colour of each normal, by the golden model."""
    points = "nx,ny,nz\n" + "".join(f"#{x},#{y},#{z}\n" for x, y, z in normals)
    operands = [f"exponent={EXPONENT}", *(f"{name}={value}" for name, value in ALBEDO.items())]
    config = pathlib.Path(__file__).parent / "lit.toml"
    command = [glint, "eval", str(config), "--quiet", "--batch", "-", *operands]
    answer = subprocess.run(command, input=points, stdout=subprocess.PIPE, text=True, check=True)
    rows = csv.DictReader(io.StringIO(answer.stdout))
    return [tuple(int(row[f"{name}_out"]) for name in ("pr", "pg", "pb")) for row in rows]


def main():
    glint, picture = sys.argv[1:]
    pixels = [normal(column, row) for row in range(SIZE) for column in range(SIZE)]
    shown = sorted({normal for normal in pixels if normal})
    of_normal = dict(zip(shown, colours(glint, shown), strict=True))
    data = b"".join(bytes(of_normal.get(normal, BACKGROUND)) for normal in pixels)
    pathlib.Path(picture).write_bytes(f"P6\n{SIZE} {SIZE}\n255\n".encode() + data)


main()
