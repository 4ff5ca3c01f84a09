"""A viser server that only answers whom it should.

viser has neither a check of who asks nor a token, and its websocket may be opened by any page in the same browser. What
stands here is put before it:

- the ``Host`` of a request must be one that was asked for, so that a foreign name cannot be made to lead here (DNS
  rebinding), and the ``Origin`` of a websocket must be this page's (RFC 6454);
- where others than this machine can reach the server, the first request must bring a token, which a cookie then holds;
- the page is forbidden to fetch anything from elsewhere (Content Security Policy);
- the tunnel that viser can open to the outside is refused.
"""

from __future__ import annotations

import hmac
import http
import ipaddress
import secrets
import socket
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stdout
from io import StringIO
from typing import Any
from urllib.parse import parse_qs, urlsplit

import viser
import websockets.asyncio.server
from websockets.asyncio.server import ServerConnection
from websockets.datastructures import Headers
from websockets.http11 import Request, Response

from ..exceptions import InputError

__all__ = ["GuardedServer", "is_loopback"]

_ProcessRequest = Callable[[ServerConnection, Request], Response | None]
_MESSAGE_BYTES = 4 * 2**20
"""Largest message from a browser; files come in parts that are smaller."""

_HEADERS = {
    "Content-Security-Policy": (
        "default-src 'self'; script-src 'self' 'unsafe-inline' 'unsafe-eval' blob: data:; style-src 'self' "
        "'unsafe-inline'; img-src 'self' data: blob:; font-src 'self' data:; worker-src 'self' blob: data:; "
        "connect-src 'self' ws: wss: data: blob:; frame-ancestors 'none'; base-uri 'none'; form-action 'none'"
    ),
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
    "Referrer-Policy": "no-referrer",
    "Cache-Control": "no-store",
}


def is_loopback(host: str) -> bool:
    """Whether only this machine can reach a server that is bound to a name or address."""
    if host == "localhost":
        return True
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return False


class Gate:
    """Decides on each request.

    Parameters
    ----------
    host
        What the server is bound to.
    token
        That has to be brought; None for none.
    """

    def __init__(self, host: str, token: str | None) -> None:
        self._token = token
        self._names = {"localhost", "127.0.0.1", "::1", host} if is_loopback(host) else None

    def refusal(self, request: Request) -> Response | None:
        """The answer to one who is not let in; None for one who is."""
        host = _host(request)
        if host is None or (self._names is not None and host[0] not in self._names):
            return _refuse(http.HTTPStatus.MISDIRECTED_REQUEST, "this server does not go by that name")
        upgrade = bool(request.headers.get_all("Upgrade"))
        if upgrade and not self._same_origin(request, host):
            return _refuse(http.HTTPStatus.FORBIDDEN, "pages of another origin are refused")
        if self._token is None or self._known(request):
            return None
        return _refuse(http.HTTPStatus.UNAUTHORIZED, "open the address with the token that viewgauge workbench printed")

    def cookie(self, request: Request) -> str | None:
        """The cookie to give to one who brought the token with the address."""
        if self._token is None or not self._brought(request):
            return None
        return f"{self._cookie_name(request)}={self._token}; HttpOnly; SameSite=Strict; Path=/"

    @staticmethod
    def _same_origin(request: Request, host: tuple[str, int | None]) -> bool:
        origins = request.headers.get_all("Origin")
        if not origins:  # no browser leaves it out
            return True
        try:
            parts = [urlsplit(origin) for origin in origins]
            return all((p.hostname, p.port) == host and p.scheme in ("http", "https") for p in parts)
        except ValueError:
            return False

    def _known(self, request: Request) -> bool:
        return self._brought(request) or any(
            name == self._cookie_name(request) and self._is_token(value) for name, value in _cookies(request)
        )

    def _brought(self, request: Request) -> bool:
        given = parse_qs(urlsplit(request.path).query).get("token", [])
        return len(given) == 1 and self._is_token(given[0])

    def _is_token(self, given: str) -> bool:
        return self._token is not None and hmac.compare_digest(given.encode(), self._token.encode())

    @staticmethod
    def _cookie_name(request: Request) -> str:
        """Cookies are shared by all ports of a machine: each server has its own name."""
        host = _host(request)
        return f"viewgauge-{host[1] if host and host[1] else 80}"


