// The page: controls on the left, what the core is and does on the right.

import { $, element, prose } from "./dom.js";
import { entriesOf, showEntries } from "./entries.js";
import { toml } from "./toml.js";
import { errorMap, partsView, roundedUp } from "./views.js";
import { zip } from "./zip.js";

// Requests to the worker. Requests of one kind replace each other while they wait: only the last is sent.
const waiting = new Map();
// The request that the worker computes, as { kind, then }.
let running = null;
let worker = startedWorker();

// In the page that is one file the worker is text in the page, which browsers only start as a classic script.
function startedWorker() {
  const own = globalThis.GLINT_WORKER;
  const started = new Worker(own ?? new URL("worker.js", import.meta.url), { type: own ? "classic" : "module" });
  started.onmessage = ({ data: { answer, failure } }) => {
    const { kind, then } = running;
    running = null;
    if (failure) failed(kind, `this cannot be computed here: ${failure}`);
    else then(answer);
    next();
  };
  started.onerror = (event) => failed("core", `the page cannot start its worker: ${event.message ?? "no answer"}`);
  return started;
}

// Shows why a request has no answer, and removes the pictures that it would replace.
function failed(kind, message) {
  showProblems([{ message }]);
  if (!core) $("loading").textContent = `Glint cannot start: ${message}`;
  if (kind === "picture") emptySphere();
  if (kind === "charts" || kind === "errors") empty(kind);
}

// Gives up the request that the worker computes, and goes on with those that wait.
function cancelRunning() {
  worker.terminate();
  running = null;
  worker = startedWorker();
  next();
}

function ask(request, then) {
  waiting.set(request.ask, { request, then });
  next();
}

function next() {
  if (running || waiting.size === 0) return;
  const [kind, { request, then }] = waiting.entries().next().value;
  waiting.delete(kind);
  running = { kind, then };
  worker.postMessage({ number: 0, request });
}

// --- Configuration -----------------------------------------------------------------------------

// The core that is shown; none before the first.
let core = null;
let exponent = null;

const MORE = ["interface", "package", "operands.buffered", "operands.logic", "output.registered", "strict", "domain"];
const SLIDER = 64;

function control(key) {
  const { is, min, max, options } = key.kind;
  if (is === "entries") return [entriesOf(key, edits[key.name] ?? key.value, (value) => change(key, value))];
  const id = `key-${key.name}`;
  const value = key.value;
  const changed = (read) => (event) => change(key, read(event.target));
  if (is === "choice") {
    const select = element("select", { id, onchange: changed((it) => it.value) });
    select.append(...options.map((it) => element("option", { value: it, textContent: it, selected: String(value) === it })));
    return [select];
  }
  if (is === "flag") return [element("input", { id, type: "checkbox", checked: value, onchange: changed((it) => it.checked) })];
  const interval = key.name === "pipeline.interval";
  const [low, high] = interval ? [1, 12] : key.name === "pipeline.clock_mhz" ? [20, 200] : [min, max];
  const number = is === "integer" || is === "number" || (interval && /^\d+$/.test(value));
  if (number && high - low <= (is === "integer" ? SLIDER : 400)) {
    const shown = element("output", { htmlFor: id, textContent: value });
    const read = (it) => (interval ? it.value : Number(it.value));
    const slider = element("input", { id, type: "range", min: low, max: high, step: is === "number" && high - low < 10 ? 0.01 : 1, value });
    slider.oninput = (event) => {
      shown.textContent = event.target.value;
      change(key, read(event.target));
    };
    return [slider, shown];
  }
  if (number) return [element("input", { id, type: "number", min, max, step: is === "integer" ? 1 : "any", value, onchange: changed((it) => Number(it.value)) })];
  const text = is === "integers" ? value.join(", ") : value;
  const read = (it) => (is === "integers" ? it.value.split(",").map(Number) : it.value);
  return [element("input", { id, type: "text", value: text, spellcheck: false, onchange: changed(read) })];
}

