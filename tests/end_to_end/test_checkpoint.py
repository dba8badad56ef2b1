# SPDX-License-Identifier: BSD-3-Clause
"""Cases that are interrupted and resumed from their checkpoints."""
import os
import shutil
import signal

import h5py
import numpy
import pytest

import test_failures
from program import (SPECTRAL, ProgramTest, case_files, changed_job, journal, plan_ids, read_by, seal, swept, table,
                     without_reference)
from table_comparison import assert_same_table, exact_as

# Two cases of 400 steps; the first volume is recorded at step 20, measure.at_ms is step 200.
STEPPED = without_reference(SPECTRAL, swept(1250, 2500), read_by(1.0, settled_ms=0.2), {
    "time.duration_ms": 2.0, "solver.spectral.time_step_us": 5.0, "record.volumes_ms": [0.1, 1.5]})
# The same job with a body that requires iterations, so that strains are part of the checkpoint.
WITH_BODY = changed_job(STEPPED, {"solver.spectral.time_step_us": 20.0, "medium.body": [
    {"shape": "ellipsoid", "center_mm": [2.0, 1.0], "depth_mm": 5.0, "semi_axes_mm": [6.0, 4.0, 3.0], "c_s_m_s": 20.0, "viscosity_Pa_s": 1.5}]})
SAVING = ("run", "job.toml", "--checkpoint-steps", 20, "--ranks-per-case")


def checkpoint(number):
    """Programs stop themselves when this checkpoint is written and has not got its name yet."""
    return {"PATH": "/checkpoints/*.h5", "CALL": "rename", "STOP_AT": number}


class SavedCase(ProgramTest):
    """Base class of the tests of one job."""
    JOB = STEPPED

    @classmethod
    def setUpClass(cls):
        """Computes the uninterrupted run once for all tests."""
        cls.undisturbed = cls("shearwake")
        cls.undisturbed.setUp()
        cls.addClassCleanup(cls.undisturbed.doCleanups)
        cls.undisturbed.write_job(cls.JOB)
        cls.undisturbed.shearwake("run", "job.toml")
        cls.undisturbed.shearwake("reduce", cls.undisturbed.out)

    def setUp(self):
        super().setUp()
        self.write_job(self.JOB)

    def events(self, name):
        lines = journal(self.out)
        return [line for line in lines if line["event"] == name]

    def states(self):
        return sorted((self.out / "checkpoints").glob("*"))

    def kill_in_the_middle(self, ranks, saves=6):
        """Kills the run after the given number of checkpoints of the first case, while it writes the next one."""
        self.kill(self.start_and_stop(*SAVING, ranks, ranks=ranks, faults=checkpoint(saves + 1)))
        self.assertEqual(case_files(self.out), [])

    def resume(self, ranks=1):
        output = self.shearwake("run", "job.toml", "--ranks-per-case", ranks, ranks=ranks).output
        self.contains(output, "2 computed now")
        self.assertEqual(self.states(), [], "checkpoints of complete cases")
        self.assertEqual(list(self.out.rglob("*.part")), [])
        self.shearwake("reduce", self.out)
        assert_same_table(self, table(self.undisturbed.out), table(self.out))
        return output

    def assert_resumed(self, from_step):
        resumed = self.events("resumed")
        self.assertEqual(len(resumed), 1)
        self.assertGreaterEqual(resumed[0]["step"], from_step)
        self.assertEqual(resumed[0]["step"] % 20, 0)

    def largest_difference(self, fields_alone=False):
        """The largest difference of any number in any dataset of the case files, relative to the largest value
        of the dataset."""
        worst = 0.0
        for path, reference in zip(case_files(self.out), case_files(self.undisturbed.out)):
            self.assertEqual(path.name, reference.name)
            with h5py.File(path) as file, h5py.File(reference) as whole:
                names = []
                whole.visititems(lambda name, item: names.append(name)  # noqa: B023
                                 if isinstance(item, h5py.Dataset) else None)
                self.assertLessEqual({"surface/u_z", "volume/u_x"}, set(names))
                for name in names:
                    if fields_alone and not name.startswith(("surface/u_", "volume/u_")):
                        continue
                    if "ipr_at" in name or "ipr_period" in name:
                        continue  # a square of sum u, which is compared
                    a, b = file[name][()], whole[name][()]
                    scale = numpy.abs(whole[exact_as(name)][()]).max()
                    numpy.testing.assert_array_equal(numpy.isnan(a), numpy.isnan(b), name)
                    if not numpy.all(numpy.isnan(b)) and scale > 0:
                        worst = max(worst, numpy.nanmax(numpy.abs(a - b)) / scale)
        return worst


