"""Export of a study as Motion-BIDS (Jeung et al., Scientific Data 2024; BIDS 1.9 and later).

Each counted trial except practice is one run. It has the commanded pose of the hand and the poses
of all objects at 62.5 Hz, as in the study's 60 Hz tables, and an event for the trial and for every
touch. Rotations are quaternions; those of joints are relative to the previous bone.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from models.arithmetic.arrays import Array
from models.errors import StudyError
from models.rotations import quaternion_exp
from models.scene import CONTROL_PERIOD
from models.skeleton import ADULT
from sandbox.recording.versions import versions
from sandbox.study.design.design import FILLED, Design
from sandbox.study.measures.columns import SECOND, Columns
from sandbox.study.record.folder import SIMULATED, StudyFolder
from sandbox.study.record.stored_sessions import StoredSession, all_sessions, planned_trials
from sandbox.study.share.export_folder import new_folder
from sandbox.study.tables.column import Earlier, Row, names_of
from sandbox.study.tables.exclusions import exclude_person
from sandbox.study.tables.participant_table import (
    earlier_questions,
    participant_columns,
    participant_row,
)
from sandbox.study.tables.trial_table import RESULT, SESSION, trial_rows

TRACKSYS = "handsandbox"
QUATERNION = ("quat_w", "quat_x", "quat_y", "quat_z")

Say = Callable[[str], object]


@dataclass(frozen=True)
class Channel:
    """A column of a motion file; the BIDS specification defines the attributes."""

    name: str
    component: str
    type: str
    tracked_point: str
    units: str
    reference_frame: str


def export_bids(study: StudyFolder, out: Path, say: Say) -> int:
    """Writes a data set.

    Args:
        study: The study; participants without consent are left out.
        out: The data set's folder, which must not exist.
        say: Callback for progress messages.

    Returns:
        Number of runs written.

    Raises:
        StudyError: A table is missing, there are no trials, or a file cannot be written.
    """
    people: list[Row] = []
    runs = 0
    with new_folder(out) as work:
        for person, sessions in all_sessions(study):
            states = [session.state for session in sessions]
            if any(state.consent is False for state in states):
                continue
            rows = [trial_rows(study.design, s.state, s.path) for s in sessions]
            mine = [row for some in rows for row in some]
            exclude_person(study.design, states, mine)
            written = sum(
                _session(study, session, work, some)
                for session, some in zip(sessions, rows, strict=True)
            )
            if not written:
                continue
            runs += written
            people.append(
                participant_row(
                    study.design,
                    states,
                    planned_trials(study, person, sessions),
                    mine,
                    study.design.sessions,
                )
            )
            say(f"sub-{person.ppid}: {written} runs")
        if not runs:
            raise StudyError(
                "the study has no finished trial besides practice",
                where=str(study.path),
                remedy="`sandbox study run` runs a session",
            )
        _about(study, work, people)
    return runs


def task_label(task: str) -> str:
    """Name of a task in letters and digits only: `box-to-goal` becomes `boxToGoal`."""
    words = re.findall(r"[A-Za-z0-9]+", task)
    return words[0] + "".join(word[:1].upper() + word[1:] for word in words[1:])


def _session(study: StudyFolder, session: StoredSession, work: Path, rows: Sequence[Row]) -> int:
    """Writes the runs of a session; its number is in the names only if there are several."""
    entities = [f"sub-{session.person.ppid}"]
    if study.design.sessions > 1:
        entities.append(f"ses-{session.number:02d}")
    folder = work.joinpath(*entities, "motion")
    counts: dict[str, int] = {}
    for row in rows:
        if not row["counted"] or row["practice"]:
            continue
        folder.mkdir(parents=True, exist_ok=True)
        label = task_label(str(row["task"]))
        counts[label] = counts.get(label, 0) + 1
        named = "_".join([*entities, f"task-{label}", f"tracksys-{TRACKSYS}"])
        _run(session.path, folder, f"{named}_run-{counts[label]}", row)
    return sum(counts.values())


def _run(session: Path, folder: Path, stem: str, row: Row) -> None:
    frames = _table(session / row["hand_pose_location_0"])
    channels, data = motion(frames)
    start = float(frames.numbers("time_s")[0, 0])
    touches = _table(session / row["touches_location_0"])
    events = [_trial_event(row, start), *touch_events(touches, start)]
    _tsv(folder / f"{stem}_motion.tsv", None, np.char.mod("%.6g", data).tolist())
    _tsv(
        folder / f"{stem}_channels.tsv",
        list(Channel.__dataclass_fields__),
        [list(vars(channel).values()) for channel in channels],
    )
    factors = [name for name in row if name.startswith("factor_")]
    columns = [*event_columns(), *factors]
    _tsv(folder / f"{stem}_events.tsv", columns, [[e.get(c) for c in columns] for e in events])
    _json(
        folder / f"{stem}_motion.json",
        motion_about(row, channels, len(data), 1.0 / CONTROL_PERIOD, TRACKSYS),
    )
    _json(folder / f"{stem}_channels.json", channel_frames())
    _json(
        folder / f"{stem}_events.json",
        {
            **event_columns(),
            **{f: {"Description": "level of this factor"} for f in factors},
        },
    )


def motion(frames: Columns) -> tuple[list[Channel], Array]:
    """Channels of a trial, and their values (frames, channels): positions in m, and quaternions."""
    channels: list[Channel] = []
    parts: list[Array] = []
    for hand in frames.hands:
        root = "hand2" if hand else "hand"
        channels += [Channel(f"{root}_pos_{a}", a, "POS", root, "m", "world") for a in "xyz"]
        parts.append(frames.numbers(*(f"{hand}q_position_{a}" for a in "xyz")))
        for bone in ("rotation", *(b.name for b in ADULT.bones)):
            point, frame = (root, "world") if bone == "rotation" else (hand + bone, "parent")
            channels += _orientation(point, frame)
            parts.append(quaternion_exp(frames.numbers(*(f"{hand}q_{bone}_{a}" for a in "xyz"))))
    for name in frames.objects():
        channels += [Channel(f"{name}_pos_{a}", a, "POS", name, "m", "world") for a in "xyz"]
        channels += _orientation(name, "world")
        columns = (*(f"{name}_{a}" for a in "xyz"), *(f"{name}_q{a}" for a in "wxyz"))
        parts.append(frames.numbers(*columns))
    return channels, np.hstack(parts)


def touch_events(touches: Columns, start: float) -> list[Row]:
    """One event for every contact, from first to last moment, with its last finger label."""
    times = touches.numbers("time_s")[:, 0]
    events: dict[str, Row] = {}
    contacts = touches.words("contact")
    if "hand" in touches:
        # The devices of two hands may use the same ids of contacts.
        hands = touches.words("hand")
        contacts = [c if h == "1" else SECOND + c for c, h in zip(contacts, hands, strict=True)]
    for i, (contact, finger) in enumerate(zip(contacts, touches.words("finger"), strict=True)):
        onset = events.setdefault(contact, {"onset": times[i] - start, "trial_type": "touch"})
        onset |= {
            "duration": times[i] - start - onset["onset"],
            "contact": contact,
            "finger": finger or onset.get("finger"),
        }
    return sorted(events.values(), key=lambda event: float(event["onset"]))


def _trial_event(row: Row, start: float) -> Row:
    factors = {name: value for name, value in row.items() if name.startswith("factor_")}
    flags = {"success": int(row["success"]), "excluded": int(row["excluded"])}
    return {"onset": -start, "duration": row["time_s"], "trial_type": "trial", **flags, **factors}


def _orientation(point: str, frame: str) -> list[Channel]:
    return [Channel(f"{point}_{part}", part, "ORNT", point, "n/a", frame) for part in QUATERNION]


def _table(path: Path) -> Columns:
    try:
        return Columns.read(path.read_bytes())
    except OSError:
        raise StudyError(
            "a trial's table is missing",
            where=str(path),
            remedy="The next `sandbox study run` of this person builds it again; of a simulated "
            "one, `sandbox study simulate --resume`",
        ) from None


def _about(study: StudyFolder, work: Path, people: Sequence[Row]) -> None:
    _json(work / "dataset_description.json", dataset_description(study))
    (work / "README").write_text(readme(study), encoding="utf-8")
    earlier = earlier_questions(study.design, people)
    asked = names_of(participant_columns(study.design, earlier))
    known = ("hand", "hand_size", "language", "simulated", "complete", "excluded")
    # An older design may have a question that is named like a column which the program fills.
    own = [item.name for item in study.design.demographics if item.name not in FILLED]
    used = [*(name for name in known if name in asked), *own, *earlier.questions]
    rows = [[f"sub-{p['ppid']}", *(p.get(name) for name in used)] for p in people]
    _tsv(work / "participants.tsv", ["participant_id", *used], rows)
    _json(work / "participants.json", participants_json(study.design, used, earlier))


def _tsv(path: Path, head: Sequence[str] | None, rows: Sequence[Sequence[Any]]) -> None:
    lines = ["\t".join(head)] if head else []
    lines += ["\t".join(map(_cell, row)) for row in rows]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def _cell(value: Any) -> str:
    if value is None or value == "":
        return "n/a"
    if isinstance(value, bool):
        return str(int(value))
    if isinstance(value, float):
        return f"{value:.6g}"
    return re.sub(r"\s+", " ", str(value))


def _json(path: Path, value: Any) -> None:
    path.write_text(json.dumps(value, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")


VERSION = "1.10.0"
"""Version of the BIDS specification."""
NO_CHANNELS = ("ACCEL", "ANGACCEL", "GYRO", "JNTANG", "LATENCY", "MAGN", "MISC", "VEL")


def dataset_description(study: StudyFolder) -> dict[str, Any]:
    """Content of `dataset_description.json`."""
    title = study.design.title or study.design.name
    kind = " (simulated participants)" if study.mode == SIMULATED else ""
    return {
        "Name": title + kind,
        "BIDSVersion": VERSION,
        "DatasetType": "raw",
        "GeneratedBy": [
            {
                "Name": "Hand Sandbox",
                "Version": versions()["hand-sandbox"],
                "Description": f"sandbox study export --bids; {study.mode} data",
            }
        ],
    }


def readme(study: StudyFolder) -> str:
    """Content of `README`."""
    whose = {
        SIMULATED: "No person took part: all data are from simulated participants.",
        "pilot": "These are data of a pilot study.",
    }.get(study.mode, "")
    return f"""{study.design.title or study.design.name}

