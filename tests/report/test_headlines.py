# SPDX-License-Identifier: BSD-3-Clause
"""What the report states as its result, and the warnings that it prints: readings that are not valid, missing
cases, numerical parameters, numerical errors."""
import math
from unittest import mock

import pytest
from synthetic import AM, PHYSICS, Folder, InFolder, Page, case_id, plain

from shearwake.checksum import sealed
from shearwake.report import answer, layout, load, sample, validity, warnings_of
from shearwake.report.figures import fig_measures
from shearwake.report.page import curve_chart, opening
from shearwake.report.summary import summary

ENGINE = "solver.engine"
KIND = "load.modulation.kind"
RETURNS = {"severity": "warning", "key": "domain.extent_mm", "message": "waves return at 4.8 ms"}
INVALID = {**RETURNS, "severity": "error"}
WINDOW = {"severity": "warning", "key": "measure.at_ms", "message": "the path ends at 3 ms"}


class HeadlineTest(InFolder):
    def folder(self, etas, key=AM, **options):
        """One case per efficiency, with the key at 100, 200, ..."""
        folder = Folder(self.root, x=key, swept=[key], **options)
        for n, eta in enumerate(etas):
            folder.add({key: 100.0 * (n + 1)}, scalars={"eta_period_1": eta})
        return folder

    def result(self, folder):
        return plain(summary(load.load(folder.save())))

    def errors(self, folder, errors):
        """The errors of eta of some cases, as `shearwake converge` stores them."""
        (folder.path / "converge").mkdir()
        (folder.path / "converge" / "converge.json").write_text(sealed({"schema": 1, "cases": [
            {"id": i, "columns": {"eta_period_1": {"error": e}}} for i, e in errors.items()]}))

    def test_a_reading_that_is_not_valid_is_not_a_result(self):
        folder = Folder(self.root)
        folder.add({AM: 100.0}, scalars={"eta_period_1": 0.8}, warnings=[INVALID])
        folder.add({AM: 200.0}, scalars={"eta_period_1": 0.3}, warnings=[RETURNS])
        text = self.result(folder)
        self.assertIn("of the only valid case, at AM frequency 200 Hz, is 30 %.", text)
        self.assertIn("1 of 2 complete cases is not valid and is not used: waves return at 4.8 ms.", text)
        self.assertNotIn("0.8", text)

    def bone(self, etas, labels=True):
        """A case with and one without a bone at each of some depths, of which the first is 5 mm: pairs of efficiencies."""
        speed, depth = "medium.body[1].c_s_m_s", "medium.body[1].depth_mm"
        root = self.root / str(len(list(self.root.iterdir())))
        root.mkdir()
        folder = Folder(root, x=depth, swept=[depth, speed], series=[speed])
        for n, pair in enumerate(etas):
            for c, eta in zip((1600.0, 5.0), pair):
                folder.add({depth: 5.0 + n, speed: c}, scalars={"eta_period_1": eta, "focal_rms_um": 1.0 if c == 5.0 else 0.5})
        selection = load.load(folder.save())
        if labels:
            selection.sweep.__dict__["_labels_of_values"] = {(speed, 1600.0): "with bone", (speed, 5.0): "without bone"}
        return selection

    def test_without_an_efficiency_of_the_same_case_without_the_body_only_the_place_is_stated(self):
        selection = self.bone([(0.5, math.nan)])
        self.assertEqual(opening.of_case(selection, selection.cases[0], "eta_period_1", "the place")[::2], ("50\N{NO-BREAK SPACE}%", "the place"))

    def test_the_pair_whose_efficiency_changes_most_is_the_answer(self):
        for etas, best in (
                ([(0.2, 0.4), (0.4, 0.4)], "5 mm: 20 % instead of the 40 % without bone (0.5 times). The ratio is 1 with body 1 at a depth of 6 mm."),
                ([(0.4 + 0.1 * n, 0.4) for n in range(6)],
                 "10 mm: 90 % instead of the 40 % without bone (2.25 times). In the other 5 pairs the ratio is 1 to 2.")):
            text = plain(summary(self.bone(etas)))
            self.assertIn(f"With bone the efficiency η changes most with body 1 at a depth of {best}", text)
            self.assertIn("The focal rms is 0.5 times that without bone.", text)
        self.assertEqual([plain(versus) for _, _, versus in opening.numbers(self.bone([(0.5, 0.4), (0.6, 0.4)]))][:2],
                         ["with bone, 6 mm deep; 40 % without bone", "with bone, 6 mm deep; 1 µm without bone"])

    def test_without_a_label_a_swept_body_is_not_called_absent(self):
        self.assertIn("is highest with body 1 at a depth of", summary(self.bone([(0.5, 0.4), (0.6, 0.4)], labels=False)))

    def test_cases_without_a_mean_over_periods_are_counted(self):
        text = self.result(self.folder([0.2, 0.4, math.nan]))
        self.assertIn("Of the 2 valid cases, the efficiency η is highest at AM frequency 200 Hz, the end of the range of valid cases: 40 %.", text)
        self.assertIn("1 case has no mean over complete periods and cannot be compared.", text)

    def test_engines_do_not_compete(self):
        folder = Folder(self.root, x=ENGINE, swept=[ENGINE])
        for engine, eta in (("layered", 0.40), ("spectral", 0.41)):
            folder.add({ENGINE: engine}, scalars={"eta_period_1": eta})
        text = self.result(folder)
        self.assertIn("is 40 to 41 %: the two engines differ by 2.5 %.", text)
        self.assertNotIn("best", text)

    def test_the_difference_between_engines_is_not_a_numerical_error(self):
        folder = Folder(self.root, series=[ENGINE], swept=[AM, ENGINE])
        for f, etas in ((100.0, (0.40, 0.42)), (200.0, (0.41, 0.43)), (300.0, (0.20, 0.21))):
            for engine, eta in zip(("layered", "pstd"), etas):
                folder.add({AM: f, ENGINE: engine}, scalars={"eta_period_1": eta})
        text = self.result(folder)
        # 0.41 to 0.43 is 4.8 % of the mean. 0.42 differs from 0.43 by less than 0.02; 0.21 does not.
        self.assertTrue(text.startswith("No noticeable difference in the efficiency η: AM frequency 200 Hz (43 %) and 100 Hz (42 %), within the "
                                        "difference between the two engines. The efficiency η is lowest at AM frequency 300 Hz (21 %)."), text)
        self.assertNotIn("pstd", text)
        self.assertIn("The two engines differ by 4.8 % in the efficiency η there. Numerical error not estimated", text)

    def test_differences_are_stated_relative_to_the_estimated_error(self):
        folder = self.folder([0.300, 0.500, 0.501])
        self.errors(folder, {case_id(1): 0.003})  # 1 %
        text = self.result(folder)
        self.assertIn("The numerical error of the efficiency η is 1 % of its value (error estimated at AM frequency 100 Hz).", text)
        self.assertIn("AM frequency 300 Hz (50.1 %) and 200 Hz (50 %), within the numerical error.", text)

    def test_the_error_of_the_case_itself_names_no_other_case(self):
        folder = self.folder([0.3, 0.5])
        self.errors(folder, {case_id(1): 0.03, case_id(2): 0.005})
        self.assertIn("is highest at AM frequency 200 Hz, the end of the swept range: 50.00 ± 0.50 %.", self.result(folder))

    def test_the_error_of_a_case_that_is_not_valid_is_not_transferred(self):
        folder = Folder(self.root)
        for f, warnings in ((100.0, [INVALID]), (200.0, []), (300.0, [])):
            folder.add({AM: f}, scalars={"eta_period_1": 0.001 * f}, warnings=warnings)
        self.errors(folder, {case_id(1): 0.05})
        self.assertIn("Numerical error not estimated: run shearwake converge.", self.result(folder))
        self.assertFalse(curve_chart.have_errors(load.load(folder.path), "eta_period_1"))

    def with_reference(self, etas, below, **reference):
        """One case per pair (eta, warnings) and a common reference with this eta."""
        folder = Folder(self.root)
        for n, (eta, warnings) in enumerate(etas):
            folder.add({AM: 100.0 * (n + 1)}, case_id(len(etas) + 1), scalars={"eta_period_1": eta}, warnings=warnings)
        folder.add({}, is_reference=True, kind="STM", scalars={"eta_period_1": below}, **reference)
        return folder

    def test_the_error_of_a_reference_alone_is_not_that_of_the_ratio(self):
        folder = self.with_reference([(0.3, []), (0.5, [])], 0.2)
        self.errors(folder, {case_id(3): 0.002})  # 1 %
        text = self.result(folder)
        self.assertIn("50 %, 2.5 times the 20 % of plain STM.", text)
        self.assertNotIn("±", text)

    def test_a_reference_that_is_not_valid_is_not_compared(self):
        text = self.result(self.with_reference([(0.3, []), (0.5, [])], 0.2, warnings=[INVALID]))
        self.assertIn("is highest at AM frequency 200 Hz, the end of the swept range: 50 %.", text)
        self.assertIn("1 of 3 complete cases is not valid and is not used (a reference): waves return", text)
        self.assertIn("No ratio is stated for 2 valid cases, because the readings of the reference are not valid.", text)
        self.assertIn("The focal rms is 1.5 µm.", text)
        self.assertNotIn("plain STM", text)

    def test_a_case_that_is_its_own_reference_has_a_valid_reference(self):
        kind = "load.modulation.kind"
        folder = Folder(self.root, series=[kind], swept=[AM, kind])
        for n, f in enumerate((150.0, 250.0)):
            folder.add({AM: f, kind: "STM"}, case_id(2 * n + 1), kind="STM", scalars={"eta_period_1": 0.2})
            folder.add({AM: f, kind: "AM-STM"}, case_id(2 * n + 1), scalars={"eta_period_1": 0.3 + 0.1 * n})
        text = self.result(folder)
        self.assertNotIn("the readings of the reference are not valid", text)
        self.assertIn("2 times the 20 % of STM", text)
        panels = layout.panels(load.load(folder.path))
        self.assertEqual([(plain(p.title), len(p.cases)) for p in panels], [("modulation STM", 2), ("modulation AM-STM", 2)])

    def test_a_case_that_is_the_reference_of_others_is_counted_once(self):
        kind = "load.modulation.kind"
        folder = Folder(self.root, x=kind, swept=[kind])
        folder.add({kind: "STM"}, case_id(1), kind="STM", warnings=[INVALID])
        folder.add({kind: "AM-STM"}, case_id(1), warnings=[INVALID])
        sweep = load.load(folder.save())
        self.assertEqual(len(validity.invalid_cases(sweep, "eta", "eta_period_1")), 2)
        self.assertEqual(len(layout.with_references(sweep)), 2)

    @pytest.mark.extended
    def test_the_page_marks_the_values_of_the_command_line(self):
        folder = Folder(self.root, job="schema = 1\n[load]\npeak_Pa = 87.5 # -S; in the file: 100\n")
        folder.add({AM: 100.0}, snapshot=False)
        page = folder.report()
        self.assertIn("<summary>Job file, with 1 value of the command line (-S)</summary>", page)
        self.assertIn("<mark>peak_Pa = 87.5 # -S; in the file: 100</mark>", page)

    def test_a_statistic_of_too_few_samples_says_so_where_it_is_stated(self):
        def row(statistic, value, note=""):
            return {"column": "eta_period_1", "statistic": statistic, "value": value, "low_95": value - 0.1, "high_95": value,
                    "samples": 23.0, "without_value": 2.0, "note": note}
        rows = [row("q05", 0.2, "too few samples: 1 values"), row("q50", 0.3), row("q95", 0.4),
                row("exceeds 0.1", 1.0, "too few samples: 0 values")]
        folder = Folder(self.root)
        folder.add({AM: 100.0})
        sweep = load.load(folder.save())
        sweep.sweep.uncertain = {"keys": [AM], "exceedance": {"eta_period_1": 0.1}}
        with mock.patch.object(sample, "read_statistics", lambda *_: rows):
            text = plain(" ".join(sample.sentences(sweep)))
            with mock.patch.object(opening, "read_statistics", lambda *_: rows):
                probability = opening.numbers(sweep)[0]
        self.assertIn("Over 23 of 25 samples", text)
        self.assertIn("between 20 % and 40 % (too few samples: 1 values).", text)
        self.assertTrue(text.startswith("The efficiency η exceeds 10 % in 100 % of the samples (95 % confidence interval of the probability 90 to 100 "
                                        "%); too few samples: 0 values."), text)
        self.assertEqual(probability[0], "90 to 100\N{NO-BREAK SPACE}%")

    @pytest.mark.extended
    def test_each_warning_is_stated_in_the_list_and_at_the_first_figure_that_it_concerns(self):
        folder = Folder(self.root)
        for f in (100.0, 200.0, 300.0):
            folder.add({AM: f}, warnings=[{**RETURNS, "message": f"the waves of this job return after {f} ms"}] if f < 300.0 else [],
                       notes={"mach_angle_deg": "the wake has no single angle"})
        page = folder.report()
        self.assertEqual(page.count("the waves of this job return after"), 2)
        self.assertIn('<a href="#warning-1">warning 1</a>', page)
        self.assertEqual(Page(page).column("note")[2]["text"], "note 1")
        self.assertEqual(page.count("Mach angle: the wake has no single angle"), 1)

    def test_silent_receptors_have_no_number_and_equal_rates_of_a_class_no_place(self):
        folder = Folder(self.root)
        for f in (100.0, 200.0):
            folder.add({AM: f}, scalars={"RA_total_rate_Hz": 0, "PC_total_rate_Hz": 7})
        self.assertEqual(opening.of_receptors(load.load(folder.save())), [("7\N{NO-BREAK SPACE}spikes/s", "of all PC afferents together", "")])

    def test_statistics_of_the_highest_median_name_its_settings(self):
        rows = [{"column": "eta_period_1", "statistic": q, "value": value + 0.1 * (kind == "SM-STM"), "note": "",
                 "low_95": value + 0.1 * (kind == "SM-STM") - 0.01, "high_95": value + 0.1 * (kind == "SM-STM") + 0.01, KIND: kind}
                for kind in ("AM-STM", "SM-STM") for q, value in (("q05", 0.2), ("q50", 0.3), ("q95", 0.4))]
        folder = Folder(self.root, swept=[AM, KIND])
        for kind in ("AM-STM", "SM-STM"):
            folder.add({AM: 100.0, KIND: kind}, kind=kind)
        sweep = load.load(folder.save())
        sweep.sweep.uncertain = {"keys": [AM], "exceedance": {}}
        with mock.patch.object(opening, "read_statistics", lambda *_: rows), mock.patch.object(sample, "read_statistics", lambda *_: rows):
            self.assertEqual([(value, place) for value, _, place in opening.numbers(sweep)],
                             [("40\N{NO-BREAK SPACE}%", "with SM-STM, the highest median"), ("30 to 50\N{NO-BREAK SPACE}%", "with SM-STM, the highest median")])

    @pytest.mark.extended
    def test_the_table_of_the_page_states_which_cases_are_valid(self):
        folder = Folder(self.root)
        folder.add({AM: 100.0}, warnings=[INVALID])
        folder.add({AM: 200.0}, warnings=[RETURNS])
        folder.add({AM: 300.0}, written=False)
        self.assertEqual([cell["text"] for cell in Page(folder.report()).column("valid")], ["no", "yes", ""])

    def test_the_number_of_valid_cases_is_stated_if_none_is_better_than_the_reference(self):
        text = self.result(self.with_reference([(0.3, []), (0.5, [INVALID]), (0.2, [])], 0.4))
        self.assertIn("Of the 2 valid cases, the efficiency η is highest at AM frequency 100 Hz", text)
        self.assertIn("30 %, 0.75 times the 40 % of plain STM.", text)
        self.assertIn("No case exceeds plain STM under the same conditions.", text)
        self.assertIn("1 of 4 complete cases is not valid", text)

    EDGE = ("waves return at 4.8 ms. On the edges of the domain, u_z^2 is {} % of its mean: the readings of this case are "
            "not valid")

    def test_messages_of_several_cases_are_one_with_ranges(self):
        folder = self.with_reference([(0.3, []), *((0.5, [{**INVALID, "message": self.EDGE.format(v)}])
                                                   for v in ("8.1", "16", "9e+01"))], 0.4)
        self.assertIn("3 of 5 complete cases are not valid and are not used: on the edges of the domain, u_z^2 is 8.1 to "
                      "9e+01 % of its mean.", self.result(folder))
        kind, = warnings_of.kinds(load.load(folder.path))
        self.assertEqual(kind.message, "waves return at 4.8 ms. On the edges of the domain, u_z^2 is 8.1 to 9e+01 % of its "
                                       "mean: the readings are not valid")
        self.assertEqual(warnings_of.merged([self.EDGE.format(16)]), self.EDGE.format(16))

    @pytest.mark.extended
    def test_the_headline_and_the_list_count_the_same_cases(self):
        folder = self.with_reference([(0.3, []), (0.5, [INVALID]), (0.2, [INVALID])], 0.4, warnings=[INVALID])
        page = Page(folder.report())
        self.assertIn("3 of 4 complete cases are not valid and are not used (1 of them a reference)", page.data)
        self.assertIn("Not valid: waves return at 4.8 ms (3 cases, 1 of them a reference).", page.data)

    def test_without_a_valid_efficiency_the_firing_rate_is_the_result(self):
        folder = Folder(self.root)
        for f, counts in ((100.0, (0, 1)), (200.0, (0, 23293))):
            folder.add({AM: f}, scalars={"RA_total_rate_Hz": counts[0], "PC_total_rate_Hz": counts[1]}, warnings=[INVALID])
        loaded = load.load(folder.save())
        self.assertTrue(summary(loaded).startswith("No result is stated"))  # the skin moves the receptors
        loaded = load.load(folder.path)
        for case in loaded.cases:
            case.parameters["afferents"] = {"input": "carrier"}
        text = plain(summary(loaded))
        self.assertTrue(text.startswith("The firing rate of all PC afferents together is highest at AM frequency 200 Hz, the end of the "
                                        "swept range: 23300 spikes/s."), text)

    @pytest.mark.extended
    def test_warnings_are_printed_next_to_the_figures_that_they_concern(self):
        folder = Folder(self.root)
        folder.add({AM: 100.0}, warnings=[RETURNS, WINDOW])
        folder.add({AM: 200.0}, warnings=[{**RETURNS, "message": "waves return at 5.1 ms"}])
        page = Page(folder.report())
        self.assertEqual(page.data.count("Warning: waves return at 4.8 to 5.1 ms (2 cases)."), 1)
        self.assertIn("Warnings about the cases shown: waves return at 4.8 to 5.1 ms (2 cases); the path ends at 3 ms (1 case).", page.data)
        self.assertIn("#warning-1", page.links)
        sweep = load.load(folder.path)
        self.assertEqual([w["message"] for w in sweep.cases[0].warnings],
                         [RETURNS["message"], WINDOW["message"]])
        self.assertEqual(warnings_of.of_figure(sweep, "drive"), [])
        self.assertEqual(len(warnings_of.of_figure(sweep, "raster_1")), 1)  # not that of the measures
        for case in sweep.cases:
            case.parameters["afferents"] = {"input": "carrier"}
        self.assertEqual(warnings_of.of_figure(sweep, "raster_1"), [])
        self.assertEqual(len(warnings_of.of_figure(sweep, "eta")), 2)
        table = (folder.path / "tables" / "s.md").read_text()
        self.assertIn("warning: domain.extent_mm: waves return at 5.1 ms", table)

    def test_of_many_best_cases_the_first_are_named(self):
        text = self.result(self.with_reference([(0.5, [])] * 5 + [(0.3, [])], 0.2))
        self.assertIn("is highest at AM frequency 100 Hz, 200 Hz and 3 further cases: 50 %, 2.5 times the 20 % of plain STM.", text)

    def kinds(self, levels, swept=("AM", "LM")):
        """One case per modulation, at rest if it is AM, with a level of sensation."""
        folder = Folder(self.root, x=KIND, swept=[KIND], job="# Which is felt strongest?\nschema = 1\n")
        for kind, level in zip(swept, levels):
            moves = '[[load.modulation.trajectory]]\nmover = "hold"\n' + ('' if kind.strip() == "AM" else '[[load.modulation.trajectory]]\nmover = "swing"\n')
            folder.add({KIND: kind}, kind=kind, snapshot=False, scalars={"felt_path_dB": level, "felt_peak_dB": level},
                       physics=PHYSICS.format(kind=kind).replace("[domain]", moves + "[domain]"))
        return folder

    def test_the_figure_and_the_table_of_levels_state_where_the_model_fails(self):
        page = Page(self.kinds([40.0, 30.0]).report())
        self.assertEqual(page.data.count("The model fails where the level compares loads at rest with loads that move, or LM with AM: see "
                                         "docs/explanation/user-studies.md."), 3)  # the result, the figure, the table

    @pytest.mark.extended
    def test_levels_of_loads_that_all_rest_have_no_such_line(self):
        self.assertNotIn("The model fails", Page(self.kinds([40.0, 30.0], swept=("AM", "AM ")).report()).data)

    def test_a_level_without_a_value_is_not_replaced_by_another_answer(self):
        folder = self.kinds([math.nan, math.nan])
        self.assertTrue(self.result(folder).startswith("The level of sensation on the path has no value in any case."))

    def test_a_reference_that_is_a_case_of_the_sweep_is_drawn_once(self):
        folder = Folder(self.root, x=KIND, swept=[KIND])
        for kind, eta in (("STM", 0.2), ("AM-STM", 0.3), ("SM-STM", 0.25)):
            folder.add({KIND: kind}, case_id(1), kind=kind, scalars={"eta_period_1": eta})
        sweep = load.load(folder.save())
        chart = curve_chart.curve_chart(sweep, "eta", "eta_period_1", "eta")
        self.assertEqual([(list(line.y), line.dashed) for line in chart.lines], [([0.2, 0.3, 0.25], False)])
        ratios, = curve_chart.curve_chart(sweep, "gain", "eta_period_over_reference_1", "gain").lines
        self.assertTrue(math.isnan(ratios.y[0]) and ratios.y[1] > 1.0)  # the dashed line at 1 is its own
        self.assertNotIn("Dashed lines", self.drawn(folder, fig_measures)[1]["eta"].caption)

    def test_the_answer_of_the_job_decides_before_its_words(self):
        job = 'schema = 1\n[job]\nquestion = "How strong is it?"\nanswer = "peak_um"\n'
        folder = Folder(self.root, job=job)
        for f in (100.0, 200.0):
            folder.add({AM: f}, scalars={"felt_peak_dB": 30.0, "peak_um": 0.01 * f})
        sweep = load.load(folder.save())
        self.assertEqual((answer.question(sweep), answer.column(sweep)), ("How strong is it?", "peak_um"))
        self.assertTrue(summary(sweep).startswith("The largest displacement is 1\N{NO-BREAK SPACE}µm (AM frequency 100"), summary(sweep))
