"""Measures names on real hands: recordings of a Leap, their fingertips laid on a plane as touches.

    python -m benchmarks.real_hands ../shared/data/leap/*.json.lz

No person touched a tablet here. A Leap of the second or third software says which finger is which
and where its tip is; the tips are projected on the plane of the palm. Every set of two to five
fingers is looked at once, without history, and turned by up to 20 degrees: fingers in the air are
no touches, and people do not put down every set equally often. So this is a hard test, and the
only one with hands that no simulation made.

The last rows give what one earlier touch with all five fingers is worth: the middle frame of the
same recording.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from itertools import combinations
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from encoders.labels.belief import BeliefLabels, builtin_belief
from encoders.labels.own_layouts import OwnLayouts
from encoders.labels.population_belief import builtin_population_belief
from models.arithmetic.arrays import Array
from models.errors import InputError
from models.frames import FINGERS, TrackedHand
from sandbox.devices.leap.leap_file import read_leap

MIDDLE = (0.15, 0.10)
"""m, where the palm lies on the tablet."""
TURNED = 20.0
"""Degrees by which a hand is turned at most."""
_ALL = range(len(FINGERS))

Maker = Callable[[OwnLayouts | None], BeliefLabels]


def layout(hand: TrackedHand) -> Array | None:
    """Fingertips on the plane of the palm, as a right hand's on a tablet.

    Returns:
        (5, 2) m in the surface frame (x right, y towards the person), about the palm; None where
        the device does not name all five fingers.
    """
    ends = {f.finger: f.end for f in hand.fingers}
    if not set(_ALL) <= set(ends):
        return None
    ahead, normal = np.array(hand.direction), np.array(hand.normal)
    across = np.cross(ahead, normal)
    away = np.array([ends[finger] for finger in _ALL]) - np.array(hand.palm)
    places = np.stack([away @ across, -(away @ ahead)], axis=1)
    if places[0, 0] > places[-1, 0]:
        places[:, 0] *= -1.0
    return places


def right(layouts: Sequence[Array], make: Maker, known: OwnLayouts | None) -> dict[int, float]:
    """Share of sets of fingers that are named right, by the number of fingers."""
    rng = np.random.default_rng(0)
    shares = {}
    for count in range(2, len(FINGERS) + 1):
        named = []
        for places in layouts:
            for fingers in combinations(_ALL, count):
                angle = np.radians(rng.uniform(-TURNED, TURNED))
                turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
                xy = places @ turn.T + MIDDLE
                ids = rng.permutation(count).tolist()
                touches = {i: tuple(xy[f].tolist()) for i, f in zip(ids, fingers, strict=True)}
                truth = dict(zip(ids, fingers, strict=True))
                named.append(make(known).assign(touches, {}).labels == truth)
        shares[count] = float(np.mean(named))
    return shares


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("recordings", type=Path, nargs="+", help="of a Leap that names fingers")
    parser.add_argument("--every", type=int, default=6, help="takes every Nth frame")
    options = parser.parse_args()
    table = Table(title="real hands in the air as touches: % of sets of fingers named right")
    for column in ("recording", "names by", "layouts", "2", "3", "4", "5"):
        table.add_column(column, justify="left" if len(column) > 7 else "right")
    makers: dict[str, Maker] = {
        "population": builtin_population_belief,
        "history": lambda known: builtin_belief(),
    }
    for path in options.recordings:
        try:
            frames = read_leap(path).frames[:: options.every]
        except InputError as error:
            sys.exit(f"{error}\n`sandbox leap formats` says where others have put recordings")
        seen = [layout(hand) for frame in frames for hand in frame.hands]
        layouts = [places for places in seen if places is not None]
        if not layouts:
            table.add_row(path.name, "no frame with five named fingers")
            continue
        own = OwnLayouts(np.array(layouts[len(layouts) // 2])[None] + MIDDLE)
        rows: list[tuple[str, Maker, OwnLayouts | None]] = [
            (name, make, None) for name, make in makers.items()
        ]
        rows.append(("population, after five", builtin_population_belief, own))
        for name, make, known in rows:
            shares = right(layouts, make, known)
            cells = [f"{100 * share:.0f}" for share in shares.values()]
            table.add_row(path.name, name, str(len(layouts)), *cells)
    Console(width=110).print(table)


if __name__ == "__main__":
    main()
