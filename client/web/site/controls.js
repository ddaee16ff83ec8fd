// Controls: mouse, keyboard, fingers, stick and gamepad as one motion, which is taken every frame. The
// core turns it into a way of the eye (client/screen/pilot.h).

const wheelStep = 100;        // of a wheel's delta
const mostWheelSteps = 3;     // of one event
const pinchSteps = 12;        // for fingers that spread by the picture's height
const flySteps = 5;           // of a double click
const glideS = 0.08;          // in which most of a step is gone
const looks = { KeyZ: [-1, 0], KeyX: [1, 0], KeyR: [0, -1], KeyV: [0, 1] };
const lookRate = 1.2;         // radians a second
const keyMoves = {
  KeyW: [0, 0, 1], ArrowUp: [0, 0, 1], KeyS: [0, 0, -1], ArrowDown: [0, 0, -1], KeyD: [1, 0, 0], ArrowRight: [1, 0, 0],
  KeyA: [-1, 0, 0], ArrowLeft: [-1, 0, 0], KeyE: [0, 1, 0], KeyQ: [0, -1, 0] };
const dead = 0.15;  // of a gamepad's axes

export class Controls {
  /// `aim` gets the place of the picture, 0 to 1, where a hand takes hold. `stick` is an element or null; `keys` is what hears the
  /// keyboard; hands and wheel are left to the page while active() is false.
  constructor(canvas, stick, wake, aim, { keys = globalThis, active = () => true } = {}) {
    this.wake = wake;
    this.aim = aim;
    this.active = active;
    this.keys = new Set();
    this.pointers = new Map();
    this.stickAt = [0, 0];
    this.dragged = [0, 0];  // shares of the picture's height, since the last take
    this.panned = [0, 0];
    this.zoom = 0;          // steps that are not taken yet
    this.fast = false;
    this.listen(canvas);
    this.listenKeys(keys);
    if (stick) this.listenStick(stick);
    addEventListener('gamepadconnected', () => this.wake());
  }

  listen(canvas) {
    canvas.addEventListener('pointerdown', (e) => {
      if (!this.active()) return;
      canvas.focus({ preventScroll: true });
      try { canvas.setPointerCapture(e.pointerId); } catch { /* a pointer that is gone already */ }
      this.pointers.set(e.pointerId, [e.clientX, e.clientY]);
      this.pans = e.button === 1 || e.button === 2;
      this.aimAt(e);
      this.wake();
    });
    canvas.addEventListener('contextmenu', (e) => { if (this.active()) e.preventDefault(); });  // the right button pans
    canvas.addEventListener('dblclick', (e) => {
      if (!this.active()) return;
      this.aimAt(e);
      this.zoom += flySteps;
      this.wake();
    });
    canvas.addEventListener('pointermove', (e) => this.drag(e));
    for (const end of ['pointerup', 'pointercancel', 'lostpointercapture']) {
      canvas.addEventListener(end, (e) => { this.pointers.delete(e.pointerId); });
    }
    canvas.addEventListener('wheel', (e) => {
      if (!this.active()) return;
      e.preventDefault();
      this.aimAt(e);
      const steps = e.deltaMode === WheelEvent.DOM_DELTA_PIXEL ? e.deltaY / wheelStep : Math.sign(e.deltaY);
      this.zoom -= Math.max(-mostWheelSteps, Math.min(mostWheelSteps, steps));
      this.wake();
    }, { passive: false });
  }

  listenKeys(keys) {
    keys.addEventListener('keydown', (e) => {
      const typing = e.target instanceof HTMLSelectElement || (e.target instanceof HTMLInputElement && e.target.type !== 'radio') || e.ctrlKey || e.metaKey || e.altKey;
      if (!(keyMoves[e.code] || looks[e.code]) || typing || !this.active()) return;
      e.preventDefault();
      this.keys.add(e.code);
      this.fast = e.shiftKey;
      this.wake();
    });
    keys.addEventListener('keyup', (e) => { this.keys.delete(e.code); this.fast = e.shiftKey; });
    addEventListener('blur', () => { this.keys.clear(); this.pointers.clear(); this.stickAt = [0, 0]; });
  }

  aimAt(e) {
    const box = e.target.getBoundingClientRect();
    this.aim((e.clientX - box.left) / box.width, (e.clientY - box.top) / box.height);
  }

