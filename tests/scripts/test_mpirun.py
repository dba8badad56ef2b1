# SPDX-License-Identifier: BSD-3-Clause
"""How the scripts and the Python package start mpirun."""
import os
import signal
import subprocess
from unittest import mock

from program import PATIENCE_s, ROOT, ProgramTest, descendants, environment

# Removes its file when it receives the signal.
RANK = ("sh", "-c", "trap 'rm -f rank-$$; exit 0' USR1; touch rank-$$; while :; do sleep 0.05; done")


def start_of_python(*words):
    return ["mpirun", "-n", "2", *words]


def start_of_scripts(*words):
    return ["sh", "-c", f'. "{ROOT}/scripts/common.sh"; on_ranks 2 "$@"', "sh", *words]


def start_of_batch_script(*words):
    return ["env", "SHEARWAKE_LAUNCH=mpirun -n 2", "SLURM_JOB_ID=1", "SLURM_JOB_NODELIST=host",
            "bash", "-c", f'. "{ROOT}/jobs/slurm/step.sh"; mkdir -p out/slurm; run_step out 0 "$@"', "bash", *words]


def start_of_kwave(*words):
    return [ROOT / "scripts" / "kspaceFirstOrder-elastic", "-t", "2", *words]


class Mpirun(ProgramTest):
    def start_for_user(self, start, words, **variables):
        """Starts a command for a user who has set HWLOC_COMPONENTS to this value, or not at all."""
        with mock.patch.dict(os.environ):
            os.environ.pop("HWLOC_COMPONENTS", None)
            os.environ.update(variables)
            settings = environment()
        if start is not start_of_python:  # the scripts add it by themselves
            settings = {**{name: settings[name] for name in settings if name != "HWLOC_COMPONENTS"}, **variables}
        process = subprocess.Popen(start(*words), cwd=self.folder, env=settings, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                   encoding="utf-8", start_new_session=True)
        self.addCleanup(self._end, process)
        return process

    def test_ranks_receive_sigusr1_also_where_pocl_is_installed(self):
        for start in (start_of_python, start_of_scripts, start_of_batch_script):
            with self.subTest(start.__name__):
                process = self.start_for_user(start, RANK)
                self.wait_for(lambda: len(list(self.folder.glob("rank-*"))) == 2, "the ranks")
                os.kill(descendants(process.pid)[0] if start is start_of_scripts else process.pid, signal.SIGUSR1)
                self.wait_for(lambda: not list(self.folder.glob("rank-*")), "the signal to reach both ranks")
                process.communicate(timeout=PATIENCE_s)

    def test_hwloc_components_are_those_of_the_user_or_all_except_opencl(self):
        (self.folder / "mpirun").write_text('#!/bin/sh\necho "components: ${HWLOC_COMPONENTS-none}"\n', encoding="utf-8")
        (self.folder / "mpirun").chmod(0o755)
        path = f"{self.folder}:{os.environ['PATH']}"
        for start in (start_of_python, start_of_scripts, start_of_batch_script, start_of_kwave):
            for variables, expected in (({}, "-opencl"), ({"HWLOC_COMPONENTS": "x86"}, "x86"), ({"HWLOC_COMPONENTS": ""}, "")):
                with self.subTest(start.__name__, variables=variables):
                    process = self.start_for_user(start, ("true",), PATH=path, **variables)
                    self.contains(process.communicate(timeout=PATIENCE_s)[0], f"components: {expected}\n")
