"""shading_pipelined: bench in Python.

The bench needs cocotb 2.1 and Icarus Verilog. Run in the directory of rtl_out/ and testbench/:

    $ python testbench/shading_pipelined/test_shading_pipelined.py

Generated files belong to their user, without conditions.
"""

import sys
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import cocotb
import glint_cocotb
from glint_cocotb import (  # noqa: F401 - cocotb runs imported tests
    bubbles_and_stalls_change_nothing,
    points_are_exact,
    random_points_follow_the_formula,
    reset_drops_every_point,
)


@cocotb.test()
async def worked_example(dut: Any) -> None:
    """The worked example of the manifest."""
    pipeline = await glint_cocotb.Pipeline.after_reset(dut)
    shown = await pipeline.compute(
        nx=1744,  # 0.1064453125
        ny=6439,  # 0.39300537109375
        nz=12340,  # 0.753173828125
        lx=-3322,  # -0.2027587890625
        ly=-3327,  # -0.20306396484375
        lz=15695,  # 0.95794677734375
        hx=3592,  # 0.21923828125
        hy=7814,  # 0.4769287109375
        hz=13945,  # 0.85113525390625
        exponent=105,
        ambient_red=38,
        ambient_green=45,
        ambient_blue=37,
        diffuse_red=14,
        diffuse_green=55,
        diffuse_blue=69,
        specular_red=58,
        specular_green=75,
        specular_blue=5,
    )
    assert shown == {
        "red_out": 82,
        "green_out": 128,
        "blue_out": 90,
    }


if __name__ == "__main__":
    glint_cocotb.run("shading_pipelined")
