"""PAALM (2013), section 4: joint angles from the directions and lengths of fingers.

Calibration measures the standard length of every finger of an open hand. In later frames, fingers
are first labelled. A finger's length divided by its standard length (the length ratio) gives the
distance of its tip from its knuckle. Distance and direction give a target, and the inverse
kinematics of the finger's chain gives angles. A finger that is no longer seen stays in place, in
palm coordinates, until it is seen again.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from math import exp, inf, sqrt

import numpy as np

from encoders.paalm.angles import by_name
from encoders.paalm.calibration import (
    ENOUGH,
    PAPER_FRAMES,
    HandCalibration,
    calibrated,
    longest_calibration,
    measure,
    pointing,
)
from encoders.paalm.chain import Bend
from encoders.paalm.coupling import LearnedCoupling
from encoders.paalm.identity import HandSides, TrackedIdentity, paper_order
from encoders.paalm.options import Hands, PaalmOptions
from encoders.paalm.palm import Palm, palm_of, stacked
from encoders.paalm.rig import (
    RiggedFinger,
    assumed_coupling,
    average_knuckle,
    rig,
    shares_behind,
    with_palm_shift,
)
from encoders.paalm.seen_palm import OVERREACH, LearnedPalm, slip
from models.arithmetic import Array
from models.errors import EncoderError
from models.frames import FINGERS, HandFrame, TrackedHand, Vector

STEADY = 0.007
"""Mean second difference (m) of a fingertip for which a time constant of one frame is enough. A
low-pass with time constant T reduces white noise of variance v to v dt / 2T. The time constant
therefore grows with the square of the noise."""
TIP_STEADY = 0.003
"""Acceptable mean second difference (m) for fingers that are solved by their tips."""
_SHARE = 1.0 / 16.0
"""Weight of a new difference in the running mean; the mean covers about a quarter of a second."""
_JUMP = 3.0
"""Limit of a new difference, as a multiple of the mean. It bounds the effect of the single jump of
a finger that was lost for a moment."""


class FingertipNoise:
    """Measures the noise of one fingertip.

    Args:
        steady: Acceptable mean second difference (m), see `STEADY`.

    Attributes:
        mean: Running mean (m) of the fingertip's second differences.
    """

    __slots__ = ("_before", "_last", "_steady", "mean")

    def __init__(self, steady: float = STEADY) -> None:
        self.mean = 0.0
        self._steady = steady
        self.interrupt()

    def interrupt(self) -> None:
        """Records that the finger is not seen, so that the next position has no predecessor."""
        self._last: Vector | None = None
        self._before: Vector | None = None

    def add(self, place: Vector) -> None:
        """Adds the position (m) in the next frame."""
        a, b = self._before, self._last
        self._before, self._last = b, place
        if a is None or b is None:
            return
        x = a[0] - 2.0 * b[0] + place[0]
        y = a[1] - 2.0 * b[1] + place[1]
        z = a[2] - 2.0 * b[2] + place[2]
        mean, steady = self.mean, self._steady
        most = _JUMP * (mean if mean >= steady else steady)
        difference = sqrt(x * x + y * y + z * z)
        self.mean += _SHARE * ((most if difference > most else difference) - mean)

    def constant(self, dt: float, least: float, most: float) -> float:
        """Time constant (s) of a low-pass that makes the fingertip steady.

        Args:
            dt: Time (s) between frames.
            least, most: Limits (s) of the time constant.
        """
        return min(max(dt * (self.mean / self._steady) ** 2, least), most)


TIP_SMOOTHING = 1.0 / 3.0
"""Factor on `PaalmOptions.smoothing` for fingers that are solved by their tips."""


@dataclass(frozen=True)
class PaalmHand:
    """Result for one hand at one moment.

    Attributes:
        side: `right` or `left`.
        bends: Angles of the five fingers.
        ratios: Length divided by standard length, by finger; for held fingers, the last ratio.
        ids: The device's id by finger; None for a held finger.
        held: Fingers that are not seen now; they stay in place.
        hand_id: The device's id of the hand, or its last id if the hand is not seen now.
        palm: Palm of the hand in the device's frame. Its centre is placed so that its knuckles are
            those of the rig. The device's centre may differ (`HandCalibration.palm_shift`).
        places: Target (3,) m of each of the five fingers relative to the finger's base, along the
            palm's axes, in the rig's scale.
        seen: True if the hand is seen now.
    """

    side: str
    bends: tuple[Bend, ...]
    ratios: dict[str, float]
    ids: dict[str, int | None]
    held: frozenset[str]
    hand_id: int
    palm: Palm
    places: tuple[Vector, ...]
    seen: bool

    @cached_property
    def table(self) -> Array:
        """Angles (5, 4), degrees: first joint's flexion and spread, then second and third joint."""
        return np.array([bend[:4] for bend in self.bends])

    @cached_property
    def targets(self) -> Array:
        """`places` as an array (5, 3), m."""
        return np.array(self.places)

    @cached_property
    def miss(self) -> Array:
        """Distances (5,) m of the tips from their targets, in the rig's scale."""
        return np.array([bend.miss for bend in self.bends])

    @property
    def angles(self) -> dict[str, float]:
        """Angles (degrees) by name, such as `index_mcp_flexion`, `index_mcp_spread`."""
        return by_name(self.table)


