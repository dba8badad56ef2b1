# SPDX-License-Identifier: BSD-3-Clause
"""Faster text in Matplotlib: plain tick labels instead of formulas, and one subset of each font for all PDF files.

Parsing formulas and reducing fonts otherwise take half of the time of a report.
"""
import io
import re

from matplotlib.backends import _backend_pdf_ps
from matplotlib.ticker import ScalarFormatter

from words import SUPERSCRIPTS

# Characters that most figures contain. A figure with other characters adds them to the font.
USUAL = {ord(c) for c in [*map(chr, range(0x20, 0x7F)), *"°²³µ·×–⁻⁰¹⁴⁵⁶⁷⁸⁹−ηθσΣΔ"]}

get_offset = ScalarFormatter.get_offset
get_glyphs_subset = _backend_pdf_ps.get_glyphs_subset
subsets = {}  # path of a font -> its characters and the bytes of the font file with them


def plain_offset(self):
    """The power of ten of an axis as '×10⁻⁷' instead of '1e−7'."""
    return re.sub(r"1e(\N{MINUS SIGN}?\d+)", lambda found: "×10" + found[1].replace("\N{MINUS SIGN}", "-").translate(
        SUPERSCRIPTS), get_offset(self))


def common_subset(path, characters):
    """The file of a font with all usual characters, which is made once; fonts of other characters are made again."""
    wanted, (known, content) = {ord(c) for c in characters}, subsets.get(path, (USUAL, b""))
    if not content or not wanted <= known:
        known = known | wanted
        content = get_glyphs_subset(path, "".join(map(chr, sorted(known)))).getvalue()
        subsets[path] = known, content
    return io.BytesIO(content)


def install():
    ScalarFormatter.get_offset = plain_offset
    _backend_pdf_ps.get_glyphs_subset = common_subset
