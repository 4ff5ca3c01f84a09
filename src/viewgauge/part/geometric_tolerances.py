"""The kinds of geometric tolerances of ISO 1101, and why each is not measured."""

from __future__ import annotations

from dataclasses import dataclass

from .indication import Measurability

__all__ = ["GEOMETRIC_TOLERANCES", "GeometricTolerance", "geometric_tolerance"]

_WHOLE_SURFACE = "it needs points of a whole surface, and a camera locates points of edges only"


@dataclass(frozen=True)
class GeometricTolerance:
    """A kind of geometric tolerance.

    Parameters
    ----------
    kind
        Its name as a kind of characteristic, such as "position".
    words
        Its name on a drawing, such as "position" or "profile of a surface".
    status, reason
        What becomes of it, and why.
    """

    kind: str
    words: str
    status: Measurability
    reason: str


def _not_yet(kind: str, words: str = "") -> GeometricTolerance:
    words = words or kind
    article = "an" if words[0] in "aeiou" else "a"
    reason = f"{article} {words} tolerance is not yet measured"
    return GeometricTolerance(kind, words, Measurability.NOT_MEASURABLE, reason)


def _surface(kind: str, words: str = "") -> GeometricTolerance:
    words = words or kind
    return GeometricTolerance(kind, words, Measurability.OUT_OF_SCOPE, _WHOLE_SURFACE)


GEOMETRIC_TOLERANCES: dict[str, GeometricTolerance] = {
    tolerance.kind: tolerance
    for tolerance in (
        _not_yet("straightness"),
        _surface("flatness"),
        _not_yet("roundness"),
        _surface("cylindricity"),
        _not_yet("line_profile", "line profile"),
        _surface("surface_profile", "surface profile"),
        _not_yet("angularity"),
        _not_yet("parallelism"),
        _not_yet("perpendicularity"),
        _not_yet("position"),
        _not_yet("coaxiality"),
        _not_yet("concentricity"),
        _not_yet("symmetry"),
        _not_yet("circular_runout", "circular runout"),
        _surface("total_runout", "total runout"),
    )
}
"""By kind."""


def geometric_tolerance(kind: str) -> GeometricTolerance:
    """The kind of this name; one that is not known is not measured either."""
    return GEOMETRIC_TOLERANCES.get(kind) or _not_yet(kind, "geometric" if kind == "geometric_tolerance" else kind)
