// Archive: files in one, and pictures whose pixels are numbers of 16 bits.

const table = Uint32Array.from({ length: 256 }, (_, n) => {
  let c = n;
  for (let bit = 0; bit < 8; ++bit) c = c & 1 ? 0xedb88320 ^ (c >>> 1) : c >>> 1;
  return c;
});

function checksum(bytes) {
  let c = 0xffffffff;
  for (const byte of bytes) c = table[(c ^ byte) & 255] ^ (c >>> 8);
  return (c ^ 0xffffffff) >>> 0;
}

/// Returns numbers of `sizes` bytes each as bytes, lowest first.
function little(...pairs) {
  const out = [];
  for (const [value, size] of pairs) for (let i = 0; i < size; ++i) out.push(Math.floor(value / 256 ** i) & 255);
  return Uint8Array.from(out);
}

/// Returns a zip archive without compression. `files`: [name, Uint8Array] each.
/// Format: PKWARE, APPNOTE.TXT 6.3.
export function zip(files) {
  const parts = [], directory = [];
  let at = 0;
  for (const [name, bytes] of files) {
    const text = new TextEncoder().encode(name);
    // Version 1.0, names in UTF-8, no compression, 1980-01-01.
    const shared = [[10, 2], [1 << 11, 2], [0, 4], [33, 2], [checksum(bytes), 4], [bytes.length, 4], [bytes.length, 4], [text.length, 2], [0, 2]];
    const head = little([0x04034b50, 4], ...shared);
    parts.push(head, text, bytes);
    directory.push(little([0x02014b50, 4], [10, 2], ...shared, [0, 10], [at, 4]), text);
    at += head.length + text.length + bytes.length;
  }
  const size = directory.reduce((sum, part) => sum + part.length, 0);
  return new Blob([...parts, ...directory, little([0x06054b50, 4], [0, 4], [files.length, 2], [files.length, 2], [size, 4], [at, 4], [0, 2])], { type: 'application/zip' });
}

function joined(...parts) {
  const out = new Uint8Array(parts.reduce((sum, part) => sum + part.length, 0));
  let at = 0;
  for (const part of parts) {
    out.set(part, at);
    at += part.length;
  }
  return out;
}

async function deflated(bytes) {
  const packed = new Blob([bytes]).stream().pipeThrough(new CompressionStream('deflate'));
  return new Uint8Array(await new Response(packed).arrayBuffer());
}

/// Returns a grey PNG of 16 bits; `values` has a number of 0 to 65535 for each pixel, rows from the top.
/// Format: W3C, Portable Network Graphics (PNG) Specification.
export async function greyPng(width, height, values) {
  const rows = new Uint8Array(height * (1 + 2 * width));  // each begins with its filter: none
  for (let y = 0, to = 0; y < height; ++y) {
    ++to;
    for (let x = 0; x < width; ++x) {
      const value = values[y * width + x];
      rows[to++] = value >> 8;
      rows[to++] = value & 255;
    }
  }
  const big = (value) => little([value, 4]).reverse();
  const chunk = (name, bytes) => {
    const body = joined(new TextEncoder().encode(name), bytes);
    return [big(bytes.length), body, big(checksum(body))];
  };
  const head = joined(big(width), big(height), Uint8Array.of(16, 0, 0, 0, 0));
  const signature = Uint8Array.of(0x89, 0x50, 0x4e, 0x47, 13, 10, 26, 10);
  return joined(signature, ...chunk('IHDR', head), ...chunk('IDAT', await deflated(rows)), ...chunk('IEND', new Uint8Array()));
}