// Writes the form again where keys or devices have come or gone, and otherwise its values alone, so that a slider that is held stays.
function showForm() {
  const applied = core.keys.filter((it) => it.applies);
  const signature = JSON.stringify([core.device, applied.map((it) => [it.name, it.kind])]);
  const is = (key, name) => key.name === name || key.name.startsWith(`${name}.`);
  if ($("form").dataset.signature !== signature) {
    $("form").dataset.signature = signature;
    const focused = document.activeElement?.id;
    const row = (key) => {
      const isEntries = key.kind.is === "entries";
      const label = isEntries ? element("h2", { textContent: key.name }) : element("label", { htmlFor: `key-${key.name}`, textContent: key.name });
      return element("div", { className: "key" }, label, element("div", {}, ...control(key)), element("small", { className: "quiet" }, ...prose(key.doc)));
    };
    const [more, first] = [true, false].map((wanted) => applied.filter((key) => MORE.some((it) => is(key, it)) === wanted));
    $("form").replaceChildren(...first.map(row));
    $("form-more").replaceChildren(...more.map(row));
    $("more").hidden = false;
    if (focused && document.activeElement?.id !== focused) $(focused)?.focus();
  }
  for (const key of applied) {
    const input = $(`key-${key.name}`);
    const value = Array.isArray(key.value) ? key.value.join(", ") : key.value;
    input.closest(".key").classList.toggle("set", JSON.stringify(key.value) !== JSON.stringify(key.default));
    if (key.kind.is === "entries") {
      showEntries(input, edits[key.name] ?? key.value);
      continue;
    }
    if (document.activeElement === input) continue;
    if (input.type === "checkbox") input.checked = value;
    else input.value = value;
    const shown = input.nextElementSibling;
    if (shown) shown.textContent = value;
  }
}

// Values that were set in the form since the core that is shown.
let edits = {};

function change({ name }, value) {
  edits[name] = value;
  const own = core.keys.filter((it) => it.applies).map((it) => [it.name, it.value]);
  $("toml").value = toml(core.device, core.named ? core.name : null, core.keys, { ...Object.fromEntries(own), ...edits });
  refresh();
}

function showProblems(problems) {
  const item = ({ line, message, remedy }) => {
    const text = remedy ? `${message}; ${remedy}` : message;
    if (!line) return element("li", {}, element("code", { textContent: text }));
    const go = element("button", { type: "button", textContent: `line ${line}` });
    go.onclick = () => {
      const lines = $("toml").value.split("\n");
      const start = lines.slice(0, line - 1).join("\n").length + (line > 1 ? 1 : 0);
      $("toml").focus();
      $("toml").setSelectionRange(start, start + lines[line - 1].length);
    };
    return element("li", {}, go, ": ", element("code", { textContent: text }));
  };
  $("problems").replaceChildren(...problems.map(item));
  showAtFields(problems);
  $("toml").setAttribute("aria-invalid", String(problems.length > 0));
}

// Shows each problem of a key below the field of the key too.
function showAtFields(problems) {
  for (const old of document.querySelectorAll(".key .wrong")) old.remove();
  for (const invalid of document.querySelectorAll(".key [aria-invalid]")) invalid.removeAttribute("aria-invalid");
  for (const { key, message, remedy } of problems) {
    // The problem of a field that an entry does not have is at the entry.
    const input = key && ($(`key-${key}`) ?? $(`key-${key.slice(0, key.lastIndexOf("."))}`));
    if (!input) continue;
    input.setAttribute("aria-invalid", "true");
    input.closest(".entry, .key").append(element("p", { className: "wrong" }, ...prose(remedy ? `${message}; ${remedy}` : message)));
    if (input.closest("details")) input.closest("details").open = true;
  }
}

// The elements that show results. Each is dimmed from a change of the configuration until its results are shown.
const SHOWN = ["summary", "facts", "parts", "schedule", "diagram", "sphere", "charts", "errors", "waves", "source"];

// The requests for results that are asked for once a core is there.
const OF_A_CORE = ["picture", "charts", "errors", "waves", "sources"];

function dim(ids) {
  for (const id of ids) $(id).dataset.stale = "";
}

// Shows an element undimmed, unless its results belong to another configuration than that of the form.
function brighten(id, text) {
  if (text === $("toml").value) delete $(id).dataset.stale;
}

// Removes the pictures from an element, and the element from the page.
function empty(id) {
  $(id).replaceChildren();
  $(id).hidden = true;
}

function emptySphere() {
  $("sphere").hidden = true;
  $("sphere-image").removeAttribute("src");
  $("sphere-caption").textContent = "";
}

// Removes the pictures and files of the last core.
function emptyAll() {
  for (const id of ["charts", "errors"]) empty(id);
  for (const id of ["waves", "source", "file"]) $(id).replaceChildren();
  emptySphere();
}

