"""The command that lists a part's features and proposes characteristics on them."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from .options import DONE, Json
from .terminal.output import print_json
from .terminal.progress import Bars

__all__ = ["features"]

_PLURALS = {"plane": "planes", "edge": "straight edges", "hole": "holes", "boss": "bosses", "slot": "slots"}


def features(
    part: Path,
    /,
    *,
    propose: Annotated[bool, Parameter(negative="")] = False,
    output: Annotated[Path | None, Parameter(name=["--output", "-o"])] = None,
    json: Json = False,
) -> int:
    """List the features of a part with their ids, and propose characteristics on them.

    An inspection file states characteristics on features by these ids, where the part has no PMI or not enough.

    Parameters
    ----------
    part
        Read this STEP file.
    propose
        Propose characteristics: distances of parallel planes, diameters, and positions of holes.
    output
        Write the proposals to this file as the part section of an inspection file, to be edited.
    """
    from ..jobs.features.list_features import describe_features, read_features, write_proposals

    with Bars().stage("Reading the part"):
        read, catalogue = read_features(part)
    document = describe_features(read, catalogue, with_proposals=propose or output is not None)
    text = write_proposals(catalogue, part, output) if propose or output is not None else ""
    if json:
        print_json(document)
    elif propose and output is None:
        print(text, end="")
    else:
        _print_features(document)
        if output is not None:
            count = sum(proposal["kind"] != "position" for proposal in document["proposals"])
            print(f"{count} characteristics proposed, written to {output}: edit them, and add the other sections")
        else:
            print("`viewgauge features` with --propose writes characteristics on them, to be edited")
    return DONE


def _print_features(document: dict[str, Any]) -> None:
    part = document["part"]
    size = " x ".join(f"{length:.6g}" for length in part["size_mm"])
    solids = "1 solid" if part["solids"] == 1 else f"{part['solids']} solids"
    print(f"{part['name']}: {size} mm (file in {part['length_unit']}), {solids}")
    for note in part["notes"]:
        print(f"  note: {note}")
    for kind, plural in _PLURALS.items():
        found = [feature for feature in document["features"] if feature["kind"] == kind]
        if not found:
            continue
        print(f"{len(found)} {kind if len(found) == 1 and kind != 'edge' else plural}:")
        for feature in found:
            sizes = ", ".join(f"{name} {value:.6g}" for name, value in feature["sizes_mm"].items())
            print(f"  {feature['id']}: {sizes} mm; at {_triple(feature['position_mm'])} mm, {_way(feature)}")


def _way(feature: dict[str, Any]) -> str:
    if feature["kind"] == "slot":
        return "between " + " and ".join(feature["planes"])
    word = {"plane": "normal", "edge": "along"}.get(feature["kind"], "axis")
    return f"{word} {_triple(feature['direction'])}"


def _triple(values: list[float]) -> str:
    return "[" + ", ".join(f"{value:.5g}" for value in values) + "]"
