"""Which finger each touch is, where a device sees fingers only now and then.

A fingertip that is seen beside the touch names it. The first Leap software loses fingers that bend,
though, and where PAALM then holds them they are not. Such a touch is one of the fingers that are
neither seen elsewhere nor taken by another touch, and of those the one that is held nearest.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from encoders.captures.conversion.fingers import RESTING, LabelledTrack, sample_times
from encoders.captures.conversion.report import ConversionReport, ConversionRules
from encoders.captures.conversion.touch_log import ContactTrack
from encoders.captures.together.seen_track import SeenTrack
from models.frames import FINGERS

Array = NDArray[np.float64]

BESIDE = 0.015
"""m from a touch within which a fingertip that is seen names it; half of the least distance that
neighbouring fingers keep is less, but they are seen as well, and nearer."""

_VOTES = 3
"""Moments at which a fingertip must be seen beside a touch to name it."""


def named_by_sight(
    tracks: list[ContactTrack],
    track: SeenTrack,
    offset: float,
    rules: ConversionRules,
    report: ConversionReport,
) -> list[LabelledTrack]:
    """Labels contacts; those that cannot be named are counted and left out.

    Args:
        tracks: Contacts.
        track: The hand, in the frame of the surface.
        offset: s, the hand's clock less the touches'.
        rules: `reach`, `doubt`, `gap`, `rate`.
        report: Takes the counts.
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
            # It was seen, and elsewhere.
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
    one: ContactTrack, track: SeenTrack, offset: float, rules: ConversionRules, held: bool
) -> Array:
    """(m, 5) m from a contact to fingertips; infinite where not known, or not seen."""
    times = sample_times(one, rules.rate)
    look = track.tips_at if held else track.seen_at
    tips, known = look(times + offset, rules.gap)
    xy = one.at(times, rules.gap) * [1.0, -1.0]
    above = np.maximum(tips[..., 2] - RESTING, 0.0)
    off = np.sqrt(((tips[..., :2] - xy[:, None]) ** 2).sum(axis=2) + above**2)
    return np.where(known[:, None] & ~np.isnan(off), off, np.inf)


def _least(off: Array) -> float:
    """m, the median of the nearest fingertip's; infinite for a contact beside none."""
    return float(np.median(off.min(axis=1))) if len(off) else np.inf


def _taken(tracks: list[ContactTrack], number: int, found: dict[int, LabelledTrack]) -> set[int]:
    """Fingers of contacts that are down at some time of this one's life."""
    own = tracks[number]
    return {
        other.finger
        for n, other in found.items()
        if n != number and own.start < other.track.end and other.track.start < own.end
    }
