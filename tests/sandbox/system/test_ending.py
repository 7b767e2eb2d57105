"""A program that was told to go on without its terminal goes on."""

from __future__ import annotations

import signal

import pytest

from sandbox.system.ending import ending_as_by_ctrl_c


@pytest.mark.skipif(not hasattr(signal, "SIGHUP"), reason="this system has no SIGHUP")
def test_a_signal_that_is_ignored_stays_ignored() -> None:
    before = signal.signal(signal.SIGHUP, signal.SIG_IGN)  # as nohup does
    try:
        with ending_as_by_ctrl_c():
            signal.raise_signal(signal.SIGHUP)
        assert signal.getsignal(signal.SIGHUP) is signal.SIG_IGN
    finally:
        signal.signal(signal.SIGHUP, before)


@pytest.mark.parametrize("name", ["SIGTERM", "SIGHUP"])
def test_a_signal_to_end_ends_as_by_ctrl_c(name: str, as_without_nohup: None) -> None:
    if not hasattr(signal, name):
        pytest.skip(f"this system has no {name}")
    before = signal.getsignal(signal.Signals[name])
    with pytest.raises(KeyboardInterrupt), ending_as_by_ctrl_c():
        signal.raise_signal(signal.Signals[name])
    assert signal.getsignal(signal.Signals[name]) == before
