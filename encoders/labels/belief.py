"""Labels with history: a probability for every labelling of the contacts that are down.

A single frame with two or three touches often fits several labellings. But fingers come and go one
or two at a time, and evidence from a frame with four touches still holds when two of them have
left. So the labeller keeps a belief: a probability for every labelling of the current contacts.

- Contacts stay: frames of one grasp repeat the same evidence, so the belief stays until the layout
  has changed. A hand that turns, opens or pinches shows layouts that a wrong labelling explains
  badly. Such a frame counts with a weight below 1, as its layout still depends on earlier ones.
- Contacts leave: they are remembered at their last place for a while; then the belief is summed
  over their labels. When one finger leaves and another comes, two contacts that never touched
  together belong to one posture: the new finger lands near the place of the old one. So the place
  of a lifted contact is shifted with the contacts that stayed, until these have moved too far for
  it to be informative.
- Contacts come: the belief about the old ones is kept, and the new ones are judged given those, by
  p(all | layout) / p(old | layout). A remembered contact counts as an old one with another finger
  than the new ones, unless it has come back. Old contacts that have moved since their last
  evaluation are judged again.

So the belief keeps early mistakes as uncertainty, which later frames can correct.

Five contacts are named without error, also of people whom nobody knows. Such layouts are kept, and
are evidence about fewer fingers (see `encoders.labels.own_layouts`).

The evidence of a frame comes from a network that was trained on simulated people
(`encoders.labels.pair_network`). `PopulationBelief` stores it, with the weights of the belief.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import astuple, dataclass, replace
from functools import cache, cached_property, partial
from hashlib import blake2b
from importlib.resources import files
from math import exp, expm1, fsum, inf, isfinite, log
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from encoders.labels.labelling import (
    LEAST,
    Labelling,
    allowed,
    arranged,
    bounded,
    hypotheses,
    normalised,
    rows_of,
    summed,
)
from encoders.labels.own_layouts import FAR, MOST, NEW, SHAPE, OwnLayouts
from encoders.labels.pair_network import (
    FRESH,
    LONE_FINGER,
    USUAL_SETS,
    NetworkEvidence,
    PairNetwork,
)
from encoders.npz import read_npz, write_npz
from models.arithmetic import functions
from models.arithmetic.arrays import Array
from models.errors import EncoderError
from models.frames import FINGERS
from models.surface import METRES_PER_INCH

_CERTAIN = 0.99
"""Least probability at which a layout of five fingers is kept."""

_IMPOSSIBLE = -700.0
"""Log weight of names that a hand cannot have; its exponential is still a number."""

_LOOK_AGAIN = 0.5
"""Share of a layout that must be new before contacts that stay are evaluated again."""

_REACH = 0.02
"""m, root mean square movement of the contacts that stayed, after which a lifted one is forgotten.
An assumption: about the distance of two neighbouring fingertips. Time does not count, since
knowledge about a hand at rest stays valid."""

_AT_ONCE = 0.05
"""Probability that a contact which comes in the same frame in which another leaves is the same
finger. An assumption: a finger cannot do so, but devices sometimes give a contact another id."""

_LATER = 0.3
"""The same probability for a contact that comes later. An assumption: fingers tap, but they also
take turns."""

SCHEMA = 1
"""Version of the file's layout."""

SHARPNESS = dict.fromkeys(range(2, len(FINGERS) + 1), 0.8)
"""Factors on the network's log probabilities. Of 1, 0.8 and 0.65, this one costs people to choose
on 0.2 points of names, and their probabilities err by 2.7 points, of 3.3 with 1."""

ETA, STAY = 0.5, 0.3
"""Weights of new evaluations; see `PopulationBelief`. Chosen on people to choose on, where
probabilities of the truth hardly depend on them."""

_ASSUMED = {
    "usual": [[*fingers, odds] for fingers, odds in USUAL_SETS.items()],
    "lone": list(LONE_FINGER),
    "fresh": FRESH,
    "lifted": [_REACH, _AT_ONCE, _LATER],
    "least": LEAST,
    "own": [_CERTAIN, MOST, NEW, *FAR, *astuple(SHAPE)],
}
"""The constants that affect labels in addition to the file, for digests."""


