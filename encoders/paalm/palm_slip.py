"""How far the device sees a palm too far forward, from what its fingers can do.

The first software's centre of the palm wanders towards the fingers: by 6 cm where a hand leaves the
view of the real recording v1-hands. Each finger then seems to end too near to its knuckle without
being lowered, which only a claw could do. All fingers say the same, so their median is the slip.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import atan2, degrees, sqrt

import numpy as np

from encoders.paalm.chain import FingerChain
from models.frames import Vector

LEVEL = 10.0
"""Degrees below the palm's direction to which a straight finger may point."""


def slip(fingers: Sequence[tuple[FingerChain, Vector]]) -> float:
    """The slip of a palm, m forward; negative if it is seen too far back.

    A finger that bends is lowered about as much as its PIP is bent.

    Args:
        fingers: Chain and tip, m from the knuckle in palm axes, of every finger that is seen, the
            thumb left out.
    """
    slips = []
    for chain, (x, y, z) in fingers:
        lowered = max(degrees(atan2(-z, max(y, 1e-6))) - LEVEL, 0.0)
        usual = chain.chord(min(lowered, chain.limits.pip[1]))
        aside = sqrt(x * x + z * z)
        slips.append(sqrt(max(usual * usual - aside * aside, 0.0)) - y)
    return float(np.median(slips)) if slips else 0.0
