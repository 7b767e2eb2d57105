"""How the corrections of a solid hand change from one control step to the next."""

from __future__ import annotations

import numpy as np

from models.arithmetic import Array
from models.pose import ROOT_POSITION
from models.scene import CONTROL_PERIOD
from sandbox.session.collision_avoidance import SPEED
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session


class Changes:
    """A view that adds up how the corrections of a session change.

    Attributes:
        steps: Control steps in which a hand was led, as well as in the two before.
        full: Those in which the correction changed as fast as it may.
        back: rad that were taken back, over all of them.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._before: list[list[Array]] = [[] for _ in session.rigs]
        self.steps = self.full = 0
        self.back = 0.0

    def __call__(self, snapshot: Snapshot) -> None:
        """Reads the corrections after a control step."""
        for hand, before in enumerate(self._before):
            correction = self._session.correction(hand)
            if correction is None:
                before.clear()
                continue
            before.append(correction)
            if len(before) == 3:
                last, now = np.diff(before, axis=0)
                for change in (last, now):
                    change[ROOT_POSITION] *= 10.0
                del before[0]
                self.steps += 1
                self.full += bool(np.abs(now).max() > 0.98 * SPEED * CONTROL_PERIOD)
                turned = last * now < 0.0
                self.back += float(np.minimum(np.abs(last), np.abs(now))[turned].sum())
