"""Links and paths in the documentation exist, and examples on its pages equal the files."""

from __future__ import annotations

import ast
import importlib
import inspect
import re
import tomllib
from pathlib import Path

import pytest

from models.objects import RED, Box, Cylinder
from models.surface import Surface
from tasks.box_to_goal import BoxToGoal
from tasks.task import Goal, place_surface

ROOT = Path(__file__).parents[1]
PAGES = sorted(
    [
        *ROOT.glob("*.md"),
        *(ROOT / "docs").rglob("*.md"),
        *(ROOT / "examples").rglob("*.md"),
        *(ROOT / "training").rglob("*.md"),
    ]
)
LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")
MODULE = re.compile(r"python -m ((?:benchmarks|sandbox|training)\.[\w.]*\w)")
FOLDERS = "benchmarks|docs|encoders|examples|models|sandbox|tasks|tests|training"
PATH = re.compile(rf"(?<![\w./-])((?:{FOLDERS})/[\w./-]*\.(?:md|npz|py|toml|ts|yml))\b")
CODE = re.compile(r"^```python\n(.*?)^```", re.M | re.S)
ELSEWHERE = ("https://", "http://", "mailto:")


def name(page: Path) -> str:
    return str(page.relative_to(ROOT))


def anchors(page: Path) -> set[str]:
    """The headings of a page, as links name them."""
    found = set()
    for heading in re.findall(r"^#+ (.*)$", page.read_text(encoding="utf-8"), re.M):
        text = re.sub(r"[`*]|\]\([^)]*\)|\[", "", heading).strip().lower()
        found.add(re.sub(r"[^\w\- ]", "", text).replace(" ", "-"))
    return found


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_every_link_within_the_repository_leads_somewhere(page: Path) -> None:
    astray = []
    for link in LINK.findall(page.read_text(encoding="utf-8")):
        if link.startswith(ELSEWHERE):
            continue
        file, _, anchor = link.partition("#")
        target = page.parent / file if file else page
        if not target.exists() or (anchor and anchor not in anchors(target)):
            astray.append(link)
    assert not astray


def test_the_menu_of_the_site_has_every_page_once() -> None:
    sections = tomllib.loads(
        (ROOT / "docs" / "site" / "navigation.toml").read_text(encoding="utf-8")
    )
    pages = [page for section in sections["section"] for page in section["pages"]]
    files = [re.sub(r".*<(.*)>", r"\1", page) for page in pages]
    assert len(set(files)) == len(files)
    listed = {ROOT / f"{file}.md" for file in files if not file.startswith("api/")}
    wanted = set((ROOT / "docs").rglob("*.md")) - {ROOT / "docs" / "index.md"}
    outside = ("README", "CHANGELOG", "CONTRIBUTING", "training/README")
    assert listed - {ROOT / f"{name}.md" for name in outside} == wanted


def test_the_index_leads_to_every_page_of_the_documentation() -> None:
    index = ROOT / "docs" / "index.md"
    listed = {
        (index.parent / link.partition("#")[0]).resolve()
        for link in LINK.findall(index.read_text(encoding="utf-8"))
        if not link.startswith(ELSEWHERE)
    }
    pages = set((ROOT / "docs").rglob("*.md")) - {index}
    missing = sorted(name(page) for page in pages - listed)
    assert not missing, f"docs/index.md has no link to {', '.join(missing)}"


def test_the_page_on_python_lists_the_public_names_of_each_package() -> None:
    text = (ROOT / "docs" / "from-python.md").read_text(encoding="utf-8")
    for package in ("models", "encoders", "tasks", "sandbox"):
        [row] = re.findall(rf"^\| `{package}` \| (.*) \|$", text, re.M)
        assert re.findall(r"`(\w+)`", row) == list(importlib.import_module(package).__all__)


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_every_file_and_module_that_a_page_names_exists(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    missing = [path for path in PATH.findall(text) if not (ROOT / path).exists()]
    for module in MODULE.findall(text):
        place = ROOT / module.replace(".", "/")
        if not (place.with_suffix(".py").exists() or (place / "__main__.py").exists()):
            missing.append(module)
    # Capital letters are to be filled in.
    assert not [m for m in missing if not re.search(r"\b[A-Z]{2,}\b", m)]


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_every_piece_of_python_can_be_read(page: Path) -> None:
    unreadable = []
    for code in CODE.findall(page.read_text(encoding="utf-8")):
        try:
            ast.parse(code, name(page))
        except SyntaxError as error:
            unreadable.append(str(error))
    assert not unreadable


@pytest.mark.parametrize(
    ("page", "example"),
    [
        ("docs/write-a-task.md", "examples/push_the_mug.py"),
        ("docs/write-a-device.md", "examples/circling_finger.py"),
        ("docs/write-an-encoder.md", "examples/kernel_ridge.py"),
    ],
)
def test_a_page_shows_the_whole_example_that_it_explains(page: str, example: str) -> None:
    shown = CODE.findall((ROOT / page).read_text(encoding="utf-8"))[0]
    kept = ast.parse((ROOT / example).read_text(encoding="utf-8"))
    # The file says besides how it is run.
    assert ast.get_docstring(kept)
    assert ast.dump(ast.parse(shown)) == ast.dump(ast.Module(kept.body[1:], kept.type_ignores))


def test_the_page_on_tasks_shows_the_user_of_its_example() -> None:
    shown = CODE.findall((ROOT / "docs" / "write-a-task.md").read_text(encoding="utf-8"))
    kept = ast.parse((ROOT / "examples" / "push_the_puck.py").read_text(encoding="utf-8"))

    def user(tree: ast.Module) -> list[str]:
        return [
            ast.dump(n) for n in tree.body if isinstance(n, ast.ClassDef) and "Finger" in n.name
        ]

    assert user(kept) == [dump for code in shown for dump in user(ast.parse(code))] != []


@pytest.mark.parametrize("kind", [Box, Cylinder, Goal])
def test_the_page_on_tasks_has_the_arguments_of_objects_and_goals(kind: type) -> None:
    given = [
        p.name if p.default is p.empty else f"{p.name}={'RED' if p.default is RED else p.default}"
        for p in inspect.signature(kind).parameters.values()
    ]
    text = (ROOT / "docs" / "write-a-task.md").read_text(encoding="utf-8")
    assert f"\n{kind.__name__}({', '.join(given)})\n" in text


def test_the_touch_surface_is_where_the_page_on_tasks_has_it() -> None:
    class Front(BoxToGoal):
        plane = "front"

    text = (ROOT / "docs" / "write-a-task.md").read_text(encoding="utf-8")
    flat, front = place_surface(Surface(), BoxToGoal), place_surface(Surface(), Front)
    (width, height), over = flat.size, BoxToGoal.touch_height
    right, far = width / 2, height / 2
    assert f"x = ±{right:.3f} and y = ±{far:.3f}" in text
    assert flat.to_world((0.0, 0.0)) == pytest.approx((-right, far, over))
    assert flat.to_world((width, height)) == pytest.approx((right, -far, over))
    assert front.to_world((0.0, height)) == pytest.approx((-right, -over, -0.015))
    assert "its lower edge 0.015 m below the table's top" in text
