"""`sandbox devices robot`: robots' hands in the place of ours."""

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
"""px of each pose."""
APART = 0.11
"""m, each hand from the middle."""
ABOVE = 0.10
"""m, palms above the table."""
BENT = (0.15, 0.5, 0.8)
"""Shares of the range of flexion."""


def _camera() -> mujoco.MjvCamera:
    """From behind the wrists, and from above."""
    camera = mujoco.MjvCamera()
    camera.type = mujoco.mjtCamera.mjCAMERA_FREE
    camera.lookat[:] = (0.0, 0.03, ABOVE)
    camera.azimuth, camera.elevation, camera.distance = 90.0, -35.0, 0.52
    return camera


def draw_both_hands(mapping: RobotMapping, picture: Path) -> None:
    """Draws both hands, open, half closed and closed.

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
        raise InputError("it cannot be written", where=str(picture), got=str(error)) from None


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

    draw_both_hands(find_robot(str(mapping)), picture)


app = application("robot", "", fit, show)
