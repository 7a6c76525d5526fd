"""Bounds of the particles and triangles of cloths that hold as long as pairs remain valid.

Particles are predicted to move at constant velocity, and may deviate from that by the skin. Boxes are in a frame that moves
with the cloths, so that those of a cloth that flies as a whole stay small.
"""

import math

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, cross, dot, minus, plus, times
from kickdrift.world.collision.broad_phase.bvh import BRANCH, ITEM, SKIP, fit_node
from kickdrift.world.columns import vector_at
from kickdrift.world.deformables.layout import (
    BOXES_VELOCITY,
    CLOTH_RADIUS,
    CORNERS,
    CROSSING_COUNT,
    FACE_AREA,
    FIRST_FACE,
    FIRST_NODE,
    FIRST_PARTICLE,
    FRAME_VELOCITY,
    HAS_STRAYED,
    IS_STRAY,
    LAST_FACE,
    LAST_NODE,
    LAST_PARTICLE,
    PARTICLE_VELOCITY,
    PREDICTED_AT,
    PREDICTED_VELOCITY,
    SEARCH_AGE,
    SEARCH_HORIZON,
    SEARCH_STATE,
    SKIN,
    TRAVELLED,
    VALID,
)
from kickdrift.world.deformables.self_collision.face_normals import forget_star
from kickdrift.world.tables import (
    CLOTH,
    CLOTH_NUMBERS,
    CLOTH_SEARCH,
    CLOTH_TREE,
    CLOTH_TREE_NODE,
    FACE,
    FACE_BOUNDS,
    FACE_NORMALS,
    FACE_NUMBERS,
    FACE_TURN,
    NORMAL_TREE,
    PARTICLE,
    PARTICLE_BOUNDS,
    PARTICLE_PATH,
    PARTICLE_SHIFT,
    ZONE,
    floats,
    integers,
    rows,
)

_LATE = 1.0 + 1e-9  # of the horizon, up to which predictions hold, with rounding
_SQUEEZED = 0.6  # of its area at rest: a triangle that is smaller may turn over in its plane
_ANY = 9.0  # half a side of the box of an undetermined normal


@compiled
def set_frame(world: int) -> float:
    """Set the velocity of the frame to the mean of the particles, and return their root mean square speed in it, m/s."""
    particle, search = floats(world, PARTICLE), floats(world, CLOTH_SEARCH)
    total, squares, count = (0.0, 0.0, 0.0), 0.0, rows(world, PARTICLE)
    for i in range(count):
        v = vector_at(particle, i, PARTICLE_VELOCITY)
        total, squares = plus(total, v), squares + dot(v, v)
    mean = times(1.0 / count, total)
    for k in range(3):
        search[0, FRAME_VELOCITY + k] = mean[k]
    return math.sqrt(max(squares / count - dot(mean, mean), 0.0))


@compiled
def travels(world: int, part: float) -> float:
    """Bound the relative displacement of two particles in the drift of a part, m."""
    particle, shift, most = floats(world, PARTICLE), floats(world, PARTICLE_SHIFT), 0.0
    x, y, z = vector_at(floats(world, CLOTH_SEARCH), 0, FRAME_VELOCITY)
    for i in range(rows(world, PARTICLE)):
        u = part * (particle[i, PARTICLE_VELOCITY] - x) + shift[i, 0]
        v = part * (particle[i, PARTICLE_VELOCITY + 1] - y) + shift[i, 1]
        w = part * (particle[i, PARTICLE_VELOCITY + 2] - z) + shift[i, 2]
        most = max(most, u * u + v * v + w * w)
    return 2.0 * math.sqrt(most)


@compiled
def find_strays(world: int, part: float) -> int:
    """Mark the particles that are off their predicted paths by more than the skin, now or after the drift of a part, s.

    Returns their number: that of all, where predictions are over.
    """
    search, particle, path = floats(world, CLOTH_SEARCH), floats(world, PARTICLE), floats(world, PARTICLE_PATH)
    own, numbers, shift = integers(world, CLOTH), floats(world, CLOTH_NUMBERS), floats(world, PARTICLE_SHIFT)
    zone, age, count = integers(world, ZONE), search[0, SEARCH_AGE], 0
    if age + part > _LATE * search[0, SEARCH_HORIZON]:
        return _all_stray(world)
    for cloth in range(rows(world, CLOTH)):
        farthest = numbers[cloth, SKIN] ** 2
        for i in range(own[cloth, FIRST_PARTICLE], own[cloth, LAST_PARTICLE]):
            now, then, since = 0.0, 0.0, age - path[i, PREDICTED_AT]
            for k in range(3):
                off = particle[i, k] - path[i, k] - since * path[i, PREDICTED_VELOCITY + k]
                strays = (
                    off + part * (particle[i, PARTICLE_VELOCITY + k] - path[i, PREDICTED_VELOCITY + k]) + shift[i, k]
                )
                now, then = now + off * off, then + strays * strays
            zone[i, IS_STRAY] = int(not (now <= farthest and then <= farthest))  # true for NaN
            count += zone[i, IS_STRAY]
    return count