@dataclass(frozen=True)
class PaalmFrame:
    """Results for all configured hands at one moment.

    Attributes:
        time: The device's time (s).
        hands: Hands by side; a hand that was never seen is missing.
        refused: Reason why this frame was ignored; None if it was used.
    """

    time: float
    hands: dict[str, PaalmHand]
    refused: str | None = None


class Paalm:
    """PAALM, the method of the paper of 2013: joint angles of hands over a Leap.

    `calibrate(frames)` measures hands that are held open, once. `step(frame)` then gives joint
    angles, palm and finger labels of every calibrated hand of a `HandFrame` (m, in the device's
    frame).

    Args:
        options: Choices that the paper leaves open.
    """

    def __init__(self, options: PaalmOptions | None = None) -> None:
        self.options = options or PaalmOptions()
        self.calibration: dict[str, HandCalibration] = {}
        self.counts: Counter[str] = Counter()
        self._hands: dict[str, _Hand] = {}
        self._sides = HandSides(())
        self._time: float | None = None

    def calibrate(
        self,
        frames: Iterable[HandFrame],
        hands: Hands = "right",
        wanted: int = PAPER_FRAMES,
        progress: Callable[[float], None] | None = None,
    ) -> dict[str, HandCalibration]:
        """Measures hands that are held open: palm down, fingers spread.

        A hand without joints that is solved by its tips is measured by its longest lengths. This
        needs `ENOUGH` frames in which each finger has its full length.

        Args:
            frames: Frames. Only as many are read as are needed.
            hands: `right`, `left` or `both`.
            wanted: Number of frames with five fingers for each hand.
            progress: Called with the share done, 0 to 1.

        Raises:
            EncoderError: The hands were not seen, not open, or not still; the error gives the
                reason.
        """
        sides = {"right": ("right",), "left": ("left",), "both": ("right", "left")}.get(hands)
        if sides is None:
            raise EncoderError(
                "no such hand to calibrate",
                got=str(hands),
                expected="right, left or both",
            )
        if wanted < 1:
            raise EncoderError("nothing to measure", got=wanted, expected="1 frame or more")
        chooser = HandSides(sides)
        samples: dict[str, list[tuple[float, TrackedHand | None]]] = {s: [] for s in sides}
        counts = dict.fromkeys(sides, 0)
        dialect = None
        for frame in frames:
            dialect = dialect or frame.dialect
            chosen = {} if stacked_hands(frame) else chooser.choose(frame)
            for side in sides:
                hand = chosen.get(side)
                samples[side].append((frame.time, hand))
                counts[side] += hand is not None and len(hand.fingers) == len(FINGERS)
            if progress is not None:
                progress(min(1.0, min(counts.values()) / wanted))
            if min(counts.values()) >= wanted:
                break
        self.use({s: self._measured(samples[s], s, wanted, dialect) for s in sides})
        return self.calibration

    def _measured(
        self,
        samples: list[tuple[float, TrackedHand | None]],
        side: str,
        wanted: int,
        dialect: str | None,
    ) -> HandCalibration:
        jointed = any(f.joints for _, hand in samples if hand for f in hand.fingers)
        if jointed or self.options.solve == "lengths":
            return calibrated(samples, side, wanted, None, dialect)
        least = min(ENOUGH, wanted)
        return with_palm_shift(longest_calibration(samples, side, least), self.options)

    def use(self, calibration: Mapping[str, HandCalibration]) -> None:
        """Uses earlier calibrations, by side."""
        self.calibration = dict(calibration)
        self._hands = {s: _Hand(c, self.options) for s, c in calibration.items()}
        self._sides = HandSides(tuple(calibration), self.counts)
        self.reset()

    def reset(self) -> None:
        """Forgets all frames, but not calibration and counts."""
        self._time = None
        self._sides.reset()
        for hand in self._hands.values():
            hand.reset()

    def step(self, frame: HandFrame) -> PaalmFrame:
        """Processes a frame. An unusable frame is counted, and the hands stay in their state.

        Raises:
            EncoderError: No hand is calibrated yet.
        """
        if not self._hands:
            raise EncoderError("PAALM needs a calibration first", remedy="Call calibrate(frames)")
        refused = None
        if self._time is not None and frame.time < self._time:
            refused = "the time runs backwards"
        elif stacked_hands(frame):
            refused = "one hand is above the other"
        if refused is not None:
            self.counts[refused] += 1
            hands = {s: h.held_result() for s, h in self._hands.items()}
            return PaalmFrame(frame.time, {s: h for s, h in hands.items() if h}, refused)
        dt = 0.0 if self._time is None else frame.time - self._time
        self._time = frame.time
        chosen = self._sides.choose(frame)
        self.counts["frames"] += 1
        results: dict[str, PaalmHand] = {}
        for side, hand in self._hands.items():
            seen = chosen.get(side)
            if seen is not None and len(seen.fingers) > len(FINGERS):
                self.counts["hands with more than five fingers"] += 1
                seen = None
            now = hand.held_result() if seen is None else hand.step(seen, frame.time, dt)
            if now is not None:
                results[side] = now
        return PaalmFrame(frame.time, results)


