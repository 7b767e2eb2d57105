"""Names of the contacts of a recording, by the fingertips in the picture."""

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
"""s between two looks at a recording."""


@dataclass(frozen=True)
class NamedContact:
    """A contact, and what the camera says of it.

    Attributes:
        track: The contact.
        share: (5,) probabilities of the fingers.
        finger: Its finger, thumb 0 to little 4; None in doubt.
        distance: m, median distance from that finger's pad; NaN where the hand was not seen.
        why: Why it has no name; empty with one.
    """

    track: ContactTrack
    share: Array
    finger: int | None
    distance: float
    why: str

    def labelled(self) -> LabelledTrack | None:
        """The contact with its finger, or None."""
        return (
            None if self.finger is None else LabelledTrack(self.track, self.finger, self.distance)
        )


def moments_of(
    tracks: Sequence[ContactTrack], pictures: PictureTrack, offset: float, gap: float
) -> list[Moment]:
    """Looks at hand and touches at the times of the pictures."""
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
    """Names contacts.

    Args:
        tracks: Contacts, by their beginning.
        pictures: The hand in the pictures.
        plane: The surface in the picture.
        offset: s, the pictures' clock minus the touches' clock.
        gap: s without a sample of a contact that is bridged by a straight line.
        rules: What a look tells.
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
    """Times of looks: a grid, and the beginning of contacts that are shorter than its step."""
    if not tracks:
        return []
    begin, end = min(t.start for t in tracks), max(t.end for t in tracks)
    times = (begin + LOOK * np.arange(int((end - begin) / LOOK) + 1)).tolist()
    short = [t.start for t in tracks if t.end - t.start < LOOK]
    return sorted({*times, *short})
