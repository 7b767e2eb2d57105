"""The public names of the four packages: each is there, documented, and known to type checkers."""

from __future__ import annotations

import ast
import importlib
import inspect
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
PACKAGES = ("models", "encoders", "tasks", "sandbox")


@pytest.mark.parametrize("package", PACKAGES)
def test_every_public_name_can_be_imported_and_has_a_docstring(package: str) -> None:
    module = importlib.import_module(package)
    for name in module.__all__:
        thing = getattr(module, name)
        if inspect.isclass(thing) or inspect.isfunction(thing):
            assert inspect.getdoc(thing), f"{package}.{name}"


@pytest.mark.parametrize("package", PACKAGES)
def test_type_checkers_see_the_public_names_in_the_modules_that_they_come_from(
    package: str,
) -> None:
    """The TYPE_CHECKING block and the table of lazy names say the same, and `__all__` too."""
    tree = ast.parse((ROOT / package / "__init__.py").read_text(encoding="utf-8"))
    block = next(n for n in tree.body if isinstance(n, ast.If) and "TYPE_CHECKING" in ast.dump(n))
    typed = {
        alias.name: node.module
        for node in block.body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }
    [table] = [node for node in ast.walk(block) if isinstance(node, ast.Dict)]
    assert ast.literal_eval(table) == typed
    local = {n.name for n in tree.body if isinstance(n, ast.ClassDef)}
    assert set(importlib.import_module(package).__all__) == set(typed) | local


@pytest.mark.parametrize("package", PACKAGES)
def test_an_unknown_name_is_an_attribute_error(package: str) -> None:
    module = importlib.import_module(package)
    with pytest.raises(AttributeError, match=f"module '{package}' has no attribute 'nothing'"):
        _ = module.nothing