  // One pointer turns, or pans with its right button; two pan by where they go, and zoom by how they spread.
  drag(e) {
    const before = this.pointers.get(e.pointerId);
    if (!before) return;
    const height = e.target.clientHeight || 1;
    const way = [(e.clientX - before[0]) / height, (e.clientY - before[1]) / height];
    if (this.pointers.size === 1) {
      const to = this.pans ? this.panned : this.dragged;
      way.forEach((share, i) => { to[i] += share; });
    } else {
      const [, other] = [...this.pointers].find(([id]) => id !== e.pointerId);
      const spread = Math.hypot(e.clientX - other[0], e.clientY - other[1]) -
        Math.hypot(before[0] - other[0], before[1] - other[1]);
      way.forEach((share, i) => { this.panned[i] += share / 2; });  // each of the two tells its half
      this.zoom += pinchSteps * spread / height;
    }
    this.pointers.set(e.pointerId, [e.clientX, e.clientY]);
    this.wake();
  }

  listenStick(stick) {
    const knob = stick.firstElementChild;
    const put = (x, y) => {
      this.stickAt = [x, y];
      knob.style.left = `${50 + 36 * x}%`;
      knob.style.top = `${50 + 36 * y}%`;
      this.wake();
    };
    const to = (e) => {
      const box = stick.getBoundingClientRect();
      const x = (e.clientX - box.left) / box.width * 2 - 1, y = (e.clientY - box.top) / box.height * 2 - 1;
      const long = Math.max(1, Math.hypot(x, y));
      put(x / long, y / long);
    };
    let held = null;
    stick.addEventListener('pointerdown', (e) => {
      held = e.pointerId;
      try { stick.setPointerCapture(held); } catch { /* as above */ }
      to(e);
    });
    stick.addEventListener('pointermove', (e) => { if (e.pointerId === held) to(e); });
    for (const end of ['pointerup', 'pointercancel']) {
      stick.addEventListener(end, (e) => { if (e.pointerId === held) { held = null; put(0, 0); } });
    }
  }

  gamepads() { return navigator.getGamepads ? [...navigator.getGamepads()].filter((pad) => pad && pad.connected) : []; }

  /// True if somebody steers, or has since the last take().
  steers() {
    return this.keys.size > 0 || this.pointers.size > 0 || [...this.dragged, ...this.panned, ...this.stickAt, this.zoom].some((v) => v !== 0);
  }

  /// Forgets the motion since the last take(). Returns that there is none; what is held stays held.
  still() {
    this.take(0);
    this.zoom = 0;
    return { steering: [], held: false, moved: false };
  }

  /// Returns the motion since the last call, `seconds` ago: the numbers of page_steer(), and whether
  /// anything is held.
  take(seconds) {
    const drag = this.dragged, pan = this.panned, turn = [0, 0], move = [0, 0, 0];
    this.dragged = [0, 0];
    this.panned = [0, 0];
    const whole = Math.abs(this.zoom) < 0.02;
    const zoom = whole ? this.zoom : this.zoom * (1 - Math.exp(-seconds / glideS));
    this.zoom -= zoom;
    let held = this.keys.size > 0 || this.stickAt.some((v) => v !== 0) || this.zoom !== 0;
    for (const key of this.keys) {
      keyMoves[key]?.forEach((m, i) => { move[i] += m * seconds; });
      looks[key]?.forEach((share, i) => { turn[i] += share * lookRate * seconds; });
    }
    move[0] += this.stickAt[0] * seconds;
    move[2] -= this.stickAt[1] * seconds;
    for (const pad of this.gamepads()) {
      const axis = (i) => (Math.abs(pad.axes[i] || 0) > dead ? pad.axes[i] : 0);
      const button = (i) => (pad.buttons[i] ? pad.buttons[i].value : 0);
      const values = [axis(0), axis(1), axis(2), axis(3), button(7) - button(6)];
      held = held || values.some((v) => v !== 0);
      move[0] += values[0] * seconds;
      move[2] -= values[1] * seconds;
      move[1] += values[4] * seconds;
      turn[0] += values[2] * seconds * 2;
      turn[1] += values[3] * seconds * 2;
    }
    const boost = this.fast ? 5 : 1;
    const steering = [...drag, ...turn, ...move.map((m) => m * boost), ...pan, zoom];
    return { steering, held: held || this.pointers.size > 0, moved: steering.some((v) => v !== 0) };
  }
}
