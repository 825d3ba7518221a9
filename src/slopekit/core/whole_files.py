"""Files are written whole or not at all: beside their place first, and put there when all of them are complete."""

import errno
import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def whole_files(folder: Path, new: bool = False) -> Iterator[Path]:
    """Yield an empty folder inside `folder`, whose files replace those of `folder` once the block has ended.

    Where the block raises, `folder` stays as it was.

    Parameters
    ----------
    new : whether a file that is there already is left as it is, with FileExistsError

    Raises
    ------
    OSError
        Where a file cannot be written or put into its place.

    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as name, whole_files(Path(name)) as staging:
    ...     _ = (staging / "sheet.txt").write_text("FoS 1.5", encoding="utf-8")
    ...     (Path(name) / "sheet.txt").exists()
    False
    """
    import tempfile  # a plain run writes nothing

    staging = Path(tempfile.mkdtemp(prefix=".slopekit-", dir=folder))
    try:
        yield staging
        moves = [
            (file, folder / file.relative_to(staging))
            for file in sorted(staging.rglob("*"))
            if file.is_file()
        ]
        for _, target in moves:
            _refuse_unwritable(target, new)
        for file, target in moves:
            target.parent.mkdir(parents=True, exist_ok=True)
            if target.is_symlink() or (target.exists() and not target.is_file()):
                with whole_file(target) as real:
                    shutil.copyfile(file, real)
            else:
                _put(file, target, new)
    finally:
        shutil.rmtree(staging, ignore_errors=True)


@contextmanager
def whole_file(path: Path, new: bool = False) -> Iterator[Path]:
    """Yield the path of a file to write, which replaces the file `path` once the block has ended.

    A device or a pipe is written to as it is. See `whole_files`.
    """
    real = Path(os.path.realpath(path))
    if real.exists() and not real.is_file():
        yield real
        return
    with whole_files(real.parent, new) as staging:
        yield staging / real.name


def _refuse_unwritable(target: Path, new: bool) -> None:
    if new and os.path.lexists(target):
        raise FileExistsError(errno.EEXIST, "it is there already", str(target))
    if target.is_dir():
        raise IsADirectoryError(errno.EISDIR, "it is a folder", str(target))
    if target.exists() and not os.access(target, os.W_OK):
        raise PermissionError(errno.EACCES, "permission denied", str(target))


def _put(file: Path, target: Path, new: bool) -> None:
    """Rename a file to its place, with the permissions of the file that it replaces."""
    if new:
        try:
            os.link(
                file, target
            )  # unlike a rename it leaves a file alone that came in the meantime
        except FileExistsError:
            raise
        except OSError:  # a file system without links
            os.replace(file, target)
        return
    if target.exists():
        os.chmod(file, target.stat().st_mode & 0o7777)
    os.replace(file, target)
