"""LeRobot itself reads what `sandbox export --to lerobot` writes.

It comes with torch, in an environment made for it, so this is no quick check: it runs with
`.ci/run --full`.
"""

from __future__ import annotations

import json
from pathlib import Path

import gymnasium
import numpy as np
import pytest

from sandbox import run_trial
from sandbox.cli.main import main
from sandbox.datasets.data_set import first_difference
from sandbox.datasets.lerobot_folder import read_lerobot
from sandbox.gym import register_task
from tests.system.lerobot.environment import run_with_lerobot

pytestmark = [pytest.mark.full, pytest.mark.needs("datasets")]

NAME = "me/box-to-goal"
SEEDS = (6004, 6005)

READER = """
import json, sys
import numpy as np
from lerobot.datasets.compute_stats import get_feature_stats
from lerobot.datasets.lerobot_dataset import LeRobotDataset
from lerobot.datasets.utils import dataset_to_policy_features
from torch.utils.data import DataLoader

data = LeRobotDataset(sys.argv[1], delta_timestamps={"action": [0.0, 0.016, 0.032]})
batch = next(iter(DataLoader(data, batch_size=8, shuffle=True)))
table = data.hf_dataset.with_format("numpy")
own = get_feature_stats(np.asarray(table["action"][:]), axis=0, keepdims=False)
print(json.dumps({
    "episodes": data.num_episodes,
    "rate": data.fps,
    "chunk": list(batch["action"].shape),
    "task": data[0]["task"],
    "types": {name: f.type.value for name, f in dataset_to_policy_features(data.features).items()},
    "seeds": list(data.meta.episodes["seed"]),
    "ends": list(data.meta.episodes["dataset_to_index"]),
    "first": list(data.meta.episodes["first_state_hash"]),
    "actions": data.hf_dataset.data["exact_action"].to_pylist(),
    "hashes": data.hf_dataset.data["next.state_hash"].to_pylist(),
    "means": [own["mean"].tolist(), data.meta.stats["action"]["mean"].tolist()],
    "deviations": [own["std"].tolist(), data.meta.stats["action"]["std"].tolist()],
}))
"""


def test_lerobot_opens_it_and_its_actions_give_the_same_hashes(
    lerobot: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HF_LEROBOT_HOME", str(tmp_path))
    files = [str(tmp_path / f"{seed}.jsonl") for seed in SEEDS]
    for seed, file in zip(SEEDS, files, strict=True):
        run_trial("box-to-goal", seed, record=file, trajectories=False)
    assert main(["export", *files, "--to", "lerobot", "--name", NAME]) == 0
    seen = json.loads(run_with_lerobot(lerobot, READER, tmp_path, NAME).splitlines()[-1])
    assert seen["episodes"] == len(SEEDS) and seen["seeds"] == list(SEEDS)
    assert seen["rate"] == 62.5 and seen["chunk"] == [8, 3, 15]
    assert seen["task"].startswith("Bring a 5 cm box")
    assert seen["types"] == {
        "observation.state": "STATE",
        "observation.environment_state": "ENV",
        "action": "ACTION",
    }
    for theirs, ours in (seen["means"], seen["deviations"]):
        assert np.allclose(theirs, ours, atol=1e-5)
    data = read_lerobot(tmp_path / NAME)
    env = gymnasium.make(register_task(data.task), **data.options)
    begin = 0
    for seed, first, end in zip(SEEDS, seen["first"], seen["ends"], strict=True):
        actions, hashes = np.array(seen["actions"][begin:end]), seen["hashes"][begin:end]
        assert first_difference(env, seed, actions, [first, *hashes]) is None
        begin = end
    env.close()
