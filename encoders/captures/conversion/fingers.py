"""Labels each contact with the finger whose tip is nearest to it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from encoders.captures.conversion.conversion_report import ConversionReport, ConversionRules
from encoders.captures.conversion.joint_track import JointTrack
from encoders.captures.conversion.touch_log import ContactTrack
from models.arithmetic import Array
from models.frames import FINGERS

RESTING = 0.012
"""Greatest height (m) of the centre of a touching fingertip: its radius plus a margin."""


@dataclass(frozen=True)
class LabelledTrack:
    """A contact, its finger (thumb 0 to little 4), and its median distance (m) from the tip."""

    track: ContactTrack
    finger: int
    distance: float


def label_contacts(
    tracks: list[ContactTrack],
    joints: JointTrack,
    offset: float,
    rules: ConversionRules,
    report: ConversionReport,
) -> list[LabelledTrack]:
    """Labels contacts by the nearest fingertip at the same time.

    A contact is dropped and counted in three cases: no fingertip is near it; another finger is
    nearer for more than the share `doubt` of the contact's life; or its finger has a nearer contact
    at the same time.

    Args:
        tracks: Contacts.
        joints: Poses, on their own clock.
        offset: Poses' clock minus touches' clock (s).
        rules: `reach`, `doubt`, `gap`, `rate`.
        report: Receives the counts.
    """
    labelled = []
    for track in tracks:
        vote = _vote(track, joints, offset, rules)
        if vote is None:
            report.drop_contacts("no pose at their time")
        elif vote.distance > rules.reach:
            report.drop_contacts(f"no fingertip within {1000 * rules.reach:g} mm")
        elif vote.share < 1 - rules.doubt:
            report.drop_contacts(
                f"nearer to another finger for more than {100 * rules.doubt:g} % of their time"
            )
        else:
            labelled.append(LabelledTrack(track, vote.finger, vote.distance))
    return _without_overlaps(labelled, report)


def sample_times(track: ContactTrack, rate: float) -> Array:
    """Sample times (m,) s during a contact's life, beginning with its touch-down."""
    return track.start + np.arange(max(1, int((track.end - track.start) * rate))) / rate


def distances(
    track: ContactTrack,
    times: Array,
    joints: JointTrack,
    offset: float,
    rules: ConversionRules,
) -> tuple[Array, NDArray[np.bool_]]:
    """Distances (m, 5) m from a contact to every fingertip at times (m,) s.

    Also returns booleans (m,): True where the pose is known.

    The height of a fingertip above its resting height adds to its distance.
    """
    tips, known = joints.tips_at(times + offset, rules.gap)
    xy = track.at(times, rules.gap)
    off = tips[..., :2] - (xy * [1.0, -1.0])[:, None, :]
    above = np.maximum(tips[..., 2] - RESTING, 0.0)
    return np.sqrt((off**2).sum(axis=2) + above**2), known


def is_in_doubt(
    track: ContactTrack, joints: JointTrack, offset: float, rules: ConversionRules
) -> bool:
    """True if a contact is near a fingertip, but another finger is nearer for too much of its life;
    see `label_contacts`."""
    vote = _vote(track, joints, offset, rules)
    return vote is not None and vote.distance <= rules.reach and vote.share < 1 - rules.doubt


class _Vote(NamedTuple):
    """The fingertip that is nearest to a contact for most of its life.

    Attributes:
        finger: Finger of this tip.
        share: Share of the contact's life in which this tip is the nearest.
        distance: Median distance (m) between contact and tip.
    """

    finger: int
    share: float
    distance: float


def _vote(
    track: ContactTrack, joints: JointTrack, offset: float, rules: ConversionRules
) -> _Vote | None:
    """Finds the fingertip that is nearest to a contact; None if there is no pose at its time."""
    times = sample_times(track, rules.rate)
    distance, known = distances(track, times, joints, offset, rules)
    if not known.any():
        return None
    nearest = distance[known].argmin(axis=1)
    votes = np.bincount(nearest, minlength=len(FINGERS)) / len(nearest)
    finger = int(votes.argmax())
    return _Vote(finger, float(votes[finger]), float(np.median(distance[known][:, finger])))


def _without_overlaps(
    labelled: list[LabelledTrack], report: ConversionReport
) -> list[LabelledTrack]:
    """Leaves at most one contact per finger at a time. Of overlapping contacts of a finger, the
    contact nearest to the fingertip remains."""
    kept: list[LabelledTrack] = []
    for one in sorted(labelled, key=lambda contact: contact.distance):
        rival = any(
            other.finger == one.finger
            and one.track.start < other.track.end
            and other.track.start < one.track.end
            for other in kept
        )
        if rival:
            report.drop_contacts("their finger had a nearer contact")
        else:
            kept.append(one)
    return sorted(kept, key=lambda labelled: labelled.track.start)
