"""The paper's Figure 2: the captured hand beside the hand of each method, for unseen touches.

With OpenGL, hands are drawn as in the program; without it, as bones. All hands of a row are seen
from the same place. For every number of fingers, the frame with the median error is drawn, where
the error is averaged over the methods. No frame is selected by a person.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from encoders.evaluation.measure_method import TRUE, MethodResult, Tests
from models.arithmetic import Array
from models.kinematics import Kinematics
from models.pose import ROOT_ROTATION
from models.rotations import exp
from models.skeleton import ADULT
from sandbox.figures.charts import FAINT, PAPER_COLOUR, STYLE, figure, source
from sandbox.views.display import GraphicsError

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


_KINEMATICS = Kinematics(ADULT)

SIZE = (480, 400)
"""Width and height of one hand's picture, px."""
ASIDE, ELEVATION, DISTANCE = 62.0, -32.0, 0.35
"""Place of the camera: angle from the hand's own direction (deg), elevation (deg) and distance (m).
It is on the thumb's side and above, where fingers hide each other least."""
ABOVE, BEHIND = 0.03, 0.02
"""Middle of the picture: its height over the table (m), and its distance from the middle of the
joints towards the wrist (m)."""


@dataclass(frozen=True)
class Moment:
    """A frame to draw.

    Attributes:
        frame: Index of the frame.
        xy: (5, 2) m, touches by label; NaN for lifted fingers.
        q: (48,) captured pose.
    """

    frame: int
    xy: Array
    q: Array