class Checkpoint(SavedCase):
    def test_a_case_killed_on_one_rank_is_resumed_bit_for_bit(self):
        self.kill_in_the_middle(ranks=1)
        self.assertTrue(list(self.out.rglob("cases/*.part")))
        self.resume()
        self.assert_resumed(120)
        self.assertEqual(self.largest_difference(), 0.0)  # the same program on the same ranks

    @pytest.mark.long
    def test_a_case_is_resumed_on_more_and_on_fewer_ranks(self):
        for killed, resumed in ((2, 3), (3, 1)):
            with self.subTest(killed=killed, resumed=resumed):
                self.kill_in_the_middle(ranks=killed)
                self.resume(ranks=resumed)
                self.assert_resumed(120)
                self.assertLess(self.largest_difference(), 1e-12)  # required accuracy
                shutil.rmtree(self.out)

    def test_a_signal_writes_a_checkpoint_and_the_same_command_resumes(self):
        for kind in (signal.SIGTERM, signal.SIGINT, signal.SIGUSR1):
            process = self.start_and_stop("run", "job.toml", "--checkpoint-steps", 20, faults=checkpoint(2))
            self.signal_and_continue(process, kind)
            output = self.output_of(process, 75)
            self.contains(output, "stopped early", "the next run resumes from checkpoints: case ", "next: shearwake run job.toml")
            self.assertEqual(case_files(self.out), [])
            self.assertEqual(journal(self.out)[-2]["event"], "checkpointed")
        self.assertEqual(len(self.events("resumed")), 2)
        self.contains(self.shearwake("run", "job.toml").output, "resumed from checkpoints: case ")
        self.assertEqual(self.largest_difference(), 0.0)
        self.assertEqual(self.events("resumed")[-1]["step"], self.events("checkpointed")[-1]["step"])

    @pytest.mark.extended
    def test_checkpoints_are_written_at_intervals_in_seconds(self):
        self.shearwake("run", "job.toml", "--checkpoint-interval", 0.001)
        self.assertEqual({line["id"] for line in self.events("checkpointed")}, set(plan_ids(self.out)))
        self.assertEqual(self.largest_difference(), 0.0)
        self.contains(self.shearwake("run", "job.toml", "--checkpoint-interval", -1, expect=2).output, "--checkpoint-interval")

    @pytest.mark.extended
    def test_a_signal_to_mpirun_writes_the_checkpoints_of_all_teams(self):
        # mpirun forwards SIGUSR1 and, unlike for SIGINT and SIGTERM, does not kill the ranks afterwards.
        process = self.start_and_stop(*SAVING, 1, ranks=2, count=2, faults=checkpoint(2))
        self.signal_and_continue(process, signal.SIGUSR1)
        self.output_of(process, 75)
        self.assertEqual(case_files(self.out), [])
        self.contains(self.shearwake("status", self.out).output, "0 running", "0 failed", "2 remaining")
        self.resume(ranks=2)
        self.assertEqual(len(self.events("resumed")), 2)
        self.assertLess(self.largest_difference(), 1e-12)  # required accuracy

    @pytest.mark.extended
    def test_a_disk_too_full_for_a_checkpoint_does_not_end_the_case(self):
        if os.geteuid() != 0:
            self.skipTest("only root can mount a small disk")
        disk = test_failures.FullDisk.mount(self, 1)
        self.compute_some(self.JOB)
        (self.out / "checkpoints").symlink_to(disk)
        process = self.start(*SAVING, 1)
        self.wait_for(lambda: len(self.events("started")) == 2, "the second case")
        process.send_signal(signal.SIGTERM)
        # Without a checkpoint a stop waits for the end of the case, which is the last one.
        output = self.output_of(process, 0)
        self.contains(output, "continues without a checkpoint: it requires", "MB left", "1 computed now")
        self.assertEqual(self.events("checkpointed"), [])
        self.assertEqual(self.states(), [])
        self.assertEqual(self.largest_difference(), 0.0)

    @pytest.mark.extended
    def test_a_damaged_checkpoint_leaves_the_previous_one(self):
        self.kill_in_the_middle(ranks=1)
        newest = max((path for path in self.states() if path.suffix == ".h5"), key=lambda path: h5py.File(path).attrs["sequence"])
        with h5py.File(newest) as file:
            newest_step, place = file["scalars"].attrs["step"], file["now"].id.get_offset()
        with open(newest, "r+b") as file:
            file.seek(place + 1000)
            file.write(b"damage")
        self.contains(self.resume(), newest.name, "is damaged (its bytes do not match its checksum)", "not used")
        self.assert_resumed(100)
        self.assertLess(self.events("resumed")[0]["step"], newest_step)
        self.assertEqual(self.largest_difference(), 0.0)

    @pytest.mark.extended
    def test_without_an_intact_checkpoint_the_case_starts_from_scratch(self):
        self.kill_in_the_middle(ranks=1)
        first, second = (path for path in self.states() if path.suffix == ".h5")
        os.truncate(first, first.stat().st_size // 2)
        second.write_bytes(b"words " * 1000)
        second.with_name(second.name + ".part.data.0").touch()  # of OMPIO, if the kill falls into a write
        self.contains(self.resume(), first.name, second.name, "does not end in its checksum")
        self.assertEqual(self.events("resumed"), [])
        self.assertEqual(self.largest_difference(), 0.0)

    @pytest.mark.extended
    def test_without_the_frames_recorded_so_far_the_case_starts_from_scratch(self):
        for damage in ("removed", "truncated"):
            with self.subTest(damage):
                self.kill_in_the_middle(ranks=1)
                part = next(self.out.rglob("cases/*.part"))
                if damage == "removed":
                    part.unlink()
                else:
                    os.truncate(part, 2000)
                self.contains(self.resume(), part.name.partition(".h5.")[0] + ".h5.", ".part ", "starts from scratch")
                self.assertEqual(self.events("resumed"), [])
                self.assertEqual(self.largest_difference(), 0.0)
                for path in case_files(self.out):
                    path.unlink()

    @pytest.mark.extended
    def test_a_checkpoint_of_another_version_is_not_used(self):
        self.kill_in_the_middle(ranks=1)
        for path in self.states():
            if path.suffix == ".h5":
                with h5py.File(path, "r+") as file:
                    file.attrs["git_id"] = numpy.bytes_("0123456789ab")
                seal(path)
        self.contains(self.resume(), "written by another program, 0123456789ab")
        self.assertEqual(self.events("resumed"), [])

    @pytest.mark.extended
    def test_checkpoints_of_a_complete_case_are_removed(self):
        self.kill_in_the_middle(ranks=1)
        kept = {path.name: path.read_bytes() for path in self.states()}
        self.resume()
        for name, content in kept.items():
            (self.out / "checkpoints" / name).write_bytes(content)
        self.contains(self.shearwake("run", "job.toml").output, "2 already complete")
        self.assertEqual(self.states(), [])

    @pytest.mark.extended
    def test_engine_layered_writes_no_checkpoints(self):
        self.write_job(changed_job(STEPPED, {"solver.engine": "layered", "record.volumes_ms": None}))
        self.shearwake(*SAVING, 1)
        self.assertEqual(self.events("checkpointed"), [])
        self.assertEqual(len(plan_ids(self.out)), 2)


class CheckpointWithABody(SavedCase):
    JOB = WITH_BODY

    @pytest.mark.long
    def test_iterations_are_resumed_on_the_same_and_on_another_number_of_ranks(self):
        self.kill_in_the_middle(ranks=2, saves=2)
        killed = self.folder / "killed"
        shutil.copytree(self.out, killed)
        self.resume(ranks=2)
        self.assert_resumed(40)
        # The uninterrupted run used one rank; only the fields are identical on any number of ranks.
        self.assertEqual(self.largest_difference(fields_alone=True), 0.0)

        shutil.rmtree(self.out)
        killed.rename(self.out)
        self.resume(ranks=3)
        self.assert_resumed(40)
        # The fields are identical to those on one rank; the measures are sums in a different order.
        self.assertLess(self.largest_difference(), 1e-14)


class CheckpointWithLevels(SavedCase):
    # Two or four passes per period of the load.
    JOB = changed_job(STEPPED, {"solver.spectral.time_step_us": 20.0, "time.duration_ms": 10.0, "measure.at_ms": 9.6, "measure.sensation": True,
                                "load.modulation.path.at_end": "back-and-forth", "load.modulation.speed_m_s": 20.0})

    @pytest.mark.long
    def test_levels_of_sensation_are_resumed_on_another_number_of_ranks(self):
        self.kill_in_the_middle(ranks=2, saves=15)  # of 25
        self.resume(ranks=3)  # which compares the tables
        self.assert_resumed(300)
        for row in table(self.out):
            self.assertTrue(row["felt_peak_dB"] and row["felt_path_dB"] and row["felt_area_mm2"], row["note"])
