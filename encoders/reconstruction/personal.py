"""The reconstructor of any person's hand: the trained right hand's, between two mirrors.

Touches go through `PersonFrame` to what the trained hand would have touched, and the pose comes
back the same way: a left hand's mirrored, a larger hand's larger. A uniform scale changes no angle,
and mirror and turn no distance either, so that fingertips which meet the shrunken touches of the
trained hand meet the real ones of the person's.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from encoders.reconstruction.reconstructor import Reconstructor
from encoders.reconstruction.touch_reconstructor import Reconstruction
from models.frames import Contact, Frame, TouchFrame
from models.person import Person, PersonFrame
from models.pose import surface_to_world
from models.surface import Surface

Array = NDArray[np.float64]

ReconstructorMaker = Callable[[Surface], Reconstructor]
"""Makes a reconstructor on a surface."""


class PersonalReconstructor:
    """Reconstructs a person's hand with a reconstructor of the trained right hand.

    Args:
        trained: Reconstructor on `frame.surface`, with the skeleton that the model was trained on.
        frame: Between the person's screen and that surface.
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
        """As the trained hand's reconstructor says."""
        return self.trained.notice

    @property
    def commanded(self) -> Array:
        """(48,) the pose last commanded, of the person's hand in the world."""
        return self._outward(self.trained.commanded)

    @property
    def counts(self) -> dict[str, int]:
        """How often contacts were ignored or repaired, by reason."""
        return self.trained.counts

    def reset(self) -> None:
        """Back to a hand that hovers over the middle of the surface and knows no contact."""
        self.trained.reset()

    def step(self, frame: TouchFrame) -> Reconstruction:
        """Takes in a touch frame of the person's screen.

        Returns:
            The person's hand. `u` alone stays as the encoder saw it: the trained hand's.
        """
        reconstruction = self.trained.step(self._inward(frame))
        contacts = tuple(replace(c, xy=self.frame.outwards(c.xy)) for c in reconstruction.contacts)
        size = self.frame.person.hand_size
        return replace(
            reconstruction,
            q=self._outward(reconstruction.q),
            tip_error=reconstruction.tip_error * size,
            contacts=contacts,
        )

    def _inward(self, frame: TouchFrame) -> TouchFrame:
        if not frame.contacts:
            return frame
        xy = self.frame.inwards([(c.x, c.y) for c in frame.contacts])
        size = self.frame.person.hand_size
        contacts = tuple(
            Contact(c.id, float(x), float(y), c.size and c.size / size, c.label)
            for c, (x, y) in zip(frame.contacts, xy, strict=True)
        )
        return replace(frame, contacts=contacts)

    def _outward(self, q: Array) -> Array:
        return surface_to_world(self.frame.outward_pose(q), self._surface)


def personal(person: Person, surface: Surface, make: ReconstructorMaker) -> Reconstructor:
    """A reconstructor for a person.

    Args:
        person: Whose hand.
        surface: Their screen, in the world.
        make: Makes the trained right hand's reconstructor on a given surface. It is used as it is
            where the person's hand is like the trained one.
    """
    frame = PersonFrame(person, surface)
    if frame.trivial:
        return make(surface)
    return PersonalReconstructor(make(frame.surface), frame, surface)