@dataclass(frozen=True)
class PopulationBelief:
    """All trained parameters of the belief over labels for any person.

    Attributes:
        evidence: Evidence of a single frame.
        eta: Weight of a new evaluation of old contacts that have moved, when others join them; 0 to
            1.
        stay: Weight of a new evaluation of contacts that stay and have moved; 0 to 1.
        population: Digest of the people it was trained on.
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
        """Writes the model as npz; weights have half precision, which they were rounded to."""
        weights = self.evidence.network.weights
        write_npz(path, self.header, {k: v.astype(np.float16) for k, v in weights.items()})


def from_weights(weights: Mapping[str, NDArray[Any]], population: str) -> PopulationBelief:
    """The belief of a network, whose weights are rounded as its file stores them."""
    rounded = {k: np.asarray(v, np.float16).astype(float) for k, v in weights.items()}
    return PopulationBelief(NetworkEvidence(PairNetwork(rounded), SHARPNESS), ETA, STAY, population)


def load_population_belief(path: Path) -> PopulationBelief:
    """Reads a belief.

    Raises:
        EncoderError: The file is missing, damaged, of another version or breaks its contract.
    """
    remedy = "`python -m training names --out FILE` in a checkout makes a valid one"
    header, arrays = read_npz(path, None, EncoderError, "names for any person", remedy)
    if header.get("schema") != SCHEMA:
        raise EncoderError(
            "the names have another version",
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
            "not names for any person, or they are damaged",
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
    """The belief trained on the population, without contacts.

    Args:
        known: The person's own layouts of five fingers, where some are known.
    """
    return BeliefLabels(builtin_population_model(), known, learns=True)


class BeliefLabels:
    """Labels contacts by a belief that is carried from frame to frame.

    It may be called at every frame, or only when contacts come and go; calls at every frame let it
    learn from a moving hand.

    Args:
        trained: The trained model; may be shared, since the belief itself is kept in this object.
        known: The person's own layouts at the beginning of a trial.
        learns: True adds layouts of five fingers to them during a trial.

    Attributes:
        own: The person's own layouts so far.
        fingers: Fingers, the thumb first, whose names are given to as many contacts: a robot's hand
            may lack the others. With more contacts all names are.
    """

    remembers = True

    def __init__(
        self, trained: PopulationBelief, known: OwnLayouts | None = None, learns: bool = False
    ) -> None:
        self.trained = trained
        self.evidence = trained.evidence
        self.known = known or OwnLayouts()
        self.learns = learns
        self.fingers = len(FINGERS)
        self.restart()

    def restart(self) -> None:
        """Forgets all contacts, and all layouts but those known at the beginning."""
        self.own = self.known
        self.reset()

    def reset(self) -> None:
        """Forgets all contacts."""
        self._ids: tuple[int, ...] = ()
        self._lifted: tuple[_LiftOff, ...] = ()
        # Over labellings of the ids, then of the recent lift-offs.
        self._joint: Array = np.zeros(1)
        self._belief: Array = np.zeros(1)
        self._places: dict[int, Array] = {}
        self._looked: dict[int, Array] = {}
        # Current positions of the contacts, where `_places` was not updated for lack of new
        # evidence.
        self._moved: dict[int, tuple[float, float]] = {}
        self._answered: tuple[dict[int, int], Labelling] | None = None

    def assign(
        self, contacts: Mapping[int, tuple[float, float]], fixed: Mapping[int, int]
    ) -> Labelling:
        """See `Labeller.assign`.

        Fixed labels restrict the answer but not the belief: evidence from the touches is kept even
        where fixed labels contradict it for now. The probability is the belief's own, among the
        fingers that the hand has.
        """
        if self._answered and fixed == self._answered[0] and self._nothing_new(contacts):
            # In nearly every frame: repeat the last answer.
            self._moved = dict(contacts)
            return self._answered[1]
        ids, xy = arranged(contacts, fixed)
        self._take_in(ids, dict(zip(ids, xy, strict=True)))
        belief = self._among_fingers(len(ids))
        candidates = belief
        if fixed:
            candidates = np.where(allowed(ids, fixed), belief, -np.inf)
        best = int(np.argmax(candidates))
        labels = hypotheses(len(ids))[best].tolist()
        labelling = Labelling(
            dict(zip(ids, labels, strict=True)),
            exp(belief[best]),
            partial(_marginals, ids, belief),
        )
        if self.learns and len(ids) == len(FINGERS):
            self._learn(ids, xy)
        self._answered = dict(fixed), labelling
        return labelling

    def _among_fingers(self, count: int) -> Array:
        """The belief (P,) about `count` contacts, if they are by fingers that the hand has."""
        if not count <= self.fingers < len(FINGERS):
            return self._belief
        lacking = (hypotheses(count) >= self.fingers).any(axis=1)
        return normalised(np.where(lacking, _IMPOSSIBLE, self._belief))

    def _learn(self, ids: tuple[int, ...], xy: Array) -> None:
        """Keeps a layout of five fingers whose names are certain, whatever the fixed labels say."""
        best = int(np.argmax(self._belief))
        if self._belief[best] >= log(_CERTAIN):
            order = np.argsort(hypotheses(len(ids))[best])
            self.own = self.own.with_new(xy[order])

    def _log_posterior(self, xy: Array) -> Array:
        """Evidence (P,) of a frame alone, with the person's own layouts."""
        if not self._own_layouts_tell(xy):
            return self.evidence.log_posterior(xy)
        return normalised(self._log_weights(xy))

    def _log_weights(self, xy: Array) -> Array:
        """The same, not normalised."""
        if not self._own_layouts_tell(xy):
            return self.evidence.log_posterior(xy)
        return self.evidence.log_posterior(xy) + self.own.log_evidence(xy)

    def _own_layouts_tell(self, xy: Array) -> bool:
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
        return self._fresh(places, [self._looked[i].tolist() for i in ids]) <= _LOOK_AGAIN

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
        """Recent lift-offs by their index in the belief so far."""
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
        joint = bounded(self._believed(ids, lifted)) if self._changed(ids, lifted) else self._joint
        self._ids, self._lifted = ids, tuple(lifted.values())
        if len(ids) < 2 or not self.trained.stay:
            self._joint = joint
            return
        xy = np.array([self._places[i] for i in ids])
        new = self._freshness(xy, np.array([self._looked[i] for i in ids]))
        if new > _LOOK_AGAIN:
            look = self.trained.stay * new * self._log_posterior(xy)
            rows = rows_of(len(ids) + len(lifted), tuple(range(len(ids))))
            joint = bounded(joint + look[rows])
            self._looked = self._places
            self._lifted = tuple(contact.seen() for contact in self._lifted)
        self._joint = joint

    def _changed(self, ids: tuple[int, ...], lifted: Mapping[int, _LiftOff]) -> bool:
        return ids != self._ids or len(lifted) != len(self._lifted)

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
            # Both lack the density of their layouts, so that only shares can be compared.
            apart, joint = normalised(apart), normalised(joint)
            back = _AT_ONCE if any(contact.just for contact in others.values()) else _LATER
            joint = functions.log_sum_exp(log(1.0 - back) + apart, log(back) + joint)
        here = (*stayed, *came)
        self._joint = bounded(summed(joint, len(ids), [here.index(i) for i in ids]))
        self._ids, self._lifted, self._looked = ids, (), self._places

    def _grown(
        self, stayed: tuple[int, ...], lifted: Mapping[int, _LiftOff], came: tuple[int, ...]
    ) -> Array:
        """Log weights of labellings of contacts that stayed, that lifted, and that came.

        The belief about the old contacts, times the evidence of all contacts divided by that of the
        old ones.
        """
        old = [self._places[i] for i in stayed] + [contact.place for contact in lifted.values()]
        xy = np.array(old + [self._places[i] for i in came])
        joint = self._log_weights(xy)
        if not old:
            return joint
        at_first = self._log_weights(xy[: len(old)])
        carried = self._believed(stayed, lifted) - at_first
        if self.trained.eta and len(old) > 1:
            looked = [self._looked[i] for i in stayed] + [c.looked for c in lifted.values()]
            again = self.trained.eta * self._freshness(xy[: len(old)], np.array(looked))
            carried = carried + again * normalised(at_first)
        return joint + carried[rows_of(len(xy), tuple(range(len(old))))]

    def _freshness(self, xy: Array, looked: Array) -> float:
        """Share 0 to 1 of a layout (k, 2) that is new since the last evaluation.

        Contacts that have hardly moved give no new evidence: when fingers land shortly one after
        the other, the first ones must not count twice.
        """
        return self._fresh(xy.tolist(), looked.tolist())

    def _fresh(self, places: Sequence[Sequence[float]], looked: Sequence[Sequence[float]]) -> float:
        """`_freshness` in plain floats, which for a few contacts are quicker than arrays."""
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
    """Probabilities (5,) of the fingers by contact id, of a belief (P,) about these contacts."""
    probability = functions.exp(belief)
    labels = hypotheses(len(ids)) if ids else np.empty((0, 0), np.int64)
    return {
        contact: np.bincount(labels[:, place], probability, len(FINGERS)).astype(float)
        for place, contact in enumerate(ids)
    }


