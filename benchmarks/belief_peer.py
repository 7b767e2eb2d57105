"""The belief about labels at one look, from its definition: a peer to measure against."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from encoders.labels.belief import builtin_trained_belief
from encoders.labels.finger_order import in_order
from encoders.labels.label_evidence import (
    STRANGER,
    STRANGER_SHARE,
    STRANGER_THUMB_AND_NEXT,
    natural_prior,
)
from encoders.labels.labelling import hypotheses
from encoders.labels.layout_density import KernelShape, finger_sets
from models.surface import METRES_PER_INCH

Contacts = dict[int, tuple[float, float]]


def plain_belief(contacts: Contacts) -> tuple[int, ...]:
    """The likeliest labels at one look, kernel by kernel from the definition."""
    evidence = builtin_trained_belief().evidence
    layouts, count = evidence.layouts[len(contacts)], len(contacts)
    xy = np.array(list(contacts.values())) / METRES_PER_INCH
    z = xy[:, 0] + 1j * xy[:, 1]
    z = z - z.mean()
    ordered = in_order(xy)
    habit = natural_prior(STRANGER_THUMB_AND_NEXT)[count]
    best, chosen = -np.inf, ()
    for row, labels in enumerate(hypotheses(count)):
        number = finger_sets(count).index(tuple(np.sort(labels)))
        x = z[np.argsort(labels)]
        captured = plain_density(x, layouts[number], evidence.shapes[count])
        stranger = plain_density(x, layouts[number, ::4], STRANGER)
        if count > 2:
            share = evidence.order[count]
            stranger += np.log(share if ordered[row] else 1.0 - share)
        value = np.logaddexp(
            np.log((1.0 - STRANGER_SHARE) * evidence.prior[count][number]) + captured,
            np.log(STRANGER_SHARE * habit[number]) + stranger,
        )
        if value > best:
            best, chosen = value, tuple(labels.tolist())
    return chosen


def plain_density(
    x: NDArray[np.complex128], p: NDArray[np.complex128], shape: KernelShape
) -> float:
    """Log density of a layout (k,) by kernels about layouts (M, k)."""
    r = np.linalg.norm(p, axis=1)
    c = (p.conj() * x).sum(axis=1) / r
    across = np.sum(np.abs(x - p) ** 2, axis=1) - (c.real - r) ** 2 - c.imag**2
    size, turn = shape.width**2 + shape.size**2 * r**2, shape.width**2 + shape.turn**2 * r**2
    exponent = across / shape.width**2 + (c.real - r) ** 2 / size + c.imag**2 / turn
    constant = (2 * len(x) - 4) * np.log(shape.width**2) + np.log(size * turn)
    return float(np.logaddexp.reduce(-0.5 * (exponent + constant)) - np.log(len(p)))
