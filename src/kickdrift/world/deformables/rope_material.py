"""Material parameters of ropes."""

from dataclasses import dataclass

from kickdrift.world.deformables.material import check_numbers

_POSITIVE = ("radius", "density", "stretch_stiffness")
_UNITS = {
    "radius": "m", "density": "kg/m", "stretch_stiffness": "N", "bending_stiffness": "N m^2", "damping": "s",
    "linear_damping": "1/s", "friction": "1", "tether_strain": "1",
}  # fmt: skip


@dataclass(frozen=True)
class RopeMaterial:
    """The material parameters of a rope: the options of `World.add_rope`.

    Attributes
    ----------
    radius : float
        m.
    density : float
        Mass per length, kg/m.
    stretch_stiffness : float
        Tension per strain, E A, N. The rope resists compression, too, and buckles under it.
    bending_stiffness : float
        Moment per curvature, E I, N m^2. A rope is straight at rest, whatever its initial shape, and twists freely.
    damping : float
        Retardation time of strain and curvature, s. If the step is too long for it, it is reduced, and the message of a
        recording reports that.
    linear_damping : float
        Rate at which velocities decay, 1/s.
    friction : float
        Coefficient of friction; a rope and what it touches use the geometric mean.
    tether_strain : float
        Strain at which tethers hold vertices back, zero if there are none; see `kickdrift.world.deformables.fabric.Fabric`.

    Raises
    ------
    ArgumentError
        For invalid numbers, and for numbers outside the supported range.
    """

    radius: float = 0.01
    density: float = 0.1
    stretch_stiffness: float = 1000.0
    bending_stiffness: float = 1e-3
    damping: float = 0.0
    linear_damping: float = 0.0
    friction: float = 0.6
    tether_strain: float = 0.0

    def __post_init__(self) -> None:
        check_numbers(self, _UNITS, _POSITIVE)
