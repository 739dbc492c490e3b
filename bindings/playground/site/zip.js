// A zip archive of texts, stored without compression: the same files give the same bytes.

const TABLE = Uint32Array.from({ length: 256 }, (_, byte) => {
  let value = byte;
  for (let bit = 0; bit < 8; bit += 1) value = value & 1 ? 0xedb88320 ^ (value >>> 1) : value >>> 1;
  return value;
});

function crc(bytes) {
  let value = 0xffffffff;
  for (const byte of bytes) value = TABLE[(value ^ byte) & 0xff] ^ (value >>> 8);
  return ~value >>> 0;
}

// The fields that a file's header and its entry in the directory share, little-endian: version, flags for names in UTF-8, method, the
// first moment that the format has, checksum, sizes and length of the name.
function shared(sum, size, length) {
  const view = new DataView(new ArrayBuffer(26));
  view.setUint16(0, 20, true);
  view.setUint16(2, 0x800, true);
  view.setUint16(8, 0x21, true);
  view.setUint32(10, sum, true);
  view.setUint32(14, size, true);
  view.setUint32(18, size, true);
  view.setUint16(22, length, true);
  return new Uint8Array(view.buffer);
}

const words = (...numbers) => new Uint8Array(new Uint32Array(numbers).buffer);
const halves = (...numbers) => new Uint8Array(new Uint16Array(numbers).buffer);

// An archive of `{ name, text }`.
export function zip(files) {
  const [parts, directory] = [[], []];
  let [at, size] = [0, 0];
  for (const { name, text } of files) {
    const [title, contents] = [name, text].map((it) => new TextEncoder().encode(it));
    const fields = shared(crc(contents), contents.length, title.length);
    parts.push(words(0x04034b50), fields, title, contents);
    directory.push(words(0x02014b50), halves(20), fields, halves(0, 0, 0), words(0), words(at), title);
    at += 4 + fields.length + title.length + contents.length;
    size += 4 + 2 + fields.length + 6 + 8 + title.length;
  }
  const count = files.length;
  const end = [words(0x06054b50), halves(0, 0, count, count), words(size, at), halves(0)];
  return new Blob([...parts, ...directory, ...end], { type: "application/zip" });
}
