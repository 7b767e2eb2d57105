"""Training of the labeller of fingers: a network that labels contacts, on layouts of a population.

The loss is minus the log probability of the true labelling. All layouts of a batch have the same
number of contacts. The set of fingers and the person of each layout are drawn with equal
probability, and each layout is rotated, scaled and disturbed a little. A subset of the touching
fingers also serves as a layout, since fingers rest beside other fingers much as they do alone.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import log, sqrt
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from encoders.capture import Capture
from encoders.labels.belief import PopulationBelief, from_weights
from encoders.labels.labelling import finger_sets, hypotheses
from encoders.labels.pair_network import (
    BIASES,
    CONTACT_FEATURES,
    PAIR_FEATURES,
    SHAPES,
    contact_features,
    ordered_pairs,
    pair_features,
    score_places,
)
from models.arithmetic import Array
from models.errors import EncoderError
from training.population.surface_people import surface_person

Weights = dict[str, NDArray[np.float32]]


@dataclass(frozen=True)
class TrainingSettings:
    """Settings of the training.

    Attributes:
        sizes: Sizes of the hidden layers; see `pair_network.SHAPES`.
        steps: Number of batches.
        batch: Number of layouts in a batch.
        rate: Largest step size of Adam; it falls to 0 along half a cosine.
        decay: Decay of the weights per step, as a share of the step size.
        turn: Standard deviation (rad) of the random rotation of a layout.
        growth: Standard deviation of the logarithm of the random factor on a layout's size.
        tremble: Standard deviation (m, per axis) of the noise on every contact.
        exact: Share of layouts that contain all touching fingers; the others are subsets of them,
            or contain all.
        seed: Seed of weights and batches.
    """

    sizes: Mapping[str, int]
    steps: int = 8000
    batch: int = 384
    rate: float = 3e-3
    decay: float = 0.01
    turn: float = 0.06
    growth: float = 0.03
    tremble: float = 0.0007
    exact: float = 0.5
    seed: int = 0


DEFAULT = TrainingSettings({"g": 48, "context": 32, "f": 64, "h": 48})
"""Settings of the network that ships."""


class SeenLayouts(Protocol):
    """Contract for the layouts of a person. A `Capture` fulfils it.

    Attributes:
        xy: (T, 5, 2) m, touches by finger; NaN for fingers that do not touch.
        down: True (T, 5) for touching fingers.
    """

    @property
    def xy(self) -> Array: ...

    @property
    def down(self) -> NDArray[np.bool_]: ...


class LayoutPool:
    """Layouts of people, by number of contacts and set of fingers.

    Args:
        people: The layouts of each person.
        weights: Weight of every person in draws; by default all weights are equal.
    """

    def __init__(
        self, people: Sequence[SeenLayouts], weights: Sequence[float] | None = None
    ) -> None:
        self._xy = np.concatenate([p.xy for p in people])
        down = np.concatenate([p.down for p in people])
        given = np.ones(len(people)) if weights is None else np.asarray(weights, float)
        frames = np.array([len(p.xy) for p in people])
        share = np.repeat(given / frames, frames)
        self._pools: dict[tuple[int, int, bool], tuple[NDArray[np.intp], Array]] = {}
        for count in range(2, 6):
            for number, fingers in enumerate(finger_sets(count)):
                whole = down[:, fingers].all(axis=1)
                for exact in (False, True):
                    rows = np.flatnonzero(whole & (down.sum(axis=1) == count) if exact else whole)
                    self._pools[count, number, exact] = rows, np.cumsum(share[rows])

    def draw(
        self, rng: np.random.Generator, count: int, n: int, exact: float
    ) -> tuple[Array, NDArray[np.intp]]:
        """Draws layouts.

        Args:
            rng: Source of randomness.
            count: Number of contacts in a layout.
            n: Number of layouts.
            exact: Share of layouts that are drawn from frames in which no other finger touches.

        Returns:
            Layouts (n, count, 2) m with contacts in random order, and their fingers (n, count).
        """
        sets = finger_sets(count)
        chosen = rng.integers(len(sets), size=n)
        alone = rng.random(n) < exact
        xy, fingers = np.empty((n, count, 2)), np.empty((n, count), np.intp)
        for number, members in enumerate(sets):
            for only in (False, True):
                at = np.flatnonzero((chosen == number) & (alone == only))
                rows, share = self._pools[count, number, only]
                picked = rows[np.searchsorted(share, rng.random(len(at)) * share[-1])]
                xy[at] = self._xy[picked][:, members]
                fingers[at] = members
        order = rng.permuted(np.tile(np.arange(count), (n, 1)), axis=1)
        row = np.arange(n)[:, None]
        return xy[row, order], fingers[row, order]


def initial_weights(
    rng: np.random.Generator, sizes: Mapping[str, int]
) -> dict[str, NDArray[np.float32]]:
    """Random weights to begin training with (He and others 2015), single precision."""
    weights = {}
    for name, shape in SHAPES.items():
        rows, columns = (sizes[a] if isinstance(a, str) else a for a in shape)
        inputs = sizes["context"] + 2 * CONTACT_FEATURES + PAIR_FEATURES
        fan = inputs if name.startswith("f_") else rows
        scale = 0.1 * log(2.0) if name == "f3" else 1.0
        drawn = rng.normal(0, scale * sqrt(2.0 / fan), (rows, columns))
        weights[name] = drawn.astype(np.float32)
        if name in BIASES:
            weights[BIASES[name]] = np.zeros(columns, np.float32)
    return weights


def train_network(
    pool: LayoutPool,
    settings: TrainingSettings = DEFAULT,
    say: Callable[[int, float], None] = lambda step, loss: None,
) -> Weights:
    """Trains a network; equal arguments give equal weights on one machine.

    Args:
        pool: Layouts to learn.
        settings: Sizes and schedule.
        say: Called every 100 steps with the step and the mean loss of these 100 steps.
    """
    rng = np.random.default_rng(settings.seed)
    weights = initial_weights(rng, settings.sizes)
    first = {k: np.zeros_like(v) for k, v in weights.items()}
    second = {k: np.zeros_like(v) for k, v in weights.items()}
    losses = []
    for step in range(1, settings.steps + 1):
        count = (2, 3, 4, 2, 3, 5)[step % 6]
        xy, fingers = pool.draw(rng, count, settings.batch, settings.exact)
        loss, slopes = loss_and_slopes(weights, _varied(rng, xy, settings), fingers)
        losses.append(loss)
        rate = settings.rate * 0.5 * (1 + np.cos(np.pi * step / settings.steps))
        rate *= min(1.0, step / 200)
        for name, slope in slopes.items():
            first[name] += 0.1 * (slope - first[name])
            second[name] += 0.005 * (slope * slope - second[name])
            mean = first[name] / (1 - 0.9**step)
            square = second[name] / (1 - 0.995**step)
            weights[name] -= np.float32(rate) * (
                mean / (np.sqrt(square) + 1e-8) + np.float32(settings.decay) * weights[name]
            )
        if step % 100 == 0:
            say(step, float(np.mean(losses)))
            losses.clear()
    return weights


def _varied(rng: np.random.Generator, xy: Array, settings: TrainingSettings) -> Array:
    n = len(xy)
    angle = settings.turn * rng.normal(size=n)
    factor = np.exp(settings.growth * rng.normal(size=n))
    z = (xy[..., 0] + 1j * xy[..., 1]) * (factor * np.exp(1j * angle))[:, None]
    turned = np.stack([z.real, z.imag], axis=-1)
    return np.asarray(turned + settings.tremble * rng.normal(size=turned.shape))


def loss_and_slopes(
    weights: Weights, xy: Array, fingers: NDArray[np.intp]
) -> tuple[float, Weights]:
    """Mean loss of a batch, and its derivatives with respect to all weights.

    Args:
        weights: Weights of the network.
        xy: (n, k, 2) m, layouts.
        fingers: (n, k), true fingers of the contacts.
    """
    n, k = fingers.shape
    forward = _Forward(weights, xy)
    codes = 5 ** np.arange(k)
    row = np.full(5**k, -1)
    row[hypotheses(k) @ codes] = np.arange(len(hypotheses(k)))
    truth = row[fingers @ codes]
    scores = forward.scores - forward.scores.max(axis=1, keepdims=True)
    share = np.exp(scores)
    share /= share.sum(axis=1, keepdims=True)
    loss = -np.log(np.maximum(share[np.arange(n), truth], 1e-12)).mean()
    share[np.arange(n), truth] -= 1.0
    return float(loss), forward.slopes(share / n)


class _Forward:
    """The network's layers for a batch of layouts (n, k, 2) m, and their derivatives."""

    def __init__(self, weights: Mapping[str, NDArray[np.float32]], xy: Array) -> None:
        w = self.w = weights
        n, k = xy.shape[:2]
        features, places = contact_features(xy)
        self.features = features.astype(np.float32)
        self.between = pair_features(places).astype(np.float32)
        self.pair = ordered_pairs(k)
        self.g1 = np.maximum(self.features @ w["g1"] + w["g1_bias"], 0)
        self.g2 = np.maximum(self.g1 @ w["g2"] + w["g2_bias"], 0)
        self.context = self.g2.mean(axis=1)
        x = (self.features @ w["f_first"])[:, self.pair[0]]
        x += (self.features @ w["f_second"])[:, self.pair[1]]
        x += self.between @ w["f_between"]
        x += (self.context @ w["f_context"] + w["f1_bias"])[:, None]
        self.f1 = np.maximum(x, 0, out=x)
        self.f2 = np.maximum(self.f1 @ w["f2"] + w["f2_bias"], 0)
        table = (self.f2 @ w["f3"]).reshape(n, -1)
        self.sums = _summing(k)
        self.scores: NDArray[np.float32] = table @ self.sums.T

    def slopes(self, by_score: Array) -> Weights:
        """Derivatives of the loss with respect to the weights, given those with respect to the
        scores (n, P)."""
        w = self.w
        n, k = self.features.shape[:2]
        pairs = len(self.pair[0])
        out: Weights = {}
        by_table = (by_score.astype(np.float32) @ self.sums).reshape(n * pairs, -1)
        f2, f1 = self.f2.reshape(n * pairs, -1), self.f1.reshape(n * pairs, -1)
        out["f3"] = f2.T @ by_table
        by_f2 = (by_table @ w["f3"].T) * (f2 > 0)
        out["f2"], out["f2_bias"] = f1.T @ by_f2, by_f2.sum(axis=0)
        by_f1 = (by_f2 @ w["f2"].T) * (f1 > 0)
        out["f1_bias"] = by_f1.sum(axis=0)
        out["f_between"] = self.between.reshape(n * pairs, -1).T @ by_f1
        by_f1 = by_f1.reshape(n, pairs, -1)
        flat = self.features.reshape(n * k, -1)
        for name, ends in zip(("f_first", "f_second"), self.pair, strict=True):
            gathered = np.zeros((n, k, by_f1.shape[-1]), np.float32)
            for i in range(k):
                gathered[:, i] = by_f1[:, ends == i].sum(axis=1)
            out[name] = flat.T @ gathered.reshape(n * k, -1)
        by_common = by_f1.sum(axis=1)
        out["f_context"] = self.context.T @ by_common
        by_g2 = (by_common @ w["f_context"].T)[:, None] / k * (self.g2 > 0)
        by_g2 = by_g2.reshape(n * k, -1)
        g1 = self.g1.reshape(n * k, -1)
        out["g2"], out["g2_bias"] = g1.T @ by_g2, by_g2.sum(axis=0)
        by_g1 = (by_g2 @ w["g2"].T) * (g1 > 0)
        out["g1"], out["g1_bias"] = flat.T @ by_g1, by_g1.sum(axis=0)
        return out


