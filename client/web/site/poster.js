// Poster: the picture of the home view that the page came with. It shows until the program's is
// better, and follows the pointer a little. Without one in the page, where the address names another
// view, or where a phone is held across, nothing is shown.
import { readAddress, usualFov } from './address.js';
import { dispose, follow } from './impostor.js';

const box = document.getElementById('poster');
const fadeMs = 250;  // as in style.css

// The program would draw something else than the server's home view.
function elsewhere() {
  const { eye, light, t, fov = usualFov, bg } = readAddress(location.hash);
  const query = new URLSearchParams(location.search);
  return Boolean(eye || light || t || bg) || fov !== usualFov || query.has('clip') || query.has('variant');
}

const image = box?.firstElementChild;
const size = (name) => Number(image?.getAttribute(name));
const across = size('height') > size('width') && innerWidth > innerHeight;
let there = Boolean(box) && !across && !elsewhere();
if (there) {
  box.hidden = false;
  follow(image, document.getElementById('mirage'));
} else {
  box?.remove();
}

/// True while the poster stands for the picture.
export const posterShown = () => there;

/// Lets the picture underneath take over.
export function leavePoster() {
  if (!there) return;
  there = false;
  box.classList.add('leaving');
  setTimeout(() => { dispose(); box.remove(); }, fadeMs);
}
