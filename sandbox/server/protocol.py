"""Messages between server and page. The page's TypeScript types are generated from this file.

From the page: JSON texts, one message each, tagged by `type`. To the page: JSON texts for events,
and binary frames for motion (see `sandbox.server.page_frames`). Every message of a page is checked
against the types of this module. An invalid message is refused, counted, and has no effect.
`Allowance` limits the number of accepted messages.
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
"""Size of the largest message from a page, bytes; a message with 20 touches has about 700."""

CREDIT = 6
"""Largest number of unacknowledged frames on their way to a page. After a stall of the network, a
page gets at most this many old frames. With a credit of three, a round trip of 30 ms would halve
the page's frame rate."""

Measured = Annotated[float | None, Meta(extra={"page": "number"})]
"""A number that a screen or headset has measured. It is null if the browser reports NaN or
infinity, which JSON lacks. The device checks the value, so that a wrong one does not invalidate the
whole message."""

Milliseconds = Annotated[float, Meta(ge=0, le=1e15)]
Count = Annotated[int, Meta(ge=0, le=2**53)]
Id = Annotated[int, Meta(ge=-(2**31), lt=2**53)]
Label = Annotated[int, Meta(ge=0, lt=len(FINGERS))]
Word = Annotated[str, Meta(max_length=64)]
LONGEST_ANSWER = 2000
"""Largest number of characters in a text answer."""
Given = Annotated[str, Meta(max_length=LONGEST_ANSWER)] | Annotated[float, Meta(ge=-1e9, le=1e9)]
"""An answer to a question, not yet checked by the study."""
Pause = Literal["", "start", "menu", "away", "back"]


LIFT_STRIP_PX = 90.0
"""Width of the lift control beside the touch rectangle in tasks that lift, CSS pixels."""
LIFT_NOTCH, LIFT_KEY, LIFT_PAGE = 0.12, 0.05, 0.20
"""Movement of the lift control, as a share of its range: by a notch of the mouse wheel, by the keys
up and down, and by page up and page down."""
NOTCH_PX = 100.0
"""CSS pixels that browsers report for a notch of the mouse wheel."""


DEMONSTRATION_KIND = 3
"""Kind of a binary message with the frames of a demonstration (`sandbox.play.demonstration`); see
`sandbox.server.page_frames` for the others."""


class Allowance:
    """A token bucket that limits messages or connections.

    Args:
        rate: Long-term limit, per second.
        burst: Number allowed at once.
        now: Time at the start, s.
    """

    def __init__(self, rate: float, burst: float, now: float) -> None:
        self._rate, self._burst = rate, burst
        self._left, self._at = burst, now

    def take(self, now: float) -> bool:
        """Returns True if one more is allowed at the time `now` (s), and counts it."""
        self._left = min(self._burst, self._left + (now - self._at) * self._rate)
        self._at = now
        if self._left < 1.0:
            return False
        self._left -= 1.0
        return True


class PageScreen(Struct, forbid_unknown_fields=True, frozen=True):
    """Size of the page's area for the table and the lift control: CSS pixels per inch, and width
    and height in CSS pixels. On a phone, text and buttons are beside this area; elsewhere it is the
    whole page.

    The encoder needs inches; `calibrated` is true if the person has measured them. `fit` is empty
    if the table has its true size. Otherwise the table is scaled to fill the page, because the
    input is a `mouse`, for which sizes do not matter, or the screen is a `phone`, which is too
    small for a hand.
    """

    px_per_in: Annotated[float, Meta(ge=20, le=1000)]
    width_px: Annotated[float, Meta(ge=1, le=32768)]
    height_px: Annotated[float, Meta(ge=1, le=32768)]
    calibrated: bool
    fit: Literal["", "mouse", "phone"] = ""


class Hello(Struct, tag="hello", forbid_unknown_fields=True, frozen=True):
    """The page's first message. `client` is the page's random name, which does not change when the
    page is reloaded. `language` is the page's language, by ISO 639-1."""

    protocol: int
    client: Word
    role: Literal["player", "spectator"]
    screen: PageScreen
    language: Word = ""


class Resized(Struct, tag="resized", forbid_unknown_fields=True, frozen=True):
    """The page's size or calibration has changed."""

    screen: PageScreen


class Presence(Struct, tag="presence", forbid_unknown_fields=True, frozen=True):
    """Whether the page can be played. It cannot while it is hidden (behind another tab, or asleep),
    or while its screen is rotated relative to the orientation for which the table was placed."""

    here: bool


