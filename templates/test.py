"""${ name }$: bench in Python.

The bench needs cocotb 2.1 and Icarus Verilog. Run in the directory of rtl_out/ and testbench/:

    $ python testbench/${ name }$/test_${ name }$.py

Generated files belong to their user, without conditions.
"""

import sys
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import cocotb
import glint_cocotb
from glint_cocotb import (  # noqa: F401 - cocotb runs imported tests
<%- for test in tests %>
    ${ test }$,
<%- endfor %>
)


@cocotb.test()
async def worked_example(dut: Any) -> None:
    """The worked example of the manifest."""
<%- if pipeline %>
    pipeline = await glint_cocotb.Pipeline.after_reset(dut)
    shown = await pipeline.compute(
<%- else %>
    core = await glint_cocotb.Core.after_reset(dut)
    shown = await core.compute(
<%- endif %>
<%- for line in operands %>
        ${ line }$
<%- endfor %>
    )
    assert ${ shown }$ == {
<%- for line in outputs %>
        ${ line }$
<%- endfor %>
    }


if __name__ == "__main__":
    glint_cocotb.run("${ name }$")
