"""Creates folders that appear only when they are complete, and never replace existing ones."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from models.errors import StudyError
from sandbox.study.record.files import TEMPORARY, make_folder, study_error
from sandbox.system.files import sync_folder


@contextmanager
def new_folder(out: Path) -> Iterator[Path]:
    """Creates a folder under a temporary name, and renames it when it has been filled.

    Args:
        out: Its final path, which must not exist.

    Raises:
        StudyError: The path exists, or the folder cannot be created.
    """
    refuse_existing(out)
    make_folder(out.parent)
    work = out.parent / f"{TEMPORARY}{os.getpid()}-{out.name}"
    try:
        shutil.rmtree(work, ignore_errors=True)
        work.mkdir()
        yield work
        refuse_existing(out)
        work.rename(out)
        sync_folder(out.parent)
    except OSError as error:
        raise study_error(error, out, "the folder cannot be written") from None
    finally:
        shutil.rmtree(work, ignore_errors=True)


def refuse_existing(out: Path) -> None:
    """Refuses to overwrite an existing file or folder.

    Raises:
        StudyError: The path exists.
    """
    if out.exists() or out.is_symlink():
        raise StudyError(
            "the path exists already, and nothing is overwritten",
            where=str(out),
            remedy="Choose another name with --out",
        )
