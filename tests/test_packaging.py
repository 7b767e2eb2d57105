"""What a stranger meets first: installing, importing, the README's commands and the checks.

Everything about the import path and about skipped tests is asked of real processes.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parent.parent
PACKAGES = ("models", "encoders", "tasks", "sandbox")
NOT_SHIPPED = {"__pycache__", "page", "node_modules"}
"""Folders inside the packages whose files stay out of the wheel."""

UNWANTED = {"PYTHONPATH", "PYTHONSAFEPATH", "PYTEST_ADDOPTS", "CI"}
"""Variables that would change what a child process is asked."""

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

SKIPS = """
import pytest
def test_no_reason(): pytest.skip("no display")
@pytest.mark.skipif(True, reason="too slow")
def test_marked(): pass
def test_missing_library(): pytest.importorskip("a_library_nobody_has")
def test_expected_failure(request):
    request.applymarker(pytest.mark.xfail)
    assert False
def test_data(shared_data): assert shared_data.is_dir()
def test_data_elsewhere(): pytest.skip("shared data absent: so it says")
def test_node(device_node): device_node("/dev/no-such-node")
def test_usable_node(): pytest.skip("device node absent: /dev/null")
def test_no_node(): pytest.skip("device node absent: /etc/no-such-node")
"""
"""Ways to be skipped; what becomes of each is in the tests below."""


@pytest.fixture(scope="module")
def project() -> dict[str, Any]:
    """pyproject.toml."""
    return tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def ci_run() -> str:
    """The script that CI runs."""
    return (ROOT / ".ci" / "run").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def readme_commands() -> list[str]:
    """The lines of the README's first block of code."""
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    block = re.search(r"```(?:bash|sh|console)\n(.*?)```", readme, re.DOTALL)
    assert block is not None, "the README shows no commands"
    return [line for line in block[1].splitlines() if line.strip() and not line.startswith("#")]


@pytest.fixture(params=["models.py", "tasks/__init__.py"])
def intruder(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    """A module, importable from `tmp_path`, with the name of one of our packages."""
    file = tmp_path / str(request.param)
    file.parent.mkdir(exist_ok=True)
    file.write_text("raise SystemExit('somebody else ran')\n", encoding="utf-8")
    return file


def python(
    *args: object, cwd: Path, path: tuple[Path, ...] = (ROOT,), **environment: Any
) -> subprocess.CompletedProcess[str]:
    """Runs this Python in `cwd` with `path` as PYTHONPATH; installed packages stay visible."""
    kept = {k: v for k, v in os.environ.items() if k not in UNWANTED}
    kept["PYTHONPATH"] = os.pathsep.join(map(str, path))
    return subprocess.run(
        [sys.executable, *map(str, args)],
        cwd=cwd,
        env=kept | environment,
        capture_output=True,
        text=True,
        stdin=subprocess.DEVNULL,
        check=False,
    )


def assert_refused_with_the_ways_out(error: str, place: Path) -> None:
    for words in (str(place), "python -P", "PYTHONSAFEPATH=1", "--import-mode=importlib"):
        assert words in error


# Somebody else's models.py


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


def test_a_caller_may_catch_it_as_an_import_error(intruder: Path, tmp_path: Path) -> None:
    code = "try:\n import sandbox\nexcept ImportError as error:\n print(error.name, error.path)"
    result = python("-c", code, cwd=tmp_path)
    shadowed = intruder.relative_to(tmp_path).parts[0].removesuffix(".py")
    assert result.stdout.split() == [shadowed, str(intruder)]


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


def test_importlib_mode_leads_out_of_a_test_folder(intruder: Path, tmp_path: Path) -> None:
    (tmp_path / "test_theirs.py").write_text("import sandbox\ndef test(): pass\n", encoding="utf-8")
    run = ("-P", "-m", "pytest", "-p", "no:cacheprovider", "--rootdir", tmp_path, tmp_path)
    assert "ShadowedPackageError" in python(*run, cwd=tmp_path).stdout
    assert python(*run, "--import-mode=importlib", cwd=tmp_path).returncode == 0


def test_an_innocent_folder_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "my_models.py").touch()
    (tmp_path / "tasks.txt").touch()
    for args in (("-c", "import sandbox"), ("-m", "sandbox.cli.main")):
        result = python(*args, cwd=tmp_path)
        assert (result.returncode, result.stderr) == (0, "")


# A skipped test is no passed test


def outcomes(folder: Path, **environment: str) -> dict[str, str]:
    """Test name -> PASSED, SKIPPED, ... for SKIPS run under the project's conftest."""
    shutil.copy(ROOT / "tests" / "conftest.py", folder)
    (folder / "test_skips.py").write_text(SKIPS, encoding="utf-8")
    run = ("-m", "pytest", "-v", "-p", "no:cacheprovider", "--rootdir", folder, folder)
    lines = re.findall(
        r"::(test_\w+) ([A-Z]+)", python(*run, cwd=folder, path=(ROOT,), **environment).stdout
    )
    assert lines
    return dict(lines)


def test_ci_fails_a_skip_unless_what_it_lacks_may_be_lacking(tmp_path: Path) -> None:
    absent = str(tmp_path / "absent")
    assert outcomes(tmp_path, CI="true", HAND_SANDBOX_DATA=absent) == {
        "test_no_reason": "FAILED",
        "test_marked": "ERROR",
        "test_missing_library": "FAILED",
        "test_expected_failure": "XFAIL",
        "test_data": "SKIPPED",
        "test_data_elsewhere": "SKIPPED",
        "test_node": "SKIPPED",
        "test_usable_node": "FAILED",
        "test_no_node": "FAILED",
    }


