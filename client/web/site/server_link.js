// Server link: the page's side of the worker that owns the socket, or reads a frozen folder. It
// connects, tries again, says what is wrong, and asks for the token.
import { textAt } from './core.js';
import { say } from './status.js';

const $ = (id) => document.getElementById(id);
const firstPauseMs = 250, longestPauseMs = 5000;  // before the next try to connect
const kept = 'mirage-token';

/// Returns the time, ms, by a clock that page and worker share.
export const now = () => performance.timeOrigin + performance.now();

// The folder that this page was frozen into; null: the page came from a server.
const told = document.querySelector('meta[name="mirage-folder"]');
export const folder = told ? new URL(told.content, document.baseURI).href : null;

function refusal(code, reason) {
  if (code === 4901) return `This page's folder cannot be read (${reason}). It was copied in part, or of another version: copy the whole folder again.`;
  if (code === 4902) return `This page's folder is not whole: there is no frozen.bin at ${reason}. Copy the whole folder.`;
  if (code === 4001) return 'The server speaks another version than this page. Reload it.';
  if (code === 4900) return `What the server sent cannot be read (${reason}). Reload the page; if that does not help, server and page do not belong together.`;
  if (code === 1008 || code === 1002 || code === 1009) return `The server refused what this page said (${reason || code}). Reload the page.`;
  return null;
}

export class ServerLink {
  constructor(viewer, token) {
    this.viewer = viewer;
    this.token = token ?? sessionStorage.getItem(kept) ?? '';
    this.arrivals = [];
    this.connected = false;
    this.holes = [];       // files of the folder that are missing or damaged
    this.told = false;     // the person knows that there is no server
    this.pauseMs = firstPauseMs;
    this.worker = new Worker(new URL('./socket_worker.js', import.meta.url), { type: 'module' });
    this.worker.onmessage = ({ data }) => {
      if (data.arrival) { this.arrivals.push(data.arrival); viewer.wake(); }
      if (data.open) this.opened();
      if (data.closed) this.closed(data.closed);
      if (data.hole) this.lacks(data.hole);
      if (data.flip) viewer.compare.measured(data.flip);
    };
    this.worker.onerror = () => viewer.fail('The part of this page that talks to the server did not start: module workers may be missing in this browser.');
    $('token-form').addEventListener('submit', (e) => { e.preventDefault(); this.useToken($('token').value.trim()); });
  }

  connect() {
    if (folder) { this.worker.postMessage({ folder }); return; }
    const scheme = location.protocol === 'https:' ? 'wss' : 'ws';
    const path = location.pathname.replace(/[^/]*$/, '');
    this.worker.postMessage({ connect: `${scheme}://${location.host}${path}` });
  }

  /// Connects a new core; messages for the former one are dropped.
  connectAnew() {
    this.arrivals.length = 0;
    this.connected = false;
    this.greeted = false;
    this.connect();
  }

  send(bytes) { this.worker.postMessage({ send: bytes }, [bytes.buffer]); }

  opened() {
    this.viewer.marks.connected ??= performance.now();
    this.connected = true;
    this.welcomes = this.viewer.viewerThere() ? this.viewer.core._page_welcomes() : 0;
    if (this.viewer.viewerThere()) this.viewer.core._page_connected(1);
    this.viewer.wake();
  }

  // Another file is drawn in its place, as wrong as that is.
  lacks(name) {
    this.holes.push(name);
    console.warn(`Mirage: ${name} is missing or damaged`);
    say(`${this.holes.length === 1 ? 'A file' : `${this.holes.length} files`} of this page ${this.holes.length === 1 ? 'is' : 'are'} missing or damaged, the last: ${name}`, { aside: true });
    this.viewer.wake();
  }

  closed({ code, reason, opened }) {
    const { viewer } = this;
    this.connected = false;
    this.arrivals.length = 0;
    if (viewer.viewerThere()) viewer.core._page_connected(0);
    if (code === 4003) { this.askToken(this.token !== ''); return; }
    if (code !== 1006 && viewer.viewerThere() && viewer.choices.refused(reason)) return;
    const refused = refusal(code, reason);
    if (refused) { viewer.fail(refused); return; }
    const goodbye = viewer.viewerThere() ? textAt(viewer.core, viewer.core._page_goodbye()) : '';
    const wait = this.pauseMs * (1 + 0.15 * Math.random());
    this.pauseMs = Math.min(2 * this.pauseMs, longestPauseMs);
    const why = opened || viewer.seen ? 'The server is gone' : 'No server answers here, or it does not let this page in';
    say(`${why}${goodbye ? ` (${goodbye})` : ''}: ${viewer.seen ? 'showing what is here, ' : ''}trying again in ${Math.max(1, Math.round(wait / 1000))} s`,
      { aside: Boolean(viewer.seen) });
    this.told = true;
    clearTimeout(this.retry);
    this.retry = setTimeout(() => this.connect(), wait);
    viewer.wake();
  }

  /// Passes arrived messages to the core; no frame waits for anything else. Returns the ms it took.
  deliver() {
    if (this.arrivals.length === 0) return 0;
    const began = performance.now();
    const { core } = this.viewer;
    for (const { control, payload, packed, wire, at } of this.arrivals.splice(0)) {
      const pointer = core._malloc(control.length + payload.length);
      core.HEAPU8.set(control, pointer);
      core.HEAPU8.set(payload, pointer + control.length);
      core._page_arrived(pointer, control.length, pointer + control.length, payload.length, packed, wire, Math.max(0, now() - at));
      core._free(pointer);
    }
    return performance.now() - began;
  }

  /// Notes that there is a picture. Returns true if its server was not there the last time. A server that loads the scene for
  /// this page first welcomes it only then.
  noteSeen() {
    if (!this.connected || this.viewer.core._page_welcomes() === this.welcomes || (this.greeted && !this.told)) return false;
    this.greeted = true;
    this.told = false;
    this.pauseMs = firstPauseMs;
    return true;
  }

  askToken(wrong) {
    sessionStorage.removeItem(kept);
    say(wrong ? 'The server does not know this token.' : '', { aside: false });
    $('token-form').hidden = false;
    $('token').value = '';
    $('token').focus();
  }

  useToken(token) {
    this.token = token;
    sessionStorage.setItem(kept, token);
    $('token-form').hidden = true;
    say('Connecting', { aside: false });
    this.viewer.restart();  // the new core greets with this token
  }
}
