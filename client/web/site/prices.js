// Prices: what frames take on this device. The graphics card's clock tells, if the browser has one,
// otherwise the display's pace. Prices are kept for the next visit; on the first one a short probe
// measures the device.

import { textAt } from './core.js';

const keepEveryMs = 10000;
const mostPending = 4;

export class Prices {
  constructor(viewer) {
    this.viewer = viewer;
    this.pending = [];
    this.keptAt = 0;
  }

  key() {
    const { viewer } = this;
    return `mirage-prices-1 ${textAt(viewer.core, viewer.core._page_renderer())}`;
  }

  recall(gl) {
    const { core } = this.viewer;
    this.gl = gl;
    this.timer = gl.getExtension('EXT_disjoint_timer_query_webgl2');
    this.pending = [];
    const count = core._page_price_count();
    let kept = null;
    try { kept = JSON.parse(localStorage.getItem(this.key())); } catch { /* no storage, or not ours */ }
    if (Array.isArray(kept) && kept.length === count && kept.every((n) => Number.isFinite(n) && n >= 0) && kept.some((n) => n > 0)) {
      const at = core._malloc(8 * count);
      core.HEAPF64.set(kept, at >> 3);
      core._page_set_prices(at);
      core._free(at);
      this.source = 'kept';
    } else {
      core._page_probe();
      this.source = 'probed';
    }
  }

  keep() {
    const { core } = this.viewer;
    if (!this.viewer.viewerThere()) return;
    this.keptAt = performance.now();
    const at = core._page_prices() >> 3;
    try { localStorage.setItem(this.key(), JSON.stringify([...core.HEAPF64.subarray(at, at + core._page_price_count())])); } catch { /* no storage */ }
  }

  beginFrame() {
    this.query = null;
    if (!this.timer || this.pending.length >= mostPending) return;
    this.query = this.gl.createQuery();
    this.gl.beginQuery(this.timer.TIME_ELAPSED_EXT, this.query);
  }

  endFrame(drawn) {
    const { gl, timer, viewer } = this;
    if (this.query) {
      gl.endQuery(timer.TIME_ELAPSED_EXT);
      if (drawn) this.pending.push({ query: this.query, frame: viewer.core._page_drawn_frames() });
      else gl.deleteQuery(this.query);
    }
    if (this.pending.length && gl.getQueryParameter(this.pending[0].query, gl.QUERY_RESULT_AVAILABLE)) {
      const { query, frame } = this.pending.shift();
      const ms = gl.getQueryParameter(query, gl.QUERY_RESULT) / 1e6;
      if (!gl.getParameter(timer.GPU_DISJOINT_EXT) && ms > 0) { this.gpuMs = ms; viewer.core._page_gpu_ms(frame, ms); }
      gl.deleteQuery(query);
    }
    if (performance.now() - this.keptAt > keepEveryMs && drawn) this.keep();
  }
}
