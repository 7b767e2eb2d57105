"""The house stands as drawn: which room may import which, and what no file may do.

Each rule on files is a function from a file to what is wrong with it. It runs over every file of
the repository, and over a few lines made to break it, so that a rule gone blind is noticed. Rules
on rooms are tried on small houses written to a folder.
"""

from __future__ import annotations

import ast
import io
import os
import re
import sys
import tokenize
import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cache, lru_cache
from importlib.metadata import packages_distributions
from pathlib import Path

import pytest

from tools.house import House, circles, python_files

ROOT = Path(__file__).resolve().parent.parent
PACKAGES = ("models", "encoders", "tasks", "sandbox")
MAY_IMPORT = {
    "models": {"models"},
    "encoders": {"models", "encoders"},
    "tasks": {"models", "tasks"},
    "sandbox": set(PACKAGES),
}
"""The arrows. Folders that are not listed (tests, benchmarks, examples) are judged below."""
MAY_RUN_THE_PROGRAM = {
    "sandbox",
    "tests",
    "benchmarks",
    "examples",
    "tools",
    "lerobot_teleoperator",
}
SHOWS_OR_SERVES = (
    "OpenGL",
    "glfw",
    "websockets",
    "matplotlib",
    "plotly",
    "moderngl",
    "pygame",
    "pyglet",
    "tkinter",
    "mujoco.viewer",
    "mujoco.renderer",
    "mujoco.gl_context",
    "mujoco.egl",
    "mujoco.glfw",
    "mujoco.osmesa",
)
"""Modules that open a window, a socket or a picture; only `sandbox` has business with them."""
MOST_FILES = 18
"""Python files in one folder, `__init__.py` aside."""
GUESTS = {
    "sandbox/stream/maya_side.py": {"maya", "__main__"},
    "sandbox/stream/blender_rigs.py": {"bpy", "mathutils"},
    "sandbox/stream/blender_side.py": {"bpy"},
}
"""Files that run inside other programs, and what these bring along."""
NOT_OURS = {"build", "dist", "out", "node_modules", "static", "__pycache__"}
"""Folders with built or fetched files."""
Rule = Callable[[str, str], Iterator[str]]


def files(*suffixes: str) -> list[Path]:
    """Every file of the repository with one of these suffixes, save what is built or fetched."""
    found = []
    for folder, inner, names in os.walk(ROOT):
        inner[:] = [n for n in inner if n not in NOT_OURS and not n.startswith(".")]
        found += [Path(folder, name) for name in names if name.endswith(suffixes)]
    return sorted(found)


@lru_cache(maxsize=2)
def nodes(source: str) -> list[ast.AST]:
    """All nodes of a file's syntax tree. It is kept while one rule after another reads the file."""
    return list(ast.walk(ast.parse(source)))


def name_of(node: ast.expr) -> str:
    """'a.b.c' for an attribute chain, the last name of any other callee."""
    if isinstance(node, ast.Attribute):
        return f"{name_of(node.value)}.{node.attr}"
    return node.id if isinstance(node, ast.Name) else ""


def text_of(node: ast.expr) -> str:
    """A string literal, or what an f-string begins with."""
    if isinstance(node, ast.JoinedStr) and node.values:
        node = node.values[0]
    return node.value if isinstance(node, ast.Constant) and isinstance(node.value, str) else ""


