"""The playground in headless Chromium: `python bindings/playground/test.py SITE GLINT`, a built site and the native program.

A slider is moved, an operand edited, a key misspelt, a link damaged, and every view looked at; the files of the page equal those of
the native program byte for byte, and so do its messages, bounds and estimates. What is loaded keeps its budget.
"""

import functools
import gzip
import http.server
import json
import math
import os
import random
import re
import subprocess
import sys
import tempfile
import threading
import tomllib
import zipfile
from pathlib import Path

from playwright.sync_api import expect, sync_playwright

# Bytes, gzipped.
BUDGET = 2_500_000

# Milliseconds that an event may take on a slow machine.
LIMIT = 600_000


def serve(site, may_load):
    """Serves the site below a path, as a host of many sites does; returns its address. The WebAssembly waits for `may_load`."""

    class Quiet(http.server.SimpleHTTPRequestHandler):
        def log_message(self, *_):
            pass

        def translate_path(self, path):
            return super().translate_path(path.removeprefix("/below"))

        def do_GET(self):
            if self.path.endswith("glint.wasm"):
                may_load.wait()
            super().do_GET()

    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), functools.partial(Quiet, directory=site))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    return f"http://127.0.0.1:{server.server_port}/below/"


def settled(page):
    """Waits until everything that was asked for is shown."""
    expect(page.locator("#results")).to_have_attribute("aria-busy", "false", timeout=LIMIT)


def native(glint, text, *arguments):
    """What the native program says of a configuration, and its files."""
    with tempfile.TemporaryDirectory() as place:
        Path(place, "core.toml").write_text(text)
        done = subprocess.run([glint, *arguments], cwd=place, capture_output=True, text=True, timeout=600)
        files = {str(it.relative_to(place)): it.read_bytes() for it in Path(place).rglob("*") if it.is_file()}
        return done, files


def changed(page, text):
    """Sets the text of the configuration, and waits until its core is shown."""
    page.locator("#toml").fill(text)
    settled(page)
    expect(page.locator("#problems li")).to_have_count(0)


# Whether an image is seen that has no picture.
BROKEN = """() => [...document.images].some(it => it.getClientRects().length > 0 && !(it.complete && it.naturalWidth > 0))"""


def nothing_is_broken_before_loading(page, address, may_load):
    """Until the program is loaded, the page says so; its list is not empty, no picture is broken, and no control can be used."""
    page.goto(address)
    expect(page.locator("#loading")).to_have_text("Loading Glint …")
    expect(page.locator("#loading")).to_be_visible()
    expect(page.locator("#device option")).to_have_text(["Loading Glint …"])
    assert not page.evaluate(BROKEN)
    for control in page.locator("select, input, textarea, button").all():
        assert control.is_disabled() or not control.is_visible(), control.evaluate("it => it.outerHTML")
    may_load.set()
    expect(page.locator("#loading")).to_be_hidden(timeout=LIMIT)
    expect(page.locator("#device")).to_be_enabled()
    assert page.locator("#device option").count() > 20


def files_are_those_of_the_native_program(page, glint, text):
    page.locator("#toml").fill(text)
    settled(page)
    expect(page.locator("#problems li")).to_have_count(0)
    with page.expect_download(timeout=LIMIT) as download:
        page.locator("#download").click()
    done, expected = native(glint, text, "generate", "core.toml")
    assert done.returncode == 0, done.stderr
    with zipfile.ZipFile(download.value.path()) as archive:
        assert archive.testzip() is None
        own = {name: archive.read(name) for name in archive.namelist()}
    assert own.keys() == expected.keys(), own.keys() ^ expected.keys()
    assert [name for name in own if own[name] != expected[name]] == []
    # The file that is shown is one of them.
    page.locator("#tab-files").click()
    name = page.locator("#file").input_value()
    assert name.endswith(".v")
    expect(page.locator("#source")).to_have_text(own[name].decode(), use_inner_text=False)
    page.locator("#tab-picture").click()


