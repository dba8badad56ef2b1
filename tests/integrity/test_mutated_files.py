# SPDX-License-Identifier: BSD-3-Clause
"""Files of users with random changes: each reader of the program accepts them or reports an error, in limited time and memory."""
import os
import random
import shutil
import sys
import unittest
import zlib

import h5py
import numpy as np
import pytest

from attacks import ELSEWHERE, accepted_or_refused, attacks_on_hdf5, grey_header, png, sampled, times
from program import ROOT, SWEEP, ProgramTest, case_files, changed, command, seal, without_reference

CORPUS = ROOT / "tests" / "fuzz" / "corpus"
SPECTRAL = ('engine = "layered"', 'engine = "spectral"')
MAP = ('base = "rigid"\n', 'base = "rigid"\nmap = "input.h5"\n')
LINE = ('path = { shape = "line", from_mm = [-14.0, 0.0], to_mm = [14.0, 0.0] }', 'path = { shape = "csv", file = "input.csv" }')
RECEPTORS = ("-S", 'afferents.where="fingertip"')


ONE_CASE = without_reference((f"[sweep]\n{SWEEP}\n", ""), ('x = "load.modulation.am_frequency_Hz"\n', ""))


def import_small_study(test):
    """Makes study.toml and study.h5."""
    from kwave import import_kwave, save
    from small_study import study
    structures = study()
    structures["sensor"]["record"] = ["p", "uz"]
    save(test.folder / "input.mat", structures)
    test.assertEqual(import_kwave(test.folder, "input.mat", "--out", "study")[0], 0)


def mutated(content, rng):
    """The bytes of a file with changed, removed and repeated parts."""
    data = bytearray(content)
    for _ in range(rng.choice((1, 1, 2, 5, 30))):
        at, kind = rng.randrange(len(data) + 1), rng.random()
        if kind < 0.5 and at < len(data):
            data[at] = rng.randrange(256)
        elif kind < 0.7:
            data[at:at + 8] = rng.choice((b"\x00", b"\xff")) * 8
        elif kind < 0.85:
            del data[at:at + rng.randrange(1, 80)]
        else:
            start = rng.randrange(len(data) + 1)
            data[at:at] = data[start:start + rng.randrange(1, 200)]
        data = data or bytearray(b"\n")
    return bytes(data) if data != content else mutated(content, rng)


