"""The part, the measurands and the camera frusta as Plotly traces."""

from __future__ import annotations

import base64
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...part import Part
from ...part.mesh import Mesh
from ...planning.plan import Plan, PlannedCharacteristic, PlannedViewpoint
from ...sensors.camera import Camera
from ..palette import NOT_MET_COLOUR, viewpoint_colours, viewpoint_markers
from ..wording import length, probability
from .simplify import picture_mesh

__all__ = ["TRIANGLE_LIMIT", "build_scene", "measurand_scene"]

TRIANGLE_LIMIT = 150_000
"""Most triangles shown."""

LABEL_LIMIT = 60
"""Most measurands that are labelled in the picture; of more, only the pointer tells the names."""

Trace = dict[str, Any]
Polyline = NDArray[np.float64]
FONT = "system-ui, sans-serif"
INK = "#1c2733"
# Without the thresholds at zero, long thin triangles get a wrong shade.
LIGHTING = {"ambient": 0.75, "diffuse": 0.4, "specular": 0, "vertexnormalsepsilon": 0, "facenormalsepsilon": 0}


def _packed(values: NDArray[Any], kind: str) -> dict[str, str]:
    """An array in Plotly's base64 form; ``kind`` is f4 or i4."""
    return {"dtype": kind, "bdata": base64.b64encode(np.ascontiguousarray(values, f"<{kind}").tobytes()).decode()}


def _coordinates(polylines: Iterable[Polyline]) -> Trace:
    """Polylines as one broken line: NaN lifts the pen."""
    pen_up = np.full((1, 3), np.nan)
    pieces = [piece for polyline in polylines for piece in (polyline, pen_up)]
    points = np.concatenate(pieces) if pieces else pen_up
    return {axis: _packed(points[:, k], "f4") for k, axis in enumerate("xyz")}


def _mesh_trace(mesh: Mesh) -> Trace:
    points = {axis: _packed(mesh.vertices[:, k], "f4") for k, axis in enumerate("xyz")}
    corners = {name: _packed(mesh.triangles[:, k], "i4") for k, name in enumerate("ijk")}
    return {
        "type": "mesh3d",
        **points,
        **corners,
        "color": "#c3cad3",
        "flatshading": True,
        "lighting": LIGHTING,
        "hoverinfo": "skip",
        "name": "part",
    }


def _feature_trace(part: Part) -> Trace:
    return {
        "type": "scatter3d",
        "mode": "lines",
        **_coordinates(part.feature_lines),
        "line": {"color": "#2b3540", "width": 2.5},
        "hoverinfo": "skip",
        "showlegend": False,
    }


def _plain(text: str) -> str:
    """Text from a file, without the angle brackets in which Plotly reads markup."""
    return text.replace("<", "‹").replace(">", "›")


def _measurand_text(characteristic: PlannedCharacteristic) -> str:
    """What the pointer shows."""
    return (
        f"<b>{_plain(characteristic.id)}</b><br>nominal {length(characteristic.nominal_mm)} mm"
        f"<br>probability {probability(characteristic.probability)}<br>{_plain(characteristic.viewpoint or 'not met')}"
    )


def _measurand_trace(
    characteristics: list[PlannedCharacteristic], name: str, line: Trace, marker: Trace, *, labelled: bool
) -> Trace:
    """Measurands as lines with a third, middle point, where the pointer finds the line and the label stands."""
    measurands = [np.asarray(characteristic.measurand, dtype=float) for characteristic in characteristics]
    polylines = [np.stack([measurand[0], measurand.mean(axis=0), measurand[1]]) for measurand in measurands]
    texts = [text for characteristic in characteristics for text in [_measurand_text(characteristic)] * 3 + [""]]
    labels = [text for characteristic in characteristics for text in ("", _plain(characteristic.id), "", "")]
    return {
        "type": "scatter3d",
        "mode": "lines+markers+text" if labelled else "lines+markers",
        **_coordinates(polylines),
        "text": labels,
        "textposition": "top center",
        "textfont": {"color": line["color"], "size": 13, "family": FONT},
        "hovertext": texts,
        "hovertemplate": "%{hovertext}<extra></extra>",
        "line": line,
        "marker": marker,
        "name": _plain(name),
    }


def _measurand_traces(plan: Plan) -> list[Trace]:
    """One trace per viewpoint, and one, unmistakable, for the characteristics that are not met."""
    colours, markers = viewpoint_colours(plan), viewpoint_markers(plan)
    shown = [characteristic for characteristic in plan.characteristics if characteristic.measurand is not None]
    labelled = len(shown) <= LABEL_LIMIT
    traces = []
    for viewpoint in plan.viewpoints:
        mine = [characteristic for characteristic in shown if characteristic.viewpoint == viewpoint.id]
        colour = colours[viewpoint.id]
        marker = {"color": colour, "size": 5, "symbol": markers[viewpoint.id]}
        line = {"color": colour, "width": 8}
        traces.append(_measurand_trace(mine, viewpoint.id, line, marker, labelled=labelled))
    not_met = [characteristic for characteristic in shown if characteristic.status != "met"]
    if not_met:
        marker = {"color": NOT_MET_COLOUR, "size": 7, "symbol": "diamond"}
        line = {"color": NOT_MET_COLOUR, "width": 14}
        traces.append(_measurand_trace(not_met, "✗ not met", line, marker, labelled=labelled))
    return traces