def a_slider_changes_everything(page):
    page.locator("#toml").fill('device = "cosine-power"\n')
    settled(page)
    before = page.locator("#facts").text_content()
    picture = page.locator("#sphere-image").get_attribute("src")
    slider = page.locator("[id='key-intensity.fraction']")
    box = slider.bounding_box()
    page.mouse.move(box["x"] + box["width"] * 0.56, box["y"] + box["height"] / 2)
    page.mouse.down()
    page.mouse.move(box["x"] + box["width"] * 0.1, box["y"] + box["height"] / 2, steps=8)
    page.mouse.up()
    slider.press("ArrowLeft")
    value = slider.input_value()
    assert int(value) < 16
    expect(page.locator("#toml")).to_have_value(f'device = "cosine-power"\n\n[intensity]\nfraction = {value}\n')
    settled(page)
    assert page.locator("#facts").text_content() != before
    expect(page.locator("#sphere-image")).not_to_have_attribute("src", picture, timeout=LIMIT)


def a_wrong_key_gets_the_message_of_the_command_line(page, glint):
    text = 'device = "lyon"\npwer = 3\n'
    page.locator("#toml").fill(text)
    problem = page.locator("#problems li")
    expect(problem).to_contain_text("line 2", timeout=LIMIT)
    done, _ = native(glint, text, "generate", "core.toml", "--json")
    said = json.loads(done.stdout)["problems"][0]
    expect(problem).to_contain_text(said["message"])
    expect(problem).to_contain_text(said["remedy"])
    problem.locator("button").click()
    chosen = page.evaluate("document.activeElement.value.slice(document.activeElement.selectionStart, document.activeElement.selectionEnd)")
    assert chosen == "pwer = 3"


def taken(kind, names):
    """The names of a kind of check in tests/kinds.toml that this run takes, as tests/common/sample.rs takes them."""
    if os.environ.get("GLINT_TESTS") == "all":
        return names
    cases = tomllib.loads(Path("tests/kinds.toml").read_text())[kind]
    if seed := os.environ.get("GLINT_SAMPLE"):
        drawn = random.Random(f"{seed} {kind}").sample(names, cases["drawn"])
        print(f"{kind}: {drawn}")
        return drawn
    assert set(cases["fixed"]) <= set(names), names
    return cases["fixed"]


def views_of_choices(page):
    """Every view of a device, a function or an expression is there, without a fault."""
    choices = page.locator("#device option").evaluate_all("all => all.map(it => it.value)")
    for choice in taken("choices of the page", choices):
        page.locator("#device").select_option(choice)
        # A preset is known by its name in the text, which has underscores, and a device by its key.
        preset = choice.partition(" ")[2].replace("-", "_")
        wanted = f'name = "{preset}"' if preset else f'device = "{choice}"'
        page.wait_for_function("wanted => document.getElementById('toml').value.includes(wanted)", arg=wanted, timeout=LIMIT)
        settled(page)
        expect(page.locator("#problems li")).to_have_count(0)
        for tab in ("parts", "schedule", "diagram", "waves", "files", "picture"):
            page.locator(f"#tab-{tab}").click()
            expect(page.locator(f"#{tab}")).to_be_visible()
            if tab == "parts":
                expect(page.locator("#parts tbody tr").first).to_be_visible()
            if tab == "waves":
                expect(page.locator("#waves img")).to_have_attribute("alt", re.compile("simulated"), timeout=LIMIT)
        if choice.startswith(("function", "expression")):
            expect(page.locator("#exponent-row")).to_be_hidden()
        assert page.locator("#schedule tr").count() > 2
        assert page.locator("#facts [data-output]").count() > 0 and page.locator("#facts [data-target]").count() > 3
        # All pictures of the choice are there in the end, and none of them is broken.
        expect(page.locator("#picture figure:visible").first).to_be_visible(timeout=LIMIT)
        expect(page.locator("#picture [data-stale]:visible")).to_have_count(0, timeout=LIMIT)
        assert not page.evaluate(BROKEN), choice


