"""What limits a characteristic that no candidate measures as required."""

from __future__ import annotations

import numpy as np

from ..evaluation import BestRows
from ..visibility import REASONS
from .bounds import Certificate

__all__ = ["limiting_cause", "proof_sentence"]

_WORDS = {
    "behind_camera": "behind the camera",
    "out_of_view": "outside the image",
    "facing_away": "on faces turned away",
    "too_short": "too short in the image",
    "out_of_focus": "out of focus",
    "occluded": "hidden by the part",
}


def limiting_cause(best: BestRows, j: int) -> str:
    """One sentence on characteristic j: why it is not seen, or which error limits it at its most probable viewpoint."""
    if not best.values.visible[j]:
        counts = dict(zip(REASONS[:-1], best.counts[j].tolist(), strict=False))
        ordered = sorted((name for name in counts if counts[name]), key=lambda name: -counts[name])
        total = int(best.counts[j].sum())
        shares = ", ".join(f"{_WORDS[name]} ({counts[name] / total:.0%})" for name in ordered[:3])
        return f"not visible from any of {total} candidates: {shares}"
    pose, pixels = (
        float(sigma[j]) ** 2 for sigma in (best.values.sigma_displacement_px, best.values.sigma_quantization_px)
    )
    share = pose / (pose + pixels) if pose + pixels > 0 else 0.0
    source = f"pose error ({share:.0%} of the variance)" if share > 0.5 else f"pixels ({1 - share:.0%} of the variance)"
    length = float(best.values.image_length_px[j])
    return f"visible, but limited by {source}: standard deviation {np.sqrt(pose + pixels):.3g} px of {length:.4g} px"


def proof_sentence(certificate: Certificate | None, candidate_count: int, given: bool = False) -> str:
    """What is known of a characteristic that no viewpoint meets: proven for the whole region, or only of what was
    tried.

    Parameters
    ----------
    given
        The candidates are explicit viewpoints, the only ones there are.
    """
    if given:
        return f"none of the {candidate_count} given viewpoints meets it"
    if certificate is not None and certificate.proven:
        return f"proven: at most {certificate.upper_words} from anywhere in the region; {certificate.cause}"
    found = f"not found in {candidate_count} candidates"
    return found if certificate is None else f"{found}; {certificate.cause}"
