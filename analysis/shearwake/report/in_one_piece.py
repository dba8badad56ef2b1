# SPDX-License-Identifier: BSD-3-Clause
"""Folders whose files are replaced only when all of them are complete."""
import contextlib
import os
import shutil
import tempfile
from collections.abc import Iterable, Iterator
from pathlib import Path


def is_running(pid: int) -> bool:
    """Whether the process is running. A process that has ended and was not reaped is not."""
    try:
        os.kill(pid, 0)
        return Path(f"/proc/{pid}/stat").read_text(encoding="utf-8").rpartition(")")[2].split()[0] not in "ZX"
    except (ProcessLookupError, FileNotFoundError):
        return False
    except PermissionError:
        return True


def remove_abandoned(parent: Path, prefix: str) -> None:
    """Removes the temporary folders of processes that were killed."""
    for path in parent.glob(f"{prefix}*-*"):
        pid = path.name[len(prefix):].split("-")[0]
        if pid.isdigit() and not is_running(int(pid)):
            shutil.rmtree(path, ignore_errors=True)


@contextlib.contextmanager
def in_one_piece(folder: Path, patterns: Iterable[str], last: str) -> Iterator[Path]:
    """A temporary folder whose files replace those of `folder` when the block ends without an exception. Files of
    `folder` that match `patterns` and were not written again are removed. The file named `last` is replaced last."""
    parent, prefix = folder.parent, f".{folder.name}-"
    remove_abandoned(parent, prefix)
    part = Path(tempfile.mkdtemp(prefix=f"{prefix}{os.getpid()}-", dir=parent))
    try:
        yield part
        folder.mkdir(exist_ok=True)
        new = {path.name for path in part.iterdir()}
        mask = os.umask(0)
        os.umask(mask)
        for name in sorted(new, key=lambda name: name == last):
            (part / name).chmod(0o666 & ~mask)
            os.replace(part / name, folder / name)
        for pattern in patterns:
            for old in folder.glob(pattern):
                if old.name not in new:
                    old.unlink()
    finally:
        shutil.rmtree(part, ignore_errors=True)
