"""Where the particles and triangles of cloths may be for as long as pairs are not sought anew.

All is in a frame that moves with the cloths, so that what flies as a whole stays in small boxes.
"""

import math
from typing import Any

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import cross, dot, minus, plus, times
from kickdrift.world.cloth.layout import (
    CLOTH_RADIUS,
    CORNERS,
    FACE_AREA,
    FIRST_FACE,
    FIRST_NODE,
    FIRST_PARTICLE,
    FRAME_VELOCITY,
    LAST_FACE,
    LAST_NODE,
    LAST_PARTICLE,
    PARTICLE_VELOCITY,
    REACH,
    SEARCH_AGE,
    SKIN,
    TRAVELLED,
)
from kickdrift.world.collision.bvh import fit
from kickdrift.world.columns import vector_at
from kickdrift.world.tables import (
    CLOTH,
    CLOTH_NUMBERS,
    CLOTH_SEARCH,
    CLOTH_TREE,
    FACE,
    FACE_BOUNDS,
    FACE_NORMALS,
    FACE_NUMBERS,
    NORMAL_TREE,
    PARTICLE,
    PARTICLE_BOUNDS,
    PARTICLE_SHIFT,
    floats,
    integers,
    rows,
)

_SQUEEZED = 0.6  # of its area at rest
_ANY = 9.0  # half a side of the box of a normal that is not known
# Cosine of the angle between normals and a direction. Of six triangles around a vertex five may be in a patch, and where they
# lean by more than 30 degrees the first and the last of them may cross while the sixth is folded away.
_FLAT = 0.9


@compiled
def set_frame(world: int) -> float:
    """Let the frame move as the particles do on average, and return how fast they are in it, by the mean of squares."""
    particle, search = floats(world, PARTICLE), floats(world, CLOTH_SEARCH)
    total, squares, count = (0.0, 0.0, 0.0), 0.0, rows(world, PARTICLE)
    for i in range(count):
        v = vector_at(particle, i, PARTICLE_VELOCITY)
        total, squares = plus(total, v), squares + dot(v, v)
    mean = times(1.0 / count, total)
    for k in range(3):
        search[0, FRAME_VELOCITY + k] = mean[k]
    search[0, SEARCH_AGE] = search[0, TRAVELLED] = 0.0
    return math.sqrt(max(squares / count - dot(mean, mean), 0.0))


@compiled
def travels(world: int, part: float) -> float:
    """Return how far two particles move against each other at most in the drift of a part, m."""
    particle, shift, most = floats(world, PARTICLE), floats(world, PARTICLE_SHIFT), 0.0
    x, y, z = vector_at(floats(world, CLOTH_SEARCH), 0, FRAME_VELOCITY)
    for i in range(rows(world, PARTICLE)):
        u = part * (particle[i, PARTICLE_VELOCITY] - x) + shift[i, 0]
        v = part * (particle[i, PARTICLE_VELOCITY + 1] - y) + shift[i, 1]
        w = part * (particle[i, PARTICLE_VELOCITY + 2] - z) + shift[i, 2]
        most = max(most, u * u + v * v + w * w)
    return 2.0 * math.sqrt(most)


@compiled
def stays(world: int, h: float) -> bool:
    """Whether all particles are in their boxes, and still will be after they have drifted for the time h, s."""
    search, particle, bounds = floats(world, CLOTH_SEARCH), floats(world, PARTICLE), floats(world, PARTICLE_BOUNDS)
    own, numbers, shift = integers(world, CLOTH), floats(world, CLOTH_NUMBERS), floats(world, PARTICLE_SHIFT)
    frame, age = vector_at(search, 0, FRAME_VELOCITY), search[0, SEARCH_AGE]
    for cloth in range(rows(world, CLOTH)):
        radius = numbers[cloth, CLOTH_RADIUS]
        for i in range(own[cloth, FIRST_PARTICLE], own[cloth, LAST_PARTICLE]):
            for k in range(3):
                x = particle[i, k] - age * frame[k]
                then = x + h * (particle[i, PARTICLE_VELOCITY + k] - frame[k]) + shift[i, k]
                if min(x, then) < bounds[i, k] + radius or max(x, then) > bounds[i, 3 + k] - radius:
                    return False
    return True


