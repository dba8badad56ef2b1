# SPDX-License-Identifier: BSD-3-Clause
"""Hostile files in place of results: case files with valid checksums, checkpoints and baselines."""
import itertools
import os
import random
import signal
import sys
import unittest

import h5py
import pytest

from attacks import ELSEWHERE, accepted_or_refused, attacks_on_hdf5, sampled, times
from program import ROOT, ProgramTest, case_files, command, seal
from test_checkpoint import STEPPED, checkpoint
from test_mutated_files import ONE_CASE, mutated

READ = f"""
import sys
import warnings
sys.path.insert(0, {str(ROOT / "analysis")!r})
import shearwake
import xarray
from shearwake.backend import Backend
warnings.simplefilter("ignore")
try:
    case = shearwake.open_case(sys.argv[1])
    print(case.groups, case.series.load(), case.traces.values, case.surface.values, case.focus, case.over_time)
    print(case.arrays("/"), xarray.open_dataset(sys.argv[1], engine=Backend, group="traces").load())
    shearwake.open(sys.argv[2]).dataset("eta_period_1").load()
except (OSError, ValueError, KeyError, shearwake.ShearwakeError) as error:
    print(ascii(str(error)))
    sys.exit(3)
"""


class HostileResults(ProgramTest):
    def read(self, call, about):
        said, _ = accepted_or_refused(self, call, (0, 2, 3, 4, 5, 6), about)
        self.assertNotIn("\x1b", said)
        self.assertNotIn("12345.6", said)
        return said

    def replaced(self, path, name):
        """The attacks on a dataset of a file, each of which has been made."""
        good = path.read_bytes()
        for kind, change in sampled(attacks_on_hdf5(self.folder), name, 2):
            path.write_bytes(good)
            with h5py.File(path, "r+") as file:
                shape = file[name].shape
                if kind != "name of control characters":
                    del file[name]
                change(file, name, shape)
            yield kind
        path.write_bytes(good)

    def test_case_files_with_valid_checksums(self):
        self.write_job(ONE_CASE)
        self.shearwake("run", "job.toml")
        path = case_files(self.out)[0]
        (self.folder / "good.h5").write_bytes(path.read_bytes())
        for name in ("traces/u_z", "eta_period_1", "surface/u_z", "time")[:times(1, 4)]:
            for kind in self.replaced(path, name):
                seal(path)
                for call in (command("show", path), command("compare", path, "good.h5"), command("reduce", self.out),
                             [sys.executable, "-c", READ, str(path), str(self.out)]):
                    with self.subTest(name=name, kind=kind, call=call[-3:]):
                        said = self.read(call, f"{name} {kind} {call[1]}")
                        if kind in ELSEWHERE and call[1] in ("-c", "show", "compare"):
                            self.says(said, "another file")

    @pytest.mark.long
    def test_what_is_not_a_file_in_place_of_results(self):
        self.compute(ONE_CASE)
        table = next((self.out / "tables").glob("*.csv"))
        path = case_files(self.out)[0]
        path.unlink()
        for kind, make, remove in (("pipe", os.mkfifo, os.unlink), ("folder", os.mkdir, os.rmdir),
                                   ("device", lambda path: os.symlink("/dev/zero", path), os.unlink)):
            odd = self.folder / f"{kind}.csv"
            for target in (path, odd):
                make(target)
            for call in (command("show", path), command("reduce", self.out), command("verify", self.out),
                         command("status", self.out), command("compare", path, self.out), command("diff", table, odd),
                         command("diff", table, table, "--tolerances", odd), command("respond", path),
                         [sys.executable, "-c", READ, str(path), str(self.out)]):
                with self.subTest(kind=kind, call=call[-3:]):
                    self.read(call, f"{kind} {call[1]}")
            remove(path)

    def test_what_is_not_a_file_in_place_of_texts(self):
        self.compute(ONE_CASE)
        case = case_files(self.out)[0]
        accepted_or_refused(self, [sys.executable, "-c", READ, str(case), str(self.out)], (0,), "undamaged results")
        odd = (("pipe", os.mkfifo), ("hole", self.make_hole), ("folder", os.mkdir), ("device", lambda path: path.symlink_to("/dev/zero")))
        texts = [self.out / "plan.json", self.out / "job.toml", *self.out.glob("journal*.jsonl"), *self.out.glob("index*.jsonl"),
                 *(self.out / "tables").iterdir()]
        for text in texts:
            good = text.read_bytes()
            text.unlink()
            for kind, make in odd[:times(1, 4)]:
                make(text)
                for call in (command("status", self.out), command("reduce", self.out), command("report", self.out),
                             [sys.executable, "-c", READ, str(case), str(self.out)])[times(3, 0):]:
                    with self.subTest(text=text.name, kind=kind, call=call[-3:]):
                        self.read(call, f"{text.name} {kind} {call[1]}")
                if text.is_dir():
                    text.rmdir()
                else:
                    text.unlink(missing_ok=True)
            text.write_bytes(good)

    @pytest.mark.long
    def test_texts_with_changed_bytes(self):
        self.compute(ONE_CASE)
        python = [sys.executable, "-c", READ, str(case_files(self.out)[0]), str(self.out)]
        rng = random.Random("texts")
        texts = [path for path in sorted(self.out.rglob("*")) if path.suffix in (".json", ".jsonl", ".toml", ".csv")]
        self.assertGreater(len(texts), 3)
        for text in texts:
            good = text.read_bytes()
            for number in range(200 // len(texts) + 1):
                for call in (command("status", self.out), command("reduce", self.out), command("run", "job.toml"), python):
                    text.write_bytes(mutated(good, rng))
                    with self.subTest(text=text.name, number=number, call=call[1]):
                        self.read(call, f"{text.name} number {number} {call[1]}")
            text.write_bytes(good)

    @staticmethod
    def make_hole(path):
        path.touch()
        os.truncate(path, 3 << 30)

    def test_checkpoints(self):
        self.write_job(STEPPED)
        process = self.start_and_stop("run", "job.toml", "--checkpoint-steps", 20, faults=checkpoint(2))
        self.signal_and_continue(process, signal.SIGTERM)
        process.wait()
        path = max((self.out / "checkpoints").iterdir(), key=os.path.getmtime)
        with h5py.File(path) as file:
            name = next(name for name, item in file.items() if isinstance(item, h5py.Dataset))
        part = next((self.out / "cases").glob("*.part"))
        written, good = part.read_bytes(), path.read_bytes()
        rng = random.Random("checkpoint")

        def with_changed_bytes():
            for number in range(times(3, 200)):
                path.write_bytes(mutated(good, rng))
                yield f"changed bytes, number {number}"

        for kind in itertools.chain(self.replaced(path, name), with_changed_bytes()):
            with self.subTest(kind=kind):
                self.read(command("status", self.out), kind)
                said = self.read(command("run", "job.toml", "--only", path.name.split(".")[0]), kind)
                self.assertRegex(said, "it is not used|cannot open dataset")
            for computed in case_files(self.out):
                computed.unlink()
            path.parent.mkdir(exist_ok=True)
            part.write_bytes(written)


if __name__ == "__main__":
    unittest.main()