@compiled
def _all_stray(world: int) -> int:
    """Mark all particles, and return their number."""
    zone, count = integers(world, ZONE), rows(world, PARTICLE)
    for i in range(count):
        zone[i, IS_STRAY] = 1
    return count


@compiled
def start_search(world: int, h: float) -> None:
    """Begin a search of all pairs, which will be valid for a time h, s."""
    search, path = floats(world, CLOTH_SEARCH), floats(world, PARTICLE_PATH)
    age = search[0, SEARCH_AGE]
    for k in range(3):
        search[0, BOXES_VELOCITY + k] = search[0, FRAME_VELOCITY + k]
    search[0, SEARCH_HORIZON], search[0, SEARCH_AGE], search[0, TRAVELLED] = h, 0.0, 0.0
    for i in range(_all_stray(world)):
        path[i, PREDICTED_AT] = path[i, PREDICTED_AT] - age if search[0, SEARCH_STATE] == VALID else 0.0


@compiled
def sweep(world: int, part: float) -> None:
    """Predict the motion of stray particles up to the horizon, and update the boxes of particles, triangles and trees."""
    numbers = floats(world, CLOTH_NUMBERS)
    for cloth in range(rows(world, CLOTH)):
        _sweep_particles(world, cloth, part, numbers[cloth, CLOTH_RADIUS] + numbers[cloth, SKIN])
        _enclose_strays(world, cloth)


@compiled
def _enclose_strays(world: int, cloth: int) -> None:
    """Update the boxes of the triangles of a cloth with stray corners, and of its trees."""
    own = integers(world, CLOTH)
    for f in range(own[cloth, FIRST_FACE], own[cloth, LAST_FACE]):
        if has_strayed(world, f):
            _enclose(world, f)
            _enclose_normal(world, f)
            forget_star(world, f)
    _fit_strays(world, own[cloth, FIRST_NODE], own[cloth, LAST_NODE])


@compiled
def _fit_strays(world: int, first: int, last: int) -> None:
    """Mark the nodes of a tree that contain stray particles, and set their boxes, bottom up."""
    mark, boxes, turns = integers(world, CLOTH_TREE_NODE), floats(world, FACE_BOUNDS), floats(world, FACE_NORMALS)
    tree, normals = floats(world, CLOTH_TREE)[first:last], floats(world, NORMAL_TREE)[first:last]
    for node in range(last - first - 1, -1, -1):
        item, strayed = int(tree[node, ITEM]), 0
        if item >= 0:
            strayed = int(has_strayed(world, item))
        else:
            child, count = node + 1, 2 if item == BRANCH else int(tree[node, SKIP]) - node - 1
            for _ in range(count):
                strayed |= mark[first + child, HAS_STRAYED]
                child = int(tree[child, SKIP])
        mark[first + node, HAS_STRAYED] = strayed
        if strayed != 0:
            fit_node(tree, node, boxes)
            fit_node(normals, node, turns)


@compiled(inline=True)
def has_strayed(world: int, f: int) -> bool:
    """Whether a corner of a triangle is stray."""
    face, zone = integers(world, FACE), integers(world, ZONE)
    a, b, c = face[f, CORNERS], face[f, CORNERS + 1], face[f, CORNERS + 2]
    strayed: bool = (zone[a, IS_STRAY] | zone[b, IS_STRAY] | zone[c, IS_STRAY]) != 0
    return strayed


@compiled
def _sweep_particles(world: int, cloth: int, part: float, around: float) -> None:
    """Predict the motion of the stray particles of a cloth, and write their boxes, enlarged by `around`, m.

    The predicted velocity is the mean since the last prediction, including the velocities and shifts of this part, s.
    """
    own, particle, age = integers(world, CLOTH), floats(world, PARTICLE), floats(world, CLOTH_SEARCH)[0, SEARCH_AGE]
    path, shift, zone = floats(world, PARTICLE_PATH), floats(world, PARTICLE_SHIFT), integers(world, ZONE)
    for i in range(own[cloth, FIRST_PARTICLE], own[cloth, LAST_PARTICLE]):
        if zone[i, IS_STRAY] == 0:
            continue
        since = age - path[i, PREDICTED_AT]
        path[i, PREDICTED_AT] = age
        for k in range(3):
            x = particle[i, k]
            way = part * particle[i, PARTICLE_VELOCITY + k] + shift[i, k]
            v = (way + x - path[i, k]) / (part + since) if since > 0.0 else way / part
            path[i, k], path[i, PREDICTED_VELOCITY + k] = x, v
        _enclose_path(world, i, around)


