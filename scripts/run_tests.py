#!/usr/bin/env python3
"""Runs every test of a build and counts test cases over all runners.

Usage: run_tests.py BUILD [WORD ...]     WORD: only the groups whose name holds one of these words

A heading a group, the text of each failure, and last of all one line `N passed, N failed`; exit 1
if one failed. A runner that crashes, hangs or yields no count is a failure. What the runners said
stays in BUILD/test-results.
"""
import json
import os
import re
import signal
import subprocess
import sys
import time
import xml.etree.ElementTree as ElementTree
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent

# Runs one file of Python tests and writes what became of each.
UNITTEST = """
import json, pathlib, sys, unittest
path, out = pathlib.Path(sys.argv[1]), sys.argv[2]
sys.path.insert(0, str(path.parent))
suite = unittest.defaultTestLoader.loadTestsFromName(path.stem)
result = unittest.TextTestRunner(verbosity=2).run(suite)
bad = [(str(test), text) for test, text in result.failures + result.errors]
bad += [(str(test), 'passed unexpectedly') for test in result.unexpectedSuccesses]
skipped = [(str(test), reason) for test, reason in result.skipped]
passed = max(0, result.testsRun - len({name for name, _ in bad}) - len(skipped))
json.dump({'passed': passed, 'failed': bad, 'skipped': skipped}, open(out, 'w'))
"""


class Group:
    def __init__(self, name, command, count, timeout_s, *, beside=False):
        self.name, self.command, self.count, self.timeout_s = name, command, count, timeout_s
        self.beside = beside  # on one core: one of these runs beside all the others


def mpirun(ranks):
    """As root and with fewer cores than ranks too; unbound and yielding, since others may use the
    cores (two ranks beside another program took six times as long as one)."""
    return ["mpirun", "--oversubscribe", "--bind-to", "none", "--mca", "mpi_yield_when_idle", "1", "-n",
            str(ranks)]


def words(element):
    """What Catch2 says of one assertion that failed, or of an exception."""
    at = f"{element.get('filename', '?')}:{element.get('line', '?')}"
    parts = [" ".join((child.text or "").split()) for child in element.iter() if child is not element]
    own = " ".join((element.text or "").split())
    return f"    {at}: " + "\n        ".join(part for part in [own, *parts] if part)


def count_catch(path):
    """Verdicts of Catch2's XML reports, one a rank: a case passes when it passes on all ranks."""
    verdicts, texts, broken = {}, [], []
    for report in sorted(path.parent.glob(path.name + "*")):
        ended = False
        try:
            for _, element in ElementTree.iterparse(report):
                ended = ended or element.tag == "OverallResults"
                if element.tag != "TestCase":
                    continue
                name = element.get("name")
                fine = element.find("OverallResult").get("success") == "true"
                if not fine and verdicts.get(name, True):
                    bad = [e for e in element.iter("Expression") if e.get("success") == "false"]
                    bad += [tag for kind in ("Exception", "Failure", "FatalErrorCondition")
                            for tag in element.iter(kind)]
                    texts.append("\n".join([f"  {name}", *map(words, bad)]))
                verdicts[name] = verdicts.get(name, True) and fine
        except ElementTree.ParseError:
            pass
        if not ended:
            broken.append(f"  {report.name} ends too early")
    if not verdicts:
        broken.append("  it yields no count")
    passed = sum(verdicts.values())
    return passed, len(verdicts) - passed, texts, broken


def count_unittest(path):
    try:
        result = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return 0, 0, [], ["  it yields no count"]
    for name, reason in result["skipped"]:
        print(f"  skipped {name}: {reason}")
    failed = result["failed"]
    texts = [f"  {name}\n" + re.sub("(?m)^", "    ", text) for name, text in failed]
    return result["passed"], len({name for name, _ in failed}), texts, []


