"""A lab's own encoder, in a file or in an installed package, is used wherever ours are."""

from __future__ import annotations

import json
from collections.abc import Iterator
from inspect import getsource
from pathlib import Path
from typing import Any, Self

import numpy as np
import pytest
from numpy.typing import ArrayLike

from encoders import check_encoder
from encoders.capture import Capture, save_capture
from encoders.encoder import Encoder
from encoders.regression.encoder_registry import (
    ENCODERS,
    builtin_name,
    find_encoder,
    source_digest,
)
from encoders.regression.model_registry import cache_folder, find_model, pca_ik_model
from encoders.regression.trained import builtin_capture, load_model
from encoders.regression.training import save_model, train_encoder
from models.arithmetic import Array
from models.errors import EncoderError, RecordingError
from sandbox.cli.main import main
from sandbox.recording.recording import load_recording
from sandbox.trial.replay import settings_of
from tests.support.lab_package import install_lab, sandbox_with
from tests.support.npz_files import header_of, rewritten
from tests.support.processes import ROOT

EXAMPLE = ROOT / "examples" / "kernel_ridge.py"
NAME = f"{EXAMPLE}:KernelRidge"
QUICK = "tests.support.regress_tasks:Quick"


@pytest.fixture(scope="module", autouse=True)
def cache(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """A folder for trained models that is not this user's."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))
        yield


@pytest.fixture(scope="module")
def capture() -> Capture:
    """Every fortieth frame of the built-in capture: all takes, quickly learned."""
    return builtin_capture().select(np.arange(0, len(builtin_capture()), 40))


class Mean(Encoder):
    """The least that an encoder has: fit and predict."""

    def fit(self, U: ArrayLike, Q: ArrayLike) -> Self:
        self.mean = np.mean(np.asarray(Q, float), axis=0)
        return self

    def predict(self, U: ArrayLike) -> Array:
        return np.broadcast_to(self.mean, (*np.shape(U)[:-1], 48)).copy()


def test_the_example_plays_a_trial_that_replays(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    record, out = tmp_path / "run.jsonl", tmp_path / "run.json"
    line = ["run", "box-to-goal", "--seed", "7", "--encoder", NAME, "--record", str(record)]
    assert main([*line, "--json", str(out)]) == 0
    assert "training KernelRidge" in capsys.readouterr().err
    result = json.loads(out.read_text())
    assert result["success"] and result["encoder"] == NAME
    assert result["encoder_from"] == {"file": str(EXAMPLE), "member": "KernelRidge"}
    assert main(["replay", str(record), "--view", "none"]) == 0
    assert "exact" in capsys.readouterr().out


def test_the_example_is_trained_into_a_file_that_is_loaded_again(
    capture: Capture, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, out = tmp_path / "c.npz", tmp_path / "kernel.npz"
    save_capture(capture, path)
    assert main(["train", "--encoder", NAME, "--capture", str(path), "--out", str(out)]) == 0
    assert "KernelRidge" in capsys.readouterr().out
    model, again = find_model(str(out), print), train_encoder(capture, "k", find_encoder(NAME))
    assert model.digest == again.digest and builtin_name(model.encoder) is None
    np.testing.assert_array_equal(
        model.encoder.predict(model.training_u), again.encoder.predict(model.training_u)
    )
    assert main(["run", QUICK, "--encoder", str(out)]) == 0


def test_the_example_is_evaluated_beside_ours(capture: Capture, tmp_path: Path) -> None:
    path, out = tmp_path / "c.npz", tmp_path / "report.json"
    save_capture(capture, path)
    line = ["evaluate", "--encoders", "mean", NAME, "--capture", str(path), "--train", "split"]
    assert main([*line, "--no-copas", "--json", str(out)]) == 0
    assert json.loads(out.read_text())["encoders"].keys() == {"mean", "KernelRidge"}


@pytest.mark.parametrize("encoder", [*sorted(ENCODERS), Mean])
def test_each_of_our_encoders_and_one_that_stores_nothing_come_back_from_a_file(
    encoder: str | type[Encoder], capture: Capture, tmp_path: Path
) -> None:
    kind = ENCODERS[encoder] if isinstance(encoder, str) else encoder
    model = pca_ik_model() if encoder == "pca-ik" else train_encoder(capture, "own", kind)
    save_model(model, tmp_path / "m.npz")
    read = load_model(tmp_path / "m.npz")
    # The built-in model of inverse kinematics has a digest of its own, the same on every machine.
    digest = "5f66865a6554705909f9101d147652c4" if encoder == "pca-ik" else read.digest
    assert model.digest == digest and type(read.encoder) is type(model.encoder)
    some = model.training_u[:: len(model.training_u) // 300 + 1]
    np.testing.assert_array_equal(read.encoder.predict(some), model.encoder.predict(some))


@pytest.mark.parametrize(
    "changes",
    [
        {"weights": None},
        {"weights": np.zeros((3, 48))},
        {"header": header_of('{"schema": 2, "meta": {}, "kind": "outside"}')},
        {
            "header": header_of(
                '{"schema": 2, "meta": {}, "kind": "outside", "configuration": {},'
                ' "from": {"file": "/nowhere/lab.py", "member": "Lab"}}'
            )
        },
    ],
)
def test_a_damaged_model_of_a_custom_encoder_is_refused_with_a_one_line_error(
    capture: Capture, tmp_path: Path, changes: dict[str, Any]
) -> None:
    path = tmp_path / "k.npz"
    save_model(train_encoder(capture, "k", find_encoder(NAME)), path)
    rewritten(path, **changes)
    with pytest.raises(EncoderError, match=r"k\.npz") as error:
        load_model(path)
    assert "\n" not in str(error.value)


def test_a_model_that_took_long_to_train_is_cached(
    capture: Capture, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from encoders.regression import model_registry

    monkeypatch.setattr(model_registry, "LONG", 0.0)
    monkeypatch.setattr(model_registry, "builtin_capture", lambda: capture)
    path, told = tmp_path / "lab.py", list[str]()
    path.write_text("from tests.encoders.test_own_encoder import Mean\nclass A(Mean): pass")
    first = find_model(str(path), told.append)
    assert any("stored in" in line for line in told) and list(cache_folder().glob("*.npz"))
    told.clear()
    model_registry._trained.cache_clear()
    assert find_model(str(path), told.append).digest == first.digest and told == []


def write(path: Path, body: str) -> str:
    path.write_text(
        "import numpy as np\nfrom encoders import Encoder\n"
        f"from tests.encoders.test_own_encoder import Mean\n{body}"
    )
    return str(path)


@pytest.mark.parametrize(
    "body",
    [
        "1/0",
        "A = 5",
        "class A:\n def fit(self, U, Q): return self",
        "class A(Encoder):\n def fit(self, U, Q): return self",
        "class A(Mean):\n def __init__(self, size): pass",
        "class A(Mean):\n def __init__(self): 1/0",
    ],
)
def test_a_file_without_a_valid_encoder_is_refused_with_a_one_line_error(
    tmp_path: Path, body: str
) -> None:
    with pytest.raises(EncoderError) as error:
        find_encoder(write(tmp_path / "lab.py", body) + ":A")
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    "method",
    [
        "fit(self, U, Q): super().fit(U, Q)",
        "fit(self, U, Q): 1/0",
        "predict(self, U): 1/0",
        "predict(self, U): return np.zeros((*U.shape[:-1], 47))",
        "predict(self, U): return np.full((*U.shape[:-1], 48), np.nan)",
        "predict(self, U): return np.zeros((len(U), 48)) if U.ndim == 2 else 1 / 0",
        "predict(self, U): U *= 2.54; return super().predict(U)",
        "configuration(self): return {'a': Mean}",
        "arrays(self): return [1]",
        "arrays(self): return {'../a': np.zeros(3)}",
        "arrays(self): return {'a': np.random.rand(3)}",
        "restore(self, arrays, U, Q): 1/0",
    ],
)
def test_an_encoder_that_breaks_the_contract_is_refused_with_a_one_line_error(
    capture: Capture, tmp_path: Path, method: str
) -> None:
    kind = find_encoder(write(tmp_path / "lab.py", f"class A(Mean):\n def {method}"))
    with pytest.raises(EncoderError) as error:
        train_encoder(capture, "a", kind)
    assert "\n" not in str(error.value)


class Counting(Mean):
    """Predicts something else every time."""

    predictions = 0

    def predict(self, U: ArrayLike) -> Array:
        self.predictions += 1
        return super().predict(U) + 1e-4 * self.predictions


class Centred(Mean):
    """Subtracts means in place, as one does with arrays that are one's own."""

    def fit(self, U: ArrayLike, Q: ArrayLike) -> Self:
        super().fit(U, Q)
        for given in (U, Q):
            assert isinstance(given, np.ndarray)
            given -= given.mean(axis=0)
        return self

    def arrays(self) -> dict[str, Any]:
        return {"mean": self.mean}

    def restore(self, arrays: Any, U: Array, Q: Array) -> Self:
        self.mean = arrays["mean"]
        U += 1.0
        return self


class Drawn(Centred):
    """Learns something else every time, and stores it."""

    def fit(self, U: ArrayLike, Q: ArrayLike) -> Self:
        super().fit(U, Q)
        self.mean = self.mean + np.random.default_rng().normal(0.0, 1.0, 48)
        return self


def test_the_check_for_authors_accepts_the_example_and_ours(capture: Capture) -> None:
    check_encoder(NAME)
    for name in ("linear", "turned"):
        check_encoder(ENCODERS[name], capture)


@pytest.mark.parametrize("encoder", [Counting, Drawn, dict, "no-such-encoder"])
def test_the_check_for_authors_refuses_what_breaks_a_rule_in_one_line(
    encoder: type | str, capture: Capture
) -> None:
    with pytest.raises(EncoderError) as error:
        check_encoder(encoder, capture)
    assert "\n" not in str(error.value)


def test_a_pose_that_is_not_finite_in_the_midst_of_a_trial_is_told_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    body = """class A(Mean):
 asked = 0
 def predict(self, U):
  self.asked += np.ndim(U) == 1
  return super().predict(U) * (np.nan if self.asked > 20 else 1.0)"""
    file = write(tmp_path / "lab.py", body)
    assert main(["run", "box-to-goal", "--encoder", f"{file}:A"]) == 2
    assert "not finite" in capsys.readouterr().err.strip().splitlines()[-1]


def test_an_encoder_that_learns_in_place_changes_no_capture_and_no_training_frame(
    capture: Capture, tmp_path: Path
) -> None:
    U, Q = capture.u.copy(), capture.relative.copy()
    model = train_encoder(capture, "centred", Centred)
    save_model(model, tmp_path / "c.npz")
    for frames in (model, load_model(tmp_path / "c.npz")):
        np.testing.assert_array_equal(frames.training_u, U.astype(np.float32))
        np.testing.assert_array_equal(frames.training_pose, Q.astype(np.float32))
    np.testing.assert_array_equal(capture.u, U)
    np.testing.assert_array_equal(capture.relative, Q)


def test_the_source_digest_is_that_of_the_file(tmp_path: Path) -> None:
    a = find_encoder(write(tmp_path / "a.py", "class A(Mean): pass"))
    b = find_encoder(write(tmp_path / "b.py", "class A(Mean): pass"))
    c = find_encoder(write(tmp_path / "c.py", "class A(Mean): 'other'"))
    assert source_digest(a) == source_digest(b) != source_digest(c)


def test_a_class_within_a_function_cannot_be_stored(capture: Capture, tmp_path: Path) -> None:
    class Inner(Mean):
        pass

    model = train_encoder(capture, "inner", Inner)
    with pytest.raises(EncoderError, match=r"Inner.*loaded again"):
        save_model(model, tmp_path / "m.npz")


def test_a_recording_whose_encoder_has_changed_or_is_gone_is_refused(tmp_path: Path) -> None:
    lab, record = tmp_path / "lab.py", tmp_path / "run.jsonl"
    write(lab, "class A(Mean): pass")
    assert main(["run", QUICK, "--encoder", f"{lab}:A", "--record", str(record)]) == 0
    settings_of(load_recording(record))
    whole = record.read_text()
    digest = json.loads(whole.splitlines()[0])["digests"]["encoder"]
    record.write_text(whole.replace(digest, "0" * 32))
    with pytest.raises(RecordingError, match=r"encoder changed.*sandbox train --encoder"):
        settings_of(load_recording(record))
    record.write_text(whole.replace("lab.py", "gone.py"))
    with pytest.raises(RecordingError, match=r"not on this machine.*Put gone\.py back"):
        settings_of(load_recording(record))


def test_an_installed_package_s_encoder_is_run_recorded_and_replayed(tmp_path: Path) -> None:
    head = "from __future__ import annotations\nimport numpy as np\nfrom encoders import Encoder\n"
    entry_point = "[hand_sandbox.encoders]\ntiny-lab-mean = tiny_lab:Mean\n"
    installed = install_lab(tmp_path, head + getsource(Mean), entry_point)
    record = str(tmp_path / "run.jsonl")
    ran = sandbox_with(installed, "run", QUICK, "--encoder", "tiny-lab-mean", "--record", record)
    assert ran.returncode == 0, ran.stderr
    source = json.loads(Path(record).read_text().splitlines()[0])["encoder_from"]
    assert source == {"entry_point": "tiny_lab:Mean", "package": "tiny-lab", "version": "0.3"}
    again = sandbox_with(installed, "replay", record, "--view", "none")
    assert again.returncode == 0 and "exact" in again.stdout
    without = sandbox_with(None, "replay", record, "--view", "none")
    assert without.returncode == 2
    assert "pip install 'tiny-lab==0.3'" in without.stderr and without.stderr.count("\n") == 1
