"""Recordings on disk: a solution, with orientations and the shapes of the world."""

from pathlib import Path
from typing import Any

import numpy as np

from kickdrift.core import archive
from kickdrift.io.shapes import Catalogue, shapes_of
from kickdrift.io.solution_file import arrays_of, header_of, members
from kickdrift.world.recordings.appearance import Appearance, DrawnCloth, DrawnShape, Rod
from kickdrift.world.recordings.recording import Recording


def save_recording(recording: Recording, path: str | Path) -> Path:
    """Write a recording to a file, whole or not at all; as `kickdrift.io.solution_file.save`."""
    looks, catalogue = recording.appearance, Catalogue()
    parts = [(part.body, catalogue.place(part.shape)) for part in looks.parts]
    header = {
        "format": archive.RECORDING,
        **header_of(recording),
        "shapes": catalogue.words,
        "names": list(looks.names.items()),
        "cloth_names": [cloth.name for cloth in looks.cloths],
        "cloth_kinds": [cloth.kind for cloth in looks.cloths],
    }
    arrays = {
        **arrays_of(recording),
        "orientation": recording.orientation,
        "angular_velocity": recording.angular_velocity,
        "particles": recording.particles,
        "contact_points": recording.contact_points,
        "kinds": looks.kinds,
        "cloths": np.array([(cloth.first, cloth.last, len(cloth.triangles)) for cloth in looks.cloths]).reshape(-1, 3),
        "cloth radii": np.array([cloth.radius for cloth in looks.cloths], dtype=np.float64),
        "triangles": np.concatenate([np.zeros((0, 3), np.int64), *(cloth.triangles for cloth in looks.cloths)]),
        "shape numbers": catalogue.numbers,
        "parts": np.array(parts, dtype=np.int64).reshape(-1, 2),
        "places": _rows([[*part.position, *part.orientation] for part in looks.parts], 7),
        "rods": np.array([(rod.body_a, rod.body_b) for rod in looks.rods], dtype=np.int64).reshape(-1, 2),
        "rod ends": _rows([[*rod.point_a, *rod.point_b] for rod in looks.rods], 6),
    }
    return archive.write(path, header, arrays)


def _rows(rows: list[list[float]], width: int) -> Any:
    return np.array(rows, dtype=np.float64).reshape(-1, width)


def assemble(head: dict[str, Any], arrays: dict[str, Any]) -> Recording:
    """Create a recording from the contents of a file.

    Raises
    ------
    LookupError, TypeError, ValueError
        If it holds something else.
    """
    if head["digest"] != archive.digest(head, arrays):
        raise ValueError("it was changed after it was written")
    known = members(head, arrays)
    times, bodies = known["x"].shape[:2]
    turns, spins, kinds = arrays["orientation"], arrays["angular_velocity"], arrays["kinds"]
    if turns.shape != (times, bodies, 4) or spins.shape != known["x"].shape or kinds.shape != (bodies,):
        raise ValueError(f"x and orientation have shapes {known['x'].shape} and {turns.shape}")
    shapes = shapes_of(head["shapes"], arrays["shape numbers"])
    rows = zip(arrays["parts"].tolist(), arrays["places"], strict=True)
    parts = tuple(DrawnShape(body, shapes[shape], place[:3], place[3:7]) for (body, shape), place in rows)
    ends = zip(arrays["rods"].tolist(), arrays["rod ends"], strict=True)
    rods = tuple(Rod(a, end[:3], b, end[3:6]) for (a, b), end in ends)
    shown = [*(part.body for part in parts), *(body for rod in rods for body in (rod.body_a, rod.body_b))]
    if any(not 0 <= body < bodies for body in shown):
        raise ValueError(f"a shape belongs to a body that does not exist; there are {bodies}")
    names = {int(row): str(name) for row, name in head["names"]}
    points = {name: arrays[name] for name in ("particles", "contact_points")}
    for name, values in points.items():
        if values.ndim != 3 or values.shape[::2] != (times, 3):
            raise ValueError(f"x and {name} have shapes {known['x'].shape} and {values.shape}")
    looks = Appearance(kinds, parts, rods, names, _cloths(head, arrays, points["particles"].shape[1]))
    return Recording(**known, **points, orientation=turns, angular_velocity=spins, appearance=looks)


def _cloths(head: dict[str, Any], arrays: dict[str, Any], count: int) -> tuple[DrawnCloth, ...]:
    """Return the cloths, ropes and soft bodies of a file, whose vertices are among so many."""
    cloths, triangles, begin = [], arrays["triangles"], 0
    looks = zip(head["cloth_names"], head["cloth_kinds"], arrays["cloth radii"].tolist(), strict=True)
    for (name, kind, radius), (first, last, n_triangles) in zip(looks, arrays["cloths"].tolist(), strict=True):
        own = triangles[begin : begin + n_triangles]
        begin += n_triangles
        if not (0 <= first < last <= count and len(own) == n_triangles and 0 <= own.min() <= own.max() < last - first):
            raise ValueError(f"a cloth has the vertices from {first} to {last} of {count}, and {n_triangles} triangles")
        if not 0.0 <= radius < np.inf:
            raise ValueError(f"a rope has a radius of {radius}")
        cloths.append(DrawnCloth(None if name is None else str(name), first, last, own, radius, str(kind)))
    return tuple(cloths)
