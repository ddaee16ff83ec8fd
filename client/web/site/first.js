// First: shows the poster as soon as the page has come so far. It stands in the page itself: a file would come a round
// trip later. The poster stays hidden where the program would draw another view (address.js, choices.js), and where a
// phone is held across.
const box = document.getElementById('poster');
if (box) {
  const size = (name) => Number(box.firstElementChild.getAttribute(name));
  const elsewhere = /[#&](eye|look|light|t|fov|bg)=/.test(location.hash) || /[?&](clip|variant)=/.test(location.search);
  const across = size('height') > size('width') && innerWidth > innerHeight;
  if (elsewhere || across) box.remove();
  else box.hidden = false;
}
