"""Converts touches and the pictures of a camera over the surface to a capture.

1. Lifts of the hand, which make the palm larger in the picture, give a rough offset of the clocks.
2. The surface is located in the picture from its corners, or from the touches themselves.
3. Every contact gets the finger whose pad is nearest, or no label if two pads are about equally
   near.
4. The clocks' offset is refined so that touches move like their fingers. Steps 2 and 3 are then
   repeated.
5. Poses are fitted to the landmarks (`encoders.air`). The hand has the size at which touching
   fingertips lie on the surface. Each pose is then corrected so that fingertips are at their
   touches.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from encoders.air.camera import Camera
from encoders.air.landmark_fit import LandmarkFit
from encoders.capture import Capture
from encoders.captures.conversion.assemble import assemble, whole_frames
from encoders.captures.conversion.conversion_report import ConversionReport, ConversionRules
from encoders.captures.conversion.fingers import LabelledTrack, sample_times
from encoders.captures.conversion.synchronise import ClockOffset, refined_by_motion
from encoders.captures.conversion.touch_log import TouchLog, valid_contacts
from encoders.captures.overhead.naming import NamedContact, NamingRules, moments_of, name_contacts
from encoders.captures.overhead.picture_track import (
    LAST_JOINTS,
    TIPS,
    PictureTrack,
    offset_by_lifts,
    picture_track,
)
from encoders.captures.overhead.tablet_plane import (
    CameraPlace,
    TabletPlane,
    field_of_view,
    place_of_camera,
    plane_of_touches,
)
from encoders.captures.paired.capture_from_hands import ONE_CLOCK, corrected
from encoders.captures.paired.hand_track import HandTrack
from encoders.correction import PAD_HEIGHT
from models.arithmetic import Array
from models.errors import CaptureError
from models.frames import FINGERS, LandmarkFrame
from models.kinematics import Kinematics
from models.person import Person
from models.pose import ROOT_POSITION, ROOT_ROTATION
from models.rotations import exp, log
from models.skeleton import ADULT, Skeleton

POSE_ERROR = (0.02, np.deg2rad(8.0), np.deg2rad(15.0))
"""Standard deviations of a pose fitted to landmarks: position (m), rotation and joints (rad). See
docs/webcam.md."""

_ROUNDS = 2
_SIZE_ROUNDS = 3
_SIZES = (0.7, 1.4)
_SIZE_PICTURES = 150
"""Number of pictures from which the hand's size is estimated; more pictures take longer without a
better result."""


@dataclass(frozen=True)
class NamedTouches:
    """Contacts of a recording, labelled from the camera's pictures.

    Attributes:
        contacts: All valid contacts with their fingers, in order of touch-down.
        clock: The pictures' clock minus the touches' clock.
        plane: Location of the surface in the picture.
        pictures: Landmarks of the hand in the pictures.
        seen: Share of the pictures that show the hand.
    """

    contacts: tuple[NamedContact, ...]
    clock: ClockOffset
    plane: TabletPlane
    pictures: PictureTrack
    seen: float

    @property
    def labelled(self) -> list[LabelledTrack]:
        """The contacts that have a label."""
        return [one for one in (c.labelled() for c in self.contacts) if one is not None]


def name_touches(
    log: TouchLog,
    frames: Sequence[LandmarkFrame],
    time: Array,
    side: str,
    rules: ConversionRules,
    report: ConversionReport,
    *,
    corners: TabletPlane | None = None,
    offset: float | None = None,
    naming: NamingRules | None = None,
) -> NamedTouches:
    """Labels the touches of a recording with fingers.

    Args:
        log: The touches; x of a left hand is already mirrored.
        frames: The camera's pictures.
        time: (F,) s, times of the pictures. They differ from the touches' clock only by latencies.
        side: `right` or `left`.
        rules: Rules for dropping contacts.
        report: Receives the counts of dropped contacts.
        corners: The surface located by its corners; None locates it by the touches.
        offset: Pictures' clock minus touches' clock (s), if known; None estimates it.
        naming: Rules that turn a sample into evidence; None takes the defaults.

    Raises:
        CaptureError: The recordings do not match; the error gives the reason.
    """
    naming = naming or NamingRules()
    tracks = valid_contacts(log, rules, report)
    if not tracks:
        raise CaptureError(
            "no usable touch is left",
            where="touches",
            expected=f"touches that last {1000 * rules.shortest:g} ms or more",
        )
    pictures, seen = picture_track(frames, time, side)
    clock = ClockOffset(offset or 0.0, 0.0, 0, 0)
    if offset is None:
        clock = offset_by_lifts(tracks, pictures, ONE_CLOCK)
    for turn in range(_ROUNDS + 1):
        moments = moments_of(tracks, pictures, clock.offset, rules.gap)
        plane = plane_of_touches(moments, corners)
        named = name_contacts(tracks, pictures, plane, clock.offset, rules.gap, naming)
        labelled = [one for one in (c.labelled() for c in named) if one is not None]
        if turn == _ROUNDS or offset is not None or not labelled:
            break
        flat = _flat_track(pictures, plane)
        clock = refined_by_motion(clock, labelled, flat, rules)
    if not labelled:
        raise CaptureError(
            "no touch is near a finger in the picture",
            got=_why(named),
            remedy="Check --side, --surface and that neither camera nor tablet was moved",
        )
    return NamedTouches(tuple(named), clock, plane, pictures, seen)


def capture_from_camera(
    log: TouchLog,
    frames: Sequence[LandmarkFrame],
    time: Array,
    side: str,
    rules: ConversionRules,
    report: ConversionReport,
    meta: dict[str, Any],
    *,
    camera: Camera | None = None,
    corners: TabletPlane | None = None,
    offset: float | None = None,
) -> tuple[Capture, NamedTouches]:
    """Creates the capture of a session under a camera.

    Args:
        log: The touches; x of a left hand is already mirrored.
        frames: The camera's pictures.
        time: (F,) s, times of the pictures. They differ from the touches' clock only by latencies.
        side: `right` or `left`.
        rules: Rules for dropping contacts and frames.
        report: Receives the counts of dropped contacts and frames, and estimated values.
        meta: Metadata of the capture.
        camera: The camera, of which only the field of view is used. None derives the field of view
            from the corners, or takes the default.
        corners: The surface located by its corners; None locates it by the touches.
        offset: Pictures' clock minus touches' clock (s), if known; None estimates it.

    Raises:
        CaptureError: The recordings do not match; the error gives the reason.
    """
    named = name_touches(log, frames, time, side, rules, report, corners=corners, offset=offset)
    for one in named.contacts:
        if one.finger is None:
            report.drop_contacts(one.why)
    view = None if corners is None else field_of_view(corners.matrix, named.pictures.size)
    lens = camera or (Camera() if view is None else Camera(view=view))
    place = place_of_camera(named.plane.matrix, named.pictures.size, lens)
    size = _hand_size(named, place)
    track = _posed(named, place, size, np.arange(len(named.pictures.time)))
    _note(report, named, place, size, offset is None)
    labelled, shift = named.labelled, named.clock.offset
    capture = assemble(labelled, track, shift, rules, report, meta)
    tracks = [c.track for c in named.contacts]
    capture = whole_frames(capture, tracks, labelled, report)
    return corrected(capture, track, shift, rules, "all", POSE_ERROR), named


def _flat_track(pictures: PictureTrack, plane: TabletPlane) -> HandTrack:
    """Track of the finger pads on the surface. Its poses are zero, since only the pads are used."""
    seen = _pads(pictures, plane)
    return HandTrack(pictures.time, np.zeros((len(seen), 48)), ADULT, seen)


def _pads(pictures: PictureTrack, plane: TabletPlane) -> Array:
    """Positions (J, 5, 3) m of the finger pads, as if all of them touched; y up the surface."""
    pads = plane.pads(pictures.image[:, TIPS], pictures.image[:, LAST_JOINTS])
    seen = np.full((*pads.shape[:2], 3), PAD_HEIGHT)
    seen[..., :2] = pads * [1.0, -1.0]
    return seen


def _posed(
    named: NamedTouches, place: CameraPlace, size: float, rows: NDArray[np.intp]
) -> HandTrack:
    """Poses fitted to the pictures `rows`, in the surface frame, and the pads in these pictures."""
    pictures = named.pictures
    skeleton = _skeleton(size)
    fit = LandmarkFit(skeleton)
    poses, before = [], -np.inf
    for row in rows.tolist():
        now = float(pictures.time[row])
        if now - before > 0.5:
            fit.reset()
        rays = place.camera.rays(pictures.image[row], pictures.size)
        q = fit.fit(rays, pictures.world[row], now - before).pose.copy()
        before = now
        q[ROOT_POSITION] = place.unseen(q[ROOT_POSITION])
        q[ROOT_ROTATION] = log(place.rotation.T @ exp(q[ROOT_ROTATION]))
        poses.append(q)
    return HandTrack(
        pictures.time[rows], np.array(poses), skeleton, _pads(pictures, named.plane)[rows]
    )


def _skeleton(size: float) -> Skeleton:
    return Person("right", size).skeleton(ADULT)


def _hand_size(named: NamedTouches, place: CameraPlace) -> float:
    """Hand size at which touching fingertips are as far from the camera as the surface."""
    times = np.concatenate([sample_times(one.track, 5.0) for one in named.labelled])
    pictures = named.pictures
    near = np.clip(
        np.searchsorted(pictures.time, times + named.clock.offset), 0, len(pictures.time) - 1
    )
    rows = np.unique(near)
    rows = rows[np.linspace(0, len(rows) - 1, min(_SIZE_PICTURES, len(rows))).astype(int)]
    size = 1.0
    for _ in range(_SIZE_ROUNDS):
        track = _posed(named, place, size, rows)
        tips = Kinematics(track.skeleton).tips(track.q)
        ratios = []
        for one in named.labelled:
            inside = (track.time - named.clock.offset >= one.track.start) & (
                track.time - named.clock.offset < one.track.end
            )
            for tip, pad in zip(
                tips[inside, one.finger], track.seen[inside, one.finger], strict=True
            ):
                ratios.append(_away(place, pad) / max(_away(place, tip), 1e-6))
        if not ratios:
            break
        size = float(np.clip(size * np.median(ratios), *_SIZES))
    return size


def _away(place: CameraPlace, point: Array) -> float:
    """Distance (m) of a point in the surface frame from the lens, along the camera's z axis."""
    return float(place.seen(point)[2])


