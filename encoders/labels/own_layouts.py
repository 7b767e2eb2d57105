"""A person's own layouts of five fingers, which label themselves, as evidence about fewer fingers.

Five touches of one hand are named without error even for strangers: there is one thumb, and the
others follow it in order. So such layouts are kept, and all their parts are known layouts of this
person's fingers. Nothing else is learned: a confident answer about two fingers may be wrong, and
would confirm itself.
"""

from __future__ import annotations

from functools import cached_property
from math import log

import numpy as np
from numpy.typing import ArrayLike

from encoders.labels.layout_density import KernelShape, LayoutDensity, finger_sets
from models.arithmetic import functions
from models.arithmetic.arrays import Array
from models.arithmetic.products import squared_lengths, total
from models.errors import EncoderError
from models.frames import FINGERS
from models.surface import METRES_PER_INCH

MOST = 24
"""Layouts that are kept; the oldest makes room for a new one."""

NEW = 0.12
"""inches, least root mean square distance of a new layout from all that are kept, after the best
shift: the same posture again tells nothing new."""

SHAPE = KernelShape(width=0.25, turn=0.22, size=0.16)
"""Kernel shape: how much a person's later layouts differ from the kept ones."""

FAR = (3.0, 4.0, 5.0)
"""Standard deviations from a kept layout beyond which it has no say, for 2, 3 and 4 contacts."""

_WIDEST = 12.0
"""inches, greatest distance of two touches of one hand."""

_LEAST = 0.2
"""inches, least distance of two fingertips' middles."""


class OwnLayouts:
    """Layouts of a person's five fingers.

    Args:
        layouts: (n, 5, 2) m, touches by finger on the surface, in the frame of a right hand; the
            newest last. At most `MOST` are kept.

    Attributes:
        layouts: (n, 5, 2) inches, each with its middle at 0, rounded to a thousandth.

    Raises:
        EncoderError: A layout is not finite, or is not that of a right hand.
    """

    def __init__(self, layouts: ArrayLike = ()) -> None:
        xy = np.asarray(layouts, float)
        xy = xy.reshape(0, len(FINGERS), 2) if xy.size == 0 else xy
        if xy.shape[1:] != (len(FINGERS), 2) or not np.isfinite(xy).all():
            raise EncoderError(
                "not layouts of five fingers",
                got=np.shape(layouts),
                expected="finite positions (n, 5, 2) in metres",
            )
        self.layouts: Array = np.array([_centred(one / METRES_PER_INCH) for one in xy[-MOST:]])
        self.layouts = self.layouts.reshape(-1, len(FINGERS), 2)
        for layout in self.layouts:
            if not like_a_hand(layout):
                raise EncoderError(
                    "no hand touches like this",
                    where="a layout of five fingers",
                    got=layout.round(2).tolist(),
                    expected=f"distances of {_LEAST:g} to {_WIDEST:g} inches between fingertips",
                    remedy="Forget the layouts of the profile, and touch with five fingers again",
                )
            if not of_right_hand(layout):
                raise EncoderError(
                    "this layout is of the other hand",
                    where="a layout of five fingers",
                    got=layout.round(2).tolist(),
                    expected="thumb to little finger clockwise, as a right hand's",
                    remedy="Forget the layouts of the profile, and touch with five fingers again",
                )

    def __len__(self) -> int:
        return len(self.layouts)

    @property
    def metres(self) -> Array:
        """The layouts (n, 5, 2) in m."""
        return self.layouts * METRES_PER_INCH

    def with_new(self, xy: Array) -> OwnLayouts:
        """These layouts and another one (5, 2) m by finger; the same object if it is not new."""
        layout = _centred(np.asarray(xy, float) / METRES_PER_INCH)
        if not (like_a_hand(layout) and of_right_hand(layout)):
            return self
        off = self.layouts - layout
        if len(off) and (squared_lengths(off.reshape(len(off), -1)) < 5 * NEW**2).any():
            return self
        grown = np.concatenate([self.layouts, layout[None]])
        return OwnLayouts(grown * METRES_PER_INCH)

    def log_evidence(self, xy: Array) -> Array:
        """Log weights (P,) of the labellings of contacts (k, 2) in m, k = 2 to 4; 0 is neutral."""
        density, log_far = self._densities[len(xy)]
        return functions.log_sum_exp(density.log_density(xy) - log_far, np.zeros(1))

    @cached_property
    def _densities(self) -> dict[int, tuple[LayoutDensity, float]]:
        z = self.layouts[..., 0] + 1j * self.layouts[..., 1]
        densities = {}
        for count in range(2, len(FINGERS)):
            parts = np.stack([z[:, fingers] for fingers in finger_sets(count)])
            parts = parts - parts.mean(axis=2, keepdims=True)
            density = LayoutDensity({count: parts}, {count: SHAPE})
            # The density of the widest kernel's middle, and that `FAR` standard deviations away.
            peak = -(2 * count - 2) * log(SHAPE.width * 2.5066282746310002) - log(len(z))
            densities[count] = density, peak - 0.5 * FAR[count - 2] ** 2
        return densities


def like_a_hand(layout: Array) -> bool:
    """True if five touches (5, 2) in inches are no nearer and no farther than a hand's."""
    i, j = np.triu_indices(len(FINGERS), 1)
    between = np.sqrt(squared_lengths(layout[i] - layout[j]))
    return bool((between > _LEAST).all() and (between < _WIDEST).all())


def of_right_hand(layout: Array) -> bool:
    """True if touches (5, 2), thumb first and y down, go clockwise about their middle.

    The signed area of their pentagon is positive; so it is for all layouts of simulated people.
    """
    x, y = layout.T.tolist()
    after = [*range(1, len(FINGERS)), 0]
    return total(x[i] * y[k] - x[k] * y[i] for i, k in enumerate(after)) > 0.0


def _centred(layout: Array) -> Array:
    middle = layout[0]
    for place in layout[1:]:
        middle = middle + place
    return np.round(layout - middle / len(FINGERS), 3)
