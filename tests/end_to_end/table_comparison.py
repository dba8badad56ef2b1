# SPDX-License-Identifier: BSD-3-Clause
"""Tables of the same cases that were computed in different ways."""
import contextlib


def is_number(text):
    with contextlib.suppress(ValueError):
        float(text)
        return True
    return False


def is_literal_ipr(name):
    return name.startswith("ipr") and "abs" not in name


def exact_as(name):
    """The column that determines the absolute accuracy of a column. In sum u_z, positive and negative values
    cancel, so its error is that of sum |u_z|; the error of the root of ipr is that of the root of ipr_abs."""
    if name == "sum_u":
        return "sum_abs_u"
    if is_literal_ipr(name):
        return name.replace("ipr", "ipr_abs", 1)
    return name


def assert_same_table(test, first, second):
    """Asserts equal texts, and numbers that differ by less than their printed digits, relative to the largest of the column."""
    test.assertEqual([list(row) for row in first], [list(row) for row in second])
    for column in first[0]:
        pairs = [(a[column], b[column]) for a, b in zip(first, second)]
        scale = [row[exact_as(column)] for row in first]
        largest = max((abs(float(a)) for a in scale if is_number(a)), default=0.0)
        for a, b in pairs:
            if is_number(a) and is_number(b) and is_literal_ipr(column):
                roots = float(a) ** 0.5, float(b) ** 0.5
                test.assertLessEqual(abs(roots[0] - roots[1]), 1e-12 * largest ** 0.5 + 1e-8 * roots[0], f"{column}: {a} and {b}")
            elif is_number(a) and is_number(b):
                # Numbers are printed with 9 digits.
                test.assertLessEqual(abs(float(a) - float(b)), 1.1e-8 * largest, f"{column}: {a} and {b}")
            else:
                test.assertEqual(a, b, column)
