"""The command that writes foreign files in another format."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from .options import DONE, Json
from .output import print_json

__all__ = ["convert"]


def convert(
    file: Path,
    /,
    *,
    output: Annotated[Path, Parameter(name=["--output", "-o"])],
    target: Annotated[str | None, Parameter(name="--as")] = None,
    name: str | None = None,
    model: str | None = None,
    size: str | None = None,
    accept: tuple[str, ...] = (),
    json: Json = False,
) -> int:
    """Write a camera's calibration in the format of another program.

    Parameters
    ----------
    file
        Read this file; its format is recognised by its content.
    output
        Write to this file.
    target
        Write this format: opencv, ros, kalibr or colmap for a camera; by default opencv.
    name
        Take the camera of this name from a file that has several.
    model
        State the lens model that the file does not say: fisheye, radial-tangential or none.
    size
        State the image's columns and rows that the file does not say, such as 1920x1080.
    accept
        Accept the finding of this name; the option may be given several times.
    """
    from ..jobs.conversion.convert import convert as convert_file

    stated = {"name": name, "model": model, "size": size}
    meanings = {key: value for key, value in stated.items() if value is not None}
    done = convert_file(file, output, target, meanings, accept)
    for finding in done.findings:
        print(f"viewgauge: warning: {finding}", file=sys.stderr)
    if json:
        findings = [{"name": finding.name, "message": str(finding)} for finding in done.findings]
        print_json({"source": done.source, "target": done.target, **(done.document or {}), "findings": findings})
    else:
        print(f"{done.source}, written as {done.target} to {output}")
    return DONE
