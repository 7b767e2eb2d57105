"""Labels with history: a probability for every labelling of the contacts that are down.

A single frame with two or three touches often fits several labellings. But fingers touch and lift
one or two at a time, and evidence from a frame with four touches is still valid after two of them
have lifted. The labeller therefore keeps a belief: a probability for every labelling of the current
contacts. Three events change it.

- Contacts stay down. Frames of one grasp repeat the same evidence, so the belief does not change
  until the layout has changed. When a hand turns, opens or pinches, a wrong labelling explains the
  new layout badly. Such a frame counts with a weight below 1, because its layout still depends on
  earlier frames.
- Contacts lift. They are remembered at their last place for a while; then the belief is summed over
  their labels. When one finger lifts and another lands, the two contacts were never down together
  but belong to one posture. A lifted contact's place is therefore shifted along with the contacts
  that stayed, until these have moved so far that the place is no longer informative.
- Contacts land. The belief about the old contacts is multiplied by
  p(labels of all | layout of all) / p(labels of the old | layout of the old). The finger of a
  remembered contact is either still lifted, or has returned. In the first case the contact counts
  as a further old contact; in the second case it is one of the new contacts. Old contacts that have
  moved since their last evaluation are evaluated again.

Early mistakes are thus stored as uncertainty, which later frames can correct.

The evidence of a frame comes from a network that was trained on simulated people
(`encoders.labels.pair_network`). `PopulationBelief` stores it with the weights of the belief.

A person's own layouts of five fingers are evidence about fewer fingers (`OwnLayouts`). Five touches
of one hand are labelled without error, even for unknown people: there is one thumb, and the other
fingers follow it in order. Such layouts are stored, and the touches of any two to four fingers in
them are known layouts of these fingers. Layouts of fewer than five touches are not learned. A
confident answer about two fingers may be wrong, and would then confirm itself.

This evidence is a kernel density of touch layouts. A layout consists of the positions of touches
relative to their mean, so that the density does not depend on the hand's place on the surface.
Every set of fingers has a kernel density over known layouts. Hands rotate and open as a whole, and
known layouts have only some of these rotations and openings. Each kernel is therefore stretched
along the rotation and the size of its layout. If the observed layout x and a known layout p are
written as complex vectors, the inner product <p, x> has the components along both directions. Such
a kernel therefore costs no more than a round kernel.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import astuple, dataclass, replace
from functools import cache, cached_property, partial
from hashlib import blake2b
from importlib.resources import files
from itertools import permutations
from math import exp, expm1, fsum, inf, isfinite, log, pi
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from encoders.labels.labelling import (
    LEAST,
    Labelling,
    LogOdds,
    allowed,
    arranged,
    bounded,
    finger_sets,
    hypotheses,
    normalised,
    rows_of,
    set_of_labelling,
    summed,
)
from encoders.labels.pair_network import (
    FRESH,
    LONE_FINGER,
    USUAL_SETS,
    NetworkEvidence,
    PairNetwork,
)
from encoders.npz import read_npz, write_npz
from models import arithmetic
from models.arithmetic import Array, matrix_product, squared_lengths, total
from models.errors import EncoderError
from models.frames import FINGERS
from models.surface import METRES_PER_INCH

Layouts = NDArray[np.complex128]
"""Array (S, M, k): M layouts for each of the S sets of `finger_sets(k)`. A layout has the complex
numbers x + i y of its touches in the order of the fingers, in inches, with their mean at 0."""

_LEAST_SIZE = 1e-3
"""Least size (inches) of a layout as a divisor; contacts on one spot have the size 0."""


@dataclass(frozen=True)
class KernelShape:
    """Width of the kernels of a layout density.

    Attributes:
        width: Standard deviation (inches) of every coordinate.
        turn: Standard deviation (rad) of the rotation of a layout about its mean.
        size: Standard deviation of the logarithm of a layout's size.
    """

    width: float = 0.1
    turn: float = 0.1
    size: float = 0.05


MOST = 24
"""Largest number of layouts that are stored; a further layout replaces the oldest layout."""

NEW = 0.12
"""Least root mean square distance (inches) of a new layout from all stored layouts, after the best
shift. A nearer layout is the same posture and adds no information."""

SHAPE = KernelShape(width=0.25, turn=0.22, size=0.16)
"""Kernel shape: how far a person's later layouts differ from the stored layouts."""

