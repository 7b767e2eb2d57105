"""Training and test data of evaluations: days of a simulated subject, or captures in files."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from hashlib import blake2b
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from rich.progress import Progress

from encoders.capture import Capture, load_capture
from encoders.captures.subject.subject import TRAINING_DAY, Subject
from encoders.evaluation.methods import Training
from encoders.regression.trained import builtin_capture, load_model
from encoders.validation import trial_folds
from models.errors import CaptureError, InputError
from models.frames import FINGERS

BUILTIN, SPLIT = "builtin", "split"

MOST = 0.5
"""Largest share of a test capture's frames that a model may have learned from. Resting hands can
give equal frames in different captures."""
SPLIT_FOLDS = 5
"""Number of folds for `split`; one fold is used for tests. Takes are not divided between folds. The
sizes of the takes determine the folds."""


@dataclass(frozen=True)
class Data:
    """Data of an evaluation.

    Attributes:
        training: Training data.
        tests: Test captures.
        configuration: Sources of both; JSON values.
        remarks: Remarks on the data for people.
    """

    training: Training
    tests: list[Capture]
    configuration: dict[str, Any]
    remarks: tuple[str, ...] = ()


def gather(
    places: Sequence[str],
    train: str,
    person: Subject,
    days: int,
    day_seed: int,
    progress: Progress,
) -> Data:
    """Loads or simulates training and test data.

    Args:
        places: `builtin`, captures, folders and lists of captures to test on.
        train: `builtin`, `split` or a capture.
        person: The simulated subject.
        days: Number of the subject's test days, for `builtin`.
        day_seed: Seed that selects these days.
        progress: Gets a bar for every simulated day.

    Raises:
        InputError: A capture does not exist, or a method would be tested on its training data.
    """
    files = [file for place in places if place != BUILTIN for file in capture_files(place)]
    configuration: dict[str, Any] = {"train": train, "captures": [str(f) for f in files]}
    if train == SPLIT:
        if BUILTIN in places or len(files) != 1:
            raise InputError(
                "only one capture of your own can be split",
                where="--train split",
                got=f"{len(files)} captures" + (" and builtin" if BUILTIN in places else ""),
                expected="one --capture FILE",
            )
        whole = _loaded(files[0])
        out = trial_folds(whole.trial, SPLIT_FOLDS) == 0
        if out.all():
            raise CaptureError("one take cannot be split", where=str(files[0]))
        # Sets of fingers that do not occur in the training data are not tested.
        sets = np.packbits(whole.down, axis=1)[:, 0]
        known = np.isin(sets, sets[~out])
        unknown = whole.down[out & ~known]
        if not (out & known).any():
            raise CaptureError(
                "every set of fingers is in a single take only, so no take is left to test on",
                where=str(files[0]),
                remedy="Record every set of fingers at least twice, with a pause between",
            )
        configuration["test_takes"] = sorted({int(t) for t in whole.trial[out & known]})
        remarks = _untested(unknown)
        return Data(
            Training(whole.select(~out)), [whole.select(out & known)], configuration, remarks
        )

    loaded = [_loaded(file) for file in files]
    learned = _loaded(Path(train)) if train != BUILTIN else None
    tests: list[Capture] = []
    if BUILTIN in places or train == BUILTIN:
        configuration |= {
            "subject": person.name,
            "subject_digest": person.digest,
            "subject_seed": person.seed,
        }
    if BUILTIN in places:
        numbers = person.judged_days(days, day_seed)
        configuration |= {"days": numbers, "day_seed": day_seed}
        tests += [_simulated(person, day, progress) for day in numbers]
    tests += loaded
    training = Training(learned) if learned is not None else _day_0(person, progress)
    digest = capture_digest(training.capture)
    for test in tests:
        if capture_digest(test) == digest:
            raise CaptureError(
                "methods would be tested on their training frames",
                where=str(test.meta.get("file", "--capture")),
                remedy="--train split trains on some takes of a capture and tests on other takes",
            )
    configuration["training_digest"] = digest
    return Data(training, tests, configuration)


def capture_digest(capture: Capture) -> str:
    """BLAKE2b of a capture's takes, its contacts, and the contacts' positions in micrometres."""
    hash_ = blake2b(digest_size=16)
    hash_.update(np.ascontiguousarray(capture.trial, np.int64).tobytes())
    hash_.update(np.ascontiguousarray(capture.down).tobytes())
    micrometres = np.where(capture.down[..., None], np.rint(capture.xy * 1e6), 0.0)
    hash_.update(micrometres.astype(np.int64).tobytes())
    return hash_.hexdigest()


def _untested(down: NDArray[np.bool_]) -> tuple[str, ...]:
    """A remark on frames that are not tested; none without such frames.

    Args:
        down: (n, 5) touching fingers of these frames.
    """
    if not len(down):
        return ()
    sets = [" + ".join(FINGERS[i] for i in np.flatnonzero(row)) for row in np.unique(down, axis=0)]
    return (
        f"{len(down):,} frames are not tested, since only one take has their set of fingers: "
        + "; ".join(sets),
    )


def refuse_learned(names: Sequence[str], tests: Sequence[Capture]) -> None:
    """Refuses test captures that are training data of a model in a file.

    Args:
        names: Methods; names that end in `.npz` are files of models.
        tests: The captures to test on.

    Raises:
        CaptureError: A model learned from most of a capture's frames.
        EncoderError: A file is not a model.
    """
    for name in names:
        if Path(name).suffix != ".npz":
            continue
        # Models store their training data in single precision.
        learned = {row.tobytes() for row in load_model(Path(name)).training_u.astype(np.float32)}
        for test in tests:
            seen = [row.tobytes() in learned for row in test.u.astype(np.float32)]
            if np.mean(seen) > MOST:
                raise CaptureError(
                    "the method would be tested on its training frames",
                    where=f"--encoders {name}",
                    got=str(test.meta.get("file", "--capture")),
                    remedy="Test on another capture, or let `--train split` train on some takes",
                )


def capture_files(place: str) -> list[Path]:
    """Returns the captures that a value of --capture names.

    A folder means its .npz files in the order of their names. A text file (.txt) names one capture
    per line, relative to the folder of the text file; `#` begins a comment.
    """
    path = Path(place)
    if path.is_dir():
        files = sorted(path.glob("*.npz"))
    elif path.suffix == ".txt":
        try:
            lines = path.read_text(encoding="utf-8").splitlines()
        except (OSError, UnicodeDecodeError) as error:
            raise CaptureError(
                "the list cannot be read", where=str(path), got=str(error)
            ) from error
        named = [line.partition("#")[0].strip() for line in lines]
        files = [path.parent / name for name in named if name]
    else:
        return [path]
    if not files:
        raise CaptureError(
            "there are no captures in this place",
            where=str(path),
            expected="at least one .npz file",
        )
    return files


def _loaded(file: Path) -> Capture:
    capture = load_capture(file)
    return replace(capture, meta=capture.meta | {"file": str(file)})


def _simulated(person: Subject, day: int, progress: Progress) -> Capture:
    bar = progress.add_task(f"{person.name} subject, day {day}", total=1.0)
    return person.day(day, lambda share: progress.update(bar, completed=share))


def _day_0(person: Subject, progress: Progress) -> Training:
    """Returns the subject's training capture: the shipped one if it is of this subject, else a
    simulated one."""
    if person.plays(builtin_capture()):
        return Training(builtin_capture())
    return Training(_simulated(person, TRAINING_DAY, progress))
