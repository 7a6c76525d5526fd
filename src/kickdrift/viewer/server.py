"""Servers of viser that only this machine can reach: neither other hosts, nor other sites in one of its browsers."""

import errno
import http
import socket
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from importlib import import_module
from typing import Any

from kickdrift.core.arguments import is_whole
from kickdrift.core.errors import ArgumentError, KickdriftError, missing_extra

ADDRESS = "127.0.0.1"
_NAMES = (ADDRESS, "localhost")  # under which browsers on this machine ask for it
_VISERS = "viser.infra._infra"  # module that starts servers
# Browsers open connections in advance, and a server that stops waits for their requests: for 10 s by default.
_PATIENCE = 3.0  # s
_starting = threading.Lock()


@contextmanager
def local_server(port: int) -> Iterator[Any]:
    """Run a server of viser on the loopback address for as long as a block lasts.

    Parameters
    ----------
    port : int
        0 chooses a free one.

    Yields
    ------
    viser.ViserServer

    Raises
    ------
    ArgumentError
        For a port that does not exist or is in use.
    MissingExtraError
        If viser is not installed.

    Notes
    -----
    The loopback address keeps other machines out, but not other sites that are open in a browser on this one. They can reach
    its servers in two ways: by a domain name of their own that resolves to 127.0.0.1 (DNS rebinding), which is then the
    ``Host`` of the request, and by WebSockets, which browsers open to any server, with the ``Origin`` of the page. Both are
    refused.
    """
    _check_free(port)
    try:
        import rich
        from viser import ViserServer
    except ImportError:
        raise missing_extra("A page for the browser", "viser", "viewer") from None

    class LocalServer(ViserServer):
        """A server that is never shared through viser's public relay."""

        def request_share_url(self, verbose: bool = True) -> str | None:
            return None

    websockets: Any = import_module("websockets.asyncio.server")
    serve, guarded = websockets.serve, []

    def serve_guarded(handler: Any, *arguments: Any, process_request: Any = None, **options: Any) -> Any:
        if handler.__module__ == _VISERS:
            process_request = _guard(process_request)
            guarded.append(handler)
        return serve(handler, *arguments, process_request=process_request, **{"open_timeout": _PATIENCE, **options})

    with _quiet(rich.get_console()), _starting:
        websockets.serve = serve_guarded  # viser has no way to hand it down
        try:
            server = LocalServer(host=ADDRESS, port=port, verbose=False)
        finally:
            websockets.serve = serve
    try:
        if not guarded:
            raise KickdriftError("this version of viser starts its server in another way; install viser 1.1.")
        if port not in (0, server.get_port()):  # taken between the look and the start: viser takes the next one
            raise _taken(port)
        yield server
    finally:
        with _quiet(rich.get_console()):
            server.stop()


def refusal(headers: Any) -> str:
    """Return why a request is refused, by its headers, or an empty string.

    Parameters
    ----------
    headers : websockets.Headers
    """
    hosts, origins = headers.get_all("Host"), headers.get_all("Origin")
    if len(hosts) != 1 or hosts[0].partition(":")[0] not in _NAMES:
        return f"This page is for this machine alone: ask for it under {ADDRESS}."
    if (origins or "Upgrade" in headers) and origins != [f"http://{hosts[0]}"]:
        return "This page is for itself alone: other sites get no answer."
    return ""


def _guard(process_request: Callable[..., Any]) -> Callable[..., Any]:
    """Look at a request before viser does."""

    def process(connection: Any, request: Any) -> Any:
        why = refusal(request.headers)
        return (
            connection.respond(http.HTTPStatus.FORBIDDEN, f"{why}\n") if why else process_request(connection, request)
        )

    return process


def _check_free(port: int) -> None:
    if not is_whole(port, 0, 65535):
        raise ArgumentError(f"port={port!r} must be a whole number from 0 to 65535; 0 chooses a free one.")
    with socket.socket() as probe:
        if sys.platform != "win32":  # where it would bind to one that is taken, instead of one left a moment ago
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((ADDRESS, int(port)))
        except OSError as error:
            if error.errno == errno.EADDRINUSE:
                raise _taken(port) from None
            raise ArgumentError(
                f"port={port!r} cannot be used: {error.strerror}; give another one, or 0 for a free one."
            ) from None


def _taken(port: int) -> ArgumentError:
    return ArgumentError(
        f"port={port!r} is in use by another page or program; close it, or give another port, or 0 for a free one."
    )


@contextmanager
def _quiet(console: Any) -> Iterator[None]:
    """Keep viser from printing its address when it starts, and when it stops."""
    was_quiet, console.quiet = console.quiet, True
    try:
        yield
    finally:
        console.quiet = was_quiet