class _Hand:
    """State of one calibrated hand."""

    def __init__(self, calibration: HandCalibration, options: PaalmOptions) -> None:
        self._calibration, self._options = calibration, options
        self._rig: list[RiggedFinger] = rig(calibration, options)
        self._identity = TrackedIdentity(calibration, np.array([r.knuckle for r in self._rig]))
        self.reset()

    def reset(self) -> None:
        options = self._options
        self._coupling: LearnedCoupling | None = None
        if options.learns and options.coupling is None:
            self._coupling = LearnedCoupling(assumed_coupling(self._calibration, options))
        self._rig = rig(self._calibration, options)
        self._identity.reset()
        self._standard: list[float] = self._calibration.standard.tolist()
        self._moved = (0.0, 0.0, 0.0)
        shift = self._calibration.palm_shift
        self._learned_palm: LearnedPalm | None = None
        if options.learns and shift is not None and not self._calibration.measured:
            knuckles = [average_knuckle(finger) for finger in range(len(FINGERS))]
            self._learned_palm = LearnedPalm(
                shift, self._standard, shares_behind(options), knuckles
            )
        self._last: PaalmHand | None = None
        self._targets: list[Vector] = []
        for rigged, along in zip(self._rig, self._calibration.directions.tolist(), strict=True):
            x, y, z = (c * rigged.open_length for c in along)
            self._targets.append((x, y, z))
        self._latest = list(self._targets)
        self._bends = [Bend(0.0, 0.0, 0.0, 0.0, 0.0)] * len(FINGERS)
        self._ratios = [1.0] * len(FINGERS)
        self._unseen = [0.0] * len(FINGERS)
        # Tips are less noisy than lengths.
        steady = TIP_STEADY if self._calibration.by_tip and options.solve == "tips" else STEADY
        self._noise = [FingertipNoise(steady) for _ in FINGERS]
        self._palm: Palm | None = None
        self._id = 0
        self._slip = 0.0
        for finger in range(len(FINGERS)):
            self._solve(finger)

    def held_result(self) -> PaalmHand | None:
        """The hand while the device does not see it; None if it was never seen."""
        if self._last is None or self._palm is None:
            return None
        return self._result(self._palm, dict.fromkeys(FINGERS), False)

    def step(self, hand: TrackedHand, time: float, dt: float) -> PaalmHand:
        side, options = self._calibration.side, self._options
        palm = palm_of(hand, side)
        if self._coupling and self._coupling.add(hand):
            self._rig = rig(replace(self._calibration, coupling=self._coupling.used), options)
        fingers = hand.fingers
        if fingers and all(f.finger is not None for f in fingers):
            names = [f.finger or 0 for f in fingers]
        elif options.identity == "tracked":
            names = self._identity.names(fingers, palm, time)
        else:
            names = paper_order(fingers, side)
        smoothing = options.smoothing * (TIP_SMOOTHING if self._calibration.by_tip else 1.0)
        smooth = smoothing > 0.0 and self._last is not None
        ids: dict[str, int | None] = dict.fromkeys(FINGERS)
        if self._learned_palm:
            self._learn(self._learned_palm, hand, palm, names)
        for finger, name in zip(fingers, names, strict=True):
            rigged = self._rig[name]
            length = measure(finger)
            self._ratios[name] = length / self._standard[name]
            if rigged.from_knuckle:
                tip, k, s = palm.place(finger.tip), rigged.knuckle, rigged.scale
                m = self._moved
                new = (
                    s * (tip[0] - k[0] - m[0]),
                    s * (tip[1] - k[1] - m[1]),
                    s * (tip[2] - k[2] - m[2]),
                )
            else:
                # The paper's target: direction * ratio * length of the rig's finger.
                d, s = palm.turn(pointing(finger)), self._ratios[name] * rigged.open_length
                new = (s * d[0], s * d[1], s * d[2])
            self._latest[name] = new
            keep = 0.0
            if smooth:
                noise = self._noise[name]
                noise.add(new)
                since = dt + (self._unseen[name] if options.solve == "tips" else 0.0)
                keep = exp(-since / noise.constant(dt, smoothing, options.longest))
            old = self._targets[name]
            self._targets[name] = (
                new[0] + keep * (old[0] - new[0]),
                new[1] + keep * (old[1] - new[1]),
                new[2] + keep * (old[2] - new[2]),
            )
            self._unseen[name] = 0.0
            ids[FINGERS[name]] = finger.id
        before = self._slip
        if self._calibration.by_tip:
            seen = [(self._rig[n].chain, self._targets[n]) for n in names if n]
            now = slip(seen, OVERREACH if options.solve == "tips" else inf)
            keep = exp(-dt / smoothing) if smooth else 0.0
            self._slip = now + keep * (self._slip - now)
        for name in names:
            self._solve(name)
        for name, label in enumerate(FINGERS):
            if ids[label] is None:
                self._hold(name, dt, before)
        self._palm, self._id = palm, hand.id
        return self._result(palm, ids, True)

    def _learn(self, learned: LearnedPalm, hand: TrackedHand, palm: Palm, names: list[int]) -> None:
        """Learns the palm's position from this frame. The next frame's labels use it."""
        for finger, name in zip(hand.fingers, names, strict=True):
            place = palm.place(finger.tip)
            learned.add(name, finger.length, place, palm.turn(finger.direction))
        learned.move()
        a, b = learned.shift, self._calibration.palm_shift or learned.shift
        self._moved = (a[0] - b[0], a[1] - b[1], a[2] - b[2])
        self._standard = list(learned.standard)
        self._identity.learn(self._moved, self._standard)

    def _solve(self, name: int, held: bool = False) -> None:
        target = self._targets[name]
        if abs(target[0]) + abs(target[1]) + abs(target[2]) < 1e-6:
            return  # The target has no direction, so the finger stays as it is.
        rigged = self._rig[name]
        x, y, z = target
        y += 0.0 if held else self._slip
        self._bends[name] = rigged.bend((x, y, z))

    def _hold(self, name: int, dt: float, slip: float) -> None:
        """Holds a finger that is not seen at its last position, as in the paper.

        Position and slip of the palm are those of the last frame that showed the finger. With
        `solve="lengths"`, the slip is that of the current frame.
        """
        held = self._options.solve == "tips"
        if self._unseen[name] == 0.0:
            # The last measured position, not the smoothed position.
            x, y, z = self._latest[name]
            self._targets[name] = x, y + (slip if held else 0.0), z
            self._solve(name, held)
        self._noise[name].interrupt()
        self._unseen[name] += dt

    def _result(self, palm: Palm, ids: dict[str, int | None], seen: bool) -> PaalmHand:
        shift, m = self._calibration.palm_shift, self._moved
        self._last = PaalmHand(
            self._calibration.side,
            tuple(self._bends),
            dict(zip(FINGERS, self._ratios, strict=True)),
            ids,
            frozenset(f for f in FINGERS if ids[f] is None),
            self._id,
            palm
            if shift is None
            else palm.shifted((shift[0] + m[0], shift[1] + m[1] - self._slip, shift[2] + m[2])),
            tuple(self._targets),
            seen,
        )
        return self._last


def stacked_hands(frame: HandFrame) -> bool:
    """True if one hand of a frame is above another, so that the frame is unusable."""
    hands = frame.hands
    return any(stacked(a, b) for i, a in enumerate(hands) for b in hands[:i])
