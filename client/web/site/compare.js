// Compare: shows a picture at rest beside the server's full render of the same view, with the FLIP
// of both.

import { pixels } from './core.js';
import { notice, say } from './status.js';

const $ = (id) => document.getElementById(id);
const samplesAnAxis = 4;
const mostSamples = 33e6;  // that a server draws

export class Compare {
  constructor(viewer) {
    this.viewer = viewer;
    this.state = 'off';  // off, asked or shown
    this.id = 0;
    $('split').addEventListener('input', () => this.split());
    $('compare-end').addEventListener('click', () => this.end());
  }

  waits() { return this.state === 'asked'; }

  toggle() {
    if (this.state !== 'off') { this.end(); return; }
    const { viewer } = this;
    const f = viewer.figures.now();
    if (!f.references) { notice('This server makes no full renders for viewers on other machines: it was started without --references.'); return; }
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
    for (let i = 3; i < reference.length; i += 4) reference[i] = 255;
    const truth = $('truth');
    [truth.width, truth.height] = [width, height];
    truth.getContext('2d').putImageData(new ImageData(new Uint8ClampedArray(reference), width, height), 0, 0);
    truth.hidden = false;
    $('slider').hidden = false;
    this.state = 'shown';
    this.split();
    say('');
    $('flip').textContent = 'FLIP …';
    $('split').focus();
    const { rgba: test } = pixels(core);
    viewer.link.worker.postMessage({ flip: { id: ++this.id, reference, test, width, height } }, [reference.buffer, test.buffer]);
  }

  measured({ id, mean }) {
    if (id !== this.id || this.state !== 'shown') return;
    this.mean = mean;
    const n = this.samples();
    $('flip').textContent = mean < 0 ? 'cannot be compared' : `FLIP ${mean.toFixed(4)} (0 is equal, 1 most different; ${n} x ${n} samples)`;
  }

  split() {
    const share = $('split').value / 10;
    $('truth').style.clipPath = `inset(0 0 0 ${share}%)`;
    $('split').setAttribute('aria-valuetext', `${share.toFixed(0)} % Mirage`);
  }

  end() {
    if (this.state === 'off') return;
    this.state = 'off';
    $('compare').setAttribute('aria-pressed', 'false');
    $('truth').hidden = true;
    $('slider').hidden = true;
    say('');
    if (this.viewer.viewerThere()) this.viewer.core._page_reference();  // drops a late render
  }
}
