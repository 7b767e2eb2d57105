"""Builds the site from the pages of docs/, with a reference of the public names.

    pip install -e ".[site]"
    python -m tools.docs.site                  # writes out/site/index.html
    python -m tools.docs.site --released       # also the sites of released versions, by tags
    python -m tools.docs.site --check          # lists what the owner of the project has to fill in

Pages are copied to a folder with the structure of the repository, so that links between them, and
to examples and sources, are valid on the site as well. Pages of tasks and of public names are made
from the program itself. A broken link, a page that is not in the menu, and a docstring that cannot
be parsed are errors.
"""

from __future__ import annotations

import argparse
import importlib
import os
import re
import shutil
import subprocess
import sys
import tomllib
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory

from tools.docs.owner import settings, to_fill_in, with_address
from tools.docs.versions import build_released, released

ROOT = Path(__file__).resolve().parents[2]
SITE = ROOT / "docs" / "site"
PACKAGES = ("models", "encoders", "tasks", "sandbox")
"""Packages with a page for their public names."""

TOP = ("README.md", "CHANGELOG.md", "CONTRIBUTING.md", "LICENSE", "CITATION.cff", "Containerfile")
"""Files in the top folder of the repository that are pages, or to which pages link."""

LINK = re.compile(r"\]\(((?:\.\./)+(?:models|encoders|tasks|sandbox|tools|benchmarks)/[^)#\s]+)")
"""Links to sources, relative to the page."""

NAMED = re.compile(r"\[[\w./-]+\.md\](?=\((?!https?:))")
"""Links to pages that show the name of the page's file."""

ARRAYS = """`Array` is a NumPy array of 64-bit numbers (float64); the texts give its shape and unit.
A default of `...` means that a new object is created for each call."""
"""Explanation of signatures in the reference."""

NEEDED = ("sphinx", "furo", "myst_parser", "sphinx_copybutton", "sphinx_design", "gymnasium")
"""Packages of the extra `site`."""

FIRST = """# {title}

```{{image}} docs/pictures/demo.webp
:alt: The simulated user drags a box to its goal by touching
```

Touch a tablet, and a simulated hand of 48 degrees of freedom follows your fingers: the program
tells which finger is which from the touch points alone, reconstructs the whole hand, and a MuJoCo
hand with force-limited servos moves boxes and wrenches. *The touches of the film are the simulated
user's; no person took part.*

"""


def stage(folder: Path) -> None:
    """Copies all pages and the files to which they link into a folder, and writes menu and
    reference.

    Args:
        folder: An empty folder.
    """
    for name in TOP:
        shutil.copy(ROOT / name, folder / name)
    shutil.copytree(ROOT / "docs", folder / "docs", ignore=shutil.ignore_patterns(SITE.name))
    not_source = shutil.ignore_patterns("__pycache__", "build", "*.egg-info")
    shutil.copytree(ROOT / "examples", folder / "examples", ignore=not_source)
    (folder / "training").mkdir()
    shutil.copy(ROOT / "training" / "README.md", folder / "training" / "README.md")
    for page in sorted((folder / "docs").rglob("*.md")):
        for link in LINK.findall(page.read_text(encoding="utf-8")):
            path = (page.parent / link).resolve().relative_to(folder.resolve())
            (folder / path).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / path, folder / path)
    # Links show the titles of pages, and commands the address of the public repository.
    address = settings()["repository"]
    for page in (*folder.glob("*.md"), *(folder / "docs").rglob("*.md")):
        text = with_address(page.read_text(encoding="utf-8"), address)
        page.write_text(NAMED.sub("[]", text), encoding="utf-8")
    (folder / "api").mkdir()
    for package in PACKAGES:
        (folder / "api" / f"{package}.rst").write_text(reference(package), encoding="utf-8")
    # Imported here, since --check does not need the extra with the environments of the tasks.
    from tools.docs.task_pages import write_pages

    (folder / "index.md").write_text(first_page(folder, write_pages(folder)), encoding="utf-8")
    (folder / "docs" / "index.md").unlink()
    for name in ("README.md", "CONTRIBUTING.md"):
        page = folder / name
        text = page.read_text(encoding="utf-8").replace("](docs/index.md)", "](index.md)")
        page.write_text(text, encoding="utf-8")
    shutil.copy(SITE / "conf.py", folder / "conf.py")
    shutil.copytree(SITE / "templates", folder / "templates")
    shutil.copytree(SITE / "static", folder / "static")


