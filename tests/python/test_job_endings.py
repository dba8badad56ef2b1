# SPDX-License-Identifier: BSD-3-Clause
"""Runs of jobs that fail, stop or are interrupted."""
import signal
import subprocess
import sys
from pathlib import Path

from study import InFolder, job, program, shearwake


class Endings(InFolder):
    def test_failed_cases_are_an_exception_that_contains_the_sweep(self):
        made = job(program.peaks(100.0, 1e200), {"job.name": "failing"})
        with self.assertRaises(shearwake.CasesFailed) as caught:
            made.run()
        self.assertEqual(caught.exception.exit_code, 4)
        self.assertIn("not finite", str(caught.exception))
        good, bad = caught.exception.sweep.every_case
        self.assertEqual((good.status, bad.status), ("complete", "failed"))
        self.assertIn("not finite", bad.reason)
        self.assertGreater(good.value("peak_um"), 0.0)

    def test_a_stopped_run_is_an_exception_and_is_resumed(self):
        made = job({"job.name": "stopped"})
        made.run(options=["--only", made.plan().cases.index[0]])
        Path("out/stopped/STOP").touch()
        with self.assertRaises(shearwake.Stopped) as caught:
            made.run()
        self.assertEqual(caught.exception.exit_code, 75)
        self.assertIn("stopped early", str(caught.exception))
        Path("out/stopped/STOP").unlink()
        self.assertTrue(all(case.is_complete for case in made.run().every_case))

    def test_a_run_stops_in_an_orderly_way_when_its_caller_is_interrupted_or_killed_and_is_resumed(self):
        Path("long.toml").write_text(program.changed_job(program.LONG, {"job.name": "long"}))
        for number, folder in ((signal.SIGINT, "interrupted"), (signal.SIGKILL, "killed")):
            with self.subTest(folder):
                text = f"import shearwake; shearwake.Job('long.toml').run(out={folder!r}, progress=print)"
                caller = subprocess.Popen([sys.executable, "-c", text], stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True, env={
                    **program.faulty_environment(**program.SECOND_CASE), "PYTHONPATH": str(Path(shearwake.__file__).parents[1])})
                self.addCleanup(caller.stderr.close)
                self.addCleanup(self.kill, caller)
                self.wait_for_stop(caller)
                programs = program.stopped(caller.pid)
                self.signal_and_continue(caller, number, forwarded=signal.SIGUSR1)
                _, output = caller.communicate(timeout=program.PATIENCE_s)
                self.assertIn("KeyboardInterrupt" if number == signal.SIGINT else "", output)
                self.wait_for(lambda: not any(map(program.alive, programs)), "the program to end")
                self.assertEqual(list(Path(folder).rglob("*.part")), [])
                complete = {path: path.stat().st_mtime_ns for path in Path(folder, "cases").glob("*.h5")}
                self.assertEqual(len(complete), 2)
                self.assertTrue(all(case.is_complete for case in shearwake.Job("long.toml").run(out=folder).every_case))
                for path, written in complete.items():  # not computed again
                    self.assertEqual(path.stat().st_mtime_ns, written)
