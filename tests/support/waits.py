"""How long a hand waits over its touches before it comes down."""

from __future__ import annotations

from encoders.reconstruction.hand_motion import Phase
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session


class Waits:
    """A view that notes how long the first hand waits over its touches.

    Args:
        session: The session that is watched.
    """

    def __init__(self, session: Session) -> None:
        self._session, self._since, self._before = session, 0.0, Phase.AWAY
        self.waits: list[float] = []

    def __call__(self, snapshot: Snapshot) -> None:
        phase = self._session.reconstructions[0].phase
        if phase is Phase.ABOVE and self._before is not Phase.ABOVE:
            self._since = snapshot.time
        if phase is Phase.COMING_DOWN and self._before is Phase.ABOVE:
            self.waits.append(round(snapshot.time - self._since, 6))
        self._before = phase
