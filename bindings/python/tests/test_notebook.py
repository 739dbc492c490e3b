"""The notebook: its cells run, and their results are those that it shows."""

import ast
import contextlib
import io
import json
from pathlib import Path

import matplotlib

matplotlib.use("Agg")

NOTEBOOK = Path(__file__).parents[3] / "examples/notebook.ipynb"


def shown(outputs):
    """The text of a cell's outputs; pictures are not compared."""
    texts = [output.get("data", {}).get("text/plain") or output.get("text") or [] for output in outputs]
    return "".join("".join(text) for text in texts).strip()


def test_the_notebook_shows_what_it_computes():
    names, compared = {}, 0
    for cell in json.loads(NOTEBOOK.read_text())["cells"]:
        if cell["cell_type"] != "code":
            continue
        tree = ast.parse("".join(cell["source"]))
        value = tree.body.pop() if isinstance(tree.body[-1], ast.Expr) else None
        with contextlib.redirect_stdout(io.StringIO()) as printed:
            exec(compile(tree, "cell", "exec"), names)
            result = eval(compile(ast.Expression(value.value), "cell", "eval"), names) if value else None
        text = printed.getvalue() + ("" if result is None else repr(result))
        if expected := shown(cell["outputs"]):
            assert text.strip() == expected
            compared += 1
    assert compared >= 6
