# SPDX-License-Identifier: BSD-3-Clause
"""Files of users with random changes: each reader of the program accepts them or reports an error, in limited time and memory."""
import random
import sys
import unittest

from attacks import accepted_or_refused, times
from program import ROOT, ProgramTest, changed, command

CORPUS = ROOT / "tests" / "fuzz" / "corpus"
MOST_s = 10.0
SPECTRAL = ('engine = "layered"', 'engine = "spectral"')
MAP = ('base = "rigid"\n', 'base = "rigid"\nmap = "input.h5"\n')
LINE = ('path = { shape = "line", from_mm = [-14.0, 0.0], to_mm = [14.0, 0.0] }', 'path = { shape = "csv", file = "input.csv" }')
RECEPTORS = ("-S", 'afferents.where="fingertip"')


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
    return bytes(data)


class MutatedFiles(ProgramTest):
    def accepted_or_refused(self, call, about):
        return accepted_or_refused(self, call, (0, 2, 3, 6), MOST_s, about)[1]

    def attack(self, name, content, call):
        rng = random.Random(name)
        (self.folder / name).write_bytes(content)
        self.assertEqual(self.accepted_or_refused(call, f"{name} without changes"), 0)
        refused = 0
        for number in range(times(5, 200)):
            (self.folder / name).write_bytes(mutated(content, rng))
            with self.subTest(name=name, number=number):
                refused += self.accepted_or_refused(call, f"{name} number {number}") != 0
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

    def test_scans(self):
        program = ("import sys; from fuzz_scan import BadScan, read_scan\n"
                   "try: read_scan(sys.argv[1])\nexcept BadScan as error: sys.exit(3)")
        folders = f"sys.path[:0] = {[str(ROOT / 'tests' / 'fuzz'), str(ROOT / 'analysis')]}"
        sys.path[:0] = [str(ROOT / "tests" / "fuzz"), str(ROOT / "analysis")]
        from fuzz_scan import KINDS, examples
        for kind, content in examples(self.folder).items():
            name = f"{kind}{KINDS[kind]}"
            self.attack(name, content, [sys.executable, "-c", f"import sys; {folders}\n{program}", name])


if __name__ == "__main__":
    unittest.main()
