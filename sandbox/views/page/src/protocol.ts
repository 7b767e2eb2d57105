// Written by `python -m tools.page_types` from sandbox/server/protocol/protocol.py.

export const PROTOCOL = 2;
export const FRAME_KIND = 1;
export const POSE_BYTES = 28;
export const SKIN_KIND = 2;

/** How large the page is: CSS pixels per inch, and pixels. The inches are what the encoder needs; `calibrated` says whether somebody measured them. */
export interface Screen {
  px_per_in: number;
  width_px: number;
  height_px: number;
  calibrated: boolean;
}

/** The page's first message. `client` is the page's own random name, kept when it reloads. */
export interface Hello {
  type: "hello";
  protocol: number;
  client: string;
  role: "player" | "spectator";
  screen: Screen;
}

/** The page's size or calibration has changed. */
export interface Resized {
  type: "resized";
  screen: Screen;
}

/** All contacts of the page at one moment. `contacts` holds id, x, y and width in CSS pixels, x right and y down from the touch rectangle's top left corner; `cancelled` the ids that the system took away since the last message; `lift` the lift control, where the page shows one. `seq` counts up from 1, `t` is the page's clock. */
export interface Touches {
  type: "touches";
  seq: number;
  t: number;
  contacts: ([number, number, number, number])[];
  cancelled?: (number)[];
  lift?: number | null;
}

/** A frame has arrived; gives its credit back. Sent at once, before anything is drawn. */
export interface Got {
  type: "got";
  frame: number;
}

/** A frame has been drawn, `after_ms` after the touch event that it answers had happened. */
export interface Drawn {
  type: "drawn";
  frame: number;
  after_ms: number;
}

/** Says that the page lives, and asks for an echo; `round_trip_ms` is the last echo's. */
export interface Beat {
  type: "beat";
  t: number;
  round_trip_ms?: number | null;
}

/** The person wants something: try again, another task, the other hand, or a stop of time. */
export interface Ask {
  type: "ask";
  what: "hand" | "pause" | "resume" | "retry" | "task";
  value?: string;
}

/** What somebody has filled in for an item of a study's sheet; null takes it back. */
export interface Answer {
  type: "answer";
  sheet: number;
  item: string;
  value: string | number | null;
}

/** Somebody is through with a study's sheet, or says yes or no to it. */
export interface Leave {
  type: "leave";
  sheet: number;
  how: "done" | "no" | "yes";
}

/** A task that can be chosen: its name, one line about it, whether it needs a lift control. */
export interface TaskName {
  name: string;
  summary: string;
  lift: boolean;
}

/** A page in a study: its words by what they are for, in the participant's language, and which of task, goal, time, progress, fingers and sound a trial shows. */
export interface StudyView {
  language: string;
  words: Record<string, string>;
  shows: (string)[];
}

/** The server's first message: what the page is (a player or a spectator), and what there is. In a study there are no menus. `touch`: the player's fingers on the page are a hand's; else something else plays, and every page only looks. */
export interface Welcome {
  type: "welcome";
  protocol: number;
  version: string;
  role: "player" | "spectator";
  tasks: (TaskName)[];
  credit: number;
  study?: StudyView | null;
  touch?: boolean;
}

/** A shape on a body: MuJoCo's type and sizes, place (m) and turn (w, x, y, z) on the body. */
export interface Geom {
  body: number;
  kind: "box" | "capsule" | "cylinder" | "ellipsoid" | "plane" | "sphere";
  size: [number, number, number];
  position: [number, number, number];
  quaternion: [number, number, number, number];
  rgba: [number, number, number, number];
  part: "hand" | "object" | "scenery";
}

/** The touch rectangle: size in inches, corner (m) and axes (row by row) in the world. */
export interface SurfaceView {
  width_in: number;
  height_in: number;
  origin: [number, number, number];
  rotation: [number, number, number, number, number, number, number, number, number];
  calibrated: boolean;
}

/** A new scene. Frames of another `scene` number belong to one that is over. `bodies` names the rows of a frame's poses. `lift` is how far the hand rises at a lift control of 1, m; 0: the task has none. `size` of a geom is as in MuJoCo: half lengths and radii. `in_air`: hands move over a 3-D device, and nobody touches the page. */
export interface Scene {
  type: "scene";
  scene: number;
  task: string;
  goal: string;
  seed: number;
  hand: "left" | "right";
  lift: number;
  time_limit: number;
  surface: SurfaceView;
  bodies: (string)[];
  geoms: (Geom)[];
  caption: string;
  in_air?: boolean;
}

/** Something that the person has to know before there is a scene, and what to do about it. */
export interface Trouble {
  type: "trouble";
  text: string;
}

/** One of several answers: as it is kept, and as it is read. */
export interface Choice {
  value: string;
  label: string;
}

/** A question in the participant's language; `low_means` and `high_means` are a scale's ends. */
export interface ItemView {
  name: string;
  kind: "choice" | "number" | "scale" | "text";
  ask: string;
  optional: boolean;
  choices: (Choice)[];
  low: number;
  high: number;
  step: number;
  low_means: string;
  high_means: string;
}

/** What a study's participant has before them instead of the scene; `none` shows the scene. `answers` is what was filled in before, by item. A `rest` can be left after `seconds`. */
export interface Sheet {
  type: "sheet";
  sheet: number;
  kind: "consent" | "end" | "form" | "none" | "rest" | "text" | "wait";
  title: string;
  text: string;
  items: (ItemView)[];
  answers: Record<string, string | number | null>;
  seconds: number;
}

/** An answer that is none, and why; without an item, the whole sheet. */
export interface Refusal {
  type: "refusal";
  sheet: number;
  item: string;
  text: string;
}

/** Answers a beat with its time. */
export interface Echo {
  type: "echo";
  t: number;
}

/** A contact as the session knows it: place (m) in the world, for those whose fingers are not on this screen; `force` (N) is what its fingertip presses things with. */
export interface ContactState {
  id: number;
  label: number | null;
  state: "active" | "ignored" | "lost";
  force: number;
  position: [number, number, number];
}

/** A hand: phase of its arrival, fingers that are solid, contacts, sureness of the labels. */
export interface HandState {
  phase: string;
  solid: (number)[];
  contacts: (ContactState)[];
  probability: number;
}

/** Where a thing should go now: position (m) and turn about the vertical (rad). */
export interface GoalState {
  object: string;
  position: [number, number, number];
  yaw: number;
}

/** What changes besides poses; the tail of a frame. */
export interface State {
  time: number;
  status: string;
  progress: number;
  reason: string;
  reached: boolean;
  held: boolean;
  hands: (HandState)[];
  goals: (GoalState)[];
  notice: string;
  paused: boolean;
}

export type Up = Hello | Resized | Touches | Got | Drawn | Beat | Ask | Answer | Leave;

export type Down = Welcome | Scene | Trouble | Sheet | Refusal | Echo;
