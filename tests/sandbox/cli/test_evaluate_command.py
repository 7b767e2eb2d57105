"""`sandbox evaluate` prints, writes and draws what it measured, and says what it cannot do."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from encoders.capture import Capture, load_capture, save_capture
from encoders.evaluation import methods
from encoders.regression.trained import TrainedModel, builtin_capture
from encoders.regression.training import save_model, train
from sandbox.cli.main import main

PICTURES = ("table-1", "table-2", "by-fingers", "pca-variance", "figure-2")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a training capture and two test captures of other takes."""
    folder = tmp_path_factory.mktemp("captures")
    whole = builtin_capture()
    trials = np.unique(whole.trial)
    for name, chosen, step in (
        ("training", trials[::3], 3),
        ("tests/one", trials[1::24], 12),
        ("tests/two", trials[2::24], 12),
    ):
        frames = np.flatnonzero(np.isin(whole.trial, chosen))[::step]
        path = folder / f"{name}.npz"
        path.parent.mkdir(exist_ok=True)
        save_capture(whole.select(frames), path)
    (folder / "list.txt").write_text("# tests\ntests/two.npz  # the second\n\ntests/one.npz\n")
    return folder


def evaluate(folder: Path, *more: str, encoders: tuple[str, ...] = ("linear", "mean")) -> int:
    """Runs the command on the test captures, trained on the training capture."""
    return main(
        ["evaluate", "--encoders", *encoders, "--train", str(folder / "training.npz"), *more]
    )


@pytest.fixture(scope="module")
def pictures(folder: Path) -> tuple[Path, dict[str, Any]]:
    """A folder of pictures, and the report they were made from."""
    out = folder / "pictures"
    report = folder / "drawn.json"
    line = f"--capture {folder}/tests --no-copas --json {report} --plots {out}"
    assert evaluate(folder, *line.split()) == 0
    return out, json.loads(report.read_text())


