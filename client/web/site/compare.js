// Compare: shows a picture at rest beside the server's full render of the same view, or beside their difference, with the
// FLIP of both. A line divides the picture; it is dragged, or moved by the arrow keys.

import { pixels, textAt } from './core.js';
import { folder } from './server_link.js';
import { notice, say } from './status.js';

const $ = (id) => document.getElementById(id);
const samplesAnAxis = 4;
const mostSamples = 33e6;  // that a server draws
const handlePx = 44;       // width of the line's handle, as in style.css

function opaque(rgba, width, height) {
  const out = new ImageData(new Uint8ClampedArray(rgba), width, height);
  for (let i = 3; i < out.data.length; i += 4) out.data[i] = 255;
  return out;
}

export class Compare {
  constructor(viewer) {
    this.viewer = viewer;
    this.state = 'off';  // off, asked or shown
    this.id = 0;
    $('split').addEventListener('input', () => this.split());
    $('compare-end').addEventListener('click', () => this.end());
    $('difference').addEventListener('click', () => { if (this.state === 'shown') this.showDifference(!this.difference); });
    window.addEventListener('resize', () => { if (this.state === 'shown') this.split(); });
  }

  waits() { return this.state === 'asked'; }

  toggle() {
    if (this.state !== 'off') { this.end(); return; }
    const { viewer } = this;
    if (folder) { notice('This page stands alone: no server is there to make a full render.'); return; }
    const f = viewer.figures.now();
    if (!f.references) { notice('This server makes no full renders for viewers on other machines: it was started without --references.'); return; }
    if (viewer.place.address.bg !== undefined) { notice("The full render has the scene's own background: choose that under Status first."); return; }
    if (!viewer.link.connected) { notice('The server is gone: there is nothing to compare with.'); return; }
    this.state = 'asked';
    this.asked = false;
    $('compare').setAttribute('aria-pressed', 'true');
    say('Waiting for the picture to be at rest, and the server to draw it');
    viewer.wake();
  }

  samples() {
    const { core } = this.viewer;
    const pixels = core._page_width() * core._page_height();
    return Math.max(1, Math.min(samplesAnAxis, Math.floor(Math.sqrt(mostSamples / pixels))));
  }

  // Called once a frame.
  look() {
    if (this.state !== 'asked') return;
    const { viewer } = this;
    const { core } = viewer;
    if (!viewer.link.connected) { this.end(); notice('The server is gone: there is nothing to compare with.'); return; }
    if (!this.asked) {
      const f = viewer.figures.now();
      if (!f.atRest || !f.refined) return;
      this.size = [core._page_width(), core._page_height()];
      core._page_ask_reference(this.samples());
      this.asked = true;
      return;
    }
    const there = core._page_reference();
    if (there < 0) { this.end(); notice('The server does not draw this view in full: it may be too large, or not allowed.'); }
    if (there > 0) this.show();
  }

  show() {
    const { viewer, size: [width, height] } = this;
    const { core } = viewer;
    const at = core._page_reference_pixels();
    const reference = core.HEAPU8.slice(at, at + 4 * width * height);
    this.truth = opaque(reference, width, height);
    this.heat = null;
    [$('truth').width, $('truth').height] = [width, height];
    for (const id of ['truth', 'slider', 'split']) $(id).hidden = false;
    $('worst').hidden = true;
    $('difference').disabled = true;
    this.state = 'shown';
    this.showDifference(false);
    this.split();
    say('');
    $('flip').textContent = 'FLIP …';
    $('split').focus();
    const { rgba: test } = pixels(core);
    viewer.link.worker.postMessage({ flip: { id: ++this.id, reference, test, width, height } }, [reference.buffer, test.buffer]);
  }

  // Called with the measurement of a comparison.
  measured({ id, mean, objects, most, worst, heat }) {
    if (id !== this.id || this.state !== 'shown') return;
    this.mean = mean;
    const { size: [width, height] } = this, n = this.samples();
    $('flip').title = `0 is equal, 1 most different; the full render has ${n} x ${n} samples a pixel`;
    const told = [`FLIP ${mean.toFixed(4)} (0 is equal)`];
    if (objects >= 0) told.push(`on objects ${objects.toFixed(4)}, and within ${most.toFixed(3)} in 99 of 100 of their pixels`);
    if (worst) told.push(this.showWorst(worst));
    $('flip').textContent = mean < 0 ? 'cannot be compared' : told.join('; ');
    this.heat = heat && opaque(heat, width, height);
    $('difference').disabled = !heat;
  }

  // Puts a ring around the square that differs most. Returns a text that names what is there.
  showWorst({ x, y, flip }) {
    const { core } = this.viewer;
    const name = textAt(core, core._page_name_at(x, y));
    Object.assign($('worst').style, { left: `${100 * x}%`, top: `${100 * y}%` });
    $('worst').hidden = false;
    return `most in the ring, ${flip.toFixed(3)}${name ? `: “${name}”` : ''}`;
  }

  // Shows the difference, or the full render, on the right of the line.
  showDifference(on) {
    this.difference = Boolean(on && this.heat);
    $('difference').setAttribute('aria-pressed', String(this.difference));
    $('right-side').textContent = this.difference ? 'Difference: black none, light yellow .5 and more' : 'Full render';
    $('truth').getContext('2d').putImageData(this.difference ? this.heat : this.truth, 0, 0);
  }

  // Moves the line. The middle of the handle goes from half a handle to that far from the other edge; at the ends, the line
  // leaves the picture.
  split() {
    const share = $('split').value / 1000, width = $('split').clientWidth;
    const line = share <= 0 ? 0 : share >= 1 ? width : handlePx / 2 + share * (width - handlePx);
    $('split').classList.toggle('outside', share <= 0 || share >= 1);
    $('truth').style.clipPath = `inset(0 0 0 ${line}px)`;
    $('split').setAttribute('aria-valuetext', `${(100 * share).toFixed(0)} % Mirage`);
  }

  end() {
    if (this.state === 'off') return;
    this.state = 'off';
    $('compare').setAttribute('aria-pressed', 'false');
    for (const id of ['truth', 'slider', 'split', 'worst']) $(id).hidden = true;
    say('');
    if (this.viewer.viewerThere()) this.viewer.core._page_reference();  // drops a late render
  }
}
