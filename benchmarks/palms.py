"""Whether palms are told from fingers by the width and height of contacts.

    python -m benchmarks.palms                   # the judged people, about five minutes
    python -m benchmarks.palms --train           # the people that the judge was tuned on
    python -m benchmarks.palms --fit             # train the network of palm_place.py
    python -m benchmarks.palms --lasting 0.5     # half of the noise stays with a contact
    python -m benchmarks.palms --cost            # of a control step with sizes

500 palms of 25 to 90 mm, half of which begin at 8 to 20 mm and grow for 0.1 to 0.4 s, come before,
with or after the fingers of a grip; 500 flat thumbs and wide fingertips of 12 to 28 mm, a third of
which flatten, belong to a grip, or join one. Sizes are diameters of the circle of equal area, and
either diameter is reported with 15 % of noise, anew in every control period. Everything goes
through the reconstructor of sessions.

A palm is wrong if it is not known in the end, or not before its first push: it had a name while the
hand was down. A finger is wrong if it was ever taken for a palm, or has no name in the end. The
judged people and seeds follow from a hash over what the judge was tuned to. SIMULATED: no person
took part.
"""

from __future__ import annotations

import argparse
import json
import os
import time
import warnings
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import cache
from hashlib import sha256
from typing import Any, NamedTuple

import numpy as np
from rich.console import Console
from rich.progress import Progress
from rich.table import Table
from sklearn.exceptions import ConvergenceWarning
from sklearn.neural_network import MLPClassifier

from benchmarks.machine import describe_machine
from benchmarks.resting_palms import (
    NOISE,
    PALM,
    USUAL,
    WIDE,
    Scene,
    clear_of,
    finger_scene,
    grip,
    palm_place,
    palm_scene,
    people,
    usual_size,
    which_finger,
)
from encoders.capture import Capture
from encoders.reconstruction import contact_courses, palm_judge
from encoders.reconstruction import palm_place as places
from encoders.reconstruction.arrival import Phase
from encoders.reconstruction.contact_tracker import JOINING
from encoders.reconstruction.touch_reconstructor import TouchReconstructor
from models.arithmetic.arrays import Array
from models.frames import Contact, TouchFrame
from models.scene import CONTROL_PERIOD
from models.skeleton import ADULT
from models.surface import Surface
from sandbox.regress.statistics import wilson
from sandbox.session.device import Device
from sandbox.trial.assembly import build, load_encoder, make_labeller, reconstructor_settings
from sandbox.trial.settings import RunSettings
from tasks.task import Task

SURFACE = Surface(16.0, 12.0)
"""Large enough for every grip and palm."""
EACH = 12
"""People of either generator."""
FITTED, FITTED_PEOPLE = 160_000, 30
"""Contacts that the network of places is trained on, and people of either generator."""
DOUBTFUL = 26.5
"""mm, diameter of these palms: of larger and smaller ones the size tells."""
HIDDEN, EPOCHS, BATCH, RATE, DECAY = 24, 30, 512, 3e-3, 1e-2
"""Rectifiers, and how they are trained."""


CORNER = ((0.02, 0.08), (0.04, 0.04), (0.06, 0.03), (0.08, 0.04), (0.10, 0.06))
"""m, thumb to little finger."""


class Job(NamedTuple):
    """One trial: `palm` or `finger`, salt of its people, number, and the lasting noise's share."""

    kind: str
    salt: str
    number: int
    lasting: float


@dataclass(frozen=True)
class Outcome:
    """What happened in one trial.

    Attributes:
        when: When the judged contact came.
        grew: It grew or flattened.
        size: mm, its diameter in the end.
        palm_after: s from its touch until it was taken for a palm; infinite if it never was.
        named_after: s until it had a name; infinite if it never had.
        pushed: It had a name while the hand was down.
        named: It has a name in the end.
        others: Number of the grip's other fingers that were taken for palms.
        waited: s by which its name came later than without sizes; infinite if it never came.
    """

    when: str
    grew: bool
    size: float
    palm_after: float
    named_after: float
    pushed: bool
    named: bool
    others: int
    waited: float


def tuned() -> str:
    """A digest of everything that was tuned."""
    values = [
        {name: values.tolist() for name, values in places.weights().items()},
        places.LARGEST,
        *(palm_judge.LANDED, palm_judge.DECIDED_BY, palm_judge.CERTAIN, JOINING),
        *(palm_judge.PALM_ODDS, palm_judge.FINGER_ODDS, palm_judge.LATE_ODDS),
        *(contact_courses.NOISE, contact_courses.MEMORY, contact_courses.REPEATED),
    ]
    return sha256(json.dumps(values).encode()).hexdigest()


