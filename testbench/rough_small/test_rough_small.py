"""rough_small: bench in Python.

The bench needs cocotb 2.1 and Icarus Verilog. Run in the directory of rtl_out/ and testbench/:

    $ python testbench/rough_small/test_rough_small.py

Generated files belong to their user, without conditions.
"""

import sys
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import cocotb
import glint_cocotb
from glint_cocotb import (  # noqa: F401 - cocotb runs imported tests
    computations_are_exact,
    formula_holds_at_random_points,
    held_start_repeats,
    reset_ends_a_computation,
    writes_and_starts_while_busy_are_ignored,
)


@cocotb.test()
async def worked_example(dut: Any) -> None:
    """The worked example of the manifest."""
    core = await glint_cocotb.Core.after_reset(dut)
    shown = await core.compute(
        cos_gamma=261120,  # 0.99609375
        cos_dgamma=261596,  # 0.9979095458984375
        exponent=20,
        dgamma_negative=0,
        red=255,
        green=170,
        blue=85,
    )
    assert shown.results[0] == {
        "red_out": 199,
        "green_out": 133,
        "blue_out": 66,
    }


if __name__ == "__main__":
    glint_cocotb.run("rough_small")
