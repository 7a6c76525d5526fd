"""``kickdrift list``: the catalogues as tables."""

from kickdrift import methods, systems
from kickdrift.cli.output import show_table
from kickdrift.core.kinds import Kind
from kickdrift.engine.program import evaluations_of
from kickdrift.methods import Method
from kickdrift.scenes import DEFAULTS, Defaults


def list_methods() -> None:
    """Show every method and what it is."""
    columns = ("name", "order", "symmetric", "evaluations", "for", "aliases", "source")
    show_table(columns, [_method_row(method) for method in methods.catalogue().values()])


def _method_row(method: Method) -> list[str]:
    return [
        method.name,
        f"{method.order} {method.generalised_order}" if method.generalised_order else f"{method.order}",
        "yes" if method.symmetric else "no",
        str(evaluations_of(method) or "varies") if method.explicit else "iterated",
        "all but constraints and noise" if method.kind is Kind.FIRST_ORDER else method.kind.value,
        ", ".join(method.aliases) or "-",
        method.source,
    ]


def list_systems() -> None:
    """Show every system with a default start, and how it is run by default."""
    columns = ("name", "state", "time", "duration", "step", "method", "conserved", "exact", "source")
    show_table(columns, [_system_row(name, make()) for name, make in systems.catalogue().items()])


def list_scenes() -> None:
    """Show every scene, and how it is run by default."""
    from kickdrift.scenes.worlds.catalogue import SCENES  # worlds take half a second that the others need not wait

    rows = [[name, f"{scene.duration:g}", f"{scene.step:.4g}", scene.what] for name, scene in SCENES.items()]
    show_table(("name", "duration (s)", "step (s)", "what happens"), rows)


def _system_row(name: str, system: systems.System) -> list[str]:
    defaults = DEFAULTS.get(name, Defaults())
    return [
        name,
        "x".join(str(size) for size in system.x0.shape) or "scalar",
        system.units.get("t", "-"),
        f"{defaults.duration:g}",
        f"{defaults.step:g}",
        defaults.method,
        ", ".join(system.quantities) or "-",
        "no" if system.exact is None else "yes",
        system.source,
    ]
