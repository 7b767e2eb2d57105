"""Messages between server and page. The page's TypeScript types are generated from this file.

From the page: JSON texts, one message each, tagged by `type`. To the page: JSON texts for events,
and binary frames for motion (see `sandbox.server.protocol.frames`). Every message is checked whole
against the types here; an invalid one is refused, counted, and changes nothing.
"""

from __future__ import annotations

from typing import Annotated, Literal

import msgspec
from msgspec import Meta, Struct

from models.errors import InputError

PROTOCOL = 2
"""Version of all messages; both sides say it first, and part if it differs."""

LARGEST_MESSAGE = 8192
"""Bytes of the largest message from a page; 20 touches take about 700."""

CREDIT = 6
"""Frames that may be on their way to a page unacknowledged. After a stall of the network a page
gets these at most before it sees the present; with three, a round trip of 30 ms halves its rate."""

Number = Annotated[float, Meta(ge=-1e6, le=1e6)]
Milliseconds = Annotated[float, Meta(ge=0, le=1e15)]
Count = Annotated[int, Meta(ge=0, le=2**53)]
Id = Annotated[int, Meta(ge=-(2**31), lt=2**53)]
Word = Annotated[str, Meta(max_length=64)]
LONGEST_ANSWER = 2000
"""Characters of an answer in words."""
Given = Annotated[str, Meta(max_length=LONGEST_ANSWER)] | Annotated[float, Meta(ge=-1e9, le=1e9)]
"""An answer, before anybody has looked whether it is one."""


class Screen(Struct, forbid_unknown_fields=True, frozen=True):
    """How large the page is: CSS pixels per inch, and pixels.

    The inches are what the encoder needs; `calibrated` says whether somebody measured them.
    """

    px_per_in: Annotated[float, Meta(ge=20, le=1000)]
    width_px: Annotated[float, Meta(ge=1, le=32768)]
    height_px: Annotated[float, Meta(ge=1, le=32768)]
    calibrated: bool


class Hello(Struct, tag="hello", forbid_unknown_fields=True, frozen=True):
    """The page's first message. `client` is the page's own random name, kept when it reloads."""

    protocol: int
    client: Word
    role: Literal["player", "spectator"]
    screen: Screen


class Resized(Struct, tag="resized", forbid_unknown_fields=True, frozen=True):
    """The page's size or calibration has changed."""

    screen: Screen


class Touches(Struct, tag="touches", forbid_unknown_fields=True, frozen=True):
    """All contacts of the page at one moment.

    `contacts` holds id, x, y and width in CSS pixels, x right and y down from the touch rectangle's
    top left corner; `cancelled` the ids that the system took away since the last message; `lift`
    the lift control, where the page shows one. `seq` counts up from 1, `t` is the page's clock.
    """

    seq: Count
    t: Milliseconds
    contacts: Annotated[list[tuple[Id, Number, Number, Number]], Meta(max_length=20)]
    cancelled: Annotated[list[Id], Meta(max_length=20)] = []
    lift: Annotated[float, Meta(ge=0, le=1)] | None = None


class Got(Struct, tag="got", forbid_unknown_fields=True, frozen=True):
    """A frame has arrived; gives its credit back. Sent at once, before anything is drawn."""

    frame: Count


class Drawn(Struct, tag="drawn", forbid_unknown_fields=True, frozen=True):
    """A frame has been drawn, `after_ms` after the touch event that it answers had happened."""

    frame: Count
    after_ms: Annotated[float, Meta(ge=0, le=60000)]


class Beat(Struct, tag="beat", forbid_unknown_fields=True, frozen=True):
    """Says that the page lives, and asks for an echo; `round_trip_ms` is the last echo's."""

    t: Milliseconds
    round_trip_ms: Annotated[float, Meta(ge=0, le=60000)] | None = None


class Ask(Struct, tag="ask", forbid_unknown_fields=True, frozen=True):
    """The person wants something: try again, another task, the other hand, or a stop of time."""

    what: Literal["retry", "task", "hand", "pause", "resume"]
    value: Word = ""


class Answer(Struct, tag="answer", forbid_unknown_fields=True, frozen=True):
    """What somebody has filled in for an item of a study's sheet; null takes it back."""

    sheet: Count
    item: Word
    value: Given | None


class Leave(Struct, tag="leave", forbid_unknown_fields=True, frozen=True):
    """Somebody is through with a study's sheet, or says yes or no to it."""

    sheet: Count
    how: Literal["done", "yes", "no"]


