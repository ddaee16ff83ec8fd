// Poster: the picture of the home view that the page came with. It shows until the program's is
// better, and follows the pointer a little. Without one in the page, where the address names another
// view, or where a phone is held across, nothing is shown. It needs no other part of the page to
// show: each would come a round trip later.

const box = document.getElementById('poster');
const image = box?.firstElementChild;
const fadeMs = 250;  // as in style.css

// The program would draw something else than the server's home view (address.js, choices.js).
const elsewhere = /[#&](eye|look|light|t|fov|bg)=/.test(location.hash) || /[?&](clip|variant)=/.test(location.search);
const size = (name) => Number(image?.getAttribute(name));
const across = size('height') > size('width') && innerWidth > innerHeight;

let there = Boolean(box) && !across && !elsewhere;
if (there) box.hidden = false;
else box?.remove();
const motion = there ? import('./impostor.js') : null;
motion?.then(({ follow }) => follow(image, document.getElementById('mirage')));

/// True while the poster stands for the picture.
export const posterShown = () => there;

/// Lets the picture underneath take over.
export function leavePoster() {
  if (!there) return;
  there = false;
  box.classList.add('leaving');
  setTimeout(() => { motion.then(({ dispose }) => dispose()); box.remove(); }, fadeMs);
}
