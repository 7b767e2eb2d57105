"""The pages about demonstrations and robots' hands do what they print."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

from sandbox.cli.main import main
from tests.models.robot.hinge_hand import TIPS, hinge_hand

DOCS = Path(__file__).parents[3] / "docs"
FENCED = re.compile(r"^```(python)?\n(.*?)^```", re.M | re.S)


def printed(page: str) -> list[tuple[str, str]]:
    """Kind and text of every block of a page, in order."""
    return FENCED.findall((DOCS / page).read_text(encoding="utf-8"))


def do(line: str) -> None:
    """Runs a printed line; what installs, or needs a tablet, was done before."""
    words = shlex.split(line)
    if words[0] == "mkdir":
        Path(words[1]).mkdir()
    elif words[0] == "sandbox" and "--tablet" not in words:
        assert main(words[1:]) == 0, line
    else:
        assert Path(words[0]).name == "pip" or "--tablet" in words, line


@pytest.mark.full
@pytest.mark.needs("datasets")
def test_demonstrations_in_ten_minutes_as_printed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(tmp_path / "minari"))
    # The last block trains a policy, which tests/system/learning does.
    *blocks, _ = printed("data-sets.md")
    assert [kind for kind, _ in blocks] == ["", "", "", "python", "python"]
    for kind, text in blocks:
        if kind:
            exec(text, {})
        else:
            for line in text.splitlines():
                do(line)
    told = capsys.readouterr().out
    assert "3 demonstrations of" in told and "3 successful, 3 by a simulated user" in told
    assert re.search(r"^2 True \(\d+, 15\) True$", told, re.M)


@pytest.mark.full
@pytest.mark.needs("robots", "opengl")
def test_my_robot_s_hand_as_printed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    text = hinge_hand(tmp_path).read_text(encoding="utf-8")
    # The page's own hand has other names of tips.
    own = "th_tip", "ff_tip", "mf_tip", "rf_tip", "lf_tip"
    for name, new in zip(TIPS, own, strict=True):
        assert f'"{name}"' in text
        text = text.replace(f'"{name}"', f'"{new}"')
    Path("my_hand.xml").write_text(text, encoding="utf-8")
    for _, block in printed("robots.md"):
        for line in block.splitlines():
            do(line)
    told = capsys.readouterr().out
    assert told.count("box-to-goal: done") == 2
    assert Path("shadow.webp").stat().st_size > 1000 and Path("my_hand.png").exists()