def run(command, log, timeout_s):
    """Exit code, or None when it hung; the whole process group ends with it."""
    with open(log, "w", encoding="utf-8") as out:
        process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=out,
                                   stderr=subprocess.STDOUT, start_new_session=True, cwd=ROOT)
        try:
            return process.wait(timeout_s)
        except subprocess.TimeoutExpired:
            for kind in (signal.SIGTERM, signal.SIGKILL):
                os.killpg(process.pid, kind)  # mpirun takes its ranks with it
                try:
                    process.wait(10)
                    break
                except subprocess.TimeoutExpired:
                    continue
            return None


def run_group(group, results):
    if not group.beside:
        print(f"== {group.name}", flush=True)
    stem = results / re.sub(r"\W+", "-", group.name)
    log, report = stem.with_suffix(".log"), stem.with_suffix(".report")
    for old in results.glob(report.name + "*"):
        old.unlink()
    began = time.monotonic()
    code = run([word.replace("REPORT", str(report)) for word in group.command], log, group.timeout_s)
    passed, failed, texts, broken = (
        group.count(report) if group.count else (int(code == 0), 0, [], []))
    if code is None:
        broken.insert(0, f"  it hung and was ended after {group.timeout_s} s")
    elif code != 0 and not failed:
        broken.insert(0, f"  it ended with exit code {code}")
    if broken:
        failed += 1
        tail = log.read_text(encoding="utf-8", errors="replace").splitlines()[-40:]
        texts.append("\n".join([f"  {group.name} as a whole", *broken, *("    | " + t for t in tail)]))
    said = [f"== {group.name}, beside the others"] if group.beside else []
    said += [f"FAILED{text}" for text in texts]
    said.append(f"   {passed} passed, {failed} failed, {time.monotonic() - began:.0f} s")
    print("\n".join(said), flush=True)
    return passed, failed


def groups_of(build, python):
    def catch(name, ranks, timeout_s, *cases, beside=False):
        launch = mpirun(ranks) if ranks > 1 else []
        command = [*launch, str(build / "tests" / name), "-r", "xml", "-o", "REPORT", *cases]
        plural = "s" if ranks > 1 else ""
        return Group(f"{name} on {ranks} rank{plural}", command, count_catch, timeout_s, beside=beside)

    groups = [Group("layers", [python, "scripts/check_layers.py"], None, 60)]
    groups.append(catch("unit_tests", 1, 180))
    if (build / "tests" / "verify_tests").exists():
        groups.append(catch("verify_tests", 1, 900, beside=True))
    if (build / "tests" / "mpi_tests").exists():
        groups += [catch("mpi_tests", ranks, 180) for ranks in (1, 2, 3, 5)]
        groups.append(catch("mpi_tests", 8, 180, "*any number of ranks*"))
    for path in sorted(path for folder in ("report", "end_to_end", "faults", "slurm", "fuzz")
                       for path in ROOT.glob(f"tests/{folder}/test_*.py")):
        command = [python, "-c", UNITTEST, str(path), "REPORT"]
        groups.append(Group(str(path.relative_to(ROOT)), command, count_unittest, 300,
                            beside=path.parent.name == "report"))
    return groups


def main():
    build = Path(sys.argv[1]).resolve()
    results = build / "test-results"
    results.mkdir(exist_ok=True)
    os.environ.update(SHEARWAKE=str(build / "shearwake"), SHEARWAKE_PYTHON=sys.executable,
                      SHEARWAKE_NEEDS_CHROMIUM="yes")  # scripts/setup --tests installs it
    if os.geteuid() == 0:  # a container
        os.environ.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    groups = [group for group in groups_of(build, sys.executable)
              if not sys.argv[2:] or any(word in group.name for word in sys.argv[2:])]
    with ThreadPoolExecutor(max_workers=1) as pool:
        beside = [pool.submit(run_group, group, results) for group in groups if group.beside]
        counts = [run_group(group, results) for group in groups if not group.beside]
        counts += [future.result() for future in beside]
    passed, failed = (sum(numbers) for numbers in zip(*counts)) if counts else (0, 0)
    print(f"{passed} passed, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
