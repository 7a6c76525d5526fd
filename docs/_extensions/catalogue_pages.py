"""Pages that are written from the catalogues whenever the site is built: methods, kinds of problem, systems, scenes."""

import hashlib
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

import kickdrift as kd
from kickdrift.engine.program import evaluations_of
from kickdrift.methods import Kind, Method
from kickdrift.scenes.worlds.catalogue import SCENES
from measured_orders import CASES, orders

_DESCRIPTIONS = {
    Kind.FIRST_ORDER: "FirstOrder", Kind.PARTITIONED: "Partitioned", Kind.HAMILTONIAN: "Hamiltonian",
    Kind.SEPARABLE: "Separable", Kind.VELOCITY_DEPENDENT: "SecondOrder", Kind.NEWTONIAN: "SecondOrder",
    Kind.DAMPED: "Damped", Kind.CHARGED: "ChargedParticle", Kind.NEARLY_KEPLERIAN: "systems.planetary",
    Kind.MULTIRATE: "Multirate", Kind.OSCILLATORY: "Oscillatory", Kind.CONSTRAINED: "Constrained",
    Kind.LANGEVIN: "Langevin",
}  # fmt: skip
# The methods drawn for each kind, and how often the largest step is halved.
_DRAWN = {
    Kind.NEWTONIAN: ("semi-implicit-euler", "velocity-verlet", "forest-ruth-4", "blanes-moan-srkn6b",
                     "blanes-moan-srkn11b", "kahan-li-8", "runge-kutta-4"),
    Kind.SEPARABLE: ("velocity-verlet", "blanes-moan-s6", "blanes-moan-s10", "kahan-li-8", "runge-kutta-4"),
    Kind.HAMILTONIAN: ("implicit-midpoint", "gauss-4", "gauss-6", "tao-2", "tao-4", "dop853"),
    Kind.PARTITIONED: ("semi-implicit-euler", "implicit-verlet", "gauss-4", "gauss-6", "dop853"),
    Kind.FIRST_ORDER: ("composition-diagonal-4", "composition-diagonal-6", "gauss-4", "radau-5", "dop853"),
    Kind.VELOCITY_DEPENDENT: ("semi-implicit-euler", "implicit-verlet", "gauss-4", "gauss-6", "dop853"),
    Kind.DAMPED: ("conformal-verlet", "blanes-moan-conformal-4", "blanes-moan-conformal-6", "implicit-verlet"),
    Kind.CHARGED: ("boris", "he-sun-liu-qin-2", "blanes-moan-gyration-4", "blanes-moan-gyration-6", "dop853"),
    Kind.NEARLY_KEPLERIAN: ("velocity-verlet", "wisdom-holman", "laskar-robutel-saba4", "blanes-aba-1064"),
    Kind.OSCILLATORY: ("velocity-verlet", "deuflhard-2", "mollified-impulse", "grimm-hochbruck-2"),
}  # fmt: skip
_HALVINGS = 7

Table = list[list[str]]


