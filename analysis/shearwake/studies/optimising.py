# SPDX-License-Identifier: BSD-3-Clause
"""Searches for the best envelope of each case of a job with [optimise], and proves upper bounds.

The program computes the cases and quadratic forms that this module requests (`shearwake optimise` starts it).

Usage: python3 -m shearwake.studies.optimising --engine=N    the descriptor of the socket on which the program answers
"""
from __future__ import annotations

import ctypes
import multiprocessing
import os
import signal
import sys
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ..job import Job
from ..running import Progress
from ..sweep import Sweep
from .envelopes import Forms, Required, best_envelope
from .optimum import (MotionChange, OptimisedCase, Optimum, Sm, StudyError, change_in, changes_around, find_optimum, read_forms,
                      read_optimum)
from .optimum_files import table_for_terminal, write_atomically, write_table
from .results import Results
from .study import Moved, Program, Study

FIRST_STEP, LAST_STEP = 0.5, 0.05  # of the search over the motion
SM_STEPS = (1.0, 0.5, 0.25)


@dataclass
class MotionSearch:
    """The search of one case and strength: the best motion so far, and the distance of the motions that the next round tries."""

    case: OptimisedCase
    strength: float
    step: float = FIRST_STEP
    eta: float = 0.0
    best: MotionChange = MotionChange()
    tried: list[Moved] = field(default_factory=list)  # in this round

    def advance(self, reached: Sequence[float], is_around: bool) -> None:
        """Moves to the best of the tried motions, or halves the step if none around the best is better."""
        place = int(np.argmax(reached)) if len(reached) else -1
        if place >= 0 and reached[place] > self.eta:
            self.eta, self.best = reached[place], self.tried[place].change
        elif is_around:
            self.step *= 0.5


def best_eta(forms: Forms, required: Required, count: int) -> float:
    return best_envelope(forms, required, count).eta


def start_worker(parent: int) -> None:
    """Lets the kernel end a worker when the module ends (PR_SET_PDEATHSIG)."""
    ctypes.CDLL(None).prctl(1, signal.SIGTERM)
    if os.getppid() != parent:  # it had ended before
        os._exit(1)


