// Frames are handed to the graphics card no faster than it draws them: two are under way at most, so that they follow each other
// evenly, and what a person does is seen soon.

const mostUnderWay = 2;

export class Pace {
  /// A context that has just been made.
  begin(gl) {
    this.gl = gl;
    this.underWay = [];
  }

  /// Whether another frame may be drawn now. Asks nothing that has to be waited for.
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
