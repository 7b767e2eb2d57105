"""Labels the contacts of a recording from the fingertips in the camera's pictures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from encoders.captures.conversion.fingers import LabelledTrack
from encoders.captures.conversion.touch_log import ContactTrack
from encoders.captures.overhead.names import MOST, NamingRules, chosen, names_of
from encoders.captures.overhead.picture_track import LAST_JOINTS, TIPS, PictureTrack
from encoders.captures.overhead.tablet_plane import Moment, TabletPlane
from models.arithmetic import Array
from models.frames import FINGERS

LOOK = 1.0 / 30.0
"""Interval (s) between two samples of a recording."""


@dataclass(frozen=True)
class NamedContact:
    """A contact, labelled from the camera's pictures.

    Attributes:
        track: The contact.
        share: (5,) probabilities of the fingers.
        finger: Label, thumb 0 to little 4; None if the contact has no label.
        distance: Median distance (m) from the most probable finger's pad; NaN where the hand was
            not seen.
        why: Reason why the contact has no label; empty if it has a label.
    """

    track: ContactTrack
    share: Array
    finger: int | None
    distance: float
    why: str

    def labelled(self) -> LabelledTrack | None:
        """The contact with its finger; None if it has no label."""
        return (
            None if self.finger is None else LabelledTrack(self.track, self.finger, self.distance)
        )


def moments_of(
    tracks: Sequence[ContactTrack], pictures: PictureTrack, offset: float, gap: float
) -> list[Moment]:
    """Hand landmarks and touches of the same moments, at the times of the pictures.

    Args:
        tracks: Contacts.
        pictures: Landmarks of the hand in the pictures.
        offset: Pictures' clock minus touches' clock (s).
        gap: Longest time (s) between two samples of a contact that is interpolated.
    """
    moments = []
    for row, time in enumerate((pictures.time - offset).tolist()):
        down = [t for t in tracks if t.start <= time < t.end][:MOST]
        if down:
            xy = np.array([t.at(np.array([time]), gap)[0] for t in down])
            image = pictures.image[row]
            moments.append(Moment(image[list(TIPS)], image[list(LAST_JOINTS)], xy))
    return moments


def name_contacts(
    tracks: Sequence[ContactTrack],
    pictures: PictureTrack,
    plane: TabletPlane,
    offset: float,
    gap: float,
    rules: NamingRules,
) -> list[NamedContact]:
    """Labels contacts with fingers.

    Args:
        tracks: Contacts, in order of touch-down.
        pictures: Landmarks of the hand in the pictures.
        plane: Location of the surface in the picture.
        offset: Pictures' clock minus touches' clock (s).
        gap: Longest time (s) between two samples of a contact that is interpolated.
        rules: Rules that turn a sample into evidence.
    """
    looks: list[dict[int, Array]] = []
    seconds: list[float] = []
    every: list[list[Array]] = [[] for _ in tracks]
    for time in _times(tracks):
        down = [n for n, t in enumerate(tracks) if t.start <= time < t.end]
        if not down:
            continue
        pads, known = _pads(pictures, plane, np.array([time + offset]))
        off: dict[int, Array] = {}
        for n in down:
            xy = tracks[n].at(np.array([time]), gap)[0]
            row = np.linalg.norm(pads[0] - xy, axis=1) if known[0] else _UNKNOWN
            off[n] = row
            every[n].append(row)
        looks.append(off)
        seconds.append(LOOK)
    shares = names_of(looks, seconds, rules) if looks else {}
    named = []
    for n, track in enumerate(tracks):
        share = shares.get(n)
        rows = np.array(every[n]) if every[n] else _UNKNOWN[None]
        named.append(_judged(track, share, rows, rules))
    return named


_UNKNOWN = np.full(len(FINGERS), np.nan)


def _judged(
    track: ContactTrack, share: Array | None, off: Array, rules: NamingRules
) -> NamedContact:
    seen = off[np.isfinite(off).all(axis=1)]
    equal = np.full(len(FINGERS), 1.0 / len(FINGERS))
    if share is None:
        return NamedContact(track, equal, None, np.nan, "more than five touches at a time")
    if not len(seen):
        return NamedContact(track, share, None, np.nan, "the hand was not in the picture")
    finger = chosen(share, rules)
    near = float(np.median(seen[:, int(share.argmax())]))
    if near > rules.reach:
        why = f"no fingertip within {1000 * rules.reach:g} mm"
        return NamedContact(track, share, None, near, why)
    if finger is None:
        return NamedContact(track, share, None, near, "two fingers are about as near")
    return NamedContact(track, share, finger, near, "")


def _pads(
    pictures: PictureTrack, plane: TabletPlane, times: Array
) -> tuple[Array, NDArray[np.bool_]]:
    image, known = pictures.between(pictures.image, times)
    return plane.pads(image[:, TIPS], image[:, LAST_JOINTS]), known


def _times(tracks: Sequence[ContactTrack]) -> list[float]:
    """Sample times (s): a grid with the step `LOOK`, and the starts of shorter contacts."""
    if not tracks:
        return []
    begin, end = min(t.start for t in tracks), max(t.end for t in tracks)
    times = (begin + LOOK * np.arange(int((end - begin) / LOOK) + 1)).tolist()
    short = [t.start for t in tracks if t.end - t.start < LOOK]
    return sorted({*times, *short})
