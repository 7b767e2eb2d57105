"""Recordings become data sets that give the same states when they are played back."""

from __future__ import annotations

import errno
import json
import shutil
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
import pytest

from models.errors import InputError
from models.frames import Contact
from sandbox import run_trial
from sandbox.cli.main import main
from sandbox.datasets.data_set import DataSet, first_difference
from sandbox.datasets.npz_file import read_npz
from sandbox.datasets.played_trial import actions_of, slots_of, touches_of
from sandbox.datasets.written_data_set import export_data_set
from sandbox.gym import register_task
from sandbox.study.record.journal import Journal
from tests.support.needs import require
from tests.support.processes import ROOT

SEEDS = (6000, 6001)


@pytest.fixture(scope="module")
def recordings(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two recorded trials of training seeds."""
    folder = tmp_path_factory.mktemp("recordings")
    for seed in SEEDS:
        run_trial("box-to-goal", seed, record=folder / f"{seed}.jsonl", trajectories=False)
    return folder


@pytest.fixture(scope="module")
def npz(recordings: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("sets") / "demonstrations.npz"
    assert main(["export", str(recordings), "--to", str(file)]) == 0
    return file


@pytest.fixture(scope="module")
def data(npz: Path) -> DataSet:
    return read_npz(npz)


def made(data: DataSet) -> Any:
    """The environment of a data set."""
    return gymnasium.make(register_task(data.task), **data.options).unwrapped


def test_every_recording_is_a_demonstration_with_its_own_states(
    data: DataSet, recordings: Path
) -> None:
    assert [episode.seed for episode in data.episodes] == list(SEEDS)
    for episode in data.episodes:
        about = episode.about
        assert episode.success and episode.terminated and not episode.truncated
        assert about["simulated"] and about["user"]["kind"] == "skilled"
        assert about["same_states_as_recorded"]
        lines = (recordings / about["source"]).read_text(encoding="utf-8").splitlines()
        assert json.loads(lines[-1])["hash"] == about["recorded_state_hash"] == episode.hashes[-1]
        assert json.loads(lines[0])["versions"] == about["versions"]
        assert episode.rewards.sum() == pytest.approx(2.0)


def test_recordings_in_folders_of_a_folder_are_demonstrations_too_and_those_of_a_study_are_not(
    recordings: Path, tmp_path: Path
) -> None:
    first, second = (recordings / f"{seed}.jsonl" for seed in SEEDS)
    folder = tmp_path / "demonstrations"
    for file, place in ((first, "."), (second, "simulated"), (first, "studies/mine/trials")):
        (folder / place).mkdir(parents=True, exist_ok=True)
        shutil.copy(file, folder / place)
    (folder / "studies" / "mine" / "notes").mkdir()
    out = tmp_path / "all.npz"
    assert main(["export", str(folder), "--to", str(out)]) == 0
    assert [episode.seed for episode in read_npz(out).episodes] == list(SEEDS)


def test_an_empty_file_is_refused_and_other_files_and_copies_are_reported(
    recordings: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder, out = tmp_path / "trials", tmp_path / "set.npz"
    folder.mkdir()
    source = next(iter(sorted(recordings.glob("*.jsonl*"))))
    for name in ("a", "b"):
        shutil.copy(source, folder / f"{name}{''.join(source.suffixes)}")
    (folder / "notes.jsonl").write_text('{"about": "something"}\n')
    assert main(["export", str(folder), "--to", str(out)]) == 0
    said = capsys.readouterr().err
    assert "1 file" in said and "notes.jsonl" in said
    assert "the same recording twice" in said
    (folder / "zero.jsonl").touch()
    assert main(["export", str(folder), "--to", str(out)]) == 2
    assert "zero.jsonl" in capsys.readouterr().err


def test_playing_it_back_gives_the_same_hashes_and_a_changed_action_does_not(data: DataSet) -> None:
    env, episode = made(data), data.episodes[0]
    assert first_difference(env, episode.seed, episode.actions, episode.hashes) is None
    changed = episode.actions.copy()
    down = int(np.flatnonzero(changed[:, 0] > 0.5)[5])
    changed[down, 1] += 1e-6
    first = first_difference(env, episode.seed, changed, episode.hashes)
    assert first is not None and first > down
    env.close()


def test_observations_are_the_environment_s_and_the_hand_s_own_pose_is_among_them(
    data: DataSet,
) -> None:
    env, episode = made(data), data.episodes[1]
    seen, _ = env.reset(seed=episode.seed)
    for step in range(120):
        for name, values in seen.items():
            assert np.array_equal(values, episode.observations[name][step])
        seen, *_ = env.step(episode.actions[step])
    assert len(episode.observations["commanded"]) == len(episode.actions) + 1
    assert episode.observations["time"][50, 0] == pytest.approx(0.8)
    env.close()


def test_a_touch_is_in_the_slot_of_its_finger(data: DataSet) -> None:
    for episode in data.episodes:
        down = episode.observations["touches"][:, :, 0] > 0.5
        labels = episode.observations["labels"]
        known = down & (labels >= 0)
        assert known.sum() > 100
        assert np.array_equal(labels[known], np.broadcast_to(np.arange(5.0), labels.shape)[known])


@pytest.mark.needs("datasets")
def test_minari_recovers_the_environment_and_playing_back_gives_the_same_hashes(
    recordings: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import minari

    monkeypatch.setenv("MINARI_DATASETS_PATH", str(tmp_path))
    name = "hand_sandbox/test/box-to-goal-v0"
    assert main(["export", str(recordings), "--to", "minari", "--name", name]) == 0
    data = minari.load_dataset(name)
    assert data.total_episodes == len(SEEDS)
    env = data.recover_environment()
    for episode, about in zip(
        data.iterate_episodes(), data.storage.get_episode_metadata([0, 1]), strict=True
    ):
        hashes = [text.decode() for text in episode.infos["state_hash"]]
        assert first_difference(env, int(about["seed"]), episode.actions, hashes) is None
        assert about["success"] and about["simulated"]
        assert json.loads(about["versions"])["mujoco"]
        assert set(episode.observations) == set(env.observation_space.spaces)
    env.close()
    with pytest.raises(InputError, match="there is a data set of this name"):
        export_data_set(sorted(recordings.glob("*.jsonl")), Path("minari"), name)


@pytest.mark.needs("robots")
def test_a_robot_s_demonstration_has_the_person_s_hand_beside_its_own(tmp_path: Path) -> None:
    require("robots")
    file = tmp_path / "shadow.jsonl"
    run_trial("box-to-goal", 3, record=file, robot="shadow", trajectories=False)
    export_data_set([file], tmp_path / "set.npz", observe=("commanded",))
    (episode,) = read_npz(tmp_path / "set.npz").episodes
    assert episode.success and episode.about["same_states_as_recorded"]
    assert episode.observations["commanded"].shape[1] == 48
    assert episode.observations["pose"].shape[1] == 28


def test_six_touches_keep_five_slots_and_a_slot_is_empty_between_two_touches() -> None:
    six = [Contact(i, 0.01 * i, 0.05) for i in range(6)]
    frames = [six[:5], six, six[1:], six[1:], six[2:], []]
    touches = touches_of(frames)
    # The sixth begins once a slot has been empty for a period.
    assert [touch.first for touch in touches] == [0, 0, 0, 0, 0, 3]
    slots = slots_of(touches)
    actions = actions_of(touches, slots, None, len(frames)).reshape(6, 5, 3)
    assert slots[5] == slots[0] and actions[2, slots[0], 0] == 0.0
    assert actions[3, slots[5], 1] == pytest.approx(0.05)
    assert actions[5].sum() == 0.0


def test_a_finger_s_slot_that_is_taken_leaves_another_one() -> None:
    frames = [[Contact(0, 0.1, 0.1, label=1)], [Contact(1, 0.1, 0.1, label=1)]]
    first, second = slots_of(touches_of(frames))
    assert first == 1 != second


BAD = {
    "cut short": ("cut.jsonl", "set.npz", "needs a complete recording"),
    "another task": ("6000.jsonl other.jsonl", "set.npz", "must have equal tasks"),
    "no success": ("idle.jsonl", "set.npz", "none with success"),
    "no such file": ("nothing.jsonl", "set.npz", "no such recording"),
    "not a recording": ("text.jsonl", "set.npz", "not a recording"),
    "no versions": ("old.jsonl", "set.npz", "has no versions"),
    "damaged versions": ("older.jsonl", "set.npz", "has no versions"),
    "no folder": ("6000.jsonl", "nowhere/set.npz", "cannot be written"),
    "no name of a file": ("6000.jsonl", "npz", "name the file"),
    "no name for LeRobot": ("6000.jsonl", "lerobot", "needs a name"),
    "no name": ("6000.jsonl", "minari", "needs a name"),
}
"""What is wrong -> files, --to, and the words of the error."""


@pytest.fixture(scope="module")
def damaged(recordings: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of recordings that cannot be exported."""
    folder = tmp_path_factory.mktemp("damaged")
    sound = recordings / "6000.jsonl"
    shutil.copy(sound, folder)
    text = sound.read_text(encoding="utf-8")
    settings = json.loads(text.partition("\n")[0])["settings"]
    other = settings | {"physics": settings["physics"] | {"impulse": 0.5}}
    changed(sound, folder / "other.jsonl", {"settings": other}, {})
    changed(sound, folder / "old.jsonl", {"versions": None}, {})
    changed(sound, folder / "older.jsonl", {"versions": 3}, {})
    (folder / "cut.jsonl").write_text(text[: len(text) // 2], encoding="utf-8")
    (folder / "text.jsonl").write_text("nothing\n", encoding="utf-8")
    # The goal is not reached in a trial that was left early.
    lines = [line for line in text.splitlines() if '"step":0,' in line or '"header"' in line]
    end = json.dumps(json.loads(text.splitlines()[-1]) | {"step": 80})
    (folder / "idle.jsonl").write_text("\n".join([*lines, end]) + "\n", encoding="utf-8")
    return folder


@pytest.mark.parametrize("wrong", BAD)
def test_what_cannot_be_exported_is_one_line(
    wrong: str, damaged: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    names, to, says = BAD[wrong]
    files = [str(damaged / name) for name in names.split()]
    to = to if to in ("npz", "lerobot", "minari") else str(tmp_path / to)
    assert main(["export", *files, "--to", to, "--successes"]) == 2
    (line,) = capsys.readouterr().err.strip().splitlines()
    assert says in line


@pytest.mark.parametrize("name", ["old.jsonl", "older.jsonl"])
def test_a_recording_without_versions_is_not_played_again(
    damaged: Path, name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["replay", str(damaged / name)]) == 2
    (line,) = capsys.readouterr().err.strip().splitlines()
    assert "has no versions" in line and name in line


def test_a_file_that_is_cut_short_is_said_to_be(npz: Path, tmp_path: Path) -> None:
    data = npz.read_bytes()
    for wrong in (data[: len(data) // 2], b"nothing"):
        (tmp_path / "cut.npz").write_bytes(wrong)
        with pytest.raises(InputError, match="not a complete data set") as error:
            read_npz(tmp_path / "cut.npz")
        assert "\n" not in str(error.value)
    with pytest.raises(InputError, match="cannot be read"):
        read_npz(tmp_path / "nothing.npz")


def test_the_true_labels_of_a_recording_are_those_of_its_environment(tmp_path: Path) -> None:
    file = tmp_path / "device.jsonl"
    run_trial("box-to-goal", 6000, record=file, labels="device", trajectories=False)
    export_data_set([file], tmp_path / "set.npz", observe=())
    data = read_npz(tmp_path / "set.npz")
    assert data.options["labels"] == "true"
    assert data.episodes[0].about["same_states_as_recorded"]


def test_states_that_are_not_the_recording_s_are_said_to_be_so(
    recordings: Path, tmp_path: Path
) -> None:
    file = tmp_path / "6000.jsonl"
    *lines, last = (recordings / file.name).read_text(encoding="utf-8").splitlines()
    end = json.dumps(json.loads(last) | {"hash": "0" * 32})
    file.write_text("\n".join([*lines, end]) + "\n", encoding="utf-8")
    found = export_data_set([file], tmp_path / "set.npz", observe=())
    assert found.differing == [str(file)]
    (episode,) = read_npz(tmp_path / "set.npz").episodes
    assert not episode.about["same_states_as_recorded"]


def changed(source: Path, to: Path, header: dict[str, Any], result: dict[str, Any]) -> None:
    """A copy of a recording with other entries of its header and its result."""
    first, *lines, last = source.read_text(encoding="utf-8").splitlines()
    end = json.loads(last)
    end["result"] |= result
    whole = [json.dumps(json.loads(first) | header), *lines, json.dumps(end)]
    to.write_text("\n".join(whole) + "\n", encoding="utf-8")


def trial(journal: Journal, number: int, attempt: int, ends: bool, repeated: bool = False) -> str:
    """Journals an attempt; the name of its file."""
    name = f"T{number:03d}{f'.a{attempt}' if attempt > 1 else ''}.jsonl"
    known: dict[str, Any] = {"step": f"trial-{number}", "trial": number, "attempt": attempt}
    journal.append("trial", **known, file=f"trials/{name}")
    if ends:
        journal.append("trial_end", **known, file=f"trials/{name}", result={})
    if repeated:
        journal.append("command", command="repeat", **known, reason="the tablet was moved")
    return name


def test_a_data_set_of_a_study_has_the_counted_attempt_of_each_finished_trial_and_no_other(
    recordings: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    session = tmp_path / "S001"
    trials = session / "trials"
    trials.mkdir(parents=True)
    first, second = (recordings / f"{seed}.jsonl" for seed in SEEDS)
    journal = Journal(session / "session.jsonl")
    # Killed, broken off, repeated: each was done again.
    killed = trials / trial(journal, 1, 1, ends=False)
    killed.write_bytes(first.read_bytes()[:20_000])
    away = {"broken_off": "the tablet was away for 3 s"}
    changed(second, trials / trial(journal, 1, 2, ends=False), {}, away)
    changed(second, trials / trial(journal, 1, 3, ends=True, repeated=True), {}, {})
    changed(first, trials / trial(journal, 1, 4, ends=True), {}, {})
    changed(second, trials / trial(journal, 2, 1, ends=True), {}, {})
    changed(second, trials / trial(journal, 3, 1, ends=False), {}, away)
    journal.close()
    for name in (session, trials):
        assert main(["export", str(name), "--to", str(tmp_path / "set.npz")]) == 0
        assert "4 attempts that do not count" in " ".join(capsys.readouterr().err.split())
        episodes = read_npz(tmp_path / "set.npz").episodes
        assert [e.about["source"] for e in episodes] == ["T001.a4.jsonl", "T002.jsonl"]
    # Without a journal its end says what does not count.
    lone = tmp_path / "lone.jsonl"
    changed(second, lone, {}, away)
    found = export_data_set([lone, first], tmp_path / "set.npz", observe=())
    assert (found.episodes, found.broken_off) == (1, 1)
    with pytest.raises(InputError, match="no demonstration is left"):
        export_data_set([lone], tmp_path / "set.npz", observe=())
    assert main(["export", f"{session}/T003", "--to", str(tmp_path / "set.npz")]) == 2
    assert "all broken off or repeated" in capsys.readouterr().err


def test_the_dump_of_a_divergence_beside_its_recording_is_no_episode_of_its_own(
    recordings: Path, tmp_path: Path
) -> None:
    for seed in SEEDS:
        changed(recordings / f"{seed}.jsonl", tmp_path / f"box-{seed}.jsonl", {}, {})
    dump = tmp_path / f"box-{SEEDS[0]}-diverged.jsonl"
    changed(recordings / f"{SEEDS[0]}.jsonl", dump, {"dump": {"states": 100}}, {})
    assert main(["export", str(tmp_path), "--to", str(tmp_path / "set.npz")]) == 0
    assert [e.seed for e in read_npz(tmp_path / "set.npz").episodes] == list(SEEDS)


@pytest.mark.needs("datasets")
def test_a_minari_export_that_fails_in_its_second_recording_leaves_no_data_set_and_says_why(
    recordings: Path,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    import minari
    from minari.dataset._storages.hdf5_storage import HDF5Storage

    monkeypatch.setenv("MINARI_DATASETS_PATH", str(tmp_path / "sets"))
    write = HDF5Storage.update_episodes
    errors: list[BaseException] = [OSError(errno.ENOSPC, "No space left on device")]

    def failing(self: Any, episodes: Any) -> None:
        if self.total_episodes >= 1:
            raise errors[0]
        write(self, episodes)

    monkeypatch.setattr(HDF5Storage, "update_episodes", failing)
    name = "lab/a-v0"
    words = ["export", str(recordings), "--to", "minari", "--name", name]
    assert main(words) == 2
    (line,) = capsys.readouterr().err.strip().splitlines()
    assert "the data set cannot be written" in line and "No space left on device" in line
    assert not minari.list_local_datasets() and not (tmp_path / "sets" / name).exists()
    errors[0] = KeyboardInterrupt()
    with pytest.raises(KeyboardInterrupt):
        export_data_set(sorted(recordings.glob("*.jsonl")), Path("minari"), name)
    assert not (tmp_path / "sets" / name).exists()
    (tmp_path / "file").write_text("no folder")
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(tmp_path / "file" / "sets"))
    assert main(words) == 2
    (line,) = capsys.readouterr().err.strip().splitlines()
    assert "the data set cannot be written" in line


def test_a_data_set_of_a_task_in_a_file_gives_its_environment_from_any_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    lab, elsewhere = tmp_path / "lab", tmp_path / "elsewhere"
    lab.mkdir()
    elsewhere.mkdir()
    text = (ROOT / "examples" / "push_the_puck.py").read_text(encoding="utf-8")
    (lab / "puck.py").write_text(text.replace("my-lab-push-the-puck", "lab-puck-of-a-data-set"))
    monkeypatch.chdir(lab)
    assert main(["run", "puck.py", "--seed", "2", "--record", "a.jsonl"]) == 0
    assert main(["run", f"{lab}/puck.py:PushThePuck", "--seed", "3", "--record", "b.jsonl"]) == 0
    assert main(["export", "a.jsonl", "b.jsonl", "--to", "both.npz"]) == 0
    monkeypatch.chdir(elsewhere)
    data = read_npz(lab / "both.npz")
    assert data.task == f"{lab / 'puck.py'}:PushThePuck"
    env = made(data)
    assert env.reset(seed=2)[1]["state_hash"] == data.episodes[0].hashes[0]
    env.close()
