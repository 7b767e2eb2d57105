"""Writes the protocol's types for the page: `python -m tools.page_types`.

A test checks that the written file and `sandbox.server.protocol` agree. So the page uses the same
version of the protocol as the server.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import msgspec.inspect as inspect
from msgspec import Struct

from models.frames import FINGERS
from sandbox.devices.mouse import mouse
from sandbox.server import protocol
from sandbox.server.page_frames import KIND, POSE_BYTES, SKIN_KIND

FILE = Path(__file__).resolve().parents[1] / "sandbox" / "views" / "page" / "src" / "protocol.ts"

_NUMBERS = ("LIFT_STRIP_PX", "LIFT_NOTCH", "LIFT_KEY", "LIFT_PAGE", "NOTCH_PX")
"""Numbers of the protocol that the page uses as well."""

_OF_MOUSE = ("GRAB_RADIUS", "WHEEL_FACTOR", "WHEEL_TURN", "NARROWEST", "WIDEST")
"""Numbers of the window's mouse device that the page uses as well."""

_SIMPLE: dict[type, str] = {
    inspect.IntType: "number",
    inspect.FloatType: "number",
    inspect.StrType: "string",
    inspect.BoolType: "boolean",
    inspect.NoneType: "null",
}


def typescript() -> str:
    """The text of the written file."""
    lines = [
        "// Written by `python -m tools.page_types` from sandbox/server/protocol.py.",
        "",
        f"export const PROTOCOL = {protocol.PROTOCOL};",
        f"export const FRAME_KIND = {KIND};",
        f"export const POSE_BYTES = {POSE_BYTES};",
        f"export const SKIN_KIND = {SKIN_KIND};",
        f"export const DEMONSTRATION_KIND = {protocol.DEMONSTRATION_KIND};",
        *(f"export const {name} = {getattr(protocol, name):g};" for name in _NUMBERS),
        *(f"export const {name} = {getattr(mouse, name):.6g};" for name in _OF_MOUSE),
        "/** Fingers of a right hand of one to five: label, and x and y (m) from its middle. */",
        f"export const HANDS: readonly (readonly [number, number, number])[][] = {_hands()};",
    ]
    for struct in vars(protocol).values():
        if isinstance(struct, type) and issubclass(struct, Struct) and struct is not Struct:
            lines += ["", *_interface(struct)]
    for name in ("Up", "Down"):
        members = " | ".join(s.__name__ for s in getattr(protocol, name).__args__)
        lines += ["", f"export type {name} = {members};"]
    return "\n".join(lines) + "\n"


def _hands() -> str:
    """Layouts of the default hands with one to five fingers, as a TypeScript array."""
    layouts = [mouse.default_hand(count) for count in range(1, len(FINGERS) + 1)]
    hands = [
        [f"[{label}, {x:.4f}, {y:.4f}]" for label, (x, y) in sorted(layout.items())]
        for layout in layouts
    ]
    return "[" + ", ".join(f"[{', '.join(fingers)}]" for fingers in hands) + "]"


def _interface(struct: type[Struct]) -> list[str]:
    info = inspect.type_info(struct)
    assert isinstance(info, inspect.StructType)
    doc = " ".join((struct.__doc__ or "").split())
    fields = [
        f"  {f.encode_name}{'' if f.required else '?'}: {_type(f.type)};" for f in info.fields
    ]
    if info.tag is not None:
        fields.insert(0, f'  {info.tag_field}: "{info.tag}";')
    return [f"/** {doc} */", f"export interface {struct.__name__} {{", *fields, "}"]


def _type(kind: Any) -> str:
    simple = _SIMPLE.get(type(kind))
    if simple:
        return simple
    match kind:
        case inspect.Metadata(extra=extra) if extra and "page" in extra:
            # This page sends fewer values than the server accepts from other programs.
            return str(extra["page"])
        case inspect.Metadata():
            return _type(kind.type)
        case inspect.LiteralType():
            return " | ".join(f'"{value}"' for value in kind.values)
        case inspect.UnionType():
            return " | ".join(_type(t) for t in kind.types)
        case inspect.ListType():
            return f"({_type(kind.item_type)})[]"
        case inspect.TupleType():
            return "[" + ", ".join(_type(t) for t in kind.item_types) + "]"
        case inspect.DictType():
            return f"Record<{_type(kind.key_type)}, {_type(kind.value_type)}>"
        case inspect.StructType():
            return str(kind.cls.__name__)
    raise TypeError(f"there is no type of the page for {kind}")


if __name__ == "__main__":
    FILE.parent.mkdir(parents=True, exist_ok=True)
    FILE.write_text(typescript())
    print(f"wrote {FILE}")
