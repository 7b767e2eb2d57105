"""Evidence from the circular order of the fingers, which hardly ever cross.

From thumb to little finger, the touches of a right hand go clockwise about their middle (on a
surface with y down: towards growing angles). The order is the same for a turned or opened hand and
for unseen people; two touches have no order.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from encoders.capture import Capture
from encoders.labels.labelling import hypotheses
from models.arithmetic import functions
from models.arithmetic.arrays import Array
from models.frames import FINGERS

ORDERED_COUNTS = range(3, len(FINGERS) + 1)
"""Numbers of contacts that have an order."""


def in_order(xy: Array) -> NDArray[np.bool_]:
    """Booleans (P,): the labellings of `hypotheses(k)` in which contacts (k, 2) are in the fingers'
    order."""
    count = len(xy)
    centred = xy - xy.mean(axis=0)
    rank = np.argsort(np.argsort(functions.atan2(centred[:, 1], centred[:, 0]), kind="stable"))
    # Ranks in the order of the fingers; from the first finger on, each is the next one's neighbour.
    round_ = rank[np.argsort(hypotheses(count), axis=1)]
    steps = (round_ - round_[:, :1]) % count
    result: NDArray[np.bool_] = (steps == np.arange(count)).all(axis=1)
    return result


def order_shares(capture: Capture) -> dict[int, float]:
    """Shares of frames whose touches are in the fingers' order, by number of contacts, 3 to 5.

    Estimated by Laplace's rule of succession, so that they are never 0 or 1.
    """
    shares = {}
    touching = capture.down.sum(axis=1)
    for count in ORDERED_COUNTS:
        frames = np.flatnonzero(touching == count)
        # The first of all labellings is 0, 1, .. k - 1: contacts in the order of their fingers.
        ordered = [in_order(capture.xy[t, capture.down[t]])[0] for t in frames]
        shares[count] = (sum(ordered) + 1.0) / (len(frames) + 2.0)  # any order: whole numbers
    return shares
