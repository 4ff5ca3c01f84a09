"""The command that writes foreign files in another format."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from .options import DONE, Json
from .terminal.output import print_json
from .terminal.reading import print_findings

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
    kind: Annotated[str | None, Parameter(name="--from")] = None,
    unit: str | None = None,
    angle: str | None = None,
    rotation: str | None = None,
    quaternion: str | None = None,
    inverse: Annotated[bool, Parameter(negative="")] = False,
    accept: tuple[str, ...] = (),
    json: Json = False,
) -> int:
    """Write a camera's calibration or a robot's poses in another format.

    Parameters
    ----------
    file
        Read this file; its format is recognised by its content.
    output
        Write to this file.
    target
        Write this format: opencv, ros, kalibr or colmap for a camera, by default opencv; viewpoints for poses.
    name
        Take the camera of this name from a file that has several.
    model
        State the lens model that the file does not say: fisheye, radial-tangential or none.
    size
        State the image's columns and rows that the file does not say, such as 1920x1080.
    kind
        Read the poses as this format, such as ur: it is asked for where the columns have names of several makers.
    unit
        State the unit of lengths that the file does not say: mm, cm, m or inch.
    angle
        State the unit of angles that the file does not say: deg or rad.
    rotation
        State what three angles mean: rotation-vector, fixed-xyz (roll, pitch, yaw), turning-zyx or other axes.
    quaternion
        State the order of quaternions whose parts have no names: wxyz or xyzw.
    inverse
        Write the inverse of each pose.
    accept
        Accept the finding of this name; the option may be given several times.
    """
    from ..jobs.conversion.convert import convert as convert_file

    stated = {"name": name, "model": model, "size": size, "kind": kind, "unit": unit, "angle": angle}
    stated |= {"rotation": rotation, "quaternion": quaternion, "inverse": "yes" if inverse else None}
    meanings = {key: value for key, value in stated.items() if value is not None}
    done = convert_file(file, output, target, meanings, accept)
    print_findings(done.findings)
    if json:
        findings = [finding.document() for finding in done.findings]
        print_json({"source": done.source, "target": done.target, **(done.document or {}), "findings": findings})
    else:
        print(f"{done.source}, written as {done.target} to {output}")
        for note in (done.document or {}).get("notes", ()):
            print(f"  {note}")
    return DONE
