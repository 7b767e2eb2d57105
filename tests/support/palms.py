"""Where the palm is around the same touches, as the wrist turns.

A pinch of three fingers around a box of 4 cm, with true names, before the hand is led away from
anything. This is why pose decides the task `books`: the mean pose keeps its direction where a wrist
turns.
"""

from __future__ import annotations

from dataclasses import replace
from math import cos, radians, sin

import mujoco
import numpy as np

from benchmarks.methods import METHODS
from encoders.reconstruction.touch_reconstructor import TouchReconstructor
from models.arithmetic import Array
from models.frames import Contact, TouchFrame
from models.hand import Hand
from models.scene import CONTROL_PERIOD, Scene, SceneSpec
from models.skeleton import ADULT
from models.surface import Surface
from sandbox.trial.assembly import load_encoder, make_labeller, reconstructor_settings
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tasks.clutter.books import EDGE, Books
from tasks.simulated_user.grasp import grasp_across
from tasks.simulated_user.user_hand import Hand as PersonsHand
from tasks.task import place_surface
from tasks.user import UserConfiguration


def palm(method: str, turned: float, person: int) -> Array:
    """Middle of the palm (3,) mm, from the middle of a pinch of three fingers: along the pinch,
    thumb to fingers, to the right of it, and up.

    Args:
        method: One of `METHODS`.
        turned: degrees by which the wrist is turned from its comfortable direction.
        person: Seed of the hand.
    """
    surface = place_surface(Surface(), Books)
    options = {"labels": "device", **METHODS[method]}
    settings = trial_settings(TrialOptions(task="box-to-goal", seed=1, **options))
    model = load_encoder(settings.pipeline.encoder)
    labeller = make_labeller(settings, model)
    hand = TouchReconstructor(model, labeller, ADULT, surface, reconstructor_settings(settings))
    own = PersonsHand.draw(UserConfiguration(), person)
    axis = own.natural_axis + radians(turned)
    middle = surface.to_world(surface.size / 2)
    grasp = replace(grasp_across(axis, EDGE, EDGE, own), skew=0.0)
    places = grasp.places(middle[:2], 0.0, own)
    xy = surface.to_surface(np.column_stack([places, np.full(len(places), middle[2])])).tolist()
    for step in range(90):
        contacts = tuple(Contact(i, x, y, label=i) for i, (x, y) in enumerate(xy))
        last = hand.step(TouchFrame(step * CONTROL_PERIOD, contacts, source="a pinch"))
    scene = Scene(SceneSpec((Hand(solid_palm=True),), ()))
    data = mujoco.MjData(scene.model)
    data.qpos[scene.qpos_slice(0)] = scene.pose_to_qpos(0, last.q)
    mujoco.mj_kinematics(scene.model, data)
    body = scene.model.body(scene.spec.hands[0].palm).id
    palms = [geom for geom in scene.parts(0) if scene.model.geom_bodyid[geom] == body]
    off = data.geom_xpos[palms].mean(axis=0) - middle
    c, s = cos(axis), sin(axis)
    return 1000 * np.array([c * off[0] + s * off[1], s * off[0] - c * off[1], off[2]])
