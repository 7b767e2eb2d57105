"""Frames are written beside what goes on, and what cannot be written costs one line."""

from __future__ import annotations

from pathlib import Path
from threading import Event
from typing import Any

from sandbox.study.record.trial_files import frames_of
from sandbox.study.tables.frame_table import FrameTable, FrameWriter, read_frames


class Slow(FrameTable):
    """Frames whose file takes as long as the test wants."""

    def __init__(self) -> None:
        super().__init__()
        self.go_on = Event()

    def columns(self) -> dict[str, Any]:
        assert self.go_on.wait(60.0)
        return {"time_s": [0.016, 0.032]}


def test_nobody_waits_for_the_file_of_the_frames(tmp_path: Path) -> None:
    first, second = Slow(), Slow()
    writer = FrameWriter()
    for table, name in ((first, "T001"), (second, "T002")):
        writer.write(table, tmp_path / f"{name}.jsonl")
    assert not list(tmp_path.iterdir())
    for table in (first, second):
        table.go_on.set()
    assert list(writer.finish()) == [] and list(writer.finish()) == []
    for name in ("T001", "T002"):
        trial = read_frames(tmp_path / f"{name}.jsonl")
        assert trial is not None and trial.t.tolist() == [0.016, 0.032]


def test_frames_that_cannot_be_written_cost_a_line_and_no_other_frames(tmp_path: Path) -> None:
    writer = FrameWriter()
    for folder in (tmp_path / "not there", tmp_path):
        table = Slow()
        table.go_on.set()
        writer.write(table, folder / "T001.jsonl")
    (line,) = writer.finish()
    assert "not there" in line and frames_of(tmp_path / "T001.jsonl").exists()
