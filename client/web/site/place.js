// Place: the view, light and time in the address, so that a link leads to them and one can come
// back.
import { qualities, readAddress, usualFov, writeAddress } from './address.js';
import { pose } from './core.js';
import { leavePoster } from './poster.js';
import { folder, now } from './server_link.js';
import { notice } from './status.js';

const stillMs = 400;  // a view enters the history this long after the last motion

// A frozen folder has one light, and nothing in it moves.
function read() {
  const address = readAddress(location.hash);
  for (const name of folder ? ['light', 't'] : []) {
    if (address[name] === undefined) continue;
    address.wrong.push(`${name}, which this page was frozen without`);
    delete address[name];
  }
  return address;
}

export class Place {
  constructor(viewer) {
    this.viewer = viewer;
    this.address = read();
    this.light = this.address.light ?? null;
    this.startedAt = now() - 1000 * (this.address.t ?? 0);
    this.hideToken();
    addEventListener('hashchange', () => this.follow());
  }

  /// Returns the session's time, ms.
  sessionMs() { return now() - this.startedAt; }

  // Keeps the token out of histories, screenshots and shared links.
  hideToken() {
    if (this.address.token === undefined) return;
    const kept = location.hash.replace(/^#/, '').split('&').filter((part) => !part.startsWith('token='));
    history.replaceState(null, '', kept.length ? `#${kept.join('&')}` : location.pathname + location.search);
  }

  /// Tells a new core where the eye was, or what the address says, as far as it says anything.
  apply() {
    const { eye, look, light } = this.address;
    if (eye) this.viewer.core._page_look(...eye, ...look);
    this.light = light ?? null;
    this.lightIsSet = false;
    this.applyPicture();
  }

  /// Tells the core how the picture is to be: its field of view, its background, and what it may take.
  applyPicture() {
    const { core } = this.viewer;
    core._page_fov(this.fov());
    core._page_background(this.address.bg === undefined ? -1 : parseInt(this.address.bg, 16));
    if (this.address.budget === undefined) core._page_pace(qualities[this.quality()]);
    this.viewer.figures?.showPicture();
    this.viewer.wake();
  }
  fov() { return this.address.fov ?? usualFov; }
  quality() { return this.address.quality ?? 'auto'; }
  changePicture(change) {
    Object.assign(this.address, change);
    this.changedAt = performance.now();
    this.viewer.compare.end();
    this.applyPicture();
  }

  // Keeps the view, because a lost graphics context takes the core with it.
  keep() { this.kept = this.view(); }
  returnToKept() {
    if (!this.kept) return;
    const { eye, ahead, light } = this.kept;
    this.viewer.core._page_look(...eye, ...eye.map((v, i) => v + ahead[i]));
    this.light = light ?? null;
    this.lightIsSet = false;
  }

  /// Names unreadable parts of the link, once there is a picture underneath.
  tellWrong() {
    if (this.address.wrong.length) notice(`This link has parts that cannot be read: ${this.address.wrong.join(', ')}`);
    this.address.wrong = [];
  }

  /// Sets the sun once its scene is known.
  setLight() {
    const { core } = this.viewer;
    if (this.lightIsSet || !core._page_home_known()) return;
    this.lightIsSet = true;
    if (this.light) core._page_sun(...this.light, this.sessionMs());
    else if (this.lightWasSet) core._page_sun(NaN, NaN, this.sessionMs());
    this.lightWasSet = Boolean(this.light);
    this.viewer.figures.showLight();
  }

  changeLight(light) {
    this.light = light;
    this.lightIsSet = false;
    this.changedAt = performance.now();
    this.viewer.wake();
  }

  goHome() {
    this.viewer.core._page_home();
    this.changedAt = 0;
    this.viewer.wake();
  }

  view() { return { ...pose(this.viewer.core), light: this.light ?? undefined }; }

  link() {
    const { fov, quality, bg, budget } = this.address;
    return location.href.replace(/#.*$/, '') + writeAddress({ ...this.view(), fov, quality, bg, budget });
  }

  /// Adds the view to the history a while after the last motion.
  remember(motion, at) {
    if (motion.moved) this.changedAt = at;
    if (this.changedAt === undefined || motion.held || at - this.changedAt < stillMs) return;
    this.changedAt = undefined;
    const link = this.link();
    if (link === location.href) return;
    if (location.hash === '') history.replaceState(null, '', link);
    else history.pushState(null, '', link);
  }

  follow() {
    const { viewer } = this;
    this.address = { ...read(), budget: this.address.budget };
    if (this.address.token !== undefined) {
      this.hideToken();
      viewer.link.useToken(this.address.token);
      return;
    }
    if (this.address.t !== undefined) this.startedAt = now() - 1000 * this.address.t;
    leavePoster();
    if (!viewer.viewerThere()) return;  // applied once it is there
    this.tellWrong();
    this.apply();
    if (!this.address.eye && viewer.core._page_home_known()) viewer.core._page_home();
    viewer.compare.end();
    viewer.figures.showLight();
    viewer.wake();
  }
}
