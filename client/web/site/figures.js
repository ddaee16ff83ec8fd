// Figures: status and details in words, the choice of layers with their legends, and the sun.

import { textAt } from './core.js';
import { folder } from './server_link.js';

const $ = (id) => document.getElementById(id);
const everyMs = 250;
// Ways to show how the picture is made, each with what its colours mean (client/draw/insight.h).
const layers = [
  ['The picture', []],
  ['Drawn from', [['#59a6ff', 'flat image'], ['#4df266', 'image with depth'], ['#ffd933', 'geometry'], ['#ff4033', 'no image yet']]],
  ['Error', [['#00ff1a', '0'], ['#ffff1a', 'as much as allowed'], ['#ff001a', 'twice as much and more: the greatest error that the image may have here, in pixels']]],
  ['Age', [['#00ff1a', 'new'], ['#ffff1a', '30 s'], ['#ff001a', 'a minute and older: since the image arrived']]],
  ['What is geometry', [['#ffd933', 'drawn from triangles, not from images']]],
];
export const megabytes = (bytes) => `${(bytes / 1e6).toFixed(1)} MB`;

// Fills a list with names, values, and a sentence that explains each.
function fill(list, rows) {
  list.replaceChildren(...rows.flatMap(([name, value, sentence]) => ['dt', 'dd', 'dd'].map((tag, i) => {
    const element = document.createElement(tag);
    element.textContent = String([name, value, sentence][i]);
    if (i === 2) element.className = 'sentence';
    return element;
  })));
}

// Returns how sharp the picture is, in words. `images`: number of things in view that have one.
function sharpness(f, images) {
  if (!f.complete) return 'first view; the server prepares the rest';
  if (f.atRest && f.refined && f.overTau === 0) return 'sharp';
  return `sharpening: ${images - Math.min(images, f.overTau)} of ${f.visible}`;
}

export class Figures {
  constructor(viewer) {
    this.viewer = viewer;
    this.shownAt = 0;
    this.showPicture();
    this.traffic = [];  // [ms, bytes]
    this.layer = 0;
    layers.forEach(([name], i) => {
      const label = document.createElement('label'), choice = document.createElement('input');
      Object.assign(choice, { type: 'radio', name: 'layer', value: String(i), checked: i === 0 });
      choice.addEventListener('change', () => this.showLayer(i));
      label.append(choice, ` ${name} (${i + 1})`);
      $('layers').append(label);
    });
    const turned = () => viewer.place.changeLight([Number($('azimuth').value), Number($('elevation').value)]);
    $('azimuth').addEventListener('input', turned);
    $('elevation').addEventListener('input', turned);
    $('quality').addEventListener('change', () => {
      $('mirage').focus({ preventScroll: true });  // keys move again
      viewer.place.changePicture({ quality: $('quality').value });
    });
    $('fov').addEventListener('input', () => viewer.place.changePicture({ fov: Number($('fov').value) }));
    $('background').addEventListener('input', () => viewer.place.changePicture({ bg: $('background').value.slice(1) }));
    $('own-background').addEventListener('click', () => viewer.place.changePicture({ bg: undefined }));
    $('own-light').addEventListener('click', () => { viewer.place.changeLight(null); this.showLight(); });
  }

  /// Shows where the sun stands: where one has put it, or where the scene has it. Without a sun there is nothing to turn.
  showLight() {
    const { core, place } = this.viewer;
    if (!this.viewer.viewerThere() || !core._page_home_known()) return;
    const own = [core._page_own_sun(0), core._page_own_sun(1)];
    $('light').hidden = Number.isNaN(own[0]);
    for (const id of ['azimuth', 'elevation', 'own-light']) $(id).disabled = Boolean(folder);
    $('frozen-light').hidden = !folder;
    [$('azimuth').value, $('elevation').value] = place.light ?? own;
  }

  /// Shows the quality, the field of view and the background that the address has. A budget of the address replaces the quality.
  showPicture() {
    const { place } = this.viewer;
    $('quality').value = place.quality();
    $('quality').disabled = place.address.budget !== undefined;
    $('fov').value = place.fov();
    $('background').value = `#${place.address.bg ?? '808080'}`;
    $('own-background').disabled = place.address.bg === undefined;
    $('fov-degrees').value = `${Math.round(place.fov())}°`;
  }

