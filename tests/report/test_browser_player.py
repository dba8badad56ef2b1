# SPDX-License-Identifier: BSD-3-Clause
"""Tests of the player of surfaces in a headless chromium."""

import h5py
import pytest

import test_browser
from synthetic import case_id


class PlayerTest(test_browser.Pages):
    def at_start(self, width):
        """The page when the player has drawn its last time."""
        page = self.open(width)
        self.assertTrue(page.wait(f"{self.FRAMES}.every(frame => frame)"))
        self.assertEqual(page.run(self.CLOCK), "4 ms")
        return page

    @pytest.mark.extended
    def test_single_steps_and_the_slider_move_every_panel(self):
        for _, page in self.both(self.at_start):
            self.assertTrue(page.wait(f'{self.FRAMES}.every(frame => frame.endsWith("/1"))'))
            focus = """Array.from(document.querySelectorAll(".player canvas"),
                canvas => JSON.parse(canvas.dataset.focus)[0])"""
            late = page.run(focus)
            page.run('document.querySelector(".back").click()')
            self.assertTrue(page.wait(f'{self.FRAMES}.every(frame => frame.endsWith("/0"))'))
            self.assertEqual(page.run(self.CLOCK), "2 ms")
            dark = page.run("""(() => { const panel = document.querySelector(".player").player.panels[0];
                const [x, y] = panel.place(...panel.shown.focus[panel.frame()]);
                return Array.from(panel.canvas.getContext("2d").getImageData(Math.round(x), Math.round(y), 1, 1).data); })()""")
            self.assertLess(max(dark[:3]), 60)  # the point at the centre of the focal disc, on red
            for before, after in zip(page.run(focus), late):
                self.assertAlmostEqual(after - before, 14.0, places=2)  # 2 ms at 7 m/s
            page.run('document.querySelector(".player input").focus()')
            page.press("ArrowRight", 39)
            self.assertTrue(page.wait(f'{self.FRAMES}.every(frame => frame.endsWith("/1"))'))
            self.assertEqual(page.errors(), [])

    @pytest.mark.extended
    def test_a_load_that_repeats_starts_again_after_its_period(self):
        page = self.at_start(1280)
        found = page.run("""(() => { const player = document.querySelector(".player").player, panel = player.panels[0];
            panel.shown.times = [1, 2]; panel.shown.period = 2;
            player.retime();
            return [player.times, player.times.map((t, i) => { player.slider.value = i; return panel.frame(); })]; })()""")
        self.assertEqual(found, [[1, 2, 3, 4], [0, 1, 0, 1]])  # the other panel shows 2 and 4 ms

    @pytest.mark.extended
    def test_pointing_at_the_surface_shows_u_in_both_panels(self):
        for _, page in self.both(self.at_start):
            x, y = page.run("""(() => {
                const panel = document.querySelector(".player").player.panels[0];
                panel.canvas.scrollIntoView({block: "center"});
                const [x, y] = panel.place(28.0, 0.0), box = panel.canvas.getBoundingClientRect();
                return [box.left + x, box.top + y]; })()""")
            page.move(x, y)
            texts = 'Array.from(document.querySelectorAll(".player-panel output"), o => o.textContent)'
            self.assertTrue(page.wait(f'{texts}.every(text => text.startsWith("x "))'))
            for text in page.run(texts):  # the centre of a spot of 3 um, within a pixel of 1 mm
                self.assertRegex(text, r"^x 2[78][0-9.]* mm, y .* mm: u (2\.[5-9][0-9]*|3) µm$")

    @pytest.mark.extended
    def test_every_case_can_be_chosen_and_colours_follow_the_scale(self):
        page = self.at_start(1280)
        selects = page.run("""Object.fromEntries(Array.from(document.querySelector(".player-panel").querySelectorAll("label"),
            label => [label.firstChild.textContent.trim(), Array.from(label.querySelector("select").options, o => o.text)]))""")
        self.assertEqual(selects, {"Load": ["AM-STM", "plain STM"],
                                   "AM frequency": [f"{f}\N{NO-BREAK SPACE}Hz" for f in (100, 200, 400, 1000)]})
        choose = """(([n, value]) => { const choice = document.querySelectorAll(".player-panel select")[n];
            choice.value = value; choice.dispatchEvent(new Event("change")); })"""
        page.run(f"{choose}([0, 0])")
        page.run(f"{choose}([1, 1])")
        self.assertTrue(page.wait(f'{self.FRAMES}[0].startsWith("1/")'))
        hidden = 'document.querySelectorAll(".player-panel select")[1].parentElement.hidden'
        self.assertFalse(page.run(hidden))
        page.run(f"{choose}([0, 1])")  # the reference
        self.assertTrue(page.wait(f'{self.FRAMES}[0].startsWith("4/")'))
        self.assertEqual(page.run('document.querySelector(".player-panel .chosen").textContent'), "plain STM")
        self.assertTrue(page.run(hidden))  # all cases have this reference
        before = page.run('document.querySelector(".high").textContent')
        page.run("""(() => { const choice = document.querySelector(".scaling");
            choice.value = "half"; choice.dispatchEvent(new Event("change")); })()""")
        self.assertNotEqual(page.run('document.querySelector(".high").textContent'), before)

    @pytest.mark.extended
    def test_a_single_surface_has_no_controls_of_the_time(self):
        folder = self.new_folder(swept=(), x="")
        folder.add({})
        with h5py.File(folder.file(case_id(1)), "r+") as file:
            for name in ("time", "u_z"):
                last = file["surface"][name][-1:]
                del file["surface"][name]
                file["surface"][name] = last
        path = self.page_of(folder)
        for _, page in self.both(path=path):
            self.assertTrue(page.wait(f"{self.FRAMES}.every(frame => frame)"))
            self.assertFalse(page.run('!!document.querySelector(".play").offsetParent'))
            self.assertTrue(page.run('!!document.querySelector(".clock").offsetParent'))
            self.assertEqual(page.errors(), [])

    @pytest.mark.extended
    def test_play_moves_the_slider_and_pause_stops_it(self):
        for _, page in self.both(self.at_start):
            page.run('document.querySelector(".speed").value = "10"')
            page.run('document.querySelector(".play").click()')
            self.assertEqual(page.run('document.querySelector(".play").textContent'), "Pause")
            self.assertTrue(page.wait(f'{self.CLOCK} === "2 ms"'))
            page.run('document.querySelector(".play").click()')
            self.assertEqual(page.run('document.querySelector(".play").textContent'), "Play")
            self.assertEqual(page.errors(), [])
