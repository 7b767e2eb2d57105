"""Training of the belief over labels; all settings are chosen by validation blocked by trial.

The criterion is the mean log probability of the true labelling in held-out trials, which, unlike
accuracy, penalises false certainty. Holding out random frames would leak, since neighbouring frames
are nearly equal. In a capture with one finger set per trial no fingers come and go, so histories
are simulated from held-out trials by hiding some of the fingers from the labeller for a while. It
gets every frame between two changes, since a moving hand gives more evidence. A scripted capture
gives every finger set equal time, so validation treats them as equally likely; in use they are not.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from importlib.resources import files
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from encoders.capture import Capture
from encoders.labels.belief import BeliefLabels
from encoders.labels.finger_order import order_shares
from encoders.labels.label_evidence import LabelEvidence, even_prior, natural_prior, normalised
from encoders.labels.labelling import true_row
from encoders.labels.layout_density import KernelShape, LayoutDensity, layouts_of
from encoders.labels.trained_belief import TrainedBelief, capture_digest
from encoders.regression.trained import builtin_capture
from encoders.validation import trial_folds
from models.arithmetic.arrays import Array
from models.errors import EncoderError
from models.frames import FINGERS

Event = dict[int, tuple[float, float]]

FOLDS = 5
JUDGED_FRAMES = 400
"""Held-out frames per number of fingers used for validation, spread evenly; neighbouring frames are
nearly equal."""

SHAPES: dict[str, tuple[float, ...]] = {
    "width": (0.05, 0.07, 0.1, 0.14),
    "turn": (0.035, 0.05, 0.07, 0.1, 0.14),
    "size": (0.035, 0.05, 0.07, 0.1),
}
"""Candidate kernel shapes; see `KernelShape` for the units. Wider ones would sometimes fit the
captured hand, but a layout that far off should count as another person's."""
ETAS = (0.0, 0.25, 0.5, 1.0)
STAYS = (0.0, 0.1, 0.2, 0.3, 0.4, 0.6, 0.8, 1.0)

MOST_LAYOUTS = 500
"""Layouts per finger set; limits the time of one evaluation. Twice as many gained nothing on
held-out trials."""


@dataclass(frozen=True)
class Report:
    """The settings chosen by validation, and their results on held-out trials.

    Attributes:
        shapes: Number of contacts -> shape of the kernels.
        eta: See `TrainedBelief`.
        stay: See `TrainedBelief`.
        log_probability: Mean log probability of the true labelling from a single frame, by number
            of fingers.
        accuracy: Share of frames labelled right from a single frame, by number of fingers.
        history: Mean log probability of the true labelling as fingers come, move and go, by eta
            and stay.
    """

    shapes: dict[int, KernelShape]
    eta: float
    stay: float
    log_probability: dict[int, float]
    accuracy: dict[int, float]
    history: dict[tuple[float, float], float]


def train_belief(
    capture: Capture, say: Callable[[str], None] = lambda line: None
) -> tuple[TrainedBelief, Report]:
    """Trains on a capture; the same capture gives the same belief.

    Args:
        capture: Labelled touches; every finger set of two or more must occur.
        say: Callback for progress messages.

    Raises:
        EncoderError: The capture has too few trials, or lacks a finger set.
    """
    folds = _Folds(capture)
    shapes = {count: _choose_shape(folds, count, say) for count in folds.all_layouts}
    held_out = folds.evidence(shapes)
    play = _Play(folds, held_out)
    eta, stay = 1.0, 0.0
    stay = max(STAYS, key=lambda share: play.score(eta, share, say))
    eta = max(ETAS, key=lambda share: play.score(share, stay, say))
    scores = {k: folds.scores(k, [e.log_posterior for e in held_out]) for k in shapes}
    evidence = LabelEvidence(folds.all_layouts, shapes, folds.order, natural_prior())
    return TrainedBelief(evidence, eta, stay, capture_digest(capture)), Report(
        shapes,
        eta,
        stay,
        {k: folds.judge(k, scores[k]) for k in shapes},
        {k: folds.accuracy(k, scores[k]) for k in shapes},
        play.scores,
    )


class _Folds:
    """Cross-validation folds over trials, with the held-out frames used for validation."""

    def __init__(self, capture: Capture) -> None:
        several = capture.down.sum(axis=1) >= 2
        capture = capture.select(several)
        if len(np.unique(capture.trial)) < FOLDS:
            raise EncoderError(
                "too few trials to validate with",
                got=len(np.unique(capture.trial)),
                expected=f"{FOLDS} or more",
            )
        self.fold = trial_folds(capture.trial, FOLDS)
        self.all_layouts = layouts_of(capture, MOST_LAYOUTS)
        self.order = order_shares(capture)
        self.layouts = [
            layouts_of(capture.select(self.fold != f), MOST_LAYOUTS) for f in range(FOLDS)
        ]
        self.capture = capture
        fingers = capture.down.sum(axis=1)
        self.judged, self.truth = {}, {}
        for count in self.all_layouts:
            frames = np.flatnonzero(fingers == count)
            self.judged[count] = frames[_evenly(len(frames), JUDGED_FRAMES)]
            self.truth[count] = [
                true_row(np.flatnonzero(capture.down[t])) for t in self.judged[count]
            ]

    def evidence(self, shapes: Mapping[int, KernelShape]) -> list[LabelEvidence]:
        """Evidence of each fold, learned from the other folds' trials. The order shares, three
        numbers, are those of all trials."""
        return [LabelEvidence(z, shapes, self.order, even_prior()) for z in self.layouts]

    def scores(self, count: int, ask: list[Callable[[Array], Array]]) -> list[Array]:
        """Scores of the validation frames with a given number of fingers, each from the evidence in
        `ask` that was not trained on its trial."""
        xy, down = self.capture.xy, self.capture.down
        return [ask[self.fold[t]](xy[t, down[t]]) for t in self.judged[count]]

    def judge(self, count: int, scores: list[Array]) -> float:
        """Mean log probability of the true labellings."""
        pairs = zip(scores, self.truth[count], strict=True)
        return float(np.mean([normalised(s)[t] for s, t in pairs]))

    def accuracy(self, count: int, scores: list[Array]) -> float:
        """Share of frames in which the true labelling is the most likely."""
        pairs = zip(scores, self.truth[count], strict=True)
        return float(np.mean([s.argmax() == t for s, t in pairs]))


