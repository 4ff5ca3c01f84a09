"""Whom the workbench lets in: seen from the network, with requests as browsers and others send them."""

from __future__ import annotations

import http.client
import socket

import pytest

pytest.importorskip("viser")

from websockets.datastructures import Headers
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from viewgauge.exceptions import InputError
from viewgauge.web.guard import Gate, GuardedServer, is_loopback

PROTOCOL = "viser-v"


@pytest.fixture(scope="module")
def local():
    server = GuardedServer("127.0.0.1", 0)
    yield server
    server.stop()


@pytest.fixture(scope="module")
def open_to_all():
    """Bound to all addresses of this machine, but asked for by that of the loopback alone."""
    server = GuardedServer("0.0.0.0", 0)  # bound for the test, asked for on the loopback alone
    yield server
    server.stop()


def get(server, path="/", **headers):
    connection = http.client.HTTPConnection("127.0.0.1", server.get_port(), timeout=60)
    connection.request("GET", path, headers={key.replace("_", "-"): value for key, value in headers.items()})
    response = connection.getresponse()
    body = response.read()
    connection.close()
    return response, body


def socket_status(server, **headers):
    """The status with which a websocket is refused; None where it is opened."""
    port = server.get_port()
    origin = headers.pop("Origin", f"http://127.0.0.1:{port}")
    try:
        with connect(f"ws://127.0.0.1:{port}/", origin=origin, additional_headers=headers, open_timeout=60, proxy=None):
            return None
    except InvalidStatus as refused:
        return refused.response.status_code


def token_of(server):
    return server.address.split("token=")[1]


def test_the_page_is_served_and_may_fetch_nothing_from_elsewhere(local):
    response, body = get(local)
    assert response.status == 200
    assert b"<html" in body.lower()
    policy = response.getheader("Content-Security-Policy")
    assert policy.startswith("default-src 'self';")
    assert "http:" not in policy
    assert "https:" not in policy
    assert response.getheader("X-Frame-Options") == "DENY"
    assert local.address == f"http://127.0.0.1:{local.get_port()}/"


@pytest.mark.parametrize("host", ["evil.example", "evil.example:80", "127.0.0.1.evil.example", ""])
def test_another_name_of_this_server_is_refused(local, host):
    """DNS rebinding: a foreign name that leads to 127.0.0.1."""
    response, _ = get(local, Host=host)
    assert response.status == 421
    assert socket_status(local, Host=host) == 421  # the client sends its own Host as well: two are refused too


@pytest.mark.parametrize("host", ["localhost", "127.0.0.1"])
def test_its_own_names_are_not(local, host):
    response, _ = get(local, Host=f"{host}:{local.get_port()}")
    assert response.status == 200


@pytest.mark.parametrize("origin", ["http://evil.example", "null", "http://127.0.0.1:1", "file://", "http://localhost"])
def test_a_page_from_elsewhere_cannot_open_the_socket(local, origin):
    assert socket_status(local, Origin=origin) == 403


def test_its_own_page_can(local):
    assert socket_status(local) is None


@pytest.mark.parametrize(
    "path",
    [
        "/../../../../etc/passwd",
        "/%2e%2e/%2e%2e/%2e%2e/etc/passwd",
        "/..%5c..%5cetc/passwd",
        "//etc/passwd",
        "/inspection.yaml",
    ],
)
def test_no_path_reaches_a_file(local, path):
    response, body = get(local, path)
    assert response.status == 404
    assert b"root:" not in body


def test_who_is_reachable_from_elsewhere_asks_for_a_token(open_to_all):
    for path in ("/", "/?token=", "/?token=wrong", "/?token=wrong&token=" + token_of(open_to_all)):
        response, body = get(open_to_all, path)
        assert response.status == 401
        assert b"<html" not in body.lower()
    assert socket_status(open_to_all) == 401
    assert socket_status(open_to_all, Cookie=f"viewgauge-{open_to_all.get_port()}=wrong") == 401


def test_the_token_lets_in_and_is_kept_in_a_cookie_that_scripts_cannot_read(open_to_all):
    response, body = get(open_to_all, f"/?token={token_of(open_to_all)}")
    assert response.status == 200
    assert b"<html" in body.lower()
    cookie = response.getheader("Set-Cookie")
    assert "HttpOnly" in cookie
    assert "SameSite=Strict" in cookie
    kept = cookie.split(";")[0]
    assert get(open_to_all, Cookie=kept)[0].status == 200
    assert socket_status(open_to_all, Cookie=f"other=1; {kept}") is None


def test_tokens_are_long_and_new_each_time(open_to_all):
    assert len(token_of(open_to_all)) >= 32
    other = GuardedServer("0.0.0.0", 0)
    try:
        assert token_of(other) != token_of(open_to_all)
    finally:
        other.stop()


def test_nothing_goes_out_by_a_tunnel(local):
    assert local.request_share_url() is None


def test_a_port_that_is_taken_is_said(local):
    with pytest.raises(InputError, match=r"--port 0"):
        GuardedServer("127.0.0.1", local.get_port())


@pytest.mark.parametrize(("host", "port"), [("no.such.host.invalid", 0), ("127.0.0.1", 70000), ("203.0.113.7", 0)])
def test_a_place_that_cannot_be_bound_to_is_said(host, port):
    with pytest.raises(InputError, match="cannot be served there"):
        GuardedServer(host, port)


@pytest.mark.parametrize(
    ("host", "only_this_machine"),
    [
        ("127.0.0.1", True),
        ("localhost", True),
        ("::1", True),
        ("127.3.2.1", True),
        ("0.0.0.0", False),
        ("10.0.0.3", False),
        ("example.org", False),
    ],
)
def test_which_hosts_others_can_reach(host, only_this_machine):
    assert is_loopback(host) is only_this_machine


def test_the_port_is_only_on_the_loopback(local):
    """Nobody listens on this machine's other addresses."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.connect(("192.0.2.1", 9))  # sends nothing: tells which address would be used
            address = probe.getsockname()[0]
        except OSError:
            pytest.skip("this machine has no other address")
    if address.startswith("127."):
        pytest.skip("this machine has no other address")
    with socket.socket() as other:
        other.settimeout(2)
        assert other.connect_ex((address, local.get_port())) != 0


def test_a_gate_without_a_token_gives_no_cookie():
    class Request:
        path, headers = "/?token=x", Headers(Host="127.0.0.1:8080")

    assert Gate("127.0.0.1", None).cookie(Request()) is None
