"""Build the block with two slots and two steps, with its characteristics, as STEP AP242 with semantic PMI.

After Fig. 6 of the 1998 paper: the characteristic E2 is the length of the step. Part frame, mm: the block lies on z = 0
with a corner at the origin, the steps descend along +x, the slots run along x through the top.

    python build_part.py [FILE]     # default: slotted_block.step beside this script; the same bytes every time
"""

from __future__ import annotations

import io
import re
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from OCP.BRep import BRep_Builder
from OCP.BRepAlgoAPI import BRepAlgoAPI_Cut
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge, BRepBuilderAPI_MakeVertex
from OCP.BRepExtrema import BRepExtrema_DistShapeShape
from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox, BRepPrimAPI_MakeCylinder
from OCP.collections import Sequence_TDF_Label
from OCP.gp import gp_Ax2, gp_Dir, gp_Pnt
from OCP.IFSelect import IFSelect_ReturnStatus
from OCP.Interface import Interface_Static
from OCP.Message import Message
from OCP.STEPCAFControl import STEPCAFControl_Controller, STEPCAFControl_Writer
from OCP.TCollection import TCollection_ExtendedString, TCollection_HAsciiString
from OCP.TDataStd import TDataStd_Name
from OCP.TDF import TDF_Label
from OCP.TDocStd import TDocStd_Document
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS_Compound, TopoDS_Shape
from OCP.XCAFDimTolObjects import XCAFDimTolObjects_DimensionObject, XCAFDimTolObjects_DimensionType
from OCP.XCAFDoc import XCAFDoc_Dimension, XCAFDoc_DocumentTool

NAME = "slotted_block"
HEADER = f"""ISO-10303-21;
HEADER;
FILE_DESCRIPTION(('Block with two slots and two steps, semantic PMI'),'2;1');
FILE_NAME('{NAME}.step','2000-01-01T00:00:00',(''),(''),'Open CASCADE','viewgauge examples','');
FILE_SCHEMA(('AP242_MANAGED_MODEL_BASED_3D_ENGINEERING_MIM_LF {{ 1 0 10303 442 1 1 4 }}'));
"""

Point = tuple[float, float, float]
DISTANCE = XCAFDimTolObjects_DimensionType.XCAFDimTolObjects_DimensionType_Location_LinearDistance
LENGTH = XCAFDimTolObjects_DimensionType.XCAFDimTolObjects_DimensionType_Size_CurveLength
DIAMETER = XCAFDimTolObjects_DimensionType.XCAFDimTolObjects_DimensionType_Size_Diameter
FACE, EDGE = TopAbs_ShapeEnum.TopAbs_FACE, TopAbs_ShapeEnum.TopAbs_EDGE


@dataclass(frozen=True)
class PmiRecord:
    """One characteristic: its value, what it refers to, and where it is drawn.

    Parameters
    ----------
    nominal, lower, upper
        Value and deviations, mm; without deviations the value is basic.
    first, second
        Points, mm, each inside one face (or on one edge, see ``target``) that is referred to.
    line, offset
        Ends of the drawn characteristic line, mm, and how far it is moved off the part, mm.
    limits
        Write the range of permitted values instead of deviations.
    """

    name: str
    type: XCAFDimTolObjects_DimensionType
    nominal: float
    lower: float | None
    upper: float | None
    first: tuple[Point, ...]
    second: tuple[Point, ...]
    line: tuple[Point, Point]
    offset: Point
    target: TopAbs_ShapeEnum = FACE
    limits: bool = False