def verilog(page):
    """The Verilog of the top module, once it is that of the configuration."""
    page.locator("#tab-files").click()
    expect(page.locator("#source:not([data-stale])")).to_be_visible(timeout=LIMIT)
    page.locator("#file").select_option("rtl_out/core/core.v")
    text = page.locator("#source").text_content()
    page.locator("#tab-picture").click()
    return text


def type_into(page, name, text):
    """Replaces the text of an input of the form by keyboard."""
    page.locator(f"[id='key-{name}']").focus()
    page.keyboard.press("Control+A")
    page.keyboard.type(text)
    page.keyboard.press("Enter")


def entries_are_edited(page, glint):
    """The fields of operands and results are read and edited in the form; a wrong field has its message at its entry."""
    changed(page, 'device = "expression"\n')
    before = verilog(page)
    for field, value in [("operands.x.bits", "12"), ("operands.x.fraction", "11"), ("results.r.fraction", "11"), ("results.r.error", "1")]:
        expect(page.locator(f"[id='key-{field}']")).to_have_value(value)
    expect(page.locator("[id='key-operands.x.signed']")).to_be_checked()
    formula = page.locator("[id='key-results.r.formula']")
    expect(formula).to_have_value("sqrt(x^2 + y^2)")
    assert formula.bounding_box()["width"] > 250
    # An edit changes the text, and the Verilog as the native program writes it.
    type_into(page, "operands.x.bits", "10")
    text = (
        'device = "expression"\n'
        "operands.x = { bits = 10, fraction = 11, signed = true }\n"
        "operands.y = { bits = 12, fraction = 11, signed = true }\n"
    )
    expect(page.locator("#toml")).to_have_value(text, timeout=LIMIT)
    settled(page)
    after = verilog(page)
    _, files = native(glint, text, "generate", "core.toml")
    assert after != before and after == files["rtl_out/core/core.v"].decode()
    # A field is added, has its message at its entry, and is removed.
    entry = page.locator("[id='key-operands.x']")
    entry.locator("select").last.select_option("from")
    entry.get_by_role("button", name="Add field").click()
    expect(page.locator("[id='key-operands.x.from']")).to_be_focused()
    expect(entry.locator(".wrong")).to_contain_text("domain", timeout=LIMIT)
    entry.get_by_role("button", name="remove from of x").click()
    expect(page.locator("#toml")).to_have_value(text, timeout=LIMIT)
    expect(page.locator("#problems li")).to_have_count(0, timeout=LIMIT)
    settled(page)
    # An entry is added, edited, renamed and removed.
    page.get_by_role("button", name="Add to results").click()
    type_into(page, "results.r2.formula", "x / y")
    expect(page.locator("[id='key-results.r2'] .wrong")).to_contain_text("not finite", timeout=LIMIT)
    type_into(page, "results.r2.formula", "x * y")
    page.locator("[id='name-results.r2']").fill("p")
    page.locator("[id='name-results.r2']").press("Enter")
    results = (
        'results.r = { formula = "sqrt(x^2 + y^2)", fraction = 11, error = 1 }\n'
        'results.p = { formula = "x * y", fraction = 11, error = 1 }\n'
    )
    expect(page.locator("#toml")).to_have_value(text + results, timeout=LIMIT)
    settled(page)
    expect(page.locator("#problems li")).to_have_count(0)
    expect(page.locator("#facts [data-output]")).to_have_count(2)
    page.get_by_role("button", name="remove p", exact=True).click()
    expect(page.locator("#toml")).to_have_value(text, timeout=LIMIT)
    settled(page)
    expect(page.get_by_role("button", name="remove r", exact=True)).to_be_disabled()
    # A key of the same table is written so that TOML accepts it.
    page.locator("#more").evaluate("it => { it.open = true; }")
    page.locator("[id='key-operands.buffered']").check()
    expect(page.locator("#toml")).to_have_value(text + "operands.buffered = true\n", timeout=LIMIT)
    settled(page)
    expect(page.locator("#problems li")).to_have_count(0)
    # The form follows the text.
    changed(page, 'device = "expression"\nname = "own"\nresults.r = { formula = "x + y", fraction = 9 }\n')
    expect(formula).to_have_value("x + y")
    expect(page.locator("[id='key-results.r.error']")).to_have_count(0)
    type_into(page, "results.r.fraction", "8")
    expect(page.locator("#toml")).to_have_value(
        'device = "expression"\nname = "own"\nresults.r = { formula = "x + y", fraction = 8 }\n', timeout=LIMIT
    )
    settled(page)


