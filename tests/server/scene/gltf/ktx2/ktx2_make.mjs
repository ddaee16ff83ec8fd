// Makes small KTX2 files from pictures that it computes, and writes those as raw RGBA beside.
//   node ktx2_make.mjs ENCODER FILES SOURCES [EDGE]
// ENCODER is the folder of the npm package ktx2-encoder. EDGE makes all pictures of that size.
import { pathToFileURL } from 'url';
import fs from 'fs';
const [enc, out, src, edge] = process.argv.slice(2);
const { encodeToKTX2 } = await import(pathToFileURL(enc + '/dist/node/index.js'));
let seed = 12345; const rnd = () => (seed = (seed * 1103515245 + 12345) >>> 0) / 4294967296;
function colour(w, h, alpha) {
  const d = new Uint8Array(w * h * 4);
  for (let y = 0; y < h; y++) for (let x = 0; x < w; x++) {
    const i = 4 * (y * w + x), n = (rnd() - 0.5) * 12;
    let c = [255 * x / w, 255 * y / h, 128 + 100 * Math.sin(x * 0.2 + y * 0.1)];
    if ((x - w / 2) ** 2 + (y - h / 2) ** 2 < (h / 4) ** 2) c = [220, 40, 30];
    if (x > w * 0.7 && y > h * 0.6 && x < w * 0.9 && y < h * 0.85) c = [20, 60, 200];
    for (let k = 0; k < 3; k++) d[i + k] = Math.max(0, Math.min(255, Math.round(c[k] + n)));
    const a = 255 * (1 - Math.hypot(x - w / 2, y - h / 2) / Math.hypot(w / 2, h / 2));
    d[i + 3] = alpha ? Math.max(0, Math.min(255, Math.round(a))) : 255;
  }
  return d;
}
function normals(w, h) {
  const d = new Uint8Array(w * h * 4);
  for (let y = 0; y < h; y++) for (let x = 0; x < w; x++) {
    const i = 4 * (y * w + x), nx = 0.5 * Math.cos(x * 0.3), ny = 0.5 * Math.sin(y * 0.25 + x * 0.05);
    const l = Math.hypot(nx, ny, 1);
    d.set([nx / l, ny / l, 1 / l].map((v) => Math.round(127.5 + 127.5 * v)), i); d[i + 3] = 255;
  }
  return d;
}
const C = { isPerceptual: true, isSetKTX2SRGBTransferFunc: true, generateMipmap: false };
const N = { isPerceptual: false, isSetKTX2SRGBTransferFunc: false, generateMipmap: true, isNormalMap: true };
const E = { isUASTC: false, qualityLevel: 200, compressionLevel: 3 }, U = { isUASTC: true, uastcLDRQualityLevel: 2 };
const big = Number(edge || 0);
const s = (w, h) => big ? [big, big] : [w, h];
const all = [
  ['etc1s_opaque', ...s(64, 48), colour, 0, { ...C, ...E }],
  ['etc1s_alpha', ...s(61, 47), colour, 1, { ...C, ...E }],
  ['uastc_opaque', ...s(64, 48), colour, 0, { ...C, ...U, needSupercompression: false }],
  ['uastc_alpha', ...s(61, 47), colour, 1, { ...C, ...U, needSupercompression: false }],
  ['uastc_zstd', ...s(62, 45), colour, 1, { ...C, ...U, needSupercompression: true, generateMipmap: true }],
  ['uastc_normal_mips', ...s(64, 32), normals, 0, { ...N, ...U, needSupercompression: true }],
  ['etc1s_normal_mips', ...s(64, 32), normals, 0, { ...N, ...E }],
];
for (const [name, w, h, make, alpha, options] of all) {
  const data = make(w, h, alpha);
  const t = Date.now();
  const ktx = await encodeToKTX2(new Uint8Array(0), { ...options, imageDecoder: async () => ({ data, width: w, height: h }) });
  fs.writeFileSync(`${out}/${name}.ktx2`, ktx); fs.writeFileSync(`${src}/${name}.rgba`, data);
  console.log(name, w, h, ktx.length, Date.now() - t, 'ms');
}