@dataclass(frozen=True)
class _LiftOff:
    """A contact that was lifted recently.

    Attributes:
        place: (2,) m on the surface, its last place, shifted with the contacts that stayed.
        looked: (2,) m, its place when the layout was last evaluated.
        since: Positions (2,) m of the contacts that stayed, by id, at the time when it left.
        just: True if it has left since the last frame.
    """

    place: Array
    looked: Array
    since: Mapping[int, Array]
    just: bool = True

    def carried(self, shift: Array) -> _LiftOff:
        """The lift-off, shifted with the others by (2,) m."""
        return replace(self, place=self.place + shift, just=False)

    def seen(self) -> _LiftOff:
        """The lift-off after another evaluation of the layout."""
        return replace(self, looked=self.place)

    def remembered(self, now: Mapping[int, Array]) -> bool:
        """True if its place is still informative, given the contacts' current positions."""
        ways = [now[i] - place for i, place in self.since.items() if i in now]
        return bool(ways) and float(np.mean(np.square(ways).sum(axis=1))) <= _REACH**2


def _that_fit(lifted: Mapping[int, _LiftOff], room: int) -> Mapping[int, _LiftOff]:
    """Chooses the lift-offs that can all be other fingers than those that touch.

    Args:
        lifted: Recent lift-offs, under any keys.
        room: Number of fingers that do not touch.
    """
    if len(lifted) > room:
        lifted = {key: contact for key, contact in lifted.items() if contact.just}
    return lifted if len(lifted) <= room else {}
