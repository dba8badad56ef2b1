# SPDX-License-Identifier: BSD-3-Clause
"""Verifies the checksums of case files and of JSON texts, see src/storage/checksum.

A case file ends in a line with the hash of all bytes before it. The last member of a JSON object is a hash of
its text. Files of earlier versions have neither and are accepted.
"""
from __future__ import annotations

import json
import os
import re
from typing import Any, Callable

import h5py
import xxhash

LINE = re.compile(rb"shearwake checksum 1 XXH3-128 ([0-9a-f]{32}) of (\d{20}) bytes\n")
LINE_LENGTH = 30 + 32 + 4 + 20 + 7
MEMBER = re.compile(r',"checksum":"([0-9a-f]{16})"\}(\s*)$')
PIECE = 1 << 20


class Damaged(ValueError):
    """The content of the file does not match its checksum."""


def verify(path: str | os.PathLike[str]) -> bool:
    """Returns whether the file has a checksum. Raises Damaged if the checksum does not match, and OSError if
    the file cannot be read."""
    with open(path, "rb") as file:
        size = file.seek(0, 2)
        file.seek(max(0, size - LINE_LENGTH))
        found = LINE.fullmatch(file.read())
        if found is None:
            return False
        covered, before = int(found[2]), size - LINE_LENGTH
        file.seek(min(covered, before))
        if covered > before or file.read(before - covered) not in (b"", b"\n"):
            raise Damaged(f"it has {before} bytes, but its checksum covers {covered} bytes")
        file.seek(0)
        hash_now, left = xxhash.xxh3_128(), covered
        while left > 0 and (piece := file.read(min(PIECE, left))):
            hash_now.update(piece)
            left -= len(piece)
    if hash_now.hexdigest().encode() != found[1]:
        raise Damaged("its bytes do not match its checksum")
    return True


def verify_case(path: str | os.PathLike[str]) -> bool:
    """Returns whether a case file has a checksum, which matches. Raises Damaged and OSError."""
    if verify(path):
        return True
    with h5py.File(path, "r") as file:
        if "checksum" in file.attrs:
            raise Damaged("it is damaged: the checksum at its end is missing")
    return False


def open_case(path: str | os.PathLike[str]) -> h5py.File:
    """Verifies a case file and opens it for reading. Raises Damaged and OSError."""
    verify_case(path)
    return h5py.File(path, "r")


def unsealed(text: str) -> tuple[Any, bool]:
    """The object of a JSON text without its checksum, and whether it had one. Raises Damaged if the checksum
    does not match, and ValueError if the text is not valid JSON."""
    found = MEMBER.search(text)
    if found is None:
        return json.loads(text), False
    plain = text[:found.start()] + "}" + found[2]
    if xxhash.xxh3_64(plain.encode("utf-8", "surrogateescape")).hexdigest() != found[1]:
        raise Damaged("it does not match its checksum")
    return json.loads(plain), True


def read_json(text: str, is_old: Callable[[Any], bool]) -> Any:
    """The object of a JSON text. A text without checksum is only accepted if `is_old(object)`, that is, if an
    earlier version wrote it."""
    value, sealed = unsealed(text)
    if not sealed and not is_old(value):
        raise Damaged("its checksum is missing")
    return value
