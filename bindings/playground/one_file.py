"""The page as one file that needs no server: `python bindings/playground/one_file.py SITE`, a built site, writes SITE/glint.html."""

import base64
import gzip
import re
import sys
from pathlib import Path

site = Path(sys.argv[1])


def scripts(*names):
    """Modules behind one another, in place of their imports."""
    texts = ((site / f"{name}.js").read_text() for name in names)
    return "".join(re.sub(r"^import .*\n|^export ", "", text, flags=re.MULTILINE) for text in texts)


def put(text, old, new):
    """`text` with `new` in place of `old`, which it has once."""
    assert text.count(old) == 1, old
    return text.replace(old, new)


wasm = base64.b64encode(gzip.compress((site / "glint.wasm").read_bytes(), 9, mtime=0)).decode()
worker = f'globalThis.GLINT_WASM = "{wasm}";\n{scripts("wasi", "glint", "worker")}'
start = 'globalThis.GLINT_WORKER = URL.createObjectURL(new Blob([document.getElementById("worker").textContent], { type: "text/javascript" }));\n'
page = start + scripts("dom", "toml", "zip", "entries", "views", "page")
html = (site / "index.html").read_text()
html = put(html, '<link rel="stylesheet" href="style.css">', f"<style>\n{(site / 'style.css').read_text()}</style>")
html = put(
    html,
    '<script type="module" src="page.js"></script>',
    f'<script type="text/plain" id="worker">\n{worker}</script>\n<script type="module">\n{page}</script>',
)
(site / "glint.html").write_text(html)
