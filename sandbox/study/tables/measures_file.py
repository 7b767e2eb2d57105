"""The file of a trial's measures: values, reasons of empty cells, and how far replays agreed.

Measures are computed from the recorded states only: when the trial ends, and where a replay gives
every recorded state. Elsewhere existing values stay as they are, and missing measures are empty.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from models.errors import StudyError
from models.json_input import decoded_record, read_bytes
from sandbox.recording.versions import versions
from sandbox.study.measures.columns import Columns
from sandbox.study.measures.compute import VERSION, measure_result, measure_trial
from sandbox.study.measures.kept import DIFFERS
from sandbox.study.measures.registry import measures
from sandbox.study.record.build import code_digest
from sandbox.study.record.files import write_atomically
from sandbox.study.record.measure_definitions import external_definitions
from sandbox.trial.result import TrialResult

REASONS = "reasons"
"""Key in a file of measures: the reasons why cells are empty, by measure."""
REPLAY = "replay"
"""Key in a file of measures: the replay whose states were not the recorded ones, if any."""
DEFINITIONS = "definitions"
"""Key in a file of measures: digests of the measures of packages that made it, by measure."""
OLDER = "older"
"""Key in a file of measures: a file of other definitions that this one has replaced."""


def write_measures(
    folder: Path, stem: str, table: Columns, result: TrialResult, truth: str
) -> list[str]:
    """Writes the measures of a trial, and the reasons why some are empty.

    Args:
        folder: Folder of the tables.
        stem: Name of the trial's recording without suffix.
        table: The 60 Hz table of the trial, of the recorded states.
        result: The trial's result.
        truth: Source of the true fingers; empty if they are unknown.

    Returns:
        A line for every failed measure.

    Raises:
        StudyError: The file cannot be written.
    """
    measured, at_end = measure_trial(table, result, truth), measure_result(result)
    values = {
        "version": VERSION,
        "truth": truth,
        **_definitions(),
        **measured.values,
        REASONS: {**measured.reasons, **at_end.reasons},
    }
    _write(folder, stem, values)
    return [*measured.notices, *at_end.notices]


def keep_measures(folder: Path, stem: str, differs: str, compared: bool) -> None:
    """Keeps the measures of a trial whose replay did not give the recorded states.

    Args:
        folder: Folder of the tables.
        stem: Name of the trial's recording without suffix.
        differs: What differs, in words.
        compared: True if states were compared, so that another replay here gives nothing new.

    Raises:
        StudyError: The file cannot be written.
    """
    kept = _read(folder, stem)
    stored = kept if kept.get("version") == VERSION else {}
    missing = _to_compute(stored)
    changed = any(name in stored for name in missing)
    older = {OLDER: kept} if kept and (changed or not stored) else {}
    reasons = stored.get(REASONS)
    why = f"a replay did not give the recorded states. What differs: {differs}"
    values = {
        "version": VERSION,
        "truth": "",
        **stored,
        **older,
        **_definitions(),
        **dict.fromkeys(missing),
        REASONS: {**(reasons if isinstance(reasons, dict) else {}), **dict.fromkeys(missing, why)},
        REPLAY: {"differs": differs, "by": _computed_by() if compared else ""},
    }
    _write(folder, stem, values)


def read_measures(folder: Path, stem: str) -> dict[str, Any]:
    """Reads the measures of a trial; empty if they are missing or of other definitions."""
    stored = _stored(folder, stem)
    apart = ("truth", REASONS, REPLAY, OLDER, DEFINITIONS)
    values = {name: value for name, value in stored.items() if name not in apart}
    differs = _replay(stored).get("differs")
    return values | ({DIFFERS: differs} if isinstance(differs, str) else {})


def measures_are_complete(folder: Path, stem: str) -> bool:
    """Returns True if every measure is there, of today's definition and of the recorded states."""
    stored = _stored(folder, stem)
    return REPLAY not in stored and not _to_compute(stored)


def measures_were_kept(folder: Path, stem: str) -> bool:
    """Returns True if every measure is there, and another replay here would give the same."""
    stored = _stored(folder, stem)
    by = _replay(stored).get("by")
    return by == _computed_by() and not _to_compute(stored)


def _to_compute(stored: dict[str, Any]) -> list[str]:
    """Names of the measures that need the 60 Hz table and that a file lacks, or has of another
    definition."""
    made_by = stored.get(DEFINITIONS)
    before = made_by if isinstance(made_by, dict) else {}
    now = external_definitions()
    names = [measure.name for measure in measures() if measure.of_trial is not None]
    return [n for n in names if n not in stored or (n in now and now[n] != before.get(n))]


def _definitions() -> dict[str, dict[str, str]]:
    """What the measures of packages are made by, as an entry of the file; none without any."""
    outside = external_definitions()
    return {DEFINITIONS: outside} if outside else {}


def _computed_by() -> str:
    """What the states of a replay depend on here."""
    return f"{versions()['fingerprint']} {code_digest()}"


def _replay(stored: dict[str, Any]) -> dict[str, Any]:
    replay = stored.get(REPLAY)
    return replay if isinstance(replay, dict) else {}


def _stored(folder: Path, stem: str) -> dict[str, Any]:
    values = _read(folder, stem)
    return values if values.pop("version", None) == VERSION else {}


def _read(folder: Path, stem: str) -> dict[str, Any]:
    path, what = folder / f"measures_{stem}.json", "the measures cannot be read"
    try:
        data = read_bytes(path, StudyError, what=what)
        return dict(decoded_record(data, StudyError, what=what, where=str(path)))
    except StudyError:
        return {}


def _write(folder: Path, stem: str, values: dict[str, Any]) -> None:
    data = json.dumps(values, indent=1).encode() + b"\n"
    write_atomically(folder / f"measures_{stem}.json", data, durable=False)
