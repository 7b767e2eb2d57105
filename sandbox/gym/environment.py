"""A task as a Gymnasium environment: a session that an agent drives step by step."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Literal

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import ArrayLike

from models.arithmetic.arrays import Array
from models.errors import InputError
from models.scene import CONTROL_PERIOD
from models.skeleton import ADULT
from sandbox.gym.actions import Hands, PoseHands, TouchHands
from sandbox.gym.observation import check_counts, observation_space, observe
from sandbox.session.session import Session
from sandbox.trial.assembly import build, place_surface
from sandbox.trial.device_makers import DeviceMaker
from sandbox.trial.driver import Trial
from sandbox.trial.result import TrialResult
from sandbox.trial.settings import HandSettings, RunSettings
from sandbox.trial.surfaces import place_all
from tasks.checks import measure
from tasks.registry import draw_task, find_task, hands_of
from tasks.score import Status
from tasks.sensing import Sensing

Observation = dict[str, Array]

SEEDS = 2**31
"""Number of seeds from which a reset without a seed draws."""


class HandSandboxEnv(gymnasium.Env[Observation, Array]):
    """One trial of a task is one episode; one step is one control period of 16 ms.

    Actions with `action="touch"`, (15,) float64: for each of five slots whether it touches (0.5 or
    more), x and y in metres on the surface (origin top left, x right, y down); tasks with a lift
    control have (16,), the last being the lift, 0 (down) to 1. Which finger a touch is, and where
    the hand goes, is reconstructed as for any person.
    With `action="pose"`, (53,) float64: the pose (48,) of the hand in the world, m and rad, then
    for each finger whether it may be solid (0.5 or more). Values out of bounds are clipped.
    In a task for two hands, an action is that of the right hand and then that of the left one;
    touches are in metres on a surface of each hand's own.

    Observations, float64, in the world (x right, y away from the person, z up); with two hands,
    `pose`, `tips`, `solid` and `labels` have one row for each, (2, 48) and so on:
        pose (48,): the simulated hand: root position m, root and 14 joints' rotation vectors, rad.
        tips (5, 3): its fingertips, m, thumb first.
        solid (5,): 1 if a finger can collide with objects now, thumb first.
        labels (5,): finger (0 thumb to 4 little) assigned to the touch in each slot, or -1.
        objects (n, 13): of each object position m, quaternion (w, x, y, z; w >= 0), velocity m/s
            and angular velocity rad/s, in the order of the task's `objects`.
        goals (g, 4): position m and yaw rad (-pi to pi), in the order of the task's `goals`; absent
            in tasks without goals.
        time (1,): s since the start.

    Reward: increase of the task's progress (0 to 1) in this step, plus 1 at the step at which
    success is certain, so that an episode's sum is progress plus success. With `reward="sparse"`
    only the latter.

    `terminated`: success was held for the task's hold time and looked at a second later, or what
    was done cannot be undone (`info["trial"]["status"]` is then `failed`), or the
    simulation diverged (`info["trial"]["status"]` is then `diverged`, and the last sound
    observation is repeated). `truncated`: the task's time limit is over.

    `reset(seed=n)` starts the trial of seed n, the same as `sandbox run --seed n`; without a seed
    the next trial is drawn from the environment's own generator. Equal seeds and actions give equal
    states to the bit on one kind of machine.

    `info` has `seed`, `state_hash` (see `Session.state_hash`), `success` so far, and at the end
    `trial`: what `sandbox run --json` prints of it.

    Args:
        task: Name of the task, or its place such as `FILE.py:Class`.
        action: `touch` or `pose`.
        reward: `progress` or `sparse`.
        render_mode: None, or `rgb_array`, for which this machine needs OpenGL.
        size: px, width and height of pictures.
        hand: `right` or `left`; in a task for two hands, that of the first half of an action.
        hand_size: Length of the hands relative to the trained one.
        turn: degrees, side of the screen where the person sits (see `models.person.Person`).
        settings: Further settings of `sandbox.trial.settings.RunSettings`, such as
            `encoder="cubic"`.

    Raises:
        InputError: The task, setting, kind of action or reward is unknown, or a robot is asked for,
            which `sandbox.gym.learning.environment.LearningEnv` takes.
    """

    metadata = {  # noqa: RUF012 as the base class has it
        "render_modes": ["rgb_array"],
        "render_fps": 1.0 / CONTROL_PERIOD,
    }

    def __init__(
        self,
        task: str = "box-to-goal",
        action: Literal["touch", "pose"] = "touch",
        reward: Literal["progress", "sparse"] = "progress",
        render_mode: str | None = None,
        size: tuple[int, int] = (640, 360),
        hand: str = "right",
        hand_size: float = 1.0,
        turn: int = 0,
        **settings: Any,
    ) -> None:
        for where, got, options in (
            ("action", action, ("touch", "pose")),
            ("reward", reward, ("progress", "sparse")),
            ("render_mode", render_mode, (None, "rgb_array")),
        ):
            if got not in options:
                raise InputError(
                    "no such choice", where=where, got=got, expected=", ".join(map(str, options))
                )
        first = HandSettings(hand, hand_size, turn)
        try:
            chosen = RunSettings(task=task, hands=(first,), **settings)
        except TypeError as error:
            raise InputError("not a setting of a run", where="settings", got=str(error)) from None
        if chosen.robot:
            raise InputError(
                "this environment shows a person's hand only",
                where="robot",
                got=chosen.robot,
                remedy="The id of the task that ends with Learn-v1, such as "
                "hand_sandbox/BoxToGoalLearn-v1, takes a robot",
            )
        self.action, self.reward = action, reward
        self.render_mode, self.size = render_mode, size
        self._kind = find_task(task)
        if hands_of(self._kind) > 1:
            chosen = replace(chosen, hands=(first, first.other))
        self.settings = chosen
        placed = place_surface(chosen.surface, self._kind)
        self._surface, self._surfaces = place_all(placed, chosen, self._kind)
        hands = self._make_hands()
        self.action_space = spaces.Box(
            np.concatenate([hand.low for hand in hands]),
            np.concatenate([hand.high for hand in hands]),
            dtype=np.float64,
        )
        self._space = observation_space(draw_task(self._kind, 0, self._surface), len(hands))
        shown: Any = self._space
        self.observation_space = shown
        self.session: Session | None = None
        self._renderer: Any = None

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Starts a new trial.

        Args:
            seed: Seed of the trial; None draws one.
            options: Not used.

        Raises:
            InputError: The trial has another number of objects or goals than that of seed 0.
        """
        super().reset(seed=seed)
        trial = int(self.np_random.integers(SEEDS)) if seed is None else seed
        self.close()
        self._hands = self._make_hands()
        settings = replace(self.settings, seed=trial)
        remaining_hands = iter(self._hands)
        session = build(
            settings,
            tuple(_given(hand) for hand in self._hands),
            wrap_reconstructor=lambda touched: next(remaining_hands).reconstructor_for(touched),
        )
        check_counts(session.task, self._space)
        self.session, self._trial = session, Trial(session)
        self._snapshot = session.snapshot()
        sensing = Sensing(session.scene, session.data)
        self._progress = measure(session.task, sensing).progress
        self._seen = self._observed(session)
        return self._copied(), self._info()

    def step(self, action: ArrayLike) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """One control period.

        Raises:
            InputError: The action has another shape, or is not finite.
            ResetNeeded: The episode is over.
        """
        session = self.session
        if session is None or session.over:
            raise gymnasium.error.ResetNeeded("the episode is over, or has not begun: call reset()")
        whole = self._checked(action)
        for hand, own in zip(self._hands, np.split(whole, len(self._hands)), strict=True):
            hand.act(own)
        won = session.scorer.score.success
        # After a divergence the trial is marked, and its last sound observation stands.
        if self._trial.step():
            assert self._trial.newest is not None
            self._snapshot = self._trial.newest
            self._seen = self._observed(session)
        score = session.scorer.score
        gained = float(score.success and not won)
        if self.reward == "progress":
            gained += score.progress - self._progress
            self._progress = score.progress
        truncated = score.status is Status.TIMEOUT
        return self._copied(), gained, session.over and not truncated, truncated, self._info()

    def render(self) -> Any:
        """The picture (height, width, 3) uint8 of now; None without a render mode.

        Raises:
            GraphicsError: There is no OpenGL on this machine.
        """
        if self.render_mode is None:
            return None
        if self.session is None:
            raise gymnasium.error.ResetNeeded("there is nothing to see yet: call reset()")
        if self._renderer is None:
            # Drawing loads OpenGL, which training mostly does without.
            from sandbox.views.renderer import Renderer

            self._renderer = Renderer(self.session.scene, self._surface, self.size)
        return np.asarray(self._renderer.frame(self._snapshot))

    def close(self) -> None:
        """Gives back what draws."""
        if self._renderer is not None:
            self._renderer.close()
            self._renderer = None
        if self.session is not None:
            self.session.close()
            self.session = None

    def _make_hands(self) -> tuple[Hands, ...]:
        if self.action == "pose":
            return tuple(PoseHands(hand.person.skeleton(ADULT)) for hand in self.settings.hands)
        return tuple(TouchHands(surface, self._kind) for surface in self._surfaces)

    def _checked(self, action: ArrayLike) -> Array:
        values = np.asarray(action, float)
        if values.shape != self.action_space.shape or not np.all(np.isfinite(values)):
            raise InputError(
                "not an action",
                where="step",
                got=f"shape {values.shape}",
                expected=f"{self.action_space.shape} finite numbers",
            )
        assert isinstance(self.action_space, spaces.Box)
        return np.clip(values, self.action_space.low, self.action_space.high)

    def _observed(self, session: Session) -> Observation:
        ids = [hand.touch_ids for hand in self._hands]
        return observe(session, self._snapshot, ids, self._space)

    def _copied(self) -> Observation:
        return {name: values.copy() for name, values in self._seen.items()}

    def _info(self) -> dict[str, Any]:
        session = self.session
        assert session is not None
        info: dict[str, Any] = {
            "seed": session.task.seed,
            "state_hash": session.state_hash,
            "success": session.scorer.score.success,
        }
        return {**info, "trial": TrialResult.of(session).as_json()} if session.over else info


def _given(hand: Hands) -> DeviceMaker:
    """Opens a device that there is already."""
    return lambda task, surface: hand
