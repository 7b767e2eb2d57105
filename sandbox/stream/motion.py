"""Sources of streamed hands: a live Leap, or a session that computes commanded poses without
physics.

Simulated persons look at the scene before they move, so with them the physics runs, too.
"""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from encoders.paalm.calibration import HandCalibration
from encoders.reconstruction.reconstructor import AirReconstructor, Reconstructor
from models.arithmetic import Array
from models.motion.armature import Armature
from models.motion.sampling import Poses
from models.scene import CONTROL_PERIOD
from sandbox.devices.device import AnyDevice, HandDevice, LatestFrame
from sandbox.export.leap_hands import (
    described,
    devices_by_side,
    leap_armatures,
    straight_reconstructors,
)
from sandbox.export.motion_source import MotionSource, PoseCallback, poses_of, together
from sandbox.export.sources import commanded_poses
from sandbox.export.view import simulated_poses
from sandbox.session.session import Session
from sandbox.trial.driver import RealTime, Trial


def source_of_session(
    session: Session, stop: threading.Event, of: str = "commanded"
) -> MotionSource:
    """Yields the hands of a session in real time, until it is over or `stop` is set.

    Args:
        session: Ready for its first step.
        stop: Ends it.
        of: `commanded` poses from the devices; or `simulated` motion, for which the physics runs.
    """
    looking = [rig.device.show for rig in session.rigs if rig.device.wants_snapshots]
    physics = bool(looking) or of == "simulated"
    names = tuple(rig.hand.name for rig in session.rigs)
    armatures = tuple(Armature.of_hand(rig.hand) for rig in session.rigs)
    what = "the simulated hand" if of == "simulated" else "the commanded pose"

    def run(take: PoseCallback) -> str:
        if physics:
            return _with_physics(session, stop, of, take)
        return _without_physics([(r.device, r.reconstructor) for r in session.rigs], stop, take)

    return MotionSource(armatures, names, 0.0, what, run)


def source_of_leap(
    device: HandDevice,
    sides: Sequence[str],
    calibrations: Mapping[str, HandCalibration],
    stop: threading.Event,
) -> MotionSource:
    """Yields the hands over a live Leap in real time, in the frame of the device, until `stop`.

    Args:
        device: The running device.
        sides: Sides of the hands, one or both.
        calibrations: Calibrations by side. A hand without one has the bones that the device
            reports when it is first seen, or is average.
        stop: Ends it.
    """
    names = tuple(sides)

    def run(take: PoseCallback) -> str:
        reconstructors = straight_reconstructors(names, calibrations)
        pairs = list(zip(devices_by_side(device, names), reconstructors, strict=True))
        return _without_physics(pairs, stop, take)

    remarks = tuple(
        f"no --calibration: the {side} hand has the bones that the Leap reports, or is average"
        for side in names
        if side not in calibrations
    )
    return MotionSource(leap_armatures(names), names, 0.0, described(names), run, remarks)


def _with_physics(session: Session, stop: threading.Event, of: str, take: PoseCallback) -> str:
    poses: Callable[..., Poses] = commanded_poses if of == "commanded" else simulated_poses
    Trial(session, [lambda snapshot: take(poses(snapshot))]).run(RealTime(), stop=stop.is_set)
    return f"the simulation diverged: {session.diverged}" if session.diverged else ""


def follow(
    hands: Sequence[tuple[AnyDevice, Reconstructor | AirReconstructor]],
    stop: threading.Event,
    show: Callable[[float, Sequence[Array]], None],
) -> None:
    """Computes commanded poses in real time and without physics, until all devices are finished.

    Args:
        hands: Device and reconstructor of each hand.
        stop: Ends it early.
        show: Called every control period with its time, s, and the pose (48,) of each hand.
    """
    newest = [LatestFrame(reconstructor.empty) for _, reconstructor in hands]
    clock, ticks = RealTime(), 0
    while not (stop.is_set() or all(device.finished for device, _ in hands)):
        now = ticks * CONTROL_PERIOD
        poses = []
        for (device, reconstructor), heard in zip(hands, newest, strict=True):
            heard.take(device.poll(now), now)
            poses.append(reconstructor.step(heard.frame).q)  # type: ignore[arg-type]
        show(now, poses)
        ticks += 1
        clock.wait(ticks * CONTROL_PERIOD)


def _without_physics(
    hands: Sequence[tuple[AnyDevice, Reconstructor | AirReconstructor]],
    stop: threading.Event,
    take: PoseCallback,
) -> str:
    def show(time: float, poses: Sequence[Array]) -> None:
        take(together([poses_of(np.array([time]), q[None]) for q in poses]))

    follow(hands, stop, show)
    return ""
