"""Writes the protocol's types for the page: `python -m tools.page_types`.

A test holds the file and `sandbox.server.protocol` equal, so the page cannot speak another
version than the server does.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import msgspec.inspect as inspect
from msgspec import Struct

from sandbox.server import protocol
from sandbox.server.frames import KIND, POSE_BYTES, SKIN_KIND

FILE = Path(__file__).resolve().parents[1] / "sandbox" / "views" / "page" / "src" / "protocol.ts"

_NUMBERS = ("LIFT_STRIP_PX", "LIFT_NOTCH", "LIFT_KEY", "LIFT_PAGE", "NOTCH_PX")
"""Numbers of the protocol that the page uses as well."""

_SIMPLE: dict[type, str] = {
    inspect.IntType: "number",
    inspect.FloatType: "number",
    inspect.StrType: "string",
    inspect.BoolType: "boolean",
    inspect.NoneType: "null",
}


def typescript() -> str:
    """The whole file."""
    lines = [
        "// Written by `python -m tools.page_types` from sandbox/server/protocol.py.",
        "",
        f"export const PROTOCOL = {protocol.PROTOCOL};",
        f"export const FRAME_KIND = {KIND};",
        f"export const POSE_BYTES = {POSE_BYTES};",
        f"export const SKIN_KIND = {SKIN_KIND};",
        *(f"export const {name} = {getattr(protocol, name):g};" for name in _NUMBERS),
    ]
    for struct in vars(protocol).values():
        if isinstance(struct, type) and issubclass(struct, Struct) and struct is not Struct:
            lines += ["", *_interface(struct)]
    for name in ("Up", "Down"):
        members = " | ".join(s.__name__ for s in getattr(protocol, name).__args__)
        lines += ["", f"export type {name} = {members};"]
    return "\n".join(lines) + "\n"


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
    raise TypeError(f"the page's types do not know {kind}")


if __name__ == "__main__":
    FILE.parent.mkdir(parents=True, exist_ok=True)
    FILE.write_text(typescript())
    print(f"wrote {FILE}")