class MutatedFiles(ProgramTest):
    def accepted_or_refused(self, call, about, codes=(0, 2, 3, 5, 6)):
        return accepted_or_refused(self, call, codes, about)[1]

    def attack(self, name, content, call, finish=lambda path: None, codes=(0, 2, 3, 5, 6)):
        rng = random.Random(name)
        (self.folder / name).write_bytes(content)
        self.assertEqual(self.accepted_or_refused(call, f"{name} without changes"), 0)
        refused = 0
        for number in range(times(5, 200)):
            (self.folder / name).write_bytes(mutated(content, rng))
            finish(self.folder / name)
            with self.subTest(name=name, number=number):
                refused += self.accepted_or_refused(call, f"{name} number {number}", codes) != 0
        self.assertGreater(refused, times(5, 200) // 10)

    def test_maps(self):
        self.write_job(changed(SPECTRAL, MAP))
        self.attack("input.h5", (CORPUS / "map" / "small.h5").read_bytes(), command("check", "job.toml", "--elsewhere"))

    def test_motions_in_hdf5(self):
        self.attack("motion.h5", (CORPUS / "motion" / "traces.h5").read_bytes(), command("respond", "motion.h5", *RECEPTORS))

    def test_motions_in_csv(self):
        self.attack("motion.csv", (CORPUS / "motion" / "small.csv").read_bytes(), command("respond", "motion.csv", *RECEPTORS))

    def test_paths_in_csv(self):
        self.write_job(changed(LINE))
        points = "x_mm,y_mm\n" + "".join(f"{-14 + n},{n % 3}\n" for n in range(29))
        self.attack("input.csv", points.encode(), command("check", "job.toml", "--elsewhere"))

    def test_lists_of_sweeps(self):
        self.write_job(without_reference((SWEEP, 'list = "list.csv"'), ('x = "load.modulation.am_frequency_Hz"\n', "")))
        lines = "".join(f"{100 + n},{7 + n % 3}\n" for n in range(20))
        self.attack("list.csv", f"load.peak_Pa,load.modulation.speed_m_s\n{lines}".encode(), command("check", "job.toml", "--elsewhere"))

    def test_afferents_in_csv(self):
        text = (ROOT / "jobs" / "steady-circle.toml").read_text(encoding="utf-8")
        self.write_job(changed(('"circle-afferents.csv"', '"input.csv"'), text=text))
        lines = (ROOT / "jobs" / "circle-afferents.csv").read_bytes().splitlines(keepends=True)
        self.attack("input.csv", b"".join(lines[:60]), command("check", "job.toml", "--elsewhere"))

    def test_pictures(self):
        text = (ROOT / "jobs" / "lens-letter.toml").read_text(encoding="utf-8")
        polygon = next(line for line in text.splitlines() if line.startswith("target_polygon_mm"))
        self.write_job(changed((polygon, 'target_png = "input.png"\ntarget_width_mm = 40.0'), text=text))
        rows = zlib.compress(b"".join(b"\0" + bytes((8 * (x + y)) % 256 for x in range(24)) for y in range(24)))

        def with_valid_checksums(path):
            """Half of the pictures have valid checksums of the changed contents, which the decoder then sees."""
            content = path.read_bytes()
            if zlib.crc32(content) % 2:
                path.write_bytes(png(content[16:29], content[41:-16]))

        self.attack("input.png", png(grey_header(24), rows), command("check", "job.toml", "--elsewhere"), with_valid_checksums)

    def test_inputs_of_kwave(self):
        content = (ROOT / "tests" / "data" / "kwave" / "homogeneous_input.h5").read_bytes()
        self.attack("input.h5", content, command("kwave", "-i", "input.h5", "-o", "out.h5"), codes=(0, 1))

    def test_tables(self):
        table = (ROOT / "tests" / "baselines" / "quickstart.csv").read_bytes()
        (self.folder / "good.csv").write_bytes(table)
        self.attack("table.csv", table, command("diff", "table.csv", "good.csv"))

    @pytest.mark.long
    def test_case_files_with_valid_checksums(self):
        self.write_job(ONE_CASE)
        self.shearwake("run", "job.toml")
        case = case_files(self.out)[0].read_bytes()
        self.attack("show.h5", case, command("show", "show.h5"), seal)
        (self.folder / "good.h5").write_bytes(case)
        self.attack("compare.h5", case, command("compare", "compare.h5", "good.h5"), seal)

    def test_studies(self):
        import_small_study(self)
        study = (self.folder / "study.h5").read_bytes()
        self.attack("study.h5", study, command("check", "study.toml", "--elsewhere"))
        self.attack("study.h5", study, HostileFiles.python("inputs.read_study(sys.argv[1])", "study.h5"))

    @pytest.mark.long
    def test_scans(self):
        program = ("import sys; from fuzz_scan import BadScan, read_scan\n"
                   "try: read_scan(sys.argv[1])\nexcept BadScan as error: sys.exit(3)")
        folders = f"sys.path[:0] = {[str(ROOT / 'tests' / 'fuzz'), str(ROOT / 'analysis')]}"
        sys.path[:0] = [str(ROOT / "tests" / "fuzz"), str(ROOT / "analysis")]
        from fuzz_scan import KINDS, examples
        for kind, content in examples(self.folder).items():
            name = f"{kind}{KINDS[kind]}"
            self.attack(name, content, [sys.executable, "-c", f"import sys; {folders}\n{program}", name])


class HostileFiles(ProgramTest):
    """Each attack on a dataset of an HDF5 file, in each reader."""

    def attack(self, name, datasets, *calls):
        good, attacks = (self.folder / name).read_bytes(), attacks_on_hdf5(self.folder)
        for dataset in datasets:
            for kind, change in sampled(attacks, name + dataset):
                (self.folder / name).write_bytes(good)
                with h5py.File(self.folder / name, "r+") as file:
                    shape = file[dataset].shape
                    if kind != "name of control characters":
                        del file[dataset]
                    change(file, dataset, shape)
                for call in calls:
                    with self.subTest(dataset=dataset, kind=kind, call=call[-2:]):
                        said, code = accepted_or_refused(self, call, (0, 1, 2, 3, 6), kind)  # 1: of k-Wave
                        self.assertNotIn("\x1b", said)
                        self.assertNotIn("12345", said)
                        if kind in ELSEWHERE:
                            self.assertNotEqual(code, 0)
                            self.says(said, "another file")

    @staticmethod
    def python(program, *names):
        """Runs a program that ends with exit code 3 if the package refuses a file."""
        return [sys.executable, "-c", f"import sys; sys.path.insert(0, {str(ROOT / 'analysis')!r})\nfrom shearwake import inputs\n"
                f"try: {program}\nexcept (OSError, KeyError) as error: print(ascii(str(error))); sys.exit(3)", *names]

    def test_maps(self):
        self.write_job(changed(SPECTRAL, MAP))
        shutil.copy(CORPUS / "map" / "small.h5", self.folder / "input.h5")
        self.attack("input.h5", ("c_s_m_s", "x_m"), command("check", "job.toml", "--elsewhere"),
                    self.python("inputs.read_map(sys.argv[1])", "input.h5"))

    def test_motions(self):
        shutil.copy(CORPUS / "motion" / "traces.h5", self.folder / "motion.h5")
        self.attack("motion.h5", ("u_z", "time"), command("respond", "motion.h5", *RECEPTORS))

    def test_files_of_kwave(self):
        shutil.copy(ROOT / "tests" / "data" / "kwave" / "homogeneous_input.h5", self.folder / "input.h5")
        self.attack("input.h5", ("Nt", "mu"), command("kwave", "-i", "input.h5", "-o", "out.h5"))

    def test_studies(self):
        import_small_study(self)
        self.attack("study.h5", ("medium/c_s_m_s", "grid/points"), command("check", "study.toml", "--elsewhere"),
                    self.python("inputs.read_study(sys.argv[1])", "study.h5"))

    def test_scans(self):
        sys.path[:0] = [str(ROOT / "tests" / "fuzz"), str(ROOT / "analysis")]
        from fuzz_scan import examples
        self.write_job(changed(SPECTRAL))
        (self.folder / "scan.mat").write_bytes(examples(self.folder)["mat"])
        self.attack("scan.mat", ("velocity",), command("measure", "scan.mat", "--options", "job.toml", "--no-report"))


LIST = ('[sweep]', '[sweep]\nlist = "input.csv"')
MEGABYTES = 60  # below the largest text that is read


def write_repeated(path, start, part, end=""):
    """A file that is never entirely in memory, since the memory of a command includes that of the process that starts it."""
    block = part.encode() * (1_000_000 // len(part))
    with path.open("wb") as file:
        file.write(start.encode())
        for _ in range(MEGABYTES):
            file.write(block)
        file.write(end.encode())


class LargeFiles(ProgramTest):
    """Long lines, many columns and rows, and holes: an error that names the file, in limited time and memory."""

    def refused(self, call, name, about, codes=(2, 3, 6)):
        said, _ = accepted_or_refused(self, call, codes, about)
        self.assertIn(name, said, about)
        return said

    @pytest.mark.long
    def test_long_lines_and_many_rows_of_csv_files(self):
        (self.folder / "other.csv").write_text("id,a\nx,1\n", encoding="utf-8")
        check = command("check", "job.toml", "--elsewhere")
        for door, change, call, header in (
                ("path", LINE, check, "x_mm,y_mm"), ("list", LIST, check, "load.peak_Pa"),
                ("motion", None, command("respond", "input.csv", *RECEPTORS), "t_ms,u_um"),
                ("table", None, command("diff", "input.csv", "other.csv"), "id,a")):
            if change:
                self.write_job(changed(change))
            for kind, *content in (("cells", header + "\n", "1,"), ("header", header, ",a_um", "\n1,2\n"), ("cell", header + "\n", "1"),
                                   ("rows", header + "\n", "1,1\n"), ("zeros", header + "\n", "\x00")):
                write_repeated(self.folder / "input.csv", *content)
                with self.subTest(door=door, kind=kind):
                    self.refused(call, "input.csv", f"{door} {kind}")

    @pytest.mark.long
    def test_scans(self):
        job = self.write_job(changed(SPECTRAL))
        header = "x_m,y_m,quality," + ",".join(f"{k}e-4" for k in range(6))
        sparse = 3 << 30
        for kind, name, words, start, part in (
                ("cells", "scan.csv", "fields", header + "\n", "1,"), ("header", "scan.csv", "fields", header, ",1"),
                ("empty lines", "scan.csv", "lines", header + "\n", "\n"), ("remarks", "scan.csv", "remarks", header + "\n", "# a\n"),
                ("values", "scan.csv", "values", header + "\n", "1,1,1,1,1,1,1,1,1\n"),
                ("sparse CSV", "scan.csv", "sparse", header, ""), ("sparse UFF", "scan.uff", "sparse", "    -1\n    58\n", ""),
                ("long line of UFF", "scan.uff", "characters", "    -1\n", "5"), ("lines of UFF", "scan.uff", "lines", "    -1\n  2411\n", "1\n")):
            if part:
                write_repeated(self.folder / name, start, part)
            else:
                (self.folder / name).write_text(start, encoding="ascii")
                os.truncate(self.folder / name, sparse)
            with self.subTest(kind=kind):
                said = self.refused(command("measure", name, "--options", job, "--no-report"), name, kind, (2, 6))
                self.says(said, words)

    def test_sparse_maps(self):
        self.write_job(changed(SPECTRAL, MAP))
        with h5py.File(self.folder / "input.h5", "w") as file:
            for axis, count in (("x_m", 400), ("y_m", 400), ("z_m", 200)):
                file[axis] = 1e-3 * np.arange(count)
            file.create_dataset("c_s_m_s", shape=(400, 400, 200), dtype=float)[0, 0, 0] = 5.0
        self.says(self.refused(command("check", "job.toml", "--elsewhere"), "input.h5", "sparse"), "sparse")

    def test_files_that_cannot_be_read_are_errors_of_the_job(self):
        for change in (LINE, LIST, MAP):
            self.write_job(changed(*([SPECTRAL, change] if change == MAP else [change])))
            for kind in ("missing", "folder", "pipe", "loop"):
                path = self.folder / ("input.h5" if change == MAP else "input.csv")
                {"missing": lambda: None, "folder": path.mkdir, "pipe": lambda: os.mkfifo(path),
                 "loop": lambda: path.symlink_to(path)}[kind]()
                with self.subTest(change=change, kind=kind):
                    self.refused(command("check", "job.toml", "--elsewhere"), path.name, kind, (3,))
                if kind == "folder":
                    path.rmdir()
                elif kind != "missing":
                    path.unlink()


if __name__ == "__main__":
    unittest.main()
