"""An environment with LeRobot, whose libraries are older than ours and come with torch.

`HAND_SANDBOX_LEROBOT` names the Python of an environment that has it already.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
"""The repository."""

TORCH = ("torch==2.13.0", "numpy>=2,<2.4")
LEROBOT = ("lerobot==0.4.4", "torchvision==0.28.0")
"""The newest LeRobot for Python 3.11. It asks for an older torch, and for cameras, motors, learners
and services that are not used here, so it comes without what it asks for."""
NEEDED = (
    "accelerate<2",
    "av>=15,<16",
    "datasets>=4,<5",
    "deepdiff<9",
    "draccus==0.10.0",
    "einops",
    "gymnasium<2",
    "huggingface-hub<0.36",
    "imageio",
    "jsonlines",
    "packaging<26",
    "pyserial",
    "safetensors",
    "termcolor",
)
"""Those of them that are used."""

WITHOUT_OPERATORS = """
import torch
# Without CUDA, the compiled part of torchvision does not load, and importing it fails
# over two operators, which nobody calls.
if not torch.version.cuda:
    operators = torch.library.Library("torchvision", "DEF")
    for name in ("nms", "qnms"):
        operators.define(name + "(Tensor dets, Tensor scores, float iou_threshold) -> Tensor")
"""
"""First lines of a script that imports LeRobot."""


def lerobot_python(folder: Path) -> str:
    """A Python with LeRobot and this program, installed into a folder unless there is one."""
    if there := os.environ.get("HAND_SANDBOX_LEROBOT"):
        return there
    subprocess.run([sys.executable, "-m", "venv", str(folder)], check=True)
    own = str(folder / "bin" / "python")
    ours = ("-e", f"{ROOT}[robots]")
    for words in (TORCH, ("--no-deps", *LEROBOT), NEEDED, ours):
        subprocess.run([own, "-m", "pip", "install", "-q", *words], check=True)
    return own


def run_with_lerobot(
    python: str, script: str, home: Path, *words: str, path: Path | None = None
) -> str:
    """Runs a script in LeRobot's environment without a network; what it printed.

    Args:
        python: The environment's Python.
        script: Its text.
        home: Folder of LeRobot's data sets.
        words: Its arguments.
        path: A folder to import from besides.
    """
    own = {"HF_LEROBOT_HOME": str(home), "HF_HOME": str(home), "HF_HUB_OFFLINE": "1"}
    if path is not None:
        own["PYTHONPATH"] = str(path)
    done = subprocess.run(
        [python, "-c", WITHOUT_OPERATORS + script, *words],
        env=os.environ | own,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout
