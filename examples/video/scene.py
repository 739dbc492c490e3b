#!/usr/bin/env python3
"""The picture of examples/video by integers: geometry here, highlights by Glint's golden model.

    scene.py GLINT FRAME BITS PICTURE.png        BITS of a colour: 8, or 4 by a pattern

Knows nothing of the Verilog: places are squared, roots are math.isqrt, and the highlight of each cosine that occurs is what
`glint eval` says. See ball.v for what the numbers mean.
"""

import csv
import io
import math
import pathlib
import struct
import subprocess
import sys
import zlib

WIDTH, HEIGHT = 640, 480
RADIUS = 448  # in half pixels
EXPONENT, HIGHLIGHT = 48, {"red": 230, "green": 220, "blue": 200}
BACKGROUND = (13, 15, 20)
BAYER = ((0, 8, 2, 10), (12, 4, 14, 6), (3, 11, 1, 9), (15, 7, 13, 5))


def half_vector(frame):
    """(hx, hy)/448 in a frame, s0.24."""
    hx, hy = -10877, 14503
    for _ in range(frame):
        hx -= hy >> 6
        hy += hx >> 6
    return hx, hy


def pixel(x, y, hx, hy):
    """cos gamma as u1.16, 0 where there is no highlight, and the colour without it."""
    square = RADIUS**2 - x**2 - y**2
    if square < 0:
        return 0, BACKGROUND
    z = math.isqrt(square << 14)  # seven bits behind the point
    cosine = (x * hx + y * hy + (z << 8)) >> 8
    facing = 2 * cosine - (cosine >> 2) - (z + (z >> 3) + (z >> 6) + (z >> 9))
    share = min(max(facing, 0) >> 8, 255)
    light = 32 + share - (share >> 2)
    colour = tuple(part * light >> 5 for part in (3, 11, 17))
    return (max(cosine, 0) if facing >= 0 else 0), colour


def highlights(glint, cosines):
    """The highlight of each cosine, by the golden model."""
    points = "cos_gamma\n" + "".join(f"#{cosine}\n" for cosine in cosines)
    operands = [f"exponent={EXPONENT}", *(f"{name}={value}" for name, value in HIGHLIGHT.items())]
    config = pathlib.Path(__file__).parent / "highlight.toml"
    command = [glint, "eval", str(config), "--quiet", "--batch", "-", *operands]
    answer = subprocess.run(command, input=points, stdout=subprocess.PIPE, text=True, check=True)
    rows = csv.DictReader(io.StringIO(answer.stdout))
    colours = [tuple(int(row[f"{name}_out"]) for name in HIGHLIGHT) for row in rows]
    return dict(zip(cosines, colours, strict=True))


def png(width, rows):
    """A PNG of 8 bits of red, green and blue; each pixel is stored as the difference from the one before."""

    def chunk(kind, body):
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    packed = b"".join(b"\1" + bytes((a - b) & 255 for a, b in zip(row, bytes(3) + row)) for row in rows)
    header = struct.pack(">IIBBBBB", width, len(rows), 8, 2, 0, 0, 0)
    body = zlib.compress(packed, 9)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", body) + chunk(b"IEND", b"")


def dithered(rows):
    """The rows in four bits a colour, as a screen with 16 levels shows them."""

    def level(colour, threshold):
        return (colour - colour // 16 + threshold) // 16 * 17

    return [
        bytes(level(colour, BAYER[j % 4][at // 3 % 4]) for at, colour in enumerate(row))
        for j, row in enumerate(rows)
    ]


def main():
    if len(sys.argv) != 5 or sys.argv[3] not in ("4", "8"):
        sys.exit(__doc__)
    glint, frame, bits, out = sys.argv[1], int(sys.argv[2]), int(sys.argv[3]), sys.argv[4]
    hx, hy = half_vector(frame)
    places = [[(2 * i + 1 - WIDTH, HEIGHT - 1 - 2 * j) for i in range(WIDTH)] for j in range(HEIGHT)]
    pixels = [[pixel(x, y, hx, hy) for x, y in row] for row in places]
    shine = highlights(glint, sorted({cosine for row in pixels for cosine, _ in row}))
    rows = [
        bytes(min(base + light, 255) for cosine, colour in row for base, light in zip(colour, shine[cosine]))
        for row in pixels
    ]
    pathlib.Path(out).write_bytes(png(WIDTH, rows if bits == 8 else dithered(rows)))


if __name__ == "__main__":
    main()
