# SPDX-License-Identifier: BSD-3-Clause
"""Adaptive axes, as users run them: refined curves, extrema, crossings, interruptions, equal commands and errors."""
import bisect
import contextlib
import json
import math
import os
import random
import signal

import pytest

from program import (AM, OPEN, ROOT, ProgramTest, case_files, changed_job, plan, plan_ids, read_csv, small_job, started, table,
                     without_reference)

SPEED, WAVES = "load.modulation.speed_m_s", "medium.layer[1].c_s_m_s"
PLAIN = {"record": None, **OPEN}  # otherwise waves return, and readings are not valid
# The shear waves have 5 m/s: the curve bends where the focus overtakes them. All cases share one transfer function.
REFINE = {"refine": [3, 7], "column": "eta_period_1", "tolerance": 0.002}
CURVE = small_job(PLAIN, {"table": {"x": SPEED}, "sweep": {SPEED: REFINE}})


def adaptive(out):
    return read_csv(out / "tables" / "small.adaptive.csv")


def curve(out, key=SPEED, column="eta_period_1"):
    return sorted((float(row[key]), float(row[column])) for row in table(out) if row["reference"] != "yes")


def interpolated(points, at):
    x = [p[0] for p in points]
    i = min(max(bisect.bisect_right(x, at), 1), len(x) - 1)
    (a, b), (c, d) = points[i - 1], points[i]
    return b + (d - b) * (at - a) / (c - a)


