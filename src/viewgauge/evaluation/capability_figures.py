"""What engineers ask of a measurand, of one characteristic measured from one viewpoint: U, P/T, Cg, Cgk, TUR and
risks.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, hypot, sin

from ..errors import TotalError
from ..sensors import Camera
from .requirement.allowed_error import Requirement
from .requirement.capability_indices import SHARE, SIGMAS, cg, cgk, coverage, percent_p_to_t
from .requirement.conformance import COVERAGE_FACTOR

__all__ = ["CapabilityFigures", "capability_figures", "spread_mm"]


@dataclass(frozen=True)
class CapabilityFigures:
    """Predicted figures of one characteristic measured from one viewpoint.

    Parameters
    ----------
    u_mm
        Standard uncertainty of measurement, mm.
    expanded_uncertainty_mm
        U = 2 u, mm.
    percent_p_to_t, cg, cgk
        Capability of the measurement (:mod:`~viewgauge.evaluation.requirement.capability_indices`); P/T per cent. None
        where there is no tolerance zone.
    test_uncertainty_ratio
        TUR = (USL - LSL) / (2 U), as ANSI/NCSL Z540.3 defines it; None where there is no tolerance zone.
    consumer_risk, producer_risk
        Global risks (:mod:`~viewgauge.evaluation.requirement.decision_risks`); None where no process is stated.
    """

    u_mm: float
    expanded_uncertainty_mm: float
    percent_p_to_t: float | None = None
    cg: float | None = None
    cgk: float | None = None
    test_uncertainty_ratio: float | None = None
    consumer_risk: float | None = None
    producer_risk: float | None = None


def capability_figures(
    u_mm: float,
    tolerance_mm: tuple[float, float] | None,
    requirement: Requirement | None = None,
    half_spread_mm: float | None = None,
) -> CapabilityFigures:
    """The figures that follow from the uncertainty of measurement and the tolerance.

    Parameters
    ----------
    u_mm
        Standard deviation of the measured value, mm, positive.
    tolerance_mm
        (lower, upper) deviation; None where there is none.
    requirement
        States the number of standard deviations, share and bias of the indices, or the process and decision rule of
        the risks, where it is of that kind; by default 6, 20 %, none, and no risks.
    half_spread_mm
        Half the width of the interval that holds the share of the errors that stands for their spread
        (:func:`spread_mm`); by default ``sigmas u / 2``, as of a normal law. With it the indices agree with a
        required capability, which is judged by that interval.
    """
    expanded = COVERAGE_FACTOR * u_mm
    if tolerance_mm is None or not tolerance_mm[0] < tolerance_mm[1]:
        return CapabilityFigures(u_mm, expanded)
    sigmas, share, bias = (SIGMAS, SHARE, 0.0) if requirement is None else requirement.sigmas_share_bias
    sigma = u_mm if half_spread_mm is None else 2 * half_spread_mm / sigmas
    risks = None if requirement is None else requirement.risks(u_mm, tolerance_mm)
    lower, upper = tolerance_mm
    return CapabilityFigures(
        u_mm,
        expanded,
        percent_p_to_t=float(percent_p_to_t(sigma, lower, upper, sigmas)),
        cg=float(cg(sigma, lower, upper, share=share, sigmas=sigmas)),
        cgk=float(cgk(sigma, lower, upper, bias=bias, share=share, sigmas=sigmas)),
        test_uncertainty_ratio=(upper - lower) / (2 * expanded),
        consumer_risk=None if risks is None else float(risks.consumer),
        producer_risk=None if risks is None else float(risks.producer),
    )


def spread_mm(
    sigma_displacement_px: float,
    image_length_px: float,
    angle_rad: float,
    length_mm: float,
    camera: Camera,
    sigmas: float = SIGMAS,
    sigma_quantization_px: float = 0.0,
) -> float:
    """Half the width of the interval that holds the errors of a measured length but for 0.27 %, mm on the part.

    Of the joint model's law, displacement plus quantization: for a normal law ``sigmas`` times half the standard
    uncertainty, less where quantization is much of it.

    Parameters
    ----------
    sigma_displacement_px, image_length_px, angle_rad
        As in the table: along the image of the measurand.
    length_mm
        Length of the measurand.
    sigmas
        The interval holds as much as that many standard deviations of a normal law, 99.73 % by default.
    sigma_quantization_px
        As in the table; it counts for a camera that is not plain.
    """
    pitch_u, pitch_v = camera.pixel_pitch_mm
    px_per_mm = hypot(cos(angle_rad) / pitch_u, sin(angle_rad) / pitch_v)
    if camera.is_plain:
        law = TotalError(sigma_displacement_px / px_per_mm, camera.quantization_step_mm, angle_rad)
    else:  # what of the camera's part is not quantization is normal
        quantization = TotalError(0.0, camera.quantization_step_mm, angle_rad)
        normal = max((sigma_quantization_px / px_per_mm) ** 2 - float(quantization.var()), 0.0)
        sigma = hypot(sigma_displacement_px / px_per_mm, normal**0.5)
        law = TotalError(sigma, camera.quantization_step_mm, angle_rad)
    return float(law.ppf((1 + coverage(sigmas)) / 2)) * px_per_mm / image_length_px * length_mm