@cache
def everyone(salt: str) -> tuple[Capture, ...]:
    """The people of a salt, drawn once in each process."""
    return people(salt, EACH)


def scene_of(job: Job) -> Scene:
    """The contacts of a trial."""
    seed = int.from_bytes(sha256(f"{job.salt} {job.kind} {job.number}".encode()).digest()[:8])
    make = palm_scene if job.kind == "palm" else finger_scene
    middle = SURFACE.size / 2
    return make(everyone(job.salt), np.random.default_rng(seed), middle, job.lasting)


def trial(job: Job) -> Outcome:
    """Plays one trial, a finger's once more without sizes."""
    scene = scene_of(job)
    touch = next(t for t in scene.touches if t.id == scene.judged)
    found = _played(scene, sized=True)
    waited = 0.0
    if job.kind == "finger":
        waited = found.named_after - _played(scene, sized=False).named_after
    return Outcome(
        scene.when,
        touch.size.takes > 0.0,
        touch.size.last,
        found.palm_after,
        found.named_after,
        found.pushed,
        found.named,
        found.others,
        waited,
    )


@dataclass
class _Played:
    palm_after: float = np.inf
    named_after: float = np.inf
    pushed: bool = False
    named: bool = False
    others: int = 0


def _played(scene: Scene, sized: bool) -> _Played:
    settings = RunSettings()
    model = load_encoder(settings.encoder)
    reconstructor = TouchReconstructor(
        model, make_labeller(settings, model), ADULT, SURFACE, reconstructor_settings(settings)
    )
    begins = next(t.begins for t in scene.touches if t.id == scene.judged)
    found, others = _Played(), set()
    for frame in scene.frames(CONTROL_PERIOD, sized):
        hand = reconstructor.step(frame)
        found.named = False
        for contact in hand.contacts:
            if contact.id != scene.judged:
                others |= {contact.id} if contact.state == "palm" else set()
            elif contact.state == "palm":
                found.palm_after = min(found.palm_after, frame.time - begins)
            elif contact.label is not None:
                found.named = True
                found.named_after = min(found.named_after, frame.time - begins)
                found.pushed |= hand.phase is Phase.DOWN
    found.others = len(others)
    return found


def fit() -> dict[str, list[Any]]:
    """Weights of the network of `palm_place`, trained on as many palms as fingertips."""
    rng = np.random.default_rng(61_031)
    fitted = people("palms to fit", FITTED_PEOPLE)
    inputs: list[list[float]] = []
    is_palm = np.arange(FITTED) % 2
    for palm in is_palm:
        person, frame, fingers = grip(fitted, rng)
        others = person.xy[frame, fingers]
        if palm:
            room = 0.0005 * (DOUBTFUL + rng.uniform(*USUAL, len(others)))
            place = clear_of(others, palm_place(person, frame, rng), room)
        else:
            which = which_finger(fingers, rng)
            place, others = others[which], np.delete(others, which, axis=0)
        inputs.append(places.place_inputs(_pair(place), [_pair(other) for other in others]))
    network = MLPClassifier(
        (HIDDEN,),
        alpha=DECAY,
        batch_size=BATCH,
        learning_rate_init=RATE,
        max_iter=EPOCHS,
        random_state=1,
    )
    with warnings.catch_warnings():
        # It ends after so many epochs on purpose.
        warnings.simplefilter("ignore", ConvergenceWarning)
        network.fit(np.array(inputs), is_palm)
    first, second = network.coefs_
    bias, constant = network.intercepts_
    weights = {"first": first.T, "bias": bias, "second": second[:, 0], "constant": constant}
    return {name: np.round(values, 4).tolist() for name, values in weights.items()}


def _pair(place: Array) -> tuple[float, float]:
    x, y = place.tolist()
    return x, y


def cost(steps: int = 400) -> tuple[float, float, float]:
    """us of a control step with five fingers without and with sizes, and the median ratio of steps
    side by side."""
    sessions = []
    for sized in (False, True):

        def make(task: Task, surface: Surface, sized: bool = sized) -> Resting:
            return Resting(sized)

        sessions.append(build(RunSettings(seed=3), (make,)))
    times: Array = np.empty((steps, 2))
    for step in range(steps):
        # In turns, so that neither gets the quieter machine.
        for which in (0, 1) if step % 2 else (1, 0):
            begin = time.perf_counter()
            sessions[which].advance()
            times[step, which] = time.perf_counter() - begin
    for session in sessions:
        session.close()
    without, with_sizes = 1e6 * np.median(times, axis=0)
    return float(without), float(with_sizes), float(np.median(times[:, 1] / times[:, 0]))


