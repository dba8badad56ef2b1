# SPDX-License-Identifier: BSD-3-Clause
"""Writes a movie of the surface of a case as MP4 and as GIF. Its title states the settings of the case, the time, the
part of the surface that is shown, and the stored warnings.

Usage: python3 -m shearwake.report.movie CASE.h5 [--out NAME] [--slow-down FACTOR] [--width PIXELS]
NAME is the path of the movies without extension; by default that of the case file. Needs numpy, h5py, matplotlib and
ffmpeg. Exit 0: done; 2: wrong arguments; 6: the case has no recorded surfaces, or ffmpeg is missing or failed.
"""
from __future__ import annotations

import argparse
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np

from .. import figure_style
from ..case import Case
from ..inputs import case_files
from ..plan import first_line
from . import layout, load
from .compare import compare_words
from .figures import fig_surface
from .page import player
from .progress import Progress
from .style import finish, plain, plt
from .words import counted, number

ENVIRONMENT = 6
FPS = 25            # largest frame rate, in frames per second
LEAST_FPS = 2       # a slower movie repeats frames
GIF_FPS, GIF_px = 12, 400  # largest frame rate and width of the GIF, whose files are large
INCHES = 6.4
LINE_in = 0.17       # height of a line of the title
BAR = 20             # characters of the progress bar
WARNINGS = 2         # largest number in the title; all are printed
WARNING_COLOUR = "#a02020"


class CannotWrite(Exception):
    """The movie cannot be written; the text states why and what to do."""


def read(path: Path) -> Any:
    """A case of a single file. Raises CannotWrite."""
    if path.is_dir():
        files = case_files(path / "cases") or case_files(path)
        raise CannotWrite(f"{path} is a folder; give one of its case files, for example {files[0]}" if files else
                          f"{path} is a folder without case files; run the job first")
    if not path.exists():
        raise CannotWrite(f"{path}: no such case file; run the job first")
    try:
        case = load.single_case(path)
    except (OSError, RuntimeError, KeyError, ValueError, TypeError) as error:
        raise CannotWrite(f"{path} is not a valid case file: {first_line(error)}") from error
    if len(load.surface_times(case)) < 2:
        raise CannotWrite(f"{path} contains fewer than two surfaces; run the case with record.frames = true or with "
                          "several record.snapshots_ms")
    return case


def name_of(case: Case) -> Any:
    """The settings of the case, or the title of its job if nothing is swept."""
    words = [*(["reference"] if case.is_reference else []), *compare_words.settings_texts(case.settings)]
    return ", ".join(words) or str(case.attributes.get("title", case.id))


def warnings_of(case: Case) -> Any:
    """The stored warnings as sentences, those of readings that are not valid first."""
    order = sorted(case.warnings, key=lambda warning: warning["severity"] != "error")
    return [f"{'not valid' if warning['severity'] == 'error' else 'warning'}: {warning['message']}" for warning in order]


def part_text(case: Case, limits: Any) -> str:
    """The part of the surface, or of the measured plane, that is shown, relative to the domain; limits in mm."""
    plane = layout.plane_name([case])
    _, x, y, _ = case.snapshot(0)
    shown = [limits[1] - limits[0], limits[3] - limits[2]]
    every = [1e3 * float(np.ptp(axis)) for axis in (x, y)]
    if all(part >= 0.999 * extent for part, extent in zip(shown, every)):
        return f"shown: {plane}, entire"
    return f"shown: {plane}, {number(shown[0], 3)} x {number(shown[1], 3)} mm of {number(every[0], 3)} x {number(every[1], 3)} mm"


def frame_rate(times_s: Any, slow_down: Any) -> Any:
    """The frames that are shown and their rate, so that the movie is `slow_down` times slower than the motion.
    Frames are skipped above FPS per second."""
    per_second = (len(times_s) - 1) / ((times_s[-1] - times_s[0]) * slow_down)
    step = max(1, int(np.ceil(per_second / FPS)))
    return range(0, len(times_s), step), per_second / step


def usual_slow_down(times_s: Any) -> Any:
    """The slow-down of the player: the run takes about six seconds."""
    run_s = float(times_s[-1] - times_s[0])
    return min(player.SLOW_DOWNS, key=lambda s: abs(np.log(s * run_s / player.PLAYED_s)))


