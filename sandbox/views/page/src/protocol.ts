// Written by `python -m tools.page_types` from sandbox/server/protocol.py.

export const PROTOCOL = 4;
export const FRAME_KIND = 1;
export const POSE_BYTES = 28;
export const SKIN_KIND = 2;
export const DEMONSTRATION_KIND = 3;
export const LIFT_STRIP_PX = 90;
export const LIFT_NOTCH = 0.12;
export const LIFT_KEY = 0.05;
export const LIFT_PAGE = 0.2;
export const NOTCH_PX = 100;
export const GRAB_RADIUS = 0.01;
export const WHEEL_FACTOR = 1.03;
export const WHEEL_TURN = 0.0523599;
export const NARROWEST = 0.008;
export const WIDEST = 0.2;
/** Fingers of a right hand of one to five: label, and x and y (m) from its middle. */
export const HANDS: readonly (readonly [number, number, number])[][] = [[[1, 0.0000, 0.0000]], [[0, -0.0240, 0.0288], [1, 0.0240, -0.0288]], [[0, -0.0240, 0.0288], [1, 0.0167, -0.0349], [2, 0.0313, -0.0227]], [[0, -0.0240, 0.0288], [1, 0.0094, -0.0410], [2, 0.0240, -0.0288], [3, 0.0386, -0.0167]], [[0, -0.0240, 0.0288], [1, 0.0021, -0.0471], [2, 0.0167, -0.0349], [3, 0.0313, -0.0227], [4, 0.0459, -0.0106]]];

/** Size of the page's part for the table and the lift control: CSS pixels per inch, and pixels. It is the whole page, save on a phone, where words and buttons stand beside the table. The encoder needs inches; `calibrated` is true if the person has measured them. `fit` says why the table fills the page, whatever its inches: a `mouse`, for which size means nothing, or a `phone`, which is too small for a hand; it is empty for a table of true size. */
export interface PageScreen {
  px_per_in: number;
  width_px: number;
  height_px: number;
  calibrated: boolean;
  fit?: "" | "mouse" | "phone";
}

/** The page's first message. `client` is the page's random name, which a reload keeps; `language` that of its words, by ISO 639-1. */
export interface Hello {
  type: "hello";
  protocol: number;
  client: string;
  role: "player" | "spectator";
  screen: PageScreen;
  language?: string;
}

/** The page's size or calibration has changed. */
export interface Resized {
  type: "resized";
  screen: PageScreen;
}

/** Whether the page can be played: not while it is hidden, as behind another tab or in sleep, or while its screen is turned away from the way the table was laid for. */
export interface Presence {
  type: "presence";
  here: boolean;
}

/** All contacts of the page at one moment. `contacts` holds id, x, y, width and height in CSS pixels, x right and y down from the touch rectangle's top left corner, width and height at most 1 where they are unknown; `cancelled` the ids that the system cancelled since the last message; `lift` the lift control, 0 to 1, if the page shows one; `labels` id and label of fingers that keys put down, with a mouse. `seq` counts up from 1, `t` is the page's clock. */
export interface PageTouches {
  type: "touches";
  seq: number;
  t: number;
  contacts: ([number, number, number, number, number])[];
  cancelled?: (number)[];
  lift?: number | null;
  labels?: ([number, number])[];
}

/** A hand that a headset sees: positions (m) of WebXR's 25 joints in the world, in its order; null for one that is not known. */
export interface SeenJoints {
  side: "left" | "right";
  joints: ([number, number, number] | null)[];
}

/** A controller in a hand: its grip's position (m) and quaternion (w, x, y, z) in the world, and how far its trigger is pulled. */
export interface HeldController {
  side: "left" | "right";
  position: [number, number, number];
  quaternion: [number, number, number, number];
  trigger: number;
}

/** All hands that a headset's page sees at one moment. `seq` counts up from 1, `t` is the page's clock. */
export interface PageHands {
  type: "hands";
  seq: number;
  t: number;
  hands: (SeenJoints)[];
  controllers?: (HeldController)[];
}

/** Acknowledges a frame and returns its credit. Sent at once, before the frame is drawn. */
export interface Got {
  type: "got";
  frame: number;
}

/** Reports that a frame was drawn, `after_ms` after the touch event that is visible in it. */
export interface Drawn {
  type: "drawn";
  frame: number;
  after_ms: number;
}

/** Heartbeat of the page, answered by an echo; `round_trip_ms` is that of the last echo. */
export interface Beat {
  type: "beat";
  t: number;
  round_trip_ms?: number | null;
}

/** Request of the player: try again, another task, the other hand, sets of fingers as in the settings, pause or resume, or a demonstration; or of a page that waits: the player's seat. */
export interface PlayerRequest {
  type: "ask";
  what: "demo" | "fingers" | "hand" | "pause" | "resume" | "retry" | "seat" | "task";
  value?: string;
}

/** A participant's answer to an item of a study's sheet; null removes it. */
export interface ItemAnswer {
  type: "answer";
  sheet: number;
  item: string;
  value: string | number | null;
}

/** A participant has finished a study's sheet, or answers yes or no to it. */
export interface Leave {
  type: "leave";
  sheet: number;
  how: "done" | "no" | "yes";
}

/** A sentence for the person: its key and values, which every language has words for. `text` is the sentence in English, for clients without words of their own, and for sentences without a key, such as those of other people's tasks. */
export interface Localised {
  key: string;
  values: Record<string, string | (string)[]>;
  text: string;
}

