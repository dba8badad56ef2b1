# SPDX-License-Identifier: BSD-3-Clause
"""The headlines of the studies in written_studies, which state what an expert states about a job and its table."""
import math
import re
import tomllib
from pathlib import Path

import pytest
from synthetic import SCALARS, Folder, case_id, plain

from shearwake.checksum import sealed
from shearwake.report import load
from shearwake.report.page import opening
from shearwake.report.summary import summary

STUDIES = sorted(Path(__file__).parent.glob("written_studies/*.toml"))
MOVES = {"circle": [("arc", "radius_m = 0.01")], "line": [("line", "to_m = [0.05, 0.0]")], "point": [("hold", "at_m = [0.0, 0.0]")],
         "swing": [("hold", "at_m = [0.0, 0.0]"), ("swing", "frequency_Hz = 100.0")]}
INVALID = [{"severity": "error", "key": "domain.extent_mm", "message": "waves return at 4.8 ms"}]


def swept_keys(table):
    """The keys of [sweep], with those of zip."""
    found = []
    for key, value in table.items():
        found += [k for part in value for k in part] if key == "zip" else [key]
    return found


def physics(case, kind):
    """The parameters of a case file that decide what may be compared."""
    end_ms = case.get("duration_ms", 14.0)
    moves = "".join(f'[[load.modulation.trajectory]]\nmover = "{mover}"\n{rest}\n' for mover, rest in MOVES[case.get("shape", "circle")])
    return (f'[load.modulation]\nkind = "{kind}"\n{moves}[domain]\nnx = 100\nny = 100\nspacing_m = 0.001\nsponge_m = 0.0\n'
            f'[time]\n{"regime = " + chr(34) + "periodic" + chr(34) if "duration_ms" in case else ""}\n'
            f'[measure]\nat_s = {end_ms / 1e3}\nsettled_after_s = {case.get("settled_ms", 4.0) / 1e3}\nfocal_radius_m = 0.003\n')


def selection_of(study, root):
    """The output folder of a study, reduced and loaded."""
    job = tomllib.loads(study["job"])
    keys = list(dict.fromkeys([*swept_keys(job.get("sweep", {})), *(k for c in study["cases"] for k in c["settings"])]))
    table = job.get("table", {})
    x = table.get("x", next((k for k in keys if k != "medium.layer[1].c_s_m_s"), ""))
    folder = Folder(root, title=job["job"]["title"], x=x, series=table.get("series", []), swept=keys, job=study["job"])
    empty = dict.fromkeys(SCALARS, math.nan)
    errors = []
    for number, case in enumerate(study["cases"], 1):
        kind = case.get("kind", job["load"]["modulation"]["kind"])
        status = case.get("status", "complete")
        values = dict(zip(study["columns"], case["values"]))
        identity = folder.add(case["settings"], case_id(case["reference"]) if "reference" in case else None,
                              is_reference=case.get("is_reference", False), kind=kind, scalars={**empty, **values},
                              written=status != "failed", warnings=INVALID if status == "invalid" else [], snapshot=False,
                              strength=float(number), physics=physics(case, kind))
        if status == "failed":
            folder.fail(identity, "the layered engine ran out of memory")
        if "error" in case:
            errors.append({"id": identity, "columns": {study["columns"][0]: {"error": case["error"]}}})
    if errors:
        (folder.path / "converge").mkdir()
        (folder.path / "converge" / "converge.json").write_text(sealed({"schema": 1, "cases": errors}))
    folder.save()
    for name in ("adaptive", "statistics"):
        rows = study.get(name)
        if rows and not isinstance(rows, str):
            rows = "\n".join(",".join(str(v) for v in row) for row in [list(rows[0]), *(r.values() for r in rows)])
        if rows:
            (folder.path / "tables" / f"s.{name}.csv").write_text(rows)
    if "optima" in study:
        (folder.path / "optimise").mkdir()
        (folder.path / "optimise" / "table.csv").write_text(study["optima"])
        (folder.path / "optimise" / "study.txt").write_text(study["study"])
    loaded = load.load(folder.path)
    loaded.sweep.uncertain = study.get("uncertain", {})
    loaded.sweep.adaptive_axes = study.get("adaptive_axes", [])
    return loaded


@pytest.mark.parametrize("path", STUDIES, ids=lambda path: path.stem)
def test_the_page_states_what_the_expert_states(path, tmp_path):
    study = tomllib.loads(path.read_text(encoding="utf-8"))
    expert, selection = study["expert"], selection_of(study, tmp_path)
    text = plain(summary(selection))
    assert opening.first_sentence(text)[0] == expert["sentence"], text
    numbers = opening.numbers(selection)
    assert [plain(value) for value, *_ in numbers] == expert["numbers"], text
    for part in expert["also"]:
        assert part in text
    every = "\n".join([text, *(plain(" ".join(number)) for number in numbers)])
    for pattern in expert["never"]:
        assert not re.search(pattern, every), (pattern, every)