class Adaptive(ProgramTest):
    def tables_of(self, out):
        self.shearwake("reduce", out)
        return table(out), (out / "tables" / "small.adaptive.csv").read_bytes()

    @pytest.mark.long
    def test_a_refined_curve_stays_within_its_tolerance_of_a_fine_grid(self):
        self.write_job(CURVE)
        output = self.shearwake("plan", "job.toml").output
        self.contains(output, "9 cases", f"adaptive axis {SPEED}: 9 points in the first round, at most 200",
                      "the estimates above cover the first round only")
        output = self.shearwake("run", "job.toml", ranks=2).output
        self.contains(output, "adding", "the estimated error of eta_period_1 between the points is at most",
                      "next: shearwake reduce")
        self.shearwake("reduce", self.out)
        points = curve(self.out)
        self.assertGreater(len(points), 9)
        self.assertTrue(all(row["within_tolerance"] == "yes" for row in adaptive(self.out)))
        self.assertEqual(len(adaptive(self.out)), len(points) - 1)

        fine = f"sweep.\"{SPEED}\"={{ linspace = [3, 7, {3 * len(points)}] }}"
        self.reduced("fine", "-S", fine, "--quiet", ranks=2)
        grid = curve(self.folder / "fine")
        self.assertEqual(len(grid), 3 * len(points))
        for x, y in grid:
            self.assertLessEqual(abs(interpolated(points, x) - y), 0.002, f"at {x}")

        widest, narrowest = (f(b[0] - a[0] for a, b in zip(points, points[1:])) for f in (max, min))
        self.assertGreaterEqual(widest, 2 * narrowest, "the points are uniform")
        output = self.shearwake("report", self.out).output
        page = (self.out / "report" / "index.html").read_text(encoding="utf-8")
        self.assertIn('id="adaptive"', page)
        self.contains(self.shearwake("status", self.out).output, "next: shearwake reduce")
        self.contains(self.shearwake("run", "job.toml").output, "0 computed now")

        more = self.shearwake("run", "job.toml", "-S", "sweep.\"" + SPEED + "\".tolerance=0.001", ranks=2).output
        self.contains(more, "adding", "(tolerance 0.001)")
        self.shearwake("reduce", self.out)
        self.assertLess(set(points), set(curve(self.out)))

    @pytest.mark.long
    def test_kills_and_ranks_do_not_change_the_points(self):
        self.write_job(CURVE)
        self.shearwake("run", "job.toml", "--out", "whole", "--quiet")
        expected = self.tables_of(self.folder / "whole")
        chance = random.Random(5)
        for kill in range(4):
            process = self.start("run", "job.toml", "--quiet", ranks=2)
            wanted = len(case_files(self.out)) + chance.randint(1, 6)
            self.wait_for(lambda: len(case_files(self.out)) >= wanted or process.poll() is not None, "cases")
            with contextlib.suppress(ProcessLookupError):  # it has ended meanwhile
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()
        self.wait_for(lambda: not json.loads(self.shearwake("status", self.out, "--json").stdout)["is_active"], "the end")
        self.shearwake("run", "job.toml", "--quiet", ranks=3)
        self.assertEqual(self.tables_of(self.out), expected)
        self.assertEqual((self.out / "plan.json").read_bytes(), (self.folder / "whole" / "plan.json").read_bytes())

    def test_status_resumes_between_rounds(self):
        self.write_job(CURVE)
        first_ids = self.first_ids()
        self.shearwake("run", "job.toml", "--quiet", "--only", first_ids[0])
        self.shearwake("run", "job.toml", "--quiet")
        expected = plan_ids(self.out)
        removed = self.folder / "other"
        self.shearwake("run", "job.toml", "--quiet", "--out", removed, "--only", ",".join(first_ids))
        output = self.shearwake("status", removed).output
        self.contains(output, "9 done", "adaptive axes:", "to add", "next: shearwake run")
        command = next(line for line in output.splitlines() if line.startswith("next: shearwake ")).split()[2:]
        self.shearwake(*command)
        self.assertEqual(plan_ids(removed), expected)

    def first_ids(self):
        document = json.loads(self.shearwake("plan", "job.toml", "--json").stdout)
        self.assertEqual([axis["goal"] for axis in document["adaptive"]], ["refine"])
        return [case["id"] for case in document["cases"]]

    @pytest.mark.long
    def test_equal_commands_work_together(self):
        self.write_job(CURVE)
        self.shearwake("run", "job.toml", "--out", "whole", "--quiet")
        runs = [self.start("run", "job.toml", "--out", "together") for _ in range(2)]
        for run in runs:
            self.output_of(run, 0)
        self.assertEqual(len(started(self.folder / "together")), len(set(started(self.folder / "together"))))
        self.assertEqual(self.tables_of(self.folder / "together"), self.tables_of(self.folder / "whole"))

    @pytest.mark.long
    def test_extrema_are_searched_in_two_dimensions(self):
        search = {"find": "maximum", "column": "eta_period_1", "initial": 5}
        self.write_job(small_job(PLAIN, {"table": {"x": WAVES}, "sweep": {
            WAVES: {**search, "in": [3, 12], "tolerance": 0.6}, SPEED: {**search, "in": [4, 7], "tolerance": 0.5}}}))
        self.contains(self.shearwake("plan", "job.toml").output, "25 cases", "about 9 for one curve", "about 7 for one curve")
        output = self.shearwake("run", "job.toml", ranks=2).output
        self.contains(output, f"{WAVES}: maximum of eta_period_1 at", f"{SPEED}: maximum of eta_period_1 at")
        self.shearwake("reduce", self.out)
        rows = adaptive(self.out)
        self.assertEqual(len(rows), 2)
        best = max(table(self.out), key=lambda row: float(row["eta_period_1"]))
        for row in rows:
            self.assertEqual(row["value"], best["eta_period_1"])
            self.assertEqual(row["location"], best[row["key"]])
            self.assertEqual(row["within_tolerance"], "yes")
        self.shearwake("report", self.out)

    @pytest.mark.long
    def test_a_crossing_with_the_reference_is_found_for_each_curve(self):
        crossing = {"find": "crossing", "in": [3, 12], "column": "eta_period_1", "tolerance": 0.05}
        self.write_job(small_job(PLAIN, {"table.x": WAVES, "sweep": {WAVES: crossing, AM: [500, 1000]}}))
        output = self.shearwake("run", "job.toml", ranks=2).output
        self.shearwake("reduce", self.out)
        rows = adaptive(self.out)
        ratios = {f: [(float(row[WAVES]), float(row["eta_period_over_reference_1"]) - 1.0) for row in table(self.out)
                      if row["reference"] != "yes" and float(row[AM]) == f] for f in (500, 1000)}
        for frequency, points in ratios.items():
            points.sort()
            changes = [(a[0], b[0]) for a, b in zip(points, points[1:]) if (a[1] < 0) != (b[1] < 0)]
            found = [row for row in rows if row["settings"] == f"{AM} = {frequency}"]
            self.assertEqual([(float(r["from"]), float(r["to"])) for r in found], changes)
            if not changes:
                self.contains(output, f"no crossing of eta_period_1, {AM} = {frequency}")
            for low, high in changes:
                self.assertLessEqual(high - low, 0.05 + 1e-9)
        self.assertTrue(rows, "the curves never cross the reference")
        self.shearwake("report", self.out)

    def test_limits_are_reported(self):
        self.write_job(changed_job(CURVE, {"sweep": {SPEED: {**REFINE, "tolerance": 1e-9, "most": 12}}}))
        limit = "intervals exceed the tolerance because of the limits most = 12"
        done = json.loads(self.shearwake("run", "job.toml", "--json").stdout)  # one document for all rounds
        self.assertEqual((done["cases"], done["computed"], done["already_complete"]), (12, 12, 0))
        self.assertTrue(any(limit in sentence for sentence in done["adaptive"]), done["adaptive"])
        self.contains(done["next"], "shearwake reduce")
        self.contains(self.shearwake("run", "job.toml").output, "12 points", limit)
        self.assertEqual(len(plan(self.out)["cases"]), 12)
        self.contains(self.shearwake("run", "job.toml", "-S", "load.peak_Pa=50", expect=2).output, "another plan")
        self.contains(self.shearwake("run", "job.toml", "-S", f"sweep.\"{SPEED}\"=[3, 7]", expect=2).output, "another plan")

    @pytest.mark.extended
    def test_errors_are_reported_before_any_case_is_computed(self):
        for axis, message in (
                ({"refine": [7, 3]}, "must be two ascending numbers"), ({"refine": [3]}, "must be two ascending numbers"),
                ({"column": "eta_perod_1"}, 'did you mean "eta_period_1"?'),
                ({"tolerance": 0}, "above 0"), ({"tolerance": math.nan}, "tolerance"), ({"most": 2.5}, "most"), ({"level": 3}, "level"),
                ({"refine": None, "find": "maximun", "in": [3, 7]}, "maximum"), ({"refine": None, "find": "maximum"}, "in"),
                ({"refine": None, "find": "crossing", "in": [3, 7]}, "requires a level to cross, or a reference"),
                ({"refine": None, "find": "minimum", "in": [3, 1e5]}, "a millionth of the interval")):
            self.write_job(changed_job(CURVE, {"sweep": {SPEED: {**REFINE, **axis}}}))
            self.contains(self.shearwake("check", "job.toml", expect=3).output, message)
        self.write_job(changed_job(CURVE, {"sweep": {"zip": [{SPEED: REFINE, AM: [400, 500]}]}}))
        self.contains(self.shearwake("check", "job.toml", expect=3).output, "is adaptive")
        self.assertFalse(self.out.exists())

    @pytest.mark.extended
    def test_sliding_windows_have_no_jumps_along_the_frequency(self):
        self.write_job(without_reference(PLAIN, {"sweep": {AM: {**REFINE, "refine": [400, 1000], "tolerance": 0.005}}}))
        self.contains(self.shearwake("run", "job.toml").output, "intervals exceed the tolerance because of the limits")
        output = self.shearwake("run", "job.toml", "-S", "measure.window='sliding'", "--out", "sliding").output
        self.assertNotIn("exceed the tolerance", output)
        self.assertLess(len(plan(self.folder / "sliding")["cases"]), len(plan(self.out)["cases"]))

    @pytest.mark.long
    def test_the_job_searches_the_gain_with_a_tenth_of_a_grid(self):
        self.shearwake("run", ROOT / "jobs" / "adaptive-gain.toml", "--out", "gain", "--quiet", ranks=2)
        self.assertLess(len(plan(self.folder / "gain")["cases"]), 71)  # a grid has 701 and the reference
        self.shearwake("reduce", "gain")
        row, = read_csv(self.folder / "gain" / "tables" / "adaptive-gain.adaptive.csv")
        self.assertEqual(row["within_tolerance"], "yes")
        # The grid with a spacing of 1 Hz has its maximum of 1.046408 at 147 Hz.
        self.assertLessEqual(abs(float(row["location"]) - 147.0), 1.0)
        self.assertAlmostEqual(float(row["value"]), 1.0464, delta=1e-4)
