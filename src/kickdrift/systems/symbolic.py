"""Equations of motion from formulas: gradients, common subexpressions and code by SymPy."""

import math
from collections.abc import Mapping, Sequence
from functools import partial
from types import FunctionType
from typing import Any

from kickdrift.core.arguments import real
from kickdrift.core.errors import ArgumentError, missing_extra
from kickdrift.systems.hamiltonian import Hamiltonian, Separable
from kickdrift.systems.mass_matrix import refuse_start
from kickdrift.systems.problem import AT_START, OF_SHAPE
from kickdrift.systems.second_order import SecondOrder

_OWN = "kickdrift:"  # prefix of the names of the code's own symbols, which no user's symbol has


def from_sympy(
    hamiltonian: Any, q: Any, p: Any, *, t: Any = None, constants: Mapping[Any, float] | None = None
) -> Separable | Hamiltonian:
    """Derive Hamilton's equations from a formula for the energy.

    Parameters
    ----------
    hamiltonian : sympy expression
        H(q, p), or H(q, p, t).
    q, p : symbol or sequence of symbols
        Coordinates and momenta, in their order in x0 and v0; for a single symbol states are scalars. Functions of time, such
        as SymPy's dynamic symbols, are accepted.
    t : symbol, optional
        The symbol of time, if H depends on it.
    constants : mapping of symbol or str to float, optional
        Values of all other symbols. Other values do not recompile anything.

    Returns
    -------
    Separable or Hamiltonian
        Separable where it can be shown that H = T(p) + V(q).

    Raises
    ------
    ArgumentError
        For symbols without values, and for functions that cannot be written in Python.
    MissingExtraError
        Without the package sympy.

    Examples
    --------
    >>> import sympy as sp, kickdrift as kd
    >>> q, p, g = sp.symbols("q p g")
    >>> pendulum = kd.from_sympy(p**2 / 2 - g * sp.cos(q), q, p, constants={g: 9.81})
    >>> type(pendulum).__name__
    'Separable'
    """
    formulas = _Formulas((("q", q), ("p", p)), t, constants, "kd.from_sympy")
    energy = formulas.expression("hamiltonian", hamiltonian)
    dq, dp = formulas.gradient(energy, "q"), formulas.gradient(energy, "p")
    whole = formulas.function("energy", "qp", [energy], scalar=True)
    if formulas.are_zero(part.diff(symbol) for part in dq for symbol in formulas.symbols["p"]):
        kinetic, potential = (
            formulas.function("kinetic_gradient", "p", dp),
            formulas.function("potential_gradient", "q", dq),
        )
        return Separable(kinetic, potential, whole)
    return Hamiltonian(formulas.function("dHdq", "qp", dq), formulas.function("dHdp", "qp", dp), whole)


def from_lagrangian(
    lagrangian: Any, q: Any = None, qdot: Any = None, *, t: Any = None, constants: Mapping[Any, float] | None = None
) -> SecondOrder:
    """Derive the accelerations from a Lagrangian, by the Euler-Lagrange equations.

    Parameters
    ----------
    lagrangian : sympy expression or sympy.physics.mechanics.LagrangesMethod
        L(q, q'), or L(q, q', t). A LagrangesMethod has its own coordinates, velocities and applied forces.
    q, qdot : symbol or sequence of symbols
        Coordinates and velocities, in their order in x0 and v0.
    t, constants
        As for `from_sympy`.

    Returns
    -------
    SecondOrder
        With the energy, the sum of q' dL/dq' less L.

    Raises
    ------
    ArgumentError
        For whatever `from_sympy` refuses, for a kinetic energy that is not positive definite, and for constraints. Where it
        depends on the state, `kickdrift.solve` refuses starts at which it is not.
    MissingExtraError
        Without the package sympy.

    Examples
    --------
    >>> import sympy as sp, kickdrift as kd
    >>> r, a, rdot, adot = sp.symbols("r a rdot adot")
    >>> L = (rdot**2 + (r * adot) ** 2) / 2 + 1 / r
    >>> orbit = kd.from_lagrangian(L, (r, a), (rdot, adot))
    >>> sol = kd.solve(
    ...     orbit, (0.0, 6.0), [1, 0], [0, 1], step=0.01, method="gauss-4", compile=False
    ... )
    >>> bool(abs(sol.x[:, 0] - 1.0).max() < 1e-9)
    True
    """
    sympy = _sympy("kd.from_lagrangian")
    forces = None
    if hasattr(lagrangian, "form_lagranges_equations"):
        lagrangian, q, qdot, t, forces = _taken_apart(lagrangian, q, qdot, sympy)
    formulas = _Formulas((("x", q), ("v", qdot)), t, constants, "kd.from_lagrangian")
    energy = formulas.expression("lagrangian", lagrangian)
    momenta, x, v = formulas.gradient(energy, "v"), formulas.symbols["x"], formulas.symbols["v"]
    mass = [[momentum.diff(symbol) for symbol in v] for momentum in momenta]
    push = formulas.gradient(energy, "x")
    for i, momentum in enumerate(momenta):
        carried = sum((momentum.diff(x[j]) * v[j] for j in range(len(x))), start=momentum.diff(formulas.t))
        push[i] = push[i] - carried + (0 if forces is None else formulas.expression("forces", forces[i]))
    minors = (sympy.Matrix(mass)[:size, :size].det(method="berkowitz") for size in range(1, len(x) + 1))
    for minor in minors:
        if formulas.are_zero([minor]):
            raise ArgumentError(
                "lagrangian has a kinetic energy that is not positive definite in its velocities, so that it does not"
                " determine the accelerations. Leave out the coordinates without mass, or give their masses."
            )
        if formulas.is_never_positive(minor):
            raise ArgumentError(
                "lagrangian has a kinetic energy that is not positive definite in its velocities: some masses are"
                " negative. Check its signs, and those of constants."
            )
    total = sum(momentum * symbol for momentum, symbol in zip(momenta, v, strict=True)) - energy
    acceleration = formulas.solution("acceleration", mass, push)
    lower = [mass[i][j] for i in range(len(x)) for j in range(i + 1)]
    vars(acceleration)[AT_START] = partial(refuse_start, formulas.function("mass", "xv", lower), len(x))
    return SecondOrder(acceleration, formulas.function("energy", "xv", [total], scalar=True))


