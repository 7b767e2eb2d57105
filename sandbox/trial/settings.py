"""Everything that decides how a run goes, as plain values: what is written, can be run again."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field, fields
from typing import Any

from models.errors import InputError
from models.hand import IMPULSE_PROFILES, SERVOS
from models.person import HANDS, Person
from models.surface import PRESETS, Surface
from sandbox.session.contact_modes import ContactMode, contact_mode
from sandbox.trial.hand_input import HandInput
from tasks.variation import Variation

LABELS = ("history", "paper", "device")
"""`history`: a belief carried from contact to contact; `paper`: nearest training pose; `device`:
what the device says, for devices that know, and as an upper bound with the simulated user."""


@dataclass(frozen=True)
class SecondHand:
    """Another hand in the same scene, of the same person or of another; JSON values only.

    Attributes:
        hand: `right` or `left`.
        hand_size: Length of the hand against the trained one.
        turn: degrees, where its owner sits (see `models.person.Person`).
        shared: Both hands are on one surface; otherwise each has its own, of the same size.
        in_air: How a 3-D device drives it; None where touches do.
    """

    hand: str = HANDS[1]
    hand_size: float = 1.0
    turn: int = 0
    shared: bool = False
    in_air: HandInput | None = None

    def __post_init__(self) -> None:
        _ = self.person

    @property
    def person(self) -> Person:
        """Whose hand it is, checked."""
        return Person(self.hand, self.hand_size, self.turn)

    @classmethod
    def from_json(cls, values: Any) -> SecondHand:
        """Read back.

        Raises:
            InputError: A name is missing or unknown.
        """
        names = {f.name for f in fields(cls)}
        values = {"in_air": None, **values} if isinstance(values, dict) else values
        if not isinstance(values, dict) or set(values) != names:
            raise InputError("no such second hand", where="settings", got=str(values)[:80],
                             expected=", ".join(sorted(names)))  # fmt: skip
        in_air = values["in_air"] and HandInput.from_json(values["in_air"])
        return cls(**{**values, "in_air": in_air})


@dataclass(frozen=True)
class RunSettings:
    """Settings of one run; JSON values only.

    Attributes:
        task: Name of the task.
        seed: Of the task's start and goal, and of a simulated user.
        encoder: `paper`, `linear`, `quadratic`, `cubic`, `best`, or a trained model's file.
        labels: One of `LABELS`.
        correction: Fingertips are made to meet their touches.
        smoothing: Touches and posture are low-passed.
        arrival: The hand hovers, comes down from above and rises; otherwise it drops where it is.
        ghost_until_clear: A hand that is down turns solid only outside of objects.
        distal_only: Only last links of touching fingers are ever solid.
        stitch: A lost contact lives on for a moment.
        encode: The encoder's pose is used; otherwise the mean training pose.
        servo: One of `models.hand.SERVOS`.
        impulse: N s (N m s) per 1/60 s, limit of every servo.
        contact: How hands and objects touch at the start: one of `sandbox.session.contact_modes`.
        surface_in: Width and height of the touch surface, inches.
        surface_calibrated: False where its size is a guess.
        timestep: s of physics.
        hand: `right` or `left`.
        hand_size: Length of the person's hand against the trained one.
        turn: degrees, where the person sits (see `models.person.Person`).
        variation: How the trial differs from the one that is drawn, and touches from those made.
        second: Another hand in the scene; None where there is one hand only.
        in_air: How a 3-D device drives the hand; None where touches do.
    """

    task: str = "box-to-goal"
    seed: int = 0
    encoder: str = "best"
    labels: str = "history"
    correction: bool = True
    smoothing: bool = True
    arrival: bool = True
    ghost_until_clear: bool = True
    distal_only: bool = True
    stitch: bool = True
    encode: bool = True
    servo: str = SERVOS[0]
    impulse: float = IMPULSE_PROFILES["paper"]
    contact: str = ContactMode.HARD.value
    surface_in: tuple[float, float] = PRESETS["ipad2"]
    surface_calibrated: bool = True
    timestep: float = 0.002
    hand: str = HANDS[0]
    hand_size: float = 1.0
    turn: int = 0
    variation: Variation = field(default_factory=Variation)
    second: SecondHand | None = None
    in_air: HandInput | None = None

    def __post_init__(self) -> None:
        if self.labels not in LABELS:
            raise InputError(
                "no such labels", where="labels", got=self.labels, expected=", ".join(LABELS)
            )
        _ = self.person
        contact_mode(self.contact)

    @property
    def person(self) -> Person:
        """Whose hand it is, checked."""
        return Person(self.hand, self.hand_size, self.turn)

    @property
    def persons(self) -> tuple[Person, ...]:
        """Whose hands they are, one or two."""
        return (self.person, self.second.person) if self.second else (self.person,)

    @property
    def hand_names(self) -> tuple[str, ...]:
        """A name of its own for every hand: its side, and `right_too` for a second right one."""
        sides = [person.hand for person in self.persons]
        return tuple(s if s not in sides[:i] else f"{s}_too" for i, s in enumerate(sides))

    @property
    def in_airs(self) -> tuple[HandInput | None, ...]:
        """How 3-D devices drive the hands, hand by hand."""
        return (self.in_air, self.second.in_air) if self.second else (self.in_air,)

    @property
    def surface(self) -> Surface:
        """The touch rectangle, not yet placed in the world."""
        return Surface(*self.surface_in, calibrated=self.surface_calibrated)

    def as_json(self) -> dict[str, Any]:
        """For headers and results; a variation, a second hand and what is said of 3-D devices
        only where there are any."""
        values = asdict(self)
        if self.variation.neutral:
            del values["variation"]
        if self.second is None:
            del values["second"]
        elif self.second.in_air is None:
            del values["second"]["in_air"]
        if self.in_air is None:
            del values["in_air"]
        return values

    @classmethod
    def from_json(cls, values: dict[str, Any]) -> RunSettings:
        """Settings read back.

        Raises:
            InputError: A setting is missing or unknown: another version wrote it.
        """
        # What older recordings do not tell was so before it could be chosen.
        older: dict[str, Any] = {"contact": ContactMode.HARD.value, "variation": {}, "second": None}
        older["in_air"] = None
        values = {**asdict(Person()), **older, **values}
        names = {f.name for f in fields(cls)}
        if set(values) != names:
            raise InputError(
                "these settings are another version's",
                where="settings",
                got=", ".join(sorted(set(values) ^ names)) + " missing or unknown",
                remedy="Use the version that the header names",
            )
        width, height = values["surface_in"]
        definite = {
            "surface_in": (float(width), float(height)),
            "variation": Variation.from_json(values["variation"]),
            "second": values["second"] and SecondHand.from_json(values["second"]),
            "in_air": values["in_air"] and HandInput.from_json(values["in_air"]),
        }
        return cls(**{**values, **definite})


def bare(settings: dict[str, Any]) -> dict[str, Any]:
    """The paper's own pipeline: its labels, no correction, no smoothing."""
    return {**settings, "labels": "paper", "correction": False, "smoothing": False}