FAR = (3.0, 4.0, 5.0)
"""Distance, in standard deviations, beyond which a stored layout is no evidence, for 2, 3 and 4
contacts."""

_WIDEST = 12.0
"""Greatest distance (inches) of two touches of one hand."""

_LEAST = 0.2
"""Least distance (inches) between the centres of two fingertips."""


class OwnLayouts:
    """Layouts of a person's five fingers.

    Args:
        layouts: (n, 5, 2) m, touches by finger on the surface, in the frame of a right hand, the
            newest last. At most `MOST` are stored.

    Attributes:
        layouts: (n, 5, 2) inches, each with its mean at 0, rounded to a thousandth.

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
            if not _like_a_hand(layout):
                raise EncoderError(
                    "these five touches cannot be one hand",
                    where="a layout of five fingers",
                    got=layout.round(2).tolist(),
                    expected=f"distances of {_LEAST:g} to {_WIDEST:g} inches between fingertips",
                    remedy="Forget the layouts of the profile, and touch with five fingers again",
                )
            if not _of_right_hand(layout):
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
        """These layouts and a further layout (5, 2) m by finger; `self` if the layout is not new or
        not that of a right hand."""
        layout = _centred(np.asarray(xy, float) / METRES_PER_INCH)
        if not (_like_a_hand(layout) and _of_right_hand(layout)):
            return self
        off = self.layouts - layout
        if len(off) and (squared_lengths(off.reshape(len(off), -1)) < 5 * NEW**2).any():
            return self
        grown = np.concatenate([self.layouts, layout[None]])
        return OwnLayouts(grown * METRES_PER_INCH)

    def log_evidence(self, xy: Array) -> Array:
        """Log weights (P,) of the labellings of contacts (k, 2) in m, k = 2 to 4; 0 is neutral."""
        density, log_far = self._densities[len(xy)]
        return arithmetic.log_sum_exp(density.log_density(xy) - log_far, np.zeros(1))

    @cached_property
    def _densities(self) -> dict[int, tuple[LayoutDensity, float]]:
        z = self.layouts[..., 0] + 1j * self.layouts[..., 1]
        densities = {}
        for count in range(2, len(FINGERS)):
            parts = np.stack([z[:, fingers] for fingers in finger_sets(count)])
            parts = parts - parts.mean(axis=2, keepdims=True)
            density = LayoutDensity(parts, SHAPE)
            # Log density at the middle of a round kernel. The density at a distance of `FAR`
            # standard deviations follows from it.
            peak = -(2 * count - 2) * log(SHAPE.width * 2.5066282746310002) - log(len(z))
            densities[count] = density, peak - 0.5 * FAR[count - 2] ** 2
        return densities


def _like_a_hand(layout: Array) -> bool:
    """True if the distances between five touches (5, 2), in inches, are possible for one hand."""
    i, j = np.triu_indices(len(FINGERS), 1)
    between = np.sqrt(squared_lengths(layout[i] - layout[j]))
    return bool((between > _LEAST).all() and (between < _WIDEST).all())


def _of_right_hand(layout: Array) -> bool:
    """True if touches (5, 2), thumb first and y down, go clockwise about their mean.

    The signed area of their pentagon is then positive, as for all layouts of simulated people.
    """
    x, y = layout.T.tolist()
    after = [*range(1, len(FINGERS)), 0]
    return total(x[i] * y[k] - x[k] * y[i] for i, k in enumerate(after)) > 0.0


def _centred(layout: Array) -> Array:
    middle = layout[0]
    for place in layout[1:]:
        middle = middle + place
    return np.round(layout - middle / len(FINGERS), 3)


@cache
def _arrangement(count: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Relation between hypotheses, finger sets and orders of contacts.

    Returns:
        Orders (k!, k): the contact that takes each place of the sorted finger set. Indices (P,):
        the place of each labelling of `hypotheses(count)` in the flattened table (S, k!).
    """
    orders = list(permutations(range(count)))
    order_of = [orders.index(tuple(order)) for order in np.argsort(hypotheses(count)).tolist()]
    return np.array(orders, np.intp), set_of_labelling(count) * len(orders) + np.array(order_of)


