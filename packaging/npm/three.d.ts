import type { Camera, Object3D, Object3DEventMap, Vector3, WebGLRenderer } from 'three';
import type { MirageClient, MirageOptions, SceneInfo } from './index.js';

interface MirageEvents extends Object3DEventMap {
  load: { text: string };
  rest: { text: string };
  'needs-render': { text: string };
  up: { text: string };
  down: { text: string };
  error: { text: string };
}

/** A Mirage scene among the objects of three.js; moved, turned and scaled evenly as any object. */
export class MirageScene extends Object3D<MirageEvents> {
  constructor(options: MirageOptions & {
    renderer: WebGLRenderer;
    /** The host's tone mapping changes Mirage's colours, too. Default false. */
    toneMapped?: boolean;
  });
  readonly client: MirageClient;
  readonly loaded: boolean;
  readonly atRest: boolean;
  readonly info: SceneInfo | null;
  /** Draws what one to four perspective cameras see, once before the frame's renders. True if there is a picture. */
  update(camera: Camera | Camera[]): boolean;
  /** The point of the world that the picture shows at a place (0 to 1, right and down); null: nothing. Waits for the graphics card. */
  pointAt(x: number, y: number): Vector3 | null;
  dispose(): void;
}
