"""Sets up the lines of the file `lines`, one a row, by the Python of NAME, and writes their operands into `in_python`."""
import NAME_setup as setup
import sys

sys.stdout = open("in_python", "w")
for line in open("lines"):
    *v, intensity, exponent, points = map(float, line.split())
    try:
        operands = setup.from_vectors(
            v[0:3], v[3:6], v[6:9], v[9:12],
            intensity=intensity, exponent=int(exponent), points=int(points))
        assert sorted(operands) == sorted(setup.OPERANDS)
        print(*(f"{name} {operands[name]}" for name in sorted(operands)))
    except setup.SetupError:
        print("refused")
