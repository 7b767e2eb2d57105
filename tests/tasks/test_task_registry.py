"""A task is imported when it is named, and no task knows of the registry."""

from __future__ import annotations

import json

from tasks.registry import TASKS, find_task
from tests.support.import_graph import import_graph
from tests.support.processes import printed

LOADED = """
import json, sys
from tasks.registry import TASKS, find_task, task_names
names = task_names()
before = set(sys.modules)
find_task("box-to-goal")
print(json.dumps([sorted(before), sorted(set(sys.modules) - before)]))
"""
OF_TASKS = {kind.__module__ for kind in TASKS.values()}


def test_a_task_that_is_named_is_the_only_one_that_is_imported() -> None:
    before, then = map(set, json.loads(printed("-c", LOADED)))
    assert not OF_TASKS & before
    assert OF_TASKS & then == {"tasks.box_to_goal"}


def test_every_name_in_the_registry_is_that_of_its_task() -> None:
    assert all(find_task(name).name == name for name in TASKS)


def test_no_task_and_nothing_that_it_imports_imports_the_registry() -> None:
    graph, waiting, found = import_graph(), list(OF_TASKS), set[str]()
    while waiting:
        module = waiting.pop()
        if module not in found:
            found.add(module)
            # The names of a package's own `__init__` are imported when they are used.
            waiting += [other for other in graph[module] if other not in ("tasks", "models")]
    assert "tasks.registry" not in found
