"""Says on what machine, and how busy it was: no time means anything without."""

from __future__ import annotations

import os
import platform

from sandbox.recording.versions import versions


def describe_machine() -> str:
    """One line: processor, load, system and versions."""
    found = versions()
    load = ", ".join(f"{x:.1f}" for x in os.getloadavg()) if hasattr(os, "getloadavg") else "?"
    return (
        f"{found['processor']}, {os.cpu_count() or '?'} cores, load {load}; "
        f"{platform.system()}, Python {found['python']}, MuJoCo {found['mujoco']}, "
        f"NumPy {found['numpy']}, SciPy {found['scipy']}"
    )
