"""The table: a case for each kind of problem, kickdrift's methods for it, and the peers that can do it."""

import math

import kickdrift as kd
from benchmarks.precision import described, problems
from benchmarks.precision.case import Case, Contestant
from benchmarks.precision.libraries import diffrax, diffrax_langevin, heyoka, scipy_dop853
from benchmarks.precision.symplectic_libraries import (
    desolver,
    pyhamsys,
    pyhamsys_extended,
    rebound,
    symplecta,
    symplecta_constrained,
    symplecta_general,
)
from kickdrift.core.kinds import Kind

_ANY_EQUATIONS = (
    Contestant("heyoka Taylor", heyoka, limit=2.3e-16, count=5),
    Contestant("diffrax Tsit5", diffrax("Tsit5"), limit=1e-12),
    Contestant("diffrax Dopri8", diffrax("Dopri8"), limit=1e-12),
    Contestant("SciPy DOP853", scipy_dop853, limit=1e-12, count=3),
)
# Python is called for each evaluation by these: their most evaluations take some tenths of a second.
_BABS9O7H = Contestant("desolver BABs9o7H", desolver("BABs9o7HSolver"), 19, 5e4, 3)
_MIDPOINT = Contestant("symplecta implicit_midpoint", symplecta_general("implicit_midpoint"), 8, 2e4, 3)
_RATTLE = symplecta_constrained(
    "rattle", problems.off_sphere_array, problems.off_sphere_jacobian_array, problems.falling_array
)
_PLANETS = kd.systems.outer_solar_system()
_MASSES = tuple(_PLANETS.params[2:8].tolist())  # times G
_FRICTION, _TEMPERATURE = 1.0, 0.5
_WELL = (problems.double_well_array, _FRICTION, _TEMPERATURE)
_QUICSORT = diffrax_langevin("QUICSORT", "SpaceTimeTimeLevyArea", 2, *_WELL)
_ALIGN = diffrax_langevin("ALIGN", "SpaceTimeLevyArea", 1, *_WELL)
_GAUSS = ("gauss-4", "gauss-6", "gauss-8")


def every_case() -> list[Case]:
    """Make all cases."""
    return [*_of_accelerations(), *_of_hamiltonians(), *_of_first_order(), *_of_special_forces()]


def _taken_by_auto(kind: Kind) -> tuple[str, ...]:
    return tuple(kd.methods.preferred(kind, order).name for order in (2, 4, 6, 8, 10))


def _of_accelerations() -> list[Case]:
    words = _taken_by_auto(Kind.NEWTONIAN)
    return [
        Case(
            name="newtonian",
            title="Hénon-Heiles, T = 1000",
            kind=Kind.NEWTONIAN,
            law=problems.henon_heiles,
            span=1000.0,
            x0=(0.1, 0.0),
            v0=(0.0, 0.5),
            problem=described.newtonian(problems.henon_heiles),
            methods=words,
            peers=(
                Contestant("pyhamsys RKN4b", pyhamsys("RKN4b"), 12, 1.5e5, 3),
                Contestant("pyhamsys RKN6b", pyhamsys("RKN6b"), 22, 1.5e5, 3),
                Contestant("symplecta yoshida6", symplecta("yoshida6"), 7, 5e4, 3),
                _BABS9O7H,
                *_ANY_EQUATIONS,
            ),
            energy=problems.henon_heiles_energy,
            evaluations=(6e3, 6e5),
        ),
        Case(
            name="kepler",
            title="Kepler, e = 0.6, 100 periods",
            kind=Kind.NEWTONIAN,
            law=problems.kepler,
            span=200 * math.pi,
            x0=(0.4, 0.0),
            v0=(0.0, 2.0),
            problem=described.newtonian(problems.kepler),
            methods=words,
            peers=(
                Contestant("REBOUND leapfrog", rebound("leapfrog"), 1),
                Contestant("REBOUND leapfrog 8", rebound("leapfrog", 17, order=8), 17, count=5),
                Contestant("REBOUND IAS15", rebound("ias15", 0), limit=1e-9),
                *_ANY_EQUATIONS,
            ),
            evaluations=(3e4, 3e6),
            end=(0.4, 0.0, 0.0, 2.0),
        ),
        Case(
            name="velocity-dependent",
            title="van der Pol, T = 100",
            kind=Kind.VELOCITY_DEPENDENT,
            law=problems.van_der_pol,
            span=100.0,
            x0=(2.0,),
            v0=(0.0,),
            problem=described.velocity_dependent(problems.van_der_pol),
            methods=("implicit-verlet", *_GAUSS, "dop853"),
            peers=_ANY_EQUATIONS,
        ),
    ]


