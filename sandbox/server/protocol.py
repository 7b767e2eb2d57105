"""Messages between server and page. The page's TypeScript types are generated from this file.

From the page: JSON texts, one message each, tagged by `type`. To the page: JSON texts for events,
and binary frames for motion (see `sandbox.server.page_frames`). Every message is checked whole
against the types here; an invalid one is refused, counted, and changes nothing. `Allowance` limits
how many are accepted.
"""

from __future__ import annotations

from typing import Annotated, Literal

import msgspec
from msgspec import Meta, Struct

from models.errors import InputError
from models.frames import FINGERS

PROTOCOL = 4
"""Version of all messages; both sides send it first, and disconnect if it differs."""

LARGEST_MESSAGE = 8192
"""Bytes of the largest message from a page; 20 touches take about 700."""

CREDIT = 6
"""Largest number of unacknowledged frames on their way to a page. After a stall of the network a
page gets at most this many old frames; with three, a round trip of 30 ms would halve its rate."""

Measured = Annotated[float | None, Meta(extra={"page": "number"})]
"""A number that a screen or headset has measured, which our page knows; null for one that is no
number, which JSON does not have. A device judges it, so that a wrong one costs itself alone."""

Milliseconds = Annotated[float, Meta(ge=0, le=1e15)]
Count = Annotated[int, Meta(ge=0, le=2**53)]
Id = Annotated[int, Meta(ge=-(2**31), lt=2**53)]
Label = Annotated[int, Meta(ge=0, lt=len(FINGERS))]
Word = Annotated[str, Meta(max_length=64)]
LONGEST_ANSWER = 2000
"""Largest number of characters in a text answer."""
Given = Annotated[str, Meta(max_length=LONGEST_ANSWER)] | Annotated[float, Meta(ge=-1e9, le=1e9)]
"""An unchecked answer."""
Pause = Literal["", "start", "menu", "away", "back"]


LIFT_STRIP_PX = 90.0
"""CSS pixels beside the touch rectangle that the lift control takes in tasks that lift."""
LIFT_NOTCH, LIFT_KEY, LIFT_PAGE = 0.12, 0.05, 0.20
"""Shares of the lift control's way: of a notch of a mouse's wheel, of the keys up and down, and of
page up and page down."""
NOTCH_PX = 100.0
"""CSS pixels that browsers report for a notch."""


DEMONSTRATION_KIND = 3
"""Kind of a binary message with the frames of a demonstration (`sandbox.play.demonstration`); see
`sandbox.server.page_frames` for the others."""


class Allowance:
    """A token bucket: how many messages or connections are accepted.

    Args:
        rate: Long-term limit, per second.
        burst: Number allowed at once.
        now: s, time at the start.
    """

    def __init__(self, rate: float, burst: float, now: float) -> None:
        self._rate, self._burst = rate, burst
        self._left, self._at = burst, now

    def take(self, now: float) -> bool:
        """True if one more is allowed at a time in seconds."""
        self._left = min(self._burst, self._left + (now - self._at) * self._rate)
        self._at = now
        if self._left < 1.0:
            return False
        self._left -= 1.0
        return True


class PageScreen(Struct, forbid_unknown_fields=True, frozen=True):
    """Size of the page's part for the table and the lift control: CSS pixels per inch, and pixels.
    It is the whole page, save on a phone, where words and buttons stand beside the table.

    The encoder needs inches; `calibrated` is true if the person has measured them. `fit` says why
    the table fills the page, whatever its inches: a `mouse`, for which size means nothing, or a
    `phone`, which is too small for a hand; it is empty for a table of true size.
    """

    px_per_in: Annotated[float, Meta(ge=20, le=1000)]
    width_px: Annotated[float, Meta(ge=1, le=32768)]
    height_px: Annotated[float, Meta(ge=1, le=32768)]
    calibrated: bool
    fit: Literal["", "mouse", "phone"] = ""