POLAR = """device = "expression"
let.s = "x^2 + y^2"
operands.x = { bits = 10, fraction = 9, signed = true }
operands.y = { bits = 10, fraction = 9, signed = true }
results.r = { formula = "sqrt(s)", fraction = 9 }
results.angle = { formula = "atan2(y, x) / pi", fraction = 9, error = 0.8, where = "s > 0" }
"""


def functions_of_a_unit_are_edited(page, glint):
    """The tables of a function of a unit have cards within its card."""
    changed(page, 'device = "unit"\n')
    expect(page.locator("[id='key-functions.rcp.operands.x.bits']")).to_have_value("12")
    formula = page.locator("[id='key-functions.rsqrt.results.r.formula']")
    expect(formula).to_have_value("1 / sqrt(x)")
    type_into(page, "functions.rsqrt.results.r.formula", "sqrt(x)")
    line = 'functions.rsqrt.results.r = { formula = "sqrt(x)", fraction = 8, error = 1, where = "x > 0" }\n'
    expect(page.locator("#toml")).to_have_value(re.compile(re.escape(line)), timeout=LIMIT)
    settled(page)
    text = page.locator("#toml").input_value()
    _, files = native(glint, text, "generate", "core.toml")
    assert verilog(page) == files["rtl_out/core/core.v"].decode()
    # A function is renamed, and its tables with it.
    page.locator("[id='name-functions.rsqrt']").fill("root")
    page.locator("[id='name-functions.rsqrt']").press("Enter")
    expect(page.locator("[id='key-functions.root.operands.x.fraction']")).to_have_value("8")
    expect(page.locator("#toml")).to_have_value(re.compile(r"functions\.root\.operands\.x = "), timeout=LIMIT)
    # An operand is added within a function.
    page.get_by_role("button", name="Add to functions.root.operands").click()
    expect(page.locator("[id='key-functions.root.operands.o2'] .wrong")).to_contain_text("no result depends", timeout=LIMIT)


def bounds_and_estimates_are_those_of_the_native_program(page, glint):
    """Each result has its own bound, and each FPGA family its estimate."""
    changed(page, POLAR)
    _, files = native(glint, POLAR, "generate", "core.toml")
    bounds = json.loads(files["rtl_out/core/core.json"])["accuracy"]["bounds"]
    assert list(bounds) == ["r_out", "angle_out"]
    expect(page.locator("#facts [data-output]")).to_have_count(2)
    for output, bound in bounds.items():
        fact = page.locator(f"#facts [data-output={output}]")
        expect(fact.locator("dt")).to_contain_text(f"{output}, proved bound")
        expect(fact.locator("dd").first).to_have_text(f"{math.ceil(bound * 1000) / 1000:.3f} units")
    expect(page.locator("#facts [data-output=angle_out]")).to_contain_text("below 0.8")
    done, _ = native(glint, POLAR, "estimate", "core.toml")
    rows = [[it.strip() for it in line.split("|")[2:7]] for line in done.stdout.splitlines() if line.startswith("| core ")]
    # The title of the first column is `core`, too.
    assert rows.pop(0)[0] == "family", done.stdout
    families = {family: f"{luts} LUT, {dsps} DSP, {rams} RAM, {mhz} MHz" for family, luts, dsps, rams, mhz in rows}
    assert len(families) >= 7, done.stdout
    shown = page.locator("#facts [data-target]").evaluate_all("all => all.map(it => [it.dataset.target, it.querySelector('dd').textContent])")
    assert dict(shown) == families, dict(shown).items() ^ families.items()


