"""Commands make the files that ship, and notice a file that is another one."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from encoders.capture import save_capture
from encoders.labels.belief import builtin_population_model, from_weights
from encoders.regression.trained import builtin, builtin_capture
from encoders.regression.training import save_model, train
from training.cli.main import COMMANDS, main
from training.population import Population, save_population, simulate_population
from training.shipped import FILES, ROOT, compared


def test_every_file_of_data_has_a_command() -> None:
    folders = (ROOT / "encoders" / "data", ROOT / "models" / "data")
    data = {path for folder in folders for path in folder.iterdir() if path.is_file()}
    assert data == {f.file for f in FILES.values()}
    assert set(FILES) < set(COMMANDS)


@pytest.mark.parametrize("name", ["linear", "paper"])
def test_an_encoder_is_made_to_the_byte_or_within_its_bound(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "made.npz"
    assert main([name, "--out", str(out)]) == 0
    assert f"agrees with {FILES[name].path}" in capsys.readouterr().out
    assert compared(out, FILES[name].file, FILES[name].compare).agrees


@pytest.mark.full
def test_all_files_are_made_to_the_byte_or_within_their_bounds(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["all", "--out", str(tmp_path)]) == 0
    said = capsys.readouterr().out
    assert said.count(" agrees with ") == len(FILES) and " differs from " not in said
    assert {path.name for path in tmp_path.iterdir()} == {f.file.name for f in FILES.values()}


def test_a_capture_may_differ_by_rounding_and_in_few_frames(tmp_path: Path) -> None:
    capture, file = builtin_capture(), FILES["capture"]
    for share, agrees in ((0.0, True), (0.005, True), (0.02, False)):
        q = capture.q + 1e-6
        q[: int(share * len(q))] += 0.01
        save_capture(
            type(capture)(capture.time, capture.trial, capture.ids, capture.xy, q, capture.meta),
            tmp_path / "capture.npz",
        )
        assert compared(tmp_path / "capture.npz", file.file, file.compare).agrees is agrees


def test_an_encoder_with_another_penalty_differs(tmp_path: Path) -> None:
    file = FILES["linear"]
    save_model(train(builtin_capture(), "linear", 1, 3.0), tmp_path / "made.npz", training=False)
    assert not compared(tmp_path / "made.npz", file.file, file.compare).agrees


def test_labels_of_a_network_with_other_weights_or_people_differ(tmp_path: Path) -> None:
    shipped, file, made = builtin_population_model(), FILES["names"], tmp_path / "names.npz"
    rng = np.random.default_rng(0)
    weights = shipped.evidence.network.weights
    for off, people, agrees in (
        (1e-4, shipped.population, True),
        (0.3, shipped.population, False),
        (0.0, "others", False),
    ):
        moved = {k: v + off * rng.normal(size=v.shape) for k, v in weights.items()}
        from_weights(moved, people).save(made)
        assert compared(made, file.file, file.compare).agrees is agrees


def test_an_encoder_of_other_people_differs(tmp_path: Path) -> None:
    model, file = builtin("population"), FILES["population"]
    model.meta["population"]["people"]["first"].append(1_000)
    try:
        save_model(model, tmp_path / "made.npz")
    finally:
        model.meta["population"]["people"]["first"].pop()
    assert not compared(tmp_path / "made.npz", file.file, file.compare).agrees


def test_other_weights_of_palms_differ(tmp_path: Path) -> None:
    file, made = FILES["palm_places"], tmp_path / "palm_places.json"
    for off, agrees in ((1e-4, True), (0.01, False)):
        weights = json.loads(file.file.read_text())
        weights["bias"][0] += off
        made.write_text(json.dumps(weights))
        assert compared(made, file.file, file.compare).agrees is agrees


def test_a_skin_that_is_larger_differs(tmp_path: Path) -> None:
    file, made = FILES["skin"], tmp_path / "skin.npz"
    with np.load(file.file) as stored:
        arrays = {name: stored[name] for name in stored.files}
    header = json.loads(bytes(arrays["header"].tobytes()).decode())
    for factor, agrees in ((1.0 + 1e-5, True), (1.01, False)):
        text = json.dumps({**header, "step": factor * header["step"]})
        np.savez(made, **(arrays | {"header": np.frombuffer(text.encode(), np.uint8)}))
        assert compared(made, file.file, file.compare).agrees is agrees


@pytest.fixture(scope="module")
def few() -> Population:
    return simulate_population("few", {"train": {"posed": 40}})


@pytest.mark.slow
def test_a_file_of_other_people_is_written_and_differs(
    few: Population, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    save_population(few, tmp_path / "people.npz")
    line = ["population", "--population", str(tmp_path / "people.npz")]
    assert main([*line, "--out", str(tmp_path / "made.npz")]) == 1
    assert "differs from" in capsys.readouterr().out
    assert (tmp_path / "made.npz").is_file()


@pytest.mark.parametrize(
    "line",
    [
        "nothing",
        "linear",
        "linear --out none/linear.npz",
        "linear --out x.npz --population people.npz",
        "names --out names.npz --population none.npz",
        "names --out kept.npz --population kept.npz",
        "all --out kept.npz",
        "people --out people.npz --share 2",
        "tables --days 0",
    ],
)
def test_bad_input_costs_one_line(
    line: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("kept.npz").write_bytes(b"kept")
    assert main(line.split()) == 2
    assert capsys.readouterr().err.count("\n") == 1
    assert [path.name for path in tmp_path.iterdir()] == ["kept.npz"]
