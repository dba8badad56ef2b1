"""Tables as `shearwake reduce` writes them: what is watched in them, and how cases are called."""
import csv
import math
import statistics

# Of the machine, not of the physics; as in analysis/reduce/tolerance.cpp.
NOT_COMPARED = ("wall_s", "host", "hosts", "note")


def read_rows(path):
    with open(path, encoding="utf-8", newline="") as file:
        reader = csv.DictReader(file)
        return list(reader.fieldnames or []), list(reader)


def swept_columns(columns):
    """Those right behind `id` and `reference` whose names have a dot."""
    swept = []
    for column in columns:
        if column in ("id", "reference"):
            continue
        if "." not in column:
            break
        swept.append(column)
    return swept


def case_name(row, swept):
    """As `shearwake diff` names it."""
    parts = ["the reference"] if row.get("reference") == "yes" else []
    parts += [f"{column}={row[column]}" for column in swept if row[column]]
    return ", ".join(parts) or row.get("id", "")


def number(text):
    try:
        value = float(text)
    except (TypeError, ValueError):
        return None
    return value if math.isfinite(value) else None


def readings(path):
    """(case, column, value) of every watched number. Of two cases of one name, the first."""
    columns, rows = read_rows(path)
    swept = swept_columns(columns)
    watched = [c for c in columns if c not in (*swept, *NOT_COMPARED, "id", "reference", "status")]
    found = {}
    for row in rows:
        for column in watched:
            value = number(row[column])
            if value is not None:
                found.setdefault((case_name(row, swept), column), value)
    return [(case, column, value) for (case, column), value in found.items()]


def median_seconds(path):
    """Of a case, or None. The first case of a medium is slower, and others may use the machine."""
    _, rows = read_rows(path)
    each = [value for value in (number(row.get("wall_s")) for row in rows) if value is not None]
    return statistics.median(each) if each else None
