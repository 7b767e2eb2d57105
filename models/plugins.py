"""Loads tasks, devices, encoders and measures by name: built-in ones, and those of other people.

A `PluginKind` is one kind of plug-in. Its registry contains the built-in plug-ins. External
plug-ins come from entry points of installed packages, from Python files and from modules. A plug-in
is imported only when its name is used. An error in the code of an external plug-in becomes one line
with its file and line number.
"""

from __future__ import annotations

import ast
import importlib
import importlib.util
import os
import re
import sys
import traceback
from collections.abc import Callable, Iterator, Mapping, MutableMapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from difflib import get_close_matches
from functools import cache
from hashlib import blake2b
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from types import ModuleType
from typing import Any, Generic, NamedTuple, TypeVar

from models.errors import HandSandboxError, InputError

T = TypeVar("T")

_FILE = re.compile(r"(?P<source>.+\.py)(:(?P<member>[A-Za-z_]\w*)(:(?P<argument>.*))?)?")
_MODULE = re.compile(
    r"(?P<source>[A-Za-z_]\w*(\.\w+)*):(?P<member>[A-Za-z_]\w*)(:(?P<argument>.*))?"
)


class Registry(MutableMapping[str, T]):
    """Built-in plug-ins by name; each is imported when it is looked up.

    Neither iteration nor `in` imports anything.

    Args:
        places: Name -> `MODULE:CLASS`, in the order in which they are listed.
    """

    def __init__(self, places: Mapping[str, str]) -> None:
        self._entries: dict[str, str | T] = dict(places)

    def __getitem__(self, name: str) -> T:
        entry = self._entries[name]
        if not isinstance(entry, str):
            return entry
        loaded: T = imported(entry)
        return loaded

    def __setitem__(self, name: str, plugin: T) -> None:
        self._entries[name] = plugin

    def __delitem__(self, name: str) -> None:
        del self._entries[name]

    def __contains__(self, name: object) -> bool:
        return name in self._entries

    def __iter__(self) -> Iterator[str]:
        return iter(self._entries)

    def __len__(self) -> int:
        return len(self._entries)


def imported(place: str) -> Any:
    """Imports the object at `MODULE:NAME`, a place in this program; errors pass unchanged."""
    module, _, member = place.partition(":")
    return getattr(importlib.import_module(module), member)


class Place(NamedTuple):
    """A place of code: `FILE.py[:CLASS[:ARGUMENT]]` or `MODULE:CLASS[:ARGUMENT]`.

    Attributes:
        source: Path of the file, or name of the module.
        member: Name of the class; None if a file is named alone.
        argument: Text after the class; None without it.
        in_file: True for a file.
    """

    source: str
    member: str | None
    argument: str | None
    in_file: bool

    @property
    def file(self) -> Path | None:
        """Absolute path of the file; None for a module."""
        return Path(self.source).resolve() if self.in_file else None

    def __str__(self) -> str:
        return f"{self.source}:{self.member}" if self.member else self.source


def place_in(text: str) -> Place | None:
    """The place that a text names; None if it has another form."""
    in_file = _FILE.fullmatch(text)
    match = in_file or _MODULE.fullmatch(text)
    if match is None:
        return None
    return Place(match["source"], match["member"], match["argument"], in_file is not None)


def place_file(text: str) -> Path | None:
    """Absolute path of the file of a place; None for a module or a name."""
    place = place_in(text)
    return place.file if place else None


class Plugin(NamedTuple):
    """A loaded plug-in, not checked yet.

    Attributes:
        value: Usually a class.
        where: Its place, for error messages.
        argument: Text after its name or place; empty without one.
    """

    value: Any
    where: str
    argument: str = ""


