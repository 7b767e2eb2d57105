"""What a pose and a decision about labels cost, beside a plain way of computing the same.

Every line is the median over questions asked many times in one thread; the ratio is against the
peer in the same run, and both give the same answer. Times of other machines are not comparable:
the paper printed 0.0021 ms for a pose, on a machine that it does not name.

    OMP_NUM_THREADS=1 python -m benchmarks.encoding
"""

from __future__ import annotations

import os

# Before NumPy: one thread, as beside a running simulation.
os.environ.setdefault("OMP_NUM_THREADS", "1")

import time
from collections.abc import Callable, Sequence
from copy import copy
from itertools import combinations_with_replacement

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table
from scipy.spatial import cKDTree
from scipy.spatial.distance import cdist

from benchmarks.machine import describe_machine
from encoders.belief import builtin_belief
from encoders.finger_order import in_order
from encoders.label_evidence import STRANGER, STRANGER_SHARE
from encoders.labelling import PaperLabels, hypotheses, labelled_contact_vectors
from encoders.layout_density import KernelShape, finger_sets
from encoders.trained import builtin
from models.pose import JOINTS
from models.surface import METRES_PER_INCH

Array = NDArray[np.float64]
Contacts = dict[int, tuple[float, float]]

QUESTIONS = 40
"""Different touches that every decision is asked about; searches depend on what is sought."""
BUDGET = 1.0
"""s, for every line and again for its peer."""


def medians(call: Callable[[int], object], peer: Callable[[int], object]) -> tuple[float, float]:
    """s, medians of two calls that take turns, so that a busy moment meets both."""
    call(0), peer(0)
    durations: tuple[list[float], list[float]] = ([], [])
    start, question = time.perf_counter(), 0
    while time.perf_counter() - start < 2 * BUDGET or question < QUESTIONS:
        for which, found in ((call, durations[0]), (peer, durations[1])):
            before = time.perf_counter()
            which(question % QUESTIONS)
            found.append(time.perf_counter() - before)
        question += 1
    return float(np.median(durations[0])), float(np.median(durations[1]))


def plain_pose(u: Array, coef: Array) -> Array:
    """A row of the design matrix, term by term, times the coefficients."""
    terms = [1.0, *u]
    terms += [u[i] * u[j] for i, j in combinations_with_replacement(range(len(u)), 2)]
    return np.array(terms) @ coef


def questions(fingers: int) -> list[Contacts]:
    """Touches of frames of the built-in capture's poses, a few millimetres off."""
    model, rng = builtin("paper"), np.random.default_rng(fingers)
    frames = np.flatnonzero(model.training_u[:, 10:].sum(axis=1) == fingers)
    found = []
    for u in model.training_u[rng.choice(frames, QUESTIONS)]:
        down = rng.permutation(np.flatnonzero(u[10:]))
        xy = u[:10].reshape(5, 2)[down] * METRES_PER_INCH + rng.normal(0, 0.003, (fingers, 2))
        found.append({i: (float(x), float(y)) for i, (x, y) in enumerate(xy)})
    return found


def by_all_pairs(contacts: Contacts, degrees: Array) -> tuple[int, ...]:
    """The paper's rule by looking at every pair of guess and training pose."""
    xy, labels = np.array(list(contacts.values())), hypotheses(len(contacts))
    guesses = builtin("paper").encoder.predict(labelled_contact_vectors(xy, labels))
    distance = cdist(np.rad2deg(guesses[:, JOINTS]), degrees, "sqeuclidean")
    return tuple(labels[distance.min(axis=1).argmin()].tolist())


def by_tree(contacts: Contacts, tree: cKDTree) -> tuple[int, ...]:
    """The paper's rule by a k-d tree over the training poses."""
    xy, labels = np.array(list(contacts.values())), hypotheses(len(contacts))
    guesses = builtin("paper").encoder.predict(labelled_contact_vectors(xy, labels))
    distance, _ = tree.query(np.rad2deg(guesses[:, JOINTS]))
    return tuple(labels[np.argmin(distance)].tolist())


