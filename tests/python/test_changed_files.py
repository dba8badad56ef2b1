# SPDX-License-Identifier: BSD-3-Clause
"""Case files that other programs have changed are warned of when their case is read."""
import warnings

import h5py

import shearwake
from shearwake.checksum import LINE_LENGTH, sealed
from synthetic import AM, Folder, InFolder


class Changed(InFolder):
    def setUp(self):
        super().setUp()
        self.folder = Folder(self.root)
        self.ids = [self.folder.add({AM: frequency}) for frequency in (100.0, 200.0, 400.0)]
        self.folder.save()

    def warned(self, read, has_table=True):
        """The messages that reading a sweep gives, twice, since each case is warned of once."""
        if not has_table:
            (self.folder.path / "tables" / "s.json").unlink()
        sweep = shearwake.open(self.folder.path)
        with warnings.catch_warnings(record=True) as found:
            warnings.simplefilter("always")
            read(sweep)
            read(sweep)
        found = [one for one in found if issubclass(one.category, shearwake.NotValid)]
        self.assertLessEqual({one.filename for one in found}, {__file__})  # the line of the user
        return [str(one.message) for one in found]

    def test_a_changed_value_is_warned_of_once_when_the_file_is_read(self):
        path = self.folder.file(self.ids[1])
        with h5py.File(path, "r+") as file:
            file["eta_period_1"][...] = 0.999
        for read in (lambda s: s[self.ids[1]].array("eta"), lambda s: s[self.ids[1]].series, lambda s: s[self.ids[1]].attributes,
                     lambda s: s[self.ids[1]].setting("measure", default=0)):
            message, = self.warned(read)
            self.assertIn(f"{path} is damaged: the checksum at its end is missing", message)
        self.assertEqual(shearwake.open(self.folder.path)[self.ids[1]].value("eta_period_1"), 0.25)  # of the table of reduce
        message, = self.warned(lambda s: s.table, has_table=False)
        self.assertIn("is damaged", message)

    def test_complete_files_and_files_that_were_only_opened_are_not_warned_of(self):
        path = self.folder.file(self.ids[0])
        line = path.read_bytes()[-LINE_LENGTH:-1].decode()
        with open(self.folder.path / "journal.jsonl", "a", encoding="utf-8") as journal:
            journal.write(sealed({"event": "finished", "id": self.ids[0], "file_checksum": line}, end="") + "\n")
        with h5py.File(path, "r+"):
            pass
        self.assertNotIn(b"shearwake checksum", path.read_bytes()[-LINE_LENGTH:])
        self.assertEqual(self.warned(lambda s: (s.table, [case.array("eta") for case in s])), [])

    def test_a_verified_case_has_its_damage_instead_of_a_warning(self):
        with h5py.File(self.folder.file(self.ids[1]), "r+") as file:
            file["eta_period_1"][...] = 0.999
        self.assertEqual(self.warned(lambda s: (s.verify(), s.table)), [])
