"""The result of a trial: every field with its unit, its meaning and the records that contain it.

`sandbox run --json`, recordings, `sandbox regress` and its baselines, a study's journals and tables
are all derived from this one declaration.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from functools import cache
from typing import TYPE_CHECKING, Annotated, Any, get_type_hints

import msgspec

from models.errors import RecordingError
from models.json_input import checked
from tasks.score import Score, Status

if TYPE_CHECKING:
    from sandbox.session.session import Session

SCHEMA = 1
"""Version of a trial's JSON."""


class ResultRecord(StrEnum):
    """A record that contains only some fields of a result.

    A trial's JSON and its recording contain all fields.
    """

    JOURNAL = "journal"
    """A `trial_end` record of a study's journal."""
    TABLE = "table"
    """`trials.csv`; the columns are in the order in which `TrialResult` declares the fields."""
    REGRESS = "regress"
    """A trial in the JSON of `sandbox regress`."""
    BASELINE = "baseline"
    """A trial in a baseline of `sandbox regress`; the fields are in the order of declaration."""
    SHARED = "shared"
    """A trial in the folder made by `sandbox study share`, and the header of its recording."""


JOURNAL, TABLE = ResultRecord.JOURNAL, ResultRecord.TABLE
REGRESS, BASELINE = ResultRecord.REGRESS, ResultRecord.BASELINE
SHARED = ResultRecord.SHARED


@dataclass(frozen=True)
class Field:
    """Description of a field of `TrialResult`.

    Attributes:
        unit: Unit of the values; `0/1` for true or false; empty for texts, counts and nested
            values.
        meaning: Definition in one line.
        values_for: Records that contain the field.
    """

    unit: str
    meaning: str
    values_for: frozenset[ResultRecord] = frozenset()


def _field(unit: str, meaning: str, *values_for: ResultRecord) -> Field:
    return Field(unit, meaning, frozenset(values_for))


