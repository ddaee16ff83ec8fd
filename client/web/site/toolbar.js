// Toolbar: the buttons and their keys.
import { notice } from './status.js';

const $ = (id) => document.getElementById(id);
const keys = { KeyH: 'home', KeyL: 'share', KeyP: 'screenshot', KeyC: 'compare', KeyO: 'figures-button', KeyM: 'mode', KeyG: 'fly', KeyF: 'fullscreen', Space: 'pause' };
const withoutKey = ['download-button', 'keys', 'more'];

/// Gives a button of the bar another name and icon; the icon's is the name's.
function show(id, name) {
  $(id).querySelector('span').textContent = name;
  $(id).querySelector('use').setAttribute('href', `#icon-${name.toLowerCase()}`);
}

export class Toolbar {
  constructor(viewer) {
    this.viewer = viewer;
    const actions = {
      home: () => viewer.place.goHome(),
      share: () => this.share(),
      screenshot: () => this.screenshot(),
      'download-button': () => this.showDownload($('download').hidden),
      compare: () => viewer.compare.toggle(),
      mode: () => this.changeMode(),
      fly: () => this.fly(),
      pause: () => this.pause(),
      'figures-button': () => viewer.figures.toggle(),
      keys: () => this.showKeys($('keys-list').hidden),
      more: () => this.showMenu($('menu').hidden),
      fullscreen: () => (document.fullscreenElement ? document.exitFullscreen() : document.documentElement.requestFullscreen?.())?.catch?.(() => {}),
    };
    for (const [id, action] of Object.entries(actions)) {
      $(id).addEventListener('click', action);
      $(id).disabled = true;  // until there is a picture
    }
    if (!document.documentElement.requestFullscreen) $('fullscreen').hidden = true;
    $('menu').addEventListener('click', (e) => { if (e.target.closest('button')) this.showMenu(false); });
    $('menu').addEventListener('change', () => this.showMenu(false));
    addEventListener('pointerdown', (e) => { if (!$('bar').contains(e.target)) this.showMenu(false); });
    $('keys-close').addEventListener('click', () => this.showKeys(false));
    $('figures-close').addEventListener('click', () => viewer.figures.toggle());
    $('link-close').addEventListener('click', () => { $('link-box').hidden = true; });
    addEventListener('keydown', (e) => this.press(e));
  }

  enable() {
    for (const id of [...Object.values(keys), ...withoutKey]) $(id).disabled = false;
    this.play(!this.stopped);
  }

  // The first picture may be drawn before the last objects are described: only then is it known what moves.
  offerPause() {
    const still = this.viewer.core._page_animated() === 0;
    if ($('pause').hidden !== still) $('pause').hidden = still;
  }

  showKeys(shown) {
    $('keys-list').hidden = !shown;
    $('keys').setAttribute('aria-pressed', String(shown));
    if (shown) $('keys-close').focus();
  }

  showMenu(shown) {
    if (!shown && $('menu').contains(document.activeElement)) $('more').focus();
    $('menu').hidden = !shown;
    $('more').setAttribute('aria-expanded', String(shown));
  }

  changeMode() {
    const { core } = this.viewer;
    core._page_set_orbits(core._page_orbits() ? 0 : 1);
    this.showMode();
  }

  /// Names the button by what it would change to.
  showMode() {
    const orbits = this.viewer.core._page_orbits() !== 0;
    this.showFly();
    if (this.orbits === orbits) return;
    this.orbits = orbits;
    $('stick').hidden = orbits || !matchMedia('(pointer: coarse)').matches;  // fingers alone orbit
    show('mode', orbits ? 'Walk' : 'Orbit');
    $('mode').title = orbits ? 'Walk: turn in place, go where one looks (M)' : 'Orbit: turn about what is under the cursor (M)';
  }

  /// Takes the feet off the ground, or puts them back. The button says whether one flies.
  fly() {
    const { core } = this.viewer;
    const lands = core._page_grounded() === 0;
    core._page_set_grounded(lands ? 1 : 0);
    this.showFly();
    notice(lands ? 'Feet on the ground.' : 'Flying, through everything. G lands.');
  }

  /// Only who walks, in a scene with ground, chooses.
  showFly() {
    const { core } = this.viewer;
    const grounded = core._page_orbits() ? -1 : core._page_grounded();
    if (this.grounded === grounded) return;
    this.grounded = grounded;
    $('fly').hidden = grounded < 0;
    $('fly').setAttribute('aria-pressed', String(grounded === 0));
  }

  press(e) {
    const typing = e.target instanceof HTMLSelectElement || e.target instanceof HTMLInputElement && e.target.type !== 'range' && e.target.type !== 'radio';
    if (typing || e.ctrlKey || e.metaKey || e.altKey || e.repeat) return;
    if (e.code === 'Escape') { this.showMenu(false); this.viewer.compare.end(); $('link-box').hidden = true; this.showKeys(false); this.showDownload(false); }
    if (e.key === '?' && !$('keys').disabled) this.showKeys($('keys-list').hidden);
    const layer = /^Digit([1-5])$/.exec(e.code);
    if (layer) this.viewer.figures.showLayer(Number(layer[1]) - 1);
    if (e.code === 'Space' && e.target instanceof HTMLButtonElement) return;  // it presses that button
    if (keys[e.code] && !$(keys[e.code]).disabled) $(keys[e.code]).click();
  }

  pause() { this.play(Boolean(this.stopped)); }

  play(playing) {
    this.stopped = !playing;
    show('pause', playing ? 'Pause' : 'Play');
    $('pause').setAttribute('aria-pressed', String(!playing));
    this.viewer.core._page_play(playing ? 1 : 0, this.viewer.place.sessionMs());
    this.viewer.wake();
  }

  async share() {
    const link = this.viewer.place.link();
    try {
      await navigator.clipboard.writeText(link);
      notice('The link to this view is copied.');
    } catch {  // pages without TLS have no clipboard
      $('link-box').hidden = false;
      $('link').value = link;
      $('link').select();
    }
  }

  // These parts of the page come when they are needed.
  async screenshot() {
    const { fileName, picture, save } = await import('./download.js');
    save(await picture(this.viewer.core), `${fileName(this.viewer.core)}.png`);
  }

  async showDownload(shown) {
    if (!shown && !this.download) return;
    const { Download } = await import('./download.js');
    this.download ??= new Download(this.viewer);
    await this.download.show(shown);
  }
}
