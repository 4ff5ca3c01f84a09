"""Plan camera viewpoints that measure every toleranced characteristic of a part accurately enough.

>>> import viewgauge as vg
>>> inspection = vg.load("inspection.yaml")  # doctest: +SKIP
>>> plan = vg.plan(inspection)  # doctest: +SKIP
>>> table = vg.evaluate(inspection, "viewpoints.csv")  # doctest: +SKIP

Lengths are mm, angles rad, image positions px; ``T_a_b`` maps coordinates in b to coordinates in a. The public names
are those of ``__init__.pyi``; each is imported when it is first used, so that starting is fast.
"""

import lazy_loader

from . import drawing

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)


def _notebook() -> drawing.Drawing:
    from .report import notebook

    return notebook


drawing.draw_with(_notebook)
