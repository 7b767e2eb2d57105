"""Tests the program on every supported Python that is found, with the oldest and the newest
libraries: `python -m tools.python_versions`.

The lowest version of a library is the lowest that its bound in pyproject.toml allows and that has
a wheel for that Python. Interpreters are those on PATH and those of pyenv; missing ones are named,
and without the oldest supported one it fails.

    python -m tools.python_versions                                  all of it
    python -m tools.python_versions --only 3.11 --libraries lowest -- -q -n0 tests/models
    python -m tools.python_versions --keep out/pythons    # environments stay there
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from packaging.requirements import Requirement
from packaging.version import Version

ROOT = Path(__file__).resolve().parent.parent
PYTHONS = ("3.11", "3.12", "3.13")
"""Supported minor versions; the first one must be there."""
LIBRARIES = ("lowest", "newest")
EXTRA = "test"
MADE = "made"
"""File in an environment that has everything."""
PIP = "pip>=26"
"""Older ones, which come with these Pythons, also list versions that have no wheel."""


def requirements(project: Mapping[str, Any], extra: str) -> list[Requirement]:
    """Everything that the project and one of its extras ask for directly, without repeats.

    Args:
        project: The table `project` of pyproject.toml.
        extra: Name of the extra; what it takes from other extras of the project is followed.
    """
    found: dict[str, Requirement] = {}
    for requirement in _followed(
        project, [*project["dependencies"], f"{project['name']}[{extra}]"]
    ):
        found.setdefault(str(requirement), requirement)
    return list(found.values())


def _followed(project: Mapping[str, Any], texts: Iterable[str]) -> Iterator[Requirement]:
    for text in texts:
        requirement = Requirement(text)
        if requirement.name != project["name"]:
            yield requirement
            continue
        for extra in sorted(requirement.extras):
            yield from _followed(project, project["optional-dependencies"][extra])


def lowest(requirement: Requirement, versions: Iterable[str]) -> str:
    """The lowest of these versions that a requirement allows.

    Raises:
        SystemExit: It has no lower bound, or allows none of them.
    """
    if not any(s.operator in (">=", "==", "~=") for s in requirement.specifier):
        raise SystemExit(f"pyproject.toml: {requirement} has no lower bound. Write one")
    fitting = [Version(v) for v in versions if requirement.specifier.contains(v)]
    if not fitting:
        raise SystemExit(f"{requirement}: no version of it has a wheel for this Python")
    return str(min(fitting))


def with_wheels(python: Path, name: str) -> list[str]:
    """Versions of a library that have a wheel for an interpreter.

    Raises:
        SystemExit: The package index does not answer, or does not know it.
    """
    command = [str(python), "-m", "pip", "index", "versions", "--only-binary=:all:", name]
    said = subprocess.run(command, capture_output=True, text=True, check=False)
    found = re.search(r"^Available versions: (.*)$", said.stdout, re.MULTILINE)
    if found is None:
        raise SystemExit(f"{name}: {said.stderr.strip() or 'no version is known'}")
    return found[1].split(", ")


def interpreters() -> dict[str, Path]:
    """Interpreters that run, by minor version."""
    found = {}
    for minor in PYTHONS:
        pyenv = Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv"), "versions")
        on_path = shutil.which(f"python{minor}")
        places = [Path(on_path)] if on_path else []
        places += sorted(pyenv.glob(f"{minor}.*/bin/python"))
        running = next((place for place in places if _runs(place, minor)), None)
        if running is not None:
            found[minor] = running
    return found


def _runs(python: Path, minor: str) -> bool:
    """True if it is that Python; those that pyenv puts on PATH may only say that they are not."""
    told = "import sys, ensurepip; print('%d.%d' % sys.version_info[:2])"
    said = subprocess.run([python, "-c", told], capture_output=True, text=True, check=False)
    return said.returncode == 0 and said.stdout.strip() == minor


def environment(python: Path, folder: Path, libraries: str) -> Path:
    """Makes an environment with the program, and the lowest or newest libraries; its interpreter.

    Raises:
        CalledProcessError: Something cannot be installed.
    """
    subprocess.run([python, "-m", "venv", folder], check=True)
    inside = folder / "bin" / "python"
    subprocess.run([str(inside), "-m", "pip", "install", "-q", PIP], check=True)
    install = [str(inside), "-m", "pip", "install", "-q", "--prefer-binary"]
    if libraries == "lowest":
        project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
        lines = [
            f"{r.name}=={lowest(r, with_wheels(inside, r.name))}"
            for r in requirements(project, EXTRA)
            if r.marker is None or r.marker.evaluate()
        ]
        constraints = folder / "lowest.txt"
        constraints.write_text("\n".join(lines) + "\n", encoding="utf-8")
        print("  " + ", ".join(lines), flush=True)
        install += ["--constraint", str(constraints)]
    subprocess.run([*install, "-e", f"{ROOT}[{EXTRA}]"], check=True)
    subprocess.run([str(inside), "-m", "pip", "check"], check=True)
    return inside


@contextmanager
def place(keep: Path | None, name: str) -> Iterator[Path]:
    """A folder for an environment: one that stays, or one that goes at the end."""
    if keep is not None:
        yield keep.resolve() / name
        return
    with tempfile.TemporaryDirectory() as folder:
        yield Path(folder)


def main(argv: Sequence[str]) -> int:
    """Makes all environments and tests in them; the exit status is 1 if any of it failed."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--only", choices=PYTHONS, action="append", help="one of the Pythons")
    parser.add_argument("--libraries", choices=LIBRARIES, action="append", help="one of the two")
    parser.add_argument("--keep", type=Path, help="folder in which environments stay")
    parser.add_argument("pytest", nargs="*", help="arguments of pytest; default: all tests")
    options = parser.parse_args(argv)
    found = interpreters()
    missing = [minor for minor in PYTHONS if minor not in found]
    if missing:
        print(f"not found, and left out: Python {', '.join(missing)}", flush=True)
    if PYTHONS[0] in missing:
        print(f"Python {PYTHONS[0]}, the oldest that is supported, must be there")
        return 1
    failed = []
    for minor in options.only or PYTHONS:
        for libraries in options.libraries or LIBRARIES:
            if minor not in found:
                continue
            name = f"Python {minor}, {libraries} libraries"
            print(f"{name} ({found[minor]})", flush=True)
            with place(options.keep, f"{minor}-{libraries}") as folder:
                try:
                    inside = folder / "bin" / "python"
                    if not (folder / MADE).exists():
                        environment(found[minor], folder, libraries)
                        (folder / MADE).touch()
                    subprocess.run([inside, "-m", "pytest", *options.pytest], cwd=ROOT, check=True)
                except (subprocess.CalledProcessError, SystemExit) as error:
                    print(f"{name}: {error}", flush=True)
                    failed.append(name)
    print("failed: " + "; ".join(failed) if failed else "all passed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
