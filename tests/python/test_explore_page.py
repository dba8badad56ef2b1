# SPDX-License-Identifier: BSD-3-Clause
"""The page of `shearwake explore` in a headless chromium: what it shows is what `run` computes."""
import base64
import statistics
import subprocess
import sys
from pathlib import Path

import h5py
import numpy
import pytest

from exploring import MOVE, PageTest
from study import program, shearwake

SHOWN = """(() => { const r = explorer.result; return {id: r.header.case, columns: Object.fromEntries(Object.entries(r.header.columns)
  .map(([name, c]) => [name, c.value])), shape: [r.frames, r.nx, r.ny], energy: document.querySelector('[data-column=eta]').textContent}; })()"""


# Every tenth frame, as base64.
FRAMES = """(() => { let text = ""; const r = explorer.result;
  for (let n = 9; n < r.frames; n += 10) { const f = r.frame(n), bytes = new Uint8Array(f.buffer, f.byteOffset, f.byteLength);
    for (let i = 0; i < bytes.length; i += 8192) text += String.fromCharCode(...bytes.subarray(i, i + 8192)); }
  return btoa(text); })()"""


class ExplorePage(PageTest):
    def assert_equal_to_run(self, page, name):
        """Runs the job that the page copies and compares the columns and every tenth frame."""
        page.run("document.getElementById('copy').click()")
        job = Path(name + ".toml")
        job.write_text(page.run("explorer.copied"), encoding="utf-8")
        out = Path(name)
        program_run = subprocess.run([*program.command("run"), job, "--out", out, "--quiet"], check=False,
                                                   env=program.environment(), capture_output=True, text=True)
        self.assertEqual(program_run.returncode, 0, program_run.stdout + program_run.stderr)
        shown = page.run(SHOWN)
        path = program.case_files(out)[0]
        self.assertEqual(shown["id"], path.stem)
        with h5py.File(path) as file:
            frames = file["surface/u_z"][:, 0]
            self.assertEqual(list(frames.shape), shown["shape"])
            for column in ("eta_at_1", "eta_period_1", "peak_um", "focal_rms_um", "participation_at_mm2"):
                value = float(file[column][()])
                if numpy.isfinite(value):
                    self.assertLessEqual(abs(shown["columns"][column] - value), 1e-6 * abs(value), column)
            eta = next(value for value in (float(file[name][()]) for name in ("eta_period_1", "eta_at_1")) if numpy.isfinite(value))
        self.assertAlmostEqual(float(shown["energy"].partition(" %")[0]), 100 * eta, delta=100 * 5e-3 * eta)  # three digits are shown
        field = numpy.frombuffer(base64.b64decode(page.run(FRAMES)), "<f4").reshape(-1, *frames.shape[1:])
        self.assertEqual(len(field), 12)
        self.assertLessEqual(numpy.abs(field - frames[9::10]).max(), 1e-6 * numpy.abs(frames).max())

    @pytest.mark.extended
    def test_moved_sliders_show_what_run_computes(self):
        page = self.open()
        self.assertEqual(page.run("explorer.surface.gl !== null"), True)
        loads = [page.run(f"{MOVE}('{name}', {value})") for name, value in
                 (("speed", 6), ("am", 350), ("fwhm", 5.2), ("peak", 120), ("depth", 0.8), ("speed", 8.5), ("am", 240), ("fwhm", 6))]
        self.assert_equal_to_run(page, "load")
        page.run("Array.from(document.querySelectorAll('#controls button')).find(b => b.textContent === 'Edit the layers').click()")
        self.assertTrue(page.wait("!explorer.active && explorer.shown.layers"))
        media = [page.run(f"{MOVE}('layer1.{name}', {value})") for name, value in
                 (("c_s_m_s", 4.2), ("viscosity_Pa_s", 0.8), ("thickness_mm", 15), ("c_s_m_s", 5.5))]
        self.assert_equal_to_run(page, "medium")
        page.run("explorer.draws.length = 0; explorer.play(true)")
        page.run("new Promise(done => setTimeout(done, 2000))")
        pictures = page.run("(d => 1000 * (d.length - 1) / (d.at(-1) - d[0]))(explorer.draws)") or 0
        # Stated for the record; a busy machine may be slower.
        print(f"changed load {statistics.median(loads):.0f} ms, changed medium {statistics.median(media):.0f} ms (medians), "
              f"{pictures:.0f} pictures per second", file=sys.stderr)
        self.assertEqual(page.errors(), [])

    @pytest.mark.long
    def test_every_kind_of_setting_is_computed(self):
        page = self.open()
        for change in ("s.kind = 'STM'", "s.kind = 'SM-STM'", "s.kind = 'AM'", "s.kind = 'LM'", "s.kind = 'AM-STM'; s.path = 'circle'",
                       "s.path = 'drawn'; s.drawn = [[-20, 0], [0, 10], [20, -5]]", "s.preset = 'ecoflex'", "s.preset = 'three-layer-skin'",
                       "s.preset = 'ecoflex'; s.base = 'rigid'; s.layers = structuredClone(PRESETS.ecoflex.layers)",
                       "s.layers = structuredClone(PRESETS['three-layer-skin'].layers); s.base = 'half-space'", "s.layers = null; s.receptors = true"):
            with self.subTest(change=change):
                self.use(page, change, "explorer.waits_ms.length || explorer.parts.state.classList.contains('error')")
                self.assertEqual(page.run("explorer.parts.state.className"), "", page.run("explorer.parts.state.textContent"))
        self.assertGreater(page.run("explorer.result.arrays['afferents/x'].length"), 10)
        self.assertEqual(page.errors(), [])

    @pytest.mark.extended
    def test_the_presets_of_the_page_are_those_of_the_program(self):
        page = self.open()
        names = page.run("Object.keys(PRESETS)")
        self.assertGreaterEqual(len(names), 4)
        for name in names:
            texts = [page.run(f"jobText({{...explorer.settings, preset: '{name}', base: PRESETS['{name}'].base, layers: {layers}}})")
                     for layers in ("null", f"structuredClone(PRESETS['{name}'].layers)")]
            self.assertIn("preset", texts[0])
            self.assertNotIn("preset", texts[1])
            ids = [list(shearwake.Job(text).plan().cases.index) for text in texts]
            self.assertEqual(*ids, name)

    @pytest.mark.extended
    def test_a_link_restores_the_settings_and_hides_the_token(self):
        page = self.open()
        page.run(f"{MOVE}('speed', 9)")
        page.run("document.getElementById('link').click()")
        link = page.run("explorer.copied")
        self.assertNotIn("token", link)
        self.assertNotIn(self.server.token, link)
        again = self.browser.open(link, 1280, 900)  # the cookie replaces the token
        self.assertTrue(again.wait("typeof explorer === 'object' && explorer.waits_ms.length > 0"))
        self.assertEqual(again.run("explorer.settings.speed"), 9)
        self.assertEqual(again.run("document.querySelector('[data-setting=speed] output').value"), "9.0 m/s")

    @pytest.mark.long
    def test_hostile_links_keep_the_defaults(self):
        for text in ("#s=%%%", "#s=" + "A" * 30000, "#s=bnVsbA", "#s=eyJwcmVzZXQiOiJfX3Byb3RvX18iLCJzcGVlZCI6IjxpbWc-In0"):
            with self.subTest(text=text[:30]):
                page = self.open(more=text)
                self.assertEqual(page.run("JSON.stringify(explorer.settings) === JSON.stringify(DEFAULTS)"), True)

    @pytest.mark.long
    def test_settings_are_pinned_and_compared(self):
        page = self.open()
        page.run("document.getElementById('pin').click()")
        page.run(f"{MOVE}('speed', 3)")
        page.run("document.getElementById('pin').click()")
        self.assertEqual(page.run("document.querySelectorAll('.pinned canvas').length"), 2)
        etas = page.run("Array.from(document.querySelectorAll('.pinned dd:first-of-type'), d => d.textContent)")
        self.assertEqual(len(set(etas)), 2)
        page.run("document.querySelector('.pinned button').click()")  # Use
        self.assertTrue(page.wait("explorer.shown.speed === DEFAULTS.speed"))
        page.run("document.querySelectorAll('.pinned button')[1].click()")  # Remove
        self.assertEqual(page.run("document.querySelectorAll('.pinned').length"), 1)

    @pytest.mark.extended
    def test_the_page_sends_the_shown_setting_to_a_sweep(self):
        page = self.open()
        self.use(page, "s.steady = false")
        page.run("document.getElementById('to-sweep').click()")
        page.run("for (const [id, v] of [['from', 4], ['to', 8], ['count', 2]]) document.getElementById('sweep-' + id).value = v")
        page.run("document.getElementById('sweep-start').click()")
        self.assertTrue(page.wait("document.querySelectorAll('#sweep-table tbody tr').length === 2"),
                        page.run("document.getElementById('sweep-state').textContent"))
        self.assertEqual(page.run("document.querySelector('#sweep-table td').textContent"), "4.000")
        self.assertEqual(page.run("explorer.sweeps.curve.plot.axes[0].label"), "Focus speed (m/s)")
        curve = page.run("explorer.sweeps.curve.plot.data.map(values => Array.from(values))")
        self.assertEqual(curve[0], [4, 8])
        self.assertEqual(len(curve[1]), 2)
        self.assertTrue(page.wait("!document.getElementById('sweep-report').hidden"))
        report = self.browser.open(self.server.address.split("?")[0] + f"report/{page.run('explorer.sweeps.report')}", 1280, 900)
        self.assertGreater(report.run("document.querySelectorAll('figure').length"), 0)
        self.assertEqual(report.errors(), [])
        page.run("document.querySelector('#sweep-table button').click()")
        self.assertTrue(page.wait("!explorer.active && explorer.shown.speed === 4"))

    @pytest.mark.long
    def test_a_finer_grid_changes_neither_the_view_nor_the_path(self):
        page = self.open()
        views = []
        for spacing in (1, 0.7):
            page.run(f"(() => {{ explorer.settings.spacing = {spacing}; explorer.waits_ms.length = 0; explorer.change(); }})()")
            self.assertTrue(page.wait("explorer.waits_ms.length"))
            views.append(page.run("(r => [explorer.overlay.extent, r.focus(r.frames - 1), r.time[r.frames - 1], r.column('eta_period_1').value])"
                                  "(explorer.result)"))
        self.assertEqual(views[0][:3], views[1][:3])
        # The grid samples a focus of 4.5 mm with 6 points and more.
        self.assertAlmostEqual(views[0][3], views[1][3], delta=0.02 * views[0][3])

    @pytest.mark.extended
    def test_results_are_worded_and_compared_with_the_pinned_setting(self):
        page = self.open()
        rows = "Array.from(document.querySelectorAll('#numbers dt'), (e, i) => [e.textContent, document.querySelectorAll('#numbers dd')[i].textContent])"
        labels = [label for label, _ in page.run(rows)]
        self.assertEqual(labels[:3], ["Efficiency η", "Focal rms", "Area that vibrates"])
        page.run("document.getElementById('pin').click()")
        page.run(f"{MOVE}('peak', 200)")
        texts = dict(page.run(rows))
        self.assertRegex(texts["Focal rms"], r"^[\d.]+ µm, 100 % more than pin 1$")  # the load is linear
        self.assertRegex(texts["Efficiency η"], "%, as pin 1$")
        self.assertRegex(texts["Level of sensation on the path"], "threshold, 6.0 dB more than pin 1$")
        page.run("document.getElementById('pin').click(); document.querySelector('.pinned input').click()")
        self.assertIn("100 % more than pin 1", dict(page.run(rows))["Focal rms"])
        self.use(page, "s.am = 400; s.steady = false; s.duration = 40")
        self.assertRegex(dict(page.run(rows))["Level of sensation on the path"], "in another band or duration than pin 1$|^unknown: ")
        self.assertNotIn("–", "".join(text for _, text in page.run(rows)))
        self.assertIn("into the skin", page.run("document.getElementById('scale-high').textContent"))
        self.assertIn("out of the skin", page.run("document.getElementById('scale-low').textContent"))
        self.assertLess(page.run("explorer.result.wake"), page.run("explorer.result.peak"))

    @pytest.mark.extended
    def test_the_level_of_sensation_has_a_map_with_its_threshold_in_the_middle_of_the_scale(self):
        page = self.open()
        self.use(page, "s.steady = false")
        page.run("(s => { s.value = 'level'; s.dispatchEvent(new Event('change')); })(document.getElementById('style'))")
        # The path of 12 ms is too short for a level: the map shows the displacement, and the reason is a hint.
        low, hint = page.run("(e => [e.textContent, e.title])(document.getElementById('scale-low'))")
        self.assertRegex(low, "^no level of sensation, instead: out of the skin")
        self.assertRegex(hint, r"^the load has the frequencies 125 and 200 Hz, which have no common period")
        self.use(page, "s.kind = 'AM'; s.am = 200")
        most, peak = page.run("(r => [Math.max(...r.level.filter(value => !Number.isNaN(value))), r.column('felt_peak_dB').value])(explorer.result)")
        self.assertAlmostEqual(most, peak, places=3)  # single precision
        low, high = (page.run(f"document.getElementById('scale-{end}').textContent") for end in ("low", "high"))
        self.assertRegex(low, r"^below the threshold −[1-9]0 dB$")
        self.assertRegex(high, r"^[1-9]0 dB above it$")
        self.assertRegex(page.run("document.querySelector('[data-column=felt_path_dB]').textContent"),
                         r"dB (above|below) threshold$")
        self.assertEqual(page.errors(), [])

    @pytest.mark.long
    def test_mach_lines_need_a_straight_path_that_is_supersonic(self):
        page = self.open()
        self.use(page, "s.path = 'line'; s.steady = false")
        angle = "(explorer.play(false), explorer.show(60), explorer.overlay.mach_deg)"
        self.assertIsNotNone(page.run(angle))
        page.run(f"{MOVE}('speed', 3)")
        self.assertIsNone(page.run(angle))
        self.use(page, "s.speed = 9; s.path = 'circle'")
        self.assertIsNone(page.run(angle))

    @pytest.mark.long
    def test_a_dragged_slider_yields_results_steadily(self):
        page = self.open()
        results = page.run("""(async () => {
          explorer.settings.spacing = 0.5;  // slow cases
          const before = explorer.waits_ms.length, speed = document.querySelector('[data-setting="speed"] input');
          for (let k = 0; k < 40 || (explorer.waits_ms.length - before < 2 && k < 600); ++k) {
            speed.value = 5 + 0.1 * (k % 40);
            speed.dispatchEvent(new Event("input"));
            await new Promise(done => setTimeout(done, 50));
          }
          return explorer.waits_ms.length - before;
        })()""")
        self.assertGreaterEqual(results, 2)

    @pytest.mark.extended
    def test_an_outdated_result_is_dimmed_and_a_lost_request_repeated(self):
        page = self.open()
        page.run("explorer.source.socket.close()")
        self.assertTrue(page.wait("explorer.is_offline"))
        self.assertTrue(page.run("document.querySelector('main').classList.contains('outdated')"))
        self.assertIn("Not connected", page.run("document.getElementById('state').textContent"))
        self.assertTrue(page.wait("!explorer.is_offline && !explorer.active && !document.querySelector('main').classList.contains('outdated')"))

    @pytest.mark.long
    def test_receptors_have_valid_readings(self):
        page = self.open()
        self.use(page, "s.receptors = true")
        self.assertEqual(page.run("explorer.result.header.warnings.filter(w => w.severity === 'error' && w.key.startsWith('afferents'))"), [])
        self.assertGreater(page.run("explorer.result.arrays['afferents/x'].length"), 10)

    @pytest.mark.extended
    def test_the_keyboard_moves_the_probe_and_starts_and_stops_the_playback(self):
        page = self.open()
        page.run("explorer.tour.end(); document.getElementById('overlay').focus()")
        page.press("ArrowRight", 39)
        page.press("ArrowUp", 38)
        self.assertEqual(page.run("explorer.overlay.probe"), [1, 1])
        self.assertEqual(page.run("document.getElementById('probe-at').value"), "(1 mm, 1 mm)")
        self.assertFalse(page.run("explorer.is_playing"))  # the system prefers reduced motion
        for plays in (True, False):
            page.press(" ", 32)
            self.assertEqual(page.run("explorer.is_playing"), plays)

    @pytest.mark.extended
    def test_every_control_has_a_name(self):
        page = self.open()
        page.run("explorer.settings.layers = structuredClone(PRESETS.forearm.layers); explorer.controls.build()")
        nameless = page.run("""Array.from(document.querySelectorAll('input, select, button, textarea, canvas[tabindex]')).filter(e =>
            !(e.labels && e.labels.length) && !e.getAttribute('aria-label') && !e.getAttribute('aria-labelledby') && !e.textContent.trim())
            .map(e => e.outerHTML)""")
        self.assertEqual(nameless, [])

    @pytest.mark.extended
    def test_the_tour_leads_through_the_page(self):
        page = self.open()
        page.run("explorer.tour.show(0)")
        steps = page.run("STOPS.length")
        for _ in range(steps):
            self.assertFalse(page.run("document.getElementById('tour').hidden"))
            covered = page.run("""(() => { const a = explorer.tour.target.getBoundingClientRect(), b = document.getElementById('tour').getBoundingClientRect();
              return Math.max(0, Math.min(a.right, b.right) - Math.max(a.left, b.left)) * Math.max(0, Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top))
                / (a.width * a.height); })()""")
            self.assertEqual(covered, 0)
            page.run("document.getElementById('tour-next').click()")
        self.assertTrue(page.run("document.getElementById('tour').hidden"))

    @pytest.mark.extended
    def test_the_page_fits_a_desktop_and_a_phone(self):
        for width in (1280, 390):
            with self.subTest(width=width):
                page = self.open(width)
                if width < 700:
                    tops = page.run("['numbers', 'controls'].map(id => document.getElementById(id).getBoundingClientRect().top)")
                    self.assertLess(tops[0], tops[1])
                self.assertLessEqual(page.run("document.documentElement.scrollWidth"), width)
                # Names of results have at most two lines, the selected modulation is not cut, and the scale can be read.
                lines = page.run("""Array.from(document.querySelectorAll("#numbers dt"),
                    part => Math.round(part.firstChild.parentElement.getClientRects()[0].height / parseFloat(getComputedStyle(part).lineHeight)))""")
                self.assertLessEqual(max(lines), 2, lines)
                self.assertGreater(page.run("document.getElementById('scale-map').getBoundingClientRect().width"), 200)
                room = page.run("""(select => { const context = document.createElement("canvas").getContext("2d");
                    context.font = getComputedStyle(select).font;
                    return select.clientWidth - Math.max(...Array.from(select.options, option => context.measureText(option.text).width)); })(
                    Array.from(document.querySelectorAll("#controls select")).find(s => Array.from(s.options).some(o => o.text.startsWith("SM-STM"))))""")
                self.assertGreater(room, 36)  # padding and arrow
                # Without playback, as here, the page does not begin with the skin at rest.
                self.assertGreater(page.run("Math.max(...explorer.result.shown(explorer.frame, 'map').map(Math.abs)) / explorer.result.wake"), 0.5)
                self.assertEqual(page.errors(), [])
