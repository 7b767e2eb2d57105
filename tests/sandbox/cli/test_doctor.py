"""`sandbox doctor` and `sandbox` alone: what they say is so, whatever this machine is like."""

from __future__ import annotations

import json
import re
import socket
import tomllib
from importlib.metadata import version
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sandbox.cli import doctor
from sandbox.cli.main import main
from sandbox.doctor import Check, run_probe
from sandbox.doctor.devices import port_check
from sandbox.doctor.system import DEVELOPERS, USES, declared, folder_check, package_checks, within
from tests.support.processes import ROOT


@pytest.fixture(scope="module")
def found() -> list[Check]:
    return doctor.run_checks()


def test_everything_has_a_state_and_what_is_missing_has_a_remedy(found: list[Check]) -> None:
    assert {c.group for c in found} == set(doctor.GROUPS)
    assert len({(c.group, c.name) for c in found}) == len(found)
    for check in found:
        assert check.found and bool(check.remedy) is not check.ok, check
        assert "Error:" not in check.found, "what is missing is said, not what Python says of it"
    told = json.loads(json.dumps(doctor.as_json(found)))
    assert told["missing"] == [c.name for c in found if not c.ok]
    assert {c["state"] for c in told["checks"]} <= {"ok", "missing"}
    assert re.fullmatch("[0-9a-f]{16}", told["versions"]["fingerprint"])


@pytest.mark.parametrize("ok", [True, False])
def test_it_ends_with_1_only_where_something_is_missing_and_that_is_asked_for(
    ok: bool, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    remedy = "" if ok else "buy a [new] one"
    only = [Check("devices", "a thing", ok, "this one", "play", remedy)]
    monkeypatch.setattr(doctor, "run_checks", lambda: only)
    assert main(["doctor"]) == 0
    said = capsys.readouterr().out
    assert "a thing" in said and (remedy or "Nothing is missing") in said
    assert main(["doctor", "--strict"]) == int(not ok)
    assert main(["doctor", "--json", "--strict"]) == int(not ok)


def test_a_port_is_free_until_somebody_listens_on_it() -> None:
    for kind, sort in (("UDP", socket.SOCK_DGRAM), ("TCP", socket.SOCK_STREAM)):
        with socket.socket(socket.AF_INET, sort) as other:
            other.bind(("127.0.0.1", 0))
            if kind == "TCP":
                other.listen()
            port = other.getsockname()[1]
            taken = port_check(kind, port)
            assert not taken.ok and "use" in taken.found and "--port" in taken.remedy
        assert port_check(kind, port).ok


def test_a_probe_that_aborts_hangs_or_fails_is_an_answer() -> None:
    assert run_probe("import os; os.abort()").text.endswith("SIGABRT")
    assert "no answer" in run_probe("import time; time.sleep(60)", patience=0.5).text
    assert run_probe("raise SystemExit('no such screen')").text == "no such screen"
    assert not run_probe("import os; os.abort()").ok and not run_probe("raise SystemExit('no')").ok
    good = run_probe("import os; print('first'); print(os.environ['WORD'])", WORD="last")
    assert good.ok and good.text == "last"


def test_a_folder_can_be_written_or_not(tmp_path: Path) -> None:
    assert folder_check(tmp_path).ok
    assert folder_check(tmp_path / "made" / "later").ok
    assert not (tmp_path / "made").exists() and not list(tmp_path.iterdir())
    file = tmp_path / "file"
    file.write_text("")
    assert not folder_check(file / "below").ok


def test_every_extra_is_looked_at_by_its_own_packages(found: list[Check]) -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = {e for e in project["optional-dependencies"] if e not in DEVELOPERS}
    shown = {c.name: c for c in found if c.group == "extras"}
    assert set(shown) <= extras <= set(USES)
    assert extras - set(shown) <= {"evdev"}
    for name, check in shown.items():
        first = declared()[name][0].package
        assert first in check.found
        if check.ok:
            assert version(first) in check.found
        else:
            assert "pip install" in check.remedy and f"[{name}]" in check.remedy


def test_a_package_that_is_too_old_counts_as_missing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sandbox.doctor.system.version", lambda name: "0.0.1")
    packages = next(c for c in package_checks() if c.name == "packages")
    assert not packages.ok and "mujoco 0.0.1 is not" in packages.found


@given(st.lists(st.integers(0, 30), min_size=1, max_size=4), st.integers(0, 3))
def test_a_version_is_within_its_own_bounds_and_not_below_them(numbers: list[int], at: int) -> None:
    text = ".".join(map(str, numbers))
    assert (
        within(text, f">={text}") and within(text, f"=={text}") and within(text + ".0", f"<={text}")
    )
    assert not within(text, f"<{text}") and not within(text, f">{text}")
    at = min(at, len(numbers) - 1)
    above = ".".join(map(str, [*numbers[:at], numbers[at] + 1, *numbers[at + 1 :]]))
    assert within(above, f">={text}") and not within(above, f">={text},<{above}")
