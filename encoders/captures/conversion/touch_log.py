"""A device's log of touches, and the extraction of contacts without the device's glitches.

`ConversionRules` contains the rules for glitches. The paper of 2015 removed "brief glitches due to
noise". Logs of real tablets also have many touches that never end, and times that run backwards.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from encoders.captures.conversion.conversion_report import ConversionReport, ConversionRules
from models.arithmetic import Array
from models.errors import CaptureError

LEAP = 2.0
"""A frame has a wrong time if its time is more than this (s) after the times of both its
neighbours; some frames of a Leap have such times."""

_STILL = 1e-4
"""Movement (m) below which a contact rests."""


@dataclass(frozen=True)
class TouchLog:
    """F frames of a touch device, with R rows. A row is one contact in one frame; every frame
    contains all contacts that are down.

    Attributes:
        time: (F,) s on the device's clock, in the order of arrival.
        frame: (R,) int, index of each row's frame, ascending.
        ids: (R,) int, contact ids.
        xy: (R, 2) m on the surface, x right and y down.
    """

    time: Array
    frame: NDArray[np.int64]
    ids: NDArray[np.int64]
    xy: Array

    def __post_init__(self) -> None:
        rows = len(self.frame)
        if self.time.ndim != 1 or self.ids.shape != (rows,) or self.xy.shape != (rows, 2):
            raise CaptureError(
                "the log's arrays disagree",
                where="touches",
                got=(self.time.shape, self.frame.shape, self.ids.shape, self.xy.shape),
                expected="(F,), (R,), (R,), (R, 2)",
            )
        if not rows:
            raise CaptureError("the log has no touch", where="touches")
        if not (np.isfinite(self.time).all() and np.isfinite(self.xy).all()):
            raise CaptureError("times and positions must be finite", where="touches")
        if (np.diff(self.frame) < 0).any() or not (
            self.frame[0] >= 0 and self.frame[-1] < len(self.time)
        ):
            raise CaptureError(
                "some rows do not belong to any frame",
                where="touches",
                expected="ascending indices of frames",
            )


@dataclass(frozen=True)
class ContactTrack:
    """One contact from touch-down to touch-up.

    Attributes:
        id: The device's id of the contact.
        time: (n,) s, times of the samples, increasing.
        xy: (n, 2) m, positions.
        end: Time (s) of the first frame without the contact.
    """

    id: int
    time: Array
    xy: Array
    end: float

    @property
    def start(self) -> float:
        """Time (s) of the first sample."""
        return float(self.time[0])

    def at(self, times: Array, gap: float) -> Array:
        """Positions (m, 2) m at times (m,) s within the contact's life.

        Positions are interpolated linearly between two samples. In a gap longer than `gap` (s), the
        contact rests until `gap` before the next sample, since devices report only moving fingers.
        """
        after = np.clip(np.searchsorted(self.time, times, side="right"), 1, len(self.time) - 1)
        if len(self.time) == 1:
            return np.tile(self.xy[0], (len(times), 1))
        before = after - 1
        span = self.time[after] - self.time[before]
        begin = np.maximum(self.time[before], self.time[after] - gap)
        share = np.clip((times - begin) / np.minimum(span, gap), 0, 1)[:, None]
        # From the last sample on, the contact stays in place.
        share[times >= self.time[-1]] = 1.0
        return self.xy[before] + share * (self.xy[after] - self.xy[before])


def valid_contacts(
    log: TouchLog, rules: ConversionRules, report: ConversionReport
) -> list[ContactTrack]:
    """Extracts a log's contacts without glitches, in order of time; counts dropped contacts."""
    # A single time that is far ahead would make all later times seem to run backwards.
    ahead = np.append(log.time[:-1] - log.time[1:] > LEAP, False)
    ahead[1:] &= log.time[1:] - log.time[:-1] > LEAP
    time = np.where(ahead, -np.inf, log.time)
    good = ~ahead & (time >= np.maximum.accumulate(time))
    good[1:] &= time[1:] > np.maximum.accumulate(time)[:-1]
    report.drop_parts("touch frames whose time leapt ahead", int(ahead.sum()))
    back = int((~good & ~ahead).sum())
    report.drop_parts("touch frames whose time ran backwards or stood still", back)
    tracks: list[ContactTrack] = []
    period = _period(log.time[good], rules)
    for track, ended in _lives(log, good):
        for part in _without_jumps(track, period, rules, report):
            whole = part if ended or part.end < track.end else _without_rest(part, rules, report)
            if whole.end - whole.start < rules.shortest:
                report.drop_contacts(f"shorter than {1000 * rules.shortest:g} ms")
            else:
                tracks.append(whole)
    return sorted(tracks, key=lambda track: track.start)