People touched a surface with the fingers of one hand, and a simulated hand of 48 degrees of freedom
followed. Motion files hold the commanded pose of that hand and the poses of all objects, 62.5 times
a second of simulated time. The world is right-handed: x to the right, y away from the person, z up.
Rotations are unit quaternions, w x y z. Those of the hand and of objects are in the world frame;
those of joints are relative to the previous bone. events.tsv holds the trial, with its conditions,
and every touch.
{whose}
"""


def motion_about(
    row: Mapping[str, Any], channels: Sequence[Channel], frames: int, rate: float, tracksys: str
) -> dict[str, Any]:
    """Content of `_motion.json` of a trial."""
    kinds = [channel.type for channel in channels]
    return {
        "TaskName": str(row["task"]),
        "TaskDescription": f"trial {row['trial_num']}, block {row['block_num']}, repetition "
        f"{row['repetition']}, encoder {row['encoder']}, seed {row['seed']}",
        "SamplingFrequency": rate,
        "SamplingFrequencyEffective": rate,
        "TrackingSystemName": tracksys,
        "Manufacturer": "Hand Sandbox",
        "SoftwareVersions": versions()["hand-sandbox"],
        "RecordingDuration": round(frames / rate, 6),
        "RecordingType": "continuous",
        "MotionChannelCount": len(channels),
        "POSChannelCount": kinds.count("POS"),
        "ORNTChannelCount": kinds.count("ORNT"),
        **{f"{kind}ChannelCount": 0 for kind in NO_CHANNELS},
        "MissingValues": "n/a",
        "TrackedPointsCount": len({channel.tracked_point for channel in channels}),
        "SpatialAxes": "RAS",
    }


def channel_frames() -> dict[str, Any]:
    """Content of `_channels.json`: the reference frames of channels."""
    return {
        "reference_frame": {
            "Description": "frame of position and rotation",
            "Levels": {
                "world": {
                    "SpatialAxes": "RAS",
                    "RotationOrder": "n/a",
                    "RotationRule": "right-hand",
                    "Description": "x right, y away from the person, z up",
                },
                "parent": {
                    "SpatialAxes": "n/a",
                    "RotationOrder": "n/a",
                    "RotationRule": "right-hand",
                    "Description": "previous bone, in the open flat hand",
                },
            },
        }
    }


def event_columns() -> dict[str, Any]:
    """Content of `_events.json`: descriptions of the columns of `_events.tsv`."""
    meanings = {column.name: column.meaning for column in (*SESSION, *RESULT)}
    return {
        "onset": {"Description": "time since the first frame of the motion file", "Units": "s"},
        "duration": {
            "Description": "duration of the trial until its result, or of the touch",
            "Units": "s",
        },
        "trial_type": {
            "Description": "kind of event",
            "Levels": {"trial": "the whole trial", "touch": "a finger on the surface"},
        },
        **{
            name: {"Description": meanings[name], "Levels": {"0": "no", "1": "yes"}}
            for name in ("success", "excluded")
        },
        "contact": {"Description": "id of the contact"},
        "finger": {"Description": "last finger label of the contact"},
    }


def participants_json(design: Design, used: Sequence[str], earlier: Earlier) -> dict[str, Any]:
    """Content of `participants.json`."""
    meanings = {column.name: column.meaning for column in participant_columns(design, earlier)}
    return {name: {"Description": meanings[name]} for name in used}