@dataclass(frozen=True)
class PluginKind(Generic[T]):
    """One kind of plug-in, and how it is found and loaded.

    Attributes:
        noun: Name of the kind, such as "task".
        group: Group of the entry points. The name of an entry point is the name of its plug-in.
        error: Class of the errors.
        registry: The built-in plug-ins; their names take precedence over those of packages.
        defines: True for a class of this kind. A file that defines a single such class can be named
            without the class. If `defines` is None, the class must be named.
        takes_argument: True if a name or a place may be followed by `:ARGUMENT`.
        article: "a" or "an".
        verb: Participle in the error for a plug-in that cannot be used: "loaded" or "opened".
    """

    noun: str
    group: str
    error: type[InputError]
    registry: Mapping[str, T] = field(default_factory=dict)
    defines: Callable[[Any], bool] | None = None
    takes_argument: bool = False
    article: str = "a"
    verb: str = "loaded"

    def find(self, text: str) -> Plugin | None:
        """Loads the plug-in that a text names; None if the text names none.

        Args:
            text: Name of a built-in plug-in or of one in an installed package, `FILE.py[:CLASS]` or
                `MODULE:CLASS`; perhaps with an argument (see `takes_argument`).

        Raises:
            InputError: The plug-in exists but cannot be loaded, or two packages offer it. Its class
                is `error`.
        """
        name, argument = text, ""
        if self.takes_argument:
            name, _, argument = text.partition(":")
        if name in self.registry:
            return Plugin(self.registry[name], name, argument)
        place = self.place_in(text)
        # `NAME:ARGUMENT` of a package and `MODULE:CLASS` look alike. The package takes precedence.
        if place is not None and (place.in_file or not self.takes_argument):
            return self.load(place)
        offered = self.from_package(name)
        if offered is not None:
            return offered._replace(argument=argument)
        return None if place is None else self.load(place)

    def place_in(self, text: str) -> Place | None:
        """The place that a text names, in the forms of this kind of plug-in; None for another
        text."""
        place = place_in(text)
        if place is None or not self.takes_argument:
            return place if place and place.argument is None else None
        # A class begins with a capital letter; text after the name of a built-in plug-in does not.
        member = place.member or ""
        return place if member and (place.in_file or "A" <= member[0] <= "Z") else None

    def names(self) -> tuple[str, ...]:
        """Names of the built-in plug-ins, then of those in packages; none is loaded."""
        return (*self.registry, *sorted(set(self.offered()) - set(self.registry)))

    def offered(self) -> dict[str, list[EntryPoint]]:
        """Entry points of installed packages by name; loads none of them."""
        entries: dict[str, list[EntryPoint]] = {}
        for entry in sorted(entry_points(group=self.group), key=lambda e: (e.name, e.value)):
            # A package that is on the path twice, as in a checkout, has every entry point twice.
            same = entries.setdefault(entry.name, [])
            if entry.value not in [e.value for e in same]:
                same.append(entry)
        return entries

    def from_package(self, name: str) -> Plugin | None:
        """Loads the plug-in that a package offers under a name; None if no package offers it.

        Raises:
            InputError: Two packages offer it, or loading it fails. The class of the error is
                `error`.
        """
        entries = self.offered().get(name, [])
        if not entries:
            return None
        if len(entries) > 1:
            raise self.error(
                f"several packages offer {self.article} {self.noun} of this name",
                where=name,
                got="; ".join(f"{e.value} of {package(e)}" for e in entries),
                remedy="Uninstall all but one, or name it by its place, "
                f"such as {entries[0].value}",
            )
        entry = entries[0]
        where = f"entry point {name} = {entry.value} of {package(entry)}"
        with self.guarded(where):
            return Plugin(entry.load(), where)

    def load(self, place: Place) -> Plugin:
        """Loads the plug-in at a place. If the place is a file alone, loads the only plug-in that
        the file defines.

        Raises:
            InputError: The file or the module does not exist, fails, or has nothing of this name.
                The class of the error is `error`.
        """
        module = self._module_of(place)
        names = self._names_in(module)
        listed = ", ".join(names) or f"no {self.noun}"
        member = place.member
        if member is None:
            if len(names) != 1:
                raise self.error(
                    f"the file does not define exactly one {self.noun}",
                    where=place.source,
                    got=listed,
                    expected=f"one {self.noun}, or {Path(place.source).name}:CLASS",
                    remedy=None if names else self._at_the_top,
                )
            member = names[0]
        with self.guarded(str(place)):
            value = getattr(module, member, None)
        if value is None:
            raise self.error(
                "the module has nothing of this name",
                where=str(place),
                got=member,
                expected=listed if names else None,
                remedy=self._at_the_top if self.defines and not names else None,
            )
        return Plugin(value, str(place), place.argument or "")

    def member_at(self, text: str) -> str:
        """Name of the variable of a plug-in in its file.

        It may differ from the name of the class itself, for example if a function made the class.

        Args:
            text: The place `FILE.py[:CLASS]` from which the plug-in was loaded.
        """
        place = place_in(text)
        assert place is not None and place.file is not None
        return place.member or self._names_in(load_file(place.file))[0]

    def package_of(self, value: type, name: str = "") -> dict[str, str]:
        """Origin of a class at the top of its module, in the form that headers of recordings
        contain.

        Args:
            value: The class.
            name: Name under which the class was found, such as that of an entry point.

        Returns:
            `entry_point` (`module:Class`), and `package` and `version` if an installed package
            offers the class.
        """
        place, offered = f"{value.__module__}:{value.__qualname__}", self.offered()
        entries = offered.get(name) or [
            entry for same in offered.values() for entry in same if entry.value == place
        ]
        dist = next((e.dist for e in entries if e.dist), None)
        source = {"entry_point": place}
        return {**source, "package": dist.name, "version": dist.version} if dist else source

    @contextmanager
    def guarded(self, where: str, problem: str = "") -> Iterator[None]:
        """Converts any error of external code to an error of class `error`, in one line.

        Args:
            where: Place of the external code.
            problem: The problem; by default that the plug-in cannot be loaded.
        """
        try:
            yield
        except HandSandboxError:
            raise
        except (Exception, SystemExit) as error:
            # A file that exits while it is read must not count as a file that was run.
            problem = problem or f"this {self.noun} cannot be {self.verb}"
            raise self.error(problem, where=where, got=failure(error)) from error

    @property
    def _at_the_top(self) -> str:
        """Next step for a person who named a file without a plug-in of this kind."""
        return (
            f"Define the {self.noun} as a class at the top of the file. A class that the file "
            "imports, or makes by a function, is named as FILE.py:NAME"
        )

    def _names_in(self, module: ModuleType) -> list[str]:
        """Names of the plug-ins of this kind that a module itself defines."""
        if self.defines is None:
            return []
        return [
            name
            for name, value in vars(module).items()
            if self.defines(value) and value.__module__ == module.__name__
        ]

    def _module_of(self, place: Place) -> ModuleType:
        path = place.file
        if path is None:
            with self.guarded(str(place)):
                return importlib.import_module(place.source)
        with self.guarded(place.source):
            # This check may raise, too: a folder on the path may belong to another user.
            if not path.is_file():
                raise self.error(
                    "no such file",
                    where=f"the {self.noun}'s file",
                    got=place.source,
                    remedy=_missing(path),
                )
            return load_file(path)