class TrialResult(msgspec.Struct, frozen=True, kw_only=True):
    """The result of a trial.

    The annotation of a field has its unit and meaning; `fields()` lists these annotations. A field
    that is None is unknown, or does not apply; it is absent in JSON.
    """

    task: Annotated[str, _field("", "name of the task", JOURNAL, TABLE, REGRESS, SHARED)]
    task_version: Annotated[
        int, _field("", "version of the task's definition", JOURNAL, REGRESS, SHARED)
    ] = 1
    encoder: Annotated[
        str | None,
        _field(
            "", "encoder that turns touches into the hand's pose", JOURNAL, TABLE, REGRESS, SHARED
        ),
    ] = None
    seed: Annotated[
        int,
        _field("", "start and goal of the trial follow from it", JOURNAL, TABLE, REGRESS, SHARED),
    ]
    success: Annotated[
        bool,
        _field(
            "0/1",
            "1 if the goal was held for the task's hold time; equal to the field held",
            JOURNAL,
            TABLE,
            REGRESS,
            BASELINE,
            SHARED,
        ),
    ]
    instant: Annotated[
        bool, _field("0/1", "1 if the goal was reached at some moment", JOURNAL, REGRESS, SHARED)
    ]
    held: Annotated[
        bool,
        _field(
            "0/1",
            "1 if the goal was held for the hold time without a break",
            JOURNAL,
            REGRESS,
            SHARED,
        ),
    ]
    final: Annotated[
        bool,
        _field(
            "0/1",
            "1 if the goal was reached at the end of the trial, which is 1 s after success",
            JOURNAL,
            REGRESS,
            SHARED,
        ),
    ]
    status: Annotated[
        Status,
        _field(
            "",
            "how the trial ended: held, timeout, failed, diverged, input_ended",
            JOURNAL,
            TABLE,
            REGRESS,
            SHARED,
        ),
    ]
    progress: Annotated[
        float,
        _field(
            "0 to 1", "how near the goal was at the end", JOURNAL, TABLE, REGRESS, BASELINE, SHARED
        ),
    ]
    time_s: Annotated[
        float,
        _field(
            "s",
            "simulated time until the goal was held, or until the trial ended",
            JOURNAL,
            TABLE,
            REGRESS,
            BASELINE,
            SHARED,
        ),
    ]
    reason: Annotated[
        str, _field("", "why the goal was not reached at the end", JOURNAL, TABLE, REGRESS, SHARED)
    ]
    diverged: Annotated[
        str, _field("", "why the simulation diverged; empty if it did not", JOURNAL, SHARED)
    ] = ""
    respawned: Annotated[
        int,
        _field(
            "", "number of times an object was put back into the workspace", JOURNAL, TABLE, SHARED
        ),
    ] = 0
    unreached: Annotated[
        float | None,
        _field(
            "0 to 1",
            "share of the control periods with touches in which a fingertip of a robot hand was "
            "5 mm or more from its touch; absent for the human hand",
            SHARED,
        ),
    ] = None
    state_hash: Annotated[
        str,
        _field(
            "",
            "BLAKE2b over all states; equal only for equal input, program and machine",
            JOURNAL,
            TABLE,
            REGRESS,
            BASELINE,
            SHARED,
        ),
    ]
    settings: Annotated[
        dict[str, Any] | None, _field("", "settings of the trial: `sandbox.trial.settings`", SHARED)
    ] = None
    digests: Annotated[
        dict[str, str] | None,
        _field("", "digests of the encoder and of the labels", JOURNAL, SHARED),
    ] = None
    states: Annotated[
        int | None,
        _field(
            "",
            "version number of the simulation, STATES (sandbox.recording.versions); recordings "
            "replay only if it is equal",
            JOURNAL,
            TABLE,
            SHARED,
        ),
    ] = None
    versions: Annotated[
        dict[str, str] | None,
        _field("", "versions of the program, processor, and a fingerprint of both", SHARED),
    ] = None
    task_from: Annotated[
        dict[str, Any] | None,
        _field("", "file or package of a task that is not built in, with digests", SHARED),
    ] = None
    encoder_from: Annotated[
        dict[str, Any] | None,
        _field("", "file or package of an encoder that is not built in", SHARED),
    ] = None
    study: Annotated[
        dict[str, Any] | None, _field("", "study, participant, session and trial", SHARED)
    ] = None
    measures: Annotated[
        dict[str, Any] | None,
        _field("", "measures that exist only while the trial runs, by name", JOURNAL, SHARED),
    ] = None
    latency: Annotated[
        dict[str, Any] | None, _field("ms", "percentiles of delays, by kind", JOURNAL, SHARED)
    ] = None
    absences: Annotated[
        list[dict[str, float]] | None,
        _field(
            "s",
            "pauses while a player's page was hidden or closed: `at_s`, start in simulated time, "
            "and `lasted_s`, duration in real time until the next touch",
            SHARED,
        ),
    ] = None
    surface_scale: Annotated[
        float | None,
        _field(
            "",
            "length on the screen divided by the length on the table; absent if it is 1",
            SHARED,
        ),
    ] = None
    scored: Annotated[
        bool | None,
        _field(
            "0/1",
            "0 if the result does not count, as on the scaled table of a phone; otherwise absent",
            SHARED,
        ),
    ] = None
    learned: Annotated[
        dict[str, Any] | None,
        _field("m", "layouts of five fingers for the session's next trial, by hand name", JOURNAL),
    ] = None
    fingers: Annotated[
        list[tuple[int, int]] | None,
        _field("", "true finger of each contact: (contact, finger)", SHARED),
    ] = None
    second_fingers: Annotated[
        list[tuple[int, int]] | None,
        _field("", "true fingers of the second hand's contacts", SHARED),
    ] = None
    fingers_by: Annotated[str | None, _field("", "source of the true fingers", JOURNAL, SHARED)] = (
        None
    )
    demonstrated: Annotated[
        bool | None,
        _field(
            "0/1",
            "1 if the page got a demonstration for the time before the first touch, 0 if there was "
            "none to show; absent if no demonstration was due",
            JOURNAL,
            TABLE,
            SHARED,
        ),
    ] = None
    broken_off: Annotated[
        str | None, _field("", "why the attempt was ended early and does not count")
    ] = None
    dump: Annotated[
        str | None,
        _field("", "file with the last states before a divergence", JOURNAL, REGRESS, SHARED),
    ] = None
    dump_error: Annotated[str | None, _field("", "why that file could not be written", REGRESS)] = (
        None
    )
    schema: Annotated[int | None, _field("", "version of this JSON", SHARED)] = None
    extra: Annotated[
        dict[str, Any],
        _field("", "further keys from the caller of the trial; in JSON they are at the top level"),
    ] = {}

    @classmethod
    def of(cls, session: Session, more: Mapping[str, Any] | None = None) -> TrialResult:
        """The result of a session.

        Args:
            session: The session, usually at its end.
            more: Further fields by name, such as the fields of a recording's header.

        Raises:
            TypeError: A field without a default is missing.
        """
        score = session.scorer.score
        values = {
            "task": session.task.name,
            "task_version": session.task.version,
            "seed": session.task.seed,
            "success": score.success,
            "instant": score.instant,
            "held": score.held,
            "final": score.final,
            "status": score.status,
            "progress": round(score.progress, 6),
            "time_s": round(score.time, 6),
            "reason": str(score.reason),
            "diverged": session.diverged,
            "respawned": session.respawned,
            "state_hash": session.state_hash,
        }
        if session.unreached is not None:
            values["unreached"] = round(session.unreached, 6)
        return cls(**_split({**values, **(more or {})}))

    @classmethod
    def from_json(cls, values: Mapping[str, Any], where: str) -> TrialResult:
        """Reads a result from JSON, complete or with the fields of a journal only.

        Args:
            values: The JSON object.
            where: Its origin, for error messages.

        Raises:
            RecordingError: A field is missing or has another type.
        """
        return checked(
            _split(values),
            cls,
            RecordingError,
            what="this is not the result of a trial",
            where=where,
        )

    def as_json(self) -> dict[str, Any]:
        """JSON values of all fields that are not None."""
        values = msgspec.structs.asdict(self)
        extra = values.pop("extra")
        return {name: v for name, v in values.items() if v is not None} | extra

    def values_for(self, record: ResultRecord) -> dict[str, Any]:
        """JSON values of the fields that a record contains and that are not None."""
        values = self.as_json()
        return {name: values[name] for name in record_fields(record) if name in values}

    @property
    def fingerprint(self) -> str:
        """Fingerprint of machine and versions; empty if it is unknown."""
        return (self.versions or {}).get("fingerprint", "")

    @property
    def score(self) -> Score:
        """The score of the trial at its end."""
        return Score(
            self.instant,
            self.held,
            self.final,
            self.status,
            self.progress,
            self.reason,
            self.time_s,
        )


@cache
def fields() -> dict[str, Field]:
    """Unit, meaning and records of every field, by name, in the order of declaration."""
    hints = get_type_hints(TrialResult, include_extras=True)
    return {
        name: next(m for m in hints[name].__metadata__ if isinstance(m, Field))
        for name in TrialResult.__struct_fields__
    }


@cache
def record_fields(record: ResultRecord) -> tuple[str, ...]:
    """Names of the fields that a record contains, in the order of declaration."""
    return tuple(name for name, field in fields().items() if record in field.values_for)


def _split(values: Mapping[str, Any]) -> dict[str, Any]:
    """Arguments of `TrialResult`: keys that `TrialResult` does not declare go into `extra`."""
    names = TrialResult.__struct_fields__
    known = {name: value for name, value in values.items() if name in names}
    extra = {name: value for name, value in values.items() if name not in names}
    return {**known, "extra": {**known.get("extra", {}), **extra}}
