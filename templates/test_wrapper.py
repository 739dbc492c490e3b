"""${ name }$_${ wrapper }$: bench in Python.

The bench needs cocotb 2.1 and Icarus Verilog. Run in the directory of rtl_out/ and testbench/:

    $ python testbench/${ name }$/test_${ name }$_${ wrapper }$.py

Generated files belong to their user, without conditions.
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

import glint_cocotb
from glint_cocotb import (  # noqa: F401 - cocotb runs what is imported here
<%- for test in tests %>
    ${ test }$,
<%- endfor %>
)

if __name__ == "__main__":
    glint_cocotb.run("${ name }$", "${ wrapper }$")
