"""STEP files that tests write: small solids of the CAD kernel's, and texts by hand."""

from __future__ import annotations

import math
from pathlib import Path

HEAD = (
    "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('','',(''),(''),'','','');\n"
    "FILE_SCHEMA(('X'));\nENDSEC;\n"
)
MILLIMETRES = "#1=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));\n"
CENTIMETRES = "#1=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.CENTI.,.METRE.));\n"
CONTEXT = "#2=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNIT_ASSIGNED_CONTEXT((#1))REPRESENTATION_CONTEXT('',''));\n"


def step_text(records: str, unit: str = MILLIMETRES) -> str:
    """A whole file with these records."""
    return f"{HEAD}DATA;\n{unit}{CONTEXT}{records}ENDSEC;\nEND-ISO-10303-21;\n"


def write_shape(shape, path: Path) -> Path:
    """Write a shape of the kernel's."""
    from OCP.STEPControl import STEPControl_StepModelType, STEPControl_Writer

    writer = STEPControl_Writer()
    writer.Transfer(shape, STEPControl_StepModelType.STEPControl_AsIs)
    writer.Write(str(path))
    return path


def plate_with_leaning_hole(tilt_deg: float):
    """A plate of 60 x 40 x 10 mm with a through hole of diameter 8, whose axis leans in the x-z plane."""
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCylinder
    from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt

    tilt = math.radians(tilt_deg)
    x, z = math.sin(tilt), math.cos(tilt)
    drill = BRepPrimAPI_MakeCylinder(gp_Ax2(gp_Pnt(30 - 60 * x, 20, 5 - 60 * z), gp_Dir(x, 0, z)), 4.0, 120.0)
    return BRepAlgoAPI_Cut(BRepPrimAPI_MakeBox(60, 40, 10).Shape(), drill.Shape()).Shape()
