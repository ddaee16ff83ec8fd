// Socket worker: owns the socket, or reads a frozen folder in its place. It stamps, joins and
// unpacks what arrives, so that the page's frames only copy.
// From the page: {module} once, {connect: URL, folder: URL}, {send: bytes}, {close}, {flip: {id, reference, test, width, height}}.
// With both addresses the folder is looked for where no server answers; one of them may be missing.
// To the page: {open, frozen}, {closed: {code, reason, opened}}, {arrival: {control, payload, packed, wire, at}}, {hole: NAME},
// {flip: {id, mean, objects, most, heat}}.
import createMirage from './mirage.js';

let core = null;
let socket = null;
let folder = null;   // address of the frozen folder that answers
const waiting = [];

const now = () => performance.timeOrigin + performance.now();

function copied(bytes, use) {
  const at = core._malloc(bytes.length);
  core.HEAPU8.set(bytes, at);
  const out = use(at, bytes.length);
  core._free(at);
  return out;
}

// Passes on what a function of the core returned as the words of a message. Returns 1: passed, 0: none is there, -1: it was refused.
function pass(out, at) {
  const [state, control, controlBytes, payload, payloadBytes, packed, wire] = core.HEAP32.subarray(out >> 2, (out >> 2) + 7);
  if (state <= 0) return state;
  const arrival = {
    control: core.HEAPU8.slice(control, control + controlBytes),
    payload: core.HEAPU8.slice(payload, payload + payloadBytes), packed, wire, at };
  postMessage({ arrival }, [arrival.control.buffer, arrival.payload.buffer]);
  return 1;
}

const problem = () => core.UTF8ToString(core._socket_problem());

function accept(from, bytes, at) {
  copied(bytes, (pointer, size) => {
    if (pass(core._socket_accept(pointer, size), at) < 0) from.close(4900, problem().slice(0, 100));
  });
}

// --- a frozen folder ------------------------------------------------------------------------------------------------------
// Passes on what the folder answers, names what it lacks, and fetches what it wants.
function answer(mine) {
  const at = now();
  for (let state = 1; state !== 0;) {
    state = pass(core._folder_next_message(), at);
    if (state < 0) console.warn(`Mirage: a file of the folder cannot be read: ${problem()}`);
  }
  for (let name; (name = core._folder_next_hole());) postMessage({ hole: core.UTF8ToString(name) });
  for (let name; (name = core._folder_next_fetch());) fetchFile(mine, core.UTF8ToString(name));
}

async function fetchFile(mine, name) {
  let bytes = null;
  try {
    const got = await fetch(new URL(name, mine), { cache: 'force-cache' });  // it never changes under its name
    if (got.ok) bytes = new Uint8Array(await got.arrayBuffer());
  } catch { /* the file is missing: said below */ }
  if (mine !== folder) return;
  const text = new TextEncoder().encode(`${name}\0`);
  copied(text, (at) => (bytes ? copied(bytes, (pointer, size) => core._folder_fetched(at, pointer, size)) : core._folder_fetched(at, 0, 0)));
  answer(mine);
}

// Opens a folder. Returns false if there is none at that address; what is there but damaged ends in `closed`.
async function openFolder(url) {
  folder = url;
  const at = new URL('frozen.bin', url);
  const got = await fetch(at, { cache: 'no-cache' }).catch(() => null);
  const bytes = got?.ok ? await got.arrayBuffer().catch(() => null) : null;
  if (folder !== url) return true;
  if (!bytes) {
    folder = null;
  } else if (copied(new Uint8Array(bytes), (pointer, size) => core._folder_open(pointer, size)) < 0) {
    folder = null;
    postMessage({ closed: { code: 4901, reason: `${at}: ${problem()}`, opened: false } });
  } else {
    postMessage({ open: true, frozen: true });
  }
  return Boolean(bytes);
}

// --- a server -------------------------------------------------------------------------------------------------------------
function connect(url, orFolder) {
  const before = socket;
  folder = null;
  socket = null;
  before?.close(1000);
  const none = () => postMessage({ closed: { code: 4902, reason: String(orFolder), opened: false } });
  if (!url) { openFolder(orFolder).then((there) => { if (!there) none(); }); return; }
  const mine = new WebSocket(url, 'mirage');
  let opened = false;
  mine.binaryType = 'arraybuffer';
  socket = mine;
  core._socket_reset();
  mine.onopen = () => { opened = true; postMessage({ open: true, frozen: false }); };
  mine.onmessage = ({ data }) => { if (mine === socket) accept(mine, new Uint8Array(data), now()); };
  mine.onclose = async ({ code, reason }) => {
    if (mine !== socket) return;
    socket = null;
    if (orFolder && !opened && code === 1006 && await openFolder(orFolder)) return;
    if (socket === null) postMessage({ closed: { code, reason, opened } });
  };
}

function send(bytes) {
  if (folder) {
    copied(bytes, (pointer, size) => core._folder_ask(pointer, size));
    answer(folder);
    return;
  }
  if (!socket || socket.readyState !== WebSocket.OPEN) return;
  copied(bytes, (pointer, size) => {
    const packets = core._socket_split(pointer, size);
    for (let i = 0; i < packets; ++i) {
      const at = core._socket_packet(i);
      socket.send(core.HEAPU8.slice(at, at + core._socket_packet_bytes(i)));
    }
  });
}

function flip({ id, reference, test, width, height }) {
  const at = copied(reference, (a) => copied(test, (b) => core._picture_flip(a, b, width, height))) >> 3;
  const [mean, objects, most, x, y, there] = core.HEAPF64.subarray(at, at + 6);
  const map = core._picture_heat();
  const heat = map ? core.HEAPU8.slice(map, map + 4 * width * height) : null;
  postMessage({ flip: { id, mean, objects, most, worst: there > 0 ? { x, y, flip: there } : null, heat } }, heat ? [heat.buffer] : []);
}

function handle(message) {
  if (message.connect || message.folder) connect(message.connect, message.folder);
  if (message.send) send(message.send);
  if (message.close && socket) socket.close(1000);
  if (message.flip) flip(message.flip);
}

onmessage = async ({ data }) => {
  if (!data.module) { core ? handle(data) : waiting.push(data); return; }
  core = await createMirage({
    instantiateWasm(imports, done) {
      WebAssembly.instantiate(data.module, imports).then((instance) => done(instance));
      return {};
    } });
  for (const message of waiting.splice(0)) handle(message);
};
