# SPDX-License-Identifier: BSD-3-Clause
"""Damaged files of an output folder: every reader detects every flipped bit and every truncation, and the next run
repairs the damage."""
import json
import random
import shutil

import h5py
import pytest

from limits import times
from program import ProgramTest, case_files, plan, small_job, table

from shearwake.checksum import LINE_LENGTH, sealed, with_line
from shearwake.report import load


class CaseFiles(ProgramTest):
    def setUp(self):
        super().setUp()
        self.compute()
        self.before = table(self.out)
        self.victim = case_files(self.out)[1]
        self.sound = self.victim.read_bytes()
        self.chance = random.Random(16)

    def notice(self, reader):
        """This reader reports the damage with its exit code, and no reader accepts it."""
        id_, out = self.victim.stem, self.out
        if reader == "verify":
            self.contains(self.shearwake("verify", out, expect=4).output, f"damaged {id_}")
        elif reader == "show":
            self.contains(self.shearwake("show", self.victim, expect=6).output, self.victim.name, "is not a complete case file")
        elif reader == "reduce":
            self.contains(self.shearwake("reduce", out, expect=4).output, "1 damaged case file", id_)
            self.assertEqual({row["id"]: row["status"] for row in table(out)}[id_], "damaged")
        else:
            self.assertEqual(load.load(out).by_id[id_].status, "damaged")

    def test_every_flipped_bit_and_every_truncation_is_detected(self):
        for n in range(times(20, 510)):
            damaged = bytearray(self.sound)
            if n % 2:
                bit = self.chance.randrange(8 * len(damaged))
                damaged[bit // 8] ^= 1 << bit % 8
            else:  # also within the line of the checksum, and all of it, except all bytes of HDF5, which the journal verifies
                kept = len(damaged) - 1 - n // 2 if n % 4 else self.chance.randrange(len(damaged))
                del damaged[kept + (kept == len(damaged) - LINE_LENGTH - 1):]
            self.victim.write_bytes(damaged)
            self.notice(self.chance.choice(["verify", "show", "reduce", "report"]))

    @pytest.mark.extended
    def test_a_file_that_was_opened_for_writing_is_kept_if_it_is_unchanged(self):
        h5py.File(self.victim, "r+").close()
        self.assertEqual(self.victim.read_bytes(), self.sound[:-LINE_LENGTH - 1])
        self.shearwake("verify", self.out)
        self.contains(self.shearwake("run", "job.toml").output, "0 computed now, 4 already complete")
        self.shearwake("reduce", self.out)
        self.assertEqual(load.load(self.out).by_id[self.victim.stem].status, "complete")
        with h5py.File(self.victim, "r+") as file:
            name = next(name for name, item in file.items() if isinstance(item, h5py.Dataset) and item.shape == ())
            file[name][()] = 2.0 * file[name][()] + 1.0
        self.contains(self.shearwake("verify", self.out, expect=4).output, "another program has opened it for writing and changed it")
        self.contains(self.shearwake("run", "job.toml").output, f"case {self.victim.stem} is damaged", "1 computed now, 3 already complete")

    @pytest.mark.long
    def test_a_changed_measure_is_moved_aside_and_computed_again(self):
        with h5py.File(self.victim, "r") as file:
            offset = file["eta_period_1"].id.get_offset()
        damaged = bytearray(self.sound)
        damaged[offset + 6] ^= 0x10
        self.victim.write_bytes(damaged)
        with h5py.File(self.victim, "r") as file:  # HDF5 notices nothing
            self.assertNotEqual(file["eta_period_1"][()], float(self.before[1]["eta_period_1"]))
        self.shearwake("reduce", self.out, expect=4)
        self.shearwake("report", self.out, expect=4)
        output = self.shearwake("run", "job.toml").output
        self.contains(output, f"case {self.victim.stem} is damaged", "moved to", "1 computed now", "3 already complete")
        kept = self.out / "failed" / f"{self.victim.stem}.damaged.h5"
        self.assertEqual(kept.read_bytes(), bytes(damaged))
        self.shearwake("verify", self.out)
        self.shearwake("reduce", self.out)
        self.assertEqual(table(self.out), self.before)

    def test_verify_prints_json(self):
        found = json.loads(self.shearwake("verify", self.out, "--json").stdout)
        self.assertTrue(found["sound"])
        self.assertEqual((found["files"], found["damaged"], found["plan"]), (4, [], "sound"))
        self.victim.write_bytes(self.sound[:-1])
        found = json.loads(self.shearwake("verify", self.out, "--json", expect=4).stdout)
        self.assertFalse(found["sound"])
        self.assertEqual([entry["id"] for entry in found["damaged"]], [self.victim.stem])
        self.shearwake("verify", self.folder / "nowhere", expect=6)


class Studies(ProgramTest):
    """The folders of converge and optimise in that of a run, and that of fit."""

    def setUp(self):
        super().setUp()
        self.compute()
        self.before = table(self.out)
        shutil.copytree(self.out, self.folder / "copy")
        for name in ("converge", "basis", "robustness"):
            shutil.copytree(self.folder / "copy", self.out / name)
        self.id = case_files(self.out)[0].stem
        (self.out / "optimise").mkdir()
        for name in ("converge/converge.json", "converge/refinements.json", "uncertainty.json", f"optimise/{self.id}.forms.json",
                     f"optimise/{self.id}.strength-0.7.json"):
            (self.out / name).write_text(sealed({"schema": 1, "cases": []}), encoding="utf-8")

    def test_a_flipped_bit_of_each_kind_of_file_is_detected_and_its_file_named(self):
        chance = random.Random(64)
        self.contains(self.shearwake("verify", self.out).output, "16 case files", ": 0 damaged, 0 of the plan")
        files = ["uncertainty.json", "plan.json", *(f"optimise/{self.id}.{name}.json" for name in ("forms", "strength-0.7")),
                 "converge/converge.json", "converge/refinements.json",
                 *(f"{folder}/{name}" for folder in ("converge", "basis", "robustness") for name in (f"cases/{self.id}.h5", "plan.json"))]
        for name in files:
            with self.subTest(file=name):
                sound = (self.out / name).read_bytes()
                damaged = bytearray(sound)
                damaged[chance.randrange(len(sound))] ^= 1 << chance.randrange(8)
                (self.out / name).write_bytes(damaged)
                lines = [line for line in self.shearwake("verify", self.out, expect=4).stdout.splitlines() if line.startswith("damaged")]
                self.assertEqual(len(lines), 1, lines)
                self.contains(lines[0], name)
                found = json.loads(self.shearwake("verify", self.out, "--json", expect=4).stdout)
                self.assertEqual([entry["file"] for entry in found["damaged_files"]], [] if name == "plan.json" else [name])
                (self.out / name).write_bytes(sound)
        self.shearwake("verify", self.out)

    @pytest.mark.extended
    def test_a_damaged_prediction_of_a_fit_is_named(self):
        path = self.folder / "small.fit" / "evaluations" / f"{self.id}-0123456789ab"
        path.parent.mkdir(parents=True)
        path.write_bytes(with_line(bytes(1000)))
        self.shearwake("verify", "small.fit")
        path.write_bytes(b"\1" + path.read_bytes()[1:])
        self.contains(self.shearwake("verify", "small.fit", expect=4).output, f"damaged evaluations/{path.name}: its bytes do not match its checksum")

    @pytest.mark.extended
    def test_copies_of_other_programs_are_named_and_disturb_no_command(self):
        sound = (self.out / "cases" / f"{self.id}.h5").read_bytes()
        names = [f"cases/._{self.id}.h5", f"cases/{self.id} (1).h5", f"cases/{self.id} (conflicted copy 2026-01-01).h5",
                 f"cases/{self.id}-LAPTOP.h5", f"cases/{self.id}.h5~", "cases/.DS_Store", f"basis/cases/._{self.id}.h5", "._plan.json",
                 ".DS_Store", f"optimise/._{self.id}.forms.json", f"optimise/{self.id}.forms (1).json"]
        for name in names:
            (self.out / name).write_bytes(b"\0\5\x16\7" if "._" in name else sound)
        for path in [*self.out.glob("journal*"), *self.out.glob("index*")]:
            copy = path.with_name(f"{path.stem} (1){path.suffix}")
            copy.write_bytes(path.read_bytes())
            names.append(copy.name)
        for path in (self.out / "locks").glob("*.run"):
            (path.with_name(f"._{path.name}")).write_bytes(b"")
        found = json.loads(self.shearwake("verify", self.out, "--json").stdout)
        self.assertEqual((found["sound"], sorted(found["stray_files"])), (True, sorted(names)))
        output = self.shearwake("verify", self.out).stdout
        for name in names:
            self.contains(output, f"stray {name}: ")
        self.contains(self.shearwake("run", "job.toml").output, "0 computed now, 4 already complete")
        status = json.loads(self.shearwake("status", self.out, "--json").stdout)
        self.assertEqual((status["remaining"], status["is_active"], status["damaged_cases"]), (0, False, []))
        self.shearwake("reduce", self.out)
        self.assertEqual(table(self.out), self.before)
        (self.out / "plan.json").unlink()  # then it is reconstructed from the case files
        self.shearwake("reduce", self.out)
        self.assertEqual(sorted(load.load(self.out).by_id), sorted(row["id"] for row in self.before))

    @pytest.mark.extended
    def test_a_folder_that_a_file_browser_has_opened_is_empty(self):
        self.folder.joinpath("new").mkdir()
        self.folder.joinpath("new", ".DS_Store").write_bytes(b"")
        self.contains(self.shearwake("run", "job.toml", "--out", "new").output, "4 computed now")


class TextFiles(ProgramTest):
    def setUp(self):
        super().setUp()
        self.compute()
        self.before = table(self.out)

    @pytest.mark.extended
    def test_a_changed_index_changes_no_table(self):
        path = next(self.out.glob("index*.jsonl"))
        path.write_text(path.read_text(encoding="utf-8").replace("0.5", "0.9"), encoding="utf-8")
        self.shearwake("status", self.out)
        self.shearwake("reduce", self.out)
        self.assertEqual(table(self.out), self.before)
        self.contains(self.shearwake("verify", self.out).output, "lines of the index do not match")

    @pytest.mark.extended
    def test_no_flipped_bit_of_index_or_journal_changes_the_table(self):
        chance = random.Random(2)
        for path in [next(self.out.glob(name)) for name in ("index*.jsonl", "journal*.jsonl")]:
            sound = path.read_bytes()
            for _ in range(times(5, 60)):
                damaged = bytearray(sound)
                damaged[chance.randrange(len(damaged))] ^= 1 << chance.randrange(8)
                path.write_bytes(damaged)
                self.shearwake("reduce", self.out)
                self.assertEqual(table(self.out), self.before)
                self.contains(self.shearwake("run", "job.toml").output, "0 computed now, 4 already complete")
            path.write_bytes(sound)

    def test_a_damaged_plan_is_reported_and_written_again(self):
        path = self.out / "plan.json"
        sound = path.read_bytes()
        chance = random.Random(3)
        for n in range(times(6, 60)):
            damaged = bytearray(sound)
            if n % 2:
                del damaged[chance.randrange(len(damaged) - 1):]
            else:
                damaged[chance.randrange(len(damaged))] ^= 1 << chance.randrange(8)
            path.write_bytes(damaged)
            output = self.shearwake("status", self.out, expect=6).output
            self.contains(output, "plan.json", "damaged")
            self.assertLess(len(output), 400, output)
            self.contains(self.shearwake("run", "job.toml").output, "was damaged and has been rewritten",
                          "0 computed now, 4 already complete")
            self.assertEqual(path.read_bytes(), sound)
        self.shearwake("reduce", self.out)
        self.assertEqual(table(self.out), self.before)

    @pytest.mark.extended
    def test_a_damaged_plan_of_another_job_is_not_replaced(self):
        (self.out / "plan.json").write_bytes((self.out / "plan.json").read_bytes()[:1000])
        self.write_job(small_job({"load.peak_Pa": 200.0}))
        self.contains(self.shearwake("run", "job.toml", expect=6).output, "is damaged", "does not belong to a case of this job")

    @pytest.mark.extended
    def test_a_plan_of_an_earlier_version_is_the_same_plan(self):
        path = self.out / "plan.json"
        old = {key: value for key, value in plan(self.out).items() if key != "checksum"}
        old["schema"] = 1
        path.write_text(json.dumps(old, indent=1), encoding="utf-8")
        self.contains(self.shearwake("run", "job.toml").output, "0 computed now, 4 already complete")
        self.shearwake("reduce", self.out)
        self.assertEqual(table(self.out), self.before)
