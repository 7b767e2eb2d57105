"""Runs the steps of the container file in a bare root, where no container engine is at hand.

    python -m tools.release.container                        # builds, runs `sandbox doctor`
    python -m tools.release.container run stack --seed 3     # another command in it

Needs root and mmdebstrap, which makes the Debian that the file names. The steps are those of the
file: what is copied, run and set. The engine's own layers, network and user mapping are not tried.
"""

from __future__ import annotations

import argparse
import json
import re
import shlex
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory

from models.errors import HandSandboxError, InputError

ROOT = Path(__file__).resolve().parents[2]
FILE = ROOT / "install" / "container" / "Containerfile"
CERTIFICATES = Path("/etc/ssl/certs/ca-certificates.crt")
"""Certificates that this machine trusts, on its way to the package index."""
PLAIN = {"HOME": "/root", "PATH": "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin"}
"""Variables of a container that sets none."""


@dataclass
class Image:
    """State of the image while its steps are run.

    Attributes:
        root: Folder of the root file system.
        variables: Variables of its processes.
        user: Number, or name, of the user who runs them.
        folder: Working folder.
        entry, command: The program, and its default arguments.
    """

    root: Path
    variables: dict[str, str] = field(default_factory=lambda: dict(PLAIN))
    user: str = "root"
    folder: str = "/"
    entry: list[str] = field(default_factory=list)
    command: list[str] = field(default_factory=list)

    def run(self, words: list[str]) -> None:
        """Runs a program in the root, in a mount namespace of its own.

        Raises:
            InputError: It failed.
        """
        inside = shlex.join(["env", "-i", *(f"{k}={v}" for k, v in self.variables.items()), *words])
        script = (
            f"mount -t proc proc {shlex.quote(str(self.root))}/proc;"
            f"mount --rbind /dev {shlex.quote(str(self.root))}/dev;"
            f"exec chroot --userspec={self.user}:{self.user} {shlex.quote(str(self.root))} "
            f"sh -c {shlex.quote(f'cd {self.folder} && exec {inside}')}"
        )
        done = subprocess.run(["unshare", "--mount", "bash", "-euc", script], check=False)
        if done.returncode:
            raise InputError("a step failed", where=shlex.join(words)[:80], got=done.returncode)


def steps(text: str) -> Iterator[tuple[str, str]]:
    """The instructions of a container file, with lines that go on joined."""
    lines = [line for line in text.splitlines() if line.strip() and not line.startswith("#")]
    joined = re.sub(r" *\\\n *", " ", "\n".join(lines))
    for line in joined.splitlines():
        word, _, rest = line.strip().partition(" ")
        yield word, rest.strip()


def build(root: Path, text: str) -> Image:
    """Carries out all instructions of a container file.

    Args:
        root: An empty folder for the root file system.
        text: The container file.

    Raises:
        InputError: A step failed, or is of a kind that is not known here.
    """
    image = Image(root)
    for word, rest in steps(text):
        print(f"== {word} {rest}", flush=True)
        if word == "FROM":
            _debian(rest, root)
        elif word == "RUN":
            image.run(["sh", "-ec", rest])
        elif word == "COPY":
            source, target = rest.split()
            _copy(source, root / target.lstrip("/"))
        elif word == "ENV":
            name, _, value = rest.partition("=")
            image.variables[name] = value
        elif word == "USER":
            image.user = rest
        elif word == "WORKDIR":
            image.folder = rest
        elif word == "ENTRYPOINT":
            image.entry = json.loads(rest)
        elif word == "CMD":
            image.command = json.loads(rest)
        else:
            raise InputError("this instruction is not known here", where=FILE.name, got=word)
    return image


def _debian(name: str, root: Path) -> None:
    """Makes the Debian of an image such as debian:bookworm-slim, with this machine's network."""
    release = name.partition(":")[2].removesuffix("-slim")
    asked = ["mmdebstrap", "--quiet", "--variant=minbase", release, str(root)]
    if subprocess.run(asked, check=False).returncode:
        raise InputError("no root could be made", where="mmdebstrap", got=release)
    shutil.copy(Path("/etc/resolv.conf").resolve(), root / "etc/resolv.conf")
    # Not in the place of Debian's own certificates, which a step may install.
    shutil.copy(CERTIFICATES, root / "etc/host-certificates.crt")
    (root / "etc/pip.conf").write_text(
        "[global]\ncert = /etc/host-certificates.crt\n", encoding="utf-8"
    )


def _copy(source: str, target: Path) -> None:
    """Copies tracked files of the repository."""
    target.mkdir(parents=True, exist_ok=True)
    archive = subprocess.run(
        ["git", "archive", "HEAD", "--", source], cwd=ROOT, capture_output=True, check=True
    )
    subprocess.run(["tar", "-x", "-C", str(target)], input=archive.stdout, check=True)


def main() -> int:
    """Builds, and runs the program; 1 if a step fails, 2 if this machine cannot."""
    parser = argparse.ArgumentParser(
        prog="python -m tools.release.container",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument(
        "words", nargs=argparse.REMAINDER, help="arguments of the program; its own by default"
    )
    words = parser.parse_args().words
    lacking = [name for name in ("mmdebstrap", "unshare", "git") if shutil.which(name) is None]
    if lacking:
        print(f"container: {', '.join(lacking)} is missing", file=sys.stderr)
        return 2
    with TemporaryDirectory() as folder:
        began = time.monotonic()
        try:
            image = build(Path(folder) / "root", FILE.read_text(encoding="utf-8"))
            print(f"== built in {time.monotonic() - began:.0f} s", flush=True)
            image.run([*image.entry, *(words or image.command)])
        except HandSandboxError as error:
            print(f"container: {error}", file=sys.stderr)
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