def test_ci_fails_a_skip_for_data_that_is_there(tmp_path: Path) -> None:
    found = outcomes(tmp_path, CI="true", HAND_SANDBOX_DATA=str(tmp_path))
    assert found["test_data"] == "PASSED"
    assert found["test_data_elsewhere"] == "FAILED"


def test_a_person_may_skip(tmp_path: Path) -> None:
    found = outcomes(tmp_path, HAND_SANDBOX_DATA=str(tmp_path / "absent"))
    assert set(found.values()) == {"SKIPPED", "XFAIL"}


def test_ci_fails_a_whole_file_that_is_skipped(tmp_path: Path) -> None:
    shutil.copy(ROOT / "tests" / "conftest.py", tmp_path)
    (tmp_path / "test_whole.py").write_text(
        "import pytest\npytest.skip('no display', allow_module_level=True)\n", encoding="utf-8"
    )
    run = ("-m", "pytest", "-p", "no:cacheprovider", "--rootdir", tmp_path, tmp_path)
    result = python(*run, cwd=tmp_path, CI="true")
    assert result.returncode not in (0, 5)
    assert "no display" in result.stdout


def test_a_folder_is_tested_in_processes_where_a_skip_fails_too_and_a_file_in_one(
    tmp_path: Path,
) -> None:
    shutil.copy(ROOT / "tests" / "conftest.py", tmp_path)
    for name in ("test_a.py", "test_b.py"):
        (tmp_path / name).write_text(
            "import pytest\ndef test_no_reason(): pytest.skip('no display')\n", encoding="utf-8"
        )
    can_count = hasattr(os, "sched_getaffinity")
    processors = len(os.sched_getaffinity(0)) if can_count else os.cpu_count() or 1
    run = ("-m", "pytest", "-v", "-p", "no:cacheprovider", "-n", "auto", "--dist", "loadfile")
    for asked, failed in ((tmp_path, 2), (tmp_path / "test_a.py", 1)):
        said = python(*run, "--rootdir", tmp_path, asked, cwd=tmp_path, CI="true").stdout
        assert re.fullmatch(f"=+ {failed} failed in .*=+", said.splitlines()[-1]), said
        assert said.count("with CI=true a skipped test fails") >= failed
        assert ("[gw" in said) == (asked == tmp_path and processors > 1)


# The commands, and what is shipped


def test_the_readme_has_two_commands_of_one_line_each(readme_commands: list[str]) -> None:
    demo, tests = readme_commands
    assert demo.endswith("sandbox demo")
    assert tests.endswith("pytest")
    for command in (demo, tests):
        assert command.startswith("python3 -m venv .venv && .venv/bin/pip install ")


def test_ci_runs_the_readme_command_to_the_letter(readme_commands: list[str], ci_run: str) -> None:
    (command,) = re.findall(r"^readme_tests='(.*)'$", ci_run, re.MULTILINE)
    assert command == readme_commands[1]
    assert re.search(r'^[^#]*bash -euc "\$readme_tests"', ci_run, re.MULTILINE)


def test_ci_says_which_thirty_tests_took_longest(ci_run: str) -> None:
    assert re.search(r'^export PYTEST_ADDOPTS="--durations=30"$', ci_run, re.MULTILINE)
    # The bare root begins with an empty environment.
    assert re.search(r'env -i [^#]*PYTEST_ADDOPTS="\$PYTEST_ADDOPTS"', ci_run)


def test_ci_run_refuses_a_flag_it_does_not_know(tmp_path: Path) -> None:
    result = subprocess.run(
        [ROOT / ".ci" / "run", "--fast"], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert result.returncode == 2
    assert "--full" in result.stderr


def test_every_folder_of_modules_is_a_package() -> None:
    """setuptools leaves a folder without __init__.py out of the wheel without a word."""
    folders = {path.parent for name in PACKAGES for path in (ROOT / name).rglob("*.py")}
    assert not [folder for folder in sorted(folders) if not (folder / "__init__.py").is_file()]


def test_every_data_file_is_shipped(project: dict[str, Any]) -> None:
    patterns = project["tool"]["setuptools"]["package-data"]["*"]
    packages = [init.parent for name in PACKAGES for init in (ROOT / name).rglob("__init__.py")]
    shipped = {file for folder in packages for glob in patterns for file in folder.glob(glob)}
    data = {
        path
        for name in PACKAGES
        for path in (ROOT / name).rglob("*")
        if path.is_file()
        and path.suffix != ".py"
        and not NOT_SHIPPED & set(path.relative_to(ROOT).parts)
    }
    assert data, "the py.typed files at least"
    assert not sorted(data - shipped), "add their suffix to package-data in pyproject.toml"


def test_the_changelog_tells_of_this_version(project: dict[str, Any]) -> None:
    version = re.escape(project["project"]["version"])
    changelog = (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")
    assert re.search(rf"^## \[{version}\]", changelog, re.MULTILINE)


def test_the_licence_is_whole() -> None:
    text = (ROOT / "LICENSE").read_text(encoding="utf-8")
    assert "Apache License" in text
    assert "END OF TERMS AND CONDITIONS" in text
