"""What every column means, written beside the tables."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence

from sandbox.study.design.design import Design
from sandbox.study.measures.measures import MEASURES
from sandbox.study.tables.scoring_table import COLUMNS as SCORES
from sandbox.study.tables.scoring_table import score_columns
from sandbox.trial.result import KeptIn, fields, kept_fields

COLUMNS = {
    "experiment": ("", "name of the study"),
    "ppid": ("", "pseudonym of the participant; its last sign checks the others"),
    "session_num": ("", "1, 2, ...: the how manyeth time that the participant came"),
    "trial_num": ("", "1, 2, ... over the session, practice included"),
    "block_num": ("", "1, 2, ...; a block ends where a factor's level changes"),
    "trial_num_in_block": ("", "1, 2, ..."),
    "start_time": ("s", "since the session began, by the wall clock"),
    "end_time": ("s", "since the session began, by the wall clock"),
    "mode": ("", "real, pilot or simulated; never mixed in one folder"),
    "participant_number": ("", "0, 1, ... in order of arrival; decides on orders"),
    "hand": ("", "which hand touches"),
    "hand_size": ("", "length of the hand against the one encoders were trained on"),
    "attempt": ("", "1, 2, ... of this trial; broken ones are in session_info/log.csv"),
    "counted": ("0/1", "1 for exactly one finished attempt of a trial: use these rows"),
    "practice": ("0/1", "1: leave it out of results"),
    "repetition": ("", "1, 2, ... of the same levels; 0 in practice"),
    "excluded": ("0/1", "1: left out by a rule or by the experimenter; never deleted"),
    "exclusion_reason": ("", "`rule NAME`, the experimenter's words, or `participant: ...`"),
    **{name: (fields()[name].unit, fields()[name].meaning) for name in kept_fields(KeptIn.TABLE)},
    **{
        m.name: (m.unit, m.means + ("" if m.source == "ours" else f" ({m.source})"))
        for m in MEASURES
    },
    "trial_recording_location_0": ("", "the recording: `sandbox replay FILE`"),
    "hand_pose_location_0": ("", "60 Hz table; with the extra `study` also as .parquet"),
    "touches_location_0": ("", "all touches, one row per contact and moment"),
    "instrument": ("", "questionnaire"),
    "item": ("", "question"),
    "answer": ("", "as it was given"),
    "language": ("", "of the texts"),
    "time": ("", "UTC"),
    "number": ("", "as participant_number"),
    "simulated": ("0/1", "1: no person, but a simulated user"),
    "consent": ("0/1", "the participant agreed; empty: not asked"),
    "trials_done": ("", "trials with an attempt that counts, practice included"),
    "sessions_done": ("", "sessions that came to their planned end"),
    "trials_planned": ("", "trials of all sessions, practice included"),
    "complete": ("0/1", "all sessions came to their planned end"),
}
"""Unit and meaning by column."""

FRAMES = {
    "time_s": ("s", "simulated time since the trial's start"),
    "step": ("", "physics steps since the trial's start"),
    "phase": ("", "where the hand is between the air and its place"),
    "solid": ("", "fingers that can touch things, as letters t i m r l"),
    "q_*": ("m, rad", "commanded pose in the world: root position, root rotation vector, then a "
            "rotation vector for each of 14 joints"),
    "touch_*": ("", "id of the contact that is this finger; empty: it does not touch"),
    "true_*": ("", "id of the contact that truly is this finger, where somebody knows: a "
               "simulated user, or a device that tells"),
    "OBJECT_*": ("m, 1", "place of an object, and its rotation as a quaternion w x y z"),
    "OBJECT_digits": ("", "digits that push it, as letters t i m r l, p for the palm; empty, with "
                      "an empty grip: not known"),
    "OBJECT_grip_N": ("N", "sum of the normal forces of the hand on it"),
    "OBJECT_by": ("", "what else pushes it: table, names of objects"),
    "OBJECT_on": ("", "which of those bear it: push up 60 percent of its weight or more"),
    "OBJECT_goal_*": ("m", "where its centre should be"),
    "OBJECT_off_rad": ("rad", "about the vertical, from its goal to it, by the nearest turn that "
                       "looks the same"),
}  # fmt: skip
TOUCHES = {
    "time_s": ("s", "simulated time since the trial's start"),
    "contact": ("", "id, from touch-down to touch-up"),
    "x, y, z": ("m", "on the surface, in the world: x right, y away from the person, z up"),
    "finger": ("", "thumb, index, middle, ring, little; empty while unnamed"),
    "state": ("", "active; lost: lives on for a moment; ignored"),
}


def codebook(design: Design, trials: Sequence[str], answers: Sequence[str]) -> bytes:
    """The codebook of a study's tables, as a table itself."""
    factors = {f"factor_{f.name}": ("", "level: " + ", ".join(x.name for x in f.levels))
               for f in design.factors}  # fmt: skip
    asked = {item.name: ("", item.ask[design.languages[0]]) for item in design.demographics}
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["table", "column", "unit", "meaning"])
    known = {**COLUMNS, **factors}
    for name in trials:
        writer.writerow(["trial_results.csv", name, *known[name]])
    for name in answers:
        writer.writerow(["questionnaires.csv", name, *known[name]])
    for name in score_columns(design):
        writer.writerow(["questionnaire_scores.csv", name, *{**known, **SCORES}[name]])
    for form in design.questionnaires:
        for item in form.items:
            ask = item.ask[design.languages[0]]
            writer.writerow(["questionnaires.csv", f"item {form.name}/{item.name}", "", ask])
    for name, (unit, meaning) in asked.items():
        writer.writerow(["participants.csv", name, unit, meaning])
    for table, columns in (("trackers/frames_*", FRAMES), ("trackers/touches_*", TOUCHES)):
        for name, (unit, meaning) in columns.items():
            writer.writerow([table, name, unit, meaning])
    return text.getvalue().encode()
