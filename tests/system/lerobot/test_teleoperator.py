"""LeRobot finds our teleoperator by its name, and moves a dummy of a robot's hand with it."""

from __future__ import annotations

import json
import subprocess
import threading
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from models.arithmetic import Array
from models.pose import JOINTS, ROOT_POSITION
from sandbox import run_trial
from sandbox.stream.hand_sources import follow
from sandbox.trial.assembly import build, device_makers
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tests.system.lerobot.environment import ROOT, run_with_lerobot

pytestmark = pytest.mark.full

DRIVE = """
import json, sys, time
from dataclasses import dataclass
import draccus
from lerobot.robots import RobotConfig, make_robot_from_config
from lerobot.teleoperators import TeleoperatorConfig, make_teleoperator_from_config
from lerobot.utils.import_utils import register_third_party_plugins

register_third_party_plugins()

@dataclass
class Options:
    teleop: TeleoperatorConfig
    robot: RobotConfig

options = draccus.parse(Options, args=sys.argv[1:])
teleoperator = make_teleoperator_from_config(options.teleop)
robot = make_robot_from_config(options.robot)
done = []
with robot:
    teleoperator.connect()
    assert teleoperator.action_features == robot.action_features
    while not teleoperator.over:
        robot.send_action(teleoperator.get_action())
        done.append(robot.get_observation())
        time.sleep(0.02)
    teleoperator.disconnect()
print(json.dumps(done))
"""


@dataclass(frozen=True)
class Installed:
    """LeRobot's Python, and the folder that our package was installed into."""

    python: str
    folder: Path

    def drive(self, home: Path, *words: str) -> list[dict[str, float]]:
        """States of the dummy while the teleoperator moves it."""
        text = run_with_lerobot(self.python, DRIVE, home, *words, path=self.folder)
        states: list[dict[str, float]] = json.loads(text.splitlines()[-1])
        return states


@pytest.fixture(scope="module")
def installed(lerobot: str, tmp_path_factory: pytest.TempPathFactory) -> Installed:
    """The package, built as a wheel and installed beside LeRobot."""
    folder = tmp_path_factory.mktemp("package")
    built = [lerobot, "-m", "pip", "wheel", "-q", "--no-deps", "-w", str(folder)]
    subprocess.run([*built, str(ROOT / "examples" / "lerobot_teleoperator")], check=True)
    (wheel,) = folder.glob("lerobot_teleoperator_hand_sandbox-*.whl")
    target = folder / "installed"
    words = [lerobot, "-m", "pip", "install", "-q", "--no-deps", "--target", str(target)]
    subprocess.run([*words, str(wheel)], check=True)
    return Installed(lerobot, target)


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    file = tmp_path_factory.mktemp("recording") / "6006.jsonl"
    run_trial("box-to-goal", 6006, record=file, trajectories=False)
    return file


def commanded(recording: Path) -> Array:
    """(n, 48) poses that the recording's touches ask for."""
    chosen = trial_settings(TrialOptions(device=str(recording)))
    session = build(chosen, device_makers(chosen))
    poses: list[Array] = []
    hands = [(rig.device, rig.reconstructor) for rig in session.rigs]
    follow(hands, threading.Event(), lambda time, each: poses.append(each[0]))
    session.close()
    return np.array(poses)


def test_a_recording_moves_the_dummy_as_its_touches_ask(
    installed: Installed, recording: Path, tmp_path: Path
) -> None:
    states = installed.drive(
        tmp_path,
        "--teleop.type=hand_sandbox",
        f"--teleop.device={recording}",
        "--robot.type=hand_sandbox_dummy",
    )
    wanted = commanded(recording)
    wanted = np.concatenate([wanted[:, ROOT_POSITION], wanted[:, JOINTS]], axis=1)
    seen = np.array([list(state.values()) for state in states])
    assert seen.shape[1] == 3 + 4 + 42
    assert np.allclose(np.linalg.norm(seen[:, 3:7], axis=1), 1.0)
    seen = np.delete(seen, slice(3, 7), axis=1)
    nearest = [int(np.argmin(np.abs(wanted - row).max(axis=1))) for row in seen]
    apart = np.abs(seen - wanted[nearest]).max(axis=1)
    # The first rows may be those of the hand that waits.
    assert np.median(apart) < 1e-9 and (apart < 1e-9).mean() > 0.9
    assert len(set(nearest)) > 60 and nearest[5:] == sorted(nearest[5:])


@pytest.mark.needs("robots")
def test_a_robot_s_hand_gets_the_angles_of_its_own_joints(
    installed: Installed, recording: Path, tmp_path: Path
) -> None:
    states = installed.drive(
        tmp_path,
        "--teleop.type=hand_sandbox",
        f"--teleop.device={recording}",
        "--teleop.robot=shadow",
        "--robot.type=hand_sandbox_dummy",
        "--robot.hand=shadow",
    )
    joints = [name for name in states[-1] if name.endswith(".pos")]
    assert len(joints) == 22 and "robot0:FFJ1.pos" in joints
    angles = np.array([[state[name] for name in joints] for state in states])
    assert np.ptp(angles, axis=0).max() > 0.1
