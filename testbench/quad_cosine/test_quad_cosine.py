"""quad_cosine: bench in Python.

The bench needs cocotb 2.1 and Icarus Verilog. Run in the directory of rtl_out/ and testbench/:

    $ python testbench/quad_cosine/test_quad_cosine.py

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
        delta_zeta=687192,  # 0.010239958763122559
        zeta_start=12679313,  # 0.1889364868402481
        exponent=20,
        length=20,
        amplitude=255,
    )
    assert shown.results[0] == {
        "intensity_out": 104,
    }


if __name__ == "__main__":
    glint_cocotb.run("quad_cosine")
