"""Measures the time of a pose, a new contact and learning, beside other ways to the same.

One thread; every ratio is between times of the same run, and of equal answers where both answer the
same question. Times of other machines are not comparable: the paper printed 2.1 microseconds for a
pose, 66,190 for PCA-IK and five minutes for learning, on a machine that it does not name.

    python -m benchmarks.encoding                                    # a minute or two
    python -m benchmarks.encoding --subjects 100 --frames 1000000 --mink

`--subjects 100` simulates 100 subjects the first time (a quarter of an hour, kept in the user's
cache), `--mink` wants `pip install mink daqp`. Contacts are those of the simulated subject.
"""

from __future__ import annotations

import os

# Before NumPy: one thread, as beside a running simulation.
os.environ.setdefault("OMP_NUM_THREADS", "1")

import argparse
from collections.abc import Callable, Mapping
from copy import copy
from itertools import combinations_with_replacement
from time import perf_counter

import numpy as np
from rich.box import MARKDOWN
from rich.console import Console
from rich.table import Table
from scipy.linalg import lstsq
from scipy.spatial import cKDTree
from scipy.spatial.distance import cdist

from benchmarks.belief_peer import Contacts, plain_belief
from benchmarks.fitting import measured_apart
from benchmarks.ik_peers import Mink, farthest_tip
from benchmarks.machine import describe_machine
from benchmarks.many_poses import joint_poses
from benchmarks.side_by_side import Call, Comparison, agree
from encoders.labels.belief import builtin_belief
from encoders.labels.labelling import (
    PaperLabels,
    hypotheses,
    labelled_contact_vectors,
    nearest_neighbour,
)
from encoders.labels.nearest_neighbour import Search
from encoders.regression.pca_ik import PcaIkEncoder
from encoders.regression.polynomial import PolynomialEncoder
from encoders.regression.trained import builtin
from models.arithmetic.arrays import Array
from models.kinematics import Kinematics
from models.pose import JOINTS
from models.skeleton import ADULT
from models.surface import METRES_PER_INCH

QUESTIONS = 40
"""Different touches that every call is asked about; searches depend on what is sought."""
FEW = 8
"""The same for calls that take milliseconds."""
CLOSE = 1e-9
"""Largest difference between poses in NumPy and compiled poses."""


def questions(fingers: int) -> list[Contacts]:
    """Touches of frames of the built-in capture, a few millimetres off."""
    model, rng = builtin("paper"), np.random.default_rng(fingers)
    frames = np.flatnonzero(model.training_u[:, 10:].sum(axis=1) == fingers)
    found = []
    for u in model.training_u[rng.choice(frames, QUESTIONS)]:
        down = rng.permutation(np.flatnonzero(u[10:]))
        xy = u[:10].reshape(5, 2)[down] * METRES_PER_INCH + rng.normal(0, 0.003, (fingers, 2))
        found.append({i: (float(x), float(y)) for i, (x, y) in enumerate(xy)})
    return found


def hypotheses_of(contacts: Contacts) -> Array:
    """(P, 15) contact vectors of all labellings."""
    return labelled_contact_vectors(np.array(list(contacts.values())), hypotheses(len(contacts)))


def plain_pose(u: Array, coef: Array) -> Array:
    """A row of the design matrix, term by term, times the coefficients."""
    terms = [1.0, *u]
    terms += [u[i] * u[j] for i, j in combinations_with_replacement(range(len(u)), 2)]
    return np.array(terms) @ coef


def the_papers_encoder() -> PolynomialEncoder:
    """The built-in quadratic one."""
    encoder = builtin("paper").encoder
    assert isinstance(encoder, PolynomialEncoder)
    return encoder


def pose_rows(console: Console) -> None:
    """One pose, and 120 at once."""
    encoder = the_papers_encoder()
    prepared, compiled = encoder.for_contacts(), encoder.for_contacts(fast=True)
    table = Comparison(console, "A quadratic pose of 48 numbers")
    for fingers in (2, 3, 4, 5):
        rows = [hypotheses_of(c) for c in questions(fingers)]
        singles = [U[i % len(U)].copy() for i, U in enumerate(rows)]
        for U in rows:
            for other in (prepared, compiled):
                assert np.abs(other.predict(U) - encoder.predict(U)).max() < CLOSE
        u = singles[0]
        assert np.abs(plain_pose(u, encoder.coef_) - encoder.predict(u)).max() < CLOSE
        plain = Call("term by term", lambda u: plain_pose(u, encoder.coef_), singles)
        table.row(
            Call(f"one, {fingers} fingers: `for_contacts(fast=True)`", compiled, singles),
            Call("`for_contacts()`", prepared, singles),
            Call("`predict`", encoder.predict, singles),
            plain,
        )
        share = len(rows[0])
        table.row(
            Call(
                f"each of {share} at once, {fingers} fingers: `for_contacts(fast=True).predict`",
                compiled.predict,
                rows,
                share,
            ),
            Call("`for_contacts().predict`", prepared.predict, rows, share),
            Call("`predict`", encoder.predict, rows, share),
        )
    table.show()


