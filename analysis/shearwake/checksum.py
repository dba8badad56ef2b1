# SPDX-License-Identifier: BSD-3-Clause
"""Verifies the checksums of case files and of JSON texts, see src/storage/checksum.

A case file ends in a line with the hash of all bytes before it. The last member of a JSON object is a hash of
its text.
"""
from __future__ import annotations

import json
import os
import re
from pathlib import Path
from typing import IO, Any

import h5py
import xxhash

from .inputs import open_self_contained, require_regular, text_of

LINE = re.compile(rb"shearwake checksum 1 XXH3-128 ([0-9a-f]{32}) of (\d{20}) bytes\n")
LINE_LENGTH = 30 + 32 + 4 + 20 + 7
MEMBER = re.compile(r',"checksum":"([0-9a-f]{16})"\}(\s*)$')
PIECE = 1 << 20


OPENED = 'another program has opened it for writing and changed it; open case files for reading only: h5py.File(path, "r")'


class Damaged(ValueError):
    """The content of the file does not match its checksum."""


def verify_case(path: str | os.PathLike[str]) -> None:
    """Reads a case file. Raises Damaged if it does not match its checksum, and OSError."""
    require_regular(Path(path))
    with open(path, "rb") as file:
        size, found = last_line(file)
        before = size - LINE_LENGTH
        is_opened = found is None
        if found is None:  # HDF5 removes the line when a program opens the file for writing
            found, before = recorded_line(path), size
        if found is None:
            raise Damaged(f"the checksum at its end is missing: it is truncated, or {OPENED}")
        covered = int(found[2])
        file.seek(min(covered, before))
        if covered > before or file.read(before - covered) not in (b"", b"\n"):
            changed = f": {'it is truncated' if covered > before else OPENED}" if is_opened or covered > before else ""
            raise Damaged(f"it has {before} bytes, but its checksum covers {covered} bytes{changed}")
        file.seek(0)
        hash_now, left = xxhash.xxh3_128(), covered
        while left > 0 and (piece := file.read(min(PIECE, left))):
            hash_now.update(piece)
            left -= len(piece)
    if hash_now.hexdigest().encode() != found[1]:
        raise Damaged(f"its bytes do not match its checksum{f': {OPENED}' if is_opened else ''}")


def with_line(content: bytes) -> bytes:
    """The content of a file, followed by its checksum."""
    return content + f"\nshearwake checksum 1 XXH3-128 {xxhash.xxh3_128(content).hexdigest()} of {len(content):020} bytes\n".encode()


def last_line(file: IO[bytes]) -> tuple[int, re.Match[bytes] | None]:
    """The size of a file, and its last line if that is a checksum."""
    size = file.seek(0, 2)
    file.seek(max(0, size - LINE_LENGTH))
    return size, LINE.fullmatch(file.read())


def has_line(path: str | os.PathLike[str]) -> bool:
    """Whether a case file ends in the line of a checksum for its size, which takes microseconds to read. Programs that change the file
    through HDF5 remove the line; other changes are found by verify_case() only. Raises OSError."""
    require_regular(Path(path))
    with open(path, "rb") as file:
        size, found = last_line(file)
    return found is not None and size - LINE_LENGTH - int(found[2]) in (0, 1)  # 1: a line break before the line


def recorded_line(path: str | os.PathLike[str]) -> re.Match[bytes] | None:
    """The last line of a case file according to the journals of its output folder; None if they do not contain it."""
    case, found = Path(path).absolute(), None
    for journal in sorted(case.parent.parent.glob("journal*.jsonl")):
        for text in text_of(journal, errors="surrogateescape").splitlines():
            if '"file_checksum"' not in text or case.stem not in text:
                continue
            try:
                entry = read_json(text)
            except ValueError:
                continue
            if entry.get("id") == case.stem:
                found = LINE.fullmatch(f"{entry.get('file_checksum')}\n".encode()) or found
    return found


def open_case(path: str | os.PathLike[str]) -> h5py.File:
    """Verifies a case file and opens it for reading. Raises Damaged and OSError."""
    verify_case(path)
    return open_self_contained(Path(path))


def sealed(value: Any, end: str = "\n", indent: int | None = None) -> str:
    """The JSON text of an object with its checksum, which covers the text and its `end`."""
    text = json.dumps(value, indent=indent)
    return f'{text[:-1]},"checksum":"{xxhash.xxh3_64((text + end).encode()).hexdigest()}"}}{end}'


def read_json(text: str) -> Any:
    """The object of a JSON text without its checksum. Raises Damaged if the checksum is missing or does not match, and
    ValueError if the text is not valid JSON."""
    found = MEMBER.search(text)
    if found is None:
        raise Damaged("its checksum is missing")
    plain = text[:found.start()] + "}" + found[2]
    if xxhash.xxh3_64(plain.encode("utf-8", "surrogateescape")).hexdigest() != found[1]:
        raise Damaged("it does not match its checksum")
    return json.loads(plain)
