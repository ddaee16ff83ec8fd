// Pace: gives frames to the graphics card no faster than it draws them. At most two are under way,
// so that they follow each other evenly, and a person soon sees what they do.

const mostUnderWay = 2;

export class Pace {
  /// Starts with a new context.
  begin(gl) {
    this.gl = gl;
    this.underWay = [];
  }

  /// True if another frame may be drawn now. It never waits.
  ready() {
    const { gl, underWay } = this;
    while (underWay.length && gl.getSyncParameter(underWay[0], gl.SYNC_STATUS) === gl.SIGNALED) gl.deleteSync(underWay.shift());
    return underWay.length < mostUnderWay;
  }

  drawn() {
    const { gl } = this;
    this.underWay.push(gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0));
    gl.flush();
  }
}
