"""Renders the conda recipe, as rattler-build would before it builds.

    pip install -e ".[release]"
    python -m tools.release.conda

It says whether the recipe can be read, and what the package needs. Nothing is built, since that
takes a conda channel.
"""

from __future__ import annotations

import argparse
import sys
from importlib.util import find_spec
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
RECIPE = ROOT / "install" / "conda" / "recipe.yaml"


def main() -> int:
    """Prints the rendered recipe; 1 if it cannot be rendered, 2 if rattler-build is missing."""
    argparse.ArgumentParser(
        prog="python -m tools.release.conda",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    ).parse_args()
    if find_spec("rattler_build") is None:
        print('rattler-build is missing: pip install -e ".[release]"', file=sys.stderr)
        return 2
    from rattler_build import RattlerBuildError, Stage0Recipe

    try:
        variants = Stage0Recipe.from_file(RECIPE).render()
    except RattlerBuildError as error:
        print(f"{RECIPE}: {error}", file=sys.stderr)
        return 1
    for variant in variants:
        recipe = variant.recipe
        print(f"{recipe.package.name} {recipe.package.version}")
        for kind, needed in recipe.requirements.to_dict().items():
            print(f"  {kind}: {', '.join(needed)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
