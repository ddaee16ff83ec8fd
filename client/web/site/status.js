// Status: the page's messages over the picture, or in its place.
import { posterShown } from './poster.js';

const $ = (id) => document.getElementById(id);
const noticeMs = 6000;
let timer = 0;

/// Shows a text; '' hides it. `progress`: 0 to 1. `aside`: there is a picture underneath; the poster is one.
export function say(text, { progress = null, aside = true } = {}) {
  $('status').hidden = text === '';
  $('status').classList.toggle('aside', aside || posterShown());
  $('message').textContent = text;
  $('progress').hidden = progress === null;
  if (progress !== null) $('progress').value = progress;
}

/// Shows a text for a while.
export function notice(text) {
  say(text);
  clearTimeout(timer);
  timer = setTimeout(() => { if ($('message').textContent === text) say(''); }, noticeMs);
}
