// Choices: which clip of the scene plays, and which variant of its materials is shown. Another choice
// is another scene of the server: the page connects anew, and the picture stays until there is a new one.
import { textAt, withText } from './core.js';
import { notice, say } from './status.js';

const $ = (id) => document.getElementById(id);
const kinds = ['clip', 'variant'];
const asServed = { clip: 'All clips', variant: 'As it is' };
const mostBytes = 256;  // of a name

const named = ({ clip, variant }) => [clip, variant].filter(Boolean).map((name) => `“${name}”`).join(', ');

export class Choices {
  constructor(viewer) {
    this.viewer = viewer;
    const query = new URLSearchParams(location.search);
    const asked = (kind) => {
      const name = query.get(kind) ?? '';
      return new TextEncoder().encode(name).length <= mostBytes ? name : '';
    };
    this.wanted = { clip: asked('clip'), variant: asked('variant') };
    for (const kind of kinds) {
      $(kind).addEventListener('change', () => {
        $('mirage').focus({ preventScroll: true });  // keys move again
        this.choose({ ...this.shown(), [kind]: $(kind).value });
      });
    }
  }

  shown() {
    const { core } = this.viewer;
    return { clip: textAt(core, core._page_shown_choice(0)), variant: textAt(core, core._page_shown_choice(1)) };
  }

  choose(wanted) {
    this.before = this.shown();
    this.connect(wanted);
    this.waits = true;
    say(`The server prepares ${named(wanted) || 'the scene as it is'}`);
  }

  connect(wanted) {
    const { viewer } = this;
    this.wanted = wanted;
    withText(viewer.core, wanted.clip, (clip) => withText(viewer.core, wanted.variant, (variant) => viewer.core._page_choose(clip, variant)));
    viewer.core._page_connected(0);
    viewer.link.connectAnew();
    viewer.wake();
  }

  /// Goes back to the choice of before, if the server has closed the connection for another one. Returns true if so.
  refused(reason) {
    if (!this.waits) return false;
    this.waits = false;
    this.refusal = `The server does not show ${named(this.wanted)}: ${reason || 'the connection was closed'}`;  // told once it is back
    this.connect(this.before);
    return true;
  }

  /// Shows what the scene offers, and what is shown of it. Called once a frame.
  look() {
    const welcomes = this.viewer.core._page_welcomes();
    if (welcomes === this.welcomes) return;
    this.welcomes = welcomes;
    const shown = this.shown();
    kinds.forEach((kind, i) => this.list(kind, i, shown[kind]));
    this.tell(shown);
  }

  list(kind, number, shown) {
    const { core } = this.viewer;
    const names = Array.from({ length: core._page_choice_count(number) }, (_, i) => textAt(core, core._page_choice(number, i)));
    this.first ??= {};
    this.first[kind] ??= this.wanted[kind] && shown === this.wanted[kind] ? '' : shown;  // what an empty name stands for
    const first = this.first[kind];
    const option = (value, text) => {
      const out = document.createElement('option');
      [out.value, out.textContent, out.selected] = [value, text, value === shown];
      return out;
    };
    $(kind).replaceChildren(...(first === '' ? [option('', asServed[kind])] : []), ...names.map((name) => option(name, name)));
    $(`${kind}-choice`).hidden = names.length === 0 || (names.length === 1 && first !== '');
  }

  // Ends the wait, and keeps the address true.
  tell(shown) {
    const missing = kinds.filter((kind) => this.wanted[kind] && this.wanted[kind] !== shown[kind]);
    if (this.waits) say('');
    this.waits = false;
    if (this.refusal) notice(this.refusal);
    this.refusal = '';
    if (missing.length) notice(`This scene has no ${missing.map((kind) => `${kind} “${this.wanted[kind]}”`).join(', and no ')}`);
    const query = new URLSearchParams(location.search);
    for (const kind of kinds) this.wanted[kind] && !missing.includes(kind) ? query.set(kind, this.wanted[kind]) : query.delete(kind);
    const search = query.size ? `?${query}` : '';
    if (search !== location.search) history.replaceState(null, '', location.pathname + search + location.hash);
  }
}