def _host(request: Request) -> tuple[str, int | None] | None:
    """Name and port of the Host header; None where there is not one, or it is none."""
    headers = request.headers.get_all("Host")
    if len(headers) != 1:
        return None
    try:
        parts = urlsplit(f"//{headers[0]}")
        return (parts.hostname, parts.port) if parts.hostname else None
    except ValueError:
        return None


def _cookies(request: Request) -> Iterator[tuple[str, str]]:
    for header in request.headers.get_all("Cookie"):
        for pair in header.split(";"):
            name, _, value = pair.strip().partition("=")
            yield name, value


def _refuse(status: http.HTTPStatus, why: str) -> Response:
    text = f"viewgauge: {why}\n".encode()
    headers = Headers({**_HEADERS, "Content-Type": "text/plain; charset=utf-8", "Content-Length": str(len(text))})
    return Response(status, status.phrase, headers, text)


class GuardedServer(viser.ViserServer):
    """viser's server behind a :class:`Gate`.

    Parameters
    ----------
    host, port
        To bind to; port 0 for any that is free.

    Raises
    ------
    InputError
        If it cannot be bound to.
    """

    def __init__(self, host: str, port: int) -> None:
        self._bound_host = host
        self._token = None if is_loopback(host) else secrets.token_urlsafe(24)
        port = _free_port(host, port)
        with _gated(Gate(host, self._token)), redirect_stdout(StringIO()):  # viser prints what is printed here
            super().__init__(host=host, port=port, verbose=False)

    @property
    def address(self) -> str:
        """What to open in a browser, with the token where there is one."""
        host = self._bound_host
        if host in ("0.0.0.0", "::"):  # any address of this machine will do
            host = socket.gethostname()
        name = f"[{host}]" if ":" in host else host
        query = "" if self._token is None else f"?token={self._token}"
        return f"http://{name}:{self.get_port()}/{query}"

    def stop(self) -> None:
        """End the server and its connections."""
        with redirect_stdout(StringIO()):
            super().stop()

    def request_share_url(self, verbose: bool = True) -> str | None:  # noqa: ARG002 - viser's
        """Nothing goes out."""
        return None


def _free_port(host: str, port: int) -> int:
    """The port, seen to be free; viser would quietly take the next one, or try for ever."""
    try:
        if not 0 <= port <= 65535:
            raise OverflowError("a port is a number from 0 to 65535")
        family, kind, protocol, _, address = socket.getaddrinfo(
            host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE
        )[0]
        with socket.socket(family, kind, protocol) as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            probe.bind(address)
            return int(probe.getsockname()[1])
    except (OSError, OverflowError) as error:
        raise InputError(
            "the workbench cannot be served there",
            key="host, port",
            got=f"{host}:{port} ({error})",
            hint="choose another --port, or --port 0 for any that is free",
        ) from None


_serving = threading.Lock()


@contextmanager
def _gated(gate: Gate) -> Iterator[None]:
    """While a server starts within the block, it is put behind the gate: viser has no place to do so."""
    serve = websockets.asyncio.server.serve

    def gated(*arguments: Any, process_request: _ProcessRequest, **options: Any) -> Any:
        def process(connection: ServerConnection, request: Request) -> Response | None:
            refusal = gate.refusal(request)
            if refusal is not None:
                return refusal
            response = process_request(connection, request)
            if response is not None:
                for name, value in _HEADERS.items():
                    response.headers[name] = value
                cookie = gate.cookie(request)
                if cookie is not None:
                    response.headers["Set-Cookie"] = cookie
            return response

        return serve(*arguments, process_request=process, **{**options, "max_size": _MESSAGE_BYTES})

    with _serving:
        websockets.asyncio.server.serve = gated  # type: ignore[assignment,misc]
        try:
            yield
        finally:
            websockets.asyncio.server.serve = serve  # type: ignore[misc]
