"""Compares a PNG of `glint render` (8 bits, RGB) with a PPM, byte for byte: compare.py PICTURE.png PICTURE.ppm"""

import struct
import sys
import zlib
from pathlib import Path


def png(path):
    data = Path(path).read_bytes()
    at, packed = 8, b""
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at : at + 8])
        body = data[at + 8 : at + 8 + size]
        if kind == b"IHDR":
            width, height, depth, colour = struct.unpack(">IIBB", body[:10])
            assert (depth, colour) == (8, 2), "not 8 bits of red, green and blue"
        if kind == b"IDAT":
            packed += body
        at += size + 12
    rows, stride = zlib.decompress(packed), 3 * width
    above, pixels = bytearray(stride), bytearray()
    for row in range(height):
        kind, *line = rows[row * (stride + 1) : (row + 1) * (stride + 1)]
        line = bytearray(line)
        for i in range(stride):
            left = line[i - 3] if i >= 3 else 0
            corner = above[i - 3] if i >= 3 else 0
            guess = left + above[i] - corner
            nearest = min((left, above[i], corner), key=lambda value: abs(guess - value))
            line[i] = (line[i] + (0, left, above[i], (left + above[i]) // 2, nearest)[kind]) & 255
        pixels += line
        above = line
    return width, height, bytes(pixels)


def ppm(path):
    kind, size, most, pixels = Path(path).read_bytes().split(b"\n", 3)
    assert (kind, most) == (b"P6", b"255"), "not a PPM of 8 bits"
    width, height = map(int, size.split())
    return width, height, pixels


wanted, seen = png(sys.argv[1]), ppm(sys.argv[2])
if wanted[:2] != seen[:2] or len(wanted[2]) != len(seen[2]):
    sys.exit(f"pictures of different sizes: {wanted[:2]} and {seen[:2]}")
differing = [at for at in range(len(wanted[2])) if wanted[2][at] != seen[2][at]]
if differing:
    at = differing[0]
    place = divmod(at // 3, wanted[0])
    sys.exit(f"{len(differing)} bytes differ, the first in row {place[0]}, column {place[1]}")
print(f"the pictures are equal, {len(seen[2])} bytes")
