/**
 * `<reprise-player>`: plays an actor and takes it to any pose of its capture.
 *
 * Frames are counted over the whole capture, from 0; `info.sequences` tells where each sequence begins. Times are in
 * seconds, lengths in metres (+Y up, the ground is XZ), angles in radians.
 *
 * Attributes: `src`, `poster`, `alt`, `loading`, `controls`, `autoplay`, `loop`, `tint`, `parts`, `theme`, `speed`, `quickness`, `variety`, `camera`,
 * `originals`, `tool`; each has the property below. Slots: `bar`, `poster`, `progress`, `error`. Parts for styling: `player`, `bar`,
 * `tools`, `stage`, `score`, `dock`, `transport`, `walk`, `facts`, `legend`, `error`. Custom properties: `--reprise-accent`,
 * `--reprise-background`, `--reprise-font`.
 */
export class ReprisePlayer extends HTMLElement {
  /** Address of a `.reprise` file. Setting it loads that file. */
  src: string;
  /** Address of a picture that is shown until the first pose is drawn. */
  poster: string;
  /** What the actor is, for those who do not see it; else its name is told. */
  alt: string;
  /** `lazy` waits with loading until the element is about to be seen. */
  loading: 'eager' | 'lazy';
  /** Whether the tools, the score, the transport and the chips are shown. Off by default, as with `<video>`. */
  controls: boolean;
  /** Whether playing begins with the first pose; not where the user prefers reduced motion. */
  autoplay: boolean;
  /** Whether a sequence that has ended begins again. */
  loop: boolean;
  /** Whether the actor is tinted green where recorded and red where synthetic. */
  tint: boolean;
  /** Whether the parts of the body have their colours, with their names beside them, where the actor has parts. */
  parts: boolean;
  /** `null` follows the page's `prefers-color-scheme`. */
  theme: 'light' | 'dark' | null;
  /** 1 is the capture's own speed. */
  speed: number;
  /** What a frame costs when ways are planned, from 0.01 (smooth) to 0.2 (quick); null: as the actor was packed. */
  quickness: number | null;
  /** How much recorded stretches vary where the actor has alternatives: 0 is as recorded, 1 (the default) as they were made. */
  variety: number;
  /**
   * The first view, and the one that a double click goes back to: `45deg 10deg 1.5` is the angle about the actor, the
   * angle above the ground, and the distance, 1 being that from which all of the actor is seen.
   */
  camera: string;
  /**
   * Addresses of the textures as captured, such as `textures/%05d.webp`: `%d` is the frame, counted over the whole capture.
   * They are fetched when *original* is chosen to compare with what is rebuilt.
   */
  originals: string;
  /** The tool in use. */
  tool: Tool;

  /** What the bundle holds; `null` until `ready`. */
  readonly info: ActorInfo | null;
  /** What the actor does now; `null` until `ready`. */
  readonly state: PlayerState | null;
  /** Whether all of the bundle has arrived. */
  readonly complete: boolean;
  readonly playing: boolean;
  /** Names of all behaviours: the sequences' labels, and the sequences without one. */
  readonly behaviours: string[];
  /**
   * Families of sequences that do the same, such as walks and runs of all speeds, each with what is performed of it now.
   * `goTo({ behaviour: 'gait@1.4' })` goes to the member nearest to 1.4.
   */
  readonly families: (Family & { value: number | null })[];
  /** The parts of the body with the colours that `parts` shows them in; none until `load`, or where the actor has none. */
  readonly bodyParts: { name: string; colour: string }[];
  /** Targets that wait for their turn. */
  readonly queued: (Target | Held)[];
  /**
   * What is asked with the tool in use, or null. Setting it takes the tool that shows it and searches, without leaving; it
   * takes what links and files hold, too. Set to null, nothing is asked with the tool in use any more; a walk under way goes on.
   * Throws a `PlayerError` with a sentence.
   */
  get direction(): Request | null;
  set direction(request: Request | Shared | null | undefined);
  /** The edits of recorded frames; null where there are none. What is wrong with a document that is set is said on the page. */
  get edits(): EditDocument | null;
  set edits(document: EditDocument | null | undefined);
  /** Adds an edit; resolves once all frames are as it has them. What cannot be met is told in the notes. */
  edit(edit: Edit): Promise<{ notes: string[] }>;
  /**
   * The actor performs a clip of motion capture, blended in from where it is, then goes on in what was recorded. A clip is a .bvh
   * file, or an .asf and an .amc; text is that of a .bvh. One that is performed is performed to its end before. Resolves once the
   * actor performs; rejects with a `PlayerError` whose sentence is said on the page, too.
   */
  drive(files: File | File[] | string, options?: { name?: string }): Promise<{ name: string; frames: number; notes: string[] }>;
  /** The best answer of the tool in use so far. */
  readonly answer: Answer | null;
  /** The direction as the part of an address behind `#`. */
  readonly link: string;