class Hello(Struct, tag="hello", forbid_unknown_fields=True, frozen=True):
    """The page's first message. `client` is the page's random name, which a reload keeps;
    `language` that of its words, by ISO 639-1."""

    protocol: int
    client: Word
    role: Literal["player", "spectator"]
    screen: PageScreen
    language: Word = ""


class Resized(Struct, tag="resized", forbid_unknown_fields=True, frozen=True):
    """The page's size or calibration has changed."""

    screen: PageScreen


class Presence(Struct, tag="presence", forbid_unknown_fields=True, frozen=True):
    """Whether the page can be played: not while it is hidden, as behind another tab or in sleep,
    or while its screen is turned away from the way the table was laid for."""

    here: bool


class PageTouches(Struct, tag="touches", forbid_unknown_fields=True, frozen=True):
    """All contacts of the page at one moment.

    `contacts` holds id, x, y, width and height in CSS pixels, x right and y down from the touch
    rectangle's top left corner, width and height at most 1 where they are unknown; `cancelled` the
    ids that the system cancelled since the last message; `lift` the lift control, 0 to 1, if the
    page shows one; `labels` id and label of fingers that keys put down, with a mouse. `seq` counts
    up from 1, `t` is the page's clock.
    """

    seq: Count
    t: Measured
    contacts: list[tuple[Id, Measured, Measured, Measured, Measured]]
    cancelled: list[Id] = []
    lift: float | None = None
    labels: list[tuple[Id, Label]] = []


Vector = tuple[Measured, Measured, Measured]
JOINTS_OF_A_HAND = 25
"""WebXR's joints: the wrist, four of the thumb, and five of each finger, thumb to little finger."""

_EVERY_JOINT = Meta(min_length=JOINTS_OF_A_HAND, max_length=JOINTS_OF_A_HAND)


class SeenJoints(Struct, forbid_unknown_fields=True, frozen=True):
    """A hand that a headset sees: positions (m) of WebXR's 25 joints in the world, in its order;
    null for one that is not known."""

    side: Literal["right", "left"]
    joints: Annotated[list[Vector | None], _EVERY_JOINT]


class HeldController(Struct, forbid_unknown_fields=True, frozen=True):
    """A controller in a hand: its grip's position (m) and quaternion (w, x, y, z) in the world, and
    how far its trigger is pulled."""

    side: Literal["right", "left"]
    position: Vector
    quaternion: tuple[Measured, Measured, Measured, Measured]
    trigger: Measured


class PageHands(Struct, tag="hands", forbid_unknown_fields=True, frozen=True):
    """All hands that a headset's page sees at one moment. `seq` counts up from 1, `t` is the page's
    clock."""

    seq: Count
    t: Measured
    hands: list[SeenJoints]
    controllers: list[HeldController] = []


class Got(Struct, tag="got", forbid_unknown_fields=True, frozen=True):
    """Acknowledges a frame and returns its credit. Sent at once, before the frame is drawn."""

    frame: Count


class Drawn(Struct, tag="drawn", forbid_unknown_fields=True, frozen=True):
    """Reports that a frame was drawn, `after_ms` after the touch event that is visible in it."""

    frame: Count
    after_ms: Annotated[float, Meta(ge=0, le=60000)]


class Beat(Struct, tag="beat", forbid_unknown_fields=True, frozen=True):
    """Heartbeat of the page, answered by an echo; `round_trip_ms` is that of the last echo."""

    t: Milliseconds
    round_trip_ms: Annotated[float, Meta(ge=0, le=60000)] | None = None


class PlayerRequest(Struct, tag="ask", forbid_unknown_fields=True, frozen=True):
    """Request of the player: try again, another task, the other hand, sets of fingers as in the
    settings, pause or resume, or a demonstration; or of a page that waits: the player's seat."""

    what: Literal["retry", "task", "hand", "fingers", "pause", "resume", "demo", "seat"]
    value: Word = ""


class ItemAnswer(Struct, tag="answer", forbid_unknown_fields=True, frozen=True):
    """A participant's answer to an item of a study's sheet; null removes it."""

    sheet: Count
    item: Word
    value: Given | None


