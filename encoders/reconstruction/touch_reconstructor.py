"""Reconstructor that turns successive touch frames into poses of the whole hand.

Each step computes touches -> tracks -> labels -> contact vector -> encoder -> smoothing ->
fingertip correction -> lift -> rate limit -> commanded pose. The arrival then determines the hand's
height for the next step. Live sessions and replays use the same object.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from math import inf, isfinite, sqrt

import numpy as np

from encoders.correction import PAD_HEIGHT, CorrectionSettings, FingertipCorrection
from encoders.input_vector import contact_vector
from encoders.labels.labelling import Labeller, Labelling
from encoders.reconstruction.contact_tracker import ContactTracker, TrackerSettings
from encoders.reconstruction.hand_motion import (
    Arrival,
    ArrivalSettings,
    Lift,
    LiftSettings,
    Motion,
    Phase,
    PoseFilter,
    RateLimit,
    RecentPlaces,
    common_motion,
)
from encoders.reconstruction.reconstructor import Reconstruction
from encoders.regression.trained import TrainedModel
from models.arithmetic import Array, distance
from models.errors import EncoderError
from models.frames import FINGERS, Contact, TouchFrame
from models.pose import ROOT_POSITION, absolute_pose, within_limits
from models.single_pose import SinglePose
from models.skeleton import Skeleton
from models.surface import METRES_PER_INCH, Surface

TURN_LENGTH = 0.08
"""Distance (m) from wrist to knuckles: converts an error of the hand's rotation (rad) to an error
of position."""

_LOW = (Phase.COMING_DOWN, Phase.DOWN)

_SETTLED = 0.010
"""Length (rad and m) of an iteration's step below which the correction of a frame stops. The next
frame, 16 ms later, continues from the result. While fingers rest, the posture therefore converges
to the most likely posture. With 0.003 instead, a frame takes 2.4 steps on average rather than 1.4,
and the posture differs by less than a degree."""

_UNLIKELY = 0.1
"""If the labels of a hand that is down are less probable than this, the fifth finger may change
them."""


@dataclass(frozen=True)
class ReconstructorSettings:
    """Settings of the steps between touches and pose.

    Attributes:
        tracker: Handling of drop-outs and palms, smoothing of touches.
        arrival: Arrival and departure of the hand.
        lift: Effect of the lift control.
        correction: Correction of fingertips to touches; None switches it off.
        posture_tau: Time constant of the posture filter (s); 0 switches it off.
        encode: False uses the mean training pose instead of the encoder's pose (an ablation).
        rate: Speed limits of the commanded pose while the hand comes down or is down. While the
            hand is up, nothing is in its way. Its limits are then at least those of `RateLimit()`,
            so that people do not wait for the hand.
        device_labels: True uses the labels of devices that report labels.
    """

    tracker: TrackerSettings = field(default_factory=TrackerSettings)
    arrival: ArrivalSettings = field(default_factory=ArrivalSettings)
    lift: LiftSettings = field(default_factory=LiftSettings)
    correction: CorrectionSettings | None = field(default_factory=CorrectionSettings)
    posture_tau: float = 0.10
    encode: bool = True
    rate: RateLimit = field(default_factory=RateLimit)
    device_labels: bool = True


class TouchReconstructor:
    """Reconstructs one hand with its labeller, encoder, filter, correction and arrival.

    Args:
        model: Trained encoder with the covariance of its errors.
        labeller: Labels the contacts.
        skeleton: The hand whose fingertips should meet the touches.
        surface: Surface of the touches in the world.
        settings: See `ReconstructorSettings`.

    Attributes:
        empty: A frame without touches.
        notice: Always empty, since touches can always be followed.
    """

    empty = TouchFrame(0.0)
    notice = ""

    def __init__(
        self,
        model: TrainedModel,
        labeller: Labeller,
        skeleton: Skeleton,
        surface: Surface,
        settings: ReconstructorSettings | None = None,
    ) -> None:
        self.model, self.labeller, self.surface = model, labeller, surface
        self.settings = settings or ReconstructorSettings()
        self._rate_above = self.settings.rate.or_faster(RateLimit())
        self._skeleton, self._hand = skeleton, SinglePose(skeleton)
        s = self.settings
        self._correction = (
            FingertipCorrection(skeleton, model.residual_covariance, s.correction)
            if s.correction
            else None
        )
        self._mean = model.training_pose.mean(axis=0)
        self._tracker = ContactTracker(s.tracker)
        self._arrival = Arrival(s.arrival)
        self._recent = RecentPlaces(s.arrival.dwell)
        self._lift = Lift(s.lift)
        self._filter = PoseFilter(s.posture_tau)
        self.reset()

    @property
    def counts(self) -> dict[str, int]:
        """Number of ignored or repaired contacts, by reason."""
        return self._tracker.counts

    @property
    def commanded(self) -> Array:
        """The pose last commanded (48,), in the world; a simulation starts its hand there."""
        return self.surface.pose_to_world(self._commanded)

    def set_tip_offsets(self, offsets: Array | None) -> None:
        """Sets the offsets from touches to fingertips, from the next step on.

        Args:
            offsets: (5, 2) m along the surface, y down; None sets all to 0.
        """
        self._offsets: Array | None = offsets

    def reset(self) -> None:
        """Returns to the initial state: a hand without contacts that hovers over the middle of the
        surface."""
        self.set_tip_offsets(None)
        self._tracker.reset()
        self._arrival.reset()
        self._recent.reset()
        self._lift.reset()
        self._filter.reset()
        self.labeller.restart()
        # These mappings are never modified in place, only replaced.
        self._labels: Mapping[int, int] = {}
        self._labelling = Labelling({}, 1.0)
        self._previous_labels: Mapping[int, int] = {}
        self._same_grasp = False
        self._known: frozenset[int] = frozenset()
        self._changed_at = -np.inf
        self._time: float | None = None
        self._last_xy: dict[int, tuple[float, float]] = {}
        width, height = self.surface.size
        middle = absolute_pose(self._mean, (width / 2, height / 2))
        self._surface_pose = within_limits(self._centred(middle), self._skeleton)
        self._commanded = self._raised(self._surface_pose)
        self._tip_error = 0.0

    def step(self, frame: TouchFrame) -> Reconstruction:
        """Processes a touch frame; called once per control step, even if nothing has changed.

        Args:
            frame: Current contacts; `frame.time` is session time and never runs backwards.
        """
        dt = 0.0 if self._time is None else max(frame.time - self._time, 0.0)
        self._time = frame.time
        self._tracker.step(frame)
        tracks = self._tracker.tracks
        self._labels = {i: f for i, f in self._labels.items() if i in tracks}
        low = self._arrival.phase in _LOW
        self._name(frame.time, low)
        motion, speed = self._motion(dt, low)
        self._recent.step(frame.time, self._last_xy)
        self._same_grasp = self._labels == self._previous_labels
        self._previous_labels = self._labels
        named = {i: tracks[i].place for i in self._labels}
        u = None
        if named:
            u = contact_vector(
                {
                    self._labels[i]: (x / METRES_PER_INCH, y / METRES_PER_INCH)
                    for i, (x, y) in named.items()
                }
            )
            self._surface_pose = self._reconstruct(named, u, motion, dt)
        self._lift.step(frame.lift, dt)
        goal = self._raised(self._surface_pose)
        rate = self.settings.rate if low else self._rate_above
        self._commanded = rate(self._commanded, goal, dt)
        self._arrival.step(
            dt,
            touched=bool(named) if self._arrival.phase is Phase.DOWN else bool(tracks),
            named=len(named) == len(tracks) > 0,
            speed=speed,
            # This distance is not needed without tracks, or once the hand is coming down.
            off=self._off(goal) if tracks and not low else 0.0,
            moved=inf if low else self._recent.moved,
        )
        if not tracks:
            self._filter.reset()
            self.labeller.reset()
        return Reconstruction(
            q=self.surface.pose_to_world(self._commanded),
            phase=self._arrival.phase,
            fingers=frozenset(self._labels.values()),
            u=u,
            probability=self._labelling.probability,
            tip_error=self._tip_error,
            see=self._contacts(),
            touches={self._labels[i]: place for i, place in named.items()},
            tip_height=PAD_HEIGHT + self._lift.height,
        )

    def _name(self, time: float, low: bool) -> None:
        """Labels the contacts once their set has been stable for a while.

        Until the hand comes down, labels may change; the posture filter smooths such changes. From
        then on, labels stay, since a change would break the grasp. A finger that joins gets one of
        the free labels. Only the fifth finger may change the earlier labels, since five touches
        show which finger is which: somebody may put five fingers down slowly, one after another.
        """
        tracks = self._tracker.tracks
        present = frozenset(tracks)
        if present - self._known:
            self._changed_at = time
        self._known = present
        settle = self.settings.arrival.settle if self.settings.arrival.hover > 0 else 0.0
        unsure = [
            i
            for i, t in tracks.items()
            if i not in self._labels and (t.unsure or (low and time < t.joins - 1e-9))
        ]
        if unsure:
            # A hand that is up waits until every contact is known to be a finger. A hand that is
            # down ignores unsure contacts.
            if not low:
                return
            tracks = {i: t for i, t in tracks.items() if i not in unsure}
        # A labeller with history learns from moving touches and lifted fingers even while the hand
        # is down and its labels are not used.
        again = self.labeller.remembers and settle > 0
        named = len(self._labels) == len(tracks)
        if not tracks or (named and not again) or time - self._changed_at < settle - 1e-9:
            return
        fixed = self._labels if low and settle > 0 else {}
        given = {i: t.device_label for i, t in tracks.items() if t.device_label is not None}
        if self.settings.device_labels and len(set(given.values())) == len(tracks):
            self._labelling = Labelling(given, 1.0)
        else:
            places = {i: t.place for i, t in tracks.items()}
            self._labelling = self.labeller.assign(places, fixed)
            fifth_joins = 0 < len(fixed) < len(places) == len(FINGERS)
            if fifth_joins and self._labelling.probability < _UNLIKELY:
                self._labelling = self.labeller.assign(places, {})
        self._labels = self._labelling.labels

    def _motion(self, dt: float, low: bool) -> tuple[Motion, float]:
        """Common motion of the touches since the last step, and the speed (m/s) of the fastest
        touch. Once the hand is coming down, the speed is not needed and is 0."""
        tracks = self._tracker.tracks
        now = {i: t.place for i, t in tracks.items() if not t.unsure or i in self._labels}
        known = [i for i in now if i in self._last_xy]
        before, after = [self._last_xy[i] for i in known], [now[i] for i in known]
        self._last_xy = now
        motion = common_motion(before, after)
        if low or not known or dt <= 0:
            return motion, 0.0
        return motion, max(map(distance, before, after)) / dt

    def _reconstruct(
        self, named: dict[int, tuple[float, float]], u: Array, motion: Motion, dt: float
    ) -> Array:
        """The pose (48,) in the 3-D surface frame, at height 0."""
        ids = sorted(named)
        labels = [self._labels[i] for i in ids]
        places = [named[i] for i in ids]
        if self._offsets is None:
            above = [(x, -y, PAD_HEIGHT) for x, y in places]
        else:
            offsets = self._offsets.tolist()
            above = [
                (x + offsets[f][0], -y - offsets[f][1], PAD_HEIGHT)
                for f, (x, y) in zip(labels, places, strict=True)
            ]
        targets = np.array(above)
        carried = motion.carried
        if len(ids) == 1:
            # A single touch has no layout that determines a posture: the posture stays, and the
            # hand follows the finger.
            guess = self._filter.step(_carried(self._surface_pose, *carried), (0.0, 0.0), dt)
            guess = self._shifted(guess, labels, targets)
        else:
            relative = self._predicted(u) if self.settings.encode else self._mean
            guess = _carried(relative, *min(places))
            if not self.settings.encode:
                guess = self._shifted(guess, labels, targets)
            guess = self._filter.step(guess, carried, dt, motion.turn, motion.about)
        if self._correction is None:
            self._tip_error = float("nan")
            return within_limits(guess, self._skeleton)
        # The iteration starts at the last pose, shifted with the touches. If the labels have
        # changed, it starts at the guess, which is then nearer to the solution.
        start = _carried(self._surface_pose, *carried) if self._same_grasp else None
        settled = None if start is None else _SETTLED
        corrected = self._correction.correct(guess, labels, targets, start, settled)
        self._tip_error = corrected.error
        return corrected.q

    def _predicted(self, u: Array) -> Array:
        """The relative pose (48,) that the encoder predicts.

        Raises:
            EncoderError: The pose is not finite, for example because a custom encoder does not
                handle these contacts.
        """
        relative = self.model.encoder.predict(u)
        # The sum is a quick test: it is not finite if an element is not finite. It may also be
        # infinite for huge finite elements, so the elements are then tested themselves.
        if not isfinite(np.add.reduce(relative)) and not np.isfinite(relative).all():
            raise EncoderError(
                "the encoder predicts a pose that is not finite",
                where=f"{type(self.model.encoder).__qualname__}.predict",
                got=f"for the contact vector {np.round(u, 3).tolist()}",
                expected="48 finite numbers",
            )
        return relative

    def _shifted(self, q: Array, labels: list[int], targets: Array) -> Array:
        """The pose moved so that its tips lie on their targets on average."""
        q = q.copy()
        q[ROOT_POSITION] += np.mean(targets - self._hand.tips(q)[labels], axis=0)
        return q

    def _centred(self, q: Array) -> Array:
        """The pose moved so that the middle of its fingertips is over the middle of the surface."""
        width, height = self.surface.size
        middle = np.array([width / 2, -height / 2])
        q = q.copy()
        q[:2] += middle - self._hand.tips(q).mean(axis=0)[:2]
        return q

    def _raised(self, q: Array) -> Array:
        """The pose at the height given by arrival and lift control. (A hand that the lift control
        raises may be in the phase `down`.)"""
        q = q.copy()
        q[2] += self._arrival.height + self._lift.height
        return q

    def _off(self, goal: Array) -> float:
        """Distance (m) of the commanded hand from its goal, seen along the surface's normal. The
        largest rotation, times `TURN_LENGTH`, is added."""
        rest = np.abs(goal - self._commanded)
        x, y = rest[:2].tolist()
        return sqrt(x * x + y * y) + TURN_LENGTH * float(np.maximum.reduce(rest[3:]))

    def _contacts(self) -> Callable[[], tuple[Contact, ...]]:
        """Function that computes, when it is called, all contacts on the surface at this step."""
        tracker = self._tracker
        tracks = [(i, t.device_id, t.place, t.lost_at is None) for i, t in tracker.tracks.items()]
        return partial(
            _labelled, tracks, self._labels, self._labelling, tracker.ignored, tracker.palms
        )


def _labelled(
    tracks: Sequence[tuple[int, int, tuple[float, float], bool]],
    labels: Mapping[int, int],
    labelling: Labelling,
    ignored: Sequence[Contact],
    palms: frozenset[int],
) -> tuple[Contact, ...]:
    """Contacts with labels and states, from a tracker's tracks and ignored contacts."""
    probabilities = labelling.label_probabilities
    tracked = [
        Contact(
            device_id,
            *place,
            label=labels.get(i),
            state="active" if active else "lost",
            probability=probabilities[i] if i in labels else 1.0,
        )
        for i, device_id, place, active in tracks
    ]
    return (
        *tracked,
        *(Contact(c.id, c.x, c.y, state="palm" if c.id in palms else "ignored") for c in ignored),
    )


def _carried(q: Array, right: float, down: float) -> Array:
    """The pose (48,) shifted along the surface, m."""
    q = q.copy()
    q[0] += right
    q[1] -= down
    return q