class LayoutDensity:
    """Kernel density of layouts of k touches given their labels.

    With c = <p, x>, a kernel's exponent has two terms. One is proportional to |x|^2, and equal for
    all labellings. The other is a quadratic form in Re c (along the size) and Im c (along the
    rotation), whose coefficients depend on |p|.

    Args:
        layouts: (S, M, k) known layouts, k = 2 to 5; each gets a kernel.
        shape: Shape of the kernels.
    """

    def __init__(self, layouts: Layouts, shape: KernelShape) -> None:
        self._sets, number, count = layouts.shape
        r2 = squared_lengths(layouts.real) + squared_lengths(layouts.imag)
        narrow = shape.width**2
        along_size = narrow + shape.size**2 * r2
        along_turn = narrow + shape.turn**2 * r2
        constant = -log(number) - 0.5 * (
            r2 / along_size
            + (2 * count - 4) * log(2 * pi * narrow)
            + arithmetic.log(2 * pi * along_size)
            + arithmetic.log(2 * pi * along_turn)
        )
        # Rows are labellings and columns the many kernels, so that rows are long; real and
        # imaginary parts are separate, since half of a complex array is not contiguous.
        flat = layouts.reshape(-1, count).T
        along, across = np.vstack([flat.real, flat.imag]), np.vstack([-flat.imag, flat.real])
        self._directions = np.hstack([along, across])
        # At a size of 0, both differences below are 0, so the bound of the divisor has no effect.
        divisor = np.maximum(r2, _LEAST_SIZE**2)
        columns = (
            0.5 * (1.0 / narrow - 1.0 / along_size) / divisor,
            1.0 / along_size,
            0.5 * (1.0 / narrow - 1.0 / along_turn) / divisor,
            constant,
        )
        self._size2, self._size1, self._turn2, self._constant = (
            np.ascontiguousarray(c.ravel(), np.float32) for c in columns
        )
        self._narrow = narrow
        self._orders, self._place = _arrangement(count)

    def log_density(self, xy: Array) -> Array:
        """log p(layout | labelling), (P,), of the labellings of `hypotheses(k)`.

        Args:
            xy: (k, 2) m on the surface. The density is per square inch to the power k - 1.
        """
        inches = xy / METRES_PER_INCH
        places = inches - inches.mean(axis=0)
        arranged = places[self._orders]
        x = np.concatenate([arranged[..., 0], arranged[..., 1]], axis=1)
        # Single precision is enough for the many kernels, and takes half the memory bandwidth.
        both = matrix_product(x, self._directions).astype(np.float32)
        along, across = np.split(both, 2, axis=1)
        exponent = self._size2 * along
        exponent += self._size1
        exponent *= along
        np.square(across, out=across)
        across *= self._turn2
        exponent += across
        exponent += self._constant
        table = exponent.reshape(len(self._orders) * self._sets, -1)
        highest = table.max(axis=1)
        table -= highest[:, None]
        total = arithmetic.exp_of_many(table).sum(axis=1)
        densities = (highest + arithmetic.log(total)).reshape(len(self._orders), self._sets)
        result: Array = densities.T.ravel()[self._place]
        return result - 0.5 * fsum(squared_lengths(places).tolist()) / self._narrow


