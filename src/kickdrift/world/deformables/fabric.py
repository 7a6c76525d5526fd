"""Material parameters of cloths."""

from dataclasses import dataclass

from kickdrift.world.deformables.material import check_numbers

_POSITIVE = ("density", "thickness", "stretch_stiffness")
_UNITS = {
    "density": "kg/m^2", "thickness": "m", "stretch_stiffness": "N/m", "shear_stiffness": "N/m", "bending_stiffness": "N m",
    "damping": "s", "linear_damping": "1/s", "friction": "1", "drag": "1", "lift": "1", "air_density": "kg/m^3",
    "tear_strain": "1", "tether_strain": "1",
}  # fmt: skip


@dataclass(frozen=True)
class Fabric:
    """The material parameters of a cloth: the options of `World.add_cloth`.

    Attributes
    ----------
    density : float
        Mass per area, kg/m^2.
    thickness : float
        m; vertices and triangles keep a distance of half of it from solid shapes, vertices alone from meshes and height fields.
    stretch_stiffness, shear_stiffness : float
        Tension per strain along warp and weft, and shear force per shear angle, both per metre of width: N/m.
    bending_stiffness : float
        Moment per curvature, per metre of width: N m.
    damping : float
        Retardation time of a Kelvin-Voigt solid, s: forces are those of the strains plus this time multiplied by the strain
        rates. If the step is too long for it, it is reduced, and the message of a recording reports that.
    linear_damping : float
        Rate at which velocities decay, 1/s.
    friction : float
        Coefficient of friction; a cloth and a shape in contact use the geometric mean.
    drag, lift : float
        Coefficients C of the forces on a triangle of area A and unit normal n in a relative wind of speed s and direction d:
        ``C air_density A s^2 / 2`` times ``|n . d| d`` (drag) and ``(n . d) (n - (n . d) d)`` (lift). A plate perpendicular to
        the wind has a drag coefficient of about 1.2.
    air_density : float
        kg/m^3.
    tear_strain : float
        Largest principal strain, averaged over the triangles around a vertex, above which the cloth tears there; zero if it
        does not tear. At a strain of 1 the length has doubled.
    tether_strain : float
        Strain at which tethers hold vertices back, zero if there are none. A vertex is then no farther from the nearest one
        that is pinned in the world, or to a fixed or kinematic body, than the way along the unstretched mesh times one plus
        this strain; with a small one a stiff cloth hardly stretches, however long the step is. Tethers stop vertices, and
        dynamic bodies to which these are pinned, without bounce; contacts may push vertices farther.

    Raises
    ------
    ArgumentError
        For invalid numbers, and for numbers outside the supported range.
    """

    density: float = 0.2
    thickness: float = 0.005
    stretch_stiffness: float = 200.0
    shear_stiffness: float = 40.0
    bending_stiffness: float = 1e-5
    damping: float = 0.0
    linear_damping: float = 0.0
    friction: float = 0.6
    drag: float = 0.0
    lift: float = 0.0
    air_density: float = 1.2
    tear_strain: float = 0.0
    tether_strain: float = 0.0

    def __post_init__(self) -> None:
        check_numbers(self, _UNITS, _POSITIVE)
