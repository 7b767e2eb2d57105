"""Which versions and which machine: equal states are promised only where these are equal."""

from __future__ import annotations

import platform
from functools import cache
from hashlib import blake2b
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path


@cache
def versions() -> dict[str, str]:
    """Versions of what computes, and a fingerprint over them and the kind of processor."""
    found = {"python": platform.python_version()}
    for package in ("hand-sandbox", "mujoco", "numpy", "scipy"):
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            # Running from a checkout that is not installed.
            found[package] = "checkout"
    found["machine"] = f"{platform.system()} {platform.machine()}"
    found["processor"] = _processor()
    text = "\n".join(f"{k}={v}" for k, v in sorted(found.items()) if k != "hand-sandbox")
    found["fingerprint"] = blake2b(text.encode(), digest_size=8).hexdigest()
    return found


def _processor() -> str:
    """The processor's model, on which the order of float operations in BLAS may depend."""
    info = Path("/proc/cpuinfo")
    if info.exists():
        for line in info.read_text().splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    return platform.processor() or "unknown"
