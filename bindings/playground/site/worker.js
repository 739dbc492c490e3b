// The module in a worker, so that the page stays at hand while it computes.

import { start } from "./glint.js";

// The module's bytes: beside this file, or in the page that is one file, gzipped.
async function bytes() {
  const packed = globalThis.GLINT_WASM;
  const response = await fetch(packed ? `data:;base64,${packed}` : new URL("glint.wasm", location));
  if (!response.ok) throw new Error(`glint.wasm: ${response.status}`);
  const unpacked = packed ? new Response(response.body.pipeThrough(new DecompressionStream("gzip"))) : response;
  return unpacked.arrayBuffer();
}

const glint = bytes().then(start);

onmessage = async ({ data: { number, request } }) => {
  try {
    const ask = await glint;
    postMessage({ number, answer: ask(request) });
  } catch (error) {
    postMessage({ number, failure: String(error) });
  }
};
