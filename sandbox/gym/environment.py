"""A task as a Gymnasium environment: a session that an agent drives step by step."""

from __future__ import annotations

import inspect
from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import ArrayLike

from models.arithmetic import Array
from models.errors import InputError
from models.scene import CONTROL_PERIOD
from models.skeleton import ADULT
from models.surface import Surface
from sandbox.gym.actions import Hands, PoseHands, TouchHands
from sandbox.gym.environment_options import (
    LABELS,
    STEP,
    TRUE_LABELS,
    Curriculum,
    EnvOptions,
    check_choice,
    observed_parts,
    run_settings,
)
from sandbox.gym.observation import Moment, Observing, Pictures, check_counts, slot_labels
from sandbox.gym.rewards import Reward, goal_observation, goal_reward, goal_space
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session
from sandbox.trial.assembly import DeviceMaker, build, place_all
from sandbox.trial.driver import Trial
from sandbox.trial.result import TrialResult
from tasks.registry import find_task
from tasks.score import Status, measure
from tasks.sensing import Sensing
from tasks.task import place_surface

Observation = dict[str, Array]

SEEDS = 2**31
"""Number of seeds from which a reset without a seed draws."""


class HandSandboxEnv(gymnasium.Env[Observation, Array]):
    """A Gymnasium environment. An episode is one trial of a task; a step is a 16 ms control period.

    docs/gymnasium.md has tables of actions, observations and rewards.

    Actions for touches are (15,) float64. The slot of each finger, thumb first, has three numbers:
    whether the finger touches (0.5 or more), and two coordinates. With `action="touch"` the
    coordinates are x and y in metres on the surface (origin top left, x right, y down). With
    `delta` and `hand` they are a step of the touch. Tasks with a lift control have actions (16,);
    the last number is the lift, 0 (down) to 1. The pose of the hand is reconstructed from the
    touches, as for a person.

    With `action="pose"`, actions are (53,): the pose (48,) of the hand in the world, m and rad,
    then for each finger whether it may be solid (0.5 or more).

    Values out of bounds are clipped. In a task for two hands, the action of the second hand follows
    the action of the first hand; touches are in metres on the hand's own surface.

    Observations are float64, in the world (x right, y away from the person, z up). With two hands,
    the parts `pose`, `tips`, `solid` and `labels` have one row per hand, such as (2, 48):
        pose (48,): the simulated hand: root position (m), root rotation vector and rotation vectors
            of 14 joints (rad). For a robot hand: root position, root rotation vector and joint
            positions.
        tips (5, 3): fingertips of the simulated hand, m, thumb first.
        solid (5,): 1 if a finger can collide with objects now, thumb first.
        labels (5,): finger (0 thumb to 4 little) assigned to the touch in each slot, or -1.
        objects (n, 13): for each object, position (m), quaternion (w, x, y, z; w >= 0), velocity
            (m/s) and angular velocity (rad/s), in the order of the task's `objects`.
        goals (g, 4): position (m) and yaw (rad, -pi to pi), in the order of the task's `goals`;
            absent in tasks without goals.
        time (1,): s since the start.
    `observe` adds further parts. With `goal=True`, observations are goal dictionaries.

    The default reward is the increase of the task's progress (0 to 1) in this step, plus 1 at the
    step at which success is certain. Its sum over an episode is the gained progress plus success.

    `terminated` is True in three cases. The goal was held for the task's hold time, and one more
    second has passed. Or the task has failed and cannot succeed any more
    (`info["trial"]["status"]` is `failed`). Or the simulation diverged (the status is `diverged`,
    and the last valid observation is repeated). `truncated` is True if the task's time limit is
    over.

    `reset(seed=n)` starts the trial of seed n, the same trial as `sandbox run --seed n`. Without a
    seed, the next trial is drawn from the environment's own generator. Equal seeds and actions give
    bit-identical states on one kind of machine.

    `info` has `seed`, `state_hash` (see `Session.state_hash`), and `success` so far, also under the
    name `is_success`. At the end it also has `trial`, the result as in `sandbox run --json`.

    Args:
        task: Name of the task, or its place such as `FILE.py:Class`.
        action: One of `ACTIONS` in `sandbox.gym.environment_options`.
        labels: One of `LABELS` in the same module: a labeller, or `true`. With `true`, the touch in
            a finger's slot gets the label of this finger. None takes the labeller of the settings.
        observe: Names in `OBSERVED` of the same module, to add to the observation; or `all`.
        reward: One of `REWARDS` in the same module. None means `progress`, or with `goal` the
            reward of `compute_reward`.
        goal: True for observations with `observation`, `achieved_goal` and `desired_goal`, and the
            reward of `compute_reward`.
        step: Largest step of a touch along each axis, m, for the actions `delta` and `hand`.
        hand: `right` or `left`; in a task for two hands, the side of the first hand. For `hand`,
            `hand_size`, `turn` and `robot`, None takes the value of the settings.
        hand_size: Length of the hand relative to the trained hand.
        turn: Side of the screen where the person sits, degrees (see `models.person.Person`).
        robot: Robot hand to simulate (docs/robots.md); empty for the human hand.
        render_mode: None, or `rgb_array`, for which this machine needs OpenGL.
        size: Width and height of pictures, px.
        settings: Settings in the form of a recording's header; None starts from the defaults.
        single: Single settings of `sandbox.trial.settings.Settings`, such as `encoder="cubic"`.

    Raises:
        InputError: An option is unknown, or its value is not allowed.
    """

    metadata = {  # noqa: RUF012 as the base class has it
        "render_modes": ["rgb_array"],
        "render_fps": 1.0 / CONTROL_PERIOD,
    }

    def __init__(
        self,
        task: str = "box-to-goal",
        action: str = "touch",
        labels: str | None = None,
        observe: str | Iterable[str] = (),
        reward: str | None = None,
        goal: bool = False,
        step: float = STEP,
        hand: str | None = None,
        hand_size: float | None = None,
        turn: int | None = None,
        robot: str | None = None,
        render_mode: str | None = None,
        size: tuple[int, int] = (640, 360),
        settings: Mapping[str, Any] | None = None,
        **single: Any,
    ) -> None:
        if render_mode not in (None, "rgb_array"):
            raise InputError(
                "no such choice",
                where="render_mode",
                got=render_mode,
                expected="None, rgb_array",
                remedy="For a window, wrap rgb_array in gymnasium.wrappers.HumanRendering",
            )
        if goal and reward is not None:
            raise InputError(
                "goal dictionaries have their own reward, so `reward` cannot be chosen",
                where="reward",
                got=reward,
                remedy="Leave out reward, or goal=True",
            )
        if labels is not None:
            check_choice("labels", labels, LABELS)
        true_labels = labels == TRUE_LABELS
        chosen_reward = "progress" if reward is None else reward
        self.options = EnvOptions(
            action, true_labels, observed_parts(observe), chosen_reward, goal, step
        )
        if labels is not None and not true_labels:
            single["labels"] = labels
        if robot is not None:
            single["robot"] = robot
        person = {"side": hand, "size": hand_size, "turn": turn}
        self.settings = run_settings(task, person, settings, single, _NAMES)
        self.render_mode = render_mode
        self._kind = find_task(task)
        placed = place_surface(self.settings.surface.rectangle, self._kind)
        self._surface, self._surfaces = place_all(placed, self.settings, self._kind)
        self._pictures = Pictures(self._surface, (size[0], size[1]))
        self.session: Session | None = None
        self._hands = self._make_hands()
        first = self._build(Curriculum(), 0)
        self._observing = Observing(first, self.options.observe)
        first.close()
        self.action_space = spaces.Box(
            np.concatenate([hand.low for hand in self._hands]),
            np.concatenate([hand.high for hand in self._hands]),
            dtype=np.float64,
        )
        shown: Any = self._observing.space
        if goal:
            shown = goal_space(self._observing.space, task)
        self.observation_space = shown

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Starts a new trial.

        Args:
            seed: Seed of the trial; None draws one.
            options: Changes to this trial only: `near`, `size`, `mass`, `friction`, `start` (see
                `sandbox.gym.environment_options.Curriculum`).

        Raises:
            InputError: An option is unknown or not allowed, or the trial has another number of
                objects or goals than the trial of seed 0.
        """
        curriculum = Curriculum.of(options)
        super().reset(seed=seed)
        trial = int(self.np_random.integers(SEEDS)) if seed is None else seed
        if self.session is not None:
            self.session.close()
            self.session = None
        self._hands = self._make_hands()
        session = self._build(curriculum, trial)
        check_counts(session.task, self._observing.space)
        self.session, self._trial = session, Trial(session)
        self._take(session.snapshot())
        progress = measure(session.task, Sensing(session.scene, session.data)).progress
        self._reward = Reward(self.options.reward, self._snapshot, progress)
        self._observe(session)
        return self._copied(), self._info(session)

    def step(self, action: ArrayLike) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Runs one control period.

        Raises:
            InputError: The action has another shape, or is not finite.
            ResetNeeded: The episode is over.
        """
        session = self.session
        if session is None or session.over:
            raise gymnasium.error.ResetNeeded("no episode is running: call reset()")
        whole = self._checked(action)
        for hand, own in zip(self._hands, np.split(whole, len(self._hands)), strict=True):
            hand.act(own)
        gained = 0.0
        # After a divergence the trial has the status `diverged`, and the last valid observation
        # remains.
        if self._trial.step():
            assert self._trial.newest is not None
            self._take(self._trial.newest)
            gained = self._reward.step(self._snapshot)
            self._observe(session)
        if self.options.goal:
            gained = float(goal_reward(self._seen["achieved_goal"], self._seen["desired_goal"]))
        truncated = session.scorer.score.status is Status.TIMEOUT
        ended = session.over and not truncated
        return self._copied(), gained, ended, truncated, self._info(session)

    def compute_reward(self, achieved_goal: Array, desired_goal: Array, info: Any) -> Any:
        """The reward with `goal=True` for any goals, as hindsight methods (HER) need it.

        Args:
            achieved_goal: (..., 3 g) m, positions of the objects that have goals.
            desired_goal: (..., 3 g) m, positions of their goals.
            info: Not used.

        Returns:
            (...) float64: 0 if all objects are within 1 cm of their goals, otherwise -1.
        """
        return goal_reward(achieved_goal, desired_goal)

    def render(self) -> Any:
        """The current picture (height, width, 3) uint8; None without a render mode.

        Raises:
            GraphicsError: There is no OpenGL on this machine.
            ResetNeeded: `reset` was never called.
        """
        if self.render_mode is None:
            return None
        if self.session is None:
            raise gymnasium.error.ResetNeeded("no trial to draw yet: call reset()")
        return self._pictures.draw(self.session.scene, self._snapshot)

    def close(self) -> None:
        """Closes the renderer and the session."""
        self._pictures.close()
        if self.session is not None:
            self.session.close()
            self.session = None

    @property
    def surfaces(self) -> tuple[Surface, ...]:
        """The touch surface of each hand."""
        return self._surfaces

    def slot_labels(self) -> list[list[int | None]]:
        """The current label of the touch in each slot of each hand; None without touch or label."""
        return [slot_labels(self._snapshot, hand, i) for i, hand in enumerate(self._hands)]

    def _make_hands(self) -> tuple[Hands, ...]:
        if self.options.action == "pose":
            return tuple(PoseHands(hand.person.skeleton(ADULT)) for hand in self.settings.hands)
        lifts = self._kind.lift_range > 0
        return tuple(TouchHands(surface, lifts, self.options) for surface in self._surfaces)

    def _build(self, curriculum: Curriculum, seed: int) -> Session:
        remaining = iter(self._hands)
        return build(
            replace(curriculum.settings(self.settings), seed=seed),
            tuple(_given(hand) for hand in self._hands),
            wrap_reconstructor=lambda touched: next(remaining).reconstructor_for(touched),
            change_task=curriculum.task,
        )

    def _take(self, snapshot: Snapshot) -> None:
        self._snapshot = snapshot
        for hand, view in zip(self._hands, snapshot.hands, strict=True):
            hand.see(view)

    def _observe(self, session: Session) -> None:
        seen = self._observing.read(Moment(session, self._snapshot, self._hands))
        if self.options.goal:
            seen = goal_observation(seen, self._observing.space, session.task)
        self._seen = seen

    def _checked(self, action: ArrayLike) -> Array:
        space = self.action_space
        assert isinstance(space, spaces.Box)
        try:
            values = np.asarray(action, float)
        except (TypeError, ValueError):
            raise InputError(
                "the action is not an array of numbers", where="step", got=type(action).__name__
            ) from None
        if values.shape != space.shape:
            raise InputError(
                "the action has a wrong shape",
                where="step",
                got=f"shape {values.shape}",
                expected=f"shape {space.shape}",
            )
        wrong = np.flatnonzero(~np.isfinite(values))
        if len(wrong):
            raise InputError(
                "the action is not finite",
                where=f"step, action[{wrong[0]}]",
                got=values[wrong[0]],
                expected=f"{space.low[wrong[0]]:g} to {space.high[wrong[0]]:g}",
            )
        return np.clip(values, space.low, space.high)

    def _copied(self) -> Observation:
        return {name: values.copy() for name, values in self._seen.items()}

    def _info(self, session: Session) -> dict[str, Any]:
        success = session.scorer.score.success
        info: dict[str, Any] = {
            "seed": session.task.seed,
            "state_hash": session.state_hash,
            "success": success,
            "is_success": success,
        }
        return {**info, "trial": TrialResult.of(session).as_json()} if session.over else info


_NAMES = tuple(list(inspect.signature(HandSandboxEnv).parameters)[:-1])
"""Options of an environment that are not single settings of a run."""


def _given(hand: Hands) -> DeviceMaker:
    """A device maker that returns an existing device."""
    return lambda task, surface: hand
