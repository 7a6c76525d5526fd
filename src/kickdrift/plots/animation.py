"""Animations of recordings."""

import math
import os
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.arguments import is_whole
from kickdrift.core.errors import ArgumentError, FileFormatError
from kickdrift.core.files import path_of, written
from kickdrift.engine.progress import Bar
from kickdrift.plots.page import FAINT, INK, new_figure
from kickdrift.plots.painter import Painter
from kickdrift.plots.scenery import Pose
from kickdrift.world.recordings.recording import Recording

Floats = NDArray[np.float64]
Pixels = NDArray[np.uint8]
_PIXELS = 310_000
_DPI = 100
_MOST_WORKERS = 4
_LAST_SECONDS = 1.0  # that the last picture of a GIF stays, before it begins again
_NEARLY_WHITE = 247
_PACKING = np.array([256**2, 256, 1], dtype=np.int32)  # of red, green and blue in one number
_SAMPLES = 8  # pictures that the colours of a GIF are chosen from


def animate_recording(
    recording: Recording, path: str | Path, *, speed: float = 1.0, rate: int = 25, progress: bool | None = None
) -> Path:
    """Write an animation of a recording.

    Parameters
    ----------
    recording : Recording
        Between the states kept, poses are interpolated linearly.
    path : path
        Ends in ``.gif``, or in ``.mp4`` if the program ffmpeg is installed.
    speed : float
        Seconds of the recording per second of the animation.
    rate : int
        Frames per second, at most 50.
    progress : bool, optional
        Show a bar; by default on a terminal, where it takes more than two seconds.

    Returns
    -------
    Path
        The file written.

    Raises
    ------
    ArgumentError
        For an invalid speed, rate or path.
    FileFormatError
        If the file cannot be written, or ffmpeg is missing.
    MissingExtraError
        If matplotlib is not installed.
    """
    if not (isinstance(speed, int | float | np.integer | np.floating) and 0.0 < float(speed) < math.inf):
        raise ArgumentError(f"speed={speed!r} must be positive and finite; 1 is real time, 0.5 half as fast.")
    if not is_whole(rate, 1, 50):
        raise ArgumentError(f"rate={rate!r} must be a whole number of frames per second, from 1 to 50.")
    target = path_of(path, "run.gif")
    write = {".gif": _write_gif, ".mp4": _write_mp4}.get(target.suffix.lower())
    if write is None:
        raise FileFormatError(f"path={str(path)!r} cannot be written: animations end in .gif or .mp4.")
    if write is _write_mp4:
        _check_ffmpeg(path)
    try:
        with closing(_Film(recording, speed, int(rate), progress)) as film, written(target) as partial:
            write(film, partial)
    except OSError as error:
        reason = error.strerror or error
        raise FileFormatError(f"path={str(path)!r} cannot be written: {reason}; choose another folder.") from None
    return target