class Picture:
    """The figure of which every frame is one state."""

    def __init__(self, case: Case, slow_down: Any, width_px: Any) -> None:
        self.case = case
        self.end, self.peak, limits = player.common_view([case])
        self.part = part_text(case, limits)
        header = [(line, "black") for line in layout.wrapped(name_of(case), INCHES - 1.0).splitlines()]
        stored = warnings_of(case)
        more = [f"and {counted(len(stored) - WARNINGS, 'more warning')}"] if len(stored) > WARNINGS else []
        header += [(line, WARNING_COLOUR) for text in [*stored[:WARNINGS], *more]
                   for line in layout.wrapped(text, INCHES - 1.0).splitlines()]
        x0, x1, y0, y1 = limits
        top = 0.4 + LINE_in * len(header)
        height = 1.05 + top + (INCHES - 1.0) * (y1 - y0) / (x1 - x0)
        self.figure = plt.figure(figsize=(INCHES, height), dpi=width_px / INCHES)
        self.axes = self.figure.add_axes([0.75 / INCHES, 1.05 / height, (INCHES - 1.0) / INCHES,
                                          (height - 1.05 - top) / height])
        self.bar = self.figure.add_axes([0.22, 0.52 / height, 0.56, 0.1 / height])
        for n, (line, colour) in enumerate(header):
            self.figure.text(0.75 / INCHES, 1.0 - (0.1 + LINE_in * n) / height, plain(line), va="top", color=colour, fontsize=8.5)
        self.limits, self.slow_down = limits, slow_down
        self.levels = load.levels(case)

    def draw(self, index: Any) -> Any:
        """RGB rows of frame `index`, with an even number of rows and columns."""
        shot = fig_surface.shot_of(self.case, index)
        self.axes.clear()
        image, _ = fig_surface.draw(self.axes, shot, plt.Normalize(-self.end, self.end), self.limits)
        if self.levels is not None:  # the limit of what can be felt
            fig_surface.draw_threshold(self.axes, self.levels)
        self.axes.set_title(f"t = {number(1e3 * shot.t_s)} ms, {number(self.slow_down)} times slower; {self.part}", loc="left",
                            fontsize=8.5)
        self.axes.set_xlabel("x (mm)")
        self.axes.set_ylabel("y (mm)")
        if not self.bar.has_data():
            self.figure.colorbar(image, cax=self.bar, orientation="horizontal", extend="both",
                                 label="$u_z$ (µm), positive into the tissue")
            finish(self.figure)
        self.figure.canvas.draw()
        rgb = np.asarray(self.figure.canvas.buffer_rgba())[:, :, :3]
        return rgb[: rgb.shape[0] // 2 * 2, : rgb.shape[1] // 2 * 2]


def encode(pictures: Any, size: Any, rate: Any, path: Path) -> None:
    """Pipes the pictures to ffmpeg, which writes a lossless intermediate file. Raises CannotWrite."""
    command = ["ffmpeg", "-loglevel", "error", "-y", "-f", "rawvideo", "-pix_fmt", "rgb24", "-s",
               f"{size[0]}x{size[1]}", "-r", f"{rate:.6f}", "-i", "-", "-c:v", "ffv1", str(path)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE) as ffmpeg:
        assert ffmpeg.stdin and ffmpeg.stderr  # pipes
        try:
            for picture in pictures:
                ffmpeg.stdin.write(picture.tobytes())
            ffmpeg.stdin.close()
        except BrokenPipeError:
            pass
        message = ffmpeg.stderr.read().decode("utf-8", "replace")
    if ffmpeg.returncode:
        raise CannotWrite(f"ffmpeg failed: {first_line(message)}")


def convert(source: Any, path: Path, *options: Any) -> None:
    """Converts the intermediate file. Raises CannotWrite."""
    part = path.with_name(f".{path.stem}.part{path.suffix}")
    done = subprocess.run(["ffmpeg", "-loglevel", "error", "-y", "-i", str(source), *options, str(part)],
                          capture_output=True, text=True, check=False, stdin=subprocess.DEVNULL)
    if done.returncode:
        part.unlink(missing_ok=True)
        raise CannotWrite(f"ffmpeg failed: {first_line(done.stderr)}")
    part.replace(path)


ENCODERS = {"libx264": ("-crf", "18"), "libopenh264": ("-b:v", "8M"), "mpeg4": ("-q:v", "3")}  # the best first


def available_encoder() -> str | None:
    """The best encoder of this ffmpeg for MP4; None if it has none. Distributions without libx264 have others."""
    listed = subprocess.run(["ffmpeg", "-hide_banner", "-encoders"], capture_output=True, text=True, check=False, stdin=subprocess.DEVNULL).stdout
    return next((name for name in ENCODERS if f" {name} " in listed), None)


def watched(indices: Any, progress: Any) -> Any:
    """The indices, with a bar on a terminal and a line per minute elsewhere."""
    for n, index in enumerate(indices):
        done = BAR * (n + 1) // len(indices)
        progress.show(f"[{'#' * done}{'.' * (BAR - done)}] frame {n + 1} of {len(indices)}")
        yield index
    progress.show("encoding")


def state(case: Case, times_s: Any, indices: Any, part: Any) -> None:
    """Prints what the movie shows, before it is drawn."""
    print(f"movie: {name_of(case)}")
    for text in warnings_of(case):
        print(f"movie: {text}")
    print(f"movie: {len(indices)} of {counted(len(times_s), 'frame')}, {number(1e3 * times_s[0])} to "
          f"{number(1e3 * times_s[-1])} ms; {part}", flush=True)


def write(case_path: Path, name: Path, slow_down: float | None, width_px: int) -> list[Path]:
    """Writes NAME.mp4, if this ffmpeg has an encoder, and NAME.gif, and returns their paths. Raises CannotWrite."""
    figure_style.reset()
    case = read(case_path)
    if not shutil.which("ffmpeg"):
        raise CannotWrite("a movie needs ffmpeg; install the Debian package ffmpeg, for example with scripts/setup")
    times_s = load.surface_times(case)
    slow_down = slow_down or usual_slow_down(times_s)
    indices, rate = frame_rate(times_s, slow_down)
    picture = Picture(case, slow_down, width_px)
    state(case, times_s, indices, picture.part)
    encoder = available_encoder()
    if encoder is None:
        print(f"movie: no MP4 is written, since this ffmpeg has none of the encoders {', '.join(ENCODERS)}")
    progress = Progress(name="movie")
    first = picture.draw(0)
    lossless = name.with_name(f".{name.name}.part.mkv")
    movie, gif = name.with_name(name.name + ".mp4"), name.with_name(name.name + ".gif")
    try:
        encode((picture.draw(i) for i in watched(indices, progress)), first.shape[1::-1], rate, lossless)
        smooth, slower = (f"fps={min(most, max(rate, LEAST_FPS)):.6f}" for most in (FPS, GIF_FPS))
        if encoder:
            convert(lossless, movie, "-vf", smooth, "-c:v", encoder, "-pix_fmt", "yuv420p", *ENCODERS[encoder], "-movflags", "+faststart")
        scale = f"scale='min({GIF_px},iw)':-1:flags=lanczos"
        convert(lossless, gif, "-vf", f"{slower},{scale},split[a][b];[a]palettegen[p];[b][p]paletteuse", "-loop", "0")
    finally:
        progress.end()
        lossless.unlink(missing_ok=True)
    return [movie, gif] if encoder else [gif]


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(prog="movie", description="Writes a movie of the surface of a case.")
    parser.add_argument("case", type=Path)
    parser.add_argument("--out", type=Path)
    parser.add_argument("--slow-down", type=float)
    parser.add_argument("--width", type=int, default=960)
    options = parser.parse_args(arguments)
    name = options.out or options.case.with_suffix("")
    try:
        for path in write(options.case, name, options.slow_down, options.width):
            print(f"movie: {path}")
    except (CannotWrite, OSError) as error:
        print(f"movie: {error}", file=sys.stderr)
        return ENVIRONMENT
    return 0


if __name__ == "__main__":
    sys.stdout.reconfigure(errors="replace")  # type: ignore[attr-defined]
    sys.exit(main(sys.argv[1:]))
