// The few calls of the system that the module makes: a clock, numbers for hash maps, and what it prints, which goes to the console.

const SUCCESS = 0;
const BAD_DESCRIPTOR = 8;

// The imports of a module; `memory` gives its memory once there is one.
export function system(memory) {
  const view = () => new DataView(memory().buffer);
  const bytes = (at, length) => new Uint8Array(memory().buffer, at, length);
  const none = () => BAD_DESCRIPTOR;
  const own = {
    clock_time_get(_id, _precision, into) {
      view().setBigUint64(into, BigInt(Math.round(performance.now() * 1e6)), true);
      return SUCCESS;
    },
    random_get(into, length) {
      // The same each time: output depends on nothing but its input.
      bytes(into, length).fill(7);
      return SUCCESS;
    },
    environ_sizes_get(count, size) {
      view().setUint32(count, 0, true);
      view().setUint32(size, 0, true);
      return SUCCESS;
    },
    environ_get: () => SUCCESS,
    args_sizes_get(count, size) {
      return own.environ_sizes_get(count, size);
    },
    args_get: () => SUCCESS,
    sched_yield: () => SUCCESS,
    fd_write(_descriptor, vectors, count, written) {
      let text = "";
      let total = 0;
      for (let at = 0; at < count; at += 1) {
        const start = view().getUint32(vectors + 8 * at, true);
        const length = view().getUint32(vectors + 8 * at + 4, true);
        text += new TextDecoder().decode(bytes(start, length));
        total += length;
      }
      view().setUint32(written, total, true);
      console.log(text.trimEnd());
      return SUCCESS;
    },
    proc_exit(code) {
      throw new Error(`the module ended with ${code}`);
    },
  };
  // Files and directories: there are none.
  return { wasi_snapshot_preview1: new Proxy(own, { get: (calls, name) => calls[name] ?? none }) };
}
