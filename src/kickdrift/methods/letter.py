"""The letters of the words of methods: flows, by their names in the engine."""

from enum import Enum

from kickdrift.core.kinds import Kind


class Letter(Enum):
    """A letter of a word: a flow, which advances a part of the dynamics by a share of the step.

    In the spelling of words, K and D are KICK and DRIFT, K* and D* their adjoints, and P and Q CONSTRAIN_POSITIONS and
    CONSTRAIN_VELOCITIES; the others are spelled by their values, such as ``boris-rotate``.

    Attributes
    ----------
    KICK, DRIFT
        Advance v under the acceleration at constant x, and x at constant v.
    ADJOINT_KICK, ADJOINT_DRIFT
        The same with the acceleration at the new v, and the rate of x at the new x: implicit.
    LINEARLY_IMPLICIT_KICK
        A kick that solves one linear system with the derivative of the acceleration with respect to v.
    GRADIENT_KICK
        A kick over a time s with the acceleration a + c s^2 grad |a|^2; c is its parameter.
    DAMP, DAMPED_DRIFT
        The exact decay of v by linear damping, and the exact motion of x and v under it.
    ROTATE, BORIS_ROTATE
        Rotations of v about a magnetic field, by the exact angle and by Boris' formula.
    THERMOSTAT, NOISE
        Friction with the noise that balances it, and noise alone, on v.
    KEPLER
        The exact motion of each body in its Kepler problem.
    ENCOUNTERS
        A step of planets that resolves close encounters; its 20 parameters are those of ``close-encounters``.
    OSCILLATE, FILTERED_KICK
        The exact motion of linear oscillators, and a kick filtered at their frequencies; its parameters are the powers a,
        b, c of the filters phi = sinc^b and psi = sinc^a (2/xi tan(xi/2))^c at xi = h omega (Hairer, Lubich, Wanner,
        Geometric Numerical Integration, section XIII.2, where psi is psi_1).
    SUBSTEPS
        Steps of Stoermer-Verlet under the fast force; their number is its parameter.
    CONSTRAIN_POSITIONS, CONSTRAIN_VELOCITIES
        Projections onto the constraints, and onto their tangent space.
    DOUBLED_KICK, DOUBLED_DRIFT, DOUBLED_BINDING
        The flows of Tao's doubled phase space: of both halves of the Hamiltonian, and of the binding of the copies, whose
        parameter is the constant omega.
    RUNGE_KUTTA, IMPLICIT_RUNGE_KUTTA, STIFF_RUNGE_KUTTA
        A step by a tableau: explicit, implicit, and implicit with an error estimate, for stiff equations.
    EXTRAPOLATION
        Symmetric steps of order 2, extrapolated to a step size of zero; its parameter is how many step sizes are used.

    Notes
    -----
    The letters of a word must together advance all of the dynamics, each part of it by shares that add up to 1:

    - KICK and DRIFT, for accelerations and Hamiltonians; with DAMP, or as KICK and DAMPED_DRIFT, for `kickdrift.Damped`; with
      ROTATE for `kickdrift.ChargedParticle`; with THERMOSTAT for `kickdrift.Langevin`; with CONSTRAIN_POSITIONS, and possibly
      CONSTRAIN_VELOCITIES, for `kickdrift.Constrained`;
    - KICK and KEPLER, or ENCOUNTERS alone, for `kickdrift.systems.planetary`;
    - KICK and OSCILLATE for `kickdrift.Oscillatory`, KICK and SUBSTEPS for `kickdrift.Multirate`;
    - the three DOUBLED letters, for `kickdrift.Hamiltonian`;
    - RUNGE_KUTTA, IMPLICIT_RUNGE_KUTTA, STIFF_RUNGE_KUTTA or EXTRAPOLATION alone, for all equations without constraints and
      noise; NOISE and IMPLICIT_RUNGE_KUTTA for `kickdrift.Langevin`.

    ADJOINT_KICK, LINEARLY_IMPLICIT_KICK, GRADIENT_KICK and FILTERED_KICK count as kicks, ADJOINT_DRIFT as a drift, and
    BORIS_ROTATE as a rotation.

    Examples
    --------
    >>> from kickdrift.methods import Letter
    >>> Letter.KICK.symbol, Letter.DRIFT.symbol
    ('K', 'D')
    """

    KICK = "kick"
    DRIFT = "drift"
    ADJOINT_KICK = "adjoint-kick"
    ADJOINT_DRIFT = "adjoint-drift"
    LINEARLY_IMPLICIT_KICK = "linearly-implicit-kick"
    GRADIENT_KICK = "gradient-kick"
    DAMP = "damp"
    DAMPED_DRIFT = "damped-drift"
    ROTATE = "rotate"
    BORIS_ROTATE = "boris-rotate"
    THERMOSTAT = "thermostat"
    NOISE = "noise"
    KEPLER = "kepler"
    ENCOUNTERS = "encounters"
    OSCILLATE = "oscillate"
    FILTERED_KICK = "filtered-kick"
    SUBSTEPS = "substeps"
    CONSTRAIN_POSITIONS = "constrain-positions"
    CONSTRAIN_VELOCITIES = "constrain-velocities"
    DOUBLED_KICK = "doubled-kick"
    DOUBLED_DRIFT = "doubled-drift"
    DOUBLED_BINDING = "doubled-binding"
    RUNGE_KUTTA = "runge-kutta"
    IMPLICIT_RUNGE_KUTTA = "implicit-runge-kutta"
    STIFF_RUNGE_KUTTA = "stiff-runge-kutta"
    EXTRAPOLATION = "extrapolation"

    @property
    def adjoint(self) -> "Letter | None":
        """The flow whose step of -h inverts a step of h; None if there is no such letter."""
        return _ADJOINTS.get(self, self)

    @property
    def share(self) -> str:
        """The part of the dynamics that it advances, such as ``"kick"`` for all kicks; in a word, its shares add up to 1."""
        return _SHARES.get(self, self.value)

    @property
    def projection(self) -> bool:
        """Whether it projects a state onto its constraints, and leaves one that satisfies them unchanged."""
        return self in (Letter.CONSTRAIN_POSITIONS, Letter.CONSTRAIN_VELOCITIES)

    @property
    def implicit(self) -> bool:
        """Whether it solves an equation that contains the acceleration."""
        return self in (
            Letter.ADJOINT_KICK,
            Letter.ADJOINT_DRIFT,
            Letter.LINEARLY_IMPLICIT_KICK,
            Letter.IMPLICIT_RUNGE_KUTTA,
            Letter.STIFF_RUNGE_KUTTA,
            Letter.EXTRAPOLATION,
        )

    @property
    def plain(self) -> "Letter":
        """The letter that replaces it if accelerations do not depend on v, nor rates of x on x."""
        return _PLAIN.get(self, self)

    @property
    def sweep(self) -> str | None:
        """The flow that replaces it for first-order equations, over their components; None if it changes only v."""
        return None if self.share == "kick" else _SWEEPS.get(self, self.value)

    @property
    def noisy(self) -> bool:
        """Whether it draws random numbers, and so cannot run backwards or be undone."""
        return self in (Letter.THERMOSTAT, Letter.NOISE)

    @property
    def turned(self) -> bool:
        """Whether half of it costs as much as all of it.

        The half at the end of a step and that at the beginning of the next are then done as one.
        """
        return self is Letter.KEPLER

    @property
    def has_tableau(self) -> bool:
        """Whether it is a Runge-Kutta flow."""
        return self in (Letter.RUNGE_KUTTA, Letter.IMPLICIT_RUNGE_KUTTA, Letter.STIFF_RUNGE_KUTTA)

    @property
    def parameters(self) -> int:
        """How many numbers it needs in `Method.parameters`."""
        return _PARAMETERS.get(self, 0)

    @property
    def kind(self) -> Kind:
        """The widest kind of problem for which the flow exists."""
        return _KINDS.get(self, Kind.FIRST_ORDER)

    @property
    def symbol(self) -> str:
        """The symbol in the spelling of words: one or two characters for the most common letters, the value for the others."""
        return _SYMBOLS.get(self, self.value)