def by_all_pairs(contacts: Contacts, degrees: Array) -> tuple[int, ...]:
    """The paper's rule by looking at every pair of guess and training pose."""
    guesses = np.rad2deg(builtin("paper").encoder.predict(hypotheses_of(contacts))[:, JOINTS])
    distance = cdist(guesses, degrees, "sqeuclidean")
    return tuple(hypotheses(len(contacts))[distance.min(axis=1).argmin()].tolist())


def by_tree(contacts: Contacts, tree: cKDTree) -> tuple[int, ...]:
    """The paper's rule by a k-d tree over the training poses."""
    guesses = np.rad2deg(builtin("paper").encoder.predict(hypotheses_of(contacts))[:, JOINTS])
    return tuple(hypotheses(len(contacts))[np.argmin(tree.query(guesses)[0])].tolist())


def rule_rows(console: Console) -> None:
    """The paper's rule, from contacts to labels, among the built-in capture's poses."""
    model = builtin("paper")
    degrees = np.rad2deg(model.training_pose[:, JOINTS])
    tree, plain, compiled = cKDTree(degrees), PaperLabels(model), PaperLabels(model, fast=True)
    table = Comparison(console, f"The paper's labels among {len(degrees)} training poses")
    for fingers in (2, 3, 4, 5):
        asked = questions(fingers)
        expected = [by_all_pairs(c, degrees) for c in asked]
        for rule in (plain, compiled):
            agree(
                "paper's rule", [labels_of(rule.assign(c, {}).labels, c) for c in asked], expected
            )
        table.row(
            Call(
                f"{fingers} fingers, {len(hypotheses(fingers))} labellings, `fast=True`",
                lambda c: compiled.assign(c, {}),
                asked,
            ),
            Call("without numba", lambda c: plain.assign(c, {}), asked),
            Call("all pairs (scipy cdist)", lambda c: by_all_pairs(c, degrees), asked[:FEW]),
            Call("scipy cKDTree", lambda c: by_tree(c, tree), asked[:FEW]),
        )
    table.show()


def search_rows(console: Console, subjects: int) -> None:
    """The same among the poses of many subjects: contact vectors, poses, exact nearest pose."""
    degrees = joint_poses(subjects, console)
    encoder = the_papers_encoder()
    ways: list[tuple[str, Callable[[Array], Array], Search]] = []
    for name, fast in (("`fast=True`", True), ("without numba", False)):
        start = perf_counter()
        search = nearest_neighbour(degrees, fast)
        console.print(f"{name}: {len(degrees)} poses made ready in {perf_counter() - start:.1f} s")
        ways.append((name, encoder.for_contacts(fast).predict, search))

    def with_way(way: int) -> Callable[[Contacts], tuple[int, int]]:
        _, poses, search = ways[way]
        return lambda q: search.closest(np.rad2deg(poses(hypotheses_of(q))[:, JOINTS]))[:2]

    def all_pairs(contacts: Contacts) -> tuple[int, int]:
        guesses = np.rad2deg(encoder.predict(hypotheses_of(contacts))[:, JOINTS])
        # A few queries at a time: all distances together would take 0.7 GB.
        distance = np.concatenate([cdist(q, degrees) for q in np.array_split(guesses, 10)])
        query, point = np.unravel_index(distance.argmin(), distance.shape)
        return int(query), int(point)

    table = Comparison(console, f"The paper's rule among {len(degrees)} poses, {subjects} subjects")
    for fingers in (2, 3, 4, 5):
        asked = questions(fingers)
        expected = [all_pairs(q) for q in asked[:2]]
        for way in (0, 1):
            agree("search", [with_way(way)(q) for q in asked[:2]], expected)
        table.row(
            Call(
                f"{fingers} fingers, {len(hypotheses(fingers))} labellings, {ways[0][0]}",
                with_way(0),
                asked,
            ),
            Call(ways[1][0], with_way(1), asked),
            Call("all pairs (scipy cdist)", all_pairs, asked[:1]),
        )
    table.show()