def first_page(folder: Path, tasks: list[str]) -> str:
    """The first page: the list of purposes from docs/index.md, and the menu.

    Args:
        folder: Folder of the pages.
        tasks: Names of the pages of tasks.
    """
    wishes = (folder / "docs" / "index.md").read_text(encoding="utf-8")
    wishes = re.sub(r"\]\((?!https?:|\.\./|#)", "](docs/", wishes).replace("](../", "](")
    wishes = wishes.replace("# I want to ...", "## I want to ...", 1).replace("\n## ", "\n### ")
    first = FIRST.format(title=settings()["title"])
    return first + wishes.replace("### I want", "## I want", 1) + "\n" + menu(tasks)


def menu(tasks: list[str]) -> str:
    """Sphinx's trees of pages, one for each section. The tasks come before the last section."""
    sections = tomllib.loads((SITE / "navigation.toml").read_text(encoding="utf-8"))["section"]
    sections.insert(-1, {"title": "Tasks", "pages": tasks})
    trees = []
    for section in sections:
        pages = "\n".join(section["pages"])
        trees.append(f"```{{toctree}}\n:hidden:\n:caption: {section['title']}\n\n{pages}\n```\n")
    return "\n".join(trees)


def reference(package: str) -> str:
    """A page, in reStructuredText, with the public names of a package and their docstrings."""
    module = importlib.import_module(package)
    text = [*heading(package, "="), f".. automodule:: {package}", "   :no-members:", ""]
    text += [ARRAYS, ""]
    for name in sorted(module.__all__, key=str.lower):
        thing = getattr(module, name)
        kind = "autoclass" if isinstance(thing, type) else "autodata"
        if not isinstance(thing, type) and callable(thing):
            kind = "autofunction"
        text += [*heading(name, "-"), f".. {kind}:: {package}.{name}", ""]
    return "\n".join(text)


def heading(text: str, line: str) -> list[str]:
    """A heading in reStructuredText."""
    return [text, line * len(text), ""]


def build(out: Path, versions: list[str], newest: str = "") -> int:
    """Builds the site; returns the exit status of Sphinx.

    Args:
        out: Folder of the site. Its earlier contents are removed.
        versions: Released versions to which the menu links.
        newest: Path from this site to the site of the newest state; empty if this is the newest.
    """
    shutil.rmtree(out, ignore_errors=True)
    with TemporaryDirectory() as made:
        pages = Path(made)
        stage(pages)
        asked = [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", "-b", "html"]
        answer = subprocess.run(
            [*asked, str(pages), str(out)],
            env={
                **os.environ,
                "HAND_SANDBOX_SITE": str(SITE),
                "HAND_SANDBOX_VERSIONS": " ".join(versions),
                "HAND_SANDBOX_NEWEST": newest,
                "PYTHONPATH": str(ROOT),
            },
            check=False,
        )
    return answer.returncode


def main() -> int:
    """Builds the site, or lists the values that are to be filled in."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--out", type=Path, default=Path("out/site"), help="folder of the site")
    parser.add_argument("--released", action="store_true", help="also build released versions")
    parser.add_argument(
        "--versions", nargs="*", default=[], help="versions to which the menu links"
    )
    parser.add_argument("--newest", default="", help="path to the site of the newest state")
    parser.add_argument("--check", action="store_true", help="list the values to be filled in")
    options = parser.parse_args()
    if options.check:
        for line in to_fill_in():
            print(line)
        return 0
    if missing := [name for name in NEEDED if find_spec(name) is None]:
        print(f'missing {", ".join(missing)}: pip install -e ".[site]"', file=sys.stderr)
        return 2
    versions = released() if options.released else options.versions
    status = build(options.out, versions, options.newest)
    if options.released:
        status = status or build_released(options.out, versions)
    if not status:
        print(f"{options.out / 'index.html'} is the first page")
    return status


if __name__ == "__main__":
    sys.exit(main())