def _why(named: Sequence[NamedContact]) -> str:
    counts: dict[str, int] = {}
    for one in named:
        if one.finger is None:
            counts[one.why] = counts.get(one.why, 0) + 1
    return "; ".join(f"{n} contacts: {why}" for why, n in counts.items())


def _note(
    report: ConversionReport, named: NamedTouches, place: CameraPlace, size: float, taps: bool
) -> None:
    contacts = named.contacts
    report.notes["sync"] = "tap" if taps else "clock"
    report.notes["offset_s"] = round(named.clock.offset, 4)
    if taps:
        report.notes["offset_precision_s"] = round(named.clock.precision, 4)
    report.notes["hand_seen_percent"] = round(100.0 * named.seen, 1)
    report.notes["touches_named"] = f"{len(named.labelled)} of {len(contacts)}"
    doubts = [1.0 - float(c.share.max()) for c in contacts if c.finger is not None]
    report.notes["names_doubted_percent"] = round(100.0 * float(np.mean(doubts)), 3)
    report.notes["touches_by_finger"] = {
        name: sum(c.finger == f for c in contacts) for f, name in enumerate(FINGERS)
    }
    report.notes["touch_to_pad_mm"] = round(1000 * named.plane.miss, 2)
    report.notes["camera_at_m"] = np.round(place.at, 3).tolist()
    report.notes["field_of_view_deg"] = round(place.camera.view, 1)
    report.notes["hand_size"] = round(size, 3)
