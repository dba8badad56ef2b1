# SPDX-License-Identifier: BSD-3-Clause
"""What a study of `shearwake optimise` asks the program for."""
from __future__ import annotations

import json
import math
import socket
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .envelopes import Forms
from .optimum import MotionChange, OptimisedCase, Options, StudyError, Variant
from .optimum_files import write_atomically


class Program:
    """The program that computes cases. It sends the description of the study first, and answers each request with a line."""

    def __init__(self, descriptor: int) -> None:
        self.stream = socket.socket(fileno=descriptor).makefile("rw", encoding="utf-8", newline="\n")
        self.study: dict[str, Any] = self.receive()

    def receive(self) -> Any:
        line = self.stream.readline()
        if not line.endswith("\n"):
            sys.exit(1)  # the program has ended
        return json.loads(line)

    def send(self, type: str, **members: Any) -> None:
        self.stream.write(json.dumps({"type": type, **members}) + "\n")
        self.stream.flush()

    def ask(self, type: str, **members: Any) -> Any:
        self.send(type, **members)
        return self.receive()


@dataclass(frozen=True)
class Reading:
    """What a computed case reached: the maximised measure, the focal rms in um and the uniformity; NaN: none. If it is not valid, a
    stored warning rules the readings out."""

    eta: float = math.nan
    focal_rms_um: float = math.nan
    is_valid: bool = True
    uniformity: float = math.nan


@dataclass(frozen=True)
class Moved:
    """An optimised case whose focus moves as in the job or as changed by the search; `described` is the answer of the program."""

    case: OptimisedCase
    change: MotionChange
    described: dict[str, Any]

    @property
    def id(self) -> str:
        return self.described["id"]

    @property
    def variant(self) -> Variant:
        return self.case.variant(self.change)


class Study:
    """A study: what the program describes, and what is known about it so far."""

    def __init__(self, program: Program) -> None:
        self.program, given = program, program.study
        self.options = Options(**given["options"])
        self.cases = [OptimisedCase(**case, number=number) for number, case in enumerate(given["cases"])]
        self.folder = Path(given["folder"]) / "optimise"
        self.is_quiet: bool = given["quiet"]
        self.basis: dict[str, Reading] = {}
        self.forms: dict[str, Forms] = {}
        self.stages = 5 if self.options.robust_to > 0.0 else 4
        self.stage = 0

    def begin(self, text: str) -> None:
        self.stage += 1
        self.report(f"[{self.stage}/{self.stages}] {text}")

    def report(self, text: str) -> None:
        if not self.is_quiet:
            print(text, file=sys.stderr, flush=True)

    def require_this_study(self) -> None:
        """Marks the folder of the study, or checks that an existing one belongs to it."""
        identity = self.options.identity + "".join(f"{id}\n" for id in self.program.study["ids"])
        path = self.folder / "study.txt"
        if not path.exists():
            write_atomically(path, identity)
        elif path.read_bytes() != identity.encode():
            raise StudyError(f"{self.folder} contains the optima of another job or of other options of [optimise]; choose another folder "
                             "with --out, or remove this one", 2)

    def compute(self, folder: str, title: str, keys: Sequence[str], cases: Sequence[Variant], **members: Any) -> list[tuple[str, Reading]]:
        """Computes cases, and returns their ids and readings."""
        answer = self.program.ask("compute", folder=folder, title=title, keys=keys, cases=cases, **members)
        return [(id, Reading(*(math.nan if value is None else value for value in answer["rows"][id]))) for id in answer["ids"]]

    def describe(self, variants: Sequence[Variant]) -> list[dict[str, Any] | None]:
        """The id and the motion of cases; None for those that are not valid."""
        return self.program.ask("cases", cases=variants) if variants else []

    def best_sm(self, case: OptimisedCase, strength: float) -> str | None:
        """The id of the SM-STM with the largest eta that meets the requirements."""
        plain = self.basis[case.plain_id].focal_rms_um
        met = [id for id in case.sm if (sm := self.basis.get(id, Reading())).eta > 0.0 and sm.focal_rms_um >= strength * plain
               and (not self.options.uniformity > 0.0 or sm.uniformity >= self.options.uniformity)]
        return max(met, key=lambda id: float(self.basis[id].eta)) if met else None

    def moved(self, requests: Sequence[tuple[OptimisedCase, MotionChange]]) -> list[Moved | None]:
        """None for motions that are not valid."""
        described = iter(self.describe([case.variant(change) for case, change in requests if change != MotionChange()]))
        found: list[Moved | None] = []
        for case, change in requests:
            answer: dict[str, Any] | None = {"id": case.id}
            if change != MotionChange():
                answer = next(described)
            found.append(None if answer is None else Moved(case, change, answer))
        return found

    def forms_file(self, id: str) -> Path:
        return self.folder / f"{id}.forms.json"

    def stem(self, case: OptimisedCase, strength: float) -> str:
        return f"{case.id}.strength-{strength:g}"
