export interface MirageOptions {
  /** Address of the server: http, https, ws or wss; `?clip=` and `?variant=` choose. */
  url: string;
  token?: string;
  /** Time for a frame, ms, 0 to 10,000; 0: by renderer. Default 0. */
  frameMs?: number;
  /** Largest error of impostors, px, 0.01 to 1,000. Default 1. */
  tauPx?: number;
  /** Samples of a pixel, 0 to 16; 0: chosen frame by frame. Default 0. */
  samples?: number;
  /** Draw the scene's own background behind everything. Default false. */
  sky?: boolean;
  /** Graphics memory for impostors and for geometry, MB. Default 192 and 256. */
  atlasMb?: number;
  geometryMb?: number;
  /** Where the program is, if not beside index.js. */
  wasm?: string | URL | Response | WebAssembly.Module;
  /** Where the worker is, if not beside index.js. */
  worker?: string | URL | Worker;
}

/** One view of a frame, in metres of the scene; it looks along -z of its rotation, and +y is up. */
export interface View {
  eye: [number, number, number];
  /** Unit quaternion x, y, z, w. */
  rotation: [number, number, number, number];
  /** Tangents of the angles to the picture's edges, with signs: left and down are usually below 0. */
  tangents: { left: number; right: number; down: number; up: number };
  /** Pixels, 1 to 8,192. */
  width: number;
  height: number;
}

/** The picture of a view. Both textures stay until the next update. */
export interface Picture {
  /** sRGB, 8 bits, premultiplied; alpha is the share that objects cover. */
  color: WebGLTexture;
  /** Window depth = windowDepth[0] + windowDepth[1] / eye depth in metres of the scene. */
  depth: WebGLTexture;
  width: number;
  height: number;
  windowDepth: [number, number];
}

export interface SceneInfo {
  name: string;
  center: [number, number, number];
  radius: number;
  home: { eye: [number, number, number]; target: [number, number, number] };
}

export type MirageEvent = 'load' | 'rest' | 'needs-render' | 'up' | 'down' | 'hole' | 'error';

/** A client of one server, or of a frozen folder, on a WebGL 2 context of yours. Events carry `detail.text`. */
export class MirageClient extends EventTarget {
  /** Throws TypeError or RangeError if an option makes no sense. */
  constructor(options: MirageOptions & { gl: WebGL2RenderingContext });
  /** Resolves once the program runs; rejects where it cannot. */
  readonly ready: Promise<void>;
  readonly pictures: Picture[];
  readonly loaded: boolean;
  readonly atRest: boolean;
  readonly connected: boolean;
  /** A frozen folder answers: it has one light, and nothing in it moves. */
  readonly frozen: boolean;
  readonly usable: boolean;
  readonly scene: SceneInfo | null;
  /** Draws one to four views. True if there are pictures. */
  update(views: View[]): boolean;
  /** The point that a picture shows at a place (0 to 1, right and down), m; null: nothing. Waits for the graphics card. */
  pointAt(view: number, x: number, y: number): [number, number, number] | null;
  setSun(azimuthDegrees?: number, elevationDegrees?: number): void;
  play(playing: boolean): void;
  noteGpuMs(ms: number): void;
  stats(): Record<string, unknown>;
  addEventListener(type: MirageEvent, listener: (event: CustomEvent<{ text: string }>) => void, options?: boolean | AddEventListenerOptions): void;
  contextLost(): void;
  contextRestored(): void;
  dispose(): void;
}