def imports(path: str, source: str) -> Iterator[tuple[int, str]]:
    """(line, dotted module) of every import, inside functions and by name as well."""
    package = Path(path).parent.parts
    for node in nodes(source):
        if isinstance(node, ast.Import):
            yield from ((node.lineno, alias.name) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            above = package[: len(package) - node.level + 1] if node.level else ()
            module = ".".join([*above, *filter(None, [node.module])])
            yield node.lineno, module
            yield from ((node.lineno, f"{module}.{alias.name}") for alias in node.names)
        elif (
            isinstance(node, ast.Call)
            and node.args
            and name_of(node.func).split(".")[-1] in ("import_module", "__import__")
        ):
            yield node.lineno, text_of(node.args[0])


def arrows_point_down(path: str, source: str) -> Iterator[str]:
    room = Path(path).parts[0]
    for line, module in imports(path, source):
        target = module.partition(".")[0]
        if target in PACKAGES and target not in MAY_IMPORT.get(room, PACKAGES):
            yield f"{path}:{line} imports {module}, and {room} may not know {target}"
        elif target == "sandbox" and room not in MAY_RUN_THE_PROGRAM:
            yield f"{path}:{line} imports {module}, and only the program knows the program"


def commands_are_on_top(path: str, source: str) -> Iterator[str]:
    above = "sandbox/cli/", "sandbox/__main__.py"
    if Path(path).parts[0] not in PACKAGES or path.startswith(above):
        return
    for line, module in imports(path, source):
        if f"{module}.".startswith("sandbox.cli."):
            yield f"{path}:{line} imports {module}, and only commands know commands"


def only_the_program_shows_and_serves(path: str, source: str) -> Iterator[str]:
    room = Path(path).parts[0]
    if room not in PACKAGES or room == "sandbox":
        return
    for line, module in imports(path, source):
        if any(f"{module}.".startswith(f"{name}.") for name in SHOWS_OR_SERVES):
            yield f"{path}:{line} imports {module} outside sandbox"


def nothing_is_swallowed(path: str, source: str) -> Iterator[str]:
    for node in nodes(source):
        if isinstance(node, ast.ExceptHandler):
            parts = ast.walk(node.type or ast.Name(""))
            caught = {name_of(part) for part in parts if isinstance(part, ast.expr)}
            if node.type is None:
                yield f"{path}:{node.lineno} catches everything without a name"
            elif all(
                isinstance(step, ast.Pass)
                or (isinstance(step, ast.Expr) and isinstance(step.value, ast.Constant))
                for step in node.body
            ):
                yield f"{path}:{node.lineno} catches an error and does nothing"
            elif caught & {"Exception", "BaseException"} and not any(
                isinstance(part, ast.Raise) or (isinstance(part, ast.Name) and part.id == node.name)
                for step in node.body
                for part in ast.walk(step)
            ):
                yield f"{path}:{node.lineno} catches every error and forgets which it was"
        elif (
            isinstance(node, ast.Call)
            and name_of(node.func).split(".")[-1] == "suppress"
            and {name_of(a) for a in node.args} & {"Exception", "BaseException"}
        ):
            yield f"{path}:{node.lineno} suppresses every error"


LATER = re.compile("TODO|FIXME|XXX")
"""Words that leave work for later in a comment."""


def nothing_is_left_undone(path: str, source: str) -> Iterator[str]:
    for node in nodes(source):
        if isinstance(node, ast.Raise) and node.exc is not None:
            raised = node.exc.func if isinstance(node.exc, ast.Call) else node.exc
            if name_of(raised) == "NotImplementedError":
                yield f"{path}:{node.lineno} is not implemented"
    if not LATER.search(source):
        return
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type == tokenize.COMMENT and LATER.search(token.string):
            yield f"{path}:{token.start[0]} leaves work for later"


def ruff_decides_the_layout(path: str, source: str) -> Iterator[str]:
    if "fmt:" not in source:
        return
    for token in tokenize.generate_tokens(io.StringIO(source).readline):
        if token.type == tokenize.COMMENT and re.match(r"# fmt: (skip|off)", token.string):
            yield f"{path}:{token.start[0]} keeps ruff from the layout"


CONTRACTS = {"device", "task", "reconstructor", "rig", "session", "inner", "part"}
"""Names of objects whose contract declares all they can do: nobody needs to ask them."""


def subject_of(node: ast.expr) -> str:
    """The name of what an expression is about: `task` for `task`, `rig.task` and `type(task)`."""
    while isinstance(node, ast.Call) and node.args:
        node = node.args[0]
    while isinstance(node, ast.Subscript):
        node = node.value
    return name_of(node).split(".")[-1]


def nobody_is_asked_what_they_can_do(path: str, source: str) -> Iterator[str]:
    if Path(path).parts[0] not in PACKAGES:
        return
    for node in nodes(source):
        if (
            isinstance(node, ast.Call)
            and node.args
            and name_of(node.func) in ("getattr", "hasattr", "vars")
        ):
            words = subject_of(node.args[0]).strip("_").removesuffix("s").split("_")
            if words[-1] in CONTRACTS:
                yield f"{path}:{node.lineno} asks a {words[-1]}, whose contract says what it can do"
        elif isinstance(node, ast.ClassDef) and any(
            isinstance(base, ast.Name) and base.id.endswith(("Device", "Wrapper", "Reconstructor"))
            for base in node.bases
        ):
            for part in node.body:
                if isinstance(part, ast.FunctionDef) and part.name == "__getattr__":
                    yield f"{path}:{part.lineno} forwards members that no contract declares"


def canonical(name: str) -> str:
    """A distribution's name as package indexes compare it."""
    return re.sub(r"[-_.]+", "-", name).lower()


@cache
def declared() -> set[str]:
    """Distributions that pyproject.toml asks for, with and without extras."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = project["optional-dependencies"].values()
    asked = [*project["dependencies"], *(r for extra in extras for r in extra)]
    return {canonical(re.split(r"[^\w.-]", requirement)[0]) for requirement in asked}


@cache
def providers() -> Mapping[str, list[str]]:
    """Installed distributions by the modules that they bring."""
    return packages_distributions()


def imports_are_declared(path: str, source: str) -> Iterator[str]:
    """Whatever another package happens to bring along may be gone with its next release."""
    if Path(path).parts[0] not in PACKAGES:
        return
    own = {*PACKAGES, *sys.stdlib_module_names, *GUESTS.get(path, ())}
    for line, module in imports(path, source):
        top = module.partition(".")[0]
        names = {canonical(name) for name in providers().get(top, [top])}
        if top and top not in own and not names & declared():
            yield f"{path}:{line} imports {module}, which pyproject.toml does not declare"


RULES: tuple[Rule, ...] = (
    imports_are_declared,
    nobody_is_asked_what_they_can_do,
    arrows_point_down,
    commands_are_on_top,
    only_the_program_shows_and_serves,
    nothing_is_swallowed,
    nothing_is_left_undone,
    ruff_decides_the_layout,
)

BROKEN = [
    (imports_are_declared, "sandbox/a.py", "def f():\n    import a_guest"),
    (nobody_is_asked_what_they_can_do, "sandbox/a.py", "getattr(device, 'news', None)"),
    (nobody_is_asked_what_they_can_do, "sandbox/a.py", "hasattr(session.rigs[0].device, 'show')"),
    (nobody_is_asked_what_they_can_do, "sandbox/a.py", "hasattr(self._rigs[0], 'yaw')"),
    (nobody_is_asked_what_they_can_do, "sandbox/a.py", "vars(device).get('device')"),
    (nobody_is_asked_what_they_can_do, "sandbox/a.py", "getattr(type(task), 'user', None)"),
    (nobody_is_asked_what_they_can_do, "encoders/a.py", "getattr(r.reconstructor, 'empty', 0)"),
    (
        nobody_is_asked_what_they_can_do,
        "sandbox/a.py",
        "class A(Device):\n    def __getattr__(self, name):\n        return 1",
    ),
    (arrows_point_down, "models/a.py", "import encoders.regression.polynomial"),
    (arrows_point_down, "models/motion/a.py", "def f():\n    from tasks import score"),
    (arrows_point_down, "encoders/a.py", "from tasks.score import Score"),
    (arrows_point_down, "tasks/a.py", "import importlib\nimportlib.import_module('encoders.pca')"),
    (arrows_point_down, "tasks/a.py", "__import__(f'sandbox.{name}')"),
    (arrows_point_down, "encoders/a.py", "if TYPE_CHECKING:\n    import sandbox"),
    (arrows_point_down, "docs/make.py", "from sandbox import session"),
    (commands_are_on_top, "sandbox/study/a.py", "from sandbox.cli.run import report_end"),
    (commands_are_on_top, "sandbox/a.py", "def f():\n    import sandbox.cli"),
    (only_the_program_shows_and_serves, "models/a.py", "from OpenGL import GL"),
    (only_the_program_shows_and_serves, "tasks/a.py", "def f():\n    import matplotlib.pyplot"),
    (only_the_program_shows_and_serves, "tasks/a.py", "from mujoco import viewer"),
    (nothing_is_swallowed, "a.py", "try:\n    f()\nexcept:\n    raise"),
    (nothing_is_swallowed, "a.py", "try:\n    f()\nexcept OSError:\n    pass"),
    (nothing_is_swallowed, "a.py", "try:\n    f()\nexcept OSError:\n    ..."),
    (nothing_is_swallowed, "a.py", "try:\n    f()\nexcept (OSError, Exception):\n    x = 1"),
    (nothing_is_swallowed, "a.py", "with contextlib.suppress(Exception):\n    f()"),
    (nothing_is_left_undone, "a.py", "def f():\n    raise NotImplementedError"),
    (nothing_is_left_undone, "a.py", "x = 1  # " + "TODO more"),
    (ruff_decides_the_layout, "a.py", "x = [1,2]  # " + "fmt: skip"),
]

SOUND = [
    (imports_are_declared, "sandbox/a.py", "import json, models\nfrom numpy import linalg"),
    (imports_are_declared, "sandbox/stream/blender_rigs.py", "import bpy"),
    (imports_are_declared, "tests/a.py", "import a_guest"),
    (nobody_is_asked_what_they_can_do, "sandbox/a.py", "getattr(options, 'device', None)"),
    (nobody_is_asked_what_they_can_do, "sandbox/a.py", "vars(self.person), device.news"),
    (nobody_is_asked_what_they_can_do, "tests/a.py", "hasattr(device, 'show')"),
    (arrows_point_down, "encoders/a.py", "from models.errors import EncoderError"),
    (arrows_point_down, "encoders/paalm/a.py", "from .. import polynomial\nfrom . import b"),
    (arrows_point_down, "sandbox/a.py", "import models, encoders, tasks"),
    (arrows_point_down, "tests/a.py", "import sandbox.session.session"),
    (commands_are_on_top, "sandbox/cli/a.py", "from sandbox.cli.run import report_end"),
    (commands_are_on_top, "sandbox/a.py", "from sandbox.client import cli"),
    (only_the_program_shows_and_serves, "models/a.py", "import mujoco\nimport glfwlike"),
    (only_the_program_shows_and_serves, "sandbox/views/a.py", "import glfw, OpenGL.GL"),
    (nothing_is_swallowed, "a.py", "try:\n    f()\nexcept Exception as error:\n    log(error)"),
    (nothing_is_swallowed, "a.py", "try:\n    f()\nexcept BaseException:\n    undo()\n    raise"),
    (nothing_is_swallowed, "a.py", "with suppress(FileNotFoundError):\n    f()"),
    (nothing_is_left_undone, "a.py", "TODO = 'in a name'\nraise ValueError"),
    (ruff_decides_the_layout, "a.py", "count = text.count('# fmt" + ": skip')"),
]


@pytest.fixture(scope="module")
def wrong_in_files() -> dict[Rule, list[str]]:
    """What is wrong with the repository's files, by rule. Each file is read once."""
    paths = files(".py")
    assert len(paths) >= len(PACKAGES), f"no files found under {ROOT}"
    wrong: dict[Rule, list[str]] = {rule: [] for rule in RULES}
    for path in paths:
        source = path.read_text(encoding="utf-8")
        for rule in RULES:
            wrong[rule] += rule(path.relative_to(ROOT).as_posix(), source)
    return wrong


@pytest.mark.parametrize("rule", RULES, ids=lambda rule: rule.__name__)
def test_every_file_of_the_repository_keeps_the_rule(
    rule: Rule, wrong_in_files: dict[Rule, list[str]]
) -> None:
    assert not wrong_in_files[rule], "\n".join(wrong_in_files[rule])


@pytest.mark.parametrize(("rule", "path", "source"), BROKEN)
def test_a_rule_sees_what_breaks_it(rule: Rule, path: str, source: str) -> None:
    assert list(rule(path, source))


@pytest.mark.parametrize(("rule", "path", "source"), SOUND)
def test_a_rule_leaves_sound_code_alone(rule: Rule, path: str, source: str) -> None:
    assert not list(rule(path, source))


def room_of(folder: str, rooms: Iterable[str]) -> str:
    """The room that a folder lies in: the longest listed name that it is or lies below."""
    inside = [r for r in rooms if folder == r or folder.startswith(f"{r}/")]
    return max(inside, key=len, default="")


def wrong_arrows(house: House, allowed: dict[str, list[str]]) -> list[str]:
    """Arrows between rooms that the table does not have, and those that only the table has."""
    wrong, seen = [], set()
    for module in house.modules.values():
        if module.is_face:
            continue
        room = room_of(module.folder, allowed)
        for target in sorted(house.arrows[module.name]):
            other = room_of(house.modules[target].folder, allowed)
            if room == other:
                continue
            seen.add((room, other))
            if other not in allowed.get(room, ()):
                wrong.append(f"{module.path} imports {target}: {room} may not import {other}")
    listed = {(room, other) for room, others in allowed.items() for other in others}
    return wrong + [f"no file of {a} imports {b} any more" for a, b in sorted(listed - seen)]


@pytest.fixture(scope="module")
def house() -> House:
    return House.of_repository()


def small_house(folder: Path, **sources: str) -> House:
    """A house of a few files; `models__a="..."` is models/a.py."""
    for name, source in sources.items():
        path = folder.joinpath(*name.split("__")).with_suffix(".py")
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(source)
    return House.of_repository(folder)


def test_arrows_between_rooms_are_those_of_the_table(house: House) -> None:
    allowed = tomllib.loads((ROOT / "tools" / "arrows.toml").read_text(encoding="utf-8"))
    wrong = wrong_arrows(house, allowed)
    assert not wrong, "\n".join(wrong)


def test_no_imports_go_round_in_a_circle(house: House) -> None:
    assert circles(house.arrows) == []
    assert circles(house.folder_arrows) == []


def test_no_folder_holds_more_files_than_a_reader_can_take_in(house: House) -> None:
    folders = dict(house.files_by_folder)
    for path in python_files("tests"):
        folders.setdefault(str(path.parent.relative_to(ROOT)), []).append(path.name)
    wrong = {name: len(files) for name, files in folders.items() if len(files) > MOST_FILES}
    assert not wrong


def test_an_arrow_that_is_not_in_the_table_is_seen(tmp_path: Path) -> None:
    built = small_house(
        tmp_path,
        models__a="",
        models__motion__b="from models import a",
        tasks__c="def f():\n    import models.motion.b",
    )
    assert wrong_arrows(built, {"models": [], "tasks": ["models"]}) == []
    table = {"models": [], "models/motion": ["models"], "tasks": []}
    assert wrong_arrows(built, table) == [
        "tasks/c.py imports models.motion.b: tasks may not import models/motion"
    ]
    table = {"models": ["tasks"], "tasks": ["models"]}
    assert wrong_arrows(built, table) == ["no file of models imports tasks any more"]


def test_a_circle_is_seen_between_modules_and_between_folders(tmp_path: Path) -> None:
    built = small_house(
        tmp_path,
        models__a="from models import b",
        models__b="from models.motion import c",
        models__motion__c="",
        models__motion__d="if TYPE_CHECKING:\n    from models.a import x",
    )
    assert circles(built.arrows) == []
    assert circles(built.folder_arrows) == [["models", "models/motion"]]
    built = small_house(tmp_path, models__motion__c="from models import a")
    assert circles(built.arrows) == [["models.a", "models.b", "models.motion.c"]]


@pytest.mark.parametrize("package", PACKAGES)
def test_every_package_tells_type_checkers_that_it_is_typed(package: str) -> None:
    assert (ROOT / package / "py.typed").is_file()
