"""A view that writes the motion of the hands of a running or replayed session to a file."""

from __future__ import annotations

from pathlib import Path
from types import TracebackType

import numpy as np

from models.motion.armature import Armature
from models.motion.sampling import Poses
from sandbox.export.sources import Of, commanded_poses, poses_of_qpos
from sandbox.export.targets import Exporter, ExportSettings
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session


def simulated_poses(snapshot: Snapshot) -> Poses:
    """Poses of all hands at one moment."""
    return poses_of_qpos(np.array([snapshot.time]), snapshot.qpos[None], len(snapshot.hands))


class MotionView(Exporter):
    """Writes the motion of a session's hands; the files appear when it is closed.

    If a session is stopped (Ctrl-C), the motion written so far is kept.

    Args:
        path: Path of the file; its ending chooses the format.
        session: The session.
        settings: Settings of written motion.
        of: Simulated or commanded motion of the hands.

    Raises:
        InputError: The file cannot be written.
    """

    def __init__(
        self,
        path: Path,
        session: Session,
        settings: ExportSettings | None = None,
        of: Of = "simulated",
    ) -> None:
        hands = [rig.hand for rig in session.rigs]
        self._poses = simulated_poses if of == "simulated" else commanded_poses
        armatures = tuple(Armature.of_hand(hand) for hand in hands)
        names = tuple(hand.name for hand in hands)
        super().__init__(path, armatures, names, settings or ExportSettings())

    def show(self, snapshot: Snapshot) -> None:
        """Writes the motion up to a snapshot."""
        self.take(self._poses(snapshot))

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        stopped = kind is not None and issubclass(kind, KeyboardInterrupt)
        if stopped and self.frames:
            kind, error, trace = None, None, None
        super().__exit__(kind, error, trace)
