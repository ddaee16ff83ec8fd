// Address: the view in the URL's fragment.
//   #eye=x,y,z&look=x,y,z&light=azimuth,elevation&t=seconds&fov=degrees&quality=speed|picture&bg=rrggbb&budget=ms&token=…
// `look` is a point that the eye looks at; `bg` is the colour behind everything. Parts that cannot be read are left out, and named in
// `wrong`.

const numbers = (text, count) => {
  const out = text.split(',').map((part) => (part.trim() === '' ? NaN : Number(part)));
  return out.length === count && out.every((n) => Number.isFinite(n) && Math.abs(n) < 1e12) ? out : null;
};

const kinds = { eye: 3, look: 3, light: 2, t: 1, fov: 1, budget: 1 };

/// Vertical field of view, degrees: the usual one, and the limits of what can be chosen.
export const usualFov = 60, leastFov = 10, mostFov = 120;
/// Share of the usual time of a frame that each quality takes.
export const qualities = { speed: 0.5, auto: 1, picture: 3 };

export function readAddress(fragment) {
  const out = { wrong: [] };
  for (const part of fragment.replace(/^#/, '').split('&')) {
    if (part === '') continue;
    const equals = part.indexOf('=');
    const name = equals < 0 ? part : part.slice(0, equals);
    let text = '';
    try { text = decodeURIComponent(part.slice(equals + 1)); } catch { /* a broken escape: wrong, below */ }
    if (name === 'token' && text !== '') { out.token = text; continue; }
    if (name === 'bg' && /^[0-9a-f]{6}$/i.test(text)) { out.bg = text.toLowerCase(); continue; }
    if (name === 'quality' && Object.hasOwn(qualities, text)) { out.quality = text; continue; }
    const value = kinds[name] && equals > 0 ? numbers(text, kinds[name]) : null;
    if (value) out[name] = value.length === 1 ? value[0] : value;
    else out.wrong.push(part.slice(0, 40));
  }
  const half = !out.eye !== !out.look;
  const apart = out.eye && out.look && out.eye.some((v, i) => v !== out.look[i]);
  if (half || (out.eye && !apart)) {
    out.wrong.push(half ? 'eye and look go together' : 'eye and look are one point');
    delete out.eye;
    delete out.look;
  }
  if (out.fov < leastFov || out.fov > mostFov) { out.wrong.push(`fov=${out.fov}`); delete out.fov; }
  for (const name of ['t', 'budget']) if (out[name] < 0) { out.wrong.push(`${name}=${out[name]}`); delete out[name]; }
  return out;
}

const short = (n, digits) => String(Number(n.toFixed(digits)));

/// Writes as few characters as show the same picture: a tenth of a millimetre, and about an arc
/// second.
export function writeAddress({ eye, ahead, light, t, fov, quality, bg, budget }) {
  const parts = [
    `eye=${eye.map((n) => short(n, 4)).join(',')}`,
    `look=${eye.map((n, i) => short(Number(short(n, 4)) + ahead[i], 5)).join(',')}`,
  ];
  if (light) parts.push(`light=${light.map((n) => short(n, 1)).join(',')}`);
  if (t !== undefined) parts.push(`t=${short(t, 2)}`);
  if (fov !== undefined && fov !== usualFov) parts.push(`fov=${short(fov, 1)}`);
  if (quality !== undefined && quality !== 'auto') parts.push(`quality=${quality}`);
  if (bg !== undefined) parts.push(`bg=${bg}`);
  if (budget !== undefined) parts.push(`budget=${short(budget, 2)}`);
  return `#${parts.join('&')}`;
}