def _table(columns: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [columns, ["---"] * len(columns), *rows]
    return "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in lines)


def _anchor(kind: Kind) -> str:
    return "kind-" + kind.name.lower().replace("_", "-")


def _evaluations(method: Method) -> str:
    return str(evaluations_of(method) or "varies") if method.explicit else "iterated"


def _order(method: Method) -> str:
    return f"{method.order} {method.generalised_order}" if method.generalised_order else str(method.order)


def _method_row(method: Method, measured: float | None) -> list[str]:
    names = ", ".join(f"`{name}`" for name in method.aliases)
    return [
        f"`{method.name}`" + (f" ({names})" if names else ""),
        _order(method),
        "-" if measured is None else f"{measured:.1f}",
        "yes" if method.symmetric else "no",
        _evaluations(method),
        f"`{method.spelling}`<br>{method.source}",  # a column of its own would be as narrow as a word
    ]


def _methods_page(measured: dict[str, float | None]) -> str:
    columns = ("name", "order", "measured", "symmetric", "evaluations a step", "word, source")
    parts = [_METHODS_TEXT.format(count=len(measured))]
    for kind in Kind:
        own = [method for method in kd.methods.catalogue().values() if method.kind is kind]
        if own:
            rows = [_method_row(method, measured[method.name]) for method in own]
            problem = f"Measured on {CASES[kind].formula}.\n\n" if kind in CASES else ""
            title = kind.value[0].upper() + kind.value[1:]
            parts.append(f"({_anchor(kind)}-methods)=\n## {title}\n\n{problem}{_table(columns, rows)}\n")
    return "\n".join(parts)


_METHODS_TEXT = """# Methods

The {count} methods of the catalogue, by the widest kind of problem for which each is made. A method keeps its order on the more
specific kinds, too: for a problem, see the table of [its kind](kinds.md) and those of the wider kinds, which come first.

```{{toctree}}
:hidden:

kinds
systems
```

The argument `method=` of {{obj}}`kickdrift.solve` takes the names in these tables, or their aliases in brackets.

The word lists the flows of a step, first to last, each with its share of the step: `K` is a kick, `D` a drift, and
{{obj}}`kickdrift.methods.Letter` explains the other letters. The measured order is the slope of the error over the step
on the problem named above each table, from the four smallest steps whose errors are above rounding. From order 8 on,
few steps lie between those that are too large and those whose error is mostly rounding, so that the slope is inaccurate
there: the test suite measures these words in extended precision. The order of `shake` is that of its positions and of the
energy, and the measured one that of its velocities, which lack the last impulse of the constraints. For methods for
planets, the numbers in brackets are the orders of the parts of the error that are proportional to the masses of the
planets, to their square, and so on. The corrected methods have the word of `wisdom-holman`, and differ
in a corrector, which transforms the state before the first step, and back wherever it is stored. For Langevin dynamics the
order is that of averages.
"""


def _kinds_page(measured: dict[str, float | None], pictures: dict[Kind, str]) -> str:
    parts = [_KINDS_TEXT]
    for kind in Kind:
        best = [kd.methods.preferred(kind)]
        for order in (2, 4, 6, 8, 10):
            try:
                best.append(kd.methods.preferred(kind, order))
            except kd.MethodMismatchError:
                break
        rows = []
        for number, method in enumerate(best):
            wanted = "any" if number == 0 else f"at least {(2, 4, 6, 8, 10)[number - 1]}"
            rows.append([wanted, f"`{method.name}`", _order(method), _evaluations(method)])
        title = kind.value[0].upper() + kind.value[1:]
        own = any(method.kind is kind for method in measured_methods())
        listed = f"Methods made for it: {{ref}}`the table <{_anchor(kind)}-methods>`. " if own else ""
        parts.append(
            f"({_anchor(kind)})=\n## {title}\n\n"
            f'Described by {{obj}}`kickdrift.{_DESCRIPTIONS[kind]}`. {listed}`method="auto"` selects:\n\n'
            + _table(("order wanted", "method", "its order", "evaluations a step"), rows)
            + "\n"
        )
        if kind in pictures:
            formula = CASES[kind].formula
            parts.append(
                f"```{{figure}} {pictures[kind]}\n:alt: Error at the end over force evaluations and over time\n\n"
                f"{formula[0].upper()}{formula[1:]}: the error at the end over its cost. Times are those of the machine that"
                " built this page.\n```\n"
            )
    return "\n".join(parts)


def measured_methods() -> list[Method]:
    """Return the methods of the catalogue."""
    return list(kd.methods.catalogue().values())


_KINDS_TEXT = """# Kinds of problem

The description of a problem determines its kind, and the kind determines the methods that suit it. A kind includes the more
specific ones indented below it, and a method that has its order on a kind also has it on those:

```text
first-order equations
  partitioned equations
    Hamiltonians
      separable Hamiltonians
        accelerations a(t, x)
          light bodies around a heavy one
          a fast and a slow part
            fast oscillations
    accelerations a(t, x, v)
      accelerations a(t, x) ...
      linear damping
      charges in fields
constraints
Langevin dynamics
```

A method that would lose its order on a problem is refused, and the error names one that keeps it.

Without `order=`, `method="auto"` selects the fastest method for most tolerances. Where that is `dop853`, the energy error
grows with time; with `order=`, the methods below are symmetric. For decay or oscillations much faster than a step, and for
planets with long steps, `auto` selects others, and the report gives the reason.

The folder `benchmarks` of the sources has the same pictures with the other libraries that support each kind.
"""


def _systems_page() -> str:
    rows = []
    for name, make in kd.systems.catalogue().items():
        system = make()
        shape = " x ".join(str(size) for size in system.x0.shape) or "a number"
        conserved = ", ".join(system.quantities) or "-"
        rows.append(
            [f"`{name}`", shape, system.units.get("t", "-"), conserved, "yes" if system.exact else "no", system.source]
        )
    scenes = [
        [f"`{name}`", scene.what, f"{scene.duration:g}", f"{1e3 * scene.step:.3g}"] for name, scene in SCENES.items()
    ]
    columns = ("name", "shape of the state", "unit of time", "conserved", "exact motion known", "source")
    return _SYSTEMS_TEXT.format(
        systems=_table(columns, rows), scenes=_table(("name", "what happens", "duration (s)", "step (ms)"), scenes)
    )


_SYSTEMS_TEXT = """# Systems and scenes

Systems with a default initial state, for `kickdrift run NAME` and {{obj}}`kickdrift.systems.get`:

{systems}

Scenes of rigid bodies and cloth, for `kickdrift run NAME` and `kickdrift view NAME`:

{scenes}
"""


def _draw(folder: Path, store: Path) -> dict[Kind, str]:
    """Draw work and precision of each kind, unless the same was drawn before."""
    folder.mkdir(parents=True, exist_ok=True)
    key = hashlib.sha256(Path(__file__).read_bytes() + store.read_bytes()).hexdigest()[:12]
    names = {kind: f"{kind.name.lower()}-{key}.png" for kind in _DRAWN}
    for old in set(folder.glob("*.png")) - {folder / name for name in names.values()}:
        old.unlink()
    for kind, methods in _DRAWN.items():
        if (folder / names[kind]).exists():
            continue
        case = CASES[kind]
        steps = [0.5 * case.largest / 2**k for k in range(_HALVINGS)]
        start = {"x0": case.x0, "v0": case.v0}
        measured = kd.analysis.work_precision(case.problem, (0.0, 4 * case.end), methods, steps, rounds=15, **start)
        figure = measured.plot()
        figure.suptitle("")
        figure.savefig(folder / names[kind], dpi=110)
    return {kind: f"pictures/{name}" for kind, name in names.items()}


def make_pages(app: Any) -> None:
    """Write the pages into the sources, where they have changed."""
    folder = Path(app.srcdir) / "methods"
    store = Path(app.srcdir) / "_build" / "orders.json"
    measured = orders(store)
    pictures = _draw(folder / "pictures", store)
    pages = {
        "index.md": _methods_page(measured),
        "kinds.md": _kinds_page(measured, pictures),
        "systems.md": _systems_page(),
    }
    for name, text in pages.items():
        path = folder / name
        if not path.exists() or path.read_text() != text:
            path.write_text(text)


def setup(app: Any) -> dict[str, bool]:
    """Let Sphinx make the pages first."""
    app.connect("builder-inited", make_pages, priority=100)
    return {"parallel_read_safe": True}