@compiled
def sweep(world: int, h: float) -> None:
    """Draw the boxes of all particles, triangles and trees anew, around what they move through in the time h, s."""
    own, numbers = integers(world, CLOTH), floats(world, CLOTH_NUMBERS)
    for cloth in range(rows(world, CLOTH)):
        _sweep_particles(world, cloth, h, numbers[cloth, CLOTH_RADIUS], numbers[cloth, SKIN])
        for f in range(own[cloth, FIRST_FACE], own[cloth, LAST_FACE]):
            _enclose(world, f)
            _look(world, f, h)
        first, last = own[cloth, FIRST_NODE], own[cloth, LAST_NODE]
        fit(floats(world, CLOTH_TREE)[first:last], floats(world, FACE_BOUNDS))
        fit(floats(world, NORMAL_TREE)[first:last], floats(world, FACE_NORMALS))


@compiled
def _sweep_particles(world: int, cloth: int, h: float, radius: float, skin: float) -> None:
    own, particle, bounds = integers(world, CLOTH), floats(world, PARTICLE), floats(world, PARTICLE_BOUNDS)
    frame = vector_at(floats(world, CLOTH_SEARCH), 0, FRAME_VELOCITY)
    for i in range(own[cloth, FIRST_PARTICLE], own[cloth, LAST_PARTICLE]):
        way = times(h, minus(vector_at(particle, i, PARTICLE_VELOCITY), frame))
        for k in range(3):
            bounds[i, k] = particle[i, k] + min(way[k], 0.0) - radius - skin
            bounds[i, 3 + k] = particle[i, k] + max(way[k], 0.0) + radius + skin
        bounds[i, REACH] = math.sqrt(dot(way, way)) + skin


@compiled(inline=True)
def _enclose(world: int, f: int) -> None:
    face, bounds, box = integers(world, FACE), floats(world, PARTICLE_BOUNDS), floats(world, FACE_BOUNDS)
    a, b, c = face[f, CORNERS], face[f, CORNERS + 1], face[f, CORNERS + 2]
    for k in range(3):
        box[f, k] = min(bounds[a, k], bounds[b, k], bounds[c, k])
        box[f, 3 + k] = max(bounds[a, 3 + k], bounds[b, 3 + k], bounds[c, 3 + k])


@compiled
def _look(world: int, f: int, h: float) -> None:
    """Draw a box around the normal of a triangle, of length one, as it is now and will be after the time h.

    One of a triangle that is squeezed may turn over in its plane.
    """
    face, particle = integers(world, FACE), floats(world, PARTICLE)
    origin, motion = vector_at(particle, face[f, CORNERS], 0), vector_at(particle, face[f, CORNERS], PARTICLE_VELOCITY)
    b, c = face[f, CORNERS + 1], face[f, CORNERS + 2]
    p, q = minus(vector_at(particle, b, 0), origin), minus(vector_at(particle, c, 0), origin)
    u = minus(vector_at(particle, b, PARTICLE_VELOCITY), motion)
    v = minus(vector_at(particle, c, PARTICLE_VELOCITY), motion)
    now, then = cross(p, q), cross(plus(p, times(h, u)), plus(q, times(h, v)))
    now_size, then_size = math.sqrt(dot(now, now)), math.sqrt(dot(then, then))
    known = min(now_size, then_size) > _SQUEEZED * 2.0 * floats(world, FACE_NUMBERS)[f, FACE_AREA]
    box = floats(world, FACE_NORMALS)
    for k in range(3):
        one, other = now[k] / now_size, then[k] / then_size
        box[f, k] = min(one, other) if known else -_ANY
        box[f, 3 + k] = max(one, other) if known else _ANY


@compiled
def is_flat(boxes: Any, m: int, n: int) -> bool:
    """Whether all normals in two boxes are near one direction."""
    x, u = min(boxes[m, 0], boxes[n, 0]), max(boxes[m, 3], boxes[n, 3])
    y, v = min(boxes[m, 1], boxes[n, 1]), max(boxes[m, 4], boxes[n, 4])
    z, w = min(boxes[m, 2], boxes[n, 2]), max(boxes[m, 5], boxes[n, 5])
    middle, half = (0.5 * (x + u), 0.5 * (y + v), 0.5 * (z + w)), (0.5 * (u - x), 0.5 * (v - y), 0.5 * (w - z))
    size = math.sqrt(dot(middle, middle))
    across = abs(middle[0]) * half[0] + abs(middle[1]) * half[1] + abs(middle[2]) * half[2]
    return size * size - across >= _FLAT * size and size > 0.0
