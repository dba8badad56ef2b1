# SPDX-License-Identifier: BSD-3-Clause
"""The report of folders that contain only case files."""
import shutil

import pytest


from synthetic import AM, FWHM, Folder, InFolder, Page, case_id, reduce, sweep

from shearwake.report import __main__ as report, load


class CasesAloneTest(InFolder):
    """`whole` is a complete sweep, `copy` a folder with only its `cases`."""

    def setUp(self):
        super().setUp()
        self.whole, self.copy = self.root / "whole", self.root / "copy"
        self.whole.mkdir()

    def cases_alone(self, folder):
        folder.save()
        shutil.copytree(self.whole / "cases", self.copy / "cases")
        reduce(self.copy)
        return load.load(self.whole), load.load(self.copy)

    def assert_same(self, first, second):
        for name in ("title", "name", "swept_keys", "x", "series_keys", "job_text"):
            self.assertEqual(getattr(first.sweep, name), getattr(second.sweep, name), name)
        for name in ("id", "settings", "is_reference", "reference_id", "status"):
            self.assertEqual([getattr(c, name) for c in first.cases],
                             [getattr(c, name) for c in second.cases], name)

    @pytest.mark.long
    def test_case_files_give_the_same_page_and_figures(self):
        folder = sweep(self.whole, job='[job]\nname = "s"\n# <& job>\n')
        self.assert_same(*self.cases_alone(folder))
        expected = Page(folder.report())
        self.assertEqual(report.main([str(self.copy)]), 0)
        page = Page((self.copy / "report" / "index.html").read_text(encoding="utf-8"))
        self.assertEqual(page.rows, expected.rows)
        self.assertEqual([image["alt"] for image in page.images],
                         [image["alt"] for image in expected.images])
        self.assertEqual({p.name for p in (self.copy / "report").glob("*.png")},
                         {p.name for p in (self.whole / "report").glob("*.png")})
        self.assertIn("# <& job>", page.data)

    def test_axes_and_order_follow_the_job(self):
        kind = "load.modulation.kind"
        job = (f'[job]\nname = "s"\n[table]\nx = "{AM}"\n[sweep]\n"{kind}" = ["STP", "AM-STM"]\n'
               f'"{AM}" = [100, 200]\n')
        folder = Folder(self.whole, swept=[kind, AM], series=[kind], job=job)
        for word in ("STP", "AM-STM"):
            for f in (100.0, 200.0):
                folder.add({kind: word, AM: f}, snapshot=False)
        self.assert_same(*self.cases_alone(folder))

    def test_a_key_that_follows_x_is_not_a_series(self):
        folder = Folder(self.whole, swept=[AM, FWHM], job='[job]\nname = "s"\n')
        for f in (100.0, 200.0):
            folder.add({AM: f, FWHM: f / 50.0}, snapshot=False)
        self.assert_same(*self.cases_alone(folder))

    def test_a_damaged_file_is_reported(self):
        folder = sweep(self.whole)
        bad = folder.file(case_id(2))
        bad.write_bytes(bad.read_bytes()[:3000])
        _, copy = self.cases_alone(folder)
        self.assertEqual({c.id: c.status for c in copy.cases},
                         {case_id(n): "damaged" if n == 2 else "complete" for n in range(1, 5)})