def typical_frames(results: Mapping[str, MethodResult], tests: Tests) -> list[int]:
    """The frame with the median error for each number of fingers from 2 to 5 that occurs.

    The error of a frame is the sum over the methods of two ratios: the wrist's error divided by its
    mean, and the joints' error divided by its mean.
    """
    total = np.zeros(len(tests.q))
    for result in results.values():
        errors = result.errors[TRUE]
        total += errors.wrist / max(errors.wrist.mean(), 1e-12)
        total += errors.angle / max(errors.angle.mean(), 1e-12)
    chosen = []
    for count in (2, 3, 4, 5):
        frames = np.flatnonzero(tests.fingers == count)
        if len(frames):
            order = frames[np.argsort(total[frames], kind="stable")]
            chosen.append(int(order[len(order) // 2]))
    return chosen


def side_by_side(
    report: dict[str, Any], results: Mapping[str, MethodResult], tests: Tests
) -> Figure:
    """Draws one row for every typical frame: the captured hand, then the hand of every method."""
    from matplotlib import rc_context

    moments = [Moment(f, tests.xy[f], tests.q[f]) for f in typical_frames(results, tests)]
    poses = [np.stack([m.q, *(r.q[TRUE][m.frame] for r in results.values())]) for m in moments]
    names = ["captured", *results]
    with rc_context({**STYLE, "axes.grid": False}):
        width = 1.75 * len(names) + 0.3
        made = figure(width, 1.52 * len(moments) + 0.9)
        grid = made.subplots(len(moments), len(names), squeeze=False)
        try:
            pictures = _rendered(moments, poses)
        except GraphicsError:
            pictures = None
        for i, moment in enumerate(moments):
            for j, name in enumerate(names):
                axis = grid[i, j]
                axis.set_xticks([])
                axis.set_yticks([])
                for spine in axis.spines.values():
                    spine.set_visible(False)
                if pictures is not None:
                    axis.imshow(pictures[i][j])
                else:
                    _bones(axis, moment, poses[i], j)
                if i == 0:
                    axis.set_title(name, fontweight="bold" if j == 0 else "normal")
                if j > 0:
                    errors = results[name].errors[TRUE]
                    axis.set_xlabel(
                        f"{errors.wrist[moment.frame]:.1f} cm, {errors.angle[moment.frame]:.0f}°",
                        fontsize=7.5,
                        color=FAINT,
                        labelpad=2,
                    )
            fingers = int((~np.isnan(moment.xy[:, 0])).sum())
            grid[i, 0].set_ylabel(f"{fingers} fingers", fontsize=8.5)
        made.suptitle(
            "Figure 2: captured hand, and reconstructions from touches of a day without training",
            fontsize=11,
            fontweight="bold",
        )
        note = (
            f"{source(report)}.\nTrue labels; frames of median error. "
            "Below each hand: wrist and mean joint error."
        )
        made.supxlabel(note, fontsize=7.5, color=FAINT)
    return made


def _rendered(moments: Sequence[Moment], poses: Sequence[Array]) -> list[list[Any]]:
    """RGB pictures of every moment's poses, drawn as in the program.

    Raises:
        GraphicsError: There is no OpenGL on this machine.
    """
    import mujoco

    from models.frames import Contact
    from models.hand import Hand
    from models.scene import Scene, SceneSpec
    from models.surface import Surface
    from sandbox.session.messages import HandView, Snapshot
    from sandbox.views.drawing import Drawing
    from sandbox.views.graphics import offscreen_context, render_context
    from sandbox.views.renderer import SAMPLES, SHADOW_SIZE, SLICES, STACKS

    surface = Surface().centred_at((0.0, 0.0, 0.0))
    scene = Scene(SceneSpec((Hand(),)))
    drawing = Drawing(scene, surface)
    look = drawing.model.vis
    look.global_.offwidth, look.global_.offheight = SIZE
    look.quality.shadowsize, look.quality.offsamples = SHADOW_SIZE, SAMPLES
    look.quality.numslices, look.quality.numstacks = SLICES, STACKS
    camera = mujoco.MjvCamera()
    camera.type = mujoco.mjtCamera.mjCAMERA_FREE
    camera.elevation, camera.distance = ELEVATION, DISTANCE
    rect = mujoco.MjrRect(0, 0, *SIZE)

    with ExitStack() as closing:
        gl = offscreen_context(*SIZE)
        closing.callback(gl.free)
        context = closing.enter_context(render_context(drawing.model, gl))

        def picture(shown: Snapshot) -> Any:
            pixels = np.empty((SIZE[1], SIZE[0], 3), np.uint8)
            with gl.as_current():
                drawing.update(shown, camera)
                mujoco.mjr_render(rect, drawing.view, context)
                mujoco.mjr_readPixels(pixels, None, rect, context)
            # OpenGL counts rows from the bottom.
            return pixels[::-1].copy()

        rows = []
        for moment, row in zip(moments, poses, strict=True):
            down = np.flatnonzero(~np.isnan(moment.xy[:, 0]))
            contacts = tuple(
                Contact(f, float(moment.xy[f, 0]), float(moment.xy[f, 1]), label=f)
                for f in down.tolist()
            )
            world = surface.pose_to_world(row)
            # The captured hand is in the middle of its picture, and seen from its thumb's side.
            along = exp(world[0, ROOT_ROTATION])[:, 1]
            middle = _KINEMATICS.place(world[0]).joints.mean(axis=0) - BEHIND * along
            camera.lookat[:] = [middle[0], middle[1], ABOVE]
            camera.azimuth = np.rad2deg(np.arctan2(along[1], along[0])) - ASIDE
            pictures = []
            for q in world:
                tips = _KINEMATICS.tips(q)
                hand = HandView(
                    q, tips, frozenset(down.tolist()), "down", contacts, surface=surface
                )
                qpos = np.zeros(scene.model.nq)
                qpos[scene.qpos_slice(0)] = scene.pose_to_qpos(0, q)
                pictures.append(picture(Snapshot(0.0, 0, qpos).with_hands(hand)))
            rows.append(pictures)
    return rows


def _bones(axis: Axes, moment: Moment, poses: Array, which: int) -> None:
    """Draws a hand as bones in oblique view, with its touches as rings."""
    placed = _KINEMATICS.place(poses)
    tips = placed.tips
    middle = placed.joints[0].mean(axis=0)
    for finger in range(len(tips[which])):
        chain = [k for k, bone in enumerate(ADULT.bones) if bone.finger == finger]
        points = np.vstack(
            [poses[which, :3], placed.joints[which, chain], tips[which, finger][None]]
        )
        seen = _slanted(points - middle)
        axis.plot(seen[:, 0], seen[:, 1], color="#b07a5e", linewidth=2.2, solid_capstyle="round")
    down = ~np.isnan(moment.xy[:, 0])
    places = np.column_stack([moment.xy[down, 0], -moment.xy[down, 1], np.zeros(down.sum())])
    seen = _slanted(places - middle)
    axis.plot(seen[:, 0], seen[:, 1], "o", color=PAPER_COLOUR, markersize=6, fillstyle="none")
    axis.set_aspect("equal")
    axis.set_xlim(-0.11, 0.11)
    axis.set_ylim(-0.095, 0.095)


def _slanted(points: Array) -> Array:
    """Projects points (n, 3) to (n, 2), seen from the person's side and obliquely from above."""
    return np.column_stack([points[:, 0], 0.75 * points[:, 1] + 0.66 * points[:, 2]])
