"""Reconstructor of any person's hand, built on the one of the trained right hand.

`PersonFrame` transforms touches to what the trained hand would have touched, and the pose back:
mirrored for a left hand, scaled for a larger one. A uniform scale does not change angles, and
mirror and rotation do not change distances either, so that fingertips which meet the scaled touches
of the trained hand meet the real touches of the person's hand.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from encoders.reconstruction.reconstructor import Reconstructor
from encoders.reconstruction.touch_reconstructor import Reconstruction
from models.arithmetic.arrays import Array
from models.frames import Contact, Frame, TouchFrame
from models.person import Person, PersonFrame
from models.pose import surface_to_world
from models.surface import Surface

ReconstructorMaker = Callable[[Surface], Reconstructor]
"""Creates a reconstructor for a surface."""


class PersonalReconstructor:
    """Reconstructs a person's hand with a reconstructor of the trained right hand.

    Args:
        trained: Reconstructor on `frame.surface`, with the skeleton that the model was trained on.
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
        """The pose last commanded (48,), of the person's hand in the world."""
        return self._outward(self.trained.commanded)

    @property
    def counts(self) -> dict[str, int]:
        """Number of ignored or repaired contacts, by reason."""
        return self.trained.counts

    def lead(self, offsets: Array | None) -> None:
        """Sets how far fingertips are led off their touches on the person's screen."""
        self.trained.lead(None if offsets is None else self.frame.inward_steps(offsets))

    def reset(self) -> None:
        """Returns to the initial state: a hand without contacts that hovers over the middle of the
        surface."""
        self.trained.reset()

    def step(self, frame: TouchFrame) -> Reconstruction:
        """Processes a touch frame of the person's screen.

        Returns:
            The reconstruction of the person's hand. Only `u` stays that of the trained hand, as the
            encoder got it.
        """
        reconstruction = self.trained.step(self._inward(frame))
        contacts = tuple(replace(c, xy=self.frame.outwards(c.xy)) for c in reconstruction.contacts)
        size = self.frame.person.hand_size
        return replace(
            reconstruction,
            q=self._outward(reconstruction.q),
            tip_error=reconstruction.tip_error * size,
            contacts=contacts,
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

    def _place_outward(self, xy: tuple[float, float]) -> tuple[float, float]:
        x, y = self.frame.outwards(xy).tolist()
        return x, y

    def _outward(self, q: Array) -> Array:
        return surface_to_world(self.frame.outward_pose(q), self._surface)


def personal(person: Person, surface: Surface, make: ReconstructorMaker) -> Reconstructor:
    """Creates a reconstructor for a person.

    Args:
        person: The person whose hand it is.
        surface: Their screen, in the world.
        make: Creates the trained right hand's reconstructor for a surface. Its result is returned
            unchanged if the person's hand equals the trained one.
    """
    frame = PersonFrame(person, surface)
    if frame.trivial:
        return make(surface)
    return PersonalReconstructor(make(frame.surface), frame, surface)