def _missing(path: Path) -> str:
    """Next step for a person who named a file that does not exist."""
    looked = f"It was looked for in {path.parent}"
    if not path.parent.is_dir():
        return f"{looked}, and there is no such folder"
    near = get_close_matches(path.name, [p.name for p in path.parent.glob("*.py")], 1)
    return f"{looked}. Did you mean {near[0]}?" if near else looked


def package(entry: EntryPoint) -> str:
    """Name and version of the package that offers an entry point."""
    return f"{entry.dist.name} {entry.dist.version}" if entry.dist else "an unnamed package"


def failure(error: BaseException) -> str:
    """One line about an error in external code: the error, with its file and line."""
    trace = traceback.extract_tb(error.__traceback__)
    text = f"{type(error).__name__}: {' '.join(str(error).split())[:300]}"
    # Lines of Python's import machinery, and of code that Python makes, do not help the reader.
    theirs = [step for step in trace if not step.filename.startswith("<")]
    if isinstance(error, SyntaxError | ImportError) or not theirs:
        return text
    # If external code called this program wrongly, the useful line is in the external code.
    last = ([step for step in theirs if not _is_ours(step.filename)] or theirs)[-1]
    return f"{text} ({last.filename}:{last.lineno})"


def _is_ours(file: str) -> bool:
    """True for a file of this program's four packages."""
    return any(file.startswith(folder) for folder in _OURS)


_OURS = tuple(
    f"{Path(__file__).resolve().parents[1] / package}{os.sep}"
    for package in ("models", "encoders", "tasks", "sandbox")
)


_FILES: dict[str, Path] = {}
"""Name of a module that `load_file` has made -> its file."""

_neighbours: dict[str, Path] = {}
"""Module that a loaded file has imported from its own folder -> that folder."""

_parts: dict[Path, tuple[Path, ...]] = {}
"""File that `load_file` has loaded -> files of the modules beside it that it uses."""


@contextmanager
def _importing_from(folder: Path) -> Iterator[set[str]]:
    """Lets `import NAME` find NAME.py in a folder, after everything else on Python's path.

    Yields a set. At the end it contains the names of the folder's modules that were imported.

    If two folders have modules of the same name, a file gets the module of its own folder. Python
    writes no bytecode meanwhile. If a file was changed within one second and its size is the same,
    Python would use the old bytecode, and so run other code than a recording stores."""
    for name, owner in list(_neighbours.items()):
        top = folder / name.partition(".")[0]
        if owner != folder and (_holds(folder, name) or top.is_dir()):
            sys.modules.pop(name, None)
            del _neighbours[name]
    before = set(sys.modules)
    sys.path.append(str(folder))
    importlib.invalidate_caches()
    written = sys.dont_write_bytecode
    sys.dont_write_bytecode = True
    imported: set[str] = set()
    try:
        yield imported
    finally:
        sys.dont_write_bytecode = written
        sys.path.remove(str(folder))
        new = set(sys.modules) - before
        imported.update(
            name for name in new if _holds(folder, name) or _is_in_plain_folder(folder, name)
        )
        _neighbours.update(dict.fromkeys(imported, folder))


