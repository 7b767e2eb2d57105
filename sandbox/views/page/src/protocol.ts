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

/** Size of the page's area for the table and the lift control: CSS pixels per inch, and width and height in CSS pixels. On a phone, text and buttons are beside this area; elsewhere it is the whole page. The encoder needs inches; `calibrated` is true if the person has measured them. `fit` is empty if the table has its true size. Otherwise the table is scaled to fill the page, because the input is a `mouse`, for which sizes do not matter, or the screen is a `phone`, which is too small for a hand. */
export interface PageScreen {
  px_per_in: number;
  width_px: number;
  height_px: number;
  calibrated: boolean;
  fit?: "" | "mouse" | "phone";
}

/** The page's first message. `client` is the page's random name, which does not change when the page is reloaded. `language` is the page's language, by ISO 639-1. */
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

/** Whether the page can be played. It cannot while it is hidden (behind another tab, or asleep), or while its screen is rotated relative to the orientation for which the table was placed. */
export interface Presence {
  type: "presence";
  here: boolean;
}

/** All contacts of the page at one moment. `contacts` has id, x, y, width and height of each contact, in CSS pixels, x right and y down from the touch rectangle's top left corner; unknown width and height are at most 1. `cancelled` has the ids that the system has cancelled since the last message. `lift` is the lift control, 0 to 1; null if the page shows none. `labels` has id and label of fingers that were put down by keys, with a mouse. `seq` counts up from 1, `t` is the page's clock. */
export interface PageTouches {
  type: "touches";
  seq: number;
  t: number;
  contacts: ([number, number, number, number, number])[];
  cancelled?: (number)[];
  lift?: number | null;
  labels?: ([number, number])[];
}

/** A hand that a headset sees: positions (m, world) of 25 joints in the order of WebXR; null for an unknown joint. */
export interface SeenJoints {
  side: "left" | "right";
  joints: ([number, number, number] | null)[];
}

/** A controller in a hand: position (m) and quaternion (w, x, y, z) of its grip in the world. `trigger` is how far the trigger is pulled, 0 to 1. */
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

/** Request of the player: try again, another task, the other hand, sets of fingers (written as in the settings), pause or resume, or a demonstration. Or request of a waiting page: the player's seat. */
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

/** A sentence for the person: `key` of its text, which exists in every language, and `values` for the text's placeholders. `text` is the sentence in English. It is for clients without texts, and for sentences without a key, such as those of users' tasks. */
export interface Localised {
  key: string;
  values: Record<string, string | (string)[]>;
  text: string;
}

/** A task to choose: its name, its summary in a line, and whether it needs a lift control. `summary` is in English; for built-in tasks, the page has texts in every language. */
export interface TaskName {
  name: string;
  summary: string;
  lift: boolean;
}

/** Settings of a page in a study: the participant's language, and the design's texts by key. `shows` lists the items that the page shows in a trial, of: task, goal, time, progress, fingers, sound, hint and result. */
export interface StudyView {
  language: string;
  words: Record<string, string>;
  shows: (string)[];
}

/** The server's first message: the role of the page, and the tasks from easiest to hardest. `study` is null outside a study; in a study, the page has no menus. `touch` is true if the player's touches drive a hand. If it is false, another device drives the hand, and all pages are spectators. */
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

/** The touch rectangle: size in inches, corner (m) and axes (row by row) in the world. `scale` is the length on the screen divided by the length in the world. */
export interface SurfaceView {
  width_in: number;
  height_in: number;
  origin: [number, number, number];
  rotation: [number, number, number, number, number, number, number, number, number];
  calibrated: boolean;
  scale?: number;
}

/** A new scene. Frames with another `scene` number belong to an earlier scene. `bodies` names the rows of a frame's poses. `lift` is the height (m) to which a lift control of 1 raises the hand; 0 if the task has no lift control. `size` of a geom is as in MuJoCo: half lengths and radii. `in_air` is true if hands are tracked in the air, without touches. `goal` is in English. In a study, `task` and `goal` are the design's texts for the participant, and `how` explains how to do the task, if the design shows hints. `scored` is false if the result does not count. `fingers` is the smallest number of different fingers with which the task can be played. `finger_sets` has the sets of fingers that the player uses, as in the settings; null if they cannot be chosen. `shared` is true if the page's touches move one of several hands. */
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
  shared?: boolean;
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

/** A sheet that a study's participant sees instead of the scene; `none` shows the scene. `answers` has earlier answers by item. A `rest` can be left after `seconds`. `note` of a form is the source of its questions' wording, if this is not the published one; `note` of a `task` is the number of the trial and the number of all trials. `picture` is a data URL with the picture of a task. At `measure`, the size of the screen is measured. */
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

/** Refusal of an answer, with the reason. If `item` is empty, the whole sheet is refused. */
export interface Refusal {
  type: "refusal";
  sheet: number;
  item: string;
  text: string;
}

/** Who may play. For a waiting page, `wait_s` is the number of seconds until it gets the seat if the player stays away; null while the player is present. For the player, `requested` is true while another page requests the seat. */
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

/** A contact in the session. `position` (m, world) is used for fingers that are not on this screen. `force` (N) is the force of the contact's fingertip on objects. `stored` (N) is the part of this force that opposing fingers balance: it is released when the grip opens. `full` is true if the force cannot increase, since a servo of the finger or of the palm is at its limit. A contact in the state `palm` is not a finger. `sure` is false if the label may well be wrong. `inside` is true if the finger is inside an object; it has to be moved out. */
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

/** Current goal of an object: position (m) and rotation about the vertical (rad). */
export interface GoalState {
  object: string;
  position: [number, number, number];
  yaw: number;
}

/** Values at the end of a frame, after the poses. `reason` is the reason why the goal is not reached. `notices` are messages for the person. `pause` is the reason why simulated time stands still; empty while it runs. `start`: time begins with the first touch. `menu`: a menu is open. `away`: a player's page is closed, hidden or lost. `back`: the player is back, and time continues with the next touch. */
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
