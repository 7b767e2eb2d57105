"""Describes the machine of a measurement and its load, without which times have no meaning."""

from __future__ import annotations

import os
import platform

from sandbox.recording.versions import versions


def describe_machine() -> str:
    """Returns one line with processor, load, system and versions."""
    found = versions()
    load = ", ".join(f"{x:.1f}" for x in os.getloadavg()) if hasattr(os, "getloadavg") else "?"
    return (
        f"{found['processor']}, {os.cpu_count() or '?'} cores, load {load}; "
        f"{platform.system()}, Python {found['python']}, MuJoCo {found['mujoco']}, "
        f"NumPy {found['numpy']}, SciPy {found['scipy']}"
    )