_ADJOINTS = {
    Letter.KICK: Letter.ADJOINT_KICK,
    Letter.ADJOINT_KICK: Letter.KICK,
    Letter.DRIFT: Letter.ADJOINT_DRIFT,
    Letter.ADJOINT_DRIFT: Letter.DRIFT,
    Letter.LINEARLY_IMPLICIT_KICK: None,
    Letter.NOISE: None,
    Letter.RUNGE_KUTTA: None,
    Letter.STIFF_RUNGE_KUTTA: None,
    Letter.EXTRAPOLATION: None,
}

_PLAIN = {Letter.ADJOINT_KICK: Letter.KICK, Letter.ADJOINT_DRIFT: Letter.DRIFT}

_SWEEPS = {Letter.DRIFT: "sweep", Letter.ADJOINT_DRIFT: "adjoint-sweep", Letter.EXTRAPOLATION: "extrapolated-sweeps"}

_PARAMETERS = {
    Letter.GRADIENT_KICK: 1,
    Letter.DOUBLED_BINDING: 1,
    Letter.EXTRAPOLATION: 1,
    Letter.SUBSTEPS: 1,
    Letter.ENCOUNTERS: 20,
    Letter.FILTERED_KICK: 3,
}

_SHARES = {
    Letter.ADJOINT_KICK: "kick",
    Letter.LINEARLY_IMPLICIT_KICK: "kick",
    Letter.GRADIENT_KICK: "kick",
    Letter.FILTERED_KICK: "kick",
    Letter.ADJOINT_DRIFT: "drift",
    Letter.BORIS_ROTATE: "rotate",
}

