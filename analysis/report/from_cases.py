"""The plan of a folder that has lost its plan.json, from what every case file says of itself.

What no file tells is not known: a case that was never computed is in no file. A damaged file keeps
its place, without settings.
"""
import json
import tomllib

import h5py

TOLD = ("case_id", "settings", "is_reference", "reference_id", "job", "title")


def facts(path):
    """What one case file says of its place in the sweep. Raises OSError, KeyError, ValueError."""
    with h5py.File(path, "r") as file:
        values = {name: file.attrs[name] for name in TOLD}
        values["overrides"] = file.attrs.get("overrides", "")
    values = {name: v.decode("utf-8", "replace") if isinstance(v, bytes) else str(v)
              for name, v in values.items()}
    values["settings"] = json.loads(values["settings"])
    return values


def attempt(path):
    """The facts, or what stands for a damaged file."""
    nothing = {"case_id": path.stem, "settings": {}, "is_reference": "no", "reference_id": "",
               "job": "", "title": "", "overrides": ""}
    try:
        return {**facts(path), "case_id": path.stem}  # the reader sees a file of another case
    except (OSError, KeyError, ValueError, RuntimeError):
        return nothing


def tables(text):
    """A TOML text as tables; none where it is cut short or no TOML."""
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError:
        return {}


def job_options(found):
    """[job] and [table] of the job, with what was overridden on the command line."""
    job, options = tables(found["job"]), {}
    for section in ("job", "table"):
        merged = dict(job.get(section, {}))
        for line in found["overrides"].splitlines():
            merged.update(tables(line).get(section, {}))
        options[section] = merged
    return options


def place(found, keys, job):
    """Sorts as the job does: numbers upward, words as they stand in its text, references last."""
    order = [found["is_reference"] == "yes"]
    for key in keys:
        value = found["settings"].get(key, "")
        if isinstance(value, str):
            at = job.find(f'"{value}"')
            order.append((1, at if at >= 0 else len(job), value))
        else:
            order.append((0, value, ""))
    return order


def series_of(cases, keys, x):
    """Every swept key but x and those that x alone tells."""
    def told(key):
        pairs = {(str(c["settings"].get(x)), str(c["settings"].get(key))) for c in cases}
        return len(pairs) == len({value for value, _ in pairs})
    return [key for key in keys if key != x and not told(key)]


def plan_of_cases(folder):
    """The plan as plan.json holds it, and the job's text. Raises OSError without any case file."""
    cases = [attempt(path) for path in sorted((folder / "cases").glob("*.h5"))]
    if not cases:
        raise FileNotFoundError(f"neither plan.json nor a case file is in {folder}")
    first = next((c for c in cases if c["job"]), cases[0])
    options = job_options(first)
    ordinary = [c for c in cases if c["is_reference"] != "yes"]
    keys = list(dict.fromkeys(key for c in ordinary for key in c["settings"]))
    cases.sort(key=lambda c: place(c, keys, first["job"]))
    x = options["table"].get("x")
    x = x if x in keys else keys[0] if keys else ""
    name = options["job"].get("name", folder.resolve().name)
    entries = [{"id": c["case_id"], "settings": c["settings"],
                "is_reference": c["is_reference"] == "yes", "reference_id": c["reference_id"]}
               for c in cases]
    plan = {"name": name, "title": first["title"] or options["job"].get("title", name),
            "swept_keys": keys, "cases": entries,
            "table": {"x": x, "series": options["table"].get("series",
                                                             series_of(ordinary, keys, x))}}
    return plan, first["job"]
