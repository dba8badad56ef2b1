# SPDX-License-Identifier: BSD-3-Clause
"""Tests that no text of a figure is clipped or hidden by another."""
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import pytest
from matplotlib.layout_engine import TightLayoutEngine


from synthetic import AM, FWHM, Folder, case_id, sweep

import texts

from shearwake.report import style
from shearwake.report.style import plt

PRESET = "medium.preset"


def one_case(root):
    folder = Folder(root, swept=(), x="")
    folder.add({}, frames=True)
    return folder


def two_keys(root):
    """Eight frequencies of three media with references of their own, whose values are close to each other."""
    folder = Folder(root, series=[PRESET], swept=(AM, PRESET))
    names = ["thesis-tissue", "three-layer-skin", "a-medium-with-a-long-name"]
    for m, name in enumerate(names):
        for n in range(8):
            folder.add({AM: 100.0 * (n + 1), PRESET: name}, case_id(25 + m),
                       scalars={"eta_period_1": 0.2 + 0.01 * n, "focal_rms_um": 1.5 + 0.1 * m - 0.05 * n})
    for m, name in enumerate(names):
        folder.add({PRESET: name}, is_reference=True, kind="STM", strength=1.0 + 0.1 * m,
                   scalars={"eta_period_1": 0.24 + 0.001 * m, "focal_rms_um": 3.0 + 0.001 * m})
    return folder


def many(root):
    folder = Folder(root, series=[FWHM], swept=(AM, FWHM))
    for n in range(9):
        for width in (2.0, 3.0, 4.5, 6.0, 8.5):
            folder.add({AM: 50.0 * (n + 1), FWHM: width}, scalars={"eta_period_1": 0.1 + 0.01 * n + 0.02 * width})
    return folder


class Texts(unittest.TestCase):
    @pytest.mark.long
    def test_no_text_is_clipped_or_overlaps(self):
        for make in (sweep, one_case, two_keys, many):
            with self.subTest(make.__name__), tempfile.TemporaryDirectory() as root:
                found, drawn, save = [], [], style.save

                def checked(figure, path):
                    with mock.patch.object(plt, "close"):
                        save(figure, path)
                    drawn.append(path.name)
                    figure.set_layout_engine("none")
                    found.extend(f"{path.name}: {problem}" for problem in texts.problems(figure))
                    plt.close(figure)

                with mock.patch.object(style, "save", checked):
                    make(root).report()
                self.assertGreater(len(drawn), 8)
                self.assertEqual(found, [])

    def test_the_check_finds_clipped_and_overlapping_texts(self):
        figure = plt.figure()
        figure.text(0.9, 0.5, "a title that is far too long")
        figure.text(0.3, 0.3, "one")
        figure.text(0.31, 0.3, "two")
        self.assertEqual(texts.problems(figure), ["clipped: 'a title that is far too long'", "overlap: 'one' and 'two'"])
        plt.close(figure)

    def test_a_saved_figure_is_not_laid_out_again(self):
        with plt.rc_context({"figure.autolayout": True}), tempfile.TemporaryDirectory() as root:  # of a user's matplotlibrc
            figure = plt.subplots(layout="constrained")[0]
            style.save(figure, Path(root) / "figure.png")
            self.assertNotIsInstance(figure.get_layout_engine(), TightLayoutEngine)

    def test_a_power_of_ten_of_an_axis_is_plain_text(self):
        figure, axes = plt.subplots()
        axes.plot([0.0, 1.0], [-2e-7, 3e-7])
        style.finish(figure)
        figure.canvas.draw()
        self.assertEqual(axes.yaxis.get_offset_text().get_text(), "×10⁻⁷")
        self.assertIn("\N{MINUS SIGN}2", [label.get_text() for label in axes.get_yticklabels()])
        plt.close(figure)