def _evenly(count: int, most: int) -> NDArray[np.int64]:
    return np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(np.int64))


def _choose_shape(folds: _Folds, count: int, say: Callable[[str], None]) -> KernelShape:
    """Chooses a kernel shape by coordinate search: one setting after another, in two rounds."""
    tried: dict[KernelShape, float] = {}

    def value(shape: KernelShape) -> float:
        if shape not in tried:
            densities = [LayoutDensity({count: z[count]}, {count: shape}) for z in folds.layouts]
            tried[shape] = folds.judge(
                count, folds.scores(count, [d.log_density for d in densities])
            )
            say(f"{count} fingers, {shape}: log probability {tried[shape]:.4f}")
        return tried[shape]

    best = KernelShape()
    for _ in range(2):
        for name, choices in SHAPES.items():
            best = max((replace(best, **{name: c}) for c in choices), key=value)
    return best


class _Play:
    """Replays held-out trials in which fingers come and go."""

    def __init__(self, folds: _Folds, held_out: list[LabelEvidence]) -> None:
        capture = folds.capture
        evidence = [_Remembered(e) for e in held_out]
        self._takes: list[tuple[_Remembered, list[Event]]] = []
        for trial in np.unique(capture.trial):
            frames = np.flatnonzero(capture.trial == trial)
            events = list(histories(capture.select(frames), int(trial)))
            self._takes.append((evidence[folds.fold[frames[0]]], events))
        self.scores: dict[tuple[float, float], float] = {}

    def score(self, eta: float, stay: float, say: Callable[[str], None]) -> float:
        """Mean log probability of the truth at every frame."""
        if (eta, stay) not in self.scores:
            logs = []
            for evidence, events in self._takes:
                belief = BeliefLabels(TrainedBelief(evidence, eta, stay, ""))
                for event in events:
                    belief.assign(event, {})
                    logs.append(belief.log_probability({i: i % len(FINGERS) for i in event}))
            self.scores[eta, stay] = float(np.mean(logs))
            say(f"eta {eta:g}, stay {stay:g}: log probability {self.scores[eta, stay]:.4f}")
        return self.scores[eta, stay]


class _Remembered(LabelEvidence):
    """Evidence with cached results, since every setting asks for the same ones."""

    def __init__(self, evidence: LabelEvidence) -> None:
        self.__dict__.update(evidence.__dict__)
        self._answers: dict[bytes, Array] = {}

    def log_joint(self, xy: Array) -> Array:
        """See `LabelEvidence.log_joint`."""
        asked = xy.tobytes()
        if asked not in self._answers:
            self._answers[asked] = super().log_joint(xy)
        return self._answers[asked]


def histories(trial: Capture, seed: int) -> Iterator[Event]:
    """Contacts in every frame of one trial; an id modulo 5 is its finger.

    Uses the trial's own fingers where they come and go. Otherwise up to two fingers at a time are
    hidden, with changes at eight moments spread over the trial.
    """
    shown, ids = trial.down, trial.ids * len(FINGERS) + np.arange(len(FINGERS))
    if (shown == shown[0]).all():
        moments = _evenly(len(trial), 8)
        stretches = _coming_and_going(shown[0], len(moments), np.random.default_rng(seed))
        shown = stretches[np.searchsorted(moments, np.arange(len(trial)), side="right") - 1]
        born = np.cumsum(np.diff(shown.astype(int), axis=0, prepend=0) > 0, axis=0)
        ids = born * len(FINGERS) + np.arange(len(FINGERS))
    for t in range(len(trial)):
        yield {
            int(ids[t, f]): (float(trial.xy[t, f, 0]), float(trial.xy[t, f, 1]))
            for f in np.flatnonzero(shown[t])
        }


def _coming_and_going(
    down: NDArray[np.bool_], steps: int, rng: np.random.Generator
) -> NDArray[np.bool_]:
    """Booleans (steps, 5): the fingers shown to the labeller among those that are down."""
    fingers = np.flatnonzero(down)
    shown = np.zeros((steps, len(FINGERS)), bool)
    current = frozenset(rng.permutation(fingers)[:2].tolist())
    for step in range(steps):
        shown[step, list(current)] = True
        if len(fingers) > 2:
            turned = rng.permutation(fingers)[: rng.integers(1, 3)].tolist()
            following = current.symmetric_difference(turned)
            current = following if len(following) >= 2 else current
    return shown


def main() -> None:
    """Trains the built-in belief on the built-in capture and writes it into the package."""
    path = Path(str(files("encoders") / "data" / "belief.npz"))
    trained, report = train_belief(builtin_capture(), print)
    trained.save(path)
    print(report)
    print(f"{path}: {path.stat().st_size} bytes")


if __name__ == "__main__":
    main()