class PageTouches(Struct, tag="touches", forbid_unknown_fields=True, frozen=True):
    """All contacts of the page at one moment.

    `contacts` has id, x, y, width and height of each contact, in CSS pixels, x right and y down
    from the touch rectangle's top left corner; unknown width and height are at most 1. `cancelled`
    has the ids that the system has cancelled since the last message. `lift` is the lift control, 0
    to 1; null if the page shows none. `labels` has id and label of fingers that were put down by
    keys, with a mouse. `seq` counts up from 1, `t` is the page's clock.
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
    """A hand that a headset sees: positions (m, world) of 25 joints in the order of WebXR; null for
    an unknown joint."""

    side: Literal["right", "left"]
    joints: Annotated[list[Vector | None], _EVERY_JOINT]


class HeldController(Struct, forbid_unknown_fields=True, frozen=True):
    """A controller in a hand: position (m) and quaternion (w, x, y, z) of its grip in the world.
    `trigger` is how far the trigger is pulled, 0 to 1."""

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
    """Request of the player: try again, another task, the other hand, sets of fingers (written as
    in the settings), pause or resume, or a demonstration. Or request of a waiting page: the
    player's seat."""

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
    """A sentence for the person: `key` of its text, which exists in every language, and `values`
    for the text's placeholders.

    `text` is the sentence in English. It is for clients without texts, and for sentences without a
    key, such as those of users' tasks.
    """

    key: str
    values: dict[str, str | list[str]]
    text: str


class TaskName(Struct, frozen=True):
    """A task to choose: its name, its summary in a line, and whether it needs a lift control.

    `summary` is in English; for built-in tasks, the page has texts in every language.
    """

    name: str
    summary: str
    lift: bool


class StudyView(Struct, frozen=True):
    """Settings of a page in a study: the participant's language, and the design's texts by key.

    `shows` lists the items that the page shows in a trial, of: task, goal, time, progress, fingers,
    sound, hint and result.
    """

    language: str
    words: dict[str, str]
    shows: list[str]


class Welcome(Struct, tag="welcome", frozen=True):
    """The server's first message: the role of the page, and the tasks from easiest to hardest.

    `study` is null outside a study; in a study, the page has no menus. `touch` is true if the
    player's touches drive a hand. If it is false, another device drives the hand, and all pages are
    spectators.
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

    `scale` is the length on the screen divided by the length in the world.
    """

    width_in: float
    height_in: float
    origin: tuple[float, float, float]
    rotation: tuple[float, float, float, float, float, float, float, float, float]
    calibrated: bool
    scale: float = 1.0


class SceneMessage(Struct, tag="scene", frozen=True):
    """A new scene. Frames with another `scene` number belong to an earlier scene.

    `bodies` names the rows of a frame's poses. `lift` is the height (m) to which a lift control of
    1 raises the hand; 0 if the task has no lift control. `size` of a geom is as in MuJoCo: half
    lengths and radii. `in_air` is true if hands are tracked in the air, without touches. `goal` is
    in English. In a study, `task` and `goal` are the design's texts for the participant, and `how`
    explains how to do the task, if the design shows hints. `scored` is false if the result does not
    count. `fingers` is the smallest number of different fingers with which the task can be played.
    `finger_sets` has the sets of fingers that the player uses, as in the settings; null if they
    cannot be chosen. `shared` is true if the page's touches move one of several hands.
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
    shared: bool = False


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

    `answers` has earlier answers by item. A `rest` can be left after `seconds`. `note` of a form is
    the source of its questions' wording, if this is not the published one; `note` of a `task` is
    the number of the trial and the number of all trials. `picture` is a data URL with the picture
    of a task. At `measure`, the size of the screen is measured.
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
    """Refusal of an answer, with the reason. If `item` is empty, the whole sheet is refused."""

    sheet: int
    item: str
    text: str


class Seat(Struct, tag="seat", frozen=True):
    """Who may play. For a waiting page, `wait_s` is the number of seconds until it gets the seat if
    the player stays away; null while the player is present. For the player, `requested` is true
    while another page requests the seat."""

    wait_s: int | None = None
    requested: bool = False


class Echo(Struct, tag="echo", frozen=True):
    """Answers a beat with its time."""

    t: float


Down = Welcome | SceneMessage | Trouble | Sheet | Refusal | Seat | Echo


class ContactState(Struct, frozen=True):
    """A contact in the session.

    `position` (m, world) is used for fingers that are not on this screen. `force` (N) is the force
    of the contact's fingertip on objects. `stored` (N) is the part of this force that opposing
    fingers balance: it is released when the grip opens. `full` is true if the force cannot
    increase, since a servo of the finger or of the palm is at its limit. A contact in the state
    `palm` is not a finger. `sure` is false if the label may well be wrong. `inside` is true if the
    finger is inside an object; it has to be moved out.
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
    """Current goal of an object: position (m) and rotation about the vertical (rad)."""

    object: str
    position: tuple[float, float, float]
    yaw: float


class State(Struct, frozen=True):
    """Values at the end of a frame, after the poses.

    `reason` is the reason why the goal is not reached. `notices` are messages for the person.

    `pause` is the reason why simulated time stands still; empty while it runs. `start`: time begins
    with the first touch. `menu`: a menu is open. `away`: a player's page is closed, hidden or lost.
    `back`: the player is back, and time continues with the next touch.
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
