"""The commands that ask the other way round: what to improve, and which camera and pose uncertainty the part needs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import Annotated, Any, Literal

from cyclopts import Parameter

import viewgauge as vg

from .options import DONE, NOT_MET, Json, PartFile
from .terminal.output import certainty, print_json
from .terminal.progress import Bars
from .terminal.reading import read_inspection

__all__ = ["improve", "specify"]

_DIGITS = 4


def improve(
    file: Path,
    /,
    *,
    output: Annotated[Path | None, Parameter(name=["--output", "-o"])] = None,
    part: PartFile = None,
    json: Json = False,
) -> int:
    """Report how much each error source must shrink for every characteristic to be met.

    One of pixels, pose uncertainty, lens and distance changes at a time, and all else stays as it is. Where a
    characteristic is met, the answer is how far it may change.

    Parameters
    ----------
    file
        Read this inspection file (YAML).
    output
        Write the answers to this file: .json, or .html to look at.
    """

    document = _answered(file, part, output, "improve")
    if json:
        print_json(document)
    else:
        _print_improvement(document)
        _print_written(output)
    return DONE if document["part"]["met"] and not _missing(document) else NOT_MET


def specify(
    file: Path,
    /,
    *,
    output: Annotated[Path | None, Parameter(name=["--output", "-o"])] = None,
    part: PartFile = None,
    json: Json = False,
) -> int:
    """Report which cameras and lenses measure the part, and the largest pose uncertainty that each allows.

    Sensor formats and focal lengths are usual ones. The inspection file gives the edge detector's step in pixels, the
    covariance of the pose up to a factor, the requirement, and the distances if it states some.

    Parameters
    ----------
    file
        Read this inspection file (YAML).
    output
        Write the answers to this file: .json, or .html to look at.
    """

    document = _answered(file, part, output, "specify")
    if json:
        print_json(document)
    else:
        _print_specification(document)
        _print_written(output)
    return DONE if document["smallest"] is not None and not document["not_measurable"] else NOT_MET


def _answered(
    file: Path, part: Path | None, output: Path | None, question: Literal["improve", "specify"]
) -> dict[str, Any]:
    """The answers as JSON-ready data, written to a file if there is to be one."""
    from ..jobs.write import describe_answers, output_folder, require_answer_suffix, write_answers

    if output is not None:
        require_answer_suffix(output)
    bars = Bars()
    with output_folder(output.parent) if output is not None else nullcontext():
        inspection = read_inspection(file, part)
        ask = vg.improve if question == "improve" else vg.specify
        answers = ask(inspection, progress=bars)
        if output is not None:
            write_answers(answers, inspection, output)
    return describe_answers(answers, inspection)


def _missing(document: dict[str, Any]) -> bool:
    return bool(document["not_measurable"] or document["part"]["left_out"])


def _print_written(output: Path | None) -> None:
    if output is not None:
        print(f"written to {output}")


def _print_improvement(document: dict[str, Any]) -> None:
    characteristics, knobs, part = document["characteristics"], document["knobs"], document["part"]
    met = sum(characteristic["met"] for characteristic in characteristics)
    print(
        f"{met} of {len(characteristics)} characteristics are met today; {document['viewpoints_tried']} "
        "viewpoints tried"
    )
    print("the value of each thing alone with which a characteristic is met, or up to which it stays met:")
    rows = [["characteristic", "today", *(name.replace("_", " ") for name in knobs)]]
    rows.append(["", "", *(knob["unit"] for knob in knobs.values())])
    rows.append(["today", "", *(_number(knob["today"]) for knob in knobs.values())])
    for d in characteristics:
        verdict = f"{'met' if d['met'] else 'not met'} {certainty(d['probability'])}"
        rows.append([d["id"], verdict, *(_answer(d["changes"][name]) for name in knobs)])
    if part["changes"]:
        verdict = "met" if part["met"] else "not met"
        rows.append(["part", verdict, *(_answer(part["changes"][name]) for name in knobs)])
        rows.append(["  limited by", "", *(_names(part["changes"][name]["limited_by"]) for name in knobs)])
    _print_table(rows)
    if part["left_out"]:
        print(f"not seen from any viewpoint that was tried: {', '.join(part['left_out'])}; viewgauge plan says why")
    for entry in document["not_measurable"]:
        print(f"  not measurable  {entry['id']}: {entry['reason']}")
    if document["trade_off"]:
        print("edge detector against pose uncertainty, for the part: with this step, at most this pose uncertainty")
        rows = [["step", "pose uncertainty", "translation", "rotation"], ["px", "of today's", "mm", "deg"]]
        for trade in document["trade_off"]:
            factor = trade["pose_error_factor"]
            values = [factor, trade["translation_mm"], trade["rotation_deg"]]
            reported = ["none is enough", "", ""] if factor is None else [_number(value) for value in values]
            rows.append([_number(trade["pixel_px"]), *reported])
        _print_table(rows)
    _print_unverified([c for d in characteristics for c in d["changes"].values()] + document["trade_off"])


def _print_specification(document: dict[str, Any]) -> None:
    total = document["characteristics"]
    print(
        "for each sensor the lens that allows the largest pose uncertainty, what is met with today's, and the coarsest"
    )
    print("edge detector with which everything is met:")
    rows = [
        [
            "sensor",
            "pixel",
            "lens",
            "distance",
            "met",
            "pose uncertainty",
            "translation",
            "rotation",
            "or edge detector",
        ]
    ]
    rows.append(["", "µm", "mm", "mm", "", "of today's", "mm", "deg", "px"])
    for choice in document["best"]:
        near, far = choice["distance_mm"]
        limits = [choice[name] for name in ("pose_error_factor", "translation_mm", "rotation_deg")]
        reported = (
            ["none is enough", "", ""] if limits[0] is None else ["" if v is None else _number(v) for v in limits]
        )
        lens = [f"{1000 * choice['pixel_pitch_mm']:g}", f"{choice['focal_length_mm']:g}", f"{near:.0f} - {far:.0f}"]
        edge_detector = "none is enough" if choice["pixel_px"] is None else _number(choice["pixel_px"])
        rows.append([choice["sensor"], *lens, f"{choice['met']} of {total}", *reported, edge_detector])
    _print_table(rows)
    smallest = document["smallest"]
    if smallest is None:
        print("no camera that was tried measures every characteristic with today's pose uncertainty")
    else:
        print(f"fewest pixels with today's pose uncertainty: {smallest['sensor']}, {smallest['focal_length_mm']:g} mm")
    for entry in document["not_measurable"]:
        print(f"  not measurable  {entry['id']}: {entry['reason']}")
    _print_unverified(document["choices"])


def _print_unverified(answers: Sequence[dict[str, Any]]) -> None:
    doubtful = sum(not answer["verified"] for answer in answers)
    if doubtful:
        print(
            f"{doubtful} answers of {len(answers)} did not hold when they were evaluated again; see verified in --json"
        )


def _answer(change: dict[str, Any]) -> str:
    """A limit rounded to the safe side, an interval, or that there is none and how near it comes."""
    if change["interval"] is None:
        best = change["best_probability"]
        return "no" if best is None else f"no, {certainty(best)}"
    low, high = change["interval"]
    if change["unlimited"]:
        return "any" if not low else f"> {_number(low)}"
    if low == 0:
        return _number(high)
    shown = [_number(low, up=True) if low is not None else "", _number(high) if high is not None else ""]
    return " - ".join(shown).strip()


def _names(names: Sequence[str]) -> str:
    return "" if not names else names[0] if len(names) == 1 else f"{names[0]}, {len(names) - 1} more"


def _number(value: float, *, up: bool = False) -> str:
    """Four digits, rounded down (up): a limit that is printed is kept."""
    if value == 0:
        return "0"
    scale = 10.0 ** (_DIGITS - 1 - math.floor(math.log10(abs(value))))
    steps = math.ceil(value * scale - 1e-9) if up else math.floor(value * scale + 1e-9)
    return f"{steps / scale:.{_DIGITS}g}"


def _print_table(rows: Sequence[Sequence[str]]) -> None:
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    for first, *others in rows:
        cells = [first.ljust(widths[0]), *(t.rjust(w) for t, w in zip(others, widths[1:], strict=True))]
        print(("  " + "  ".join(cells)).rstrip())