_CERTAIN = 0.99
"""A layout of five fingers is stored if its labelling has at least this probability."""

_LOOK_AGAIN = 0.5
"""Share of a layout that must be new before contacts that stay are evaluated again."""

_REACH = 0.02
"""Root mean square movement (m) of the contacts that stayed, after which a lifted contact is
forgotten. Assumed to be about the distance of two neighbouring fingertips. Time does not count,
since knowledge about a hand at rest stays valid."""

_AT_ONCE = 0.05
"""Probability that a contact which lands in the frame in which another contact lifts is the same
finger. Assumed: a finger is not as fast, but devices sometimes change the id of a contact."""

_LATER = 0.3
"""The same probability for a contact that lands later. Assumed: fingers tap, but also alternate."""

SCHEMA = 1
"""Version of the file's layout."""

SHARPNESS = dict.fromkeys(range(2, len(FINGERS) + 1), 0.8)
"""Factors on the network's log probabilities, chosen from 1, 0.8 and 0.65 on the people of the
selection set. Compared with 1, the factor 0.8 lowers the share of correct labels by 0.2 percentage
points, and the error of the probabilities from 3.3 to 2.7 percentage points."""

ETA, STAY = 0.5, 0.3
"""Weights of new evaluations; see `PopulationBelief`. Chosen on the people of the selection set,
for whom the probabilities of the true labels hardly depend on these weights."""

ODD: Mapping[int, float] = {2: 0.2, 3: 0.05, 4: 0.01, 5: 0.0}
"""Share of people, by number of contacts, whose hands the trained evidence does not fit. Chosen on
66 people of the selection set, who come from two generators. The network for the people of one
generator was trained without that generator. The claimed probabilities err by 2.2 and 2.6 points
for the two generators (5.7 and 1.9 with a share of 0). All answers with a claim of 0.99 are right
(97.6 and 99.9 % with a share of 0).
"""

FAINT = 0.2
"""Factor on log probabilities for the share `ODD` of people; chosen together with it."""

_ASSUMED = {
    "usual": [[*fingers, odds] for fingers, odds in USUAL_SETS.items()],
    "lone": list(LONE_FINGER),
    "fresh": FRESH,
    "lifted": [_REACH, _AT_ONCE, _LATER],
    "least": LEAST,
    "own": [_CERTAIN, MOST, NEW, *FAR, *astuple(SHAPE)],
}
"""Constants that affect labels and are not in the file; digests include them. `ODD` and `FAINT` are
absent: they change only the claimed probabilities, unless the person's finger sets are declared."""


@dataclass(frozen=True)
class PopulationBelief:
    """All trained parameters of the belief over labels for any person.

    Attributes:
        evidence: Evidence of a single frame.
        eta: Weight, 0 to 1, of a new evaluation of old contacts that have moved, when further
            contacts land.
        stay: Weight, 0 to 1, of a new evaluation of contacts that stay down and have moved.
        population: Digest of the people on whom the model was trained.
    """

    evidence: NetworkEvidence
    eta: float
    stay: float
    population: str

    @property
    def header(self) -> dict[str, Any]:
        """The settings as JSON values."""
        return {
            "schema": SCHEMA,
            "simulated": True,
            "sharpness": {str(k): v for k, v in self.evidence.sharpness.items()},
            "eta": self.eta,
            "stay": self.stay,
            "population": self.population,
        }

    @cached_property
    def digest(self) -> str:
        """BLAKE2b, hexadecimal, of everything that decides a label, with the assumed constants."""
        known = json.dumps({**self.header, **_ASSUMED}, sort_keys=True)
        hash_ = blake2b(known.encode(), digest_size=16)
        for name, array in sorted(self.evidence.network.weights.items()):
            hash_.update(name.encode() + array.tobytes())
        return hash_.hexdigest()

    def save(self, path: Path) -> None:
        """Writes the model as npz. The weights are stored in half precision, to which they were
        rounded before."""
        weights = self.evidence.network.weights
        write_npz(path, self.header, {k: v.astype(np.float16) for k, v in weights.items()})