/** A task to choose: its name, its summary in a line, and whether it needs a lift control. The page calls built-in tasks by its own words; `summary` is in English. */
export interface TaskName {
  name: string;
  summary: string;
  lift: boolean;
}

/** A page in a study, in the participant's language, with the design's own words by key. `shows` lists what a trial shows: task, goal, time, progress, fingers, sound, hint and result. */
export interface StudyView {
  language: string;
  words: Record<string, string>;
  shows: (string)[];
}

/** The server's first message: the role of the page, and the tasks from easiest to hardest. In a study there are no menus. `touch` is true if the player's touches drive a hand; otherwise another device does, and all pages are spectators. */
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

/** A shape on a body: MuJoCo's type and sizes, position (m) and quaternion (w, x, y, z). */
export interface Geom {
  body: number;
  kind: "box" | "capsule" | "cylinder" | "ellipsoid" | "plane" | "sphere";
  size: [number, number, number];
  position: [number, number, number];
  quaternion: [number, number, number, number];
  rgba: [number, number, number, number];
  part: "hand" | "object" | "scenery";
}

/** The touch rectangle: size in inches, corner (m) and axes (row by row) in the world. `scale` is the length on the screen of what is one long in the world. */
export interface SurfaceView {
  width_in: number;
  height_in: number;
  origin: [number, number, number];
  rotation: [number, number, number, number, number, number, number, number, number];
  calibrated: boolean;
  scale?: number;
}

/** A new scene. Frames with another `scene` number belong to an earlier one. `bodies` names the rows of a frame's poses. `lift` is the height (m) to which a lift control of 1 raises the hand; 0 if the task has none. `size` of a geom is as in MuJoCo: half lengths and radii. `in_air` is true if hands move over a 3-D device, without touches. `goal` is in English; in a study, `task` and `goal` are what the participant reads, and `how`, if the design shows hints, how it is done. `scored` is false if the result does not count. `fingers` is the least number of different fingers with which the task can be played. `finger_sets` has the sets of fingers that the player uses, as in the settings; null if they cannot be chosen. */
export interface SceneMessage {
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
  caption: Localised | null;
  in_air?: boolean;
  scored?: boolean;
  how?: string;
  fingers?: number;
  finger_sets?: string | null;
}

/** A problem that prevents a scene, and its remedy, sentence by sentence. */
export interface Trouble {
  type: "trouble";
  told: (Localised)[];
}

/** One of several answers: its stored value, and the label that the person reads. */
export interface Choice {
  value: string;
  label: string;
}

/** A question in the participant's language; `low_means` and `high_means` label a scale. */
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

/** A sheet that a study's participant sees instead of the scene; `none` shows the scene. `answers` has earlier answers by item. A `rest` can be left after `seconds`. `note` says whose wording the questions of a form have, where it is not the published one, and of a `task` which trial of how many it is; `picture` is a data URL with its picture. At `measure`, the size of the screen is measured. */
export interface Sheet {
  type: "sheet";
  sheet: number;
  kind: "consent" | "end" | "form" | "measure" | "none" | "rest" | "task" | "text" | "wait";
  title: string;
  text: string;
  items: (ItemView)[];
  answers: Record<string, string | number | null>;
  seconds: number;
  note?: string;
  picture?: string;
}

/** Refusal of an answer, with the reason; with an empty item, of the whole sheet. */
export interface Refusal {
  type: "refusal";
  sheet: number;
  item: string;
  text: string;
}

/** Who may play: to a page that waits, `wait_s` is in how many seconds it plays if the player stays away, null while the player is there; to the player, `requested` is true while another page requests the seat. */
export interface Seat {
  type: "seat";
  wait_s?: number | null;
  requested?: boolean;
}

/** Answers a beat with its time. */
export interface Echo {
  type: "echo";
  t: number;
}

/** A contact in the session. `position` (m) in the world is for fingers that are not on this screen; `force` (N) is that of its fingertip on objects, `stored` (N) the part of it that other fingers press back, which is let go when the grip opens. `full` is true if the hand has no more force for it. A `palm` is no finger. `sure` is false if the label may well be wrong; `inside` is true if the finger is inside an object, out of which it has to be moved. */
export interface ContactState {
  id: number;
  label: number | null;
  state: "active" | "ignored" | "lost" | "palm";
  force: number;
  position: [number, number, number];
  sure: boolean;
  inside: boolean;
  stored?: number;
  full?: boolean;
}

/** A hand: phase of its arrival, solid fingers, contacts, probability of the labels. */
export interface HandState {
  phase: string;
  solid: (number)[];
  contacts: (ContactState)[];
  probability: number;
}

/** Current goal of an object: position (m) and turn about the vertical (rad). */
export interface GoalState {
  object: string;
  position: [number, number, number];
  yaw: number;
}

/** Values of a frame besides poses, at its end. `reason` says what is missing, and `notices` what the person has to know. `pause` says why simulated time stands still, and is empty while it runs. `start`: it begins with the first touch; `menu`: a menu is open; `away`: a player's page is closed, hidden or lost; `back`: the player is back, and time goes on with the next touch. */
export interface State {
  time: number;
  status: string;
  progress: number;
  reason: Localised | null;
  reached: boolean;
  held: boolean;
  hands: (HandState)[];
  goals: (GoalState)[];
  notices: (Localised)[];
  pause: "" | "away" | "back" | "menu" | "start";
}

export type Up = Hello | Resized | Presence | PageTouches | PageHands | Got | Drawn | Beat | PlayerRequest | ItemAnswer | Leave;

export type Down = Welcome | SceneMessage | Trouble | Sheet | Refusal | Seat | Echo;
