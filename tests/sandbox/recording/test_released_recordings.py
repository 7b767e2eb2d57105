"""Recordings of every release replay as promised, whatever ships now."""

from __future__ import annotations

import gzip
import json
import os
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from sandbox.recording.versions import decisive_differences
from tests.support.released import (
    OUTCOME_ALONE,
    Release,
    file_digest,
    missing,
    releases,
    verdict,
)

ROOT = Path(__file__).resolve().parents[3]
RELEASES = releases()
RECORDINGS = [(release, name) for release in RELEASES for name in release.recordings]


def of(release: Release, folder: Path, name: str, **header: object) -> Release:
    """A copy of a release with one recording, and other settings or versions in its header."""
    folder.mkdir()
    lines = gzip.decompress(release.path(name).read_bytes()).decode().splitlines()
    head = json.loads(lines[0])
    for part, values in header.items():
        head[part] |= values
    copy = replace(release, folder=folder)
    copy.path(name).write_bytes(gzip.compress("\n".join([json.dumps(head), *lines[1:]]).encode()))
    entry = release.recordings[name] | {"sha256": file_digest(copy.path(name))}
    return replace(copy, recordings={name: entry})


@pytest.mark.parametrize(
    ("release", "name"), RECORDINGS, ids=[f"{r.version}-{name}" for r, name in RECORDINGS]
)
def test_a_released_recording_replays_as_promised(release: Release, name: str) -> None:
    found = verdict(release, name)
    assert found.holds, f"{name}: {found.says}"


def test_places_are_promised_of_every_recording_but_two() -> None:
    assert all({*OUTCOME_ALONE} <= {*release.recordings} for release in RELEASES)
    assert all(len(release.recordings) >= 36 + len(OUTCOME_ALONE) for release in RELEASES)


def test_every_model_that_a_release_names_ships_or_is_kept() -> None:
    assert RELEASES
    assert missing() == {}


def test_a_changed_file_and_changed_states_break_the_promise(tmp_path: Path) -> None:
    name = "task-box-to-goal"
    weak = of(RELEASES[0], tmp_path / "weak", name, settings={"impulse": 0.02})
    assert not verdict(weak, name).holds
    weak.path(name).write_bytes(weak.path(name).read_bytes()[:-20])
    assert "not the one that was released" in verdict(weak, name).says


def test_on_another_machine_nearly_equal_states_hold_and_others_do_not(tmp_path: Path) -> None:
    name, there = "task-box-to-goal", {"fingerprint": "another machine", "libm": "musl, 0123456789"}
    near = {"timestep": 0.002, "impulse": 100.0 + 1e-9}
    for settings, holds in ((near, True), ({"impulse": 0.02}, False)):
        folder = tmp_path / str(holds)
        copy = of(RELEASES[0], folder, name, versions=there, settings=settings)
        found = verdict(copy, name)
        assert found.holds == holds, found.says


CHANGE = """
from dataclasses import replace
import numpy as np
from encoders.capture import Capture
from encoders.labels.population_belief import load_population_belief
from encoders.labels.trained_belief import load_belief
from encoders.regression.trained import builtin_folder, load_model, save_model
from encoders.store import load_capture, save_capture

data = builtin_folder()
c = load_capture(data / "capture.npz")
rows = c.trial != c.trial.max()
less = Capture(c.time[rows], c.trial[rows], c.ids[rows], c.xy[rows], c.q[rows], c.meta)
save_capture(less, data / "capture.npz", np.float32)
model = load_model(data / "population.npz")
other = replace(model, residual_covariance=1.5 * model.residual_covariance, meta={"again": True})
save_model(other, data / "population.npz")
belief = load_belief(data / "belief.npz")
replace(belief, eta=0.9 * belief.eta).save(data / "belief.npz")
names = load_population_belief(data / "names.npz")
replace(names, eta=0.9 * names.eta, population="other people").save(data / "names.npz")
"""
"""Every model that ships becomes another one."""

KEEP = """
import json, shutil, sys
from pathlib import Path
from encoders.kept import ENCODER, HISTORY, INDEX, PCA_IK, POPULATION, kept_folder
from encoders.labels.population_belief import load_population_belief
from encoders.labels.trained_belief import load_belief
from encoders.regression.trained import BUILTIN, load_model
from encoders.store import load_capture

data = Path(sys.argv[1])
capture = load_capture(data / "capture.npz")
kept = {}
for name in BUILTIN:
    model = load_model(data / f"{name}.npz", capture)
    kept[model.digest] = dict(kind=ENCODER, name=name, file=f"{name}.npz", capture="capture.npz")
    if name == "quadratic":
        for digest in sys.argv[2:]:
            kept[digest] = dict(kind=PCA_IK, name=PCA_IK, like=model.digest)
digest = load_model(data / "population.npz").digest
kept[digest] = dict(kind=ENCODER, name=POPULATION, file="population.npz")
digest = load_belief(data / "belief.npz").digest
kept[digest] = dict(kind=HISTORY, name=HISTORY, file="belief.npz")
digest = load_population_belief(data / "names.npz").digest
kept[digest] = dict(kind=POPULATION, name=POPULATION, file="names.npz")
shutil.copytree(data, kept_folder(), ignore=shutil.ignore_patterns("kept"))
(kept_folder() / INDEX).write_text(json.dumps(kept))
"""
"""The models of a folder are kept, by their digests; those of inverse kinematics are given."""

OF_MODELS = ("encoder-best", "encoder-population", "encoder-pca-ik", "labels-history", "bare")


@pytest.mark.slow
def test_after_all_models_were_trained_anew_old_recordings_find_theirs(tmp_path: Path) -> None:
    tree = tmp_path / "tree"
    left_out = shutil.ignore_patterns("__pycache__", "node_modules", "page")
    for folder in ("models", "encoders", "tasks", "sandbox"):
        shutil.copytree(ROOT / folder, tree / folder, ignore=left_out)
    shutil.copytree(ROOT / "tests" / "released", tree / "tests" / "released")
    released = tree / "tests" / "released" / RELEASES[0].version

    def python(*words: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, *words],
            cwd=tree,
            env={**os.environ, "PYTHONPATH": str(tree), "OMP_NUM_THREADS": "1"},
            capture_output=True,
            text=True,
            check=False,
        )

    shutil.copytree(tree / "encoders" / "data", tmp_path / "as released")
    changed = python("-c", CHANGE)
    assert changed.returncode == 0, changed.stderr
    refused = python("-m", "sandbox", "replay", str(released / "encoder-best.jsonl.gz"))
    assert refused.returncode == 2 and "of the same name" in refused.stderr
    inverse = RELEASES[0].recordings["encoder-pca-ik"]["encoder"]
    kept = python("-c", KEEP, str(tmp_path / "as released"), inverse)
    assert kept.returncode == 0, kept.stderr
    replayed = python(
        "-c",
        "import sys; from sandbox.cli.main import main; "
        "assert not any([main(['replay', path, '--view', 'none']) for path in sys.argv[1:]])",
        *[str(released / f"{name}.jsonl.gz") for name in OF_MODELS],
    )
    assert replayed.returncode == 0, replayed.stderr
    differs = decisive_differences(RELEASES[0].versions)
    expected = "agrees: the same outcome" if differs else "equal to the bit"
    assert replayed.stdout.count(expected) == len(OF_MODELS), replayed.stdout
