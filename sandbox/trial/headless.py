"""Runs a trial as fast as it goes, with whoever wants to look on."""

from __future__ import annotations

import gc
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from threadpoolctl import threadpool_limits

from encoders.regression.registry import origin as encoder_origin
from models.errors import DivergenceError
from sandbox.recording.versions import versions
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session
from sandbox.trial.assembly import build, digests
from sandbox.trial.device_makers import DeviceMakers
from sandbox.trial.keeping import Keeping
from sandbox.trial.result import TrialResult
from sandbox.trial.settings import RunSettings
from tasks.registry import origin

View = Callable[[Snapshot], None]
"""Gets every snapshot of a headless run, in order."""

ViewMaker = Callable[[Session], Sequence[View]]
"""Makes the views of a session before its first step."""


def no_views(session: Session) -> Sequence[View]:
    """Nobody looks on."""
    return ()


def run_trial(
    settings: RunSettings,
    makers: DeviceMakers,
    make_views: ViewMaker = no_views,
    record: Path | None = None,
    about: dict[str, Any] | None = None,
    dump: Path | None = None,
) -> TrialResult:
    """Plays a trial to its end.

    Args:
        settings: How it goes.
        makers: Open the devices, one for every hand.
        make_views: Who looks on. A device that also looks (the simulated user) need not be named.
        record: Where to write a recording.
        about: More for the header and the result, such as who the simulated user is.
        dump: Folder for the last states of a simulation that diverges, where nothing is recorded;
            beside a recording they are written in any case.

    Returns:
        The trial's result; after a divergence, its `dump` is the file that shows how.
    """
    header = trial_header(settings, about)
    keeping = Keeping(header, record, dump)
    try:
        # More threads gain nothing on such small matrices, and would wait for each other.
        with threadpool_limits(1), no_search_for_garbage():
            session = build(settings, makers, keeping.recorder)
            try:
                play(session, make_views(session))
                return keeping.end(session)
            finally:
                session.close()
    finally:
        keeping.close()


@contextmanager
def no_search_for_garbage() -> Iterator[None]:
    """Lets Python look for garbage between trials instead of in the middle of one.

    A trial leaves none, but makes thousands of objects, and every so often Python would look
    through them and everything that was ever imported: milliseconds, for which a person's touch
    would have to wait.
    """
    was = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was:
            gc.enable()


def play(session: Session, views: Sequence[View]) -> None:
    """Advances a session until it is over."""
    watching = [*views, *looking_devices(session)]
    while not session.over:
        try:
            snapshot = session.advance()
        except DivergenceError:
            # The trial is marked; its recording holds all that led here.
            break
        for view in watching:
            view(snapshot)


def trial_header(settings: RunSettings, about: dict[str, Any] | None = None) -> dict[str, Any]:
    """What must be known to run a trial again."""
    return {
        "settings": settings.as_json(),
        "encoder": settings.encoder,
        "digests": digests(settings),
        "versions": versions(),
        **({"task_from": found} if (found := origin(settings.task)) else {}),
        **({"encoder_from": found} if (found := encoder_origin(settings.encoder)) else {}),
        **(about or {}),
    }


def looking_devices(session: Session) -> list[View]:
    """`show` of all devices that look."""
    return [rig.device.show for rig in session.rigs if rig.device.looks]