def errors_are_shown_over_the_operands(page):
    """A map of the errors for each result, blank where nothing is promised, and the shares of the parts; a curve for one operand."""
    changed(page, POLAR)
    maps = page.locator("#errors:not([data-stale]) figure.map")
    expect(maps).to_have_count(2, timeout=LIMIT)
    for at, output in enumerate(["r_out", "angle_out"]):
        expect(maps.nth(at)).to_have_attribute("data-output", output)
        expect(maps.nth(at).locator("figcaption")).to_contain_text("sample")
        fact = page.locator(f"#facts [data-output={output}]")
        bound, largest = (float(re.search(it, fact.text_content())[1]) for it in (r"([\d.]+) units", r"largest of \d+ points ([\d.]+)"))
        assert 0 < largest <= bound, fact.text_content()
    # The number of transparent points of a map.
    blank = """async image => {
        const picture = new Image();
        picture.src = image.getAttribute("href");
        await picture.decode();
        const canvas = new OffscreenCanvas(picture.width, picture.height);
        const context = canvas.getContext("2d");
        context.drawImage(picture, 0, 0);
        const { data } = context.getImageData(0, 0, picture.width, picture.height);
        return data.filter((_, at) => at % 4 === 3).filter(it => it === 0).length;
    }"""
    assert maps.first.locator("image").evaluate(blank) == 0
    # x < y is true for a bit less than half of the points.
    changed(page, 'device = "expression"\nresults.r = { formula = "x + y", fraction = 4, where = "x < y" }\n')
    expect(maps).to_have_count(1, timeout=LIMIT)
    expect(maps.locator("figcaption")).to_contain_text("Hatched")
    assert 48 * 48 * 0.5 <= maps.locator("image").evaluate(blank) <= 48 * 48 * 0.53
    changed(page, POLAR)
    page.locator("#tab-parts").click()
    expect(page.locator("#parts th")).to_have_text(["part", "share in r_out, units", "share in angle_out, units", "LUTs, about", "products"])
    for column in (2, 3):
        assert page.locator(f"#parts td:nth-child({column}) .bar").count() > 0
    page.locator("#tab-picture").click()
    changed(page, 'device = "expression"\noperands.x = { bits = 8, fraction = 7 }\nresults.s = { formula = "sin(x)", fraction = 8 }\nresults.c = { formula = "cos(x)", fraction = 8 }\n')
    expect(maps).to_have_count(0)
    expect(page.locator("#errors figure")).to_have_count(1, timeout=LIMIT)
    expect(page.locator("#errors .legend")).to_contain_text("c_out")


