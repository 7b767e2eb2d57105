"""Named points on the hand in recordings: joints, fingertips, markers on the skin."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from msgspec import Meta, Struct

from models.arithmetic import Array
from models.errors import CaptureError
from models.frames import FINGERS
from models.json_input import checked
from models.skeleton import Skeleton

PALM = -1
"""Index of the palm with the wrist, which is not one of the 14 bones."""

_JOINT, _TIP, _SKIN, _BACK = 0.006, 0.008, 0.008, 0.025
"""Accuracy (m) of a point's place on the hand: joint, fingertip, skin marker, back of the hand."""

_MARKER = 0.006
"""Distance (m) from the skin to the middle of a marker."""

_BACK_OF_HAND = {
    "back_front": (0.0, 0.078, 0.016),
    "back_left": (-0.015, 0.035, 0.018),
    "back_right": (0.015, 0.035, 0.018),
}
"""Positions (m) in the hand frame of a plate of three markers on the back of a hand. Left and right
are those of a right hand, seen from its wrist."""


_Metres = Annotated[float, Meta(ge=-1e3, le=1e3)]


class _Table(Struct):
    """A place on the hand as a table of a mapping file; see `mapped`."""

    bone: str
    at: tuple[_Metres, _Metres, _Metres]
    spread: Annotated[float, Meta(gt=0, lt=1)] = _SKIN


@dataclass(frozen=True)
class Site:
    """A point that moves with one bone.

    Attributes:
        name: Name of the point.
        bone: Index of the bone, or `PALM`.
        at: (3,) m, position in the bone's frame, for a hand of the skeleton's size.
        spread: Standard deviation (m) of this position.
    """

    name: str
    bone: int
    at: Array
    spread: float


def sites_of(skeleton: Skeleton) -> dict[str, Site]:
    """All named sites.

    They are `wrist`; every joint, by the name of its bone; `thumb_ip`; `FINGER_tip` for every
    finger; a marker on the skin above each of these except the wrist, with the ending `_skin`; and
    a plate on the back of the hand.
    """
    sites = [Site("wrist", PALM, np.zeros(3), _JOINT)]
    for finger, name in enumerate(FINGERS):
        chain = [i for i, bone in enumerate(skeleton.bones) if bone.finger == finger]
        for parent, i in zip([PALM, *chain[:-1]], chain, strict=True):
            bone = skeleton.bones[i]
            sites.append(Site(bone.name, parent, np.array(bone.anchor), _JOINT))
        last = skeleton.bones[chain[-1]]
        if finger == 0:
            # The thumb's last bone contains two phalanges; their joint is a little past its middle.
            sites.append(Site("thumb_ip", chain[-1], np.array([0, 0.55 * last.length, 0]), _JOINT))
        sites.append(Site(f"{name}_tip", chain[-1], np.array([0, last.length, 0]), _TIP))
    for site in sites[1:]:
        radius = skeleton.palm_radius if site.bone == PALM else skeleton.bones[site.bone].radius
        above = site.at + np.array([0, 0, radius + _MARKER])
        sites.append(Site(f"{site.name}_skin", site.bone, above, _SKIN))
    for name, at in _BACK_OF_HAND.items():
        sites.append(Site(name, PALM, np.array(at), _BACK))
    return {site.name: site for site in sites}


def _qualisys() -> dict[str, str]:
    names = {"hand_top": "back_front", "hand_left": "back_left", "hand_right": "back_right"}
    for finger in FINGERS:
        names[f"{finger}_tip"] = f"{finger}_tip_skin"
        names[f"{finger}_middle"] = f"{finger}_pip_skin" if finger != "thumb" else "thumb_ip_skin"
    return names


def _mixamo(side: str) -> dict[str, str]:
    hand = f"{side.capitalize()}Hand"
    names = {hand: "wrist"}
    levels = {"thumb": ("cmc", "mcp", "ip")}
    for finger in FINGERS:
        stem = hand + ("Pinky" if finger == "little" else finger.capitalize())
        for i, level in enumerate(levels.get(finger, ("mcp", "pip", "dip")), start=1):
            names[f"{stem}{i}"] = f"{finger}_{level}"
        # Mixamo's own skeleton has a joint at the tip. A rig without it has the third bone's end.
        names[f"{stem}4"] = names[f"{stem}3 end"] = f"{finger}_tip"
    return names


