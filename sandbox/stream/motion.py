"""Source of streamed hands: a session that computes commanded poses without physics.

Simulated persons look at the scene before they move, so with them the physics runs, too.
"""

from __future__ import annotations

import threading
from collections.abc import Callable

import numpy as np

from models.motion.armature import Armature
from models.motion.sampling import Poses
from models.scene import CONTROL_PERIOD
from sandbox.export.sources import MotionSource, PoseCallback, commanded_poses, poses_of, together
from sandbox.export.view import simulated_poses
from sandbox.session.latest_frame import LatestFrame
from sandbox.session.session import Session
from sandbox.trial.driver import Trial
from sandbox.trial.pacing import Pace, RealTime


def source_of_session(
    session: Session, stop: threading.Event, of: str = "commanded"
) -> MotionSource:
    """Yields the hands of a session in real time, until it is over or `stop` is set.

    Args:
        session: Ready for its first step.
        stop: Ends it.
        of: `commanded` poses from the devices; or `simulated` motion, for which the physics runs.
    """
    looking = [rig.device.show for rig in session.rigs if rig.device.looks]
    physics = bool(looking) or of == "simulated"
    play = _with_physics if physics else _without_physics
    names = tuple(rig.hand.name for rig in session.rigs)
    armatures = tuple(Armature.of_hand(rig.hand) for rig in session.rigs)
    what = "the simulated hand" if of == "simulated" else "the commanded pose"

    def run(take: PoseCallback) -> str:
        return play(session, stop, of, take)

    return MotionSource(armatures, names, 0.0, what, run)


def _with_physics(session: Session, stop: threading.Event, of: str, take: PoseCallback) -> str:
    poses: Callable[..., Poses] = commanded_poses if of == "commanded" else simulated_poses
    Trial(session, [lambda snapshot: take(poses(snapshot))]).run(Pace(), stop=stop.is_set)
    return f"the simulation diverged: {session.diverged}" if session.diverged else ""


def _without_physics(session: Session, stop: threading.Event, of: str, take: PoseCallback) -> str:
    rigs = session.rigs
    newest = [LatestFrame(rig.reconstructor.empty) for rig in rigs]
    clock, ticks = RealTime(), 0
    while not (stop.is_set() or all(rig.device.finished for rig in rigs)):
        now = ticks * CONTROL_PERIOD
        hands = []
        for rig, heard in zip(rigs, newest, strict=True):
            heard.take(rig.device.poll(now), now)
            reconstruction = rig.reconstructor.step(heard.frame)  # type: ignore[arg-type]
            hands.append(poses_of(np.array([now]), reconstruction.q[None]))
        take(together(hands))
        ticks += 1
        clock.wait(ticks * CONTROL_PERIOD)
    return ""