function refresh() {
  const text = $("toml").value;
  dim(SHOWN);
  for (const kind of OF_A_CORE) waiting.delete(kind);
  cancelDownload("The download was cancelled, because the configuration changed.");
  $("results").setAttribute("aria-busy", "true");
  const hash = `#${encoded(text)}`;
  if (location.hash !== hash) history.replaceState(null, "", hash);
  ask({ ask: "core", toml: text }, (answer) => {
    const isLast = text === $("toml").value;
    if (isLast) $("results").setAttribute("aria-busy", "false");
    showProblems(answer.ok ? [] : answer.problems);
    if (!answer.ok) {
      if (!core) $("loading").textContent = "The results appear here once the configuration has no problem.";
      return;
    }
    if (core?.device !== answer.device) exponent = answer.exponent;
    // Pictures of another device, or of other outputs, are no older state of these results.
    const shows = ({ device, name, bounds }) => JSON.stringify([device, name, bounds.map((it) => it.output)]);
    if (core && shows(core) !== shows(answer)) emptyAll();
    core = { ...answer, text };
    if (isLast) edits = {};
    show(text);
  });
}

// --- Results -----------------------------------------------------------------------------------

function show(text) {
  const known = [...$("device").options].some((it) => it.value === core.device);
  if (known && !$("device").value.startsWith(`${core.device} `)) $("device").value = core.device;
  $("loading").hidden = true;
  $("loaded").hidden = false;
  $("summary").textContent = core.summary;
  showForm();
  showFacts();
  showSchedule();
  $("parts").replaceChildren(...partsView(core));
  $("diagram").replaceChildren(drawing(core.diagram, `Block diagram of ${core.name}`));
  for (const id of ["summary", "facts", "parts", "schedule", "diagram"]) brighten(id, text);
  if (!$("files").hidden) showFiles(text);
  if (!$("waves").hidden) showWaves(text);
  $("exponent-row").hidden = !core.draws || !core.exponents;
  if (core.exponents) {
    const [least, most] = core.exponents;
    Object.assign($("exponent"), { min: least, max: Math.min(most, 1000), value: exponent });
    $("exponent-value").textContent = exponent;
  }
  if (core.draws) showPicture(text);
  else emptySphere();
  ask({ ask: "charts", toml: text }, (answer) => showCharts(answer, text));
  if (!core.sampled) empty("errors");
  else setTimeout(() => askForErrors(text), PAUSE);
}

// A sample of the errors takes seconds. It begins when no change has followed for a while, so that a slider that is dragged does not
// wait for it.
const PAUSE = 300;

function askForErrors(text) {
  if (text === $("toml").value && text === core.text) ask({ ask: "errors", toml: text }, (answer) => showErrors(answer, text));
}

// A drawing, fitted to the page until its button is pressed.
function drawing(svg, alt) {
  const address = URL.createObjectURL(new Blob([svg], { type: "image/svg+xml" }));
  const image = element("img", { src: address, alt });
  image.onload = () => URL.revokeObjectURL(address);
  const button = element("button", { type: "button", className: "drawing", title: "Enlarge, or fit to the page" }, image);
  button.onclick = () => button.setAttribute("aria-pressed", String(image.classList.toggle("whole")));
  return button;
}

function showWaves(text) {
  ask({ ask: "waves", toml: text }, ({ ok, problems, svg, described }) => {
    if (text !== core.text) return;
    if (!ok) return showProblems(problems);
    $("waves").replaceChildren(drawing(svg, described), element("p", { className: "quiet", textContent: described }));
    brighten("waves", text);
  });
}

function showPicture(text) {
  ask({ ask: "picture", toml: text, exponent: core.exponents ? exponent : null, side: 200 }, (answer) => {
    if (text !== core.text) return;
    if (!answer.ok) return showProblems(answer.problems);
    $("sphere").hidden = false;
    $("sphere-image").src = `data:image/png;base64,${answer.png}`;
    $("sphere-caption").textContent =
      `The specular term of every pixel is a result of the core, here with n = ${answer.exponent}; the largest error against its own formula is ${answer.units.toFixed(3)} of 255.`;
    brighten("sphere", text);
  });
}

// The bound of each output, and the largest error of its sample once that is known.
function boundFacts() {
  const kind = core.proved ? "proved bound" : "stated bound";
  return core.bounds.map(({ output, units, limit }, at) => {
    const largest = core.largest?.[at] ?? null;
    const found = largest === null ? "" : `; largest of ${core.points} points ${largest.toFixed(3)}`;
    return { output, name: `${output}, ${kind} of the error`, value: units === null ? "not stated" : `${roundedUp(units)} units`, more: `allowed: below ${limit}${found}` };
  });
}