def from_weights(weights: Mapping[str, NDArray[Any]], population: str) -> PopulationBelief:
    """Creates a belief from a network's weights, rounded to the half precision of the file."""
    rounded = {k: np.asarray(v, np.float16).astype(float) for k, v in weights.items()}
    return PopulationBelief(NetworkEvidence(PairNetwork(rounded), SHARPNESS), ETA, STAY, population)


def load_population_belief(path: Path) -> PopulationBelief:
    """Reads a belief.

    Raises:
        EncoderError: The file is missing, damaged, of another version or breaks its contract.
    """
    remedy = "`python -m training names --out FILE` in a checkout makes a valid one"
    header, arrays = read_npz(path, None, EncoderError, "a labelling model", remedy)
    if header.get("schema") != SCHEMA:
        raise EncoderError(
            "the labelling model has an unsupported version",
            where=str(path),
            got=header.get("schema"),
            expected=f"schema {SCHEMA}",
            remedy=remedy,
        )
    try:
        sharpness = {k: float(header["sharpness"][str(k)]) for k in range(2, len(FINGERS) + 1)}
        eta, stay = float(header["eta"]), float(header["stay"])
        population = str(header["population"])
    except (KeyError, TypeError, ValueError) as error:
        raise EncoderError(
            "the file is not a labelling model, or it is damaged",
            where=str(path),
            got=f"{type(error).__name__}: {error}",
            remedy=remedy,
        ) from error
    weights = {name: array.astype(float) for name, array in arrays.items()}
    return PopulationBelief(NetworkEvidence(PairNetwork(weights), sharpness), eta, stay, population)


@cache
def builtin_population_model() -> PopulationBelief:
    """The model trained on the population."""
    return load_population_belief(Path(str(files("encoders") / "data" / "names.npz")))


def builtin_population_belief(known: OwnLayouts | None = None) -> BeliefLabels:
    """A labeller with the model trained on the population, without contacts.

    Args:
        known: The person's own layouts of five fingers; None if none are known.
    """
    return BeliefLabels(builtin_population_model(), known, learns=True)


def claimed(belief: Array, count: int) -> Array:
    """Log probabilities (P,) to show and record, from a belief (P,) about `count` contacts.

    The belief is valid for people like those on whom it was trained. A hand unlike theirs differs
    from them in every frame, so the belief may become certain of a wrong answer. Therefore the
    share `ODD` of all people is assumed to have such hands, and log probabilities are multiplied by
    `FAINT` for this share. The order of the labellings does not change.
    """
    odd = ODD.get(count, 0.0)
    if not odd:
        return belief
    return arithmetic.log_sum_exp(log(1.0 - odd) + belief, log(odd) + normalised(FAINT * belief))


