"""Recordings become data sets of LeRobot that keep what was done to the bit."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest

from models.errors import InputError
from sandbox import run_trial
from sandbox.cli.main import main
from sandbox.datasets.data_set import first_difference
from sandbox.datasets.lerobot_folder import combined, read_lerobot, statistics_of
from sandbox.datasets.npz_file import read_npz
from sandbox.gym import register_task

NAME = "me/box-to-goal"


SEEDS = (6002, 6003)


pytestmark = pytest.mark.needs("datasets")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A data set of two trials of training seeds, and the same as .npz beside it."""
    home = tmp_path_factory.mktemp("lerobot")
    files = [str(home / f"{seed}.jsonl") for seed in SEEDS]
    for seed, file in zip(SEEDS, files, strict=True):
        run_trial("box-to-goal", seed, record=file, trajectories=False)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("HF_LEROBOT_HOME", str(home))
        assert main(["export", *files, "--to", "lerobot", "--name", NAME]) == 0
    assert main(["export", *files, "--to", str(home / "same.npz")]) == 0
    return home / NAME


def info_of(folder: Path) -> dict[str, Any]:
    return json.loads((folder / "meta/info.json").read_text(encoding="utf-8"))


def frames_of(folder: Path) -> Any:
    import pyarrow.parquet

    return pyarrow.parquet.read_table(folder / "data/chunk-000/file-000.parquet")


def test_playing_it_back_gives_the_same_hashes(folder: Path) -> None:
    data = read_lerobot(folder)
    env = gymnasium.make(register_task(data.task), **data.options)
    assert [episode.seed for episode in data.episodes] == list(SEEDS)
    for episode in data.episodes:
        assert first_difference(env, episode.seed, episode.actions, episode.hashes) is None
        assert episode.success and episode.about["simulated"]
    env.close()


def test_it_holds_what_the_npz_file_holds_in_single_precision(folder: Path) -> None:
    pairs = zip(
        read_lerobot(folder).episodes,
        read_npz(folder.parents[1] / "same.npz").episodes,
        strict=True,
    )
    names = info_of(folder)["features"]["observation.state"]["names"]
    for kept, same in pairs:
        assert np.array_equal(kept.actions, same.actions) and kept.hashes == same.hashes
        assert kept.terminated == same.terminated and kept.about == same.about
        state = kept.observations["observation.state"]
        assert state.dtype == np.float32 and len(state) == len(kept.actions)
        tips = state[:, [i for i, name in enumerate(names) if name.startswith("tips.")]]
        wanted = same.observations["tips"][:-1].reshape(len(tips), -1).astype(np.float32)
        assert np.array_equal(tips, wanted)


def test_counters_and_times_run_on_from_episode_to_episode(folder: Path) -> None:
    import pandas

    frames, info = frames_of(folder).to_pandas(), info_of(folder)
    assert info["codebase_version"] == "v3.0" and info["fps"] == 62.5
    assert np.array_equal(frames["index"], np.arange(info["total_frames"]))
    assert np.allclose(frames["timestamp"], frames["frame_index"] / info["fps"], atol=1e-6)
    rows = pandas.read_parquet(folder / "meta/episodes/chunk-000/file-000.parquet")
    for row in rows.itertuples():
        own = frames[row.dataset_from_index : row.dataset_to_index]
        assert (own["episode_index"] == row.episode_index).all() and len(own) == row.length
        assert np.array_equal(own["frame_index"], np.arange(row.length))
        assert own["next.done"].tolist() == [False] * (row.length - 1) + [True]
        assert bool(own["next.success"].iloc[-1]) == row.success
    tasks = pandas.read_parquet(folder / "meta/tasks.parquet")
    assert tasks.index.tolist() == ["Bring a 5 cm box onto its translucent twin."]


def test_statistics_are_those_of_all_frames(folder: Path) -> None:
    stats = json.loads((folder / "meta/stats.json").read_text(encoding="utf-8"))
    action = np.array(frames_of(folder)["exact_action"].to_pylist())
    wanted = statistics_of(action)
    for name in ("min", "max", "mean", "std", "count"):
        assert np.allclose(stats["exact_action"][name], wanted[name], atol=1e-12), name
    assert set(stats["action"]) == set(wanted)


def test_statistics_of_parts_together_are_those_of_the_whole() -> None:
    rng = np.random.default_rng(3)
    parts = [rng.normal(k, 1.0 + k, (40 + 30 * k, 4)) for k in range(3)]
    together, whole = combined([*map(statistics_of, parts)]), statistics_of(np.concatenate(parts))
    for name in ("min", "max", "mean", "std", "count"):
        assert np.allclose(together[name], whole[name], rtol=1e-12)


def test_a_file_that_is_full_is_followed_by_another(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sandbox.datasets.lerobot_folder.FILE_SIZE", 0)
    monkeypatch.setattr("sandbox.datasets.lerobot_folder.FILES", 1)
    monkeypatch.setenv("HF_LEROBOT_HOME", str(tmp_path))
    files = [str(folder.parents[1] / f"{seed}.jsonl") for seed in SEEDS]
    assert main(["export", *files, "--to", "lerobot", "--name", NAME]) == 0
    assert [p.parent.name for p in sorted((tmp_path / NAME / "data").rglob("*.parquet"))] == [
        "chunk-000",
        "chunk-001",
    ]
    pairs = zip(read_lerobot(folder).episodes, read_lerobot(tmp_path / NAME).episodes, strict=True)
    assert all(one.hashes == two.hashes for one, two in pairs)


def test_a_name_that_is_taken_or_wrong_is_one_line(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("HF_LEROBOT_HOME", str(folder.parents[1]))
    recording = str(folder.parents[1] / f"{SEEDS[0]}.jsonl")
    for name, says in ((NAME, "there is a data set"), ("../box", "not a name"), ("me", "not a")):
        assert main(["export", recording, "--to", "lerobot", "--name", name]) == 2
        (line,) = capsys.readouterr().err.strip().splitlines()
        assert says in line


def test_a_data_set_that_is_cut_short_is_said_to_be(folder: Path, tmp_path: Path) -> None:
    for number, wrong in enumerate(("data", "meta/info.json", "meta/hand_sandbox.json")):
        copy = tmp_path / str(number)
        shutil.copytree(folder, copy)
        file = next((copy / wrong).rglob("*.parquet")) if wrong == "data" else copy / wrong
        file.write_bytes(file.read_bytes()[: file.stat().st_size // 2])
        with pytest.raises(InputError, match="not a complete data set") as error:
            read_lerobot(copy)
        assert "\n" not in str(error.value)
        file.unlink()
        with pytest.raises(InputError):
            read_lerobot(copy)
