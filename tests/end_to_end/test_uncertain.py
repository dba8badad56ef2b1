# SPDX-License-Identifier: BSD-3-Clause
"""Samples of uncertain keys, lists of cases, and single evaluations, as users run them."""
import json

import pytest

from program import AM, NO_REFERENCE, ROOT, ProgramTest, case_files, changed_job, read_csv, small_job, swept, table

SPEED, VISCOSITY = "medium.layer[1].c_s_m_s", "medium.layer[1].viscosity_Pa_s"
SAMPLE = small_job(swept(500, 1000), {"record": None, "uncertain": {
    "samples": 2, SPEED: {"preset": "forearm-skin"}, VISCOSITY: {"distribution": "lognormal", "median": 1.0, "geometric_sd": 1.5},
    "exceedance": {"eta_period_over_reference_1": 1.0}}})
# Tables are compared byte by byte: ranks of a team add in another order than a single one, which changes digit nine
TEAMS = ["--ranks-per-case", "1"]


def statistics(out):
    return read_csv(out / "tables" / "small.statistics.csv")


class Uncertain(ProgramTest):
    def test_a_sample_is_run_reduced_extended_and_drawn(self):
        self.write_job(SAMPLE)
        self.contains(self.shearwake("plan", "job.toml").output, "6 cases")
        self.shearwake("run", "job.toml", "--quiet")
        self.contains(self.shearwake("reduce", self.out).output, "small.statistics.csv")
        first = statistics(self.out)
        self.assertEqual({row["samples"] for row in first}, {"2"})
        self.contains(first[0]["note"], "too few samples")

        more = ["-S", "uncertain.samples=4"]
        before = {path: path.stat().st_mtime_ns for path in case_files(self.out)}
        self.contains(self.shearwake("run", "job.toml", *more, *TEAMS, ranks=2).output, "6 computed now, 6 already complete")
        after = {path: path.stat().st_mtime_ns for path in case_files(self.out)}
        self.assertEqual({path: after[path] for path in before}, before, "a complete case was computed again")
        self.shearwake("reduce", self.out)

        fresh = self.folder / "fresh"
        self.reduced(fresh, *more, "--quiet", *TEAMS, ranks=2)
        name = "tables/small.statistics.csv"
        self.assertEqual((self.out / name).read_bytes(), (fresh / name).read_bytes())

        rows = {row["id"]: row for row in table(self.out)}
        ratios = [float(row["eta_period_over_reference_1"]) for row in rows.values()
                  if row["reference"] != "yes" and float(row[AM]) == 500.0]
        probability, = [row for row in statistics(self.out) if row["statistic"] == "exceeds 1" and float(row[AM]) == 500.0]
        self.assertAlmostEqual(float(probability["value"]), sum(r > 1.0 for r in ratios) / len(ratios))
        self.assertLessEqual(float(probability["low_95"]), float(probability["value"]))

        self.contains(self.shearwake("run", "job.toml", "--quiet", expect=2).output, "contains the results of another plan")

        self.contains(self.shearwake("report", self.out).output, "Over 4 samples of 2 uncertain keys")
        page = (self.out / "report" / "index.html").read_text(encoding="utf-8")
        for figure in ("uncertain_bands", "uncertain_probability", "uncertain_scatter"):
            self.assertIn(f'id="{figure}"', page)

    @pytest.mark.long
    def test_sobol_indices_reach_the_report(self):
        self.write_job(changed_job(SAMPLE, NO_REFERENCE, swept(500), {"uncertain.analysis": "sobol-indices", "uncertain.exceedance": None}))
        self.contains(self.shearwake("plan", "job.toml").output, "8 cases")
        self.reduced(self.out, "--quiet", ranks=2)
        text = (self.out / "tables" / "small.sensitivity.csv").read_text(encoding="utf-8")
        self.assertIn(f"500,eta_period_1,{SPEED},total,", text)
        self.shearwake("report", self.out)
        page = (self.out / "report" / "index.html").read_text(encoding="utf-8")
        self.assertIn('id="uncertain_indices"', page)


