"""`sandbox devices robot`: fits and lists robot hands, which can replace the human hand."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import mujoco
import numpy as np
from cyclopts import Parameter
from PIL import Image

from models.errors import InputError
from models.hand import Hand
from models.pose import JOINTS, POSE_SIZE
from models.robot.mapping import ROBOTS, RobotMapping, find_robot, located
from models.robot.mapping_fit import fit_mapping
from models.robot.retargeting import REACHED
from models.robot.robot_hand import RobotHand
from models.scene import Scene, SceneSpec
from models.skeleton import ADULT
from models.surface import Surface
from sandbox.cli.common.command_line import application
from sandbox.cli.common.json_out import refuse_replacing
from sandbox.session.messages import HandView, Snapshot
from sandbox.views.renderer import Renderer

SIZE = (480, 320)
"""Size of the picture of each pose, px."""
APART = 0.11
"""Distance of each hand from the middle, m."""
ABOVE = 0.10
"""Height of the palms above the table, m."""
BENT = (0.15, 0.5, 0.8)
"""Flexion in each pose, as a share of its range."""


def _camera() -> mujoco.MjvCamera:
    """Returns a camera that looks down from behind the wrists."""
    camera = mujoco.MjvCamera()
    camera.type = mujoco.mjtCamera.mjCAMERA_FREE
    camera.lookat[:] = (0.0, 0.03, ABOVE)
    camera.azimuth, camera.elevation, camera.distance = 90.0, -35.0, 0.52
    return camera


def draw_both_hands(mapping: RobotMapping, picture: Path) -> None:
    """Draws the human hand and the robot's, side by side: open, half closed and closed.

    Raises:
        GraphicsError: This machine has no OpenGL.
        InputError: The file cannot be written.
    """
    person = ADULT if mapping.side == "right" else ADULT.mirrored()
    hands = Hand("person", person), RobotHand("robot", mapping, person)
    scene = Scene(SceneSpec(hands))
    surface = Surface().centred_at((0.0, 0.0, 0.0))
    pictures = []
    with Renderer(scene, surface, SIZE, camera=_camera()) as renderer:
        for share in BENT:
            qpos, views = np.zeros(scene.model.nq), []
            for i, side in enumerate((-APART, APART)):
                q = np.zeros(POSE_SIZE)
                q[:3] = side, -0.05, ABOVE
                q[JOINTS][::3] = (person.upper + share * (person.lower - person.upper))[::3]
                qpos[scene.qpos_slice(i)] = scene.pose_to_qpos(i, q)
                tips = hands[i].tips_of()(q)
                fingers = frozenset(link.finger for link in hands[i].links)
                views.append(HandView(q, tips, fingers, "down", ()))
            shot = Snapshot(0.0, 0, qpos).with_hands(*views)
            pictures.append(np.asarray(renderer.without_texts(shot)))
    try:
        Image.fromarray(np.hstack(pictures)).save(picture)
    except (OSError, ValueError) as error:
        raise InputError(
            "the picture cannot be written",
            where=f"--picture {picture}",
            got=str(error),
            remedy="Name another file",
        ) from None


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
    """Fits a mapping from a person's hand to a robot hand, for --robot of other commands.

    The command reads an MJCF model, lays its palm over a person's, and finds the lengths of its
    fingers, its side and its coupled joints (docs/robots.md). It prints the errors of the
    fingertips over many poses, and how similar the robot hand is to the person's hand of the same
    side and of the other side.

    Args:
        model: MJCF file of the robot, or PACKAGE:PATH inside an installed package.
        tips: Names of sites or bodies in the middle of the fingertips, from thumb to little finger,
            separated by commas. With four names, the little finger is missing; with three, the ring
            finger also.
        palm: Name of the body that carries all fingers. Default: the nearest common parent of all
            fingertips.
        ends: For models without sites at the fingertips: `tips` has the names of the fingers' last
            bodies, and a fingertip is the end of its body's mesh.
        hand: Side of the hand. Default: found from the ranges of its joints.
        out: File for the mapping; an existing file is replaced. Default: beside the model.
        picture: File for a picture of both hands in three poses; needs OpenGL.
    """
    path = located(model, Path())
    inside = ":" in model
    if out is None and inside:
        raise InputError(
            "the mapping of a model in a package needs a file",
            where="--out",
            got=f"no --out, for {model}",
            expected="--out FILE.toml",
        )
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
        raise InputError(
            "the mapping cannot be written",
            where=f"--out {out}",
            got=error.strerror,
            remedy="Name another file",
        ) from None
    print(f"{out}: a {mapping.side} hand, palm {mapping.palm}")
    if mapping.palm == "world":
        print("the palm is part of the world in this model; it becomes a body of 0.3 kg")
    for part in fitted.not_followed:
        print(f"not followed: {part}")
    print(f"coupled joints: {', '.join(mapping.coupled) or 'none'}")
    middle, most = np.percentile(fitted.errors, (50, 95)) * 1e3
    print(
        f"error of the fingertips with the palm fixed: median {middle:.2f} mm, 95 % below "
        f"{most:.2f} mm"
    )
    if middle > REACHED * 1e3:
        print("Most fingertips cannot reach those of a person: check the ranges of the joints")
    other = "left" if mapping.side == "right" else "right"
    print(
        f"distance of knuckles and fingertips of bent hands from those of a person's "
        f"{mapping.side} hand: {fitted.shape * 1e3:.0f} mm; from those of the {other} hand: "
        f"{fitted.mirrored * 1e3:.0f} mm"
    )
    if np.isfinite(fitted.side):
        print(
            f"volume spanned by the fingers, difference from that of a person's {mapping.side} "
            f"hand: {fitted.side:.2f}; from that of the {other} hand: {fitted.other_side:.2f}"
        )
    if picture is not None:
        _draw(out, picture)
        print(f"picture: {picture}")
    return 0


def show() -> int:
    """Lists the robot hands that are known by name, and whether each is installed."""
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
    """Draws the person's hand and the robot's, side by side, in three poses."""
    draw_both_hands(find_robot(str(mapping)), picture)


app = application("robot", "", fit, show)
