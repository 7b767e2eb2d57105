"""A person is calibrated on the command line, and a run uses what was found."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from typing import Any

import pytest

from sandbox.trial.profiles import load_profile
from tests.support.processes import python


def command(*arguments: str, home: Path) -> subprocess.CompletedProcess:
    own: dict[str, Any] = {
        "HOME": str(home),
        "XDG_CONFIG_HOME": str(home / "config"),
        "COLUMNS": "200",
    }
    return python("-m", "sandbox.cli.main", *arguments, cwd=home, **own)


@pytest.fixture(scope="module")
def calibrated(
    tmp_path_factory: pytest.TempPathFactory,
) -> tuple[subprocess.CompletedProcess[str], Path]:
    home = tmp_path_factory.mktemp("home")
    person = ["--hand-size", "0.88", "--hand", "left", "--turn", "90"]
    return command("hand", "measure", "--device", "simulated", *person, home=home), home


def test_calibrating_a_simulated_person_tells_their_size_and_writes_the_users_profile(
    calibrated: tuple[subprocess.CompletedProcess[str], Path],
) -> None:
    done, home = calibrated
    assert done.returncode == 0, done.stderr
    assert "SIMULATED" in done.stdout
    profile = load_profile(home / "config" / "hand-sandbox" / "profile.json")
    assert (profile.person.hand, profile.person.turn) == ("left", 90)
    assert profile.interval[0] < 0.88 < profile.interval[1]
    assert profile.simulated


def test_a_run_uses_the_profile_only_when_it_is_named(
    calibrated: tuple[subprocess.CompletedProcess[str], Path],
) -> None:
    _, home = calibrated
    plain = command("run", "--seed", "5", "--json", "-", home=home)
    asked = command("run", "--seed", "5", "--json", "-", "--profile", "default", home=home)
    plain, asked = json.loads(plain.stdout), json.loads(asked.stdout)
    (hand,), (own,) = plain["settings"]["hands"], asked["settings"]["hands"]
    assert (hand["side"], hand["size"], hand["turn"]) == ("right", 1.0, 0)
    assert (own["side"], own["turn"]) == ("left", 90)
    assert own["size"] == pytest.approx(0.88, abs=0.1)
    assert plain["success"] and asked["success"]
