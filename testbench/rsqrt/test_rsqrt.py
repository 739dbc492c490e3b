"""rsqrt: bench in Python.

The bench needs cocotb 2.1 and Icarus Verilog. Run in the directory of rtl_out/ and testbench/:

    $ python testbench/rsqrt/test_rsqrt.py

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
        x=130048,  # 1.984375
    )
    assert shown.results[0] == {
        "result_out": 46523,  # 0.7098846435546875
    }


if __name__ == "__main__":
    glint_cocotb.run("rsqrt")
