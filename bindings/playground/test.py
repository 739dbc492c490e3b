"""The playground in headless Chromium: `python bindings/playground/test.py SITE GLINT`, a built site and the native program.

A slider is moved, a key misspelt, a link damaged, and every view looked at; the files of the page equal those of the native
program byte for byte, and so do its messages. What is loaded keeps its budget.
"""

import functools
import gzip
import http.server
import json
import re
import subprocess
import sys
import tempfile
import threading
import zipfile
from pathlib import Path

from playwright.sync_api import expect, sync_playwright

# Bytes, gzipped.
BUDGET = 2_500_000

# Milliseconds that an event may take on a slow machine.
LIMIT = 600_000


def serve(site):
    """Serves the site below a path, as a host of many sites does; returns its address."""

    class Quiet(http.server.SimpleHTTPRequestHandler):
        def log_message(self, *_):
            pass

        def translate_path(self, path):
            return super().translate_path(path.removeprefix("/below"))

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


def every_choice_has_its_views(page):
    for choice in page.locator("#device option").evaluate_all("all => all.map(it => it.value)"):
        page.locator("#device").select_option(choice)
        # A preset is known by its name in the text, which has underscores, and a device by its key.
        preset = choice.partition(" ")[2].replace("-", "_")
        wanted = f'name = "{preset}"' if preset else f'device = "{choice}"'
        page.wait_for_function("wanted => document.getElementById('toml').value.includes(wanted)", arg=wanted, timeout=LIMIT)
        settled(page)
        expect(page.locator("#problems li")).to_have_count(0)
        for tab in ("schedule", "diagram", "waves", "files", "picture"):
            page.locator(f"#tab-{tab}").click()
            expect(page.locator(f"#{tab}")).to_be_visible()
            if tab == "waves":
                expect(page.locator("#waves img")).to_have_attribute("alt", re.compile("simulated"), timeout=LIMIT)
        if choice.startswith(("function", "expression")):
            expect(page.locator("#exponent-row")).to_be_hidden()
        assert page.locator("#schedule tr").count() > 2 and page.locator("#facts dd").count() == 6


def entries_are_edited(page):
    """The operands and results of an expression are edited in the form; a wrong field has its message at its entry."""
    page.locator("#toml").fill('device = "expression"\n')
    settled(page)
    fields = page.locator("[id='key-results.r']")
    expect(fields).to_have_value('formula = "sqrt(x^2 + y^2)", fraction = 11, error = 1')
    fields.fill('formula = "x / (2 + y)", fraction = 9')
    fields.press("Enter")
    expect(page.locator("#toml")).to_have_value(
        'device = "expression"\nresults.r = { formula = "x / (2 + y)", fraction = 9 }\n', timeout=LIMIT
    )
    settled(page)
    expect(page.locator("#problems li")).to_have_count(0)
    page.locator("[id='key-results'] button[aria-label='add an entry to results']").click()
    settled(page)
    expect(page.locator("#problems li")).to_have_count(0)
    expect(page.locator("[id='key-results.r2']")).to_have_value('formula = "x / (2 + y)", fraction = 9')
    fields.fill('formula = "x / y", fraction = 9')
    fields.press("Enter")
    expect(page.locator(".key:has([id='key-results.r']) .wrong")).to_contain_text("not finite", timeout=LIMIT)
    page.locator("button[aria-label='remove r2']").click()
    fields.fill('formula = "x * y", fraction = 9')
    fields.press("Enter")
    settled(page)
    expect(page.locator("#problems li")).to_have_count(0)


def old_results_are_dimmed(page):
    """From a change on, what belongs to the configuration before it is dimmed until its own results are there."""
    page.locator("#tab-picture").click()
    parts = ["facts", "schedule", "diagram", "sphere", "charts"]
    stale = "ids => ids.map(id => 'stale' in document.getElementById(id).dataset)"
    # The page changes and is read in one call, because the new results may be there before a second call.
    changed = f"""ids => {{
        const toml = document.getElementById("toml");
        toml.value = 'device = "lyon"\\n';
        toml.dispatchEvent(new Event("input"));
        return ({stale})(ids);
    }}"""
    assert page.evaluate(changed, parts) == [True] * len(parts)
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


def a_slider_and_the_picture_are_seen_together(page):
    page.locator("#toml").fill('device = "rough"\n')
    settled(page)
    page.locator("[id='key-cosine.fraction']").evaluate("it => it.scrollIntoView({ block: 'end' })")
    boxes = [page.locator(it).bounding_box() for it in ("[id='key-cosine.fraction']", "#results")]
    assert all(0 <= box["y"] < 900 for box in boxes), boxes
    assert boxes[0]["y"] >= boxes[1]["y"] + boxes[1]["height"], boxes


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
    address = serve(site)
    with sync_playwright() as browsers:
        browser = browsers.chromium.launch(executable_path="/usr/bin/chromium", args=["--no-sandbox"])
        page = browser.new_context(viewport={"width": 1280, "height": 900}).new_page()
        faults = []
        page.on("console", lambda it: faults.append(it.text) if it.type in ("error", "warning") else None)
        page.on("pageerror", lambda it: faults.append(str(it)))
        page.goto(address)
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
        every_choice_has_its_views(page)
        entries_are_edited(page)
        old_results_are_dimmed(page)
        a_download_can_be_cancelled(page)
        a_drawing_enlarges_by_keyboard(page)
        a_link_carries_the_configuration(page, address)
        for width in (390, 1920):
            page.set_viewport_size({"width": width, "height": 900})
            assert page.evaluate("document.documentElement.scrollWidth") <= width
            if width == 390:
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
