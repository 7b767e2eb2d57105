"""Orders of all designs are those of before, and numbers of who leaves go to newcomers."""

from __future__ import annotations

import json
from hashlib import blake2b
from itertools import product
from pathlib import Path

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from sandbox.study.design.balance import rows_of, whole_cycle
from sandbox.study.design.session_plan import session_plan, trials_of
from sandbox.study.record.folder import REAL, Participant, StudyFolder
from tests.sandbox.study.design.test_study_balance import crossed
from tests.support.study_files import SHORT, design

KEPT = Path(__file__).with_name("orders.json")
"""Digests of the orders of all designs, by their first factor; `python FILE` writes them anew."""
RULES = ("latin", "factorial", "random", "between", "blocked")
LARGEST = 720
"""Participants of a cycle that are compared at most."""


def designs() -> list[tuple[tuple[str, int], ...]]:
    """Factors of all designs of up to three factors, each with two to five levels."""
    one = [(rule, count) for rule in RULES for count in range(2, 6)]
    few = [(rule, count) for rule in RULES for count in (2, 3)]
    return [*((a,) for a in one), *product(one, few), *product(few, few, few[::3])]


def digest(rules: tuple[tuple[str, int], ...]) -> str:
    """Digest of the orders that the participants of a whole cycle meet."""
    plan = crossed(*rules)
    met = [rows_of(plan, number) for number in range(min(whole_cycle(plan), LARGEST))]
    levels = [
        [tuple(trial.levels.values()) for trial in trials_of(session_plan(plan, number, 1))]
        for number in (1, 2, whole_cycle(plan))
    ]
    return blake2b(json.dumps([met, levels]).encode(), digest_size=8).hexdigest()


def digests() -> dict[str, str]:
    """Digest of the orders of all designs with this first factor."""
    found: dict[str, list[str]] = {}
    for rules in designs():
        rule, count = rules[0]
        found.setdefault(f"{rule} {count}", []).append(digest(rules))
    return {
        first: blake2b("".join(some).encode(), digest_size=8).hexdigest()
        for first, some in found.items()
    }


def test_every_participant_of_every_design_meets_the_levels_in_the_order_of_before() -> None:
    assert digests() == json.loads(KEPT.read_bytes())


@given(st.integers(2, 24), st.floats(0.0, 0.6), st.integers(0, 1000))
@settings(max_examples=12, deadline=None)
def test_after_any_drop_outs_those_who_finish_have_the_numbers_from_the_first_on(
    tmp_path_factory: object, wanted: int, share: float, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    study = StudyFolder(tmp_path_factory.mktemp("orders"), design(SHORT), REAL)  # type: ignore[attr-defined]
    here: list[Participant] = []
    finished: set[int] = set()
    while len(finished) < wanted:
        if here and rng.random() < 0.5:
            person = here.pop(int(rng.integers(len(here))))
            if rng.random() < share:
                study.release(person.ppid, "left")
            else:
                finished.add(person.number)
        elif len(here) + len(finished) < wanted:
            here.append(study.add())
    assert finished == set(range(1, wanted + 1))


if __name__ == "__main__":
    KEPT.write_text(json.dumps(digests(), indent=0) + "\n")
