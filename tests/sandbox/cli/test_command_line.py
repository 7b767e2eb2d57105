"""What the command line refuses: one clear line, exit status 2, for every command."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from models.errors import InputError
from sandbox.cli import removed
from sandbox.cli.main import COMMANDS, main
from sandbox.cli.removed import REMOVED, refuse_removed
from sandbox.cli.study.command import ACTIONS

WITH_PARTS = {
    "touches": ("show", "record", "send"),
    "hand": ("measure", "rest", "show", "forget"),
    "paalm": ("show", "calibrate"),
    "study": tuple(ACTIONS),
}
EVERY = [
    [name, *part]
    for name in COMMANDS
    if name != "devices"
    for part in ([[p] for p in WITH_PARTS[name]] if name in WITH_PARTS else [[]])
] + [
    ["devices", *line.split()]
    for line in ("leap fake", "leap simulate", "webcam record", "webcam status", "robot fit")
]


DEVICE_THAT_ENDS_THE_PROGRAM = """
from sandbox.devices.device import Device

class Ends(Device):
    name = "ends"
    finished = False
    def __init__(self, surface, argument):
        pass
    def poll(self, now):
        {poll}
    def close(self):
        {close}
"""


def refused(capsys: pytest.CaptureFixture[str], *argv: str) -> str:
    """The one line."""
    assert main(list(argv)) == 2
    said = capsys.readouterr()
    assert said.out == ""
    (line,) = said.err.splitlines()
    assert line.startswith("sandbox: ")
    return line


@pytest.mark.parametrize("command", EVERY, ids=" ".join)
def test_an_option_that_there_is_not_is_one_line_that_leads_on(
    command: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    line = refused(capsys, *command, "--no-such-option", "7")
    assert not set(line) & set("╭│╰")
    assert len(line) < 400


@pytest.mark.parametrize(
    ("argv", "words"),
    [
        (["play", "box-to-goal", "--hand", "middle"], ["'middle'", "--hand", "right, left"]),
        (["play", "box-to-goal", "--page-port", "x"], ["--page-port", "'x'"]),
        (["run", "stack", "--device", "web"], ["--device web", "sandbox play stack --device web"]),
        (["run", "box-to-goal", "--json", "x" * 300], ["--json", "cannot be written"]),
        (["run", "--bare", "--labels", "population"], ["--bare", "--labels population"]),
        (["play", "--view", "web", "--record", "no-folder/x.jsonl"], ["no such folder"]),
        (["run", "box-to-goal", "--devic", "simulated"], ["--devic", "Did you mean --device?"]),
        (["run", "box-to-goal", "--seed"], ["--seed: its value is missing (expected INT)"]),
        (["plya"], ["'plya'", "Did you mean play?"]),
        (["run", "box-to-goal", "stack"], ["too many words", "'stack'"]),
        (["run", "--seed", "1.5"], ["--seed: not a whole number (got '1.5')"]),
    ],
    ids=lambda v: " ".join(v) if isinstance(v, list) else None,
)
def test_it_says_what_is_wrong_and_with_which_word(
    argv: list[str], words: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    line = refused(capsys, *argv)
    for word in words:
        assert word in line
    assert "'None'" not in line


@pytest.mark.parametrize("command", EVERY, ids=" ".join)
def test_every_command_has_help(command: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as stop:
        main([*command, "--help"])
    assert stop.value.code == 0
    help_text = capsys.readouterr().out
    assert "Usage: sandbox " + " ".join(command) in " ".join(help_text.split())
    # What may be left out is not offered as a value.
    assert not re.search(r"\bNone\b", help_text)


@pytest.mark.parametrize(
    ("poll", "close", "status", "says"),
    [
        ("raise SystemExit", "pass", 2, "`poll` of this device fails (got 'SystemExit"),
        ("1 / 0", "raise SystemExit", 1, "somebody else's code ended the program (SystemExit"),
    ],
)
def test_somebody_s_code_that_ends_the_program_is_no_command_that_is_done(
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    poll: str,
    close: str,
    status: int,
    says: str,
) -> None:
    device = tmp_path / "ends.py"
    device.write_text(DEVICE_THAT_ENDS_THE_PROGRAM.format(poll=poll, close=close))
    assert main(["run", "box-to-goal", "--device", f"{device}:Ends"]) == status
    said = capsys.readouterr().err
    assert says in said and "ends.py:" in said


def test_a_trial_that_fails_exits_with_0(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "wrench-turn", "--user", "idle"]) == 0
    assert "timeout" in capsys.readouterr().out


def test_touches_that_cannot_be_recorded_leave_no_file_in_the_way_of_the_corrected_command(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file, source = tmp_path / "new.jsonl", tmp_path / "frames.jsonl"
    line = ["touches", "record", str(file), "--device", str(source)]
    assert main(line) == 2
    assert "no such device" in capsys.readouterr().err and not file.exists()
    source.write_text('{"time": 0, "contacts": []}\n')
    assert main(line) == 0
    assert len(file.read_text().splitlines()) == 2


def test_a_recording_into_which_nothing_came_leaves_no_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "new.jsonl"
    line = ["touches", "record", str(file), "--device", "tuio", "--port", "0", "--seconds", "0.2"]
    assert main(line) == 1
    assert "nothing arrived" in capsys.readouterr().err
    assert not file.exists()


@pytest.mark.parametrize("old", REMOVED)
def test_every_entry_is_refused_in_one_line(old: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(old.split()) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert old in line and REMOVED[old] in line


def test_words_match_exactly_and_options_stand_anywhere(monkeypatch: pytest.MonkeyPatch) -> None:
    table = {"study plan --pilot": "a", "study preregister": "b", "train --encoder mean": "c"}
    table |= {"--without history": "d", "--tell-labels": "e"}
    monkeypatch.setattr(removed, "REMOVED", table)
    for line in (
        "study plan design.toml --pilot 12",
        "study plan --pilot=12",
        "study preregister design.toml",
        "train --out x.npz --encoder=mean",
        "run stack --without stitch history --seed 3",
        "regress --tell-labels",
    ):
        with pytest.raises(InputError, match="was removed"):
            refuse_removed(line.split())
    for line in ("study plan --pilots", "study run preregister", "train --encoder meaner", "train"):
        refuse_removed(line.split())