def recognised(names: Sequence[str], side: str, skeleton: Skeleton) -> dict[str, str]:
    """Recognises common names of points.

    The known names are those of `sites_of`, of Qualisys glove recordings (such as `index_middle`
    and `hand_top`) and of Mixamo rigs (such as `RightHandIndex1`), each with or without a prefix
    that ends with a colon. In a Mixamo rig, `RightHandIndex3 end` is the end of the bone of joint
    `RightHandIndex3`, and `RightHandIndex4` is a joint at the tip.

    Returns:
        Name in the recording -> name of a site.

    Raises:
        CaptureError: No set of names gives three points on the palm and one on every finger.
    """
    own = {name: name for name in sites_of(skeleton)}
    own |= {f"{f}_dip end": f"{f}_tip" for f in FINGERS} | {"thumb_mcp end": "thumb_tip"}
    bare = {name: name.rpartition(":")[2] for name in names}
    best: dict[str, str] = {}
    for known in (_qualisys(), own, _mixamo(side)):
        known_sites = {name: known[short] for name, short in bare.items() if short in known}
        if len(known_sites) > len(best):
            best = known_sites
    if _unseen(best, skeleton):
        raise CaptureError(
            "the names of markers or joints are not recognised",
            got=", ".join(names)[:200],
            expected="three points on the palm and one on every finger",
            remedy='Give a --mapping: lines like index_tip_marker = "index_tip_skin"; '
            "`sandbox capture --help` lists the names",
        )
    return best


def mapped(mapping: Mapping[str, Any], names: Sequence[str], skeleton: Skeleton) -> dict[str, Site]:
    """Sites of a mapping file, by the names in the recording.

    Args:
        mapping: Name in the recording -> name of a site, or a table with `bone` (a joint's name or
            "palm"), `at` (three numbers, m in this bone's frame) and `spread` (m, optional).
        names: The recording's names.
        skeleton: The hand's skeleton.

    Raises:
        CaptureError: A name or site is unknown, a table is wrong, or a finger has no point.
    """
    known = sites_of(skeleton)
    out = {}
    for name, value in mapping.items():
        if name not in names:
            raise CaptureError(
                "the recording has no such point", where="mapping", got=name, expected=_few(names)
            )
        if isinstance(value, dict):
            out[name] = _site(name, value, skeleton)
        elif isinstance(value, str) and value in known:
            out[name] = known[value]
        else:
            raise CaptureError(
                "no such place on the hand",
                where=f"mapping, {name}",
                got=str(value)[:40],
                expected=", ".join(known),
            )
    if missing := _unseen({name: site.name for name, site in out.items()}, skeleton, out):
        raise CaptureError(
            "too few points on the hand",
            where="mapping",
            expected=missing,
            remedy="Add these points to [points] in the mapping file",
        )
    return out


def _site(name: str, table: dict[str, Any], skeleton: Skeleton) -> Site:
    bones = {"palm": PALM} | {bone.name: i for i, bone in enumerate(skeleton.bones)}
    expected = f"bone ({', '.join(bones)}), at = [x, y, z] in m"
    what, where = "the place on the hand is damaged", f"mapping, {name}"
    place = checked(table, _Table, CaptureError, what=what, where=where, expected=expected)
    if place.bone not in bones:
        raise CaptureError(
            "no such bone", where=where, got=place.bone[:40], expected=", ".join(bones)
        )
    return Site(name, bones[place.bone], np.array(place.at), place.spread)


def _unseen(
    names: Mapping[str, str], skeleton: Skeleton, sites: Mapping[str, Site] | None = None
) -> str:
    """Text that lists the points missing for a whole hand; empty if none is missing."""
    known = sites_of(skeleton)
    chosen = list(sites.values()) if sites is not None else [known[n] for n in names.values()]
    lacking = [
        f"a point on the {finger}"
        for label, finger in enumerate(FINGERS)
        if not any(s.bone != PALM and skeleton.bones[s.bone].finger == label for s in chosen)
    ]
    if sum(site.bone == PALM for site in chosen) < 3:
        lacking.append("three points on the palm")
    return ", ".join(lacking)


def _few(names: Sequence[str]) -> str:
    return ", ".join(names)[:200]
