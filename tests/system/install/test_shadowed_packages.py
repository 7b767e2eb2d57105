"""Packages of ours that somebody else's files hide."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import pytest

from tests.support.processes import ROOT, python

PACKAGES = ("models", "encoders", "tasks", "sandbox")


FINDER = f"""
import sys
from importlib.machinery import PathFinder
class Finder:
    @classmethod
    def find_spec(cls, name, path=None, target=None):
        return PathFinder.find_spec(name, [{str(ROOT)!r}]) if name in {PACKAGES} else None
sys.meta_path.append(Finder)
"""
"""Finds the packages as an editable install does: last of all finders, and on no path."""


SCRIPT = "import sys\nfrom sandbox.cli.main import main\nsys.exit(main())\n"
"""What pip writes for the `sandbox` command."""


@pytest.fixture(params=["models.py", "tasks/__init__.py"])
def intruder(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    """A module, importable from `tmp_path`, with the name of one of our packages."""
    file = tmp_path / str(request.param)
    file.parent.mkdir(exist_ok=True)
    file.write_text("raise SystemExit('somebody else ran')\n", encoding="utf-8")
    return file


def assert_refused_with_the_ways_out(error: str, place: Path) -> None:
    for words in (str(place), "python -P", "PYTHONSAFEPATH=1", "--import-mode=importlib"):
        assert words in error


def test_an_import_names_the_file_in_the_way_and_the_ways_out(
    intruder: Path, tmp_path: Path
) -> None:
    result = python("-c", "import sandbox", cwd=tmp_path)
    assert result.returncode == 1
    assert "ShadowedPackageError" in result.stderr.splitlines()[-1]
    assert_refused_with_the_ways_out(result.stderr.splitlines()[-1], intruder)


def test_an_editable_install_is_guarded_as_well(intruder: Path, tmp_path: Path) -> None:
    result = python("-c", FINDER + "import sandbox", cwd=tmp_path, path=())
    assert result.returncode == 1
    assert_refused_with_the_ways_out(result.stderr.splitlines()[-1], intruder)


def test_a_folder_without_init_hides_only_an_editable_install(tmp_path: Path) -> None:
    (tmp_path / "models").mkdir()
    assert python("-c", "import sandbox", cwd=tmp_path).returncode == 0
    hidden = python("-c", FINDER + "import sandbox", cwd=tmp_path, path=())
    assert hidden.returncode == 1
    assert_refused_with_the_ways_out(hidden.stderr.splitlines()[-1], tmp_path / "models")


def test_a_module_imported_earlier_is_noticed(tmp_path: Path) -> None:
    (tmp_path / "encoders.py").touch()
    code = "import sys, encoders; sys.path.remove(''); import sandbox"
    result = python("-c", code, cwd=tmp_path)
    assert result.returncode == 1
    assert_refused_with_the_ways_out(result.stderr.splitlines()[-1], tmp_path / "encoders.py")


def test_a_module_made_from_nothing_is_noticed(tmp_path: Path) -> None:
    code = "import sys, types; sys.modules['tasks'] = types.ModuleType('tasks'); import sandbox"
    assert "ShadowedPackageError" in python("-c", code, cwd=tmp_path).stderr


def test_a_missing_neighbour_is_reported_as_missing(tmp_path: Path) -> None:
    shutil.copytree(ROOT / "sandbox", tmp_path / "sandbox")
    # Isolated from the packages of this environment, where an install would fill the gap.
    code = f"import sys; sys.path[:0] = [{str(tmp_path)!r}]; import sandbox"
    result = python("-I", "-S", "-c", code, cwd=tmp_path)
    assert "`models` is missing" in result.stderr.splitlines()[-1]


@pytest.mark.parametrize("module", ["sandbox.cli.main", "sandbox.cli"])
def test_the_command_says_it_in_one_line(intruder: Path, tmp_path: Path, module: str) -> None:
    result = python("-m", module, "--help", cwd=tmp_path)
    assert (result.returncode, result.stdout) == (2, "")
    (line,) = result.stderr.splitlines()
    assert line.startswith("sandbox: ")
    assert_refused_with_the_ways_out(line, intruder)


def test_the_installed_command_does_not_look_in_the_current_folder(
    intruder: Path, tmp_path: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    command = tmp_path_factory.mktemp("bin") / "sandbox"
    command.write_text(SCRIPT, encoding="utf-8")
    assert python(command, "--help", cwd=tmp_path).returncode == 0
    refused = python(command, "--help", cwd=tmp_path, path=(tmp_path, ROOT))
    assert refused.returncode == 2
    (line,) = refused.stderr.splitlines()
    assert_refused_with_the_ways_out(line, intruder)


@pytest.mark.parametrize(("flags", "variables"), [(["-P"], {}), ([], {"PYTHONSAFEPATH": "1"})])
def test_the_ways_out_lead_out(
    intruder: Path, tmp_path: Path, flags: list[str], variables: dict[str, str]
) -> None:
    result = python(
        *flags, "-m", "sandbox.cli.main", "--help", cwd=tmp_path, path=(ROOT,), **variables
    )
    assert (result.returncode, result.stderr) == (0, "")
    assert result.stdout.startswith("usage: sandbox")


@pytest.fixture
def site_packages(tmp_path: Path) -> Path:
    """Our packages as pip installs them from a wheel, with its list of files."""
    place = tmp_path / "site-packages"
    for name in PACKAGES:
        shutil.copytree(
            ROOT / name,
            place / name,
            ignore=shutil.ignore_patterns("__pycache__", "node_modules", "page"),
        )
    lines = [
        f"{path.relative_to(place).as_posix()},sha256=unread,{path.stat().st_size}"
        for path in sorted(place.rglob("*"))
        if path.is_file()
    ]
    listed = place / "hand_sandbox-0.2.0.dist-info" / "RECORD"
    listed.parent.mkdir()
    lines.append("hand_sandbox-0.2.0.dist-info/RECORD,,")
    listed.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return place


def test_an_installed_package_that_is_whole_says_nothing(site_packages: Path) -> None:
    answer = python("-c", "import sandbox", cwd=site_packages.parent, path=(site_packages,))
    assert (answer.returncode, answer.stderr) == (0, "")


@pytest.mark.parametrize("file", ["models/user.py", "tasks/celery/__init__.py"])
def test_another_package_s_files_among_ours_are_told_in_one_line(
    site_packages: Path, file: str
) -> None:
    stranger = site_packages / file
    stranger.parent.mkdir(exist_ok=True)
    stranger.write_text("name = 'somebody else'\n", encoding="utf-8")
    package, name = file.split("/")[:2]
    call: dict[str, Any] = {"cwd": site_packages.parent, "path": (site_packages,)}
    answer = python("-c", "import sandbox; print(sandbox.Settings().task)", **call)
    assert (answer.returncode, answer.stdout) == (0, "box-to-goal\n")
    assert f"`{package}` ({name!r}" in answer.stderr
    command = python("-m", "sandbox", "--version", **call)
    (line,) = command.stderr.splitlines()
    assert command.returncode == 0
    assert line.startswith("sandbox: another package") and "in its own environment" in line


@pytest.mark.parametrize("file", ["models/__init__.py", "tasks/task.py"])
def test_a_file_of_ours_that_another_package_replaced_is_refused_in_one_line(
    site_packages: Path, file: str
) -> None:
    (site_packages / file).write_text("raise SystemExit('somebody else ran')\n", encoding="utf-8")
    call: dict[str, Any] = {"cwd": site_packages.parent, "path": (site_packages,)}
    refused = python("-m", "sandbox", "--version", **call)
    assert refused.returncode == 2
    (line,) = refused.stderr.splitlines()
    assert repr(file.split("/")[1]) in line and "--force-reinstall" in line
    assert "ShadowedPackageError" in python("-c", "import sandbox", **call).stderr
