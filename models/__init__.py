"""The physical world (hand, surface, scenes, objects) and the types that cross between packages.

The names in `__all__` are the public API; `docs/from-python.md` explains them. Every other module
may change without notice.
"""

from collections.abc import Callable, Mapping
from importlib import import_module
from typing import TYPE_CHECKING, Any


def lazy_names(package: str, places: Mapping[str, str]) -> Callable[[str], Any]:
    """A module's `__getattr__` (PEP 562) that imports public names when they are first used.

    Args:
        package: Dotted name of the package that offers the names.
        places: Public name -> dotted module that defines it.

    Returns:
        Gives the object of a public name, and raises AttributeError for any other name.
    """

    def look_up(name: str) -> Any:
        if name not in places:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        return getattr(import_module(places[name]), name)

    return look_up


if TYPE_CHECKING:
    from models.errors import DeviceError, HandSandboxError, InputError
    from models.frames import FINGERS, Contact, HandFrame, TouchFrame
    from models.kinematics import Kinematics
    from models.mechanism import Mechanism
    from models.mjcf_object import MjcfObject
    from models.objects import Box, Wrench
    from models.skeleton import ADULT, Skeleton
    from models.surface import Surface, parse_surface
else:
    __getattr__ = lazy_names(
        __name__,
        {
            "ADULT": "models.skeleton",
            "FINGERS": "models.frames",
            "Box": "models.objects",
            "Contact": "models.frames",
            "DeviceError": "models.errors",
            "HandFrame": "models.frames",
            "HandSandboxError": "models.errors",
            "InputError": "models.errors",
            "Kinematics": "models.kinematics",
            "Mechanism": "models.mechanism",
            "MjcfObject": "models.mjcf_object",
            "Skeleton": "models.skeleton",
            "Surface": "models.surface",
            "TouchFrame": "models.frames",
            "Wrench": "models.objects",
            "parse_surface": "models.surface",
        },
    )

__all__ = [
    "ADULT",
    "FINGERS",
    "Box",
    "Contact",
    "DeviceError",
    "HandFrame",
    "HandSandboxError",
    "InputError",
    "Kinematics",
    "Mechanism",
    "MjcfObject",
    "Skeleton",
    "Surface",
    "TouchFrame",
    "Wrench",
    "parse_surface",
]
