"""The contract of reconstructors, which turn successive frames into poses of the whole hand.

`PersonalReconstructor` reconstructs any person's hand with a reconstructor of the trained hand, a
right hand. `PersonFrame` transforms the person's touches to touches of the trained hand, and the
pose back. It mirrors for a left hand, and scales for a hand of another size. A uniform scale does
not change angles, and mirroring and rotation change neither angles nor distances. Fingertips of the
trained hand that meet the transformed touches therefore become fingertips of the person's hand that
meet the real touches.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Protocol, TypeGuard, TypeVar

from encoders.reconstruction.hand_motion import Phase
from models.arithmetic import Array
from models.frames import Contact, Frame, HandFrame, LandmarkFrame, TouchFrame
from models.person import Person, PersonFrame
from models.surface import Surface


@dataclass(frozen=True)
class Reconstruction:
    """The reconstructed hand at one moment.

    Attributes:
        q: (48,) commanded pose in the world.
        phase: Phase of arrival or departure.
        fingers: Labels of the fingers that touch.
        u: (15,) contact vector, or None without a labelled contact.
        probability: Probability of the labels, 0 to 1.
        tip_error: Largest distance (m) between a corrected fingertip and its target, which is its
            touch or a point at an offset from it.
        see: Function that computes `contacts` of this moment, even if it is called later.
        touches: Label of a touching finger -> smoothed (x, y) m on the surface.
        tip_height: Height (m) of touching fingertips above the surface once the hand is down.
    """

    q: Array
    phase: Phase
    fingers: frozenset[int]
    u: Array | None
    probability: float
    tip_error: float
    see: Callable[[], tuple[Contact, ...]] = tuple
    touches: Mapping[int, tuple[float, float]] = field(default_factory=dict)
    tip_height: float = 0.0

    @cached_property
    def contacts(self) -> tuple[Contact, ...]:
        """All contacts on the surface, with labels, states and smoothed positions."""
        return self.see()

    @property
    def down(self) -> bool:
        """True if the hand is at its place, so that its fingers may touch objects."""
        return self.phase is Phase.DOWN


Frame_contra = TypeVar("Frame_contra", TouchFrame, HandFrame, LandmarkFrame, contravariant=True)


class FrameReconstructor(Protocol[Frame_contra]):
    """Reconstructs one hand from frames of one kind, with a state that depends on earlier
    frames."""

    @property
    def surface(self) -> Surface:
        """The touch surface in the world; for a hand in the air, the task's workspace."""
        ...

    @property
    def empty(self) -> Frame:
        """Frame that is used until the device has sent its first frame."""
        ...

    @property
    def commanded(self) -> Array:
        """The last commanded pose (48,), in the world."""
        ...

    @property
    def counts(self) -> dict[str, int]:
        """Number of ignored or repaired contacts, frames or hands, by reason."""
        ...

    @property
    def notice(self) -> str:
        """Notice to the person whose hand is not followed; empty while it is followed."""
        return ""

    def reset(self) -> None:
        """Returns to the initial state: a hand that waits for its first frame."""
        ...

    def step(self, frame: Frame_contra) -> Reconstruction:
        """Processes a frame; called once per control step, even if nothing has changed."""
        ...


class Reconstructor(FrameReconstructor[TouchFrame], Protocol):
    """Reconstructs a hand from its touches."""

    def set_tip_offsets(self, offsets: Array | None) -> None:
        """Sets the offsets from touches to fingertips, from the next step on.

        Args:
            offsets: (5, 2) m along the surface, y down; None sets all to 0.
        """
        ...


HandFrameReconstructor = FrameReconstructor[HandFrame]
"""Reconstructs a hand from the frames of a 3-D device."""

LandmarkFrameReconstructor = FrameReconstructor[LandmarkFrame]
"""Reconstructs a hand from the landmarks in a camera's pictures."""

AirReconstructor = HandFrameReconstructor | LandmarkFrameReconstructor
"""Reconstructs a hand in the air."""


