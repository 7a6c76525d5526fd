"""Cameras: where the rays of a picture begin, where they go, and where points appear on it."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

_FIELD = math.tan(math.radians(17.0))  # half the height of a perspective picture, at distance 1
_MARGIN = 1.1
_FAR = 50.0  # from the scene, of its extent: where parallel rays begin


class Camera(NamedTuple):
    """A camera that does not move.

    Attributes
    ----------
    eye : (3,) array
        Where it is, m.
    right, up, ahead : (3,) array
        Its axes.
    perspective : bool
        Whether all rays begin at the eye; else they are parallel.
    scale : float
        Half the height of the picture: at distance 1, or, where rays are parallel, anywhere, m.
    """

    eye: Floats
    right: Floats
    up: Floats
    ahead: Floats
    perspective: bool
    scale: float

    def numbers(self) -> Floats:
        """Return what compiled code knows of it."""
        return np.concatenate((self.eye, self.right, self.up, self.ahead, [self.perspective, self.scale]))

    def project(self, points: Floats, width: int, height: int) -> Floats:
        """Return where points (..., 3) appear on a picture of so many pixels, from its upper left, and how far away.

        Returns
        -------
        (..., 3) array
            Column, row, and distance along the camera's axis in m.
        """
        offset = points - self.eye
        right, up, depth = offset @ self.right, offset @ self.up, offset @ self.ahead
        pixels = 0.5 * height / self.scale
        if self.perspective:
            right, up = (along / np.where(depth > 0.0, depth, np.nan) for along in (right, up))
        return np.stack((0.5 * width + pixels * right, 0.5 * height - pixels * up, depth), axis=-1)


def axes_of(ahead: Floats) -> tuple[Floats, Floats, Floats]:
    """Return right, up and ahead for a camera that looks somewhere and is not tilted."""
    ahead = ahead / np.linalg.norm(ahead)
    right = np.cross(ahead, [0.0, 0.0, 1.0] if abs(ahead[2]) < 0.999 else [0.0, 1.0, 0.0])
    right /= np.linalg.norm(right)
    return right, np.cross(right, ahead), ahead


def showing(points: Floats, reaches: Floats, ahead: Floats, aspect: float, *, perspective: bool) -> Camera:
    """Place a camera that looks in a direction, as near as it sees balls whole.

    Parameters
    ----------
    points : (K, 3) array
        Centres of the balls, m.
    reaches : (K,) array
        Their radii, m.
    ahead : (3,) array
        Where it looks.
    aspect : float
        Width of the picture over its height.
    perspective : bool
    """
    axes = axes_of(ahead)
    x, y, z = (points @ axis for axis in axes)
    if not perspective:
        x0, x1, y0, y1 = (x - reaches).min(), (x + reaches).max(), (y - reaches).min(), (y + reaches).max()
        strip = 0.5 * (_MARGIN - 1.0) * max(x1 - x0, y1 - y0)  # below the scene; what is left over is above
        scale = float(max(0.5 * _MARGIN * (x1 - x0) / aspect, 0.5 * (y1 - y0) + strip))
        eye = 0.5 * (x0 + x1), y0 - strip + scale, (z - reaches).min() - _FAR * max(x1 - x0, y1 - y0)
        return Camera(np.array(eye) @ axes, *axes, False, scale)
    # The eye (a, b, c) sees a ball between the left and the right edge of the picture if x - a and a - x are at most
    # t (z - c) - r sqrt(1 + t^2), with the tangent t of half the angle; so both give a bound of a and t c.
    tangents = _FIELD * aspect / _MARGIN, _FIELD / _MARGIN
    places, depths = [], []
    for along, t in zip((x, y), tangents, strict=True):
        width = reaches * math.sqrt(1.0 + t * t) - t * z
        right, left = (width + along).max(), (width - along).max()
        places.append(0.5 * (right - left))
        depths.append(-0.5 * (right + left) / t)
    return Camera(np.array([*places, min(depths)]) @ axes, *axes, True, _FIELD)