class Leave(Struct, tag="leave", forbid_unknown_fields=True, frozen=True):
    """A participant has finished a study's sheet, or answers yes or no to it."""

    sheet: Count
    how: Literal["done", "yes", "no"]


Up = (
    Hello
    | Resized
    | Presence
    | PageTouches
    | PageHands
    | Got
    | Drawn
    | Beat
    | PlayerRequest
    | ItemAnswer
    | Leave
)


class Localised(Struct, frozen=True):
    """A sentence for the person: its key and values, which every language has words for.

    `text` is the sentence in English, for clients without words of their own, and for sentences
    without a key, such as those of other people's tasks.
    """

    key: str
    values: dict[str, str | list[str]]
    text: str


class TaskName(Struct, frozen=True):
    """A task to choose: its name, its summary in a line, and whether it needs a lift control.

    The page calls built-in tasks by its own words; `summary` is in English.
    """

    name: str
    summary: str
    lift: bool


class StudyView(Struct, frozen=True):
    """A page in a study, in the participant's language, with the design's own words by key.

    `shows` lists what a trial shows: task, goal, time, progress, fingers, sound, hint and result.
    """

    language: str
    words: dict[str, str]
    shows: list[str]


class Welcome(Struct, tag="welcome", frozen=True):
    """The server's first message: the role of the page, and the tasks from easiest to hardest.

    In a study there are no menus. `touch` is true if the player's touches drive a hand; otherwise
    another device does, and all pages are spectators.
    """

    protocol: int
    version: str
    role: Literal["player", "spectator"]
    tasks: list[TaskName]
    credit: int
    study: StudyView | None = None
    touch: bool = True


class Geom(Struct, frozen=True):
    """A shape on a body: MuJoCo's type and sizes, position (m) and quaternion (w, x, y, z)."""

    body: int
    kind: Literal["plane", "sphere", "capsule", "ellipsoid", "cylinder", "box"]
    size: tuple[float, float, float]
    position: tuple[float, float, float]
    quaternion: tuple[float, float, float, float]
    rgba: tuple[float, float, float, float]
    part: Literal["hand", "object", "scenery"]


class SurfaceView(Struct, frozen=True):
    """The touch rectangle: size in inches, corner (m) and axes (row by row) in the world.

    `scale` is the length on the screen of what is one long in the world.
    """

    width_in: float
    height_in: float
    origin: tuple[float, float, float]
    rotation: tuple[float, float, float, float, float, float, float, float, float]
    calibrated: bool
    scale: float = 1.0


class SceneMessage(Struct, tag="scene", frozen=True):
    """A new scene. Frames with another `scene` number belong to an earlier one.

    `bodies` names the rows of a frame's poses. `lift` is the height (m) to which a lift control of
    1 raises the hand; 0 if the task has none. `size` of a geom is as in MuJoCo: half lengths and
    radii. `in_air` is true if hands move over a 3-D device, without touches. `goal` is in English;
    in a study, `task` and `goal` are what the participant reads, and `how`, if the design shows
    hints, how it is done. `scored` is false if the result does not count. `fingers` is the least
    number of different fingers with which the task can be played. `finger_sets` has the sets of
    fingers that the player uses, as in the settings; null if they cannot be chosen.
    """

    scene: int
    task: str
    goal: str
    seed: int
    hand: Literal["right", "left"]
    lift: float
    time_limit: float
    surface: SurfaceView
    bodies: list[str]
    geoms: list[Geom]
    caption: Localised | None
    in_air: bool = False
    scored: bool = True
    how: str = ""
    fingers: int = 1
    finger_sets: str | None = None


class Trouble(Struct, tag="trouble", frozen=True):
    """A problem that prevents a scene, and its remedy, sentence by sentence."""

    told: list[Localised]


class Choice(Struct, frozen=True):
    """One of several answers: its stored value, and the label that the person reads."""

    value: str
    label: str


