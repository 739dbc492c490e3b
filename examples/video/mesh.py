#!/usr/bin/env python3
"""The second scene of examples/video: a ring of patches as spans of scan lines, which `quad-cosine` walks.

    mesh.py spans SPANS.mem                      what a host computes of the mesh: a span a line
    mesh.py picture GLINT SPANS.mem PICTURE.png  what has to be seen, by the golden model

A span is the pixels of a scan line that show the same patch, two triangles. On it the normal turns evenly from its value at the first pixel to that
at the last, so that its cosine with the half vector is peak * cos(zeta), zeta growing evenly (seed 000): the line's amplitude,
zeta_start and delta_zeta. The second command knows the table of spans and nothing of the Verilog.
"""

import csv
import io
import math
import pathlib
import subprocess
import sys

from scene import BACKGROUND, HEIGHT, WIDTH, png

PLACES = 4096  # of the table
FRACTION, STORED = 26, 18  # fraction bits of an angle in right angles: of the core, and in the table
EXPONENT, SPECULAR, AMBIENT, DIFFUSE = 60, 230, 24, 170
# Bits of an entry, the first uppermost.
FIELDS = {"row": 9, "column": 10, "base": 8, "amplitude": 8, "length": 8, "zeta_start": 20, "delta_zeta": 20}
MAJOR, MINOR, TILT, AROUND, ACROSS = 150.0, 68.0, 0.95, 24, 8  # a ring: radii in pixels, its tilt, its patches


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def unit(a):
    return tuple(x / math.sqrt(dot(a, a)) for x in a)


LIGHT = unit((-0.5, 0.7, 0.75))
HALF = unit((LIGHT[0], LIGHT[1], LIGHT[2] + 1.0))


def ring():
    """Triangles: of each corner its place in pixels, x to the right, y down, z to the eye, and its normal, y up."""

    def corner(i, j):
        u, v = math.tau * i / AROUND, math.tau * j / ACROSS
        normal = (math.cos(u) * math.cos(v), math.sin(u) * math.cos(v), math.sin(v))
        place = [MAJOR * part for part in (math.cos(u), math.sin(u), 0.0)]
        place = [a + MINOR * b for a, b in zip(place, normal)]

        def tilted(a):
            cosine, sine = math.cos(TILT), math.sin(TILT)
            return (a[0], a[1] * cosine + a[2] * sine, a[2] * cosine - a[1] * sine)

        x, y, z = tilted(place)
        return (WIDTH / 2 + x, HEIGHT / 2 - y, z), tilted(normal)

    for i in range(AROUND):
        for j in range(ACROSS):
            a, b, c, d = corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)
            yield a, b, c
            yield a, c, d


def seen(triangles):
    """Of each pixel that is covered, the nearest triangle: its depth, its number, and the weights of its corners."""
    nearest = {}
    for number, corners in enumerate(triangles):
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = (place for place, _ in corners)
        area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
        if area >= 0:  # seen from behind: y is down
            continue
        for j in range(math.floor(min(ay, by, cy)), math.ceil(max(ay, by, cy)) + 1):
            for i in range(math.floor(min(ax, bx, cx)), math.ceil(max(ax, bx, cx)) + 1):
                x, y = i + 0.5, j + 0.5
                second = ((x - ax) * (cy - ay) - (y - ay) * (cx - ax)) / area
                third = ((bx - ax) * (y - ay) - (by - ay) * (x - ax)) / area
                weights = (1 - second - third, second, third)
                depth = dot(weights, (az, bz, cz))
                if min(weights) >= 0 and depth > nearest.get((j, i), (-math.inf,))[0]:
                    nearest[j, i] = depth, number, weights
    return nearest