Up = Hello | Resized | Touches | Got | Drawn | Beat | Ask | Answer | Leave


class TaskName(Struct, frozen=True):
    """A task that can be chosen: its name, one line about it, whether it needs a lift control."""

    name: str
    summary: str
    lift: bool


class StudyView(Struct, frozen=True):
    """A page in a study: its words by what they are for, in the participant's language, and which
    of task, goal, time, progress, fingers and sound a trial shows."""

    language: str
    words: dict[str, str]
    shows: list[str]


class Welcome(Struct, tag="welcome", frozen=True):
    """The server's first message: what the page is (a player or a spectator), and what there is.
    In a study there are no menus. `touch`: the player's fingers on the page are a hand's; else
    something else plays, and every page only looks."""

    protocol: int
    version: str
    role: Literal["player", "spectator"]
    tasks: list[TaskName]
    credit: int
    study: StudyView | None = None
    touch: bool = True


class Geom(Struct, frozen=True):
    """A shape on a body: MuJoCo's type and sizes, place (m) and turn (w, x, y, z) on the body."""

    body: int
    kind: Literal["plane", "sphere", "capsule", "ellipsoid", "cylinder", "box"]
    size: tuple[float, float, float]
    position: tuple[float, float, float]
    quaternion: tuple[float, float, float, float]
    rgba: tuple[float, float, float, float]
    part: Literal["hand", "object", "scenery"]


class SurfaceView(Struct, frozen=True):
    """The touch rectangle: size in inches, corner (m) and axes (row by row) in the world."""

    width_in: float
    height_in: float
    origin: tuple[float, float, float]
    rotation: tuple[float, float, float, float, float, float, float, float, float]
    calibrated: bool


class Scene(Struct, tag="scene", frozen=True):
    """A new scene. Frames of another `scene` number belong to one that is over.

    `bodies` names the rows of a frame's poses. `lift` is how far the hand rises at a lift control
    of 1, m; 0: the task has none. `size` of a geom is as in MuJoCo: half lengths and radii.
    `in_air`: hands move over a 3-D device, and nobody touches the page.
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
    caption: str
    in_air: bool = False


class Trouble(Struct, tag="trouble", frozen=True):
    """Something that the person has to know before there is a scene, and what to do about it."""

    text: str


class Choice(Struct, frozen=True):
    """One of several answers: as it is kept, and as it is read."""

    value: str
    label: str


class ItemView(Struct, frozen=True):
    """A question in the participant's language; `low_means` and `high_means` are a scale's ends."""

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
    """What a study's participant has before them instead of the scene; `none` shows the scene.

    `answers` is what was filled in before, by item. A `rest` can be left after `seconds`.
    """

    sheet: int
    kind: Literal["consent", "text", "form", "rest", "wait", "end", "none"]
    title: str
    text: str
    items: list[ItemView]
    answers: dict[str, str | float | None]
    seconds: float


class Refusal(Struct, tag="refusal", frozen=True):
    """An answer that is none, and why; without an item, the whole sheet."""

    sheet: int
    item: str
    text: str


class Echo(Struct, tag="echo", frozen=True):
    """Answers a beat with its time."""

    t: float


Down = Welcome | Scene | Trouble | Sheet | Refusal | Echo


class ContactState(Struct, frozen=True):
    """A contact as the session knows it: place (m) in the world, for those whose fingers are not on
    this screen; `force` (N) is what its fingertip presses things with."""

    id: int
    label: int | None
    state: Literal["active", "lost", "ignored"]
    force: float
    position: tuple[float, float, float]


class HandState(Struct, frozen=True):
    """A hand: phase of its arrival, fingers that are solid, contacts, sureness of the labels."""

    phase: str
    solid: list[int]
    contacts: list[ContactState]
    probability: float


class GoalState(Struct, frozen=True):
    """Where a thing should go now: position (m) and turn about the vertical (rad)."""

    object: str
    position: tuple[float, float, float]
    yaw: float


class State(Struct, frozen=True):
    """What changes besides poses; the tail of a frame."""

    time: float
    status: str
    progress: float
    reason: str
    reached: bool
    held: bool
    hands: list[HandState]
    goals: list[GoalState]
    notice: str
    paused: bool


_up = msgspec.json.Decoder(Up)
_encoder = msgspec.json.Encoder()


def decode(text: str | bytes) -> Up:
    """A page's message.

    Raises:
        InputError: It is no JSON, no message of this protocol, or a value is out of its range.
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
    """JSON of a message to a page."""
    return _encoder.encode(message)
