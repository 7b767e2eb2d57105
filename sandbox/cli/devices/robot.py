"""`sandbox devices robot`: robots' hands in the place of ours."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from cyclopts import Parameter

from models.errors import InputError
from models.robot.mapping import ROBOTS, find_robot, located
from models.robot.mapping_fit import fit_mapping
from models.robot.retargeting import REACHED
from models.robot.robot_hand import RobotHand
from sandbox.cli.common.command_line import application
from sandbox.cli.common.json_out import refuse_replacing


def fit(
    model: Annotated[str, Parameter(metavar="FILE.xml")],
    *,
    tips: str,
    palm: str = "",
    ends: bool = False,
    hand: Literal["right", "left"] | None = None,
    out: Annotated[Path | None, Parameter(metavar="FILE.toml")] = None,
    picture: Annotated[Path | None, Parameter(metavar="FILE.png")] = None,
) -> int:
    """Fits a mapping from a person's hand to a robot's, for --robot of other commands.

    Reads an MJCF model, lays its palm over a person's, and finds the lengths of its fingers, its
    side and its coupled joints (docs/robots.md). It says how far fingertips are off in many
    poses, and how alike the hands are, and how alike the person's other hand is.

    Args:
        model: MJCF file of the robot, or PACKAGE:PATH inside an installed package.
        tips: Names of sites or bodies in the middle of the fingertips, thumb to little finger, with
            commas between. A hand with four lacks the little finger, one with three the ring finger
            too.
        palm: Name of the body that carries all fingers. Default: the last above all fingertips.
        ends: The names are those of the fingers' last bodies, and a fingertip is where the mesh of
            its body ends: for models without sites at the fingertips.
        hand: Side of the hand. Default: found from the ranges of its joints.
        out: File for the mapping; an existing one is replaced. Default: beside the model.
        picture: File for a picture of both hands in three poses; needs OpenGL.
    """
    path = located(model, Path())
    inside = ":" in model
    if out is None and inside:
        raise InputError("a mapping of a package's model needs a file", where="--out")
    out = out or path.with_suffix(".toml")
    refuse_replacing(out, {"MODEL": path})
    near = path.resolve().parent == out.resolve().parent
    name = model if inside else path.name if near else str(path.resolve())
    fitted = fit_mapping(
        path, [tip.strip() for tip in tips.split(",")], palm, name, ends, hand or ""
    )
    mapping = fitted.mapping
    try:
        text = f"# Fitted by `sandbox devices robot fit {model}`.\n{mapping.as_toml()}"
        out.write_text(text, encoding="utf-8")
    except OSError as error:
        raise InputError("it cannot be written", where=str(out), got=error.strerror) from None
    print(f"{out}: a {mapping.side} hand, palm {mapping.palm}")
    if mapping.palm == "world":
        print("the palm is part of the world in this model; it is taken for a body of 0.3 kg")
    for part in fitted.not_followed:
        print(f"not followed: {part}")
    print(f"coupled joints: {', '.join(mapping.coupled) or 'none'}")
    middle, most = np.percentile(fitted.errors, (50, 95)) * 1e3
    print(f"fingertips off, the palm held: median {middle:.2f} mm, 95 % below {most:.2f} mm")
    if middle > REACHED * 1e3:
        print("Most fingertips cannot be where a person's are: look at the ranges of joints")
    print(
        f"knuckles and fingertips of bent hands, laid over each other: {fitted.shape * 1e3:.0f} mm "
        f"apart; with the other hand {fitted.mirrored * 1e3:.0f} mm"
    )
    if np.isfinite(fitted.side):
        print(
            f"volume spanned by the fingers: {fitted.side:.2f} from that of a person's "
            f"{mapping.side} hand, {fitted.other_side:.2f} from that of the other"
        )
    if picture is not None:
        _draw(out, picture)
        print(f"picture: {picture}")
    return 0


def show() -> int:
    """Lists the robots' hands that are known by name, and whether they are installed."""
    for name in ROBOTS:
        mapping = find_robot(name)
        try:
            hand = RobotHand(name, mapping)
            joints = len(hand.robot.joints)
            print(f"{name}: {joints} joints, {mapping.path}")
        except InputError as error:
            print(f"{name}: {error}")
    return 0


def _draw(mapping: Path, picture: Path) -> None:
    """A picture of the person's hand and the robot's, side by side, in three poses."""
    # Drawing loads OpenGL, which fitting does without.
    from sandbox.views.two_hands import draw_beside

    draw_beside(find_robot(str(mapping)), picture)


app = application("robot", "", fit, show)
