"""A live hand that a device commands, for programs that need the hand's current pose."""

from __future__ import annotations

import threading

from models.arithmetic import Array
from models.errors import DeviceError
from sandbox.devices.device import Closeable
from sandbox.session.session import Session
from sandbox.stream.hand_sources import follow
from sandbox.trial.driver import RealTime, Trial


class LiveHand(Closeable):
    """Follows the commanded pose of a session's first hand in real time.

    Physics runs only if a device needs the scene, as a simulated person does.

    Args:
        session: A session that is ready for its first step. `close` also closes the session.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._pose = session.rigs[0].reconstructor.commanded
        self._stop, self._lock = threading.Event(), threading.Lock()
        self._failure: Exception | None = None
        self._thread = threading.Thread(target=self._run, name="live hand", daemon=True)
        self._thread.start()

    @property
    def over(self) -> bool:
        """True when the device has no more frames, as at the end of a recording."""
        return not self._thread.is_alive()

    def pose(self) -> Array:
        """The newest commanded pose (48,) in the world; after the end, the last pose.

        Raises:
            DeviceError: The device failed.
        """
        if self._failure is not None:
            raise DeviceError("the hand is lost", got=str(self._failure)) from self._failure
        with self._lock:
            return self._pose.copy()

    def close(self) -> None:
        """Stops the thread and closes the session; may be called twice."""
        self._stop.set()
        self._thread.join()
        self._session.close()

    def _take(self, pose: Array) -> None:
        with self._lock:
            self._pose = pose

    def _run(self) -> None:
        try:
            if any(rig.device.takes_snapshots for rig in self._session.rigs):
                views = [lambda snapshot: self._take(snapshot.hands[0].target)]
                Trial(self._session, views).run(RealTime(), stop=self._stop.is_set)
            else:
                hands = [(rig.device, rig.reconstructor) for rig in self._session.rigs]
                follow(hands, self._stop, lambda time, poses: self._take(poses[0]))
        except Exception as error:
            self._failure = error
