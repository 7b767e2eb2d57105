"""Builds the site from the pages of docs/, with a reference of the public names.

    pip install -e ".[site]"
    python -m tools.docs.site                  # writes out/site/index.html
    python -m tools.docs.site --check          # lists what the owner of the project has to fill in

Pages are copied to a folder where each has its place as in the repository, so that links between
them, and to examples and sources, hold on the site as they do here. A link that leads nowhere, a
page that the menu lacks, or a docstring that cannot be read, is an error.
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

ROOT = Path(__file__).resolve().parents[2]
SITE = ROOT / "site"
PACKAGES = ("models", "encoders", "tasks", "sandbox")
"""Packages whose public names have a page each."""

TOP = ("README.md", "CHANGELOG.md", "CONTRIBUTING.md", "LICENSE", "CITATION.cff")
"""Files of the repository's top folder that are pages, or that pages link to."""

LINK = re.compile(r"\]\(((?:\.\./)+(?:models|encoders|tasks|sandbox|tools|benchmarks)/[^)#\s]+)")
"""Links to sources, relative to the page."""

FIRST = """# {title}

```{{image}} docs/pictures/demo.webp
:alt: The simulated user drags a box to its goal by touching
```

Touch a tablet, and a simulated hand of 48 degrees of freedom follows your fingers: the program
tells which finger is which from the touch points alone, reconstructs the whole hand, and a MuJoCo
hand with force-limited servos moves boxes and wrenches. *The touches of the film are the simulated
user's; no person took part.*

"""


def to_fill_in() -> list[str]:
    """Names of the settings that still have their placeholder."""
    settings = tomllib.loads((SITE / "settings.toml").read_text(encoding="utf-8"))
    return [name for name, value in settings.items() if str(value).startswith("<")]


def stage(folder: Path) -> None:
    """Copies all pages and what they link to into a folder, and writes the menu and the reference.

    Args:
        folder: An empty folder.
    """
    for name in TOP:
        shutil.copy(ROOT / name, folder / name)
    for name in ("docs", "examples"):
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
    for page in sorted((folder / "docs").rglob("*.md")):
        for link in LINK.findall(page.read_text(encoding="utf-8")):
            path = (page.parent / link).resolve().relative_to(folder.resolve())
            (folder / path).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / path, folder / path)
    (folder / "api").mkdir()
    for package in PACKAGES:
        (folder / "api" / f"{package}.rst").write_text(reference(package), encoding="utf-8")
    (folder / "index.md").write_text(first_page(folder), encoding="utf-8")
    (folder / "docs" / "index.md").unlink()
    for name in ("README.md", "CONTRIBUTING.md"):
        page = folder / name
        text = page.read_text(encoding="utf-8").replace("](docs/index.md)", "](index.md)")
        page.write_text(text, encoding="utf-8")
    shutil.copy(SITE / "conf.py", folder / "conf.py")


def first_page(folder: Path) -> str:
    """The first page: what people want to do, as docs/index.md has it, and the menu."""
    wishes = (folder / "docs" / "index.md").read_text(encoding="utf-8")
    wishes = re.sub(r"\]\((?!https?:|\.\./|#)", "](docs/", wishes).replace("](../", "](")
    # Titles of pages in the place of their files' names.
    wishes = re.sub(r"\[[\w-]+\.md\]\(", "[](", wishes)
    wishes = wishes.replace("# I want to ...", "## I want to ...", 1).replace("\n## ", "\n### ")
    title = tomllib.loads((SITE / "settings.toml").read_text(encoding="utf-8"))["title"]
    return FIRST.format(title=title) + wishes.replace("### I want", "## I want", 1) + "\n" + menu()


def menu() -> str:
    """Sphinx's trees of pages, one a section."""
    sections = tomllib.loads((SITE / "navigation.toml").read_text(encoding="utf-8"))["section"]
    trees = []
    for section in sections:
        pages = "\n".join(section["pages"])
        trees.append(f"```{{toctree}}\n:hidden:\n:caption: {section['title']}\n\n{pages}\n```\n")
    return "\n".join(trees)


def reference(package: str) -> str:
    """A page, in reStructuredText, with the public names of a package and their docstrings."""
    module = importlib.import_module(package)
    text = [*heading(package, "="), f".. automodule:: {package}", "   :no-members:", ""]
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


def build(out: Path) -> int:
    """Builds the site; returns the exit status of Sphinx.

    Args:
        out: Folder of the site, which is written anew.
    """
    shutil.rmtree(out, ignore_errors=True)
    with TemporaryDirectory() as made:
        pages = Path(made)
        stage(pages)
        asked = [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", "-b", "html"]
        answer = subprocess.run(
            [*asked, str(pages), str(out)],
            env={**os.environ, "HAND_SANDBOX_SITE": str(SITE), "PYTHONPATH": str(ROOT)},
            check=False,
        )
    return answer.returncode


def main() -> int:
    """Builds the site, or says what is to be filled in."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--out", type=Path, default=Path("out/site"), help="folder of the site")
    parser.add_argument("--check", action="store_true", help="list settings to be filled in")
    options = parser.parse_args()
    if options.check:
        for name in to_fill_in():
            print(f"site/settings.toml: {name} is to be filled in")
        return 0
    if find_spec("sphinx") is None:
        print('Sphinx is missing: pip install -e ".[site]"', file=sys.stderr)
        return 2
    status = build(options.out)
    if not status:
        print(f"{options.out / 'index.html'} is the first page")
    return status


if __name__ == "__main__":
    sys.exit(main())
