"""Runs a whole trial as fast as possible."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from sandbox.trial.device_makers import DeviceMakers
from sandbox.trial.driver import ViewMaker, no_views, open_trial
from sandbox.trial.result import TrialResult
from sandbox.trial.settings import Settings


def run_trial(
    settings: Settings,
    makers: DeviceMakers | None = None,
    make_views: ViewMaker = no_views,
    record: Path | None = None,
    about: dict[str, Any] | None = None,
    dump: Path | None = None,
) -> TrialResult:
    """Plays a trial to its end.

    Args:
        settings, makers, make_views, record, about, dump: See `open_trial`.

    Returns:
        The trial's result; after a divergence, its `dump` is the file with the last states.
    """
    with open_trial(settings, makers, make_views, record, about, dump) as trial:
        trial.run()
        return trial.end()
