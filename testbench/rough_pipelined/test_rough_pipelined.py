"""rough_pipelined: bench in Python.

The bench needs cocotb 2.1 and Icarus Verilog. Run in the directory of rtl_out/ and testbench/:

    $ python testbench/rough_pipelined/test_rough_pipelined.py

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
        cos_gamma=1044480,  # 0.99609375
        cos_dgamma=1046381,  # 0.9979066848754883
        exponent=20,
        dgamma_negative=0,
        red=255,
        green=170,
        blue=85,
    )
    assert shown == {
        "red_out": 199,
        "green_out": 133,
        "blue_out": 66,
    }


if __name__ == "__main__":
    glint_cocotb.run("rough_pipelined")
