"""viewgauge workbench, as a user calls it."""

from __future__ import annotations

import os
import re
import signal
import socket
import subprocess
import sys
import urllib.error
import urllib.request

import pytest
from box_inspection import refused, write

from inspections import box_part, entry

pytest.importorskip("viser")

from viewgauge.cli import main

pytestmark = pytest.mark.usefixtures("folder")


def test_a_missing_inspection_is_reported(capsys):
    assert "does not exist" in refused(capsys, "workbench", "nowhere.yaml")


def test_a_missing_plan_is_reported(capsys):
    assert "nowhere" in refused(capsys, "workbench", "inspection.yaml", "--plan", "nowhere")


def test_the_plan_of_another_inspection_is_reported(capsys):
    assert main(["plan", "inspection.yaml", "-o", "plan", "--no-refine", "--no-prove"]) == 0
    capsys.readouterr()
    write(part=box_part(entry("other", "[0, 0, 40]", "[80, 0, 40]")))
    assert "the plan was made from other files" in refused(capsys, "workbench", "inspection.yaml", "--plan", "plan")


def test_a_port_that_is_taken_is_reported(capsys):
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = str(taken.getsockname()[1])
        assert "--port 0" in refused(capsys, "workbench", "inspection.yaml", "--port", port)


@pytest.mark.parametrize("port", ["70000", "-1", "1.5", "http"])
def test_what_is_no_port_is_reported(capsys, port):
    assert main(["workbench", "inspection.yaml", "--port", port]) == 2
    assert "Traceback" not in capsys.readouterr().err


def test_without_viser_it_says_what_to_install(capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "viser", None)
    for name in [name for name in sys.modules if name.startswith("viewgauge.web")]:
        monkeypatch.delitem(sys.modules, name)
    assert 'pip install "viewgauge[web]"' in refused(capsys, "workbench", "inspection.yaml")


@pytest.mark.skipif(os.name != "posix", reason="signals are POSIX only")
@pytest.mark.parametrize(("host", "end"), [("127.0.0.1", signal.SIGINT), ("0.0.0.0", signal.SIGTERM)])
def test_it_serves_until_it_is_ended(host, end):
    """By the address that is printed; that of a host which others can reach has a token in it."""
    code = (
        "import signal, sys\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"  # a test run in the background ignores it
        "from viewgauge.cli import main\n"
        "sys.exit(main(sys.argv[1:]))"
    )
    running = subprocess.Popen(
        [sys.executable, "-c", code, "workbench", "inspection.yaml", "--port", "0", "--host", host, "--no-browser"],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        address = None
        for line in running.stdout:
            if found := re.search(r"the workbench is at (http://\S+)", line):
                address = found[1]
                break
        assert address is not None
        opened = address if host == "127.0.0.1" else re.sub(r"//[^:/]+:", "//127.0.0.1:", address)
        with urllib.request.urlopen(opened, timeout=120) as page:
            assert page.status == 200
        if host == "0.0.0.0":
            with pytest.raises(urllib.error.HTTPError, match="401"):
                urllib.request.urlopen(opened.split("?")[0], timeout=120)
        running.send_signal(end)
        _, err = running.communicate(timeout=300)
    finally:
        running.kill()
    assert running.returncode == 0
    assert "Traceback" not in err
