"""A lab's own package, installed by pip from a wheel, and our program with it."""

from __future__ import annotations

import subprocess
import sys
import zipfile
from pathlib import Path

from tests.support.processes import ROOT, python

METADATA = {
    "METADATA": "Metadata-Version: 2.1\nName: tiny-lab\nVersion: 0.3\n",
    "WHEEL": "Wheel-Version: 1.0\nGenerator: a test\nRoot-Is-Purelib: true\nTag: py3-none-any\n",
    "RECORD": "",
}
PIP = ("-m", "pip", "install", "--quiet", "--no-deps", "--no-index", "--disable-pip-version-check")


def install_lab(folder: Path, module: str, entry_points: str) -> Path:
    """Installs the package tiny-lab 0.3.

    Args:
        folder: An empty folder.
        module: Text of its only module, `tiny_lab`.
        entry_points: Text of its `entry_points.txt`.

    Returns:
        The folder to import it from.
    """
    target, wheel = folder / "site", folder / "tiny_lab-0.3-py3-none-any.whl"
    with zipfile.ZipFile(wheel, "w") as archive:
        archive.writestr("tiny_lab.py", module)
        for name, text in (METADATA | {"entry_points.txt": entry_points}).items():
            archive.writestr(f"tiny_lab-0.3.dist-info/{name}", text)
    subprocess.run([sys.executable, *PIP, "--target", str(target), str(wheel)], check=True)
    return target


def sandbox_with(site: Path | None, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Runs `sandbox` where the packages in a folder can be imported, too."""
    path = (ROOT, site) if site else (ROOT,)
    return python("-m", "sandbox", *arguments, path=path)