  play(): void;
  pause(): void;
  /** Jumps to a frame, fractions allowed, and drops the target. */
  seek(frame: number): void;
  /** The cheapest walk from the present to a target, without leaving. Throws a `PlayerError`, also if there is none. */
  plan(target: Target): Walk;
  /** Leaves for a target at once; during a walk this changes its mind. Throws as `plan` does. */
  goTo(target: Target): Walk;
  /** Places, paths and behaviours that are held have to be searched for: leaves once there is a walk, and tells how well it does. */
  goTo(target: GroundTarget | Held | MemberTarget): Promise<Answer>;
  /** Does what a request asks: leaves once there is a walk. `anywhere`: begins where suits it best, instead of here. */
  direct(request: Request, options?: { anywhere?: boolean }): Promise<Answer>;
  /** Goes wherever it likes, for ever. Weights: how often behaviours are to be seen, 1 being as often as others. */
  wander(options?: { seed?: number; weights?: Record<string, number> }): Promise<Answer>;
  /** Goes to a behaviour and holds it for so many seconds (10 by default), in a loop where there is one. */
  hold(behaviour: string, seconds?: number): Promise<Answer>;
  /** Goes to these targets, one after the other, after those that wait already. Throws where one is no target. */
  queue(...targets: (Target | Held | MemberTarget)[]): void;
  /** Stops on the way, a transition under way is finished first; drops the queue. */
  cancel(): void;
  /** What is on the stage as pixels; with a frame, that pose alone on a transparent background. */
  snapshot(options?: PictureOptions): Promise<ImageData>;
  /** The same as an encoded picture. */
  toBlob(options?: PictureOptions & { type?: string; quality?: number }): Promise<Blob>;
  /** Back to the first view. */
  recentre(): void;
  /**
   * Asks for the direction that an address carries behind `#`. What is wrong with it is said on the page.
   * Tells whether there was one that could be used.
   */
  openLink(address: string): boolean;
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

export type Tool = 'pose' | 'place' | 'path' | 'timing' | 'wander' | 'edit';

/** A frame; a pose by its sequence and the time within it; or the frame of a behaviour that is nearest. */
export type Target = number | { frame: number } | { sequence: string; seconds?: number } | { behaviour: string };

/** The member of a family that is nearest to a value of its parameter, by the family's name or what one of its members shows. */
export type MemberTarget = { behaviour: `${string}@${number}` };

/** Sequences that do the same, by a number. */
export interface Family {
  name: string;
  /** What members are asked by: `speed`, `turn`, `height` or `length`, and its unit. */
  parameter: string;
  unit: string;
  members: {
    /** The name of its sequence. */
    sequence: string;
    /** First and last frame, counted over the whole capture. */
    frames: [number, number];
    /** The parameter, measured. */
    value: number;
  }[];
}

/** A behaviour that is gone to and held for so many seconds, in a loop where there is one. */
export type Held = { behaviour: string; hold: number };

export interface PictureOptions {
  frame?: number;
  /** Pixels, for a picture of a frame; 512 by default, 1024 at most. */
  width?: number;
  height?: number;
}

/**
 * A place on the ground, which way to face there, and the pose to end in; or a path that a spline goes through, of points all (x, z) or all
 * (x, y, z). It is followed by the middle of the body, or by that of some vertices, such as a hand's.
 */
export type GroundTarget =
  | { x: number; z: number; heading?: number | null; pose?: FrameRef; exactness?: number }
  | { path: number[][]; stretches?: Stretch[]; shape?: 'spline' | 'polyline'; vertices?: number[]; exactness?: number };

/** A part of a path that demands a behaviour. Ends are counted in points: 1.5 is between the second and the third. */
export interface Stretch {
  from: number;
  to: number;
  behaviour: string;
}

export type FrameRef = number | { sequence: string; frame?: number; time?: number };

/** What the actor shall do: the JSON of docs/directing.md, which the command line reads, too. */
export interface Request {
  version: 1;
  /** Of what is random. */
  seed?: number;
  /** What a frame costs, from 0.01 for smooth ways to 0.2 for quick ones; as the actor was packed, where not given. */
  quickness?: number;
  target: RequestTarget | { queue: RequestTarget[] };
}

export type RequestTarget =
  | { pose: FrameRef }
  | { behaviour: { name: string; hold?: number } }
  /** `exactness`, from 0 to 1 (the default), is how far the walk is bent onto its place or path. */
  /** `pose` is what the walk ends in there. */
  | { place: { x: number; z: number; heading?: number; pose?: FrameRef; realism?: number; exactness?: number } }
  | {
      path: {
        /** All [x, z], or all [x, y, z]. */
        points: number[][];
        shape?: 'spline' | 'polyline';
        stretches?: Stretch[];
        /** Whether the actor may begin with any pose, on the path's first point. */
        free_start?: boolean;
        /** Vertices whose mean follows the path, in place of the body's middle. */
        vertices?: number[];
        realism?: number;
        exactness?: number;
      };
    }
  | { keys: { poses: { pose: FrameRef; time: number }[] } }
  | { wander: { seconds: number; weights?: Record<string, number> } };

/** Edits of recorded frames: the JSON of docs/editing.md, which the command line reads, too. */
export interface EditDocument {
  version: 1;
  edits: Edit[];
}

/** Points of the surface that are put elsewhere in a recorded frame; the frames around follow. */
export interface Edit {
  sequence: string;
  /** Counted within the sequence. */
  frame: number;
  /** The frames before and after at which the edit has faded to nothing; a quarter of a second to both sides by default. */
  window?: [number, number];
  /** Vertices of the mesh, and where each goes: metres, as the frame was recorded. */
  handles: { vertex: number; to: [number, number, number] }[];
  /** What stays; feet that stand by default. */
  pins?: 'contacts' | 'none' | number[];
  scope?: 'body' | 'limb' | { radius: number };
  method?: 'rig' | 'learned' | 'parts' | 'arap' | 'laplace';
  propagate?: 'nonlinear' | 'linear' | 'constraint';
  on?: boolean;
}

/** What links and files hold: a request, where its answer began, and edits. */
export interface Shared {
  request?: Request;
  edits?: EditDocument;
  start?: { frame: number; placement: [number, number, number] };
  answer?: Answer;
}

/** The best walk that a search has found so far, and how well it does what was asked. */
export interface Answer {
  seconds: number;
  frames: number;
  transitions: number;
  /** `proven`: there is no better walk. `ended`: the search has ended without knowing that. */
  progress: 'running' | 'ended' | 'proven';
  /** Sentences where it does not do what was asked. */
  notes: string[];
  /** The frame that it begins with, and its heading, x and z. */
  start: { frame: number; placement: [number, number, number] };
  legs: Leg[];
  /** Where it leads on the ground (x, z), leg by leg. */
  track: { synthetic: boolean; points: [number, number][] }[];
  /** Metres off the place, radians off the heading; the frame that it ends in, where a pose is wanted. */
  place?: { distance: number; turn: number | null; frame?: number };
  /** Metres; `mean` and `max` against the path's point of equal length, `...Aside` against its nearest. */
  path?: {
    length: number;
    travelled: number;
    mean: number;
    max: number;
    meanAside: number;
    maxAside: number;
    /** The part of the painted frames that shows what is demanded. */
    demandsKept: number | null;
    /** Metres travelled, x, y, z. */
    samples: [number, number, number, number][];
  };
  /** Seconds; `null` where a key pose is not reached. */
  keys?: { frame: number; wanted: number; reached: number | null }[];
  /** Frames that are visited, and how far from what is wanted the spread of the poses is (Prada 2016, section 7.1). */
  wander?: { frames: number; objective: number; objectives: [number, number, number] };
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
  /** Families of them; none before that part of the file has arrived. */
  families: Family[];
  /** Names of all behaviours: the labels, then the sequences whose name is no label. */
  behaviours: string[];
  images: { media_type: string; width: number; height: number; ready: boolean }[];
  /** Eigen textures and Eigen warps that the texture is rebuilt from; `null` where it does not change or is still to come. */
  appearance: [number, number] | null;
  /** Modes of textures that were not aligned, to compare with; `null` where the file holds none or they are still to come. */
  naive: number | null;
  /** Frames that can be shown as they were scanned (`builder pack --mode windows`); 0 where there are none. */
  scanned: number;
  /** Whether the actor has alternatives of what was recorded (`variety`). */
  varies: boolean;
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
  /** The alternative of the recorded stretch that most is shown of, from 1; none where it is as recorded. */
  alternative?: number;
  /** Where there are scanned frames: whether the last picture showed one, one that an edit has changed or those of a transition's ends, carried
   * by the mesh that all of them were brought onto, or that mesh. */
  shown?: 'scan' | 'carried' | 'template';
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
  /** All of the bundle has arrived, and the script of the tools where they are wanted. */
  load: CustomEvent<{ info: ActorInfo }>;
  /** The page shows a sentence too. */
  error: CustomEvent<{ kind: ErrorKind; message: string }>;
  transitionstart: CustomEvent<{ from: number; to: number }>;
  transitionend: CustomEvent<{ from: number; to: number }>;
  /** The actor stands in the pose it was sent to. */
  arrive: CustomEvent<{ frame: number }>;
  /** The picture shows another moment: at most once a display frame. */
  frame: CustomEvent<{ frame: number; mode: PlayerState['mode']; x: number; z: number; heading: number }>;
  /** Another tool is in use. */
  toolchange: CustomEvent<{ tool: Tool }>;
  /** What is asked has changed, by the user, by undoing, or by a page. */
  change: CustomEvent<{ tool: Tool }>;
  /** Recorded frames are edited otherwise than before; they are made in the next display frames. */
  editchange: CustomEvent<{ edits: EditDocument }>;
  /** The actor begins to perform a clip of motion capture of so many frames. */
  drivestart: CustomEvent<{ name: string; frames: number; apart: [[number, number], [number, number]] }>;
  /** It is back in what was recorded, in this frame, or was sent elsewhere. */
  driveend: CustomEvent<{ name: string; frame: number }>;
  /** The search has found a walk, or a better one. */
  answer: CustomEvent<{ answer: Answer }>;
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