def takes_touches(reconstructor: Reconstructor | AirReconstructor) -> TypeGuard[Reconstructor]:
    """True for a reconstructor of touches, False for a reconstructor of a hand in the air."""
    return isinstance(reconstructor.empty, TouchFrame)


ReconstructorMaker = Callable[[Surface], Reconstructor]
"""Creates a reconstructor for a surface."""


class PersonalReconstructor:
    """Reconstructs a person's hand with a reconstructor of the trained hand, a right hand.

    Args:
        trained: Reconstructor on `frame.surface`, with the skeleton on which the model was trained.
        frame: Transform between the person's screen and that surface.
        surface: The person's screen, in the world.
    """

    def __init__(self, trained: Reconstructor, frame: PersonFrame, surface: Surface) -> None:
        self.trained, self.frame = trained, frame
        self._surface = surface

    @property
    def surface(self) -> Surface:
        """The person's screen in the world."""
        return self._surface

    @property
    def empty(self) -> Frame:
        """A frame without touches."""
        return self.trained.empty

    @property
    def notice(self) -> str:
        """See the trained hand's reconstructor."""
        return self.trained.notice

    @property
    def commanded(self) -> Array:
        """The last commanded pose (48,) of the person's hand, in the world."""
        return self._outward(self.trained.commanded)

    @property
    def counts(self) -> dict[str, int]:
        """Number of ignored or repaired contacts, by reason."""
        return self.trained.counts

    def set_tip_offsets(self, offsets: Array | None) -> None:
        """Sets the offsets from touches to fingertips on the person's screen."""
        inward = None if offsets is None else self.frame.inward_steps(offsets)
        self.trained.set_tip_offsets(inward)

    def reset(self) -> None:
        """Returns to the initial state: a hand without contacts that hovers over the middle of the
        surface."""
        self.trained.reset()

    def step(self, frame: TouchFrame) -> Reconstruction:
        """Processes a touch frame of the person's screen.

        Returns:
            The reconstruction of the person's hand. Only `u` is that of the trained hand, since it
            is the input of the encoder.
        """
        reconstruction = self.trained.step(self._inward(frame))
        size = self.frame.person.hand_size
        return replace(
            reconstruction,
            q=self._outward(reconstruction.q),
            tip_error=reconstruction.tip_error * size,
            see=lambda: tuple(self._outward_contact(c) for c in reconstruction.contacts),
            touches={f: self._place_outward(xy) for f, xy in reconstruction.touches.items()},
            tip_height=reconstruction.tip_height * size,
        )

    def _inward(self, frame: TouchFrame) -> TouchFrame:
        if not frame.contacts:
            return frame
        xy = self.frame.inwards([(c.x, c.y) for c in frame.contacts])
        size = self.frame.person.hand_size
        contacts = tuple(
            Contact(
                c.id,
                float(x),
                float(y),
                c.size and c.size / size,
                c.label,
                c.extent and (c.extent[0] / size, c.extent[1] / size),
            )
            for c, (x, y) in zip(frame.contacts, xy, strict=True)
        )
        return replace(frame, contacts=contacts)

    def _outward_contact(self, contact: Contact) -> Contact:
        x, y = self._place_outward((contact.x, contact.y))
        return replace(contact, x=x, y=y)

    def _place_outward(self, xy: tuple[float, float]) -> tuple[float, float]:
        x, y = self.frame.outwards(xy).tolist()
        return x, y

    def _outward(self, q: Array) -> Array:
        return self._surface.pose_to_world(self.frame.outward_pose(q))


def personal(person: Person, surface: Surface, make: ReconstructorMaker) -> Reconstructor:
    """Creates a reconstructor for a person.

    Args:
        person: The person whose hand it is.
        surface: The person's screen, in the world.
        make: Creates a reconstructor of the trained hand for a surface. Its result is returned
            unchanged if the person's hand and seat are those of the trained hand.
    """
    frame = PersonFrame(person, surface)
    if frame.trivial:
        return make(surface)
    return PersonalReconstructor(make(frame.surface), frame, surface)