class _Formulas:
    """Formulas in the symbols of a state, and the functions written of them.

    Attributes
    ----------
    symbols : dict
        Of each half of the state by its name, the symbols that the code has for its numbers.
    t : symbol
    """

    def __init__(
        self, halves: Sequence[tuple[str, Any]], t: Any, constants: Mapping[Any, float] | None, caller: str
    ) -> None:
        self._sympy = sympy = _sympy(caller)
        self.t, self.symbols = sympy.Symbol(f"{_OWN}t", real=True), dict[str, list[Any]]()
        self._replaced: dict[Any, Any] = {}
        self._scalar = not isinstance(halves[0][1], Sequence | sympy.MatrixBase | sympy.Tuple)
        for name, given in halves:
            members = [given] if self._scalar else list(given)
            self.symbols[name] = [
                sympy.Symbol(f"{_OWN}{name}" if self._scalar else f"{_OWN}{name}[{k}]", real=True)
                for k in range(len(members))
            ]
            self._replaced |= dict(zip(members, self.symbols[name], strict=True))
        first, second = self.symbols.values()
        if len(first) != len(second) or len(self._replaced) != 2 * len(first) or not first:
            raise ArgumentError(
                f"{halves[0][1]!r} and {halves[1][1]!r} must have the same number of symbols, all different."
            )
        if t is not None:
            self._replaced[t] = self.t
        self._numbers: dict[str, float] = {}
        for k, (symbol, value) in enumerate((constants or {}).items()):
            own = sympy.Symbol(f"{_OWN}constant{k}", real=True)
            self._replaced[sympy.Symbol(symbol) if isinstance(symbol, str) else symbol] = own
            self._numbers[f"constant{k}"] = _number(symbol, value)

    def expression(self, argument: str, given: Any) -> Any:
        """Return a formula in the symbols of the code; derivatives are replaced first, since they contain their variables."""
        sympy, formula = self._sympy, self._sympy.sympify(given)
        names = {symbol.name: own for symbol, own in self._replaced.items() if isinstance(symbol, sympy.Symbol)}
        for symbol in sorted(self._replaced, key=lambda symbol: not isinstance(symbol, sympy.Derivative)):
            formula = formula.subs(symbol, self._replaced[symbol])
        # Symbols of one name and other assumptions are others to SymPy, and the same to whoever wrote them.
        formula = formula.subs({s: names[s.name] for s in formula.free_symbols if s.name in names})
        known = {self.t, *(s for half in self.symbols.values() for s in half), *map(self._own, self._numbers)}
        unknown = sorted(map(str, formula.free_symbols - known))
        if unknown:
            raise ArgumentError(
                f"{argument} has symbols without values: {', '.join(unknown)}. Pass them as constants={{{unknown[0]}:"
                " 1.0}, or time as t=... ."
            )
        return formula

    def _own(self, name: str) -> Any:
        return self._sympy.Symbol(f"{_OWN}{name}", real=True)

    def gradient(self, formula: Any, half: str) -> list[Any]:
        """Return the derivatives by the numbers of one half of the state."""
        return [formula.diff(symbol) for symbol in self.symbols[half]]

    def are_zero(self, formulas: Any) -> bool:
        """Return whether all of these can be shown to be zero."""
        return all(formula == 0 or self._sympy.simplify(formula) == 0 for formula in formulas)

    def is_never_positive(self, formula: Any) -> bool:
        """Return whether a formula, with the numbers of its constants, is seen at once not to be positive."""
        return formula.subs({self._own(name): number for name, number in self._numbers.items()}).is_positive is False

    def function(self, name: str, halves: str, formulas: list[Any], *, scalar: bool = False) -> FunctionType:
        """Write a function of halves of the state; it writes into `out` where it returns more than a number."""
        lines, parts = self._lines(formulas)
        if scalar or self._scalar:
            return self._defined(name, halves, formulas, [*lines, f"return {parts[0]}"])
        return self._defined(
            name, f"{halves}o", formulas, [*lines, *(f"out[{k}] = {part}" for k, part in enumerate(parts))]
        )

    def solution(self, name: str, matrix: list[list[Any]], right: list[Any]) -> FunctionType:
        """Write a function that solves a symmetric positive system, L D L' without loops, n^3 / 6 products."""
        size, lower = len(right), [(i, j) for i in range(len(right)) for j in range(i + 1)]
        formulas = [*(matrix[i][j] for i, j in lower), *right]
        lines, parts = self._lines(formulas)
        lines += [f"m{i}_{j} = {part}" for (i, j), part in zip(lower, parts, strict=False)]
        for i in range(size):
            for j in range(i + 1):
                known = "".join(f" - l{i}_{k} * l{j}_{k} * d{k}" for k in range(j))
                lines.append(f"d{i} = m{i}_{i}{known}" if i == j else f"l{i}_{j} = (m{i}_{j}{known}) / d{j}")
            done = "".join(f" - l{i}_{k} * y{k}" for k in range(i))
            lines.append(f"y{i} = {parts[len(lower) + i]}{done}")
        for i in reversed(range(size)):
            done = "".join(f" - l{k}_{i} * a{k}" for k in range(i + 1, size))
            lines.append(f"a{i} = y{i} / d{i}{done}")
        if self._scalar:
            return self._defined(name, "xv", formulas, [*lines, "return a0"])
        return self._defined(name, "xvo", formulas, [*lines, *(f"out[{i}] = a{i}" for i in range(size))])

    def _lines(self, formulas: list[Any]) -> tuple[list[str], list[str]]:
        """Return the source of common subexpressions, and of the formulas that use them."""
        common, rest = self._sympy.cse(formulas, symbols=self._sympy.numbered_symbols("common"))
        return [f"{symbol} = {self._spelt(part)}" for symbol, part in common], [self._spelt(part) for part in rest]

    def _spelt(self, formula: Any) -> str:
        try:
            text: str = self._sympy.pycode(formula, fully_qualified_modules=True, strict=True)
        except NotImplementedError:
            raise ArgumentError(f"{formula} has functions that cannot be written in Python; replace them.") from None
        return f"({text})".replace(_OWN, "")

    def _defined(self, name: str, halves: str, formulas: list[Any], lines: list[str]) -> FunctionType:
        """Define a function, whose arguments declare what it depends on."""
        used = set().union(*(formula.free_symbols for formula in formulas))
        arguments = [half for half in halves if half != "o" and (used & set(self.symbols[half]) or name == "energy")]
        arguments = arguments or [halves[0]]
        arguments += ["t"] * (self.t in used) + ["out"] * halves.endswith("o")
        scope: dict[str, Any] = {"math": math, "__name__": __name__, **self._numbers}
        exec(f"def {name}({', '.join(arguments)}):\n    " + "\n    ".join(lines), scope)  # noqa: S102 - our own text, above
        function: FunctionType = scope[name]
        vars(function)[OF_SHAPE] = () if self._scalar else (len(self.symbols[halves[0]]),)
        return function


