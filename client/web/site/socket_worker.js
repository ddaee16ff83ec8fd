// Socket worker: owns the socket. It stamps, joins and unpacks what arrives, so that the page's
// frames only copy.
// From the page: {module} once, {connect: URL}, {send: bytes}, {close}, {flip: {id, reference, test, width, height}}.
// To the page: {open}, {closed: {code, reason, opened}}, {arrival: {control, payload, packed, wire, at}}, {flip: {id, mean,
// objects, most, heat}}.
import createMirage from './mirage.js';

let core = null;
let socket = null;
const waiting = [];

const now = () => performance.timeOrigin + performance.now();

function copied(bytes, use) {
  const at = core._malloc(bytes.length);
  core.HEAPU8.set(bytes, at);
  const out = use(at, bytes.length);
  core._free(at);
  return out;
}

function accept(from, bytes, at) {
  copied(bytes, (pointer, size) => {
    const out = core._socket_accept(pointer, size) >> 2;
    const [state, control, controlBytes, payload, payloadBytes, packed, wire] = core.HEAP32.subarray(out, out + 7);
    if (state < 0) {
      from.close(4900, core.UTF8ToString(core._socket_problem()).slice(0, 100));
    } else if (state > 0) {
      const arrival = {
        control: core.HEAPU8.slice(control, control + controlBytes),
        payload: core.HEAPU8.slice(payload, payload + payloadBytes), packed, wire, at };
      postMessage({ arrival }, [arrival.control.buffer, arrival.payload.buffer]);
    }
  });
}

function connect(url) {
  const before = socket;
  const mine = new WebSocket(url, 'mirage');
  let opened = false;
  mine.binaryType = 'arraybuffer';
  socket = mine;
  before?.close(1000);
  core._socket_reset();
  mine.onopen = () => { opened = true; postMessage({ open: true }); };
  mine.onmessage = ({ data }) => { if (mine === socket) accept(mine, new Uint8Array(data), now()); };
  mine.onclose = ({ code, reason }) => {
    if (mine === socket) { socket = null; postMessage({ closed: { code, reason, opened } }); }
  };
}

function send(bytes) {
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
  if (message.connect) connect(message.connect);
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
