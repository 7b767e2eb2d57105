"""PAALM as a reconstructor: it turns hand frames, one after another, into poses of the whole hand.

It has the interface of `encoders.reconstruction.touch_reconstructor`, so that whatever drives a
hand by touches can drive one by a Leap: `step(frame)`, `reset()`, `commanded`, and a
`Reconstruction`.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import exp, inf

import numpy as np

from encoders.paalm.average import average_calibration
from encoders.paalm.hand_pose import hand_pose
from encoders.paalm.paalm import Paalm, PaalmHand
from encoders.paalm.palm import Palm
from encoders.reconstruction.arrival import Phase
from encoders.reconstruction.touch_reconstructor import Reconstruction
from models.arithmetic.arrays import Array
from models.arithmetic.products import length
from models.errors import EncoderError
from models.frames import FINGERS, HandFrame, Vector
from models.limits import RateLimit
from models.messages.message import Message
from models.one_pose import OnePose
from models.person import Person
from models.pose import ROOT_POSITION, ROOT_ROTATION
from models.rotations import unwrapped
from models.skeleton import ADULT
from models.surface import Surface

_ALL = frozenset(range(len(FINGERS)))

NOTICE_LASTS = 1.0
"""s that a notice to the person stays after its cause has ended."""
UNSEEN_NOTICE = 1.0
"""s that a hand is an unseen ghost before the person gets a notice."""


@dataclass(frozen=True)
class HandReconstructorSettings:
    """Settings of the steps between hand frames and pose.

    Attributes:
        device: m, position of the device in the world. Its axes are the world's.
        rate: Speed limits of the commanded pose.
        size: Length of the simulated hand relative to the average one.
        root_smoothing: s, time constant of the palm's position and rotation; 0 switches it off.
            PAALM smooths fingers itself.
        patience: s that a lost hand keeps its pose and stays solid: devices lose hands for moments,
            and a held box should not fall each time.
        rise, rise_speed: m by which, and m/s at which, a hand that stays lost rises as a ghost, so
        that it does not hide objects. near: m from its place within which a returned hand may be
        solid again. floor: m, least world height of a commanded fingertip; the whole hand is
        raised. People do not feel the table, and a hand pushed into it would crush a held object.
    """

    device: Vector = (0.0, 0.0, -0.10)
    rate: RateLimit = field(default_factory=RateLimit)
    size: float = 1.0
    root_smoothing: float = 0.04
    patience: float = 0.3
    rise: float = 0.08
    rise_speed: float = 0.15
    near: float = 0.02
    floor: float = 0.0


class HandReconstructor:
    """Reconstructs one hand of a `Paalm` as poses of the sandbox's hand.

    Args:
        paalm: PAALM state, owned by this reconstructor from now on.
        side: `right` or `left`.
        settings: Settings of all steps.
        surface: Workspace of a task; None is the default tablet.
        assume: True lets an uncalibrated hand be treated as average, or be measured by the device's
            own bones, when it is first seen.

    Attributes:
        empty: The frame that stands for a device before its first one.

    Raises:
        EncoderError: PAALM has not measured that hand, and `assume` is false.
    """

    empty = HandFrame(0.0)

    def __init__(
        self,
        paalm: Paalm,
        side: str = "right",
        settings: HandReconstructorSettings | None = None,
        surface: Surface | None = None,
        assume: bool = False,
    ) -> None:
        self._assume = assume and side not in paalm.calibration
        if side not in paalm.calibration and not assume:
            raise EncoderError(
                "this hand was not calibrated",
                got=side,
                expected=", ".join(paalm.calibration) or "a calibrated PAALM",
            )
        self.paalm, self.side = paalm, side
        self.settings = settings or HandReconstructorSettings()
        self.surface = surface or Surface()
        skeleton = Person(side, self.settings.size).skeleton(ADULT)
        self._tips, self._radius = OnePose(skeleton), skeleton.tip_radius
        self.reset()

    @property
    def counts(self) -> dict[str, int]:
        """Number of frames or hands that could not be used, by reason."""
        return self.paalm.counts

    @property
    def commanded(self) -> Array:
        """The pose last commanded (48,), in the world."""
        return self._commanded

    @property
    def notice(self) -> str:
        """Notice to the person whose hand is not tracked; empty while all is well."""
        if self._refused and (self._time or 0.0) - self._refused_at < NOTICE_LASTS:
            return Message("hands_apart", "{why}: hold them apart", why=self._refused)
        if self._unseen > self.settings.patience + UNSEEN_NOTICE:
            return Message(
                "hand_unseen",
                "the {side} hand is not seen: hold it over the device",
                side=self.side,
            )
        return ""

    def reset(self) -> None:
        """Returns to the initial state: an open hand 20 cm over the device."""
        if self._assume:
            self.paalm.use({})
        self.paalm.reset()
        self._time: float | None = None
        across = (1.0, 0.0, 0.0) if self.side == "right" else (-1.0, 0.0, 0.0)
        palm = Palm((0.0, 0.0, 0.20), across, (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
        self._commanded = self._goal = self._pose(np.zeros((len(FINGERS), 4)), palm)
        self._seen_before = False
        self._unseen = np.inf
        self._here = False
        self._refused, self._refused_at = "", 0.0

    def step(self, frame: HandFrame) -> Reconstruction:
        """Processes a hand frame; called once per control step, even if nothing has changed.

        A lost hand keeps its pose for a moment, then rises as a ghost, since its position is
        unknown.
        """
        dt = 0.0 if self._time is None else max(frame.time - self._time, 0.0)
        self._time = frame.time if self._time is None else max(frame.time, self._time)
        hand = self._look(frame)
        if hand is not None and hand.seen:
            self._follow(hand, dt)
        else:
            self._lose(dt)
        return Reconstruction(
            self._commanded,
            Phase.DOWN if self._here else Phase.COMING_DOWN if self._unseen == 0.0 else Phase.AWAY,
            _ALL if self._here else frozenset(),
            None,
            1.0,
            float(hand.miss.max()) if hand is not None else float("nan"),
            (),
        )

    def _look(self, frame: HandFrame) -> PaalmHand | None:
        if self._assume and self.side not in self.paalm.calibration:
            if not any(h.side in (None, self.side) for h in frame.hands):
                return None
            self.paalm.use({self.side: average_calibration([frame], self.side, self.paalm.options)})
        hands = self.paalm.step(frame)
        if hands.refused:
            self._refused, self._refused_at = hands.refused, frame.time
        return hands.hands.get(self.side)

    def _follow(self, hand: PaalmHand, dt: float) -> None:
        s, goal = self.settings, self._pose(hand.table, hand.palm)
        first = not self._seen_before
        # After a long absence the old state is not used for smoothing.
        if self._unseen <= s.patience and s.root_smoothing > 0.0:
            keep = exp(-dt / s.root_smoothing)
            turn = unwrapped(goal[ROOT_ROTATION], self._goal[ROOT_ROTATION])
            goal[ROOT_ROTATION] = turn + keep * (self._goal[ROOT_ROTATION] - turn)
            place = goal[ROOT_POSITION]
            goal[ROOT_POSITION] = place + keep * (self._goal[ROOT_POSITION] - place)
        self._goal = goal
        above = self._above_floor(goal)
        self._commanded = above if first else s.rate(self._commanded, above, dt)
        self._seen_before, self._unseen = True, 0.0
        off = length(self._commanded[ROOT_POSITION] - above[ROOT_POSITION])
        self._here = self._here or off < s.near

    def _lose(self, dt: float) -> None:
        s = self.settings
        self._unseen += dt
        if self._unseen <= s.patience:
            return
        self._here = False
        gone = self._unseen - s.patience
        if self._seen_before and (gone - dt) * s.rise_speed < s.rise:
            self._commanded = self._commanded.copy()
            self._commanded[2] += s.rise_speed * min(dt, gone)

    def _pose(self, table: Array, palm: Palm) -> Array:
        return hand_pose(table, palm, self.side, self.settings.device, size=self.settings.size)

    def _above_floor(self, q: Array) -> Array:
        if self.settings.floor == -inf:
            return q
        low = float((self._tips.tips(q)[:, 2] - self._radius).min()) - self.settings.floor
        if low >= 0.0:
            return q
        raised = q.copy()
        raised[2] -= low
        return raised