def _frustum(viewpoint: PlannedViewpoint, camera: Camera, depth_mm: float) -> list[Polyline]:
    """The pyramid seen by the camera, as two closed strokes: its outline and its base."""
    columns, rows = camera.resolution
    corners_px = np.array([[-0.5, -0.5], [columns - 0.5, -0.5], [columns - 0.5, rows - 0.5], [-0.5, rows - 0.5]])
    if camera.field_radius_px is not None:  # the lens does not show the corners
        centre = np.asarray(camera.principal_point)
        reach = np.linalg.norm(corners_px - centre, axis=1, keepdims=True)
        corners_px = centre + (corners_px - centre) * np.minimum(0.999 * camera.field_radius_px / reach, 1.0)
    rays = np.column_stack([camera.from_pixels(corners_px) / camera.principal_distance_mm, np.ones(4)]) * depth_mm
    T = viewpoint.T_part_camera
    apex, base = T[:3, 3], rays @ T[:3, :3].T + T[:3, 3]
    return [
        np.stack([base[0], apex, base[1], base[2], apex, base[3], base[2]]),
        np.stack([base[1], base[0], base[3]]),
    ]


def _frustum_depth(plan: Plan, part: Part) -> float:
    """Height of the drawn pyramids, mm: large enough to be seen beside the part, but short of it."""
    low, high = part.mesh.bounds
    centre = (low + high) / 2
    distances = [float(np.linalg.norm(viewpoint.T_part_camera[:3, 3] - centre)) for viewpoint in plan.viewpoints]
    return min([0.45 * float(np.linalg.norm(high - low)), *(distance / 3 for distance in distances)])


def _camera_traces(plan: Plan, camera: Camera, size_mm: float) -> list[Trace]:
    colours = viewpoint_colours(plan)
    traces: list[Trace] = []
    for viewpoint in plan.viewpoints:
        colour, name = colours[viewpoint.id], _plain(viewpoint.id)
        apex = viewpoint.T_part_camera[:3, 3]
        shared = {"type": "scatter3d", "name": name, "legendgroup": name}
        frustum = _coordinates(_frustum(viewpoint, camera, size_mm))
        traces.append(
            {**shared, "mode": "lines", **frustum, "line": {"color": colour, "width": 4}, "hoverinfo": "skip"}
        )
        label = {axis: [round(float(apex[k]), 3)] for k, axis in enumerate("xyz")}
        traces.append(
            {
                **shared,
                **label,
                "mode": "markers+text",
                "text": [name],
                "textposition": "top center",
                "textfont": {"color": colour, "size": 15, "family": FONT},
                "marker": {"color": colour, "size": 4},
                "hovertemplate": f"<b>{name}</b><br>%{{x:.1f}}, %{{y:.1f}}, %{{z:.1f}} mm<extra></extra>",
                "showlegend": False,
            }
        )
    return traces


def _axis(title: str) -> Trace:
    return {
        "title": {"text": f"{title} / mm", "font": {"size": 12}},
        "tickfont": {"size": 10},
        "nticks": 6,
        "gridcolor": "#dde3ea",
        "zeroline": False,
        "showbackground": False,
        "showspikes": False,
    }


def _layout() -> Trace:
    return {
        "scene": {
            "aspectmode": "data",
            **{f"{axis}axis": _axis(axis) for axis in "xyz"},
            "domain": {"x": [0, 1], "y": [0.08, 1]},
            "camera": {"eye": {"x": 1.2, "y": -1.6, "z": 1.05}, "center": {"x": 0, "y": 0, "z": -0.08}},
        },
        "margin": {"l": 0, "r": 0, "t": 0, "b": 0},
        "paper_bgcolor": "#ffffff",
        "font": {"family": FONT, "color": INK},
        "showlegend": True,
        "legend": {"orientation": "h", "x": 0, "y": 0, "yanchor": "bottom"},
        "hoverlabel": {"align": "left"},
    }


def measurand_scene(plan: Plan) -> dict[str, Any]:
    """The pictures' data where the part is not at hand: measurands, and the cameras as points; as
    :func:`build_scene`.
    """
    cameras = [
        {
            "type": "scatter3d",
            "mode": "markers+text",
            **{axis: [float(viewpoint.T_part_camera[k, 3])] for k, axis in enumerate("xyz")},
            "text": [_plain(viewpoint.id)],
            "textposition": "top center",
            "marker": {"color": viewpoint_colours(plan)[viewpoint.id], "size": 6, "symbol": "square"},
            "name": _plain(viewpoint.id),
            "showlegend": False,
        }
        for viewpoint in plan.viewpoints
    ]
    return {"part": _measurand_traces(plan), "cameras": cameras, "layout": _layout()}


def build_scene(
    plan: Plan, part: Part, camera: Camera, triangle_limit: int = TRIANGLE_LIMIT
) -> tuple[dict[str, Any], str]:
    """Both pictures as data for Plotly, and a remark on what they leave out (empty where nothing).

    Returns
    -------
    ``part`` (traces of the part and the measurands), ``cameras`` (traces of the frusta), ``layout``; the remark.
    """
    mesh = picture_mesh(part.mesh, triangle_limit)
    shown, total = len(mesh.triangles), len(part.mesh.triangles)
    remark = "" if shown == total else f"The picture shows a coarser part: {shown:,} of {total:,} triangles."
    traces = [_mesh_trace(mesh), _feature_trace(part), *_measurand_traces(plan)]
    return {
        "part": traces,
        "cameras": _camera_traces(plan, camera, _frustum_depth(plan, part)),
        "layout": _layout(),
    }, remark
