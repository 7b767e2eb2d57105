"""Fixtures and rules for all tests: data beside the project, processes, and skips in CI.

With `CI=true` a skip fails the run, since a check that quietly stopped running looks like one that
passes. Two things a machine may honestly lack are let through, each only while it is lacking: the
recordings in `../shared/data` (`HAND_SANDBOX_DATA` overrides the place) and device nodes in /dev.

Whoever runs a folder of tests has them run in as many processes as there are processors, at most
four, a file in one of them, and in one process more where no browser is installed. A file or a test
that is named runs in the process that was started.
`-n 0` has everything in one process.
"""

from __future__ import annotations

import gc
import os
import re
import signal
from collections.abc import Callable, Generator, Iterator
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

import models  # noqa: F401  (before NumPy: it pins the BLAS kernel)
from tests.support.chromium import BINARY
from tests.support.needs import require

ROOT = Path(__file__).resolve().parent.parent
SYSTEM = ROOT / "tests" / "system"
DATA_ABSENT = "shared data absent"
NODE_ABSENT = "device node absent"
SLOW = "slow: runs with CI=true, or where its file is named"
NAMED = re.compile(r"\.py(::|$)")
"""What pytest was asked for is a file, or a test in it."""
MOST_PROCESSES = 4
EXAMPLES = 25
"""Examples of a hypothesis test that does not say itself how many."""
LONG = "long"
"""Hypothesis' profile of `.ci/run --full`."""
TIMES_LONGER = 10
"""Factor on a test's number of examples in that profile."""
# A shell's background job ignores Ctrl-C, and so would every program that a test presses it in.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)
# What somebody has set for terminals would change what programs print.
for _name in ("COLUMNS", "LINES", "FORCE_COLOR", "NO_COLOR", "PYTHONUNBUFFERED", "TTY_COMPATIBLE"):
    os.environ.pop(_name, None)
IN_CI = os.environ.get("CI", "").lower() in ("true", "1")

# No deadlines, because a busy machine must not fail a test. The seed is fixed, so that a test that
# passes here passes for a stranger, too; new examples are searched for with the profile below.
settings.register_profile(
    "hand-sandbox",
    max_examples=EXAMPLES,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.too_slow],
)
# Searches long, from the seed that pytest's --hypothesis-seed gives; CONTRIBUTING.md says how.
settings.register_profile(
    LONG,
    settings.get_profile("hand-sandbox"),
    max_examples=100,
    derandomize=False,
    print_blob=True,
)
settings.load_profile("hand-sandbox")


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_auto_num_workers(config: pytest.Config) -> int:
    """Number of processes for `-n auto`; 0: this process alone."""
    here = config.invocation_params.dir
    if config.option.collectonly or not any((here / name).is_dir() for name in config.args):
        return 0
    can_count = hasattr(os, "sched_getaffinity")
    processors = len(os.sched_getaffinity(0)) if can_count else os.cpu_count() or 1
    if processors == 1:
        return 0
    # Some tests wait for servers and processes, and one more process computes meanwhile. Where a
    # browser is installed, this is busy enough.
    processors += not os.path.exists(BINARY)
    # Each of them has one processor: threads of linear algebra would only be in the others' way.
    for library in ("OMP", "OPENBLAS", "MKL"):
        os.environ.setdefault(f"{library}_NUM_THREADS", "1")
    return min(processors, MOST_PROCESSES)


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Puts tests of browsers, windows and processes first, leaves out those that are marked slow
    unless they are asked for, and gives examples to a long search.

    Tests that are put first wait, and their files have few tests: one of them at the end would
    keep one process busy while the others have nothing left to do.
    """
    items.sort(key=lambda item: SYSTEM not in item.path.parents)
    if not (IN_CI or any(NAMED.search(name) for name in config.args)):
        for item in items:
            if item.get_closest_marker("slow"):
                item.add_marker(pytest.mark.skip(reason=SLOW))
    if config.getoption("hypothesis_profile", None) == LONG:
        for test in {getattr(item, "function", None) for item in items}:
            _search_longer(test)


def pytest_collection_finish() -> None:
    """Takes the collected tests out of every later search for garbage: they stay to the end."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(5_000, 20, 20)


def _search_longer(test: object) -> None:
    """Multiplies the examples of a hypothesis test, also of one that says itself how many.

    Hypothesis has no public way to change the settings of a decorated test.
    """
    chosen = getattr(test, "_hypothesis_internal_use_settings", None)
    if chosen is not None:
        more = settings(chosen, max_examples=TIMES_LONGER * chosen.max_examples)
        setattr(test, "_hypothesis_internal_use_settings", more)  # noqa: B010


def data_folder() -> Path:
    """Where the recordings made by people outside this project are, or would be."""
    override = os.environ.get("HAND_SANDBOX_DATA")
    return Path(override) if override else ROOT.parent / "shared" / "data"


def usable(node: str) -> bool:
    """True if a device node exists and this process may read and write it."""
    return os.access(node, os.R_OK | os.W_OK)


def skip_is_honest(reason: str) -> bool:
    """True if a skip names one of the two things that may be absent, and it is absent."""
    text = reason.removeprefix("Skipped: ")
    if text.startswith(DATA_ABSENT):
        return not data_folder().is_dir()
    if text.startswith(NODE_ABSENT):
        node = text.removeprefix(NODE_ABSENT).lstrip(": ").split(" ")[0]
        return node.startswith("/dev/") and not usable(node)
    return False


def pytest_runtest_setup(item: pytest.Item) -> None:
    for mark in item.iter_markers("needs"):
        require(*mark.args)


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """The folder of recordings made outside this project; skips where it is absent."""
    folder = data_folder()
    if not folder.is_dir():
        pytest.skip(f"{DATA_ABSENT}: there is no folder {folder}")
    return folder


@pytest.fixture(scope="session")
def device_node() -> Callable[[str], Path]:
    """`device_node("/dev/uinput")` gives the node's path; skips where it cannot be used."""

    def find(node: str) -> Path:
        if not usable(node):
            pytest.skip(f"{NODE_ABSENT}: {node}")
        return Path(node)

    return find


def _fail_if_skipped(report: pytest.TestReport | pytest.CollectReport) -> None:
    if not (IN_CI and report.skipped) or hasattr(report, "wasxfail"):
        return
    reason = report.longrepr[2] if isinstance(report.longrepr, tuple) else str(report.longrepr)
    if not skip_is_honest(reason):
        report.outcome = "failed"
        report.longrepr = f"with CI=true a skipped test fails the run. {reason}"


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport() -> Generator[None, pytest.TestReport, pytest.TestReport]:
    report = yield
    _fail_if_skipped(report)
    return report


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report() -> Generator[None, pytest.CollectReport, pytest.CollectReport]:
    report = yield
    _fail_if_skipped(report)
    return report


@pytest.fixture
def as_without_nohup() -> Iterator[None]:
    """What a test starts hears that its terminal is closed, also where tests run under `nohup`."""
    if os.name == "nt":  # without SIGHUP
        yield
        return
    before = signal.signal(signal.SIGHUP, signal.SIG_DFL)
    yield
    signal.signal(signal.SIGHUP, before)
