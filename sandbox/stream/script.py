"""Builds the scripts for Maya and Blender: one file from several modules."""

from __future__ import annotations

import ast
from pathlib import Path

from models.errors import InputError

HERE = Path(__file__).parent
PARTS = {
    "maya": ("guest_math", "guest_line", "maya_side"),
    "blender": ("guest_math", "guest_line", "blender_rigs", "blender_side"),
}
"""Modules of each script; the docstring of the last one becomes that of the script."""


def script(program: str) -> str:
    """Returns the script for `maya` or `blender`, which needs no other files.

    Raises:
        InputError: The program is unknown.
    """
    if program not in PARTS:
        raise InputError(
            "no script for this program",
            where="--script",
            got=program,
            expected=", ".join(PARTS),
        )
    parts = [(HERE / f"{part}.py").read_text(encoding="utf-8") for part in PARTS[program]]
    docstring = ast.get_docstring(ast.parse(parts[-1]), clean=False) or ""
    head = f'"""{docstring}"""\n\nfrom __future__ import annotations\n'
    return head + "\n\n".join(_body(part) for part in parts)


def _body(source: str) -> str:
    """Returns a module without its docstring and its imports of this package."""
    lines: list[str | None] = list(source.splitlines())
    for node in ast.parse(source).body:
        ours = isinstance(node, ast.ImportFrom) and (node.module or "").partition(".")[0] in (
            "sandbox",
            "__future__",
        )
        docstring = node.lineno == 1 and isinstance(node, ast.Expr)
        if ours or docstring:
            lines[node.lineno - 1 : node.end_lineno] = [None] * (
                (node.end_lineno or node.lineno) - node.lineno + 1
            )
    kept = [line.replace("  # noqa: N818", "") for line in lines if line is not None]
    return "\n".join(kept).strip("\n") + "\n"