def no_picture_of_the_last_device_stays(page):
    """In the moment in which the results of another device are there, no picture of the device before it is."""
    # What is seen of pictures when the bounds change.
    watch = """outputs => new Promise(done => {
        const facts = document.getElementById("facts");
        const watcher = new MutationObserver(() => {
            if (!facts.querySelector(`[data-output=${outputs}]`)) return;
            watcher.disconnect();
            const seen = [...document.querySelectorAll("#picture figure")].filter(it => it.getClientRects().length > 0);
            done([seen.length, document.getElementById("sphere-image").getAttribute("src"), document.getElementById("waves").children.length]);
        });
        watcher.observe(facts, { childList: true });
        const toml = document.getElementById("toml");
        toml.value = TEXT;
        toml.dispatchEvent(new Event("input"));
    })"""
    changed(page, 'device = "lyon"\n')
    expect(page.locator("#sphere-image")).to_have_attribute("src", re.compile("^data:image/png"), timeout=LIMIT)
    expect(page.locator("#charts figure").first).to_be_visible(timeout=LIMIT)
    page.locator("#tab-waves").click()
    expect(page.locator("#waves img")).to_be_visible(timeout=LIMIT)
    page.locator("#tab-picture").click()
    assert page.evaluate(watch.replace("TEXT", json.dumps(POLAR)), "angle_out") == [0, None, 0]
    settled(page)
    expect(page.locator("#errors figure.map")).to_have_count(2, timeout=LIMIT)
    expect(page.locator("#charts figure")).to_have_count(0)
    expect(page.locator("#sphere")).to_be_hidden()
    assert page.evaluate(watch.replace("TEXT", json.dumps('device = "lyon"\n')), "red_out") == [0, None, 0]
    settled(page)
    expect(page.locator("#sphere")).to_be_visible(timeout=LIMIT)
    expect(page.locator("#errors figure")).to_have_count(0)


def old_results_are_dimmed(page):
    """From a change on, what belongs to the configuration before it is dimmed until its own results are there."""
    changed(page, 'device = "cosine-power"\n')
    page.locator("#tab-picture").click()
    expect(page.locator("#charts figure").first).to_be_visible(timeout=LIMIT)
    parts = ["facts", "parts", "schedule", "diagram", "sphere", "charts"]
    stale = "ids => ids.map(id => 'stale' in document.getElementById(id).dataset)"
    # The page changes and is read in one call, because the new results may be there before a second call.
    change_and_read = f"""ids => {{
        const toml = document.getElementById("toml");
        toml.value = 'device = "lyon"\\n';
        toml.dispatchEvent(new Event("input"));
        return ({stale})(ids);
    }}"""
    assert page.evaluate(change_and_read, parts) == [True] * len(parts)
    for part in parts:
        expect(page.locator(f"#{part}")).not_to_have_attribute("data-stale", "", timeout=LIMIT)
    page.locator("#toml").fill('device = "lyon"\npower = 3\n')
    expect(page.locator("#problems li")).to_have_count(1, timeout=LIMIT)
    assert page.evaluate(stale, parts) == [True] * len(parts)
    # The message is at the field, too.
    expect(page.locator(".key:has([id='key-power']) .wrong")).to_contain_text("power cannot be 3")


def a_download_can_be_cancelled(page):
    page.locator("#toml").fill('device = "shading"\nlights = 2\n')
    settled(page)
    # Each pair of actions is one call, because the download may end before a second call.
    page.evaluate("['download', 'cancel'].forEach(id => document.getElementById(id).click())")
    expect(page.locator("#said")).to_contain_text("cancelled")
    page.evaluate("""() => {
        document.getElementById("download").click();
        const toml = document.getElementById("toml");
        toml.value = 'device = "lyon"\\n';
        toml.dispatchEvent(new Event("input"));
    }""")
    expect(page.locator("#said")).to_contain_text("because the configuration changed")
    settled(page)
    expect(page.locator("#facts")).not_to_have_attribute("data-stale", "", timeout=LIMIT)


def a_drawing_enlarges_by_keyboard(page):
    page.locator("#tab-diagram").click()
    page.locator("#diagram button").press("Enter")
    expect(page.locator("#diagram img")).to_have_class("whole")
    page.locator("#tab-picture").click()


def a_wide_form_fits(page):
    """At the width of a telephone, the form of an expression and its pictures need no scrolling to the side."""
    changed(page, POLAR)
    expect(page.locator("#errors figure.map")).to_have_count(2, timeout=LIMIT)
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    for field in page.locator("#form .entry input").all():
        box = field.bounding_box()
        assert box["x"] >= 0 and box["x"] + box["width"] <= 390, box