class Resting(Device):
    """Five fingertips that rest in the upper left corner.

    Args:
        sized: They report noisy sizes.
    """

    def __init__(self, sized: bool) -> None:
        self._sized = sized
        self._rng = np.random.default_rng(61_037)
        self._sizes = [usual_size(self._rng) for _ in CORNER]

    def poll(self, now: float) -> list[TouchFrame]:
        contacts = tuple(
            Contact(i, x, y, extent=size.report(now, self._rng) if self._sized else None)
            for i, ((x, y), size) in enumerate(zip(CORNER, self._sizes, strict=True))
        )
        return [TouchFrame(now, contacts)]


def wrong(kind: str, outcome: Outcome) -> bool:
    """True if the contact was misjudged, or too late."""
    known = np.isfinite(outcome.palm_after)
    if kind == "palm":
        return not known or outcome.pushed or outcome.named
    return bool(known) or not outcome.named


def add_row(table: Table, kind: str, name: str, found: Sequence[Outcome]) -> None:
    """Adds the row of some trials."""
    if not found:
        return
    bad = sum(wrong(kind, o) for o in found)
    low, high = wilson(bad, len(found))
    after = [o.palm_after if kind == "palm" else o.waited for o in found]
    after = [a for a in after if np.isfinite(a)] or [np.nan]
    table.add_row(
        name,
        f"{bad} of {len(found)}",
        f"{100 * bad / len(found):.1f} [{100 * low:.1f}, {100 * high:.1f}]",
        f"{np.median(after):.2f}, {np.percentile(after, 95):.2f}, {max(after):.2f}",
        str(sum(o.pushed for o in found)) if kind == "palm" else "-",
        str(sum(o.others for o in found)),
    )


def main() -> None:
    """Prints the table, or the weights."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--each", type=int, default=500, help="palms, and fingers")
    parser.add_argument("--train", action="store_true", help="the people that it was tuned on")
    parser.add_argument("--fit", action="store_true", help="train the network of places")
    parser.add_argument("--lasting", type=float, default=0.0, help="share of the noise, 0 to 1")
    parser.add_argument("--cost", action="store_true", help="time control steps instead")
    parser.add_argument("--workers", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--failures", action="store_true", help="list what was wrong")
    options = parser.parse_args()
    if options.fit:
        places.FILE.write_text(json.dumps(fit()) + "\n")
        return
    if options.cost:
        without, with_sizes, ratio = cost()
        print(describe_machine())
        print(f"a control step: {without:.0f} us, {with_sizes:.0f} us with sizes: {ratio:.3f}")
        return
    salt = "palms to tune" if options.train else f"palms {tuned()}"
    jobs = [
        Job(kind, salt, number, options.lasting)
        for kind in ("palm", "finger")
        for number in range(options.each)
    ]
    os.environ["OMP_NUM_THREADS"] = "1"
    everyone(salt)  # Before the processes begin, which share them.
    bars = Progress(console=Console(stderr=True))
    with bars, ProcessPoolExecutor(options.workers) as pool:
        found = list(bars.track(pool.map(trial, jobs, chunksize=25), total=len(jobs)))
    done = list(zip(jobs, found, strict=True))
    table = Table(
        "contacts",
        "wrong",
        "%",
        "s: median, 95 %, most",
        "pushed first",
        "other fingers taken for palms",
    )
    for kind, edge in (("palm", PALM[0] + 5.0), ("finger", WIDE[1] - 4.0)):
        those = [o for job, o in done if job.kind == kind]
        add_row(table, kind, f"{kind}s", those)
        for when in ("before", "with", "while down"):
            add_row(table, kind, f"  that come {when}", [o for o in those if o.when == when])
        add_row(table, kind, "  that grow or flatten", [o for o in those if o.grew])
        add_row(table, kind, f"  below {edge:g} mm", [o for o in those if o.size < edge])
        add_row(table, kind, f"  from {edge:g} mm", [o for o in those if o.size >= edge])
    print(
        f"people and seeds of {salt!r}; {NOISE:.0%} of noise, {options.lasting:.0%} of it lasting"
    )
    print("s: of palms from the touch until known, of fingers the later name than without sizes")
    Console(width=120).print(table)
    if options.failures:
        for job, outcome in done:
            if wrong(job.kind, outcome):
                print(job.kind, job.number, outcome)


if __name__ == "__main__":
    main()