function estimateFact({ target, own, luts, dsps, block_rams, mhz }) {
  const name = own ? `${target}, estimated; the pipeline is for it` : `${target}, estimated`;
  return { target, name, value: `${luts} LUT, ${dsps} DSP, ${block_rams} RAM, ${mhz} MHz` };
}

function showFacts() {
  const facts = [
    ...boundFacts(),
    { name: "Latency", value: core.latency === null ? "by the operands" : `${core.latency} clocks` },
    { name: "A point every", value: core.interval === null ? "line" : core.interval === 1 ? "clock" : `${core.interval} clocks` },
    ...core.estimates.map(estimateFact),
  ];
  const fact = ({ output, target, name, value, more }) => {
    const made = element("div", {}, element("dt", { textContent: name }), element("dd", { textContent: value }));
    if (output) made.dataset.output = output;
    if (target) made.dataset.target = target;
    if (more) made.append(element("dd", { className: "quiet", textContent: more }));
    return made;
  };
  $("facts").replaceChildren(...facts.map(fact));
}

function showSchedule() {
  const number = (textContent) => element("td", { className: "number", textContent });
  const cell = (textContent) => element("td", { textContent });
  const head = core.pipelined ? ["stage", "microinstructions", "computes", "ns", "register bits"] : ["address", "microinstruction"];
  const row = ({ at, does, values, ns, bits }) =>
    element("tr", {}, number(at), cell(does), ...(core.pipelined ? [cell(values.join(", ")), number(ns.toFixed(2)), number(bits)] : []));
  const heads = head.map((textContent) => element("th", { scope: "col", textContent }));
  $("schedule").replaceChildren(element("table", {}, element("thead", {}, element("tr", {}, ...heads)), element("tbody", {}, ...core.schedule.map(row))));
}

// The files of the configuration, and their text; all of them once they were downloaded.
let files = { of: null, all: [], whole: false };

// Hands files of a configuration to `then`: all, for which the bench is simulated, or those that do without.
function withFiles(text, whole, then) {
  if (files.of === text && (files.whole || !whole)) return then(files.all);
  ask({ ask: whole ? "files" : "sources", toml: text }, (answer) => {
    if (!answer.ok) {
      showDownload("");
      return showProblems(answer.problems);
    }
    files = { of: text, all: answer.files, whole };
    then(files.all);
  });
}

function showFiles(text) {
  withFiles(text, false, (all) => {
    if (text !== core.text) return;
    const before = $("file").value;
    const plain = ({ name }) => element("option", { textContent: name });
    $("file").replaceChildren(...all.map(plain));
    const wanted = all.find(({ name }) => name === before) ?? all.find(({ name }) => name.endsWith(".v")) ?? all[0];
    $("file").value = wanted.name;
    $("source").textContent = wanted.text;
    brighten("source", text);
    $("files-note").hidden = files.whole;
  });
}

// A chart with its legend.
function chart({ title, caption, svg, series, y }) {
  const line = (at) => {
    const made = element("i");
    made.style.background = `var(--s${(at % 5) + 1})`;
    return made;
  };
  const legend = element("p", { className: "legend" }, ...series.map((name, at) => element("span", {}, line(at), name)));
  const figure = element("figure", {}, element("h2", { textContent: title }), element("p", { className: "quiet", textContent: y }));
  figure.insertAdjacentHTML("beforeend", svg);
  figure.append(legend, element("figcaption", { textContent: caption }));
  return figure;
}

// Shows pictures, or nothing where there are none.
function showPictures(id, pictures, text) {
  $(id).replaceChildren(...pictures);
  $(id).hidden = pictures.length === 0;
  brighten(id, text);
}

function showCharts(answer, text) {
  if (text !== core.text) return;
  if (!answer.ok) return showProblems(answer.problems);
  showPictures("charts", answer.charts.map(chart), text);
}

function showErrors(answer, text) {
  if (text !== core.text) return;
  if (!answer.ok) return showProblems(answer.problems);
  const { largest, points, charts, maps } = answer;
  Object.assign(core, { largest, points });
  showFacts();
  const map = (it, at) => errorMap(answer, it, core.bounds[at].units, largest[at]);
  showPictures("errors", [...charts.map(chart), ...maps.map(map)], text);
}

