"""Which recordings a release keeps: one of every task, encoder and device that runs here."""

from __future__ import annotations

from encoders.regression.model_registry import MODELS
from sandbox.devices.registry import DEVICES
from sandbox.trial.settings import LABELS
from tasks.registry import TASKS

LEFT_OUT = {
    "mouse": "its touch frames are of the form of `tuio`, and it needs a window and a person",
    "web": "its touch frames are of the form of `tuio`, and it needs a browser and a person",
    "evdev": "its touch frames are of the form of `tuio`, and it needs a touch screen",
    "leap": "`leap-simulated` and `leap-simulated:v1` make its frames without the controller",
    "webxr": "`webxr-simulated` makes its frames without a headset",
}
"""Devices of which no recording is kept, and why."""

TUIO = "device-tuio"
"""The recording whose touches come over the network."""

WEBCAM_FILE = "seen-hand.jsonl"
"""Landmarks of a simulated hand before a camera, in the folder of releases: a device file."""


def recordings(folder: str) -> dict[str, str]:
    """Name of each recording -> words after `sandbox run` that make it.

    Args:
        folder: Folder with the files that are devices.
    """
    made = {f"task-{task}": f"{task} --seed 1" for task in TASKS}
    made |= {f"encoder-{name}": f"box-to-goal --seed 2 --encoder {name}" for name in MODELS}
    made |= {
        f"labels-{labels}": f"box-to-goal --seed 3 --encoder best --labels {labels}"
        for labels in LABELS
        if labels not in ("paper", "device")
    }
    made["labels-paper"] = "box-to-goal --seed 3 --encoder best --without history"
    made["labels-device"] = "box-to-goal --seed 3 --tell-labels"
    made |= {
        "bare": "box-to-goal --seed 2 --bare",
        "left-hand": "wrench-turn --seed 3 --hand left --turn 180 --hand-size 0.9",
        "other-servos": "stack --seed 3 --servo position --impulse safe --contact soft",
        "whole-hand": "stack --seed 1 --solid hand",
        "whole-hand-slalom": "slalom --seed 2 --solid hand --fingers 5",
        "whole-hand-books": "books --seed 2 --solid hand",
        "varied": "wrench-slide --seed 5 --fingers 5 --vary size=1.2",
        "device-leap-simulated": "box-to-goal --seed 2 --device leap-simulated",
        "device-leap-simulated-v1": "box-to-goal --seed 2 --device leap-simulated:v1",
        "device-webxr-simulated": "box-to-goal --seed 2 --device webxr-simulated",
        "device-webcam": f"box-to-goal --device {folder}/{WEBCAM_FILE}",
        TUIO: "box-to-goal --seed 1 --device tuio",
    }
    return made


def not_covered(names: list[str]) -> list[str]:
    """Tasks, encoders, labels, rules and devices of this version that no recording of these names
    is of, and that are not left out for a reason."""
    wanted = [f"task-{task}" for task in TASKS]
    wanted += [f"encoder-{name}" for name in MODELS]
    wanted += [f"labels-{labels}" for labels in LABELS]
    devices = set(DEVICES) - set(LEFT_OUT) - {"simulated"}
    wanted += [f"device-{device}" for device in sorted(devices)]
    return [name for name in wanted if name not in names]
