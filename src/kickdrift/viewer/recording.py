"""Recordings of worlds as pages for the browser."""

from collections.abc import Mapping
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from kickdrift.core.colours import COLOURS, SUM
from kickdrift.viewer.bodies import DrawnBodies, check_can_be_seen, extent, parts_of
from kickdrift.viewer.contacts import ContactPoints
from kickdrift.viewer.curves import Curve, panel
from kickdrift.viewer.meshes import FINE, TURN, State
from kickdrift.viewer.page import Stage, check_in_memory, write_page
from kickdrift.world.layout import DYNAMIC
from kickdrift.world.recordings.appearance import DrawnShape
from kickdrift.world.recordings.recording import Recording

Floats = NDArray[np.float64]
_RATE = 30.0  # states a second, at least, where so many were kept
_MOST_POSES = 900_000  # that differ from those before: 18.5 MB; a thousand bodies that never rest have as many in 30 s


def recording_to_html(recording: Recording, path: str | Path) -> Path:
    """Write a recording as a page that plays in the browser, in real time, and can be turned with the mouse.

    Parameters
    ----------
    recording : Recording
        The states kept are shown, 30 a second or a few more; there is nothing between them. Where so much moves for so long
        that the file would have more than 20 MB, 15 or 10 a second are. Its points of contacts are shown, if they were
        recorded.
    path : path
        Ends in ``.html``.

    Returns
    -------
    Path
        The file written. It needs no server and no network.

    Raises
    ------
    KickdriftError
        If there is nothing to show, or the states are on disk.
    FileFormatError
        If the file cannot be written.
    MissingExtraError
        If viser is not installed.
    """
    check_can_be_seen(recording.appearance, "the recording")
    check_in_memory(recording)
    return write_page(path, recording.about.system, lambda stage: _play(stage, recording))


def _play(stage: Stage, recording: Recording) -> str:
    rows, appearance = rows_shown(recording.t), recording.appearance
    poses = _moved(recording, rows, parts_of(appearance)[0])
    if poses > _MOST_POSES:
        rows = rows_shown(recording.t, _RATE / -(-poses // _MOST_POSES))
    x, q = recording.x[rows], recording.orientation[rows]
    centre, radius = extent(appearance, x, recording.particles[rows])
    stage.look(centre, radius)
    moves = (x != x[0]).any(axis=(0, 2)) | (q != q[0]).any(axis=(0, 2))
    drawn = DrawnBodies(stage.scene, appearance, _state(recording, 0), moves, radius)
    contacts = ContactPoints(stage.scene, radius) if recording.contact_points.size else None
    for before, row in zip([rows[0], *rows], rows, strict=False):
        stage.wait(float(recording.t[row] - recording.t[before]))
        drawn.show(_state(recording, row))
        if contacts is not None:
            points = recording.contact_points[row]
            contacts.show(points[np.isfinite(points[:, 0])])
    stage.wait(1.0 / _RATE)  # the last state is seen, too
    t = recording.t
    return panel(recording.about.system, t, _energies(recording.derived), "J", float(t[-1] - t[0]), "s")


def _state(recording: Recording, row: int) -> State:
    return State(recording.x[row], recording.orientation[row], recording.particles[row])


def _energies(derived: Mapping[str, Floats]) -> list[Curve]:
    kinetic, potential = derived["kinetic energy"], derived["potential energy"]
    potential = potential - potential.min()
    return [
        Curve("kinetic + potential energy", kinetic + potential, SUM),
        Curve("kinetic", kinetic, COLOURS[1]),
        Curve("potential", potential, COLOURS[0]),
    ]


def rows_shown(t: Floats, rate: float = _RATE) -> list[int]:
    """Choose rows so that no two of them are farther apart than a rate asks for, where the states kept allow that."""
    rows, longest = [0], (1.0 + 1e-9) / rate
    while rows[-1] < t.size - 1:
        last = int(np.searchsorted(t, t[rows[-1]] + longest, side="right")) - 1
        rows.append(max(last, rows[-1] + 1))
    return rows


def _moved(recording: Recording, rows: list[int], parts: list[DrawnShape]) -> int:
    """Count poses of shapes that can be told from those in the row before."""
    sizes = {part.body: part.shape.reach for part in parts if recording.appearance.kinds[part.body] == DYNAMIC}
    bodies, grains = list(sizes), FINE * np.array(list(sizes.values()))
    count = int(recording.particles.shape[1]) * len(rows) // 2  # a vertex takes less than half of the room of a pose
    for before, row in pairwise(rows):
        way = np.abs(recording.x[row, bodies] - recording.x[before, bodies]).max(axis=1, initial=0.0)
        turn = np.abs(recording.orientation[row, bodies] - recording.orientation[before, bodies]).max(
            axis=1, initial=0.0
        )
        count += int(np.count_nonzero((way > grains) | (turn > TURN)))
    return count
