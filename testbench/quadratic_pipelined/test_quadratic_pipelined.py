"""quadratic_pipelined: bench in Python.

The bench needs cocotb 2.1 and Icarus Verilog. Run in the directory of rtl_out/ and testbench/:

    $ python testbench/quadratic_pipelined/test_quadratic_pipelined.py

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
        cos_gamma=1028096,  # 0.98046875
        exponent=20,
        red=255,
        green=170,
        blue=85,
    )
    assert shown == {
        "red_out": 200,
        "green_out": 133,
        "blue_out": 67,
    }


if __name__ == "__main__":
    glint_cocotb.run("quadratic_pipelined")
