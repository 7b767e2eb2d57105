"""Runs the notebook, and writes the notebook's page with its output.

    pip install -e ".[notebook]"
    python -m tools.docs.notebook              # writes docs/notebook.md and its pictures
    python -m tools.docs.notebook --check      # runs it, and compares its output with the page

Needs OpenGL for the film. The notebook itself is stored without outputs.
"""

from __future__ import annotations

import argparse
import base64
import difflib
import io
import re
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
NOTEBOOK = ROOT / "examples" / "notebook.ipynb"
PAGE = ROOT / "docs" / "notebook.md"
LONGEST = 600
"""Longest time (s) of a step."""
MOST_LINES = 24
"""Largest number of lines of a step's output that the page shows."""
WIDEST = 900
"""Largest width and height (px) of a picture on the page."""

FILM_WIDTH = 400
"""Width (px) of the film on the page."""
EVERY = 2
"""The film on the page has every second frame."""
EXTRA = ("nbclient", "ipykernel", "matplotlib")
"""Packages of the extra `notebook`."""

_INLINE = re.compile(r'alt="([^"]*)" src="data:image/webp;base64,([^"]+)"')


def executed(folder: Path) -> Any:
    """The notebook with the outputs of its steps, run in a folder.

    Args:
        folder: Folder in which files are written.

    Raises:
        nbclient.exceptions.CellExecutionError: A step failed.
    """
    import nbformat
    from nbclient import NotebookClient

    notebook = nbformat.read(NOTEBOOK, as_version=4)
    client = NotebookClient(
        notebook,
        timeout=LONGEST,
        kernel_name="python3",
        # Only errors are shown, since the kernel warns about its connection to this process.
        extra_arguments=["--IPKernelApp.log_level=40"],
        resources={"metadata": {"path": str(folder)}},
    )
    client.execute()
    return notebook


def page(notebook: Any) -> tuple[str, list[bytes]]:
    """The page of an executed notebook, and its pictures as WebP.

    Args:
        notebook: What `executed` returned, or a notebook without outputs.
    """
    parts: list[str] = []
    pictures: list[bytes] = []
    heading = ""
    for cell in notebook.cells:
        if cell.cell_type == "markdown":
            parts.append(cell.source)
            heading = re.findall(r"^#+ (?:\d+\. )?(.*)$", cell.source, re.MULTILINE)[-1]
            continue
        parts.append(f"```python\n{cell.source}\n```")
        for output in cell.outputs:
            if shown := _picture(output):
                pictures.append(shown[1])
                name = f"pictures/notebook-{len(pictures)}.webp"
                parts.append(f"![{shown[0] or heading}]({name})")
            elif words := _text(output):
                parts.append(f"```text\n{words}\n```")
    intro = (
        "*[examples/notebook.ipynb](../examples/notebook.ipynb), with the output of `python -m "
        "tools.docs.notebook`. CI runs the notebook at every change.*"
    )
    title, _, rest = "\n\n".join(parts).partition("\n\n")
    return f"{title}\n\n{intro}\n\n{rest}\n", pictures


def _picture(output: Any) -> tuple[str, bytes] | None:
    """Alternative text and WebP of an output that is a picture; None for any other output."""
    data = output.get("data", {})
    if found := _INLINE.search(data.get("text/html", "")):
        return found[1], _smaller(base64.b64decode(found[2]))
    if "image/png" not in data:
        return None
    from PIL import Image

    with Image.open(io.BytesIO(base64.b64decode(data["image/png"]))) as picture:
        picture.thumbnail((WIDEST, WIDEST))
        out = io.BytesIO()
        picture.convert("RGB").save(out, "webp", quality=85)
    return "", out.getvalue()


def _smaller(film: bytes) -> bytes:
    """A film for the page: smaller, and with fewer frames."""
    from PIL import Image, ImageSequence

    frames = []
    times: list[int] = []
    with Image.open(io.BytesIO(film)) as opened:
        height = round(opened.height * FILM_WIDTH / opened.width)
        for i, frame in enumerate(ImageSequence.Iterator(opened)):
            frame.load()
            if i % EVERY:
                times[-1] += frame.info["duration"]
                continue
            frames.append(frame.convert("RGB").resize((FILM_WIDTH, height)))
            times.append(frame.info["duration"])
    out = io.BytesIO()
    frames[0].save(
        out, "webp", save_all=True, append_images=frames[1:], duration=times, loop=0, quality=60
    )
    return out.getvalue()


def _text(output: Any) -> str:
    """The first lines that a step prints; empty for outputs that are not printed text."""
    if output.output_type != "stream" or output.name != "stdout":
        return ""
    lines = str(output.text).rstrip().splitlines()
    more = [f"... {len(lines) - MOST_LINES} more lines"] if len(lines) > MOST_LINES else []
    return "\n".join([*lines[:MOST_LINES], *more])


def main() -> int:
    """Writes page and pictures, or compares the page; returns 1 if the page differs."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--check", action="store_true", help="write nothing, compare with the page")
    options = parser.parse_args()
    if missing := [name for name in EXTRA if find_spec(name) is None]:
        print(f'missing {", ".join(missing)}: pip install -e ".[notebook]"', file=sys.stderr)
        return 2
    with tempfile.TemporaryDirectory() as folder:
        text, pictures = page(executed(Path(folder)))
    if options.check:
        kept = PAGE.read_text(encoding="utf-8").splitlines()
        differences = list(
            difflib.unified_diff(kept, text.splitlines(), "page", "now", lineterm="")
        )
        print("\n".join(differences) or f"{PAGE.relative_to(ROOT)} is what the notebook shows")
        return int(bool(differences))
    PAGE.write_text(text, encoding="utf-8")
    for number, picture in enumerate(pictures, 1):
        (PAGE.parent / "pictures" / f"notebook-{number}.webp").write_bytes(picture)
    print(PAGE)
    return 0


if __name__ == "__main__":
    sys.exit(main())
