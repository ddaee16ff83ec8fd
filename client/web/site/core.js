// Core: the compiled core (client/web/page.cpp) for the other parts of the page.
import createMirage from './mirage.js';

const wasmBytes = Number(document.querySelector('script[data-wasm-bytes]')?.dataset.wasmBytes) || 1e6;

/// Compiles the module while it arrives; `progress` gets the bytes that are here, and all.
export async function loadModule(progress) {
  const response = await fetch(new URL('./mirage.wasm', import.meta.url));
  if (!response.ok) throw new Error(`the server answered ${response.status}`);
  let got = 0;
  const counted = response.body.pipeThrough(new TransformStream({
    transform: (chunk, out) => {
      got += chunk.length;
      progress(Math.min(got, wasmBytes), wasmBytes);
      out.enqueue(chunk);
    } }));
  return WebAssembly.compileStreaming(new Response(counted, { headers: { 'Content-Type': 'application/wasm' } }));
}

/// Starts the core; `write` gets what it sends to the server.
export const startCore = (module, write) => createMirage({
  instantiateWasm(imports, done) {
    WebAssembly.instantiate(module, imports).then((instance) => done(instance));
    return {};
  },
  write,
});

/// Calls `use` with a pointer to the text, and returns its result.
export function withText(core, text, use) {
  const bytes = new TextEncoder().encode(`${text}\0`);
  const at = core._malloc(bytes.length);
  core.HEAPU8.set(bytes, at);
  const out = use(at);
  core._free(at);
  return out;
}

export const textAt = (core, pointer) => core.UTF8ToString(pointer);

/// Returns the picture: RGBA, rows from the top.
export function pixels(core) {
  const [width, height] = [core._page_width(), core._page_height()];
  const at = core._page_pixels();
  return { width, height, rgba: core.HEAPU8.slice(at, at + 4 * width * height) };
}

/// Returns where the eye is, m, and the unit vector that it looks along.
export function pose(core) {
  const at = core._page_pose() >> 3;
  const [ex, ey, ez, ax, ay, az] = core.HEAPF64.subarray(at, at + 6);
  return { eye: [ex, ey, ez], ahead: [ax, ay, az] };
}