  showLayer(layer) {
    this.layer = layer;
    document.querySelectorAll('#layers input').forEach((choice, i) => { choice.checked = i === layer; });
    this.viewer.core._page_layer(layer);
    $('legend').hidden = layer === 0;
    $('legend').replaceChildren(...layers[layer][1].map(([color, text]) => {
      const item = document.createElement('li'), spot = document.createElement('span');
      spot.style.setProperty('background', color);
      item.append(spot, text);
      return item;
    }));
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

  /// Shows how much of the picture is there, and the open panel. `at`: ms, Infinity at rest. Called once a frame.
  look(at) {
    const rests = at === Infinity;
    const panel = !$('figures').hidden, line = this.viewer.seen && !(rests && $('arriving').hidden);
    if (!(panel || line) || (!rests && at - this.shownAt < everyMs)) return;
    const time = performance.now();
    this.shownAt = rests ? time : at;
    const f = this.now();
    this.showArriving(f, rests);
    if (panel) this.showPanel(f, rests, time);
  }

  // A line at the top: the share of what is in view that has an image. It goes once all of it has. While the server still
  // prepares the scene, that share is not known.
  showArriving(f, rests) {
    const there = f.visible > 0 ? (f.visible - f.placeholders) / f.visible : 1;
    $('arriving').hidden = f.complete && (rests || f.atRest || there >= 1);
    if (f.complete) $('arriving').value = there;
    else $('arriving').removeAttribute('value');
  }

  showPanel(f, rests, time) {
    const images = f.visible - f.placeholders;
    fill($('status-list'), [
      ['Picture', sharpness(f, images),
        'How many of the things in view are as sharp as the server makes them.'],
      ['Frames', f.frameMs > 0 && !rests ? `${(1000 / f.frameMs).toFixed(0)} a second` : 'at rest', 'Pictures a second. At rest nothing is drawn.'],
      ['Network', `${this.rate(f.bytesDown, time).toFixed(1)} Mbit/s`, 'What arrives from the server now.'],
      ['Received', megabytes(f.bytesDown), 'All that has arrived since the page was opened.'],
    ]);
    fill($('details-list'), [
      ['Time of a frame', f.budgetMs > 0 ? `${f.plannedMs.toFixed(1)} of ${f.budgetMs.toFixed(0)} ms` : 'any',
        'What a picture is planned to take, of the time that there is for one.'],
      ['Drawn with', f.software ? 'the processor' : 'the graphics card', 'Without a graphics card everything is slower.'],
      ['Resolution', `${f.scale} x, ${f.samples} samples`, 'Below 1, moving pictures are drawn smaller and enlarged. Samples smooth the edges.'],
      ['Images, geometry', `${f.impostors}, ${f.meshes}`, 'Things that are drawn from images of the server (impostors), and from triangles.'],
      ['Without an image', f.placeholders, 'Things of which nothing has arrived yet: they show their mean colour.'],
      ['Greatest error', `${f.boundPx.toFixed(1)} px`, 'Proven bound: no pixel of an image is farther than this from where it belongs.'],
      ['Expected difference', `${f.expectedFlip.toFixed(3)} FLIP`, 'How different from the full render the things in view should look, 0 to 1. It counts what no image has seen yet and old reflections, which no bound covers.'],
      ['Above the allowed', `${f.overTau} of ${f.visible}`, 'Things whose bound is above the allowed error (tau). Sharper images of them are asked for.'],
      ['Age of images', `${f.tileAgeS.toFixed(1)} s`, 'Median time since the images arrived. Only what moves gets old.'],
      ['Round trip', `${f.roundTripMs} ms`, 'From a question to the server until its answer.'],
      ['Draw calls', f.drawCalls, 'Orders to the graphics card for one picture.'],
      ['Graphics memory', megabytes(f.gpuBytes + f.targetBytes), 'Images, geometry and the picture itself.'],
      ['Memory', megabytes(this.viewer.core.HEAPU8.length), 'Memory of the program behind this page.'],
    ]);
  }
}
