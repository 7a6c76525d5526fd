"""Pages for the browser: a scene that plays, in one HTML file that needs no server and no network."""

import json
import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from html import escape
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from kickdrift.core.errors import FileFormatError, KickdriftError
from kickdrift.core.files import path_of, written
from kickdrift.engine.solution import Solution
from kickdrift.viewer.server import local_server

Floats = NDArray[np.float64]
Singles = NDArray[np.float32]
AHEAD = (-0.42, 0.82, -0.36)  # where the camera looks first
_FIELD = math.radians(34.0)  # of the camera, from top to bottom
_TITLE, _END = "<title>Viser</title>", "</body>"  # of viser's page

# The client of viser takes a camera from the address of its page, which a page in a frame cannot change.
_STAND_BACK = """
<script>(() => {
  const ball = %s, aspect = innerWidth / innerHeight, get = URLSearchParams.prototype.get;
  if (!(aspect > 0 && aspect < 1)) return;  // a frame that is hidden has no size
  const farther = Math.sin(ball.half) / Math.sin(Math.atan(aspect * Math.tan(ball.half)));
  const position = ball.centre.map((at, axis) => at + farther * ball.away[axis]).join();
  URLSearchParams.prototype.get = function (name) {
    return get.call(this, name) ?? (name === "initialCameraPosition" ? position : null);
  };
})();</script>"""


class Stage(NamedTuple):
    """What is drawn on: the scene of viser, its camera, and its clock, ``wait(seconds)``."""

    scene: Any
    camera: Any
    wait: Callable[[float], None]

    def look(self, centre: Floats, radius: float) -> None:
        """Place the camera so that it sees a ball, and the lamps."""
        self.camera.position, self.camera.look_at = place_for(centre, radius), centre
        distance = float(np.linalg.norm(self.camera.position - centre))
        self.camera.up = (0.0, 0.0, 1.0)
        self.camera.fov = _FIELD
        self.scene.configure_environment_map(None)
        self.scene.configure_default_lights(False)
        self.scene.add_light_ambient("/ambient", intensity=1.3)
        self.scene.add_light_directional("/lamp", intensity=2.2, cast_shadow=True, position=(-3.0, -4.0, 8.0))
        self.camera.near, self.camera.far = 1e-3 * distance, 1e2 * distance


def place_for(centre: Floats, radius: float, aspect: float = 1.0) -> Floats:
    """Return where a camera has to be to see all of a ball; the aspect is that of the picture, width over height."""
    distance = radius / math.sin(math.atan(min(aspect, 1.0) * math.tan(0.5 * _FIELD)))
    result: Floats = centre - distance * np.array(AHEAD) / np.linalg.norm(AHEAD)
    return result


def check_in_memory(solution: Solution) -> None:
    """Refuse a solution that has only the first and the last of its states.

    Raises
    ------
    KickdriftError
    """
    if solution.saved_to:
        raise KickdriftError(
            f"the states are on disk, in {solution.saved_to!r}, and the solution has only the first and the last; run without"
            " save_to, or with a larger save_every, to show them."
        )


def write_page(path: str | Path, title: str, draw: Callable[[Stage], str]) -> Path:
    """Write what a function draws, as one HTML file, whole or not at all; what it returns is HTML beside the scene.

    Raises
    ------
    ArgumentError
        For anything but a path.
    FileFormatError
        If the name does not end in .html, or the file cannot be written.
    MissingExtraError
        If viser is not installed.
    """
    target = path_of(path, "run.html")
    if target.suffix.lower() != ".html":
        raise FileFormatError(f"path={str(path)!r} cannot be written: pages for the browser end in .html.")
    try:
        with written(target) as partial, _serialized(draw) as page:
            partial.write_text(page.replace(_TITLE, f"<title>{escape(title)}</title>", 1), encoding="utf-8")
    except OSError as error:
        reason = error.strerror or error
        raise FileFormatError(f"path={str(path)!r} cannot be written: {reason}; choose another folder.") from None
    return target


@contextmanager
def _serialized(draw: Callable[[Stage], str]) -> Iterator[str]:
    """Have a function draw, and return the page that shows it; scenes of viser belong to a server, which is stopped then."""
    with local_server(0) as server:
        recorder = server.get_scene_serializer()
        beside = draw(Stage(server.scene, server.initial_camera, recorder.insert_sleep))
        page = recorder.as_html().replace(_TITLE, _TITLE + _stand_back(server.initial_camera), 1)
        end = page.rindex(_END)
        yield page[:end] + beside + page[end:]


def _stand_back(camera: Any) -> str:
    """Return the script that moves the camera of a page that is higher than wide back, as `place_for` does."""
    centre, away = np.array(camera.look_at), np.array(camera.position) - np.array(camera.look_at)
    return _STAND_BACK % json.dumps({"half": 0.5 * _FIELD, "centre": centre.tolist(), "away": away.tolist()})


def rounded(values: Floats, grain: float) -> Singles:
    """Round to multiples of a power of two, at most the grain: the last bits are zero, and compress well."""
    step = 2.0 ** math.floor(math.log2(grain))
    result: Singles = (np.round(values / step) * step + 0.0).astype(np.float32)
    return result


def linear(colours: ArrayLike) -> NDArray[np.uint8]:
    """Return colours (..., 3) from 0 to 1 in the form that viser draws batched meshes and lines in.

    Its meshes and points take them as screens do (sRGB, IEC 61966-2-1), but these without the curve of screens, from 0 to
    255: they were too pale with it.
    """
    c = np.asarray(colours, dtype=np.float64)
    result: NDArray[np.uint8] = np.round(
        255.0 * np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)
    ).astype(np.uint8)
    return result
