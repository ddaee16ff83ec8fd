// Figures: the strip of figures, the choice of layers, and the sun.

import { textAt } from './core.js';

const $ = (id) => document.getElementById(id);
const everyMs = 250;
const layers = ['The picture', 'Tile borders', 'Bound over tau', 'Age', 'What is geometry'];
const megabytes = (bytes) => `${(bytes / 1e6).toFixed(1)} MB`;

export class Figures {
  constructor(viewer) {
    this.viewer = viewer;
    this.shownAt = 0;
    this.traffic = [];  // [ms, bytes]
    this.layer = 0;
    layers.forEach((name, i) => {
      const label = document.createElement('label'), choice = document.createElement('input');
      Object.assign(choice, { type: 'radio', name: 'layer', value: String(i), checked: i === 0 });
      choice.addEventListener('change', () => this.showLayer(i));
      label.append(choice, ` ${name} (${i + 1})`);
      $('layers').append(label);
    });
    const turned = () => viewer.place.changeLight([Number($('azimuth').value), Number($('elevation').value)]);
    $('azimuth').addEventListener('input', turned);
    $('elevation').addEventListener('input', turned);
    $('own-light').addEventListener('click', () => viewer.place.changeLight(null));
    this.showLight();
  }

  showLight() {
    const { light } = this.viewer.place;
    if (light) [$('azimuth').value, $('elevation').value] = light;
  }

  showLayer(layer) {
    this.layer = layer;
    document.querySelectorAll('#layers input').forEach((choice, i) => { choice.checked = i === layer; });
    this.viewer.core._page_layer(layer);
    this.viewer.wake();
  }

  toggle() {
    const open = $('figures').hidden;
    $('figures').hidden = !open;
    $('figures-button').setAttribute('aria-pressed', String(open));
    this.shownAt = 0;
    this.viewer.wake();
  }

  /// Returns all figures, for the strip and for tests.
  now() {
    const { viewer } = this;
    const figures = JSON.parse(textAt(viewer.core, viewer.core._page_figures(viewer.place.sessionMs())));
    const recent = viewer.frames.slice(-30);
    figures.frameMs = recent.length ? recent.reduce((a, b) => a + b) / recent.length : 0;
    return figures;
  }

  rate(bytes, at) {
    this.traffic.push([at, bytes]);
    while (this.traffic.length > 2 && at - this.traffic[0][0] > 2000) this.traffic.shift();
    const [first] = this.traffic;
    return at > first[0] ? (bytes - first[1]) * 8e-3 / (at - first[0]) : 0;  // Mbit/s
  }

  look(at) {
    if ($('figures').hidden || at - this.shownAt < everyMs) return;
    const time = performance.now();
    this.shownAt = at === Infinity ? time : at;
    const f = this.now();
    const rows = {
      'Frames': f.frameMs > 0 && at !== Infinity ? `${(1000 / f.frameMs).toFixed(0)} a second` : 'at rest',
      'Budget': f.budgetMs > 0 ? `${f.plannedMs.toFixed(1)} of ${f.budgetMs.toFixed(0)} ms` : 'none',
      'Scale, samples': `${f.scale}, ${f.samples}`,
      'Draw calls': f.drawCalls,
      'Impostors, geometry': `${f.impostors}, ${f.meshes}`,
      'Without an image': f.placeholders,
      'Bound, worst': `${f.boundPx.toFixed(1)} px`,
      'Over tau': `${f.overTau} of ${f.visible}`,
      'Age of tiles': `${f.tileAgeS.toFixed(1)} s`,
      'Received': megabytes(f.bytesDown),
      'Rate': `${this.rate(f.bytesDown, time).toFixed(1)} Mbit/s`,
      'Round trip': `${f.roundTripMs} ms`,
      'Graphics memory': megabytes(f.gpuBytes + f.targetBytes),
      'Memory': megabytes(this.viewer.core.HEAPU8.length),
    };
    $('figures').querySelector('dl').replaceChildren(...Object.entries(rows).flatMap(([name, value]) => {
      const dt = document.createElement('dt'), dd = document.createElement('dd');
      dt.textContent = name;
      dd.textContent = String(value);
      return [dt, dd];
    }));
  }
}