_KINDS = {
    Letter.LINEARLY_IMPLICIT_KICK: Kind.VELOCITY_DEPENDENT,
    Letter.GRADIENT_KICK: Kind.NEWTONIAN,
    Letter.DAMP: Kind.DAMPED,
    Letter.DAMPED_DRIFT: Kind.DAMPED,
    Letter.ROTATE: Kind.CHARGED,
    Letter.BORIS_ROTATE: Kind.CHARGED,
    Letter.THERMOSTAT: Kind.LANGEVIN,
    Letter.NOISE: Kind.LANGEVIN,
    Letter.KEPLER: Kind.NEARLY_KEPLERIAN,
    Letter.ENCOUNTERS: Kind.NEARLY_KEPLERIAN,
    Letter.OSCILLATE: Kind.OSCILLATORY,
    Letter.FILTERED_KICK: Kind.OSCILLATORY,
    Letter.SUBSTEPS: Kind.MULTIRATE,
    Letter.CONSTRAIN_POSITIONS: Kind.CONSTRAINED,
    Letter.CONSTRAIN_VELOCITIES: Kind.CONSTRAINED,
    Letter.DOUBLED_KICK: Kind.HAMILTONIAN,
    Letter.DOUBLED_DRIFT: Kind.HAMILTONIAN,
    Letter.DOUBLED_BINDING: Kind.HAMILTONIAN,
}

_SYMBOLS = {
    Letter.KICK: "K",
    Letter.DRIFT: "D",
    Letter.ADJOINT_KICK: "K*",
    Letter.ADJOINT_DRIFT: "D*",
    Letter.CONSTRAIN_POSITIONS: "P",
    Letter.CONSTRAIN_VELOCITIES: "Q",
}

WHOLES = tuple(
    frozenset(shares)
    for shares in (
        ("kick", "drift"),
        ("kick", "drift", "damp"),
        ("kick", "damped-drift"),
        ("kick", "drift", "rotate"),
        ("kick", "drift", "thermostat"),
        ("kick", "drift", "constrain-positions"),
        ("kick", "drift", "constrain-positions", "constrain-velocities"),
        ("kick", "kepler"),
        ("encounters",),
        ("kick", "oscillate"),
        ("kick", "substeps"),
        ("doubled-kick", "doubled-drift", "doubled-binding"),
        ("runge-kutta",),
        ("implicit-runge-kutta",),
        ("stiff-runge-kutta",),
        ("noise", "implicit-runge-kutta"),
        ("extrapolation",),
    )
)
"""The sets of shares that make up the whole dynamics of some kind of problem."""
