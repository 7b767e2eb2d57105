"""The contract of reconstructors: from one frame after another to the pose of the whole hand."""

from __future__ import annotations

from typing import Protocol, TypeVar

from encoders.reconstruction.touch_reconstructor import Reconstruction
from models.arithmetic.arrays import Array
from models.frames import Frame, HandFrame, LandmarkFrame, TouchFrame
from models.surface import Surface

Frame_contra = TypeVar("Frame_contra", TouchFrame, HandFrame, LandmarkFrame, contravariant=True)


class FrameReconstructor(Protocol[Frame_contra]):
    """Reconstructs one hand from frames of one kind; keeps what it needs of earlier frames."""

    @property
    def surface(self) -> Surface:
        """The touch surface in the world; for a hand in the air, the task's workspace."""
        ...

    @property
    def empty(self) -> Frame:
        """The frame that stands for a device before its first one."""
        ...

    @property
    def commanded(self) -> Array:
        """The pose last commanded (48,), in the world."""
        ...

    @property
    def counts(self) -> dict[str, int]:
        """Number of ignored or repaired contacts, frames or hands, by reason."""
        ...

    @property
    def notice(self) -> str:
        """A message for the person whose hand is not followed; empty while all is well."""
        return ""

    def reset(self) -> None:
        """Returns to the initial state, a hand that waits for its first frame."""
        ...

    def step(self, frame: Frame_contra) -> Reconstruction:
        """Processes a frame; called once per control step, even if nothing has changed."""
        ...


class Reconstructor(FrameReconstructor[TouchFrame], Protocol):
    """Reconstructs a hand from its touches."""

    def lead(self, offsets: Array | None) -> None:
        """Sets how far fingertips are led off their touches, from the next step on.

        Args:
            offsets: (5, 2) m along the surface, y down; None leads no finger.
        """
        ...


HandFrameReconstructor = FrameReconstructor[HandFrame]
"""Reconstructs a hand from the frames of a 3-D device."""

LandmarkFrameReconstructor = FrameReconstructor[LandmarkFrame]
"""Reconstructs a hand from the landmarks in a camera's pictures."""

AirReconstructor = HandFrameReconstructor | LandmarkFrameReconstructor
"""Reconstructs a hand in the air."""
