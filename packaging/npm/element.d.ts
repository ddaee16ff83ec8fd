/** <mirage-view src camera-controls auto-rotate poster alt camera-eye camera-target field-of-view sun paused token> */
export class MirageView extends HTMLElement {
  readonly loaded: boolean;
  readonly atRest: boolean;
  readonly camera: { eye: number[]; target: number[]; pivot: number[] } | null;
  setCamera(eye: number[], target: number[]): void;
  resetCamera(): void;
  stats(): Record<string, unknown>;
  addEventListener(type: 'load' | 'rest' | 'camera-change' | 'up' | 'down' | 'error',
    listener: (event: CustomEvent<{ text?: string }>) => void, options?: boolean | AddEventListenerOptions): void;
  addEventListener(type: string, listener: EventListenerOrEventListenerObject, options?: boolean | AddEventListenerOptions): void;
}

declare global {
  interface HTMLElementTagNameMap { 'mirage-view': MirageView; }
}