// --- Links, files, tabs ------------------------------------------------------------------------

function encoded(text) {
  return btoa(String.fromCharCode(...new TextEncoder().encode(text))).replaceAll("+", "-").replaceAll("/", "_").replace(/=+$/, "");
}

// The text of a link; throws where it is damaged.
function decoded(hash) {
  const bytes = Uint8Array.from(atob(hash.replaceAll("-", "+").replaceAll("_", "/")), (it) => it.charCodeAt(0));
  return new TextDecoder("utf-8", { fatal: true }).decode(bytes);
}

$("link").onclick = async () => {
  try {
    await navigator.clipboard.writeText(location.href);
    $("said").textContent = "copied";
  } catch {
    $("said").textContent = "the address of this page is the link";
  }
};

// Says how the download ended; while `isRunning` it can be cancelled.
function showDownload(said, isRunning = false) {
  $("said").textContent = said;
  $("cancel").hidden = !isRunning;
  $("download").disabled = isRunning;
}

// Gives up a download that waits or runs, if there is one, and says why.
function cancelDownload(why) {
  const isWaiting = waiting.delete("files");
  const isRunning = running?.kind === "files";
  if (isRunning) cancelRunning();
  if (isWaiting || isRunning) showDownload(why);
}

$("cancel").onclick = () => cancelDownload("The download was cancelled.");

$("download").onclick = () => {
  showDownload("Choosing and simulating the points of the test bench …", true);
  const text = $("toml").value;
  withFiles(text, true, (all) => {
    const address = URL.createObjectURL(zip([{ name: "core.toml", text }, ...all]));
    element("a", { href: address, download: `${core.name}.zip` }).click();
    URL.revokeObjectURL(address);
    showDownload(`${all.length + 1} files`);
  });
};

for (const tab of $("tabs").children) {
  tab.onclick = () => {
    for (const other of $("tabs").children) {
      const chosen = other === tab;
      other.setAttribute("aria-selected", String(chosen));
      other.tabIndex = chosen ? 0 : -1;
      $(other.getAttribute("aria-controls")).hidden = !chosen;
    }
    if (tab.id === "tab-files") showFiles($("toml").value);
    if (tab.id === "tab-waves") showWaves($("toml").value);
  };
  tab.onkeydown = ({ key }) => {
    const to = { ArrowRight: tab.nextElementSibling ?? $("tabs").firstElementChild, ArrowLeft: tab.previousElementSibling ?? $("tabs").lastElementChild }[key];
    to?.focus();
    to?.click();
  };
}

$("toml").oninput = () => {
  edits = {};
  refresh();
};
$("file").onchange = () => showFiles(files.of);
$("exponent").oninput = (event) => {
  exponent = Number(event.target.value);
  $("exponent-value").textContent = exponent;
  dim(["sphere"]);
  showPicture($("toml").value);
};
$("device").onchange = ({ target: { value } }) => {
  const [device, preset] = value.split(" ");
  if (!preset) {
    $("toml").value = `device = "${device}"\n`;
    return refresh();
  }
  ask({ ask: "preset", name: preset }, (answer) => {
    $("toml").value = answer.toml;
    refresh();
  });
};

window.onhashchange = fromLink;

function fromLink() {
  let text = 'device = "cosine-power"\n';
  let damaged = false;
  if (location.hash.length > 1) {
    try {
      text = decoded(location.hash.slice(1));
    } catch {
      damaged = true;
    }
  }
  $("said").textContent = damaged ? "The link is damaged: it holds no configuration. Here is another to start from." : "";
  if (core && text === $("toml").value) return;
  $("toml").value = text;
  refresh();
}

ask({ ask: "devices" }, ({ devices, functions, expressions }) => {
  $("inputs").disabled = false;
  $("loading").textContent = "Computing the core …";
  const option = (value, name, title) => element("option", { value, textContent: name, title });
  const own = ["function", "expression"];
  const known = devices.filter(({ name }) => !own.includes(name)).map(({ name, summary }) => option(name, name, summary));
  const group = (label, device, mine, presets) =>
    element("optgroup", { label }, option(device, mine), ...presets.map((it) => option(`${device} ${it}`, it)));
  $("device").replaceChildren(
    element("optgroup", { label: "Devices" }, ...known),
    group("Functions", "function", "a formula of your own", functions),
    group("Expressions of several operands", "expression", "formulas of your own", expressions),
  );
  fromLink();
});