def _period(time: Array, rules: ConversionRules) -> float:
    """Period (s) between frames of an active device.

    Frames without time stamps have their arrival times, and several frames may arrive at once. The
    period is used as the least time between two frames, so that speeds stay finite.
    """
    steps = np.diff(time)
    steps = steps[steps < rules.gap]
    return float(steps.mean()) if len(steps) else 0.0


def _lives(log: TouchLog, good: NDArray[np.bool_]) -> list[tuple[ContactTrack, bool]]:
    """Contacts, each with a boolean: True if its end was recorded. An id that is absent from a
    frame is a new contact when it returns."""
    order = np.flatnonzero(good)
    number = np.full(len(log.time), -1)
    number[order] = np.arange(len(order))
    times = log.time[order]
    frame = number[log.frame]
    out = []
    for id_ in np.unique(log.ids):
        rows = np.flatnonzero((log.ids == id_) & (frame >= 0))
        if not len(rows):
            continue
        for part in np.split(rows, np.flatnonzero(np.diff(frame[rows]) > 1) + 1):
            following = int(frame[part[-1]]) + 1
            ended = following < len(times)
            end = float(times[following] if ended else np.nextafter(times[-1], np.inf))
            track = ContactTrack(int(id_), times[frame[part]], log.xy[part], end)
            out.append((track, ended))
    return out


def _without_jumps(
    track: ContactTrack, period: float, rules: ConversionRules, report: ConversionReport
) -> list[ContactTrack]:
    """Removes samples that jump away and back, and cuts a contact where it jumps and stays."""
    time, xy = track.time, track.xy

    def leaps(a: int, b: int) -> bool:
        far = float(np.linalg.norm(xy[b] - xy[a]))
        return far > rules.fastest * max(float(time[b] - time[a]), period)

    keep = np.ones(len(time), bool)
    for i in range(1, len(time) - 1):
        out_and_back = leaps(i - 1, i) and leaps(i, i + 1)
        if keep[i - 1] and out_and_back and not leaps(i - 1, i + 1):
            keep[i] = False
    report.drop_parts(f"places that jumped faster than {rules.fastest:g} m/s", int((~keep).sum()))
    time, xy = time[keep], xy[keep]
    cuts = np.array([i for i in range(1, len(time)) if leaps(i - 1, i)], int)
    report.drop_parts("contacts cut in two at a jump", len(cuts))
    edges = [0, *cuts.tolist(), len(time)]
    return [
        ContactTrack(track.id, time[a:b], xy[a:b], float(time[b]) if b < len(time) else track.end)
        for a, b in pairwise(edges)
    ]


def _without_rest(
    track: ContactTrack, rules: ConversionRules, report: ConversionReport
) -> ContactTrack:
    """Removes a long rest at the end of a contact whose lift is missing in the log."""
    moved = np.linalg.norm(track.xy - track.xy[-1], axis=1) > _STILL
    last = int(np.flatnonzero(moved)[-1]) + 1 if moved.any() else 0
    if track.end - track.time[last] < rules.stuck:
        return track
    report.drop_parts("long rests at the ends of touches without a lift")
    return ContactTrack(
        track.id, track.time[: last + 1], track.xy[: last + 1], float(track.time[last])
    )