class BeliefLabels:
    """Labels contacts by a belief that is carried from frame to frame.

    `assign` may be called at every frame, or only when contacts land or lift. Only calls at every
    frame give evidence from a moving hand.

    Args:
        trained: The trained model. Labellers may share it, since each stores its own belief.
        known: The person's own layouts at the beginning of a trial.
        learns: True adds layouts of five fingers to the known layouts during a trial.

    Attributes:
        own: The person's own layouts so far.
        odds: Log factors on the labellings for the fingers that are in use
            (`encoders.labels.labelling`). They restrict the answer, not the belief.
    """

    remembers = True

    def __init__(
        self, trained: PopulationBelief, known: OwnLayouts | None = None, learns: bool = False
    ) -> None:
        self.trained = trained
        self.evidence = trained.evidence
        self.known = known or OwnLayouts()
        self.learns = learns
        self.odds: LogOdds = (None,) * (len(FINGERS) + 1)
        self.restart()

    def restart(self) -> None:
        """Forgets all contacts, and all layouts learned since the beginning."""
        self.own = self.known
        self.reset()

    def reset(self) -> None:
        """Forgets all contacts."""
        self._ids: tuple[int, ...] = ()
        self._lifted: tuple[_LiftOff, ...] = ()
        # Log probabilities of the joint labellings of the contacts `_ids` and then `_lifted`.
        self._joint: Array = np.zeros(1)
        self._belief: Array = np.zeros(1)
        self._places: dict[int, Array] = {}
        self._looked: dict[int, Array] = {}
        # Current positions of the contacts while `_places` is old. It is not updated as long as
        # there is no new evidence.
        self._moved: dict[int, tuple[float, float]] = {}
        self._answered: tuple[dict[int, int], Labelling] | None = None

    def assign(
        self, contacts: Mapping[int, tuple[float, float]], fixed: Mapping[int, int]
    ) -> Labelling:
        """See `Labeller.assign`.

        Fixed labels restrict the answer but not the belief: evidence from the touches still counts
        where fixed labels contradict it. The probability is that of `claimed`, restricted to the
        fingers that are in use.
        """
        if self._answered and fixed == self._answered[0] and self._nothing_new(contacts):
            # This is so in nearly every frame.
            self._moved = dict(contacts)
            return self._answered[1]
        ids, xy = arranged(contacts, fixed)
        self._take_in(ids, dict(zip(ids, xy, strict=True)))
        claims = self._claims(len(ids))
        candidates = claims
        if fixed:
            candidates = np.where(allowed(ids, fixed), claims, -np.inf)
        best = int(np.argmax(candidates))
        labels = hypotheses(len(ids))[best].tolist()
        labelling = Labelling(
            dict(zip(ids, labels, strict=True)),
            exp(claims[best]),
            partial(_marginals, ids, claims),
        )
        if self.learns and len(ids) == len(FINGERS):
            self._learn(ids, xy)
        self._answered = dict(fixed), labelling
        return labelling

    def _claims(self, count: int) -> Array:
        """Log probabilities (P,) of `claimed` for `count` contacts, restricted to the fingers in
        use."""
        claims, odds = claimed(self._belief, count), self.odds[count]
        return claims if odds is None else normalised(claims + odds)

    def _learn(self, ids: tuple[int, ...], xy: Array) -> None:
        """Stores a layout of five fingers if its labels are certain, regardless of fixed labels."""
        best = int(np.argmax(self._belief))
        if self._belief[best] >= log(_CERTAIN):
            order = np.argsort(hypotheses(len(ids))[best])
            self.own = self.own.with_new(xy[order])

    def _log_posterior(self, xy: Array) -> Array:
        """Log probabilities (P,) from a single frame and the person's own layouts."""
        if not self._own_layouts_count(xy):
            return self.evidence.log_posterior(xy)
        return normalised(self._log_weights(xy))

    def _log_weights(self, xy: Array) -> Array:
        """Log weights (P,) from a single frame and the person's own layouts, not normalised."""
        if not self._own_layouts_count(xy):
            return self.evidence.log_posterior(xy)
        return self.evidence.log_posterior(xy) + self.own.log_evidence(xy)

    def _own_layouts_count(self, xy: Array) -> bool:
        return len(self.own) > 0 and 1 < len(xy) < len(FINGERS)

    def _nothing_new(self, contacts: Mapping[int, tuple[float, float]]) -> bool:
        """True if the contacts and their order are unchanged and their layout gives no new
        evidence."""
        ids = self._ids
        if self._lifted or len(contacts) != len(ids):
            return False
        places, before = [], (-inf, -inf, -1)
        for i in ids:
            if i not in contacts:
                return False
            place = x, y = contacts[i]
            if not (isfinite(x) and isfinite(y)) or before > (x, y, i):
                return False
            places.append(place)
            before = x, y, i
        if len(ids) < 2 or not self.trained.stay:
            return True
        return self._freshness(places, [self._looked[i].tolist() for i in ids]) <= _LOOK_AGAIN

    def _take_in(self, ids: tuple[int, ...], now: dict[int, Array]) -> None:
        if self._moved:
            self._places = {i: np.array(self._moved[i], float) for i in self._ids}
            self._moved = {}
        stayed = tuple(i for i in ids if i in self._places)
        came = tuple(i for i in ids if i not in self._places)
        lifted = self._lifted_now(stayed, now) if stayed else {}
        self._places = now
        if came:
            self._judge_new(ids, stayed, came, lifted)
        else:
            self._carry_on(ids, lifted)
        self._belief = summed(self._joint, len(ids) + len(self._lifted), range(len(ids)))

    def _lifted_now(self, stayed: tuple[int, ...], now: dict[int, Array]) -> dict[int, _LiftOff]:
        """Recent lift-offs that are still remembered, by their index in the belief so far."""
        before = self._places
        shift = np.mean([now[i] - before[i] for i in stayed], axis=0)
        since = {i: before[i] for i in stayed}
        lifted = {
            at: _LiftOff(before[i] + shift, self._looked[i], since)
            for at, i in enumerate(self._ids)
            if i not in now
        }
        for at, contact in enumerate(self._lifted, len(self._ids)):
            lifted[at] = contact.carried(shift)
        return {at: contact for at, contact in lifted.items() if contact.remembered(now)}

    def _believed(self, stayed: tuple[int, ...], lifted: Mapping[int, _LiftOff]) -> Array:
        """The belief so far about contacts that stayed and some recent lift-offs, in this order."""
        places = (*(self._ids.index(i) for i in stayed), *lifted)
        return summed(self._joint, len(self._ids) + len(self._lifted), places)

    def _carry_on(self, ids: tuple[int, ...], lifted: Mapping[int, _LiftOff]) -> None:
        changed = ids != self._ids or len(lifted) != len(self._lifted)
        joint = bounded(self._believed(ids, lifted)) if changed else self._joint
        self._ids, self._lifted = ids, tuple(lifted.values())
        if len(ids) < 2 or not self.trained.stay:
            self._joint = joint
            return
        xy = np.array([self._places[i] for i in ids])
        new = self._freshness(xy.tolist(), [self._looked[i].tolist() for i in ids])
        if new > _LOOK_AGAIN:
            look = self.trained.stay * new * self._log_posterior(xy)
            rows = rows_of(len(ids) + len(lifted), tuple(range(len(ids))))
            joint = bounded(joint + look[rows])
            self._looked = self._places
            self._lifted = tuple(contact.seen() for contact in self._lifted)
        self._joint = joint

    def _judge_new(
        self,
        ids: tuple[int, ...],
        stayed: tuple[int, ...],
        came: tuple[int, ...],
        lifted: Mapping[int, _LiftOff],
    ) -> None:
        others = _that_fit(lifted, len(FINGERS) - len(ids))
        count = len(ids) + len(others)
        joint = self._grown(stayed, {}, came)
        if others:
            apart = self._grown(stayed, others, came)
            touching = [*range(len(stayed)), *range(len(stayed) + len(others), count)]
            apart = summed(apart, count, touching)
            # `apart` and `joint` belong to different layouts, and both lack the layout's density as
            # a factor. They are therefore normalised before they are mixed.
            apart, joint = normalised(apart), normalised(joint)
            back = _AT_ONCE if any(contact.just for contact in others.values()) else _LATER
            joint = arithmetic.log_sum_exp(log(1.0 - back) + apart, log(back) + joint)
        here = (*stayed, *came)
        self._joint = bounded(summed(joint, len(ids), [here.index(i) for i in ids]))
        self._ids, self._lifted, self._looked = ids, (), self._places

    def _grown(
        self, stayed: tuple[int, ...], lifted: Mapping[int, _LiftOff], came: tuple[int, ...]
    ) -> Array:
        """Log weights of the labellings of contacts that stayed, lifted and landed, in this order.

        The weight is the belief about the old contacts, multiplied by the evidence of all contacts
        and divided by the evidence of the old contacts.
        """
        old = [self._places[i] for i in stayed] + [contact.place for contact in lifted.values()]
        xy = np.array(old + [self._places[i] for i in came])
        joint = self._log_weights(xy)
        if not old:
            return joint
        at_first = self._log_weights(xy[: len(old)])
        carried = self._believed(stayed, lifted) - at_first
        if self.trained.eta and len(old) > 1:
            looked = [self._looked[i].tolist() for i in stayed]
            looked += [contact.looked.tolist() for contact in lifted.values()]
            again = self.trained.eta * self._freshness(xy[: len(old)].tolist(), looked)
            carried = carried + again * normalised(at_first)
        return joint + carried[rows_of(len(xy), tuple(range(len(old))))]

    def _freshness(
        self, places: Sequence[Sequence[float]], looked: Sequence[Sequence[float]]
    ) -> float:
        """Share, 0 to 1, of a layout (k, 2) that is new since its last evaluation at `looked`.

        Contacts that have hardly moved give no new evidence. When fingers land shortly after each
        other, the fingers that landed first must not count twice. Plain floats are quicker than
        arrays here.
        """
        n = len(places)
        x = [a[0] - b[0] for a, b in zip(places, looked, strict=True)]
        y = [a[1] - b[1] for a, b in zip(places, looked, strict=True)]
        mx, my = fsum(x) / n, fsum(y) / n
        moved = 0.0
        for a, b in zip(x, y, strict=True):
            moved += (a - mx) ** 2 + (b - my) ** 2
        width = FRESH * METRES_PER_INCH
        return -expm1(-0.5 * (moved / n) / width**2)