PMI_RECORDS = (
    # overall: length, width, height (asymmetric)
    PmiRecord("E1", DISTANCE, 100, -0.15, 0.15, ((0, 6, 20),), ((100, 6, 6),), ((0, 0, 0), (100, 0, 0)), (0, -30, 0)),
    PmiRecord("E3", DISTANCE, 60, -0.1, 0.1, ((30, 0, 20),), ((30, 60, 20),), ((0, 0, 0), (0, 60, 0)), (-30, 0, 0)),
    PmiRecord("E4", DISTANCE, 40, -0.05, 0.1, ((30, 6, 0),), ((30, 6, 40),), ((0, 0, 0), (0, 0, 40)), (-30, 0, 0)),
    # the steps: lengths and heights
    PmiRecord("E2", LENGTH, 60, -0.1, 0.1, ((30, 0, 40),), (), ((0, 0, 40), (60, 0, 40)), (0, -15, 0), target=EDGE),
    PmiRecord("E5", DISTANCE, 26, -0.08, 0.08, ((30, 6, 0),), ((70, 6, 26),), ((80, 0, 0), (80, 0, 26)), (0, -15, 0)),
    PmiRecord("E6", DISTANCE, 12, -0.06, 0.06, ((30, 6, 0),), ((90, 6, 12),), ((100, 0, 0), (100, 0, 12)), (15, 0, 0)),
    PmiRecord("E7", DISTANCE, 20, -0.06, 0.06, ((60, 6, 28),), ((80, 6, 20),), ((60, 0, 26), (80, 0, 26)), (0, -15, 0)),
    # the slots: widths (the second as a range), depths, the land between them from edge to edge, a basic position
    PmiRecord(
        "E8", DISTANCE, 12, -0.05, 0.05, ((30, 12, 35),), ((30, 24, 35),), ((0, 12, 40), (0, 24, 40)), (-15, 0, 0)
    ),
    PmiRecord(
        "E9", DISTANCE, 8, -0.05, 0.05, ((30, 36, 37),), ((30, 44, 37),), ((0, 36, 40), (0, 44, 40)), (-15, 0, 0),
        limits=True,
    ),
    PmiRecord(
        "E10", DISTANCE, 10, -0.05, 0.05, ((30, 18, 30),), ((30, 6, 40),), ((0, 12, 30), (0, 12, 40)), (-15, 0, 0)
    ),
    PmiRecord(
        "E11", DISTANCE, 12, -0.06, 0.06, ((30, 24, 40),), ((30, 36, 40),), ((60, 24, 40), (60, 36, 40)), (0, 0, 15),
        target=EDGE,
    ),
    PmiRecord("E12", DISTANCE, 12, None, None, ((30, 0, 20),), ((30, 12, 35),), ((0, 0, 40), (0, 12, 40)), (0, 0, 15)),
    # through holes: one alone, and two alike in one PMI record
    PmiRecord("E13", DIAMETER, 10, -0.05, 0.05, ((65, 30, 13),), (), ((65, 30, 26), (75, 30, 26)), (0, 0, 30)),
    PmiRecord(
        "E14", DIAMETER, 8, 0.0, 0.08, ((86, 15, 6), (86, 45, 6)), (), ((86, 15, 12), (94, 15, 12)), (0, 0, 30)
    ),
)  # fmt: skip


def build_solid() -> TopoDS_Shape:
    """The block 100 x 60 x 40 less two steps, two slots and three holes."""
    solid = BRepPrimAPI_MakeBox(100, 60, 40).Shape()
    boxes = [
        ((60, -1, 26), (81, 61, 41)),  # upper step
        ((80, -1, 12), (101, 61, 41)),  # lower step
        ((-1, 12, 30), (61, 24, 41)),  # wide slot
        ((-1, 36, 34), (61, 44, 41)),  # narrow slot
    ]
    tools = [BRepPrimAPI_MakeBox(gp_Pnt(*low), gp_Pnt(*high)).Shape() for low, high in boxes]
    for x, y, radius in ((70, 30, 5), (90, 15, 4), (90, 45, 4)):
        axis = gp_Ax2(gp_Pnt(x, y, -1), gp_Dir(0, 0, 1), gp_Dir(0, 1, 0))
        tools.append(BRepPrimAPI_MakeCylinder(axis, radius, 42).Shape())
    for tool in tools:
        solid = BRepAlgoAPI_Cut(solid, tool).Shape()
    explorer = TopExp_Explorer(solid, TopAbs_ShapeEnum.TopAbs_SOLID)
    return explorer.Current()


def feature_at(solid: TopoDS_Shape, point: Point, target: TopAbs_ShapeEnum) -> TopoDS_Shape:
    """The one face or edge of the solid on which a point lies."""
    vertex = BRepBuilderAPI_MakeVertex(gp_Pnt(*point)).Vertex()
    found: list[TopoDS_Shape] = []
    explorer = TopExp_Explorer(solid, target)
    while explorer.More():
        shape = explorer.Current()
        near = BRepExtrema_DistShapeShape(shape, vertex).Value() < 1e-6
        if near and not any(shape.IsSame(other) for other in found):
            found.append(shape)
        explorer.Next()
    if len(found) != 1:
        raise ValueError(f"{len(found)} features at {point}, expected one")
    return found[0]


