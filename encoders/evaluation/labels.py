"""Accuracy of labels: the paper's Table 2, and single contacts.

A labeller gets contacts in a random order and with random ids, so that neither the order in which a
capture stores fingers nor the order of their ids reveals labels. It is called at every frame. A
labeller without history is reset before each frame, a labeller with history before each take. A
frame counts as right if all its contacts are right.

Two cases of a single contact, which the captures of the simulated subjects and of the paper lack:

- `stayed`: just before the set of contacts changes, and at the end of a take, all contacts but one
  are removed, each contact remaining in turn. With history, the remaining contact has its last
  label, since the program does not change the label of a contact. Without history, the contact is
  labelled alone. Frames of the capture with a single contact count here, too.
- `first`: each contact of the first frame of a take is labelled alone, without earlier frames.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from encoders.capture import Capture
from encoders.labels.labelling import Labeller
from models.arithmetic import Array

Contacts = dict[int, tuple[float, float]]

COUNTS = (1, 2, 3, 4, 5)
SEVERAL = COUNTS[1:]
"""Numbers of fingers in the column `all` of Table 2."""


@dataclass(frozen=True)
class Verdicts:
    """Correctness of labels, with their takes.

    Attributes:
        right: (n,) booleans, true if the label is right.
        trial: (n,) int, take of every label.
    """

    right: NDArray[np.bool_]
    trial: NDArray[np.int64]


@dataclass(frozen=True)
class OwnLabels:
    """Labels of a capture by a labeller.

    Attributes:
        xy: (T, 5, 2) m, contacts by the labeller's labels, NaN for labels without a contact.
        right: (T,) booleans, true if all contacts of the frame have their true label.
        stayed: Results for single contacts that stayed (see the module).
        first: Results for single contacts that came first (see the module).
    """

    xy: Array
    right: NDArray[np.bool_]
    stayed: Verdicts
    first: Verdicts


def own_labels(
    capture: Capture,
    make: Callable[[], Labeller],
    history: bool,
    seed: int = 0,
    progress: Callable[[float], None] | None = None,
) -> OwnLabels:
    """Labels a capture.

    Args:
        capture: The capture; its labels are used only for comparison.
        make: Creates a labeller without contacts.
        history: True if the labeller may use earlier frames of a take.
        seed: Seed of the shuffling.
        progress: Called with the share done, 0 to 1.
    """
    rng = np.random.default_rng(seed)
    labeller, alone = make(), make()
    xy = np.full_like(capture.xy, np.nan)
    right = np.zeros(len(capture), bool)
    stayed: list[tuple[bool, int]] = []
    first: list[tuple[bool, int]] = []
    for trial, frames in takes(capture):
        labeller.restart()
        ids = _drawn_ids(rng, capture.ids[frames])
        truth: dict[int, int] = {}
        labels: Mapping[int, int] = {}
        places: Contacts = {}
        for row, frame in enumerate(frames):
            fingers = np.flatnonzero(capture.down[frame])
            now = {ids[int(capture.ids[frame, f])]: int(f) for f in fingers}
            if now.keys() != truth.keys():
                known = labels if history else None
                stayed += [(good, trial) for good in _left_alone(alone, truth, places, known)]
            truth = now
            places = _shuffled(rng, truth, capture.xy[frame])
            if row == 0:
                for contact, finger in truth.items():
                    named = _ask(alone, {contact: places[contact]})
                    first.append((named[contact] == finger, trial))
            if not history:
                labeller.reset()
            labels = labeller.assign(places, {}).labels
            right[frame] = labels == truth
            if len(truth) == 1:
                stayed.append((bool(right[frame]), trial))
            for contact, label in labels.items():
                xy[frame, label] = places[contact]
        known = labels if history else None
        stayed += [(good, trial) for good in _left_alone(alone, truth, places, known)]
        if progress:
            progress((int(frames[-1]) + 1) / len(capture))
    return OwnLabels(xy, right, _verdicts(stayed), _verdicts(first))


def takes(capture: Capture) -> Iterator[tuple[int, NDArray[np.intp]]]:
    """Yields number and frame indices of every take, in the order of the capture."""
    starts = np.flatnonzero(np.diff(capture.trial, prepend=capture.trial[0] - 1))
    for frames in np.split(np.arange(len(capture)), starts[1:]):
        yield int(capture.trial[frames[0]]), frames


def _left_alone(
    labeller: Labeller, truth: dict[int, int], places: Contacts, known: Mapping[int, int] | None
) -> Iterator[bool]:
    """Yields, for each contact, whether its label is right after all other contacts left.

    The label is taken from `known`. If that is None, the labeller labels the contact alone.
    """
    if len(truth) < 2:
        return
    for contact, finger in truth.items():
        label = _ask(labeller, {contact: places[contact]}) if known is None else known
        yield label[contact] == finger


def _ask(labeller: Labeller, contacts: Contacts) -> Mapping[int, int]:
    labeller.reset()
    return labeller.assign(contacts, {}).labels


def _drawn_ids(rng: np.random.Generator, ids: NDArray[np.int64]) -> dict[int, int]:
    """Id in the capture -> random id that replaces it, for the contacts of a take."""
    known = np.unique(ids[ids >= 0])
    return dict(zip(known.tolist(), rng.permutation(len(known)).tolist(), strict=True))


def _shuffled(rng: np.random.Generator, truth: dict[int, int], xy: Array) -> Contacts:
    """Contacts of a frame in a random order."""
    order = rng.permutation(np.array(list(truth)))
    return {int(i): (float(xy[truth[i], 0]), float(xy[truth[i], 1])) for i in order.tolist()}


def _verdicts(pairs: list[tuple[bool, int]]) -> Verdicts:
    return Verdicts(
        np.array([right for right, _ in pairs], bool),
        np.array([trial for _, trial in pairs], np.int64),
    )