def _marginals(ids: tuple[int, ...], belief: Array) -> dict[int, Array]:
    """Probabilities (5,) of the fingers by contact id, from a belief (P,) about these contacts."""
    probability = arithmetic.exp(belief)
    labels = hypotheses(len(ids)) if ids else np.empty((0, 0), np.int64)
    return {
        contact: np.bincount(labels[:, place], probability, len(FINGERS)).astype(float)
        for place, contact in enumerate(ids)
    }


@dataclass(frozen=True)
class _LiftOff:
    """A contact that was lifted recently.

    Attributes:
        place: (2,) m on the surface: the last position, shifted with the contacts that stayed.
        looked: (2,) m, position when the layout was last evaluated.
        since: Positions (2,) m of the contacts that stayed, by id, when this contact lifted.
        just: True if the contact has lifted in the current frame.
    """

    place: Array
    looked: Array
    since: Mapping[int, Array]
    just: bool = True

    def carried(self, shift: Array) -> _LiftOff:
        """The lift-off, shifted by (2,) m with the contacts that stayed."""
        return replace(self, place=self.place + shift, just=False)

    def seen(self) -> _LiftOff:
        """The lift-off after another evaluation of the layout."""
        return replace(self, looked=self.place)

    def remembered(self, now: Mapping[int, Array]) -> bool:
        """True if the place is still informative, given the contacts' current positions."""
        ways = [now[i] - place for i, place in self.since.items() if i in now]
        return bool(ways) and float(np.mean(np.square(ways).sum(axis=1))) <= _REACH**2


def _that_fit(lifted: Mapping[int, _LiftOff], room: int) -> Mapping[int, _LiftOff]:
    """Selects lift-offs that can all belong to fingers that do not touch.

    Args:
        lifted: Recent lift-offs, under any keys.
        room: Number of fingers that do not touch.
    """
    if len(lifted) > room:
        lifted = {key: contact for key, contact in lifted.items() if contact.just}
    return lifted if len(lifted) <= room else {}