def _of_hamiltonians() -> list[Case]:
    return [
        Case(
            name="separable",
            title="relativistic oscillator in an anharmonic well, T = 1000",
            kind=Kind.SEPARABLE,
            law=problems.relativistic,
            span=1000.0,
            x0=(1.0,),
            v0=(0.0,),
            problem=described.separable(problems.relativistic),
            methods=_taken_by_auto(Kind.SEPARABLE),
            peers=(
                Contestant("pyhamsys BM4", pyhamsys("BM4"), 12, 1.5e5, 3),
                Contestant("pyhamsys BM6", pyhamsys("BM6"), 20, 1.5e5, 3),
                _MIDPOINT,
                _BABS9O7H,
                *_ANY_EQUATIONS,
            ),
            energy=problems.relativistic_energy,
            evaluations=(6e3, 6e5),
        ),
        Case(
            name="hamiltonian",
            title="H = (q² + 1)(p² + 1)/2, T = 200",
            kind=Kind.HAMILTONIAN,
            law=problems.tao,
            span=200.0,
            x0=(-3.0,),
            v0=(0.0,),
            problem=described.hamiltonian(problems.tao),
            methods=(*_GAUSS, "tao-4", "dop853"),
            peers=(
                Contestant("pyhamsys extended BM4", pyhamsys_extended("BM4"), 24, 5e4, 3),
                _MIDPOINT,
                *_ANY_EQUATIONS,
            ),
            energy=problems.tao_energy,
            evaluations=(1e4, 5e5),
        ),
        Case(
            name="nearly-keplerian",
            title="outer Solar System, 200,000 days",
            kind=Kind.NEARLY_KEPLERIAN,
            law=problems.gravity(_MASSES),
            span=200_000.0,
            x0=tuple(_PLANETS.x0.ravel().tolist()),
            v0=tuple(_PLANETS.v0.ravel().tolist()),
            problem=_PLANETS,
            methods=("wisdom-holman", "wisdom-holman-corrected-11", "blanes-aba-1064", "blanes-moan-srkn11b"),
            peers=(
                Contestant("REBOUND WHFast", rebound("whfast", safe_mode=0), 1),
                Contestant("REBOUND WHFast 11", rebound("whfast", safe_mode=0, corrector=11), 1),
                Contestant("REBOUND SABA(10,6,4)", rebound("saba", 8, safe_mode=0), 8),
                Contestant("REBOUND IAS15", rebound("ias15", 0), limit=1e-9),
                *_ANY_EQUATIONS[::3],
            ),
            energy=problems.gravity_energy(_MASSES),
            evaluations=(1e3, 5e4),
            masses=_MASSES,
        ),
    ]


def _of_first_order() -> list[Case]:
    return [
        Case(
            name="partitioned",
            title="Lotka-Volterra, T = 100",
            kind=Kind.PARTITIONED,
            law=problems.predator_and_prey,
            span=100.0,
            x0=(0.5,),
            v0=(1.0,),
            problem=described.partitioned(problems.predator_and_prey),
            methods=("implicit-verlet", *_GAUSS, "dop853"),
            peers=_ANY_EQUATIONS,
        ),
        Case(
            name="first-order",
            title="Lorenz, T = 10",
            kind=Kind.FIRST_ORDER,
            law=problems.lorenz,
            span=10.0,
            x0=(1.0, 1.0, 1.0),
            v0=(),
            problem=described.first_order(problems.lorenz),
            methods=(*_GAUSS, "composition-diagonal-8", "dop853"),
            peers=_ANY_EQUATIONS,
        ),
    ]