def _holds(folder: Path, name: str) -> bool:
    """True if a folder holds the module or package of a dotted name."""
    top = folder / name.partition(".")[0]
    return top.with_suffix(".py").is_file() or (top / "__init__.py").is_file()


def _is_in_plain_folder(folder: Path, name: str) -> bool:
    """True if an imported module is in a package inside a folder that has no `__init__.py`."""
    both = name.partition(".")[0], name
    top, own = (getattr(sys.modules.get(module), "__dict__", {}) for module in both)
    places = [own["__file__"]] if own.get("__file__") else own.get("__path__", ())
    return not top.get("__file__") and any(Path(p).is_relative_to(folder) for p in places)


def files_of(file: Path) -> list[Path]:
    """A loaded file, and the files of the modules beside it that it has imported, in order.

    The result does not depend on which other files of the folder were loaded.

    Args:
        file: Absolute path of a file that `load_file` has loaded, or of a script.
    """
    return sorted({file, *_parts.get(file, ())})


def _taking_part(file: Path, imported: set[str]) -> tuple[Path, ...]:
    """Files of the modules that a file imports from its own folder, including those that another
    file imported first."""
    folder = file.parent
    names, looked = set(imported), set[str]()
    waiting = [*_names_imported(file, ""), *imported]
    while waiting:
        name = waiting.pop()
        module = sys.modules.get(name)
        if name in looked or _neighbours.get(name) != folder or module is None:
            continue
        looked.add(name)
        names.add(name)
        if module.__file__ and module.__file__.endswith(".py"):
            waiting += _names_imported(Path(module.__file__), module.__package__ or "")
    modules = [sys.modules.get(name) for name in names]
    return tuple(Path(m.__file__) for m in modules if m is not None and m.__file__)


def _names_imported(file: Path, package: str) -> set[str]:
    """Names of modules to which the import statements anywhere in a file may refer.

    Args:
        file: A Python file.
        package: Name of its package, for relative imports; empty without one.
    """
    names: set[str] = set()
    for node in ast.walk(ast.parse(file.read_bytes())):
        if isinstance(node, ast.Import):
            names.update(alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            parents = package.split(".")[: package.count(".") + 2 - node.level]
            base = ".".join([*(parents if node.level else []), *filter(None, [node.module])])
            names.add(base)
            names.update(f"{base}.{alias.name}" for alias in node.names)
    # A package runs before its modules do.
    return {
        ".".join(name.split(".")[: i + 1]) for name in names for i in range(name.count(".") + 1)
    }


@cache
def load_file(path: Path) -> ModuleType:
    """Loads a Python file as a module; its errors pass through unchanged.

    While the file runs, it can import modules that lie beside it.

    Args:
        path: Absolute path of a Python file.
    """
    # The name is unique, so that it hides no other module. The module is registered under it
    # because dataclasses look up their module by name.
    name = f"{path.stem}_{blake2b(str(path).encode(), digest_size=4).hexdigest()}"
    _FILES[name] = path
    spec = importlib.util.spec_from_file_location(name, path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    try:
        with _importing_from(path.parent) as imported:
            spec.loader.exec_module(module)
        _parts[path] = _taking_part(path, imported)
    except BaseException:
        del sys.modules[name]
        raise
    return module


def loaded_from(module: str) -> Path | None:
    """The file of a module that cannot be imported by name: a loaded file, or a script. None for
    any other module."""
    if module == "__main__":
        script = sys.modules[module].__dict__.get("__file__")
        return Path(script).resolve() if script else None
    return _FILES.get(module)


def place_of(source: Mapping[str, Any]) -> str:
    """`FILE.py:CLASS` or `MODULE:CLASS`, the place of a class that the header of a recording names.

    Args:
        source: `file` and `member`, or `entry_point`, perhaps with `package` and `version`.
    """
    if source.get("file"):
        return f"{source['file']}:{source.get('member', '')}"
    return str(source.get("entry_point", ""))


def how_to_get(source: Mapping[str, Any]) -> str:
    """Next step for a person who lacks a class: the package to install, or the file to provide.

    Args:
        source: See `place_of`.
    """
    if source.get("package"):
        return f"Install it: pip install '{source['package']}=={source.get('version')}'"
    if source.get("file"):
        return f"Put {Path(str(source['file'])).name} back where it was"
    module = str(source.get("entry_point", "")).partition(":")[0]
    return f"Put the module {module} on the path: PYTHONPATH=its folder"
