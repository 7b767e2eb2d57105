"""Labels with history: a probability for every labelling of the contacts that are down.

A single frame with two or three touches often fits several labellings. But fingers come and go one
or two at a time, and evidence from a frame with four touches still holds when two of them have
left. So the labeller keeps a belief: a probability for every labelling of the current contacts.

- Contacts stay: frames of one grasp repeat the same evidence, so the belief stays until the layout
  has changed. A hand that turns, opens or pinches shows layouts that a wrong labelling explains
  badly. Such a frame counts with a weight below 1, as its layout still depends on earlier ones.
- Contacts leave: they are remembered at their last place for a while (see
  `encoders.labels.recent_liftoffs`); then the belief is summed over their labels.
- Contacts come: the belief about the old ones is kept, and the new ones are judged given those, by
  p(all | layout) / p(old | layout). A remembered contact counts as an old one with another finger
  than the new ones, unless it has come back. Old contacts that have moved since their last
  evaluation are judged again.

So the belief keeps early mistakes as uncertainty, which later frames can correct.

Five contacts are named without error, also of people whom nobody knows. Such layouts are kept, and
are evidence about fewer fingers (see `encoders.labels.own_layouts`).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from math import exp, expm1, fsum, inf, isfinite, log
from typing import Protocol

import numpy as np

from encoders.labels.label_sums import bounded, normalised, rows_of, summed
from encoders.labels.labelling import Labelling, allowed, arranged, hypotheses
from encoders.labels.network_evidence import FRESH, NetworkEvidence
from encoders.labels.own_layouts import OwnLayouts
from encoders.labels.recent_liftoffs import AT_ONCE, LATER, LiftOff, that_fit
from models.arithmetic import functions
from models.arithmetic.arrays import Array
from models.frames import FINGERS
from models.surface import METRES_PER_INCH

CERTAIN = 0.99
"""Least probability at which a layout of five fingers is kept."""

IMPOSSIBLE = -700.0
"""Log weight of names that a hand cannot have; its exponential is still a number."""

_LOOK_AGAIN = 0.5
"""Share of a layout that must be new before contacts that stay are evaluated again."""


class BeliefModel(Protocol):
    """A trained model of the belief over labels.

    Attributes:
        evidence: Evidence of a single frame.
        eta: Weight of a new evaluation of old contacts that have moved, when others join them; 0 to
            1.
        stay: Weight of a new evaluation of contacts that stay and have moved; 0 to 1.
        digest: Digest of everything that decides a label.
    """

    @property
    def evidence(self) -> NetworkEvidence: ...

    @property
    def eta(self) -> float: ...

    @property
    def stay(self) -> float: ...

    @property
    def digest(self) -> str: ...


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
        self, trained: BeliefModel, known: OwnLayouts | None = None, learns: bool = False
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
        self._lifted: tuple[LiftOff, ...] = ()
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
        return normalised(np.where(lacking, IMPOSSIBLE, self._belief))

    def _learn(self, ids: tuple[int, ...], xy: Array) -> None:
        """Keeps a layout of five fingers whose names are certain, whatever the fixed labels say."""
        best = int(np.argmax(self._belief))
        if self._belief[best] >= log(CERTAIN):
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

    def _lifted_now(self, stayed: tuple[int, ...], now: dict[int, Array]) -> dict[int, LiftOff]:
        """Recent lift-offs by their index in the belief so far."""
        before = self._places
        shift = np.mean([now[i] - before[i] for i in stayed], axis=0)
        since = {i: before[i] for i in stayed}
        lifted = {
            at: LiftOff(before[i] + shift, self._looked[i], since)
            for at, i in enumerate(self._ids)
            if i not in now
        }
        for at, contact in enumerate(self._lifted, len(self._ids)):
            lifted[at] = contact.carried(shift)
        return {at: contact for at, contact in lifted.items() if contact.remembered(now)}

    def _believed(self, stayed: tuple[int, ...], lifted: Mapping[int, LiftOff]) -> Array:
        """The belief so far about contacts that stayed and some recent lift-offs, in this order."""
        places = (*(self._ids.index(i) for i in stayed), *lifted)
        return summed(self._joint, len(self._ids) + len(self._lifted), places)

    def _carry_on(self, ids: tuple[int, ...], lifted: Mapping[int, LiftOff]) -> None:
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

    def _changed(self, ids: tuple[int, ...], lifted: Mapping[int, LiftOff]) -> bool:
        return ids != self._ids or len(lifted) != len(self._lifted)

    def _judge_new(
        self,
        ids: tuple[int, ...],
        stayed: tuple[int, ...],
        came: tuple[int, ...],
        lifted: Mapping[int, LiftOff],
    ) -> None:
        others = that_fit(lifted, len(FINGERS) - len(ids))
        count = len(ids) + len(others)
        joint = self._grown(stayed, {}, came)
        if others:
            apart = self._grown(stayed, others, came)
            touching = [*range(len(stayed)), *range(len(stayed) + len(others), count)]
            apart = summed(apart, count, touching)
            # Both lack the density of their layouts, so that only shares can be compared.
            apart, joint = normalised(apart), normalised(joint)
            back = AT_ONCE if any(contact.just for contact in others.values()) else LATER
            joint = functions.log_sum_exp(log(1.0 - back) + apart, log(back) + joint)
        here = (*stayed, *came)
        self._joint = bounded(summed(joint, len(ids), [here.index(i) for i in ids]))
        self._ids, self._lifted, self._looked = ids, (), self._places

    def _grown(
        self, stayed: tuple[int, ...], lifted: Mapping[int, LiftOff], came: tuple[int, ...]
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
