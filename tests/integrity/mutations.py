# SPDX-License-Identifier: BSD-3-Clause
"""Random changes of jobs: of numbers, words and lines, as hurried people make them."""
import re

NUMBER = re.compile(r"(?<![\w.\"'-])-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?(?![\w.\"'])")
EXTREMES = ("0", "0.0", "-1.0", "1e-12", "1e-6", "1e-3", "1e3", "1e6", "1e12", "1e300", "1e-300", "nan", "inf", "-inf",
            "9223372036854775807")
WORDS = (('"layered"', '"spectral"'), ('"layered"', '"pstd"'), ('"spectral"', '"layered"'), ('"spectral"', '"pstd"'),
         ('"pstd"', '"layered"'), ('edges = "open"', 'edges = "periodic"'), ('edges = "periodic"', 'edges = "open"'),
         ('base = "rigid"', 'base = "half-space"'), ('base = "half-space"', 'base = "rigid"'),
         ('kind = "AM-STM"', 'kind = "STM"'), ('kind = "AM-STM"', 'kind = "AM"'))


def changed_number(word, rng):
    value, kind = float(word), rng.random()
    if kind < 0.3:
        return repr(value * 10.0 ** rng.uniform(-6.0, 6.0))
    if kind < 0.6:
        return repr(value * 10.0 ** rng.uniform(-1.5, 1.5))
    if kind < 0.8:
        scaled = value * rng.choice((0.1, 0.5, 2.0, 3.0, 10.0, 100.0))
        return repr(float(round(scaled))) if "." in word else str(round(scaled))
    return rng.choice(EXTREMES)


def mutated(text, rng):
    """The job with one to five changes."""
    lines = text.split("\n")
    for _ in range(rng.choice((1, 1, 1, 2, 2, 3, 5))):
        kind = rng.random()
        numbers = [(n, found) for n, line in enumerate(lines) if not line.startswith(("#", "title", "schema"))
                   for found in NUMBER.finditer(line.split("#")[0])]
        words = [(n, old, new) for n, line in enumerate(lines) for old, new in WORDS if old in line]
        if kind < 0.8 and numbers:
            n, found = rng.choice(numbers)
            lines[n] = lines[n][:found.start()] + changed_number(found[0], rng) + lines[n][found.end():]
        elif kind < 0.92 and words:
            n, old, new = rng.choice(words)
            lines[n] = lines[n].replace(old, new, 1)
        elif kind < 0.97:
            del lines[rng.randrange(len(lines))]
        else:
            lines.insert(rng.randrange(len(lines) + 1), rng.choice(lines))
        lines = lines or [""]
    return "\n".join(lines)
