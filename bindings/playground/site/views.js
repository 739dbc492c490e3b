// Views of the errors of a core: a map over two operands, and a table of the parts or terms that add up to a bound.

import { element } from "./dom.js";

// Colours from no error to the largest of a map, legible on light and dark ground.
const COLOURS = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]];

// A number for people, such as −0.25.
const short = (value) => String(Number(value.toPrecision(4))).replace("-", "−");

// A bound with three places, rounded up, so that it stays one.
export function roundedUp(bound) {
  const nearest = bound.toFixed(3);
  return Number(nearest) < bound ? (bound + 0.001).toFixed(3) : nearest;
}

function colour(share) {
  const place = Math.min(Math.max(share, 0), 1) * (COLOURS.length - 1);
  const at = Math.min(Math.floor(place), COLOURS.length - 2);
  return COLOURS[at].map((from, it) => Math.round(from + (COLOURS[at + 1][it] - from) * (place - at)));
}

// The picture of the errors of a map, a pixel for each; transparent where nothing is promised. The rows begin at the bottom.
function pixels(errors, width, height, most) {
  const canvas = element("canvas", { width, height });
  const context = canvas.getContext("2d");
  const image = context.createImageData(width, height);
  for (const [at, error] of errors.entries()) {
    const pixel = (height - 1 - Math.floor(at / width)) * width + (at % width);
    if (error !== null) image.data.set([...colour(error / most), 255], 4 * pixel);
  }
  context.putImageData(image, 0, 0);
  return canvas.toDataURL();
}

// The map of an output: `bound` is its bound or null, and `largest` its largest error in the sample or null.
export function errorMap({ x, y, others, points }, { output, errors }, bound, largest) {
  const most = bound ?? (largest || 1);
  const title = `The error of ${output} over ${x.name} and ${y.name}`;
  const figure = element("figure", { className: "map" }, element("h2", { textContent: title }));
  figure.dataset.output = output;
  const picture = pixels(errors, x.count, y.count, most);
  const stops = COLOURS.map((it, at) => `<stop offset="${at / (COLOURS.length - 1)}" stop-color="rgb(${it})"/>`).join("");
  const text = (at, up, anchor, words) => `<text x="${at}" y="${up}" text-anchor="${anchor}" font-size="19">${words}</text>`;
  const top = bound === null ? `${short(most)} units` : `bound ${roundedUp(bound)}`;
  figure.insertAdjacentHTML("beforeend", `<svg viewBox="0 0 600 405" role="img">
<defs><linearGradient id="scale-${output}" x1="0" x2="0" y1="1" y2="0">${stops}</linearGradient>
<pattern id="blank-${output}" width="8" height="8" patternUnits="userSpaceOnUse" patternTransform="rotate(45)"><path class="hatch" d="M0 0V8"/></pattern></defs>
<rect class="frame" x="80" y="10" width="340" height="340" fill="url(#blank-${output})"/>
<image x="80" y="10" width="340" height="340" preserveAspectRatio="none" href="${picture}"/>
${text(80, 372, "start", short(x.from))}${text(250, 392, "middle", x.name)}${text(420, 372, "end", short(x.to))}
${text(74, 350, "end", short(y.from))}${text(74, 184, "end", y.name)}${text(74, 25, "end", short(y.to))}
<rect class="frame" x="436" y="10" width="16" height="340" fill="url(#scale-${output})"/>
${text(460, 350, "start", "0")}${text(460, 25, "start", top)}</svg>`);
  figure.querySelector("svg").setAttribute("aria-label", title);
  figure.querySelector("image").style.imageRendering = "pixelated";
  figure.append(element("figcaption", { textContent: mapCaption(errors, others, points, largest) }));
  return figure;
}

function mapCaption(errors, others, points, largest) {
  const found = largest === null ? "Nothing is promised at any of them." : `The largest error among them is ${largest.toFixed(3)} units.`;
  const blank = largest !== null && errors.includes(null) ? " Hatched points are blank: the contract promises nothing there." : "";
  const fixed = others.map(({ name, value }) => `${name} = ${short(value)}`).join(", ");
  const rest = fixed && ` The other operands are at the middle of their domains: ${fixed}.`;
  return `A sample of ${points} points, spread evenly; between them the error may be larger. ${found}${blank}${rest}`;
}

const cell = (...children) => element("td", {}, ...children);
const number = (textContent) => element("td", { className: "number", textContent });

// A share of a bound as a number and a bar. `most` is the share of a full bar.
function share(units, most) {
  if (!units) return element("td", { className: "number share" });
  const bar = element("span", { className: "bar" });
  bar.style.width = `${Math.min((100 * units) / most, 100)}%`;
  return element("td", { className: "number share" }, roundedUp(units), bar);
}

function table(heads, rows) {
  const head = element("tr", {}, ...heads.map(([textContent, className = ""]) => element("th", { scope: "col", textContent, className })));
  return element("div", { className: "scrolled", tabIndex: 0, role: "group", ariaLabel: "table" }, element("table", {}, element("thead", {}, head), element("tbody", {}, ...rows)));
}

// The parts of a computation in their order, each with its share in the error of each output.
function partsTable(parts, bounds) {
  const most = bounds.map(({ units }, at) => Math.max(units ?? 0, ...parts.map((it) => it.shares[at])));
  const row = ({ name, words, format, shares, cells, products }) => {
    const what = cell(element("code", { textContent: name }), " ", words, element("small", { className: "quiet", textContent: format }));
    return element("tr", {}, what, ...shares.map((it, at) => share(it, most[at])), number(cells ? Math.round(cells) : ""), number(products || ""));
  };
  const shares = bounds.map(({ output }) => [`share in ${output}, units`, "number share"]);
  return table([["part"], ...shares, ["LUTs, about", "number"], ["products", "number"]], parts.map(row));
}

// The terms of one bound.
function termsTable({ units, terms }) {
  const row = (it) => element("tr", {}, cell(element("code", { textContent: it.key })), cell(it.what), share(it.units, units ?? 1));
  return table([["key"], ["what rounds or approximates"], ["units", "number share"]], terms.map(row));
}

// Everything that adds up to the bounds: the parts of the computation, or the terms. Outputs with equal bounds share a table.
export function partsView({ parts, bounds }) {
  if (parts.length > 0) {
    const said = "The operations of the core in their order. A bar is a part's share in the proved bound of a result; a part without a bar is exact.";
    return [element("p", { className: "quiet", textContent: said }), partsTable(parts, bounds)];
  }
  const alike = new Map();
  for (const bound of bounds) {
    const kind = JSON.stringify([bound.units, bound.terms]);
    alike.set(kind, [...(alike.get(kind) ?? []), bound]);
  }
  return [...alike.values()].flatMap((group) => {
    const names = group.map((it) => it.output).join(", ");
    if (group[0].terms.length === 0) return [element("p", { textContent: `No bound is stated for ${names}.` })];
    return [element("h2", { textContent: `The bound of ${names}` }), termsTable(group[0])];
  });
}