def span(row, column, length, first, middle, last):
    """The entry of a span with these normals."""
    turn = math.acos(min(dot(first, last), 1.0))
    aside = tuple(b - math.cos(turn) * a for a, b in zip(first, last))
    across = dot(unit(aside), HALF) if turn > 1e-6 else 0.0
    peak, begin = math.hypot(dot(first, HALF), across), math.atan2(across, dot(first, HALF))

    def stored(radians):
        return round(radians / (math.pi / 2) * 2**STORED)

    return {
        "row": row,
        "column": column,
        "base": round(AMBIENT + DIFFUSE * max(dot(middle, LIGHT), 0.0)),
        "amplitude": round(SPECULAR * min(peak, 1.0) ** EXPONENT),
        "length": length,
        "zeta_start": stored(-begin),
        "delta_zeta": stored(turn / length) if length else 0,
    }


def spans():
    triangles = list(ring())
    pixels = seen(triangles)

    def normal(place):
        _, number, weights = pixels[place]
        return unit([dot(weights, [normal[axis] for _, normal in triangles[number]]) for axis in range(3)])

    entries, at = [], sorted(pixels)
    begin = 0
    while begin < len(at):
        row, column = at[begin]
        patch, end = pixels[at[begin]][1] // 2, begin
        while at[end : end + 1] == [(row, column + end - begin)] and pixels[at[end]][1] // 2 == patch and end < begin + 256:
            end += 1
        normals = [normal(place) for place in (at[begin], at[(begin + end) // 2], at[end - 1])]
        entries.append(span(row, column, end - begin - 1, *normals))
        begin = end
    return entries


def packed(entry):
    word = 0
    for name, bits in FIELDS.items():
        word = word << bits | entry[name] & ((1 << bits) - 1)
    return word


def unpacked(word):
    entry = {}
    for name, bits in reversed(FIELDS.items()):
        entry[name] = word & ((1 << bits) - 1)
        word >>= bits
    for name in ("zeta_start", "delta_zeta"):
        if entry[name] >> FIELDS[name] - 1:
            entry[name] -= 1 << FIELDS[name]
    return entry


def write(path):
    entries = spans()
    if len(entries) >= PLACES:
        sys.exit(f"{len(entries)} spans, and the table has {PLACES - 1} places for them")
    # The row 511 never comes.
    words = [packed(entry) for entry in entries] + [511 << sum(FIELDS.values()) - 9] * (PLACES - len(entries))
    pathlib.Path(path).write_text("".join(f"{word:021x}\n" for word in words))
    print(f"{len(entries)} spans")


def picture(glint, table, out):
    entries = [unpacked(int(line, 16)) for line in pathlib.Path(table).read_text().split()]
    points = {}  # amplitude and angle of each pixel
    bases = {}
    for entry in entries:
        if entry["row"] == 511:
            break
        for at in range(entry["length"] + 1):
            place = entry["row"], entry["column"] + at
            angle = (entry["zeta_start"] + at * entry["delta_zeta"]) << FRACTION - STORED
            points[place], bases[place] = (entry["amplitude"], angle), entry["base"]
    different = sorted(set(points.values()))
    text = "amplitude,zeta_start\n" + "".join(f"#{amplitude},#{angle}\n" for amplitude, angle in different)
    config = pathlib.Path(__file__).parent / "spans.toml"
    command = [glint, "eval", str(config), "--quiet", "--batch", "-", f"exponent={EXPONENT}", "length=0", "delta_zeta=0"]
    answer = subprocess.run(command, input=text, stdout=subprocess.PIPE, text=True, check=True)
    results = [int(row["intensity_out"]) for row in csv.DictReader(io.StringIO(answer.stdout))]
    shine = dict(zip(different, results, strict=True))

    def colour(place):
        if place not in points:
            return BACKGROUND
        base, light = bases[place], shine[points[place]]
        return tuple(min(part + light, 255) for part in (base, base * 3 // 4, base // 4))

    rows = [bytes(part for i in range(WIDTH) for part in colour((j, i))) for j in range(HEIGHT)]
    pathlib.Path(out).write_bytes(png(WIDTH, rows))


if sys.argv[1:2] == ["spans"] and len(sys.argv) == 3:
    write(sys.argv[2])
elif sys.argv[1:2] == ["picture"] and len(sys.argv) == 5:
    picture(*sys.argv[2:])
else:
    sys.exit(__doc__)
