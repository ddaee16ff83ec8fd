// The view, light and time in the address: where a link leads to, and where one can come back to.
import { readAddress, writeAddress } from './address.js';
import { pose } from './core.js';
import { now } from './server_link.js';
import { notice } from './status.js';

const stillMs = 400;  // after the last motion a view is worth a place in the history

export class Place {
  constructor(viewer) {
    this.viewer = viewer;
    this.address = readAddress(location.hash);
    this.light = this.address.light ?? null;
    this.startedAt = now() - 1000 * (this.address.t ?? 0);
    this.hideToken();
    addEventListener('hashchange', () => this.follow());
  }

  /// Of the session, ms.
  sessionMs() { return now() - this.startedAt; }

  // Never in a history, a screenshot or a link that is passed on.
  hideToken() {
    if (this.address.token === undefined) return;
    const kept = location.hash.replace(/^#/, '').split('&').filter((part) => !part.startsWith('token='));
    history.replaceState(null, '', kept.length ? `#${kept.join('&')}` : location.pathname + location.search);
  }

  /// To a core that has just been started: where it was, or what the address says, as far as it says anything.
  apply() {
    const { eye, look, light } = this.address;
    if (eye) this.viewer.core._page_look(...eye, ...look);
    this.light = light ?? null;
    this.lightIsSet = false;
  }

  // A graphics context that is lost takes the core with it.
  keep() { this.kept = this.view(); }
  returnToKept() {
    if (!this.kept) return;
    const { eye, ahead, light } = this.kept;
    this.viewer.core._page_look(...eye, ...eye.map((v, i) => v + ahead[i]));
    this.light = light ?? null;
    this.lightIsSet = false;
  }

  /// Once there is a picture under it.
  tellWrong() {
    if (this.address.wrong.length) notice(`This link has parts that cannot be read: ${this.address.wrong.join(', ')}`);
    this.address.wrong = [];
  }

  /// The sun, once the scene is known that it stands in.
  setLight() {
    const { core } = this.viewer;
    if (this.lightIsSet || !core._page_home_known()) return;
    this.lightIsSet = true;
    if (this.light) core._page_sun(...this.light, this.sessionMs());
    else if (this.lightWasSet) core._page_sun(NaN, NaN, this.sessionMs());
    this.lightWasSet = Boolean(this.light);
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

  link() { return location.href.replace(/#.*$/, '') + writeAddress({ ...this.view(), budget: this.address.budget }); }

  /// A while after the last motion: a place one can come back to.
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
    this.address = { ...readAddress(location.hash), budget: this.address.budget };
    if (this.address.token !== undefined) {
      this.hideToken();
      viewer.link.useToken(this.address.token);
      return;
    }
    if (this.address.t !== undefined) this.startedAt = now() - 1000 * this.address.t;
    if (!viewer.viewerThere()) return;  // applied when it is
    this.tellWrong();
    this.apply();
    if (!this.address.eye && viewer.core._page_home_known()) viewer.core._page_home();
    viewer.compare.end();
    viewer.figures.showLight();
    viewer.wake();
  }
}
