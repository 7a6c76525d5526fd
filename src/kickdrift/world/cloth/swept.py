"""Where the particles and triangles of cloths may be for as long as pairs are not sought anew.

All is in a frame that moves with the cloths, so that what flies as a whole stays in small boxes.
"""

import math

from kickdrift.core.compilation import compiled
from kickdrift.core.vectors import Vector, cross, dot, minus, plus, times
from kickdrift.world.cloth.layout import (
    CLOTH_RADIUS,
    CORNERS,
    FIRST_FACE,
    FIRST_NODE,
    FIRST_PARTICLE,
    FRAME_VELOCITY,
    IS_CONNECTED,
    LAST_FACE,
    LAST_NODE,
    LAST_PARTICLE,
    LOOKS,
    NODE_LOOKS,
    PARTICLE_VELOCITY,
    REACH,
    SEARCH_AGE,
)
from kickdrift.world.collision.bvh import BRANCH, ITEM, SKIP, TWIG, fit
from kickdrift.world.columns import vector_at
from kickdrift.world.tables import (
    CLOTH,
    CLOTH_NUMBERS,
    CLOTH_SEARCH,
    CLOTH_TREE,
    CLOTH_TREE_NODE,
    FACE,
    FACE_BOUNDS,
    FACE_SIDES,
    PARTICLE,
    PARTICLE_BOUNDS,
    PARTICLE_SHIFT,
    floats,
    integers,
    rows,
)

_STEEP = 0.7  # cosine of the angle between a normal and a direction that it looks into, at least
# Directions, each with its opposite: of the axes, of the diagonals of a cube's sides and of the cube
_AXES = (
    (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0),
    (0.70710678, 0.70710678, 0.0), (0.70710678, -0.70710678, 0.0), (0.70710678, 0.0, 0.70710678),
    (0.70710678, 0.0, -0.70710678), (0.0, 0.70710678, 0.70710678), (0.0, 0.70710678, -0.70710678),
    (0.57735027, 0.57735027, 0.57735027), (0.57735027, 0.57735027, -0.57735027),
    (0.57735027, -0.57735027, 0.57735027), (0.57735027, -0.57735027, -0.57735027),
)  # fmt: skip


@compiled
def set_frame(world: int) -> None:
    """Let the frame move as the particles do on average."""
    particle, search = floats(world, PARTICLE), floats(world, CLOTH_SEARCH)
    total, count = (0.0, 0.0, 0.0), rows(world, PARTICLE)
    for i in range(count):
        total = plus(total, vector_at(particle, i, PARTICLE_VELOCITY))
    for k in range(3):
        search[0, FRAME_VELOCITY + k] = total[k] / count
    search[0, SEARCH_AGE] = 0.0


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
        _sweep_particles(world, cloth, h, 2.0 * numbers[cloth, CLOTH_RADIUS])
        for f in range(own[cloth, FIRST_FACE], own[cloth, LAST_FACE]):
            _enclose(world, f)
            _look(world, f, h)
        _fit(world, own[cloth, FIRST_NODE], own[cloth, LAST_NODE])


@compiled
def _sweep_particles(world: int, cloth: int, h: float, margin: float) -> None:
    own, particle, bounds = integers(world, CLOTH), floats(world, PARTICLE), floats(world, PARTICLE_BOUNDS)
    frame = vector_at(floats(world, CLOTH_SEARCH), 0, FRAME_VELOCITY)
    for i in range(own[cloth, FIRST_PARTICLE], own[cloth, LAST_PARTICLE]):
        way = times(h, minus(vector_at(particle, i, PARTICLE_VELOCITY), frame))
        for k in range(3):
            bounds[i, k] = particle[i, k] + min(way[k], 0.0) - margin
            bounds[i, 3 + k] = particle[i, k] + max(way[k], 0.0) + margin
        bounds[i, REACH] = math.sqrt(dot(way, way)) + 0.5 * margin


@compiled(inline=True)
def _enclose(world: int, f: int) -> None:
    face, bounds, box = integers(world, FACE), floats(world, PARTICLE_BOUNDS), floats(world, FACE_BOUNDS)
    a, b, c = face[f, CORNERS], face[f, CORNERS + 1], face[f, CORNERS + 2]
    for k in range(3):
        box[f, k] = min(bounds[a, k], bounds[b, k], bounds[c, k])
        box[f, 3 + k] = max(bounds[a, 3 + k], bounds[b, 3 + k], bounds[c, 3 + k])


@compiled
def _look(world: int, f: int, h: float) -> None:
    """Note the directions that the normal of a triangle looks into now, and still will after the time h."""
    face, particle = integers(world, FACE), floats(world, PARTICLE)
    origin, motion = vector_at(particle, face[f, CORNERS], 0), vector_at(particle, face[f, CORNERS], PARTICLE_VELOCITY)
    b, c = face[f, CORNERS + 1], face[f, CORNERS + 2]
    p, q = minus(vector_at(particle, b, 0), origin), minus(vector_at(particle, c, 0), origin)
    u, v = (
        minus(vector_at(particle, b, PARTICLE_VELOCITY), motion),
        minus(vector_at(particle, c, PARTICLE_VELOCITY), motion),
    )
    now, then = cross(p, q), cross(plus(p, times(h, u)), plus(q, times(h, v)))
    integers(world, FACE_SIDES)[f, LOOKS] = _directions(now) & _directions(then)


@compiled(inline=True)
def _directions(normal: Vector) -> int:
    """Return the set of directions that a vector looks into; none for zero."""
    least, found = _STEEP * math.sqrt(dot(normal, normal)), 0
    for k in range(len(_AXES)):
        along = dot(_AXES[k], normal)
        found |= int(along > least) << (2 * k) | int(-along > least) << (2 * k + 1)
    return found


@compiled
def _fit(world: int, first: int, last: int) -> None:
    """Draw the boxes of a tree, and find the directions that all normals below a node look into."""
    nodes, own = floats(world, CLOTH_TREE)[first:last], integers(world, CLOTH_TREE_NODE)[first:last]
    faces = integers(world, FACE_SIDES)
    fit(nodes, floats(world, FACE_BOUNDS))
    for node in range(len(nodes) - 1, -1, -1):
        item = nodes[node, ITEM]
        if item == BRANCH:
            found = own[node + 1, NODE_LOOKS] & own[int(nodes[node + 1, SKIP]), NODE_LOOKS]
        elif item == TWIG:
            found = own[node + 1, NODE_LOOKS]
            for leaf in range(node + 2, int(nodes[node, SKIP])):
                found &= own[leaf, NODE_LOOKS]
        else:
            found = faces[int(item), LOOKS]
        own[node, NODE_LOOKS] = found * own[node, IS_CONNECTED]
