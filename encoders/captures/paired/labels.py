"""Labels touches by a 3-D device that sees fingers only at times.

A fingertip seen beside the touch labels it. But the first Leap software loses bent fingers, and
PAALM's guess of their place is wrong. Such a touch gets, of the fingers that are neither seen
elsewhere nor used by another touch, the one whose guessed place is nearest.
"""

from __future__ import annotations

import numpy as np

from encoders.captures.conversion.fingers import RESTING, LabelledTrack, sample_times
from encoders.captures.conversion.report import ConversionReport, ConversionRules
from encoders.captures.conversion.touch_log import ContactTrack
from encoders.captures.paired.hand_track import HandTrack
from models.arithmetic import Array
from models.frames import FINGERS

BESIDE = 0.015
"""m from a touch within which a visible fingertip labels it. It is more than half of the least
distance of neighbouring fingers, but a visible neighbour would be nearer to its own touch."""

_VOTES = 3
"""Number of moments at which a fingertip must be seen beside a touch to label it."""


def label_by_fingertips(
    tracks: list[ContactTrack],
    track: HandTrack,
    offset: float,
    rules: ConversionRules,
    report: ConversionReport,
) -> list[LabelledTrack]:
    """Labels contacts; those that cannot be labelled are counted and left out.

    Args:
        tracks: Contacts.
        track: The hand, in the frame of the surface.
        offset: s, the hand's clock minus the touches' clock.
        rules: `reach`, `doubt`, `gap`, `rate`.
        report: Receives the counts.
    """
    seen = [_distances(one, track, offset, rules, held=False) for one in tracks]
    labelled: dict[int, LabelledTrack] = {}
    for number in sorted(range(len(tracks)), key=lambda n: _least(seen[n])):
        off = seen[number]
        votes = off[(off < BESIDE).any(axis=1)]
        if len(votes) < min(_VOTES, len(off)) or not len(votes):
            continue
        share = np.bincount(votes.argmin(axis=1), minlength=len(FINGERS)) / len(votes)
        finger = int(share.argmax())
        if share[finger] < 1 - rules.doubt or finger in _taken(tracks, number, labelled):
            continue
        there = votes[:, finger][np.isfinite(votes[:, finger])]
        labelled[number] = LabelledTrack(tracks[number], finger, float(np.median(there)))
    for number, one in enumerate(tracks):
        if number in labelled:
            continue
        off = _distances(one, track, offset, rules, held=True)
        if not np.isfinite(off).any():
            report.drop_contacts("no pose at their time")
            continue
        typical = np.median(off[np.isfinite(off).any(axis=1)], axis=0)
        for finger in range(len(FINGERS)):
            shown = seen[number][:, finger]
            shown = shown[np.isfinite(shown)]
            # The finger was seen elsewhere.
            if len(shown) >= _VOTES and np.median(shown) > rules.reach:
                typical[finger] = np.inf
        typical[list(_taken(tracks, number, labelled))] = np.inf
        finger = int(typical.argmin())
        if not np.isfinite(typical[finger]) or typical[finger] > 2 * rules.reach:
            report.drop_contacts(f"no free fingertip within {2000 * rules.reach:g} mm")
            continue
        labelled[number] = LabelledTrack(one, finger, float(typical[finger]))
    return [labelled[n] for n in sorted(labelled)]


def _distances(
    one: ContactTrack, track: HandTrack, offset: float, rules: ConversionRules, held: bool
) -> Array:
    """Distances (m, 5) m from a contact to fingertips; infinite where unknown or not seen."""
    times = sample_times(one, rules.rate)
    look = track.tips_at if held else track.seen_at
    tips, known = look(times + offset, rules.gap)
    xy = one.at(times, rules.gap) * [1.0, -1.0]
    above = np.maximum(tips[..., 2] - RESTING, 0.0)
    off = np.sqrt(((tips[..., :2] - xy[:, None]) ** 2).sum(axis=2) + above**2)
    return np.where(known[:, None] & ~np.isnan(off), off, np.inf)


def _least(off: Array) -> float:
    """Median distance in m of the nearest fingertip; infinite for a contact without one."""
    return float(np.median(off.min(axis=1))) if len(off) else np.inf


def _taken(tracks: list[ContactTrack], number: int, labelled: dict[int, LabelledTrack]) -> set[int]:
    """Fingers of contacts that are down at some time of this contact's life."""
    own = tracks[number]
    return {
        other.finger
        for n, other in labelled.items()
        if n != number and own.start < other.track.end and other.track.start < own.end
    }
