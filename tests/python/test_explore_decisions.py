# SPDX-License-Identifier: BSD-3-Clause
"""The page of `shearwake explore` as a basis for decisions: unknown values, the steady state, comparisons and saved files."""
import os
import re
import subprocess
import time
import xml.etree.ElementTree
from pathlib import Path

import h5py
import numpy
import PIL.Image
import pytest

from exploring import MOVE, PageTest
from study import program, shearwake

from shearwake.explore import page as explore_page


class ExploreDecisions(PageTest):
    def test_the_first_picture_is_computed_before_the_page_opens(self):
        page = self.open()
        self.assertEqual(page.run("jobText(DEFAULTS)"), explore_page.first_job())
        self.assertEqual(page.run("[explorer.shown.preset, explorer.shown.path, isSteady(explorer.shown)]"), ["palm", "circle", True])
        speeds = page.run("[explorer.shown.speed, explorer.result.header.surface_wave_m_s]")
        self.assertGreater(speeds[0], 1.2 * speeds[1])  # a Mach cone

    @pytest.mark.extended
    def test_unknown_levels_are_grey_and_no_threshold_passes_through_them(self):
        page = self.open()
        page.run("(s => { s.value = 'level'; s.dispatchEvent(new Event('change')); })(document.getElementById('style'))")
        self.assertTrue(page.run("document.getElementById('scale-unknown').hidden"))
        # 20 x 16 cells without a level, between cells above and below the threshold.
        grey = page.run("""(draw => { const r = explorer.result; r.level.forEach((_, k) => { r.levels[k] = k % r.ny < r.ny / 2 ? -20 : 20; });
          for (let i = 50; i < 70; ++i) for (let j = 40; j < 56; ++j) r.levels[i * r.ny + j] = NaN;
          explorer.draw();
          return [true, false].map(draw); })(shader => {
            const r = explorer.result, canvas = document.createElement("canvas"), surface = Object.create(explorer.surface);
            if (!shader) Object.assign(surface, {gl: null, canvas, flat: canvas.getContext("2d")});
            Object.assign(surface.canvas, {width: 8 * WIDTH_mm, height: 8 * HEIGHT_mm});  // cells of 1 mm
            surface.draw(r, 0, 40, "level");
            const copy = document.createElement("canvas");
            Object.assign(copy, {width: 8 * WIDTH_mm, height: 8 * HEIGHT_mm});
            const context = copy.getContext("2d");
            context.drawImage(surface.canvas, 0, 0);
            const {data} = context.getImageData(0, 0, copy.width, copy.height);
            let count = 0, black = 0;
            for (let k = 0; k < data.length; k += 4) {
              const [a, b, c] = [data[k], data[k + 1], data[k + 2]];
              const y = Math.floor(k / 4 / copy.width) / 8, x = k / 4 % copy.width / 8, inside = x > 51 && x < 68 && y > 43 && y < 56;
              if (a === b && b === c && a > 100 && a < 220) ++count;
              if (inside && a < 60) ++black;
            }
            return [count / 64, black]; })""")
        for (count, black), delta in zip(grey, (1, 40)):  # without shaders, pixels at the edge are mixed
            self.assertAlmostEqual(count, 20 * 16, delta=delta)
            self.assertEqual(black, 0)
        self.assertFalse(page.run("document.getElementById('scale-unknown').hidden"))

    @pytest.mark.extended
    def test_the_level_of_five_settings_is_that_of_run_in_the_periodic_regime(self):
        page = self.open()
        changes = ("s.kind = 'STM'", "s.kind = 'SM-STM'", "s.kind = 'AM'", "s.kind = 'LM'; s.am = 100", "s.kind = 'AM-STM'; s.path = 'line'; s.length = 50; s.speed = 8")
        for number, change in enumerate(changes):
            with self.subTest(change=change):
                self.use(page, change)
                self.assertEqual(page.run("isSteady(explorer.shown)"), True)
                job = Path(f"steady-{number}.toml")
                # With other frames than those of the page.
                job.write_text(re.sub("output_interval_us = .*", "output_interval_us = 50.0", page.run("explorer.job")), encoding="utf-8")
                self.assertIn('regime = "periodic"', job.read_text(encoding="utf-8"))
                out = Path(f"steady-{number}")
                subprocess.run([*program.command("run"), job, "--out", out, "--quiet"], check=True, env=program.environment(), capture_output=True)
                with h5py.File(program.case_files(out)[0]) as file:
                    level_dB = float(file["felt_path_dB"][()])
                self.assertAlmostEqual(page.run("explorer.result.column('felt_path_dB').value"), level_dB, delta=0.1)

    @pytest.mark.extended
    def test_a_load_without_a_period_starts_from_rest_and_offers_the_values_that_check_names(self):
        page = self.open()
        self.use(page, "s.speed = 7")
        self.assertIn("12 ms after a start from rest. 7 m/s and 200 Hz have no common period", page.run("document.getElementById('period').textContent"))
        self.assertNotIn("periodic", page.run("explorer.job"))
        usable = page.run("usableValues(explorer.shown)")
        job = Path("aperiodic.toml")
        job.write_text(page.run("explorer.job").replace("duration_ms = 12.0", 'regime = "periodic"'), encoding="utf-8")
        output = subprocess.run([*program.command("check"), job], check=False, env=program.environment(), capture_output=True, text=True)
        found = re.findall(r"([\d.]+) (?:m/s|Hz) instead of [\d.]+ \(period ([\d.]+) ms\)", output.stdout + output.stderr)
        self.assertEqual(len(found), 2, output.stdout + output.stderr)
        for value, expected in zip(usable, sorted(found, key=lambda pair: float(pair[0]))):
            self.assertAlmostEqual(value["value"], float(expected[0]), delta=1e-8 * value["value"])
            self.assertAlmostEqual(value["period_ms"], float(expected[1]), delta=1e-3 * value["period_ms"])
        page.run("explorer.waits_ms.length = 0; document.querySelector('#period button').click()")
        self.assertTrue(page.wait("explorer.waits_ms.length"))
        self.assertEqual(page.run("document.getElementById('period').textContent"), "Steady state with a period of 40 ms.")

    @pytest.mark.long
    def test_all_modulations_are_compared_and_saved(self):
        page = self.open()
        self.browser.send("Browser.setDownloadBehavior", behavior="allow", downloadPath=str(Path.cwd()))
        page.run("explorer.settings.speed = 7; document.getElementById('compare').click()")
        self.assertTrue(page.wait("!document.getElementById('compare-png').disabled"), page.run("document.getElementById('compare-state').textContent"))
        self.assertIn("7.069 m/s, the nearest to 7 m/s", page.run("document.getElementById('compare-state').textContent"))
        self.assertEqual(page.run("Array.from(document.querySelectorAll('#compare-table tbody th'), e => e.textContent)"), ["STM", "AM-STM", "SM-STM", "LM", "AM"])
        self.assertEqual(page.run("document.querySelectorAll('.best').length"), 4)
        marked = page.run("Array.from(document.querySelectorAll('#compare-table tr'), row => Array.from(row.cells, cell => cell.textContent))")
        answer = page.run("document.getElementById('compare-state').textContent").partition("Best kinds. ")[2]
        for column in range(1, 5):
            best, = (row[0] for row in marked[1:] if row[column].startswith("★"))
            self.assertIn(f"{marked[0][column]}: {best}", answer)
        for name in ("png", "csv", "job"):
            page.run(f"document.getElementById('compare-{name}').click()")
        self.wait_for_files("modulations.png", "modulations.csv", "modulations.toml")
        self.assertGreater(PIL.Image.open("modulations.png").width, 2000)
        table = Path("modulations.csv").read_text(encoding="utf-8").splitlines()
        self.assertEqual([line.partition(",")[0] for line in table], ["modulation", "STM", "AM-STM", "SM-STM", "LM", "AM"])
        self.assertEqual(sorted(shearwake.Job("modulations.toml").plan().cases.index),
                         sorted(page.run("explorer.comparison.rows.map(row => row.result.header.case)")))
        self.assertEqual(page.errors(), [])

    def wait_for_files(self, *names):
        end = time.monotonic() + program.PATIENCE_s
        while not all(Path(name).is_file() for name in names):
            self.assertLess(time.monotonic(), end, os.listdir())
            time.sleep(0.05)

    @pytest.mark.extended
    def test_a_picture_and_a_curve_are_saved_and_reset_restores_the_first_setting(self):
        page = self.open()
        self.browser.send("Browser.setDownloadBehavior", behavior="allow", downloadPath=str(Path.cwd()))
        page.run(f"{MOVE}('peak', 120)")
        name = f"shearwake-{page.run('explorer.result.header.case')[:8]}.png"
        page.run("document.getElementById('save').click(); document.querySelector('[data-curve=eta]').click()")
        self.wait_for_files(name, "eta.svg")
        picture = numpy.asarray(PIL.Image.open(name).convert("RGB")).astype(int)
        surface = picture[60:960, 20:1220]
        self.assertGreater((numpy.ptp(surface, axis=2) > 20).mean(), 0.1)  # colours of the waves
        self.assertGreater((picture[-150:].max(axis=2) < 80).mean(), 0.01)  # text
        curve = xml.etree.ElementTree.parse("eta.svg").getroot().find("{http://www.w3.org/2000/svg}polyline")
        self.assertEqual(len(curve.get("points").split()), page.run("explorer.result.frames"))
        page.run("explorer.waits_ms.length = 0; document.getElementById('reset').click()")
        self.assertTrue(page.wait("explorer.waits_ms.length"))
        self.assertEqual(page.run("JSON.stringify(explorer.shown) === JSON.stringify(DEFAULTS)"), True)
