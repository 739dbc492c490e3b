// The module in a worker, so that the page stays at hand while it computes.

import { start } from "./glint.js";

const glint = fetch(new URL("glint.wasm", import.meta.url))
  .then((response) => {
    if (!response.ok) throw new Error(`glint.wasm: ${response.status}`);
    return response.arrayBuffer();
  })
  .then(start);

onmessage = async ({ data: { number, request } }) => {
  try {
    const ask = await glint;
    postMessage({ number, answer: ask(request) });
  } catch (error) {
    postMessage({ number, failure: String(error) });
  }
};
