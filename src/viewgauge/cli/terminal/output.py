"""What the commands print."""

from __future__ import annotations

import json
import sys
from typing import Any

__all__ = ["certainty", "print_check", "print_error", "print_json", "print_plan", "print_table_summary"]

_STATUSES = ("not_met", "partial", "not_measurable", "out_of_scope", "met")
_OPEN = {"partial": "partial", "not_measurable": "not measurable", "out_of_scope": "out of scope"}


def print_json(document: Any) -> None:
    """JSON on standard output."""
    print(json.dumps(document, indent=2, ensure_ascii=False, allow_nan=False))


def print_error(error: Exception, *, as_json: bool) -> None:
    """One clear message on standard error; for programs also as JSON on standard output."""
    print(f"viewgauge: {error}", file=sys.stderr)
    if as_json:
        names = ("problem", "file", "line", "key", "expected", "hint")
        details = {name: getattr(error, name, None) for name in names}
        details["got"] = None if getattr(error, "got", None) is None else str(error.got)  # type: ignore[attr-defined]
        print_json({"error": {"kind": type(error).__name__, "message": str(error), **details}})


def print_plan(document: dict[str, Any], folder: str) -> None:
    """A plan in a few lines: the count, what is not met and why, and the table of what is."""
    by_status = {s: [d for d in document["characteristics"] if d["status"] == s] for s in _STATUSES}
    count, total, tried = document["count"], len(document["characteristics"]), document["candidates"]
    if count:
        print(f"{_viewpoints(count)} ({_optimality(document)}) for {len(by_status['met'])} of {total} characteristics")
    else:
        print(f"none of {tried} candidates measures any of {total} characteristics as required")
    if document["refinement"]:
        _print_refinement(document["refinement"])
    if document["interrupted"]:
        print("  interrupted: the best so far; run it again for the rest")
    required = document["requirement"]["probability"]
    for characteristic in by_status["not_met"]:
        best = f"best probability {certainty(characteristic['probability'])} of {required:g} required"
        print(f"  not met         {characteristic['id']}: {best}; {characteristic['limit']}")
        print(f"                  {characteristic['proof']}")
    for characteristic in by_status["met"]:
        if characteristic["acquisitions"]:
            names = ", ".join(acquisition["viewpoint"] for acquisition in characteristic["acquisitions"])
            alone = certainty(characteristic["single_probability"])
            mean = certainty(characteristic["probability"])
            print(f"  averaged        {characteristic['id']}: {mean} from {names}; alone {alone}")
    for status, words in _OPEN.items():
        for characteristic in by_status[status]:
            print(f"  {words:<15} {characteristic['id']}: {_on_drawing(characteristic)}{characteristic['limit']}")
    for entry in document["without_tolerance"]:
        print(f"  {'no tolerance':<15} {entry['id']}: {entry['text']}; nothing is demanded of it")
    for characteristic in document["characteristics"]:
        if characteristic["warning"]:
            reported = "confirmed" if characteristic["status"] == "met" else "not confirmed"
            print(
                f"  warning         {characteristic['id']}: {characteristic['warning']}; {reported} with the full "
                "camera model"
            )
    if by_status["met"]:
        weakest = min(by_status["met"], key=lambda d: float(d["probability"]))
        print(f"weakest characteristic met: {weakest['id']} with probability {certainty(weakest['probability'])}")
    for viewpoint in document["viewpoints"]:
        print(f"  {viewpoint['id']} measures {', '.join(viewpoint['observes'])}")
    print(f"written to {folder}: report.html, plan.json, viewpoints.csv, assignments.csv")


def _viewpoints(count: int) -> str:
    return "1 viewpoint" if count == 1 else f"{count} viewpoints"


def _optimality(document: dict[str, Any]) -> str:
    """What is known of the number of viewpoints."""
    tried, anywhere = document["candidates"], document["anywhere"]
    if anywhere is not None and anywhere["proven"]:
        return "proven fewest anywhere in the region"
    more = " and those that refining found" if document["refinement"] and document["refinement"]["generated"] else ""
    proof = "proven fewest" if document["proven"] else f"at least {document['lower_bound']} are needed"
    return f"{proof} of {tried} candidates{more}" + (
        f"; anywhere at least {anywhere['lower_bound']}" if anywhere else ""
    )