def plain_belief(contacts: Contacts) -> tuple[int, ...]:
    """The likeliest labels at one look, kernel by kernel from the definition."""
    evidence = builtin_belief().evidence
    layouts, count = evidence.layouts[len(contacts)], len(contacts)
    xy = np.array(list(contacts.values())) / METRES_PER_INCH
    z = xy[:, 0] + 1j * xy[:, 1]
    z = z - z.mean()
    ordered = in_order(xy)
    best, chosen = -np.inf, ()
    for row, labels in enumerate(hypotheses(count)):
        number = finger_sets(count).index(tuple(np.sort(labels)))
        x = z[np.argsort(labels)]
        captured = plain_density(x, layouts[number], evidence.shape)
        stranger = plain_density(x, layouts[number, ::4], STRANGER)
        if count > 2:
            share = evidence.order[count]
            stranger += np.log(share if ordered[row] else 1.0 - share)
        value = np.log(evidence.prior[count][number]) + np.logaddexp(
            np.log(1.0 - STRANGER_SHARE) + captured, np.log(STRANGER_SHARE) + stranger
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


Row = Callable[[str, str, Callable[[int], object], Callable[[int], object]], None]


def belief_rows(fingers: int, row: Row) -> None:
    """A first look, and the last finger's landing beside the others: two looks in one."""
    asked, belief = questions(fingers), builtin_belief()
    one_less = []
    for contacts in asked:
        belief.reset()
        belief.assign(dict(list(contacts.items())[:-1]), {})
        # Beliefs are replaced and not changed in place, so a shallow copy keeps this one.
        one_less.append(copy(belief))
    belief.reset()

    def first(i: int) -> tuple[int, ...]:
        return labels_of(copy(belief).assign(asked[i], {}).labels, asked[i])

    peer = "kernels by their definition"
    agree("belief", [first(i) for i in range(QUESTIONS)], [plain_belief(q) for q in asked])
    row(f"belief, {fingers} fingers, first look", peer, first, lambda i: plain_belief(asked[i]))
    row(
        f"belief, {fingers} fingers, one joins",
        f"{peer} (one look)",
        lambda i: copy(one_less[i]).assign(asked[i], {}),
        lambda i: plain_belief(asked[i]),
    )


def rule_rows(fingers: int, row: Row) -> None:
    """The paper's rule."""
    model, asked = builtin("paper"), questions(fingers)
    rule, degrees = PaperLabels(model), np.rad2deg(model.training_pose[:, JOINTS])
    ours = [labels_of(rule.assign(q, {}).labels, q) for q in asked]
    agree("paper's rule", ours, [by_all_pairs(q, degrees) for q in asked])
    name = f"paper's rule, {fingers} fingers, {len(hypotheses(fingers))} labellings"
    row(
        name,
        "all pairs (scipy cdist)",
        lambda i: rule.assign(asked[i], {}),
        lambda i: by_all_pairs(asked[i], degrees),
    )
    if fingers == 5:
        tree = cKDTree(degrees)
        row(
            name,
            "scipy cKDTree",
            lambda i: rule.assign(asked[i], {}),
            lambda i: by_tree(asked[i], tree),
        )


def labels_of(labels: dict[int, int], contacts: Contacts) -> tuple[int, ...]:
    return tuple(labels[i] for i in contacts)


def agree(name: str, ours: Sequence[object], theirs: Sequence[object]) -> None:
    """A ratio of times is worth something only between equal answers."""
    same = sum(a == b for a, b in zip(ours, theirs, strict=True))
    if same < len(ours):
        raise SystemExit(f"{name}: only {same} of {len(ours)} answers agree with the peer's")


def main() -> None:
    """Prints the table."""
    console = Console(width=118)
    console.print(describe_machine())
    model, table = builtin("paper"), Table("", "median, us", "peer", "peer, us", "ratio")

    def row(
        name: str, peer: str, call: Callable[[int], object], plain: Callable[[int], object]
    ) -> None:
        ours, theirs = medians(call, plain)
        table.add_row(name, f"{1e6 * ours:.1f}", peer, f"{1e6 * theirs:.1f}",
                      f"{theirs / ours:.1f}")  # fmt: skip

    U = model.training_u[np.random.default_rng(0).integers(0, len(model.training_u), QUESTIONS)]
    coef, encoder = model.encoder.coef_, model.encoder
    assert np.allclose(encoder.predict(U[0]), plain_pose(U[0], coef))
    row("one quadratic pose", "design matrix term by term",
        lambda i: encoder.predict(U[i]), lambda i: plain_pose(U[i], coef))  # fmt: skip

    batch = labelled_contact_vectors(np.array(list(questions(5)[0].values())), hypotheses(5))
    row(
        "120 quadratic poses at once",
        "one by one",
        lambda i: encoder.predict(batch),
        lambda i: [encoder.predict(u) for u in batch],
    )

    for fingers in (2, 3, 4, 5):
        rule_rows(fingers, row)
    for fingers in (2, 3, 4, 5):
        belief_rows(fingers, row)
    console.print(f"{len(model.training_pose)} training poses of the simulated subject")
    console.print(table)


if __name__ == "__main__":
    main()
