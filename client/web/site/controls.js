// Controls: mouse, keyboard, fingers, stick and gamepad as one motion, which is taken every frame.

const radiansPerPixel = 0.003;  // as in the native window
const metresPerPixel = 0.01;    // of two fingers, at walking speed
const keyMoves = {
  KeyW: [0, 0, 1], ArrowUp: [0, 0, 1], KeyS: [0, 0, -1], ArrowDown: [0, 0, -1], KeyD: [1, 0, 0], ArrowRight: [1, 0, 0],
  KeyA: [-1, 0, 0], ArrowLeft: [-1, 0, 0], KeyE: [0, 1, 0], KeyQ: [0, -1, 0] };
const dead = 0.15;  // of a gamepad's axes

export class Controls {
  constructor(canvas, stick, wake) {
    this.wake = wake;
    this.keys = new Set();
    this.pointers = new Map();
    this.stickAt = [0, 0];
    this.turn = [0, 0];     // radians since the last take
    this.step = [0, 0, 0];  // metres at walking speed
    this.fast = false;
    this.listen(canvas);
    this.listenStick(stick);
    addEventListener('gamepadconnected', () => this.wake());
  }

  listen(canvas) {
    canvas.addEventListener('pointerdown', (e) => {
      canvas.focus({ preventScroll: true });
      try { canvas.setPointerCapture(e.pointerId); } catch { /* a pointer that is gone already */ }
      this.pointers.set(e.pointerId, [e.clientX, e.clientY]);
      this.wake();
    });
    canvas.addEventListener('pointermove', (e) => this.drag(e));
    for (const end of ['pointerup', 'pointercancel', 'lostpointercapture']) {
      canvas.addEventListener(end, (e) => { this.pointers.delete(e.pointerId); });
    }
    canvas.addEventListener('wheel', (e) => {
      e.preventDefault();
      this.step[2] -= Math.sign(e.deltaY) * 0.5;
      this.wake();
    }, { passive: false });
    addEventListener('keydown', (e) => {
      const typing = e.target instanceof HTMLInputElement || e.ctrlKey || e.metaKey || e.altKey;
      if (!keyMoves[e.code] || typing) return;
      e.preventDefault();
      this.keys.add(e.code);
      this.fast = e.shiftKey;
      this.wake();
    });
    addEventListener('keyup', (e) => { this.keys.delete(e.code); this.fast = e.shiftKey; });
    addEventListener('blur', () => { this.keys.clear(); this.pointers.clear(); this.stickAt = [0, 0]; });
  }

  // One pointer looks; two pointers move the eye by where they go and how they spread.
  drag(e) {
    const before = this.pointers.get(e.pointerId);
    if (!before) return;
    const dx = e.clientX - before[0], dy = e.clientY - before[1];
    if (this.pointers.size === 1) {
      this.turn[0] += dx * radiansPerPixel;
      this.turn[1] += dy * radiansPerPixel;
    } else {
      const [, other] = [...this.pointers].find(([id]) => id !== e.pointerId);
      const spread = Math.hypot(e.clientX - other[0], e.clientY - other[1]) -
        Math.hypot(before[0] - other[0], before[1] - other[1]);
      this.step[0] -= dx * metresPerPixel / 2;
      this.step[1] += dy * metresPerPixel / 2;
      this.step[2] += spread * metresPerPixel;
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

  /// Returns the motion since the last call, `seconds` ago: radians to turn, m at walking speed to
  /// move, and whether anything is held.
  take(seconds) {
    const turn = this.turn, move = this.step.map((m) => m);
    this.turn = [0, 0];
    this.step = [0, 0, 0];
    let held = this.keys.size > 0 || this.stickAt.some((v) => v !== 0);
    for (const key of this.keys) keyMoves[key].forEach((m, i) => { move[i] += m * seconds; });
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
    return { turn, move, boost: this.fast ? 5 : 1, held: held || this.pointers.size > 0,
      moved: turn.some((v) => v !== 0) || move.some((v) => v !== 0) };
  }
}