def drawing(pmi_record: PmiRecord) -> tuple[TopoDS_Shape, gp_Ax2, gp_Pnt]:
    """The characteristic line with its two extension lines, the plane they lie in, and the middle of the line."""
    start, end = (np.asarray(point, dtype=float) for point in pmi_record.line)
    offset = np.asarray(pmi_record.offset, dtype=float)
    lines = ((start, start + offset), (start + offset, end + offset), (end + offset, end))
    compound, builder = TopoDS_Compound(), BRep_Builder()
    builder.MakeCompound(compound)
    for a, b in lines:
        builder.Add(compound, BRepBuilderAPI_MakeEdge(gp_Pnt(*a), gp_Pnt(*b)).Edge())
    middle = gp_Pnt(*((start + end) / 2 + offset))
    return compound, gp_Ax2(middle, gp_Dir(*np.cross(end - start, offset)), gp_Dir(*(end - start))), middle


def dimension_object(pmi_record: PmiRecord) -> XCAFDimTolObjects_DimensionObject:
    """The PMI record as the CAD kernel's object; its name travels as the name of its presentation."""
    thing = XCAFDimTolObjects_DimensionObject()
    thing.SetType(pmi_record.type)
    if pmi_record.lower is None or pmi_record.upper is None:
        thing.SetValue(pmi_record.nominal)
    elif pmi_record.limits:
        thing.SetUpperBound(pmi_record.nominal + pmi_record.upper)
        thing.SetLowerBound(pmi_record.nominal + pmi_record.lower)
    else:
        thing.SetValue(pmi_record.nominal)
        thing.SetUpperTolValue(pmi_record.upper)
        thing.SetLowerTolValue(-pmi_record.lower)  # the kernel keeps the magnitude and writes the minus sign
    lines, plane, middle = drawing(pmi_record)
    thing.SetPresentation(lines, TCollection_HAsciiString(pmi_record.name))
    thing.SetPlane(plane)
    thing.SetPointTextAttach(middle)
    return thing


def build_document() -> TDocStd_Document:
    """The solid and its characteristics as a CAD document."""
    solid = build_solid()
    document = TDocStd_Document(TCollection_ExtendedString("XmlOcaf"))
    shapes = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    characteristics = XCAFDoc_DocumentTool.DimTolTool_s(document.Main())
    root = shapes.AddShape(solid, False)
    TDataStd_Name.Set_s(root, TCollection_ExtendedString(NAME))

    def labels(points: tuple[Point, ...], target: TopAbs_ShapeEnum) -> Sequence_TDF_Label:
        sequence = Sequence_TDF_Label()
        for point in points:
            sequence.Append(shapes.AddSubShape(root, feature_at(solid, point, target)))
        return sequence

    for pmi_record in PMI_RECORDS:
        label: TDF_Label = characteristics.AddDimension()
        first, second = labels(pmi_record.first, pmi_record.target), labels(pmi_record.second, pmi_record.target)
        characteristics.SetDimension(first, second, label)
        XCAFDoc_Dimension.Set_s(label).SetObject(dimension_object(pmi_record))
    return document


def step_text(document: TDocStd_Document) -> str:
    """The document as STEP AP242 text that does not depend on when, where and by whom it is written."""
    Message.DefaultMessenger_s().ChangePrinters().Clear()  # no statistics on the console
    STEPCAFControl_Controller.Init_s()
    Interface_Static.SetIVal_s("write.step.schema", 5)  # AP242
    writer = STEPCAFControl_Writer()
    writer.SetDimTolMode(True)
    stream = io.BytesIO()
    if not writer.Transfer(document) or writer.WriteStream(stream) != IFSelect_ReturnStatus.IFSelect_RetDone:
        raise RuntimeError("the CAD kernel could not write the STEP file")
    _, body = stream.getvalue().decode("ascii").split("ENDSEC;\n", maxsplit=1)
    # The kernel writes tolerance values without their type, which the schema requires.
    typed = re.sub(r"= MEASURE_WITH_UNIT\((-?[\d.E+-]+),", r"= LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(\1),", body)
    return HEADER + "ENDSEC;\n" + typed


if __name__ == "__main__":
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).with_name(f"{NAME}.step")
    target.write_text(step_text(build_document()), encoding="ascii", newline="\n")
    print(f"{target.name}: {len(PMI_RECORDS)} PMI records")
