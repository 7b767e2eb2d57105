"""What a release promises: recordings of it replay for good.

    python -m tools.release record 0.2.0         # records one trial of every kind, until it is out
    python -m tools.release check [0.2.0]        # replays them; status 1 if one does not hold
    python -m tools.release keep [--from v0.2.0] # keeps the models that releases name
    python -m tools.release ready                # what is left to be done before a version is out
    python -m tools.release out 0.2.0            # from now on its recordings are never made anew

Before a model that ships is trained anew, or after it with --from, `keep` copies the old one to
encoders/data/kept, which is in the wheel. A recording's header names its models by digest, and a
replay finds them there.
"""

from __future__ import annotations

import argparse
import sys
from dataclasses import replace

from models.errors import HandSandboxError
from tools.release.check import promised, verdict
from tools.release.keep import keep, keep_of, missing
from tools.release.ready import to_do
from tools.release.record import record
from tools.release.released import load, releases


def main() -> int:
    """Runs a command; 1 if something does not hold, 2 for bad input."""
    parser = argparse.ArgumentParser(
        prog="python -m tools.release",
        description=__doc__,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    commands = parser.add_subparsers(dest="command", required=True)
    recorder = commands.add_parser("record", help="record the trials of a version")
    recorder.add_argument("version")
    recorder.add_argument("--only", nargs="+", help="names of recordings; all others stay")
    checker = commands.add_parser("check", help="replay the recordings of releases")
    checker.add_argument("version", nargs="*")
    keeper = commands.add_parser("keep", help="keep the models that releases name")
    keeper.add_argument("--from", dest="revision", help="a tag or commit of this repository")
    commands.add_parser("ready", help="what is to be done before this version is out")
    out = commands.add_parser("out", help="the version is out")
    out.add_argument("version")
    options = parser.parse_args()
    try:
        if options.command == "record":
            record(options.version, only=options.only)
        elif options.command == "check":
            return _check(options.version)
        elif options.command == "keep":
            return _keep(options.revision)
        elif options.command == "ready":
            left = to_do()
            print("\n".join(left) or "nothing is left to be done")
            return int(bool(left))
        else:
            replace(load(options.version), candidate=False).write()
    except HandSandboxError as error:
        print(f"tools.release: {error}", file=sys.stderr)
        return 2
    return 0


def _check(versions: list[str]) -> int:
    failed = 0
    for release in [load(version) for version in versions] if versions else releases():
        state = "a candidate" if release.candidate else "out"
        print(f"{release.version} ({state}), {promised(release)}")
        for name in release.recordings:
            found = verdict(release, name)
            failed += not found.holds
            print(f"  {'holds' if found.holds else 'FAILS'}  {name}: {found.says}", flush=True)
    return int(failed > 0)


def _keep(revision: str | None) -> int:
    for model in keep_of(revision) if revision else keep():
        print(f"kept {model.name} ({model.kind}) as {model.digest}")
    lacking = missing()
    for digest, version in lacking.items():
        print(
            f"{version} names the model {digest}, which neither ships nor is kept: "
            f"python -m tools.release keep --from v{version}",
            file=sys.stderr,
        )
    return int(bool(lacking))


if __name__ == "__main__":
    sys.exit(main())
