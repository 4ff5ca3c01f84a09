"""``viewgauge workbench``: a local web page that shows a plan and what changes would do."""

from __future__ import annotations

import logging
import signal
import sys
import threading
import warnings
import webbrowser
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

import viewgauge as vg

from ..exceptions import InputError
from .options import DONE, PartFile, whole_number
from .terminal.reading import read_inspection

__all__ = ["workbench"]


def workbench(
    file: Path,
    /,
    *,
    plan: Path | None = None,
    part: PartFile = None,
    host: str = "127.0.0.1",
    port: Annotated[int, Parameter(converter=whole_number)] = 8080,
    browser: bool = True,
) -> int:
    """Open a local web page with the part, the cameras and the numbers, and see what a change would do.

    Ctrl-C ends it. Only this machine can reach it, unless --host says otherwise; then the printed address holds a token
    without which no visitor is let in.

    Parameters
    ----------
    file
        Read this inspection file (YAML). The page reads no file outside its folder.
    plan
        Begin with the plan in this folder, as viewgauge plan wrote it; by default one is made.
    host
        Bind to this address or name.
    port
        Serve at this port; 0 takes any that is free.
    browser
        Open the page in the browser; --no-browser only prints its address.
    """
    from ..jobs.read_plan import require_plan_of

    try:
        from ..web import open_workbench
    except ImportError as error:
        raise InputError(
            "the workbench needs viser, which is not installed", got=str(error), hint='pip install "viewgauge[web]"'
        ) from None
    inspection = read_inspection(file, part, meanwhile=lambda: vg.plan)
    made = None if plan is None else vg.read_plan(plan)
    if made is not None:
        require_plan_of(made, inspection)
    logging.getLogger("websockets").setLevel(logging.CRITICAL)
    # of what was on its way to a page that has been closed
    warnings.filterwarnings("ignore", message="Queued a .* on a closed connection")
    workbench = open_workbench(file, inspection, made, host=host, port=port)
    print(f"the workbench is at {workbench.address}  (Ctrl-C ends it)", flush=True)
    if browser and sys.stdout.isatty():
        webbrowser.open(workbench.address)
    if threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGTERM, signal.default_int_handler)  # ends as with Ctrl-C, children too
    try:
        threading.Event().wait()
    except KeyboardInterrupt:
        print()
    finally:
        workbench.close()
    return DONE
