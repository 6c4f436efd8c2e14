/**
 * `<reprise-player>`: plays an actor and takes it to any pose of its capture.
 *
 * Frames are counted over the whole capture, from 0; `info.sequences` tells where each sequence begins. Times are in
 * seconds, lengths in metres (+Y up, the ground is XZ), angles in radians.
 *
 * Attributes: `src`, `poster`, `controls`, `autoplay`, `loop`, `tint`, `theme`, `speed`; each has the property below.
 * Parts for styling: `player`, `stage`, `score`, `transport`, `walk`, `facts`, `error`. Custom properties:
 * `--reprise-accent`, `--reprise-background`, `--reprise-font`.
 */
export class ReprisePlayer extends HTMLElement {
  /** Address of a `.reprise` file. Setting it loads that file. */
  src: string;
  /** Address of a picture that is shown until the first pose is drawn. */
  poster: string;
  /** Whether the score, the transport and the chips are shown. Off by default, as with `<video>`. */
  controls: boolean;
  /** Whether playing begins with the first pose; not where the user prefers reduced motion. */
  autoplay: boolean;
  /** Whether a sequence that has ended begins again. */
  loop: boolean;
  /** Whether the actor is tinted green where recorded and red where synthetic. */
  tint: boolean;
  /** `null` follows the page's `prefers-color-scheme`. */
  theme: 'light' | 'dark' | null;
  /** 1 is the capture's own speed. */
  speed: number;

  /** What the bundle holds; `null` until `ready`. */
  readonly info: ActorInfo | null;
  /** What the actor does now; `null` until `ready`. */
  readonly state: PlayerState | null;
  /** Whether all of the bundle has arrived. */
  readonly complete: boolean;
  readonly playing: boolean;

  play(): void;
  pause(): void;
  /** Jumps to a frame, fractions allowed, and drops the target. */
  seek(frame: number): void;
  /** The cheapest walk from the present to a frame, without leaving. Throws a `PlayerError`, also if there is none. */
  plan(frame: number): Walk;
  /** Leaves for a frame at once; during a walk this changes its mind. Throws as `plan` does. */
  goTo(frame: number): Walk;
  /** Stops on the way; a transition under way is finished first. */
  cancel(): void;
  /** The frame at a time of a sequence. */
  frameOf(sequence: string, seconds?: number): number;
  /** Loads `src` again. Trouble becomes an `error` event. */
  reload(): Promise<void>;
  /** Does what a key does, for pages that hand all their keys to the player. Tells whether the key was used. */
  pressKey(event: KeyboardEvent): boolean;

  addEventListener<K extends keyof ReprisePlayerEventMap>(
    type: K,
    listener: (this: ReprisePlayer, event: ReprisePlayerEventMap[K]) => unknown,
    options?: boolean | AddEventListenerOptions,
  ): void;
  addEventListener<K extends keyof HTMLElementEventMap>(
    type: Exclude<K, keyof ReprisePlayerEventMap>,
    listener: (this: ReprisePlayer, event: HTMLElementEventMap[K]) => unknown,
    options?: boolean | AddEventListenerOptions,
  ): void;
  removeEventListener<K extends keyof ReprisePlayerEventMap>(
    type: K,
    listener: (this: ReprisePlayer, event: ReprisePlayerEventMap[K]) => unknown,
    options?: boolean | EventListenerOptions,
  ): void;
  removeEventListener<K extends keyof HTMLElementEventMap>(
    type: Exclude<K, keyof ReprisePlayerEventMap>,
    listener: (this: ReprisePlayer, event: HTMLElementEventMap[K]) => unknown,
    options?: boolean | EventListenerOptions,
  ): void;
}

export interface ActorInfo {
  name: string;
  fps: number;
  frames: number;
  /** Vertices and triangles of the welded surface. */
  vertices: number;
  triangles: number;
  /** Edges of the essential graph, consecutive frames not counted. */
  transitions: number;
  /** Edges kept, as a part of all pairs of frames. */
  density: number;
  /** Cost of one frame of duration. */
  alpha: number;
  sequences: { name: string; first: number; count: number; cyclic: boolean; labels: string[] }[];
  images: { media_type: string; width: number; height: number; ready: boolean }[];
  /** Eigen textures and Eigen warps that the texture is rebuilt from; `null` where it does not change or is still to come. */
  appearance: [number, number] | null;
  /** Frames in the largest strongly connected component: all of them reach each other. */
  main: number;
}

export type Leg =
  /** `back`: along the recording backwards, out of a dead end. */
  | { kind: 'recorded'; first: number; last: number; steps: number; back: boolean }
  | { kind: 'synthetic'; from: number; to: number; frames: number; deformation: number; edge: number };

export interface Walk {
  to: number;
  /** The sum of D + alpha L. */
  cost: number;
  /** The sum of D. */
  deformation: number;
  frames: number;
  seconds: number;
  transitions: number;
  legs: Leg[];
}

export interface PlayerState {
  /** With fractions; during a transition the nearer of its source and destination. */
  frame: number;
  mode: 'paused' | 'recorded' | 'synthetic';
  target: number | null;
  walk: Leg[] | null;
  /** Which leg is under way, and how much of it is done, from 0 to 1. */
  leg: number;
  leg_progress: number;
  remaining_seconds: number;
  transition: { from: number; to: number; lambda: number; source: number; destination: number } | null;
  /** Where the actor stands, and which way it faces. */
  x: number;
  z: number;
  heading: number;
  /** Median time to make a synthetic frame, in milliseconds. */
  synthesis_ms: number;
}

/** What an `error` event, or an error that a method throws, is about. */
export type ErrorKind =
  | 'no-webgpu'
  | 'insecure'
  | 'no-adapter'
  | 'device-lost'
  | 'bad-address'
  | 'not-found'
  | 'network'
  | 'not-reprise'
  | 'too-new'
  | 'damaged'
  | 'truncated'
  | 'engine'
  | 'internal'
  | 'unreachable'
  | 'not-loaded'
  | 'bad-argument';

export interface PlayerError extends Error {
  kind: ErrorKind;
}

export interface ReprisePlayerEventMap {
  /** Bytes of the bundle so far; `total` is 0 where the server does not say. */
  progress: CustomEvent<{ loaded: number; total: number }>;
  /** The first pose is drawn; the rest may still be on its way. */
  ready: CustomEvent<{ info: ActorInfo }>;
  /** All of the bundle has arrived. */
  load: CustomEvent<{ info: ActorInfo }>;
  /** The page shows a sentence too. */
  error: CustomEvent<{ kind: ErrorKind; message: string }>;
  transitionstart: CustomEvent<{ from: number; to: number }>;
  transitionend: CustomEvent<{ from: number; to: number }>;
  /** The actor stands in the pose it was sent to. */
  arrive: CustomEvent<{ frame: number }>;
  /** The actor waits for frames that have not arrived. */
  stall: CustomEvent<{ frame: number }>;
  /** A sequence has ended and does not loop. */
  end: CustomEvent<{ frame: number }>;
  /** The graphics device is gone; pose and target are kept. */
  devicelost: CustomEvent<Record<string, never>>;
  devicerestored: CustomEvent<Record<string, never>>;
}

declare global {
  interface HTMLElementTagNameMap {
    'reprise-player': ReprisePlayer;
  }
}