def belief_rows(console: Console) -> None:
    """A first look, and the last finger's landing beside the others: two looks in one."""
    table = Comparison(console, "Belief about labels, which needs no poses")
    belief = builtin_belief()
    belief.reset()

    def first(contacts: Contacts) -> tuple[int, ...]:
        # Beliefs are replaced and not changed in place, so a shallow copy keeps the first.
        return labels_of(copy(belief).assign(contacts, {}).labels, contacts)

    for fingers in (2, 3, 4, 5):
        asked = questions(fingers)
        joining = []
        for contacts in asked:
            before = copy(belief)
            before.assign(dict(list(contacts.items())[:-1]), {})
            joining.append((before, contacts))
        agree("belief", [first(c) for c in asked], [plain_belief(c) for c in asked])
        table.row(
            Call(f"{fingers} fingers, first look", first, asked),
            Call("kernels by their definition", plain_belief, asked[:FEW]),
        )
        table.row(
            Call(
                f"{fingers} fingers, one of them joins",
                lambda q: copy(q[0]).assign(q[1], {}),
                joining,
            )
        )
    table.show()


def labels_of(labels: Mapping[int, int], contacts: Contacts) -> tuple[int, ...]:
    return tuple(labels[i] for i in contacts)


def kinematics_rows(console: Console, mink: bool) -> None:
    """Encoder against inverse kinematics; how far fingertips are from their touches beside it."""
    model = builtin("paper")
    five = model.training_u[model.training_u[:, 10:].sum(axis=1) == 5]
    asked = list(five[np.random.default_rng(0).choice(len(five), QUESTIONS)])
    pca = PcaIkEncoder(settled=0.0).fit(model.training_u, model.training_pose)
    pose, mean, height = the_papers_encoder().for_contacts(), pca.mean_, pca.pad_height_
    calls = [
        Call("encoder, `for_contacts()`", pose, asked),
        Call("PCA-IK, 100 iterations", pca.predict, asked[:FEW]),
        Call("PCA-IK, 100 iterations, each of 256 at once", pca.predict, [five[:256]], 256),
    ]
    if mink:
        for iterations, start, where in (
            (20, lambda u: mean, "mean"),
            (100, lambda u: mean, "mean"),
            (5, pose, "encoder's"),
        ):
            way = Mink(iterations, start, height)
            calls.append(
                Call(f"mink, {iterations} iterations from the {where} pose", way, asked[:FEW])
            )
    table = Comparison(console, "Inverse kinematics, 5 fingers")
    table.row(*calls)
    table.show()
    kinematics = Kinematics(ADULT)
    console.print()
    for call in calls:
        if call.share == 1:
            off = [
                farthest_tip(np.asarray(call.function(u)), u, height, kinematics)
                for u in call.questions[:FEW]
            ]
            console.print(
                f"{call.name}: farthest fingertip {100 * np.median(off):.2f} cm off (median)"
            )


def fit_rows(console: Console, frames: int | None) -> None:
    """Learning from the built-in capture, and from many frames in a process of its own."""
    model = builtin("paper")
    U, Q = model.training_u, model.training_pose
    table = Comparison(console, f"Learning from {len(U)} frames")
    for degree, name in ((1, "linear"), (2, "quadratic"), (3, "cubic")):
        encoder = PolynomialEncoder(degree)
        X = encoder.fit(U, Q).terms(U)

        def direct(of: PolynomialEncoder) -> Array:
            terms = of.terms(U)
            scale = np.sqrt(np.mean(terms**2, axis=0))
            found = lstsq(terms / scale, Q, cond=1e-10, lapack_driver="gelsd")[0]
            return np.asarray(found / scale[:, None])

        apart = np.abs(X @ (direct(encoder) - encoder.coef_)).max()
        table.row(
            Call(f"{name}, rank {encoder.rank_} of {X.shape[1]}", lambda e: e.fit(U, Q), [encoder]),
            Call(f"singular values of all frames; poses differ by {apart:.0e}", direct, [encoder]),
        )
    table.show()
    if frames:
        console.print(f"\n## Learning from {frames} frames in blocks\n")
        many = Table("", "s", "most memory, MiB", "rank", box=MARKDOWN)
        for kind, degree, name in (
            ("contacts", 2, "quadratic, contact vectors"),
            ("contacts", 3, "cubic, contact vectors"),
            ("others", 2, "quadratic, 15 other numbers"),
        ):
            found = measured_apart(kind, degree, frames)
            numbers = [found["seconds"], found["peak_mib"], found["rank"]]
            many.add_row(name, f"{numbers[0]:.1f}", *(f"{n:.0f}" for n in numbers[1:]))
        console.print(many)


def main() -> None:
    """Prints the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--subjects", type=int, nargs="*", default=[])
    parser.add_argument("--frames", type=int)
    parser.add_argument("--mink", action="store_true")
    asked = parser.parse_args()
    console = Console(width=150)
    console.print(describe_machine())
    pose_rows(console)
    rule_rows(console)
    for subjects in asked.subjects:
        search_rows(console, subjects)
    belief_rows(console)
    fit_rows(console, asked.frames)
    kinematics_rows(console, asked.mink)


if __name__ == "__main__":
    main()