def a_slider_and_the_picture_are_seen_together(page):
    page.locator("#toml").fill('device = "rough"\n')
    settled(page)
    # Pictures of the last device leave the page late, and others come late, so that the form moves.
    page.wait_for_function(
        """() => {
            const slider = document.getElementById("key-cosine.fraction");
            slider.scrollIntoView({ block: "end" });
            const [own, results] = [slider, document.getElementById("results")].map((it) => it.getBoundingClientRect());
            const areSeen = [own, results].every(({ top }) => 0 <= top && top < innerHeight);
            return areSeen && own.top >= results.bottom;
        }""",
        timeout=LIMIT,
    )


def a_link_carries_the_configuration(page, address):
    page.locator("#toml").fill('device = "rough"\narchitecture = "pipelined"\n[pipeline]\ninterval = 3\n')
    settled(page)
    link = page.url
    other = page.context.new_page()
    other.goto(link)
    settled(other)
    expect(other.locator("#facts")).to_contain_text("3 clocks")
    other.goto(f"{address}#%%%")
    expect(other.locator("#said")).to_contain_text("damaged", timeout=LIMIT)
    other.close()


def main():
    site, glint = (Path(it).resolve() for it in sys.argv[1:3])
    whole = site / "glint.html"
    gzipped = {it: len(gzip.compress(it.read_bytes(), 9)) for it in site.iterdir()}
    loaded = sum(size for it, size in gzipped.items() if it != whole)
    assert max(loaded, gzipped[whole]) <= BUDGET, f"{loaded} bytes gzipped, {gzipped[whole]} in one file"
    may_load = threading.Event()
    address = serve(site, may_load)
    with sync_playwright() as browsers:
        browser = browsers.chromium.launch(executable_path="/usr/bin/chromium", args=["--no-sandbox"])
        page = browser.new_context(viewport={"width": 1280, "height": 900}).new_page()
        faults = []
        page.on("console", lambda it: faults.append(it.text) if it.type in ("error", "warning") else None)
        page.on("pageerror", lambda it: faults.append(str(it)))
        nothing_is_broken_before_loading(page, address, may_load)
        expect(page.locator("#sphere-image")).to_have_attribute("src", re.compile("^data:image/png"), timeout=LIMIT)
        settled(page)
        a_slider_changes_everything(page)
        for text in [
            'device = "cosine-power"\n',
            'device = "rough"\narchitecture = "pipelined"\n\n[pipeline]\ninterval = 3\n',
            'device = "expression"\nname = "own"\nresults.r = { formula = "x * y", fraction = 11 }\n',
            'device = "function"\nname = "own"\n\n[function]\nformula = "exp(-x)"\nfrom = 0\nto = 1\n',
        ]:
            files_are_those_of_the_native_program(page, glint, text)
        a_wrong_key_gets_the_message_of_the_command_line(page, glint)
        views_of_choices(page)
        entries_are_edited(page, glint)
        functions_of_a_unit_are_edited(page, glint)
        bounds_and_estimates_are_those_of_the_native_program(page, glint)
        errors_are_shown_over_the_operands(page)
        no_picture_of_the_last_device_stays(page)
        old_results_are_dimmed(page)
        a_download_can_be_cancelled(page)
        a_drawing_enlarges_by_keyboard(page)
        a_link_carries_the_configuration(page, address)
        for width in (390, 1920):
            page.set_viewport_size({"width": width, "height": 900})
            assert page.evaluate("document.documentElement.scrollWidth") <= width
            if width == 390:
                a_wide_form_fits(page)
                a_slider_and_the_picture_are_seen_together(page)
        # Without a server.
        page.goto(whole.as_uri())
        expect(page.locator("#sphere-image")).to_have_attribute("src", re.compile("^data:image/png"), timeout=LIMIT)
        a_slider_changes_everything(page)
        files_are_those_of_the_native_program(page, glint, 'device = "cosine-power"\n')
        assert faults == [], faults
        browser.close()
    print(f"{loaded} bytes gzipped, of {BUDGET}")


main()
