"""Methods are compared on the same seeds, and what is told of them follows from their trials."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.methods import (
    SHIPS,
    Job,
    Played,
    compare,
    difference,
    differences,
    draw,
    interval,
    play,
    rows,
)

GOOD = Played(True, 90.0, 6.0, False, 0, 0.5)
BAD = Played(False, 20.0, 30.0, True, 1, 4.0)
JOB = Job("insert", SHIPS, "hand", 3, 0)


def trials(method: str, *played: Played) -> dict[Job, Played]:
    return {JOB._replace(method=method, seed=i): each for i, each in enumerate(played)}


def test_a_method_that_is_equal_on_every_seed_differs_in_nothing() -> None:
    same = difference([GOOD, BAD], [GOOD, BAD])
    assert (same.won, same.lost, same.points) == (0, 0, 0.0)
    assert (same.by_success, same.by_points) == (1.0, 1.0)


# The exact p value of a dozen unequal pairs takes long.
@settings(max_examples=15)
@given(st.lists(st.tuples(st.booleans(), st.booleans()), min_size=2, max_size=40))
def test_a_comparison_that_is_turned_round_says_the_opposite(
    pairs: list[tuple[bool, bool]],
) -> None:
    one = [GOOD if a else BAD for a, _ in pairs]
    other = [GOOD if b else BAD for _, b in pairs]
    there, back = difference(one, other), difference(other, one)
    assert (there.won, there.lost) == (back.lost, back.won)
    assert there.points == pytest.approx(-back.points)
    assert (there.low, there.high) == pytest.approx((-back.high, -back.low))
    assert there.by_success == pytest.approx(back.by_success)
    assert there.by_points == pytest.approx(back.by_points)


def test_an_interval_holds_its_mean_and_narrows_with_more_values() -> None:
    few, many = [80.0, 90.0, 100.0], [80.0, 90.0, 100.0] * 10
    for values in (few, many):
        low, high = interval(values)
        assert low < 90.0 < high
    assert interval(many)[1] < interval(few)[1]
    assert interval([70.0]) == (70.0, 70.0)


def test_only_seeds_that_both_have_played_are_compared_and_all_tests_are_corrected() -> None:
    done = trials(SHIPS, *[GOOD] * 12) | trials("mean pose", *[BAD] * 10)
    done |= trials("linear", *[replace(GOOD, points=89.0)] * 12)
    lines = list(differences(compare(done)))
    mean_pose = next(line for line in lines if "mean pose" in line)
    assert "| 10 | 0, 10 | -70.0 [-70.0, -70.0] |" in mean_pose
    assert not any(line.split("|")[4].strip() == SHIPS for line in lines[2:])
    # Four tests: the smallest p, of points of `linear`, is multiplied by 4, and the next by 3.
    raw = difference([BAD] * 10, [GOOD] * 10).by_success
    assert f"{3 * raw:.3g}" in mean_pose


def test_the_table_counts_what_is_in_the_trials() -> None:
    (line,) = list(rows(trials(SHIPS, GOOD, GOOD, BAD)))[2:]
    cells = [cell.strip() for cell in line.strip("|").split("|")]
    assert cells[:4] == ["insert", "hand", "3", SHIPS]
    assert cells[4].startswith("2/3") and cells[6:] == ["6.0", "1", "1", "0.5, 4.0"]


def test_the_picture_names_every_method_and_every_task_and_is_the_same_each_time(
    tmp_path: Path,
) -> None:
    done = {
        job._replace(task=task): played
        for task in ("insert", "books")
        for name in (SHIPS, "cubic", "bare")
        for job, played in trials(name, GOOD, BAD if name == "bare" else GOOD).items()
    }
    for name in ("one.svg", "other.svg"):
        draw(compare(done), tmp_path / name)
    picture = (tmp_path / "one.svg").read_text(encoding="utf-8")
    assert all(f">{name}<" in picture for name in ("insert", "books", "cubic", "bare"))
    assert picture == (tmp_path / "other.svg").read_text(encoding="utf-8")


def test_a_trial_gives_the_points_of_its_result() -> None:
    played = play(JOB._replace(task="box-to-goal", solid="fingertips", seed=1))
    assert played.success and played.push == 0.0
    assert played.points == pytest.approx(100.0 - 50.0 * played.seconds / 30.0)