class Search(Study):
    """The search of a study, whose evaluations are stored in its folder."""

    def run(self) -> None:
        self.require_this_study()
        with ProcessPoolExecutor(self.program.study["ranks"], multiprocessing.get_context("fork"), start_worker,
                                 (os.getpid(),)) as pool:
            self.begin("comparison with SM-STM")
            self.search_sm()
            known = self.known_optima()
            searches = [MotionSearch(case, strength) for case in self.cases for strength in self.options.strengths
                        if (case.number, strength) not in known]
            self.begin("quadratic forms" if searches else "quadratic forms: known")
            self.find_motions(searches, pool)
            self.begin(f"optima and bounds: {len(searches)} of {len(known) + len(searches)} to search")
            known |= self.find_optima(searches, pool)
        results = Results(self)
        found = [results.find(case, *known[case.number, strength]) for case in self.cases for strength in self.options.strengths]
        robust = results.robustness(found)
        rows = results.rows_of(found)
        text = table_for_terminal(rows)
        write_table(self.folder / "table", rows)
        if robust:
            write_table(self.folder / "robustness", robust)
        if not self.is_quiet:
            print(f"\n{self.options.maximise} of the modulations\n{text}\noptima: {self.folder / 'table.csv'}\n"
                  f"next: {self.program.study['next']}", flush=True)

    def compute_basis(self, moved: Sequence[Moved] = ()) -> None:
        """Computes the cases with which the optima are compared, and the forms of these motions."""
        cases = []
        for case in self.cases:
            cases.append(case.variant(readings_only=True, settings=[("optimise.part", "unmodulated")]))
            cases += [case.variant(readings_only=True, sm=vars(sm), settings=[
                ("optimise.part", f"SM-STM {sm.frequency_Hz:g} Hz, {sm.deviation_m_s:g} m/s, {sm.phase_rad:g} rad")])
                for sm in case.sm.values()]
        forms = [{**m.variant, "interval_s": m.case.interval_of(m.change)} for m in moved]
        title = "Basis of the optimisation of " + self.program.study["title"]
        self.basis |= self.compute("basis", title, ["optimise.part"], cases, forms=forms)

    def add_sm(self, case: OptimisedCase, candidates: Sequence[Sm]) -> bool:
        """Adds the SM-STM that are valid and not known; returns whether there are any."""
        before = len(case.sm)
        for sm, described in zip(candidates, self.describe([case.variant(readings_only=True, sm=vars(sm)) for sm in candidates])):
            if described is not None:
                case.sm.setdefault(described["id"], sm)
        return len(case.sm) > before

    def search_sm(self) -> None:
        plain = self.describe([case.variant(readings_only=True) for case in self.cases])
        for case, described in zip(self.cases, plain):
            assert described is not None  # the program has checked the job
            case.plain_id = described["id"]
            self.add_sm(case, case.first_sm(self.options))
        self.compute_basis()
        for step in SM_STEPS:
            is_refined = False
            for case in self.cases:
                centres = dict.fromkeys(self.best_sm(case, strength) for strength in self.options.strengths)
                around = [sm for id in centres if id for sm in case.sm_around(case.sm[id], step, self.options)]
                is_refined |= self.add_sm(case, around)
            if is_refined:
                self.compute_basis()

    def require_forms(self, moved: Sequence[Moved]) -> None:
        """Computes the forms that are not known. The strength refers to the motion of the job."""
        bases = [Moved(m.case, MotionChange(), {"id": m.case.id}) for m in moved]
        needed = {m.id: m for m in (*bases, *moved) if not self.forms_file(m.id).exists()}
        if needed:
            self.compute_basis(list(needed.values()))
        for m in (*bases, *moved):
            if m.id not in self.forms:
                reference = None if m.id == m.case.id else self.forms[m.case.id].reference
                self.forms[m.id] = read_forms(self.forms_file(m.id), m.case.knots, reference)

    def known_optima(self) -> dict[tuple[int, float], tuple[Moved, Optimum]]:
        """The stored optima by the number of their case and their strength."""
        stored = [(case, strength, path) for case in self.cases for strength in self.options.strengths
                  if (path := self.folder / (self.stem(case, strength) + ".json")).exists()]
        moved = self.moved([(case, change_in(path)) for case, _, path in stored])
        for m, (_, _, path) in zip(moved, stored):
            if m is None:
                raise StudyError(f"{path} is damaged: its motion is not that of a valid case; remove it, and rerun the command", 6)
        valid = [m for m in moved if m is not None]
        self.require_forms(valid)
        return {(case.number, strength): (m, read_optimum(path, case, strength, self.forms[case.id], self.forms[m.id]))
                for m, (case, strength, path) in zip(valid, stored)}

    def find_motions(self, searches: Sequence[MotionSearch], pool: ProcessPoolExecutor) -> None:
        """The best motion of each search. The first round tries the motion of the job, the second that of the best SM-STM, and the
        others those around the best so far."""
        rounds = 1 + self.options.rounds if len(self.options.over) > 1 else 0
        etas: dict[tuple[str, float], float] = {}
        for number in range(rounds + 1):
            active = [search for search in searches if search.step >= LAST_STEP]
            for search in active:
                changes = self.changes_of(search, number)
                search.tried = [m for m in self.moved([(search.case, change) for change in changes]) if m is not None]
            tried = [(m, search) for search in active for m in search.tried]
            if not tried:
                continue
            if rounds:
                self.report(f"      motions, round {number + 1} of at most {rounds + 1}: {len(tried)} to evaluate")
            self.require_forms([m for m, _ in tried])
            if not rounds:
                return
            new = list(dict.fromkeys((m.id, search.strength) for m, search in tried if (m.id, search.strength) not in etas))
            etas |= zip(new, pool.map(best_eta, [self.forms[id] for id, _ in new],
                                      [Required(strength, self.options.uniformity) for _, strength in new],
                                      [self.options.starts] * len(new)))
            for search in active:
                search.advance([etas[m.id, search.strength] for m in search.tried], number > 1)

    def changes_of(self, search: MotionSearch, number: int) -> list[MotionChange]:
        if number == 0:
            return [MotionChange()]
        if number > 1:
            return changes_around(search.best, search.step, self.options)
        sm = self.best_sm(search.case, search.strength) if "speed-profile" in self.options.over else None
        motion = search.case.motion_of(search.case.sm[sm]) if sm else None
        return [motion] if motion else []

    def find_optima(self, searches: Sequence[MotionSearch], pool: ProcessPoolExecutor) -> dict[tuple[int, float], tuple[Moved, Optimum]]:
        """Each optimum is stored as soon as it is found."""
        found, began = {}, time.monotonic()
        moved = self.moved([(search.case, search.best) for search in searches])
        futures = {pool.submit(find_optimum, search.case, self.forms[search.case.id], search.best, self.forms[m.id], search.strength,
                               self.options): (search, m) for search, m in zip(searches, moved) if m is not None}
        for number, future in enumerate(as_completed(futures), 1):
            (search, m), optimum = futures[future], future.result()
            write_atomically(self.folder / (self.stem(search.case, search.strength) + ".json"), optimum.text(search.case.id, m.id))
            found[search.case.number, search.strength] = m, optimum
            left_s = (time.monotonic() - began) * (len(futures) - number) / number
            self.report(f"      optimum {number} of {len(futures)}" + (f", about {left_s:.0f} s remain" if number < len(futures) else ""))
        return found


def optimise(job: Job | str | os.PathLike[str], *, out: str | os.PathLike[str] | None = None, ranks: int = 1,
             launch: Sequence[str] | None = None, progress: bool | Callable[[Progress], None] = False,
             options: Sequence[str] = ()) -> Sweep:
    """Finds the best modulation of each case of a job with [optimise], and opens the output folder; its `optima` is the table with the
    upper bounds. `out` is by default out/NAME.optimise. The other arguments and the exceptions are those of Job.run: if the call is
    interrupted, the same call resumes the study."""
    job = job if isinstance(job, Job) else Job(job)
    folder = Path(out) if out is not None else Path("out") / f"{job.name}.optimise"
    job.run_command("optimise", folder, ranks, progress, launch, options)
    return Sweep(folder)


def main(descriptor: str) -> int:
    program = Program(int(descriptor))
    try:
        Search(program).run()
    except StudyError as error:
        program.send("error", message=str(error), code=error.exit_code)
    except OSError as error:
        program.send("error", message=f"{error.filename or 'file'}: {error.strerror or error}", code=6)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1].partition("=")[2]))