class Drivers(ProgramTest):
    def test_an_evaluation_equals_the_case_of_a_sweep(self):
        self.write_job()
        row, = [row for row in self.reduced(self.out) if row[AM] == "1000"]
        arguments = ["evaluate", "job.toml", "--set", f"{AM}=1000", "--json"]
        document = json.loads(self.shearwake(*arguments).stdout)
        self.assertEqual((document["id"], document["status"]), (row["id"], "complete"))
        for column in ("eta_period_1", "eta_period_over_reference_1", "peak_um"):
            self.assertEqual(f"{document['values'][column]:.9g}", row[column])
        file, = [p for p in (self.folder / document["folder"] / "cases").glob(row["id"] + ".h5")]
        before = file.stat().st_mtime_ns
        again = json.loads(self.shearwake(*arguments, ranks=2).stdout)
        self.assertEqual(again["values"], document["values"])
        self.assertEqual(file.stat().st_mtime_ns, before, "the case was computed again")
        self.contains(self.shearwake("evaluate", "job.toml", "--set", "load.peak=1", expect=3).output, "peak")
        warned = self.shearwake("evaluate", "job.toml", "--set", f"{AM}=1000", "-S", "domain.spacing_mm=2")
        self.assertIn("eta_period_1 = ", warned.stdout)
        self.contains(warned.stderr, "warning: domain.spacing_mm")

    def test_each_kind_of_a_swept_modulation_can_be_evaluated(self):
        # The job has the keys of all kinds, as the sweep needs them.
        self.write_job(small_job(swept("AM-STM", "SM-STM", key="load.modulation.kind"), {
            "load.modulation.sm_frequency_Hz": 500.0, "load.modulation.speed_deviation_m_s": 2.0, "table.x": "load.modulation.kind"}))
        ids = {row["load.modulation.kind"]: row["id"] for row in self.reduced(self.out)}
        for kind in ("AM-STM", "SM-STM"):
            done = self.shearwake("evaluate", "job.toml", "--set", f"load.modulation.kind={kind}", "--json")
            self.assertEqual(json.loads(done.stdout)["id"], ids[kind])
        output = self.shearwake("run", "job.toml", "-S", "sweep={}", "-S", 'table={}', "-S", "load.modulation.kind=STM",
                              "--out", "one").output
        self.contains(output, "1 case: 1 computed now")

    def test_a_list_of_cases_is_an_axis(self):
        (self.folder / "cases.csv").write_text(f"{AM},load.peak_Pa\n500,100\n700,80\n", encoding="utf-8")
        self.write_job(small_job({"sweep": {"list": "cases.csv"}}))
        self.contains(self.shearwake("plan", "job.toml").output, "4 cases")  # each peak has a reference
        (self.folder / "cases.csv").write_text(f"# measured on Monday\n# {AM},load.peak_Pa\n500,100\n700,80\n", encoding="utf-8")  # numpy.savetxt
        self.contains(self.shearwake("plan", "job.toml").output, "4 cases")
        for text, *expected in ((f"{AM},load.peak_Pa\n500,nan\n", "line 2", 'the value of load.peak_Pa is "nan"'),
                            (f"{AM},load.peak_Pa\n500\n", "has 1 values, but the first line names 2 keys"),
                            (f"{AM},load.peak_Pa,{AM}\n500,100,600\n", "line 1", f"names {AM} twice"),
                            (f",{AM}\n0,500\n", "line 1", "index=False"), (f"Unnamed: 0,{AM}\n0,500\n", "line 1", "index=False")):
            (self.folder / "cases.csv").write_text(text, encoding="utf-8")
            self.contains(self.shearwake("check", "job.toml", expect=3).output, *expected)

    def test_the_population_job_is_sampled_from_published_values(self):
        output = self.shearwake("plan", ROOT / "jobs" / "uncertain-skin.toml", "-S", "uncertain.samples=4").output
        self.contains(output, "12 cases")
