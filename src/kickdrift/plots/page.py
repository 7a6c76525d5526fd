"""How every picture looks: size, type, colours, and how it is written to a file.

Figures are made without pyplot: nothing global changes, no window opens, and threads may draw.
"""

from functools import cache
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any

from kickdrift.core.errors import ArgumentError, FileFormatError, missing_extra
from kickdrift.core.files import path_of, written

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

INK, FAINT = "#222222", "#888888"
_DPI, _DPI_IN_NOTEBOOKS = 200, 90


@cache
def _shown(figure: type["Figure"]) -> type["Figure"]:
    """Return the class of figures that show themselves in notebooks, also where pyplot was never imported."""

    class ShownFigure(figure):  # type: ignore[valid-type, misc]
        def _repr_png_(self) -> bytes:
            content = BytesIO()
            self.savefig(content, format="png", dpi=_DPI_IN_NOTEBOOKS)
            return content.getvalue()

    return ShownFigure


def new_figure(width: float, height: float, title: str) -> "Figure":
    """Make an empty page, in inches, with a title at its upper left.

    Raises
    ------
    MissingExtraError
        If matplotlib is not installed.
    """
    try:
        from matplotlib.figure import Figure
    except ImportError:
        raise missing_extra("Drawing", "matplotlib", "cli") from None
    figure = _shown(Figure)(figsize=(width, height), layout="constrained")
    figure.get_layout_engine().set(w_pad=0.08, h_pad=0.08, wspace=0.04)  # type: ignore[union-attr, call-arg]
    figure.suptitle(title, x=0.015, ha="left", fontsize=11.5, color=INK)
    return figure


def one_panel(width: float, height: float, title: str, ax: "Axes | None") -> tuple["Figure", "Axes"]:
    """Return the axes given, with their figure, or make a page with one panel.

    Raises
    ------
    ArgumentError
        If ax is not an Axes.
    MissingExtraError
        If matplotlib is not installed.
    """
    if ax is None:
        figure = new_figure(width, height, title)
        return figure, figure.add_subplot()
    check_axes(ax)
    return ax.figure.figure, ax  # the whole figure, also if that is in a part of one


def check_axes(ax: Any) -> None:
    """Refuse anything but an Axes of matplotlib, such as the array that ``pyplot.subplots`` returns for several.

    Raises
    ------
    ArgumentError
    """
    from matplotlib.axes import Axes

    if not isinstance(ax, Axes):
        raise ArgumentError(f"ax={ax!r} is not a matplotlib Axes; give one, as in figure, ax = plt.subplots().")


def dress(axes: "Axes", x: str, y: str, title: str = "") -> None:
    """Label a panel, and remove the empty sides of its frame."""
    axes.set_xlabel(x, color=INK)
    axes.set_ylabel(y, color=INK)
    axes.set_title(title, loc="left", fontsize=10, color=INK)
    axes.spines[["top", "right"]].set_visible(False)
    axes.spines[["left", "bottom"]].set_color(FAINT)
    axes.tick_params(color=FAINT, labelcolor=INK, labelsize=9)
    axes.grid(color="#e6e6e6", linewidth=0.6)
    axes.set_axisbelow(True)
    axes.locator_params(axis="x", nbins=7)


def label(name: str, unit: str | None) -> str:
    """Name of an axis with its unit, if it has one."""
    return f"{name} ({unit})" if unit else name


def keep(figure: "Figure", path: str | Path | None) -> "Figure":
    """Write a figure to a file, if there is a path; the file extension determines the format.

    Raises
    ------
    ArgumentError
        If that is not a path.
    FileFormatError
        If the file cannot be written there, or its extension is not a format of matplotlib.
    """
    if path is not None:
        target = path_of(path, "picture.png")
        try:
            with written(target) as partial:
                figure.savefig(partial, dpi=_DPI)
        except OSError as error:
            raise FileFormatError(_unwritable(path, error.strerror or error, "choose another folder.")) from None
        except ValueError as error:
            raise FileFormatError(_unwritable(path, error, "use a name that ends in .png, .pdf or .svg.")) from None
    return figure


def _unwritable(path: Any, reason: Any, remedy: str) -> str:
    return f"path={str(path)!r} cannot be written: {reason}; {remedy}"
