"""A task as an environment that can be learned from."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import ArrayLike

from models.arithmetic.arrays import Array
from models.errors import InputError
from models.frames import FINGERS
from models.scene import CONTROL_PERIOD
from models.skeleton import ADULT
from models.surface import Surface
from sandbox.gym.actions import Hands, PoseHands
from sandbox.gym.learning.curriculum import Curriculum
from sandbox.gym.learning.observing import Moment, Observing
from sandbox.gym.learning.options import STEP, LearningOptions, parts, run_settings
from sandbox.gym.learning.pictures import Pictures
from sandbox.gym.learning.rewards import Reward
from sandbox.gym.learning.touches import FingerTouches
from sandbox.gym.observation import check_counts
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session
from sandbox.trial.assembly import build, place_surface
from sandbox.trial.device_makers import DeviceMaker
from sandbox.trial.driver import Trial
from sandbox.trial.result import TrialResult
from sandbox.trial.surfaces import place_all
from tasks.checks import measure
from tasks.registry import find_task
from tasks.score import Status
from tasks.sensing import Sensing

SEEDS = 2**31
"""Number of seeds from which a reset without a seed draws."""


class LearningEnv(gymnasium.Env[dict[str, Array], Array]):
    """One trial of a task is one episode; one step is one control period of 16 ms.

    docs/gymnasium.md has tables of actions, observations and rewards.

    Args:
        task: Name of the task, or its place such as `FILE.py:Class`.
        action: One of `sandbox.gym.learning.options.ACTIONS`.
        names: One of `NAMES` there.
        observe: Names of `OBSERVED` there, or `all`.
        reward: One of `REWARDS` there.
        step: m, largest step of a touch, for actions that are steps.
        hand: `right` or `left`; empty takes that of the settings.
        robot: The robot whose hand it is (docs/robots.md); empty: our own hand.
        render_mode: None, or `rgb_array`, for which this machine needs OpenGL.
        size: px, width and height of pictures.
        settings: Settings as a recording's header has them; None starts from the defaults.
        more: Further settings of `sandbox.trial.settings.RunSettings`.

    Raises:
        InputError: A choice or setting is unknown or not allowed.
    """

    metadata = {  # noqa: RUF012 as the base class has it
        "render_modes": ["rgb_array"],
        "render_fps": 1.0 / CONTROL_PERIOD,
    }

    def __init__(
        self,
        task: str = "box-to-goal",
        action: str = "touch",
        names: str = "told",
        observe: str | Sequence[str] = (),
        reward: str = "reach",
        step: float = STEP,
        hand: str = "",
        robot: str = "",
        render_mode: str | None = None,
        size: tuple[int, int] = (640, 360),
        settings: Mapping[str, Any] | None = None,
        **more: Any,
    ) -> None:
        if render_mode not in (None, "rgb_array"):
            raise InputError(
                "no such choice",
                where="render_mode",
                got=render_mode,
                expected="None, rgb_array",
                remedy="For a window, wrap rgb_array in gymnasium.wrappers.HumanRendering",
            )
        self.options = LearningOptions(action, names, parts(observe), reward, step)
        self.settings = run_settings(task, hand, robot, settings, more)
        self.render_mode = render_mode
        self._kind = find_task(task)
        placed = place_surface(self.settings.surface, self._kind)
        self._surface, self._surfaces = place_all(placed, self.settings, self._kind)
        self._pictures = Pictures(self._surface, (size[0], size[1]))
        self.session: Session | None = None
        self._hands, self._touches = self._make_hands()
        first = self._build(Curriculum(), 0)
        self._observing = Observing(first, self.options.observe)
        first.close()
        self.action_space = spaces.Box(
            np.concatenate([hand.low for hand in self._hands]),
            np.concatenate([hand.high for hand in self._hands]),
            dtype=np.float64,
        )
        shown: Any = self._observing.space
        self.observation_space = shown

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Array], dict[str, Any]]:
        """Starts a new trial.

        Args:
            seed: Seed of the trial; None draws one.
            options: Of this trial only: `near`, `size`, `mass`, `friction`, `start` (see
                `sandbox.gym.learning.curriculum.Curriculum`).

        Raises:
            InputError: An option is unknown or not allowed, or the trial has another number of
                objects or goals than that of seed 0.
        """
        curriculum = Curriculum.of(options)
        super().reset(seed=seed)
        trial = int(self.np_random.integers(SEEDS)) if seed is None else seed
        if self.session is not None:
            self.session.close()
            self.session = None
        self._hands, self._touches = self._make_hands()
        session = self._build(curriculum, trial)
        check_counts(session.task, self._observing.space)
        self.session, self._trial = session, Trial(session)
        self._take(session.snapshot())
        progress = measure(session.task, Sensing(session.scene, session.data)).progress
        self._reward = Reward(self.options.reward, self._snapshot, progress)
        self._seen = self._observing.read(self._moment(session))
        return self._copied(), self._info(session)

    def step(self, action: ArrayLike) -> tuple[dict[str, Array], float, bool, bool, dict[str, Any]]:
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
        gained = 0.0
        # After a divergence the trial is marked, and its last sound observation stands.
        if self._trial.step():
            assert self._trial.newest is not None
            self._take(self._trial.newest)
            gained = self._reward.step(self._snapshot)
            self._seen = self._observing.read(self._moment(session))
        truncated = session.scorer.score.status is Status.TIMEOUT
        ended = session.over and not truncated
        return self._copied(), gained, ended, truncated, self._info(session)

    def render(self) -> Any:
        """The picture (height, width, 3) uint8 of now; None without a render mode.

        Raises:
            GraphicsError: There is no OpenGL on this machine.
        """
        if self.render_mode is None:
            return None
        if self.session is None:
            raise gymnasium.error.ResetNeeded("there is nothing to see yet: call reset()")
        return self._pictures.draw(self.session.scene, self._snapshot)

    def close(self) -> None:
        """Gives back what draws."""
        self._pictures.close()
        if self.session is not None:
            self.session.close()
            self.session = None

    @property
    def surfaces(self) -> tuple[Surface, ...]:
        """The touch surface of each hand."""
        return self._surfaces

    def names(self) -> list[list[int | None]]:
        """For every hand and slot the finger that its touch is taken for now; None for none."""
        known = [{c.id: c.label for c in hand.contacts} for hand in self._snapshot.hands]
        return [
            [None if id is None else names.get(id) for id in hand.touch_ids]
            for hand, names in zip(self._hands, known, strict=True)
        ]

    def _make_hands(self) -> tuple[tuple[Hands, ...], tuple[FingerTouches, ...]]:
        if self.options.action == "pose":
            people = [hand.person for hand in self.settings.hands]
            return tuple(PoseHands(person.skeleton(ADULT)) for person in people), ()
        lifts = self._kind.lift_range > 0
        touches = tuple(FingerTouches(on, lifts, self.options) for on in self._surfaces)
        return touches, touches

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
        for touches, hand in zip(self._touches, snapshot.hands, strict=False):
            touches.see(hand)

    def _moment(self, session: Session) -> Moment:
        nowhere = [np.zeros((len(FINGERS), 2))] * len(self._hands)
        places = [touches.places for touches in self._touches] or nowhere
        return Moment(session, self._snapshot, self._hands, places)

    def _checked(self, action: ArrayLike) -> Array:
        space = self.action_space
        assert isinstance(space, spaces.Box)
        try:
            values = np.asarray(action, float)
        except (TypeError, ValueError):
            raise InputError(
                "an action is made of numbers", where="step", got=type(action).__name__
            ) from None
        if values.shape != space.shape:
            raise InputError(
                "an action has another shape",
                where="step",
                got=f"shape {values.shape}",
                expected=f"shape {space.shape}",
            )
        wrong = np.flatnonzero(~np.isfinite(values))
        if len(wrong):
            raise InputError(
                "an action is not finite",
                where=f"step, number {wrong[0]} of the action",
                got=values[wrong[0]],
                expected=f"{space.low[wrong[0]]:g} to {space.high[wrong[0]]:g}",
            )
        return np.clip(values, space.low, space.high)

    def _copied(self) -> dict[str, Array]:
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


def _given(hand: Hands) -> DeviceMaker:
    """Opens a device that there is already."""
    return lambda task, surface: hand
