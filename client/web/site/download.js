// Download: the view as a picture with depth, an object as a bake for an engine, the place as a
// folder that needs no server. The first is made here, the others by the server's programs.
import { greyPng, zip } from './archive.js';
import { pixels, textAt } from './core.js';
import { folder } from './server_link.js';

const $ = (id) => document.getElementById(id);
const pauseMs = 700;      // between two looks at a download
const nearest = 65535;    // depth of the nearest point; 0: nothing is there

/// Returns the scene's name as a file's.
export const fileName = (core) => `mirage-${textAt(core, core._page_scene_name()).replace(/[^a-z0-9]+/gi, '-')}`;

/// Hands a file to the browser.
export function save(blob, name) {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

/// Returns the picture as a PNG, its background opaque.
export function picture(core) {
  const { width, height, rgba } = pixels(core);
  for (let i = 3; i < rgba.length; i += 4) rgba[i] = 255;
  const sheet = document.createElement('canvas');
  [sheet.width, sheet.height] = [width, height];
  sheet.getContext('2d').putImageData(new ImageData(new Uint8ClampedArray(rgba.buffer), width, height), 0, 0);
  return new Promise((done) => { sheet.toBlob(done, 'image/png'); });
}

export class Download {
  constructor(viewer) {
    this.viewer = viewer;
    this.job = null;  // {stopped} of what is being made
    $('download-close').addEventListener('click', () => this.show(false));
    $('download-view').addEventListener('click', () => this.view());
    $('download-bake').addEventListener('click', () => this.make({ kind: 'bake', target: $('bake-target').value, ...this.subject(), ...this.frames() }));
    $('download-folder').addEventListener('click', () => this.make({ kind: 'folder', mb: $('folder-mb').value, ...this.ground() }));
    $('download-stop').addEventListener('click', () => this.stop());
  }

  async show(shown) {
    $('download').hidden = !shown;
    if (!shown) { this.stop(); return; }
    this.find();
    $('download-close').focus();
    const may = await this.ask();
    $('bake').hidden = !may.bake;
    $('folder').hidden = !may.folder;
    $('download-none').hidden = may.bake || may.folder;
    $('download-none').textContent = folder
      ? 'This page stands alone. A server also makes bakes for engines, and folders like this one.'
      : 'This server makes no bakes and no folders for visitors.';
  }

  headers() { return this.viewer.link.token ? { Authorization: `Bearer ${this.viewer.link.token}` } : {}; }

  /// Returns what the server makes.
  async ask() {
    if (folder) return {};
    try {
      const answer = await fetch('v1/downloads', { headers: this.headers() });
      return answer.ok ? await answer.json() : {};
    } catch { return {}; }
  }

  /// Looks what is in the middle of the picture.
  find() {
    const { core } = this.viewer;
    this.object = core._page_object_at(0.5, 0.5);
    const name = this.object < 0 ? '' : textAt(core, core._page_name_at(0.5, 0.5));
    $('bake-object').textContent = this.object < 0 ? 'Nothing single is in the middle' : `In the middle: ${name || `object ${this.object}`}`;
    $('bake-object').disabled = this.object < 0;
    $('bake-what').value = this.object < 0 ? 'whole' : 'object';
  }
  subject() { return $('bake-what').value === 'object' ? { object: this.object } : {}; }

  frames() {
    const [grid, size] = $('bake-size').value.split('x');
    return { grid, size };
  }

  // A walker takes the place around the eye along; others the scene from all around.
  ground() {
    const { core, place } = this.viewer;
    if (core._page_orbits()) return {};
    const { eye, ahead } = place.view();
    return { eye: eye.join(','), look: eye.map((v, i) => v + ahead[i]).join(','), reach: 1 };
  }

  say(text, making = false) {
    $('download-line').textContent = text;
    $('download-stop').hidden = !making;
    for (const id of ['download-bake', 'download-folder']) $(id).disabled = making;
  }

  stop() {
    if (!this.job) return;
    this.job.stopped = true;
    this.job = null;
    this.say('Stopped.');
  }

  /// Asks the server for a download until it is there.
  async make(values) {
    const job = { stopped: false };
    this.job = job;
    this.say('Asking', true);
    const address = `v1/download?${new URLSearchParams(values)}`;
    let saved = '';
    let wrong = '';
    try {
      for (let answer; !job.stopped && !saved && !wrong;) {
        answer = await fetch(address, { headers: this.headers(), cache: 'no-store' });
        if (answer.status === 200) {
          saved = /filename="([^"]+)"/.exec(answer.headers.get('Content-Disposition') ?? '')?.[1] ?? 'mirage.zip';
          const file = await answer.blob();
          if (!job.stopped) save(file, saved);
        } else if (answer.status === 202) {
          const { state, ahead, line } = await answer.json();
          if (!job.stopped) this.say(state === 'waiting' ? `Waiting for ${ahead} before this one` : line || 'Loading the scene', true);
          await new Promise((done) => { setTimeout(done, pauseMs); });
        } else {
          wrong = (await answer.text()).trim() || `the server answered ${answer.status}`;
        }
      }
    } catch { wrong = 'the server does not answer'; }
    if (job.stopped) return;
    this.job = null;
    this.say(wrong ? `It was not made: ${wrong}` : `${saved} is saved.`);
  }

  /// Saves the picture, its depth, and where it was seen from.
  async view() {
    const { core, place } = this.viewer;
    const { width, height } = pixels(core);
    const at = core._page_depths();
    if (!at) { this.say(`It was not made: ${textAt(core, core._page_text())}`); return; }
    const depths = core.HEAPF32.slice(at >> 2, (at >> 2) + width * height);
    const color = new Uint8Array(await (await picture(core)).arrayBuffer());
    let near = Infinity;
    for (const depth of depths) if (depth > 0 && depth < near) near = depth;
    if (near === Infinity) near = 1;
    const grey = await greyPng(width, height, Uint16Array.from(depths, (depth) => (depth > 0 ? Math.max(1, Math.round(nearest * near / depth)) : 0)));
    const { eye, ahead } = place.view();
    const facts = {
      width, height, eye_m: eye, ahead, up: 'the picture stands upright: +y is up', vertical_field_of_view_degrees: place.fov(),
      depth: { file: 'depth.png', near_m: near, metres_along_ahead: `near_m * ${nearest} / value`, 0: 'nothing is there' },
    };
    const name = fileName(core);
    save(zip([['view.png', color], ['depth.png', grey], ['view.json', new TextEncoder().encode(`${JSON.stringify(facts, null, 1)}\n`)]]), `${name}-view.zip`);
    this.say(`${name}-view.zip is saved.`);
  }
}