@compiled(inline=True)
def _enclose_path(world: int, i: int, around: float) -> None:
    """Write the box of the predicted motion of a particle, enlarged by `around`, m."""
    bounds, path, search = floats(world, PARTICLE_BOUNDS), floats(world, PARTICLE_PATH), floats(world, CLOTH_SEARCH)
    age, left = path[i, PREDICTED_AT], search[0, SEARCH_HORIZON] - path[i, PREDICTED_AT]
    for k in range(3):
        drift = search[0, BOXES_VELOCITY + k]
        way, x = left * (path[i, PREDICTED_VELOCITY + k] - drift), path[i, k] - age * drift
        bounds[i, k], bounds[i, 3 + k] = x + min(way, 0.0) - around, x + max(way, 0.0) + around


@compiled
def restore_boxes(world: int) -> None:
    """Update the boxes of all particles, triangles and trees, given the predicted motion; nothing is tangled."""
    own, numbers, zone = integers(world, CLOTH), floats(world, CLOTH_NUMBERS), integers(world, ZONE)
    for i in range(_all_stray(world)):
        zone[i, CROSSING_COUNT] = 0
    for cloth in range(rows(world, CLOTH)):
        for i in range(own[cloth, FIRST_PARTICLE], own[cloth, LAST_PARTICLE]):
            _enclose_path(world, i, numbers[cloth, CLOTH_RADIUS] + numbers[cloth, SKIN])
        _enclose_strays(world, cloth)
    floats(world, CLOTH_SEARCH)[0, SEARCH_STATE] = VALID


@compiled(inline=True)
def predicted(world: int, i: int, age: float) -> Vector:
    """Return the predicted position of a particle at an age of the search, s."""
    path = floats(world, PARTICLE_PATH)
    return plus(vector_at(path, i, 0), times(age - path[i, PREDICTED_AT], vector_at(path, i, PREDICTED_VELOCITY)))


@compiled(inline=True)
def _enclose(world: int, f: int) -> None:
    """Write the box of a triangle from those of its corners."""
    face, bounds, box = integers(world, FACE), floats(world, PARTICLE_BOUNDS), floats(world, FACE_BOUNDS)
    a, b, c = face[f, CORNERS], face[f, CORNERS + 1], face[f, CORNERS + 2]
    for k in range(3):
        box[f, k] = min(bounds[a, k], bounds[b, k], bounds[c, k])
        box[f, 3 + k] = max(bounds[a, 3 + k], bounds[b, 3 + k], bounds[c, 3 + k])


@compiled
def _enclose_normal(world: int, f: int) -> None:
    """Write the unit normal of a triangle, at its last prediction and for the horizon, and a box around both.

    The normal of a squeezed triangle is undetermined, since it may turn over in its plane.
    """
    face, path = integers(world, FACE), floats(world, PARTICLE_PATH)
    a, b, c = face[f, CORNERS], face[f, CORNERS + 1], face[f, CORNERS + 2]
    age = max(path[a, PREDICTED_AT], path[b, PREDICTED_AT], path[c, PREDICTED_AT])
    now, then = _normal(world, f, age), _normal(world, f, floats(world, CLOTH_SEARCH)[0, SEARCH_HORIZON])
    now_size, then_size = math.sqrt(dot(now, now)), math.sqrt(dot(then, then))
    known = min(now_size, then_size) > _SQUEEZED * 2.0 * floats(world, FACE_NUMBERS)[f, FACE_AREA]
    box, turn = floats(world, FACE_NORMALS), floats(world, FACE_TURN)
    for k in range(3):
        one, other = now[k] / now_size, then[k] / then_size
        turn[f, k], turn[f, 3 + k] = (one, other) if known else (0.0, 0.0)
        box[f, k] = min(one, other) if known else -_ANY
        box[f, 3 + k] = max(one, other) if known else _ANY


@compiled(inline=True)
def _normal(world: int, f: int, age: float) -> Vector:
    """Return the predicted normal of a triangle at an age of the search, s, times twice its area."""
    face = integers(world, FACE)
    origin = predicted(world, face[f, CORNERS], age)
    p = minus(predicted(world, face[f, CORNERS + 1], age), origin)
    return cross(p, minus(predicted(world, face[f, CORNERS + 2], age), origin))