def _of_special_forces() -> list[Case]:
    return [
        Case(
            name="charged",
            title="a magnetic field that grows outwards, T = 200",
            kind=Kind.CHARGED,
            law=problems.magnetic,
            span=200.0,
            x0=(0.0, -1.0, 0.0),
            v0=(0.1, 0.01, 0.0),
            problem=kd.ChargedParticle(1.0, problems.magnetic_field, problems.electric_field),
            methods=("boris", "blanes-moan-gyration-4", "blanes-moan-gyration-6", "gauss-6"),
            peers=_ANY_EQUATIONS,
        ),
        Case(
            name="damped",
            title="driven pendulum, T = 100",
            kind=Kind.DAMPED,
            law=problems.damped_pendulum,
            span=100.0,
            x0=(0.5,),
            v0=(0.0,),
            problem=kd.Damped(problems.driven, damping=0.1),
            methods=("conformal-verlet", "blanes-moan-conformal-4", "blanes-moan-conformal-6", "gauss-6"),
            peers=_ANY_EQUATIONS,
        ),
        *_of_fast_and_slow_forces(),
        Case(
            name="constrained",
            title="spherical pendulum, T = 100",
            kind=Kind.CONSTRAINED,
            law=problems.spherical_pendulum,
            span=100.0,
            x0=(1.0, 0.0, 0.0),
            v0=(0.0, 0.8, 0.0),
            problem=kd.Constrained(problems.falling, problems.off_sphere, jacobian=problems.off_sphere_jacobian),
            methods=("rattle",),
            peers=(Contestant("symplecta rattle", _RATTLE, 2, 1e4, 3), *_ANY_EQUATIONS),
            near=1e-4,
        ),
        Case(
            name="langevin",
            title="2000 particles in a double well, T = 200, mean of x²",
            kind=Kind.LANGEVIN,
            span=200.0,
            x0=(1.0,) * 2000,
            v0=(0.0,) * 2000,
            problem=kd.Langevin(problems.double_well, friction=_FRICTION, temperature=_TEMPERATURE, seed=1),
            methods=("baoab", "aboba", "obabo"),
            peers=(Contestant("diffrax QUICSORT", _QUICSORT, 2), Contestant("diffrax ALIGN", _ALIGN, 1)),
            average=(problems.mean_square, problems.mean_square_in_double_well(_TEMPERATURE)),
            evaluations=(600, 3e3),
            near=3e-3,
        ),
    ]


def _of_fast_and_slow_forces() -> list[Case]:
    shared = {
        "law": problems.stiff_spring,
        "span": 200.0,
        "x0": (1.0, 1 / problems.STIFF),
        "v0": (0.0, 1.0),
        "peers": _ANY_EQUATIONS,
        "energy": problems.stiff_spring_energy,
    }
    return [
        Case(
            name="oscillatory",
            title="one stiff spring, T = 200",
            kind=Kind.OSCILLATORY,
            problem=kd.Oscillatory(problems.soft_springs, omega=[0.0, problems.STIFF]),
            methods=("deuflhard-2", "mollified-impulse", "grimm-hochbruck-2", "velocity-verlet", "blanes-moan-srkn11b"),
            **shared,
        ),
        Case(
            name="multirate",
            title="one stiff spring, its force evaluated more often, T = 200",
            kind=Kind.MULTIRATE,
            problem=kd.Multirate(slow_force=problems.soft_springs, fast_force=problems.stiff_part),
            methods=("respa-2", "velocity-verlet", "blanes-moan-srkn11b"),
            **shared,
        ),
    ]