def _number(symbol: Any, value: Any) -> float:
    try:
        number = real(value)
    except TypeError:
        number = math.nan
    if not math.isfinite(number):
        raise ArgumentError(f"constants[{symbol}]={value!r} must be a finite number.")
    return number


def _taken_apart(equations: Any, q: Any, qdot: Any, sympy: Any) -> tuple[Any, Any, Any, Any, Any]:
    """Return Lagrangian, coordinates, velocities, time and applied forces of a LagrangesMethod."""
    if q is not None or qdot is not None:
        raise ArgumentError("q and qdot are given, but a LagrangesMethod brings its own; leave them out.")
    if equations.coneqs:
        raise ArgumentError(
            "lagrangian has constraints, which accelerations alone do not enforce; describe them with"
            " kd.Constrained(force, constraint)."
        )
    time = sympy.physics.mechanics.dynamicsymbols._t
    equations.form_lagranges_equations()
    lagrangian, coordinates, velocities = equations._L[0], list(equations.q), list(equations.u)
    zero = dict.fromkeys([*(u.diff(time) for u in velocities)], 0)
    applied = equations.eom.subs(zero)
    free = sympy.physics.mechanics.LagrangesMethod(lagrangian, coordinates)
    free.form_lagranges_equations()
    return lagrangian, coordinates, velocities, time, list(free.eom.subs(zero) - applied)


def _sympy(caller: str) -> Any:
    try:
        import sympy
        import sympy.physics.mechanics
    except ImportError:
        raise missing_extra(caller, "sympy", "sympy") from None
    return sympy
