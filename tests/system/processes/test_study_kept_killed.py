"""A study that is packed or kept while its program runs or dies."""

from __future__ import annotations

import resource
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from models.errors import StudyError
from sandbox.recording.recording import read_stored, stored
from sandbox.study.record.durable_files import remove_unfinished
from sandbox.study.record.folder import SIMULATED, StudyFolder
from sandbox.study.record.trial_files import pack
from sandbox.study.run.simulated_study import simulate
from tests.support.study_files import (
    FIRST,
    SECOND,
    TWICE,
    check_session,
    design,
    in_child,
    killed_after,
    recordings,
    rows_of,
    told_finished,
)

Say = Callable[[str], object]


def test_a_kill_while_recordings_are_compressed_loses_none(tmp_path: Path) -> None:
    made = recordings(tmp_path, 4)

    def work(say: Say) -> None:
        while True:
            for path, data in made.items():
                pack(path)
                say("packed")
                path.write_bytes(data)

    rng, told = np.random.default_rng(9), 0
    for _ in range(15):
        killed, said = killed_after(in_child(work), float(rng.uniform(0.01, 0.15)))
        assert killed
        told += said.count("packed")
        for path, data in made.items():
            whole = Path(f"{path}.gz")
            # The plain file is half there where the kill came while this test wrote it.
            assert (whole if whole.exists() else path).exists()
            assert read_stored(whole if whole.exists() else path) == (data, True)
            path.write_bytes(data)
            pack(path)
            assert stored(path) == whole and read_stored(path) == (data, True)
        remove_unfinished(tmp_path)
        assert len(list(tmp_path.iterdir())) == len(made)
    assert told > 15


def test_where_there_is_no_room_the_recording_stays_as_it_is(tmp_path: Path) -> None:
    ((path, data),) = recordings(tmp_path, 1).items()

    def work(say: Say) -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))
        try:
            pack(path)
        except StudyError as error:
            say(f"refused: {error}")

    killed, said = killed_after(in_child(work), 60.0)
    assert not killed and "refused" in said
    assert path.read_bytes() == data and [path] == list(tmp_path.iterdir())


@pytest.mark.slow
def test_kills_in_both_sessions_lose_nothing_and_count_nothing_twice(tmp_path: Path) -> None:
    # Children inherit what is loaded here, and get somewhere before they are killed.
    simulate(
        StudyFolder(tmp_path / "loaded", design(TWICE), SIMULATED), 1, False, lambda text: None
    )
    study = StudyFolder(tmp_path / "killed", design(TWICE), SIMULATED)
    rng = np.random.default_rng(4)
    finished, kills, killed, in_second = [0, 0], 0, True, 0

    def begun() -> bool:
        """However fast this machine is, one kill is in the second session."""
        return not in_second and any(study.path.glob("*/S002/trials/*"))

    while killed:
        wait = float(rng.uniform(0.0, 0.8)) if kills < 8 or not in_second else 120.0
        child = in_child(lambda say: simulate(study, 1, True, say))
        killed, said = killed_after(child, wait, begun)
        kills += killed
        at_least = finished[1] if finished[0] == FIRST else 0
        if finished[0] < FIRST:
            finished[0] = check_session(study, 1, finished[0])
        finished[1] = check_session(study, 1, at_least, 2)
        in_second += killed and finished[0] == FIRST and finished[1] < SECOND
        assert finished[1] == 0 or finished[0] == FIRST
        assert told_finished(said) <= max(finished)
    assert finished == [FIRST, SECOND] and in_second
    rows = rows_of(study.path / "tables/trials.csv")
    assert [(r["session"], r["trial"]) for r in rows if r["counted"] == "1"] == [
        *(("1", str(n + 1)) for n in range(FIRST)),
        *(("2", str(n + 1)) for n in range(SECOND)),
    ]