def _print_refinement(refinement: dict[str, Any]) -> None:
    """Before and after, where it changed something."""
    before, after = refinement["steps"][0], refinement["steps"][-1]
    reported = [
        f"{_viewpoints(s['count'])}, {s['met']} met, weakest {certainty(s['weakest'])}" for s in (before, after)
    ]
    if reported[0] != reported[1]:
        print(f"  refined         from {reported[0]} to {reported[1]}")
    if not refinement["finished"]:
        print("  refined         until stopped; more time (--time-limit) may find better")


def print_table_summary(
    rows: dict[str, dict[str, Any]], refused: list[dict[str, Any]], viewpoints: int, method: str
) -> None:
    """For each characteristic the best of the evaluated viewpoints, and what cannot be measured at all."""
    characteristics = "1 characteristic" if len(rows) == 1 else f"{len(rows)} characteristics"
    print(f"{characteristics} from {_viewpoints(viewpoints)}; the best of each:")
    for name, row in rows.items():
        verdict = "accepted" if row["accepted"] else "not accepted"
        seen = (
            f"probability {certainty(row['probability'])} from {row['viewpoint']}"
            if row["visible"]
            else f"not visible ({row['reason']})"
        )
        print(f"  {name}: {seen}, {verdict}")
        if row["validity"] and method != "monte-carlo":
            print(f"    warning: {row['validity']}; the full camera model answers with --method monte-carlo")
    for entry in refused:
        print(f"  {entry['id']}: {_OPEN[entry['status']]}; {_on_drawing(entry)}{entry['reason']}")


def print_check(document: dict[str, Any]) -> None:
    """What was read: the part, its characteristics, and what cannot be measured."""
    part, refused = document["part"], document["not_measurable"]
    characteristics = [entry for entry in document["characteristics"] if entry["status"] == "measurable"]
    size = " x ".join(f"{length:.4g}" for length in part["size_mm"])
    print(f"{part['name']}: {size} mm (file in {part['length_unit']}), {part['triangles']} triangles", end="")
    print(f" within {part['chord_error_mm']:.2g} mm of the surface")
    for note in part["notes"]:
        print(f"  note: {note}")
    if part["solids"] is not None:
        print(f"  solids: {part['solids']}")
    if not document["characteristics"]:
        print("no characteristics")
        return
    print(f"{len(characteristics)} characteristics can be measured:")
    for d in characteristics:
        tolerance = "no tolerance" if d["tolerance_mm"] is None else "{:+g} {:+g}".format(*d["tolerance_mm"])
        measurands = "1 measurand" if d["measurands"] == 1 else f"{d['measurands']} measurands"
        print(
            f"  {d['id']}: {d['kind']} {d['nominal_mm']:.6g} mm ({tolerance}), "
            f"allowed error {d['allowed_error_mm']:.3g} mm, {measurands}"
        )
    if refused:
        print(f"{len(refused)} cannot be measured:")
    for d in refused:
        outside = " (out of scope)" if d["status"] == "out_of_scope" else ""
        print(f"  {d['id']}: {d['text'] or d['kind']}; {d['reason']}{outside}")
    for d in document["without_tolerance"]:
        print(f"without a tolerance, so nothing is demanded: {d['id']}: {d['text']}")
    if document["counts"]:
        kinds = ", ".join(f"{count} {kind.replace('_', ' ')}" for kind, count in document["counts"].items())
        print(f"toleranced records in the part's file, counted apart: {sum(document['counts'].values())} ({kinds})")


def _on_drawing(entry: dict[str, Any]) -> str:
    """How a characteristic stands on the drawing, before its reason."""
    return f"{entry['text']}; " if entry["text"] else ""


def certainty(probability: float) -> str:
    """A probability rounded down: it never reads higher than it is, and never as certain."""
    if probability > 0.9999:
        return "> 0.9999"
    return f"{int(probability * 10_000) / 10_000:.4f}"