class _Film:
    """The pictures of a film, with the time written on them."""

    def __init__(self, recording: Recording, speed: float, rate: int, progress: bool | None) -> None:
        self.figure: Any = new_figure(1.0, 1.0, "")  # says so where matplotlib is missing, before the work
        self.rate = rate
        self._recording = recording
        count = max(1, math.floor((recording.t[-1] - recording.t[0]) * rate / speed + 1e-9) + 1)
        self.times = recording.t[0] + np.arange(count) * (speed / rate)
        workers = min(_MOST_WORKERS, os.cpu_count() or 1, count)
        self._painters = [Painter(recording, _PIXELS) for _ in range(workers)]
        self._samples: dict[float, Pixels] = {}
        self._compose(speed)
        self._bar = Bar(count, progress, unit="picture")
        self._painted_count, self._started = 0, perf_counter()

    def close(self) -> None:
        """Remove the bar."""
        self._bar.close()

    def _compose(self, speed: float) -> None:
        from matplotlib.backends.backend_agg import FigureCanvasAgg

        width, height = self._painters[0].width, self._painters[0].height
        self.figure.set_layout_engine("none")
        self.figure.set_size_inches(width / _DPI, height / _DPI)
        self.figure.set_dpi(_DPI)
        self._canvas: Any = FigureCanvasAgg(self.figure)
        axes = self.figure.add_axes((0.0, 0.0, 1.0, 1.0))
        axes.set_axis_off()
        self._image = axes.imshow(np.zeros((height, width, 3), dtype=np.uint8), aspect="auto", interpolation="nearest")
        pace = "" if speed == 1.0 else f"   x {speed:g}"
        style = {"transform": axes.transAxes, "fontsize": 9.5, "va": "top"}
        axes.text(0.015, 1.0 - 8.0 / height, self._recording.about.system, color=INK, **style)
        self._clock = axes.text(1.0 - 0.015, 1.0 - 8.0 / height, "", color=FAINT, ha="right", **style)
        self._pace = pace

    def pose(self, time: float) -> Pose:
        """Return where the bodies were, on the straight way between two states."""
        recording = self._recording
        after = int(np.clip(np.searchsorted(recording.t, time, side="right"), 1, recording.t.size - 1))
        if recording.t.size == 1:
            return Pose(recording.x[0], recording.orientation[0], recording.particles[0])
        before = after - 1
        part = float(np.clip((time - recording.t[before]) / (recording.t[after] - recording.t[before]), 0.0, 1.0))
        p, q = recording.orientation[before], recording.orientation[after]
        q = np.where(np.sum(p * q, axis=1, keepdims=True) < 0.0, -q, q)
        place = (1.0 - part) * recording.x[before] + part * recording.x[after]
        turn = (1.0 - part) * p + part * q
        particles = (1.0 - part) * recording.particles[before] + part * recording.particles[after]
        return Pose(place, turn / np.linalg.norm(turn, axis=1, keepdims=True), particles)

    def samples(self) -> Iterator[Pixels]:
        """Paint some pictures from all over the film."""
        times = self.times[np.unique(np.linspace(0, len(self.times) - 1, _SAMPLES).astype(np.intp))]
        for time, pixels in zip(times, self._painted(times), strict=True):
            self._samples[time] = pixels
            yield pixels

    def __iter__(self) -> Iterator[Pixels]:
        """Paint all pictures but those that are painted already."""
        painted = self._painted(self.times[[time not in self._samples for time in self.times]])
        for time in self.times:
            yield self._samples[time] if time in self._samples else next(painted)

    def _painted(self, times: Floats) -> Iterator[Pixels]:
        """Paint pictures, several at once."""
        workers = len(self._painters)
        with ThreadPoolExecutor(workers) as pool:
            for first in range(0, len(times), workers):
                some = times[first : first + workers].tolist()
                pictures = pool.map(lambda painter, time: painter.paint(self.pose(time)), self._painters, some)
                yield from map(self._finished, some, pictures)

    def _finished(self, time: float, picture: Pixels) -> Pixels:
        self._image.set_data(picture)
        self._clock.set_text(f"{time:.2f} s{self._pace}")
        self._canvas.draw()
        self._painted_count += 1
        self._bar.show(self._painted_count, perf_counter() - self._started)
        return np.asarray(self._canvas.buffer_rgba())[..., :3].copy()


def _write_gif(film: _Film, path: Path) -> None:
    from PIL import Image

    palette = _palette(film.samples())
    frames = (Image.fromarray(pixels).quantize(palette=palette, dither=Image.Dither.NONE) for pixels in film)
    first = next(frames)
    # Delays are whole hundredths of a second: rounded so that they add up.
    ends = [round(100 * (k + 1) / film.rate) for k in range(len(film.times))]
    delays = [10 * (end - begin) for begin, end in zip([0, *ends], ends, strict=False)]
    delays[-1] = int(1000 * _LAST_SECONDS)
    first.save(path, format="GIF", save_all=True, append_images=frames, duration=delays, loop=0, optimize=False)


def _palette(samples: Iterator[Pixels]) -> Any:
    """Choose the colours of all pictures at once: with colours of their own, what does not move would flicker."""
    from PIL import Image

    packed = np.concatenate([sample.reshape(-1, 3) @ _PACKING for sample in samples])
    numbers, counts = np.unique(packed, return_counts=True)  # of rows of three, it would take 5 s instead of 0.2
    colours = (numbers[:, None] // _PACKING % 256).astype(np.uint8)
    # The square root leaves to bodies, which are small and shaded, their part beside a wide ground.
    weighted = np.repeat(colours, np.sqrt(counts).astype(np.intp), axis=0)
    palette = Image.fromarray(weighted[None]).quantize(255, method=Image.Quantize.MEDIANCUT)
    entries = np.array(palette.getpalette()).reshape(-1, 3)
    entries[entries.min(axis=1) > _NEARLY_WHITE] = 255  # white stays white on a white page
    palette.putpalette(entries.ravel().tolist())
    return palette


def _check_ffmpeg(path: str | Path) -> None:
    new_figure(1.0, 1.0, "")  # says so where matplotlib is missing
    from matplotlib.animation import FFMpegWriter

    if not FFMpegWriter.isAvailable():
        raise FileFormatError(
            f"path={str(path)!r} needs the program ffmpeg, which was not found; install it, or use a name that ends in"
            " .gif."
        )


def _write_mp4(film: _Film, path: Path) -> None:
    from matplotlib.animation import FFMpegWriter

    writer = FFMpegWriter(fps=film.rate)
    with writer.saving(film.figure, str(path), _DPI):
        for _ in film:
            writer.grab_frame()
