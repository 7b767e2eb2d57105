"""What a Motion-BIDS data set says about itself: descriptions of its files and columns."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from sandbox.study.codebook import COLUMNS
from sandbox.study.design import Design
from sandbox.study.folder import SIMULATED, StudyFolder
from sandbox.versions import versions

if TYPE_CHECKING:
    from sandbox.study.bids import Channel

VERSION = "1.10.0"
"""Of the specification."""
NO_CHANNELS = ("ACCEL", "ANGACCEL", "GYRO", "JNTANG", "LATENCY", "MAGN", "MISC", "VEL")


def dataset_description(study: StudyFolder) -> dict[str, Any]:
    """`dataset_description.json`."""
    title = study.design.title or study.design.name
    kind = " (simulated participants)" if study.mode == SIMULATED else ""
    return {
        "Name": title + kind,
        "BIDSVersion": VERSION,
        "DatasetType": "raw",
        "GeneratedBy": [{"Name": "Hand Sandbox", "Version": versions()["hand-sandbox"],
                         "Description": f"sandbox study export --bids; {study.mode} data"}],
    }  # fmt: skip


def readme(study: StudyFolder) -> str:
    """`README`."""
    whose = {
        SIMULATED: "Nobody took part: all of it was made by simulated participants.",
        "pilot": "These are data of a pilot.",
    }.get(study.mode, "")
    return f"""{study.design.title or study.design.name}

People touched a surface with the fingers of one hand, and a simulated hand of 48 degrees of freedom
followed. Motion files hold the commanded pose of that hand and the places of all things, 62.5 times
a second of simulated time. The world is right-handed: x to the right, y away from the person, z up.
Rotations are unit quaternions, w x y z: of the hand and of things in the world, of joints against
the bone before. events.tsv holds the trial, with its conditions, and every touch.
{whose}
"""


def motion_about(
    row: Mapping[str, Any], channels: Sequence[Channel], frames: int, rate: float, tracksys: str
) -> dict[str, Any]:
    """`_motion.json` of a trial."""
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
    }  # fmt: skip


def channel_frames() -> dict[str, Any]:
    """`_channels.json`: the frames in which channels are."""
    return {"reference_frame": {
        "Description": "frame in which position and rotation are told",
        "Levels": {
            "world": {"SpatialAxes": "RAS", "RotationOrder": "n/a", "RotationRule": "right-hand",
                      "Description": "x right, y away from the person, z up"},
            "parent": {"SpatialAxes": "n/a", "RotationOrder": "n/a", "RotationRule": "right-hand",
                       "Description": "the bone before, in the open flat hand"},
        },
    }}  # fmt: skip


def event_columns() -> dict[str, Any]:
    """Columns of `_events.tsv`, described."""
    return {
        "onset": {"Description": "since the first frame of the motion file", "Units": "s"},
        "duration": {"Description": "of the trial until it was decided, or of the touch",
                     "Units": "s"},
        "trial_type": {"Description": "what it is",
                       "Levels": {"trial": "the whole trial", "touch": "a finger on the surface"}},
        "success": {"Description": COLUMNS["success"][1], "Levels": {"0": "no", "1": "yes"}},
        "excluded": {"Description": COLUMNS["excluded"][1], "Levels": {"0": "no", "1": "yes"}},
        "contact": {"Description": "id of the touch"},
        "finger": {"Description": "which finger it was taken for, at last"},
    }  # fmt: skip


def participant_columns(design: Design, used: Sequence[str]) -> dict[str, Any]:
    """`participants.json`."""
    asked = {item.name: item.ask[design.languages[0]] for item in design.demographics}
    return {name: {"Description": asked.get(name) or COLUMNS[name][1]} for name in used}
