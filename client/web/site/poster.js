// Poster: the picture of the home view that the page came with, if first.js has left it there. It shows until
// the program's is better, and follows the pointer a little.

const box = document.getElementById('poster');
const image = box?.firstElementChild;
const fadeMs = 250;  // as in style.css

let there = Boolean(box);
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