@pytest.mark.full
def test_without_a_capture_encoders_are_tested_on_days_of_a_simulated_person(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "day.json"
    words = ["evaluate", "--encoders", "linear", "--days", "1", "--no-copas", "--json", str(path)]
    assert main(words) == 0
    found = json.loads(path.read_text())
    assert found["configuration"]["days"] == [found["tests"][0]["day"]]
    assert found["simulated"] is True and "SIMULATED" in capsys.readouterr().out


def quickly_trained(capture: Capture, progress: object = None) -> TrainedModel:
    model = train(capture, "trained", 1, 0.0)
    return replace(model, meta=model.meta | {"winner": "quadratic, ridge 0.1"})


def test_what_is_trained_on_the_person_who_is_tested_has_a_row_of_that_name(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(methods, "person_model", quickly_trained)
    learned, other = str(folder / "training.npz"), str(folder / "tests" / "one.npz")
    line = ["evaluate", "--encoders", "linear", "trained", "--no-copas"]
    path = folder / "own.json"
    assert main([*line, "--capture", learned, "--train", "split", "--json", str(path)]) == 0
    assert "trained on this person" in capsys.readouterr().out
    encoders = json.loads(path.read_text())["encoders"]
    linear, own = (encoders[name]["labels_percent"]["5"] for name in ("linear", "trained"))
    assert own > 90 > linear
    assert main([*line, "--capture", other, "--train", learned]) == 0
    assert "trained on this person" not in capsys.readouterr().out


def refused(capsys: pytest.CaptureFixture[str], *argv: str) -> str:
    """The one line with which a command is refused."""
    assert main(["evaluate", *argv]) == 2
    shown = capsys.readouterr()
    assert shown.err.startswith("sandbox: ") and shown.err.count("\n") == 1
    assert shown.out == ""
    return shown.err


def test_captures_of_a_list_are_judged_one_by_one_and_together(folder: Path) -> None:
    path = folder / "listed.json"
    tests = str(folder / "list.txt")
    assert evaluate(folder, "--capture", tests, "--no-copas", "--json", str(path)) == 0
    found = json.loads(path.read_text())
    frames = [t["frames"] for t in found["tests"]]
    each = [c["wrist_cm"]["true_labels"] for c in found["encoders"]["linear"]["by_capture"]]
    together = found["encoders"]["linear"]["wrist_cm"]["true_labels"]
    assert len(each) == 2
    assert np.average(each, weights=frames) == pytest.approx(together)


def test_a_capture_can_be_split_into_takes_to_learn_from_and_takes_to_test_on(folder: Path) -> None:
    path, capture = folder / "split.json", str(folder / "training.npz")
    argv = ["--encoders", "mean", "--capture", capture, "--train", "split", "--no-copas"]
    assert main(["evaluate", *argv, "--json", str(path)]) == 0
    found = json.loads(path.read_text())
    takes = found["configuration"]["test_takes"]
    assert found["tests"][0]["takes"] == len(takes) > 0
    whole = builtin_capture().trial
    # A take whose fingers no other take has is not tested on.
    assert 0 <= len(np.unique(whole)[::3]) - found["training"]["takes"] - len(takes) < 3
    assert found["training"]["frames"] > 3 * found["tests"][0]["frames"]


def test_a_capture_with_every_set_in_one_take_still_tests_what_can_be_tested(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    whole = builtin_capture()
    sets = np.packbits(whole.down, axis=1)[:, 0]
    first = {int(s): int(whole.trial[np.flatnonzero(sets == s)[0]]) for s in np.unique(sets)}
    last = {int(s): int(whole.trial[np.flatnonzero(sets == s)[-1]]) for s in np.unique(sets)}
    once = whole.select(np.isin(whole.trial, list(first.values())))
    save_capture(once, folder / "once.npz")
    argv = ["--capture", str(folder / "once.npz"), "--train", "split", "--no-copas"]
    assert "at least twice" in refused(capsys, "--encoders", "pca-ik", *argv)
    twice = list(first.values()) + list(last.values())[:-6]
    save_capture(whole.select(np.isin(whole.trial, twice)), folder / "once.npz")
    assert main(["evaluate", "--encoders", "pca-ik", "linear", *argv]) == 0
    assert "only one take has their set of fingers" in capsys.readouterr().err


RAISES = """
import numpy as np
from encoders import Encoder

class Raises(Encoder):
    def fit(self, U, Q):
        self.q = Q.mean(axis=0)
    def predict(self, U):
        if len(np.atleast_2d(U)) > 1:
            raise KeyError("three fingers")
        return self.q if np.ndim(U) == 1 else self.q[None]
"""


def test_an_encoder_that_fails_is_named_and_the_others_are_judged(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "mine.py").write_text(RAISES)
    capture = str(folder / "tests" / "one.npz")
    argv = ["--encoders", f"{tmp_path / 'mine.py'}:Raises", "mean", "--capture", capture]
    train = ["--train", str(folder / "training.npz"), "--no-copas", "--json", "-"]
    assert main(["evaluate", *argv, *train]) == 2
    out, err = capsys.readouterr()
    assert "Raises was left out" in err and "three fingers" in err and "Traceback" not in err
    assert '"mean"' in out


def test_a_model_from_a_file_is_evaluated_under_the_files_name(folder: Path) -> None:
    model, path = folder / "mine.npz", folder / "mine.json"
    whole = builtin_capture()
    small = whole.select(np.arange(0, len(whole), 25))
    save_model(train(small, "mine", 1, 0.0), model)
    tests = str(folder / "tests" / "one.npz")
    assert evaluate(folder, "--capture", tests, "--json", str(path), encoders=(str(model),)) == 0
    e = json.loads(path.read_text())["encoders"]["mine"]
    assert e["overfitted_joints"] is None and e["wrist_cm"]["true_labels"] > 0


def test_a_model_is_not_tested_on_the_capture_that_it_learned_from(
    folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    test = folder / "tests" / "one.npz"
    save_model(train(load_capture(test), "learned", 1, 0.0), folder / "learned.npz")
    error = refused(
        capsys, "--encoders", str(folder / "learned.npz"), "--capture", str(test), "--no-copas"
    )
    assert "would be tested on its training frames" in error and "--train split" in error


@pytest.mark.parametrize(
    ("argv", "words"),
    [
        (("--encoders", "quintic"), ("quintic", "Did you mean quadratic?")),
        (("--encoders", "linear", "linear"), ("once", "linear")),
        (("--encoders", "missing.npz"), ("missing.npz", "no such file")),
        (("--days", "0"), ("--days", "1 or more")),
        (("--json", "nowhere/out.json"), ("--json nowhere/out.json", "folder")),
        (("--train", "split"), ("--train split", "one --capture FILE")),
        (("--capture", "empty"), ("empty", "no captures")),
        (("--capture", "list.txt"), ("gone.npz", "no such file")),
        (("--capture", "junk.npz"), ("junk.npz", "not a capture")),
    ],
)
def test_what_cannot_be_done_is_one_clear_line(
    argv: tuple[str, ...],
    words: tuple[str, ...],
    capsys: pytest.CaptureFixture[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "empty").mkdir()
    (tmp_path / "list.txt").write_text("gone.npz\n")
    (tmp_path / "junk.npz").write_bytes(b"junk")
    encoders = () if "--encoders" in argv else ("--encoders", "mean")
    train = () if "--train" in argv or "--capture" not in argv else ("--train", "builtin")
    text = refused(capsys, *encoders, *argv, *train)
    for word in words:
        assert word in text


def test_every_picture_is_drawn_twice_and_shows_something(
    pictures: tuple[Path, dict[str, Any]],
) -> None:
    out, _ = pictures
    made = {path.name for path in out.iterdir()}
    assert made == {f"{name}.{kind}" for name in PICTURES for kind in ("png", "svg")}
    for name in PICTURES:
        with Image.open(out / f"{name}.png") as picture:
            pixels = np.asarray(picture.convert("L"))
        assert min(pixels.shape) > 300 and pixels.std() > 10
        assert (out / f"{name}.svg").read_text().rstrip().endswith("</svg>")