class ItemView(Struct, frozen=True):
    """A question in the participant's language; `low_means` and `high_means` label a scale."""

    name: str
    kind: Literal["choice", "scale", "number", "text"]
    ask: str
    optional: bool
    choices: list[Choice]
    low: float
    high: float
    step: float
    low_means: str
    high_means: str


class Sheet(Struct, tag="sheet", frozen=True):
    """A sheet that a study's participant sees instead of the scene; `none` shows the scene.

    `answers` has earlier answers by item. A `rest` can be left after `seconds`. `note` says whose
    wording the questions of a form have, where it is not the published one, and of a `task` which
    trial of how many it is; `picture` is a data URL with its picture. At `measure`, the size of
    the screen is measured.
    """

    sheet: int
    kind: Literal["measure", "consent", "text", "task", "form", "rest", "wait", "end", "none"]
    title: str
    text: str
    items: list[ItemView]
    answers: dict[str, str | float | None]
    seconds: float
    note: str = ""
    picture: str = ""


class Refusal(Struct, tag="refusal", frozen=True):
    """Refusal of an answer, with the reason; with an empty item, of the whole sheet."""

    sheet: int
    item: str
    text: str


class Seat(Struct, tag="seat", frozen=True):
    """Who may play: to a page that waits, `wait_s` is in how many seconds it plays if the player
    stays away, null while the player is there; to the player, `requested` is true while another
    page requests the seat."""

    wait_s: int | None = None
    requested: bool = False


class Echo(Struct, tag="echo", frozen=True):
    """Answers a beat with its time."""

    t: float


Down = Welcome | SceneMessage | Trouble | Sheet | Refusal | Seat | Echo


class ContactState(Struct, frozen=True):
    """A contact in the session.

    `position` (m) in the world is for fingers that are not on this screen; `force` (N) is that of
    its fingertip on objects, `stored` (N) the part of it that other fingers press back, which is
    let go when the grip opens. `full` is true if the hand has no more force for it. A `palm` is no
    finger. `sure` is false if the label may well be wrong; `inside` is true if the finger is inside
    an object, out of which it has to be moved.
    """

    id: int
    label: int | None
    state: Literal["active", "lost", "ignored", "palm"]
    force: float
    position: tuple[float, float, float]
    sure: bool
    inside: bool
    stored: float = 0.0
    full: bool = False


class HandState(Struct, frozen=True):
    """A hand: phase of its arrival, solid fingers, contacts, probability of the labels."""

    phase: str
    solid: list[int]
    contacts: list[ContactState]
    probability: float


class GoalState(Struct, frozen=True):
    """Current goal of an object: position (m) and turn about the vertical (rad)."""

    object: str
    position: tuple[float, float, float]
    yaw: float


class State(Struct, frozen=True):
    """Values of a frame besides poses, at its end.

    `reason` says what is missing, and `notices` what the person has to know.

    `pause` says why simulated time stands still, and is empty while it runs. `start`: it begins
    with the first touch; `menu`: a menu is open; `away`: a player's page is closed, hidden or lost;
    `back`: the player is back, and time goes on with the next touch.
    """

    time: float
    status: str
    progress: float
    reason: Localised | None
    reached: bool
    held: bool
    hands: list[HandState]
    goals: list[GoalState]
    notices: list[Localised]
    pause: Pause


_up = msgspec.json.Decoder(Up)
_encoder = msgspec.json.Encoder()


def decode(text: str | bytes) -> Up:
    """Decodes a message of a page.

    Raises:
        InputError: The text is not JSON or not a message of this protocol, or a value is out of
            range.
    """
    try:
        return _up.decode(text)
    except (msgspec.MsgspecError, RecursionError, UnicodeError) as error:
        raise InputError(
            "not a message of the page's protocol",
            got=text[:80],
            expected=f"version {PROTOCOL}: {str(error)[:200]}",
        ) from None


def encode(message: Struct) -> bytes:
    """Encodes a message to a page as JSON."""
    return _encoder.encode(message)
