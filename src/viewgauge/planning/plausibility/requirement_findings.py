"""What is implausible in a requirement, and in the tolerances that it is judged against."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ...evaluation import Requirement
from ...findings import Finding
from ...part import Characteristic
from .usual_range import some_of

__all__ = ["requirement_findings"]

_SMALLEST_ERROR_MM = 1e-5


def requirement_findings(requirement: Requirement, characteristics: Sequence[Characteristic]) -> Iterator[Finding]:
    """Every finding of a requirement and of the tolerances of characteristics."""
    if requirement.probability < 0.5:
        yield Finding(
            "probability",
            f"the required probability is {requirement.probability:.6g}: less than that of a coin",
            "0.9 to 0.999",
            "a percentage without its sign, or the risk in place of the probability",
            "requirement.probability",
        )
    above, small, wide = [], [], []
    for characteristic in characteristics:
        zone = characteristic.tolerance_mm
        allowed_mm = requirement.allowed_error_mm(characteristic.nominal_mm, zone)
        if allowed_mm is not None and allowed_mm < _SMALLEST_ERROR_MM:
            small.append(f"{characteristic.id} ({allowed_mm:.2g} mm)")
        if zone is None:
            continue
        half_mm = (zone[1] - zone[0]) / 2
        if allowed_mm is not None and half_mm > 0 and allowed_mm > (1 + 1e-9) * half_mm:
            above.append(f"{characteristic.id} ({allowed_mm:.3g} mm, tolerance +-{half_mm:.3g} mm)")
        if half_mm > characteristic.nominal_mm > 0:
            wide.append(f"{characteristic.id} (+-{half_mm:.3g} mm of {characteristic.nominal_mm:.4g} mm)")
    if above:
        yield Finding(
            "allowed_error_above_tolerance",
            f"the allowed error is larger than the tolerance of {some_of(above)}: what is met so says nothing "
            "of whether the part conforms",
            "10 to 30 % of the tolerance",
            "an accuracy relative to the length; fraction_of_tolerance follows the tolerance",
            "requirement",
        )
    if small:
        yield Finding(
            "allowed_error_small",
            f"the allowed error is below {_SMALLEST_ERROR_MM:g} mm for {some_of(small)}: less than the roughness "
            "of any surface",
            "at least 0.0001 mm",
            "a length in m or um written as mm, or an accuracy of too many nines",
            "requirement",
        )
    if wide:
        yield Finding(
            "tolerance_size",
            f"the tolerance is larger than the length itself for {some_of(wide)}",
            "at most a tenth of the length",
            "um or percent written as mm, or a part in another unit",
            "part.characteristics",
        )
