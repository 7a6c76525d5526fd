"""What recordings and worlds need of the floors above: functions that draw, show and store them."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import Any, Protocol, Self

from numpy.typing import NDArray

from kickdrift.engine.presented import Presenters


class Page(Protocol):
    """A page in the browser on which a world runs."""

    url: str

    def wait(self) -> None:
        """Wait until Ctrl-C, which closes the page, or until it is closed elsewhere."""
        ...

    def close(self) -> None:
        """Stop the world and the server; an error that ended the page earlier is raised."""
        ...

    def __enter__(self) -> Self: ...

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, where: TracebackType | None
    ) -> None: ...


@dataclass(frozen=True)
class WorldPresenters(Presenters):
    """Functions of higher layers that recordings and worlds call; the package sets them when it is imported."""

    animate: Callable[..., Path]
    world_html: Callable[..., str]
    save_meshes: Callable[..., Path]
    view: Callable[..., Page]
    save_world: Callable[..., Path]
    contents: Callable[..., tuple[dict[str, Any], dict[str, NDArray[Any]]]]
    snapshot_of: Callable[..., Any]