def _summing(count: int) -> NDArray[np.float32]:
    """Matrix (P, pairs * 25) that adds scores of pairs to the scores of the P labellings."""
    table = _SUMS.get(count)
    if table is None:
        places = score_places(count)
        table = np.zeros((len(places), len(ordered_pairs(count)[0]) * 25), np.float32)
        table[np.arange(len(places))[:, None], places] = 1.0
        _SUMS[count] = table
    return table


_SUMS: dict[int, NDArray[np.float32]] = {}


SHARES = {"first": 1.0, "second": 1.0, "posed": 0.5, "surface": 1.0}
"""Weight of every source of people in the draws. Posed people have a small weight, since real
people do not show many of their postures."""

SURFACE_PEOPLE = 150
"""Number of additional people, whose layouts are like those of real people (`surface_people`)."""


def train_names(
    people: Sequence[Capture],
    population: str,
    say: Callable[[float, float], None] = lambda share, loss: None,
    settings: TrainingSettings = DEFAULT,
) -> PopulationBelief:
    """Trains the belief over labels for any person.

    Args:
        people: People to train on; `meta` names the source of each.
        population: Digest of the population that contains these people.
        say: Called with the share done and the mean loss of the last 100 steps.
        settings: Sizes and schedule.

    Raises:
        EncoderError: `people` is empty.
    """
    if not people:
        raise EncoderError(
            "no person of the population is in the group to train on",
            remedy="`python -m training people --out FILE` makes a population with such people",
        )
    drawn = [surface_person([settings.seed, i]) for i in range(SURFACE_PEOPLE)]
    sources = [str(person.meta["source"]) for person in people] + ["surface"] * len(drawn)
    shares = [SHARES[source] / sources.count(source) for source in sources]
    pool = LayoutPool([*people, *drawn], shares)
    steps = settings.steps
    weights = train_network(pool, settings, lambda step, loss: say(step / steps, loss))
    return from_weights(weights, population)
