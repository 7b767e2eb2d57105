"""Skips of tests that need something which a machine may lack.

`@pytest.mark.needs("opengl")` at a test, or `require("opengl")` inside a fixture. With `CI=true`
such a skip fails the run: there, all of it is installed.
"""

from __future__ import annotations

import ctypes
import os
import shutil
import subprocess
from collections.abc import Callable
from functools import cache
from importlib.util import find_spec
from pathlib import Path

import pytest


def _opengl() -> str:
    from sandbox.views.display import GraphicsError
    from sandbox.views.graphics import choose_backend

    try:
        choose_backend()
    except GraphicsError:
        return "no OpenGL that draws without a screen (libegl1 and libgl1-mesa-dri, or libosmesa6)"
    return ""


def _library(name: str, package: str) -> str:
    try:
        ctypes.CDLL(name)
    except OSError:
        return f"no {name} (Debian's {package})"
    return ""


def _package(name: str, extra: str) -> str:
    return "" if find_spec(name) else f"no {name} (the extra {extra})"


def _packages(extra: str, *names: str) -> str:
    return next(filter(None, (_package(name, extra) for name in names)), "")


def _screen() -> str:
    missing = [name for name in ("Xvfb", "xdotool") if shutil.which(name) is None]
    return f"no {' and no '.join(missing)}" if missing else _library("libGL.so.1", "libgl1")


_FETCHED = Path(__file__).resolve().parents[2] / "sandbox/views/page/node_modules"
"""What npm fetches with what builds the page."""
AXE = _FETCHED / "axe-core/axe.min.js"
"""The checks of axe-core."""
IWER = _FETCHED / "iwer/build/iwer.min.js"
"""An emulated headset."""


def _axe() -> str:
    return "" if AXE.is_file() else "no axe-core (npm ci in sandbox/views/page)"


SITE = Path(__file__).resolve().parents[2] / "out" / "site"
"""The site, where `python -m tools.docs.site` puts it."""


def _site() -> str:
    return "" if (SITE / "index.html").is_file() else "no site (python -m tools.docs.site)"


def _firefox() -> str:
    there = shutil.which("firefox-esr") or shutil.which("firefox")
    return _screen() if there else "no Firefox (Debian's firefox-esr)"


def _webkit() -> str:
    there = shutil.which("WebKitWebDriver")
    return _screen() if there else "no WebKit (Debian's webkit2gtk-driver)"


def _iwer() -> str:
    return "" if IWER.is_file() else "no iwer (npm ci in sandbox/views/page)"


def _r() -> str:
    if shutil.which("Rscript") is None:
        return "no R (Debian's r-base-core)"
    packages = ("lme4", "survival", "emmeans", "ordinal", "coin")
    code = f"cat(setdiff(c{packages}, rownames(installed.packages())))"
    run = subprocess.run(["Rscript", "-e", code], capture_output=True, text=True, check=True)
    return " and ".join(f"no {name} (Debian's r-cran-{name})" for name in run.stdout.split())


_WHAT_LACKS: dict[str, Callable[[], str]] = {
    "opengl": _opengl,
    "egl": lambda: _library("libEGL.so.1", "libegl1"),
    "osmesa": lambda: _library("libOSMesa.so.8", "libosmesa6"),
    "screen": _screen,
    "axe": _axe,
    "site": _site,
    "iwer": _iwer,
    "firefox": _firefox,
    "webkit": _webkit,
    "datasets": lambda: _packages("datasets", "minari", "h5py", "pyarrow", "pandas"),
    "fork": lambda: "" if os.name == "posix" else "no fork of processes",
    "r": _r,
    # It has no wheels for Linux on ARM.
    "ezc3d": lambda: _package("ezc3d", "test"),
    "robots": lambda: _package("gymnasium_robotics", "robots"),
}
"""Need -> what is missing for it on this machine; empty: nothing."""


@cache
def _lacks(need: str) -> str:
    return _WHAT_LACKS[need]()


def require(*needs: str) -> None:
    """Skips the test that runs now if this machine lacks one of the needs."""
    for need in needs:
        if missing := _lacks(need):
            pytest.skip(f"this machine has {missing}")
