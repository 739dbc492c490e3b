// The module: a request is an object, and so is its answer.

import { system } from "./wasi.js";

// Starts the module from its bytes.
export async function start(bytes) {
  let instance;
  const imports = system(() => instance.exports.memory);
  ({ instance } = await WebAssembly.instantiate(bytes, imports));
  const { memory, reserve, answer, answer_len, _initialize } = instance.exports;
  _initialize?.();
  return (request) => {
    const text = new TextEncoder().encode(JSON.stringify(request));
    const room = reserve(text.length);
    new Uint8Array(memory.buffer, room, text.length).set(text);
    const at = answer();
    return JSON.parse(new TextDecoder().decode(new Uint8Array(memory.buffer, at, answer_len())));
  };
}
