"""The part, the measurands and the cameras in three dimensions, for one visitor."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import viser
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from ..planning.candidates.direction_map import DirectionMap
from ..planning.improve.answers import Answers
from ..planning.inspection import Inspection
from ..report.palette import NOT_MET_COLOUR, UNSEEN_COLOUR, colours_of, probability_colour
from ..report.pictures.simplify import picture_mesh
from .picking import APEX_TO_BASE, picked
from .tone import before_tone_curve

__all__ = ["Scene", "rgb"]

_FIELD_OF_VIEW_RAD, _ASIDE_RAD = 0.7, 0.45
_NARROW = 0.75  # width of the picture between the panels, of its height
_TRIANGLES, _LABELS = 150_000, 40
_PART, _EDGES = (0xC3, 0xCA, 0xD3), (0x2B, 0x35, 0x40)
_OCTAHEDRON = (
    np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], dtype=np.float32),
    np.array([[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]], dtype=np.uint32),
)


def rgb(colour: str) -> tuple[int, int, int]:
    """Of a hexadecimal colour."""
    return int(colour[1:3], 16), int(colour[3:5], 16), int(colour[5:7], 16)


class Scene:
    """What a visitor sees of a part; everything has one place in the tree and is replaced there."""

    def __init__(self, client: viser.ClientHandle) -> None:
        self._client, self._scene = client, client.scene
        self._scene.set_up_direction("+z")
        self._scene.configure_default_lights(cast_shadow=False)
        self._size_mm, self._centre = 1.0, np.zeros(3)
        self._frusta: dict[str, Any] = {}
        self._shown: dict[str, Any] = {}

    def show_part(self, inspection: Inspection) -> None:
        """The part, and the view of it from a corner."""
        self.clear()
        mesh = picture_mesh(inspection.part.mesh, _TRIANGLES)
        low, high = inspection.part.mesh.bounds
        self._size_mm, centre = float(np.linalg.norm(high - low)), (low + high) / 2
        surface = self._scene.add_mesh_simple(
            "/part", mesh.vertices, mesh.triangles, color=_PART, flat_shading=True, side="double", cast_shadow=False
        )
        self._put("/part", surface)
        pieces = [np.stack([line[:-1], line[1:]], axis=1) for line in inspection.part.feature_lines if len(line) > 1]
        self._lines("/edges", np.concatenate(pieces) if pieces else None, _EDGES, 1.5)
        self._centre = centre
        camera = self._client.camera
        camera.near, camera.far, camera.fov = self._size_mm / 500, self._size_mm * 200, _FIELD_OF_VIEW_RAD
        self.look_at_part()

    def see_through(self, yes: bool) -> None:
        """Let measurands behind the part's surface be seen."""
        self._shown["/part"].opacity = 0.35 if yes else 1.0

    def look_at_part(self) -> None:
        """From above a corner."""
        self._look(self._centre + self._size_mm * np.array([1.0, -1.5, 1.05]), self._centre)

    def look_at_all(self, viewpoints: Mapping[str, NDArray[np.float64]]) -> None:
        """At the part and all cameras, from beside them."""
        if not viewpoints:
            self.look_at_part()
            return
        eyes = np.array([T[:3, 3] for T in viewpoints.values()]) - self._centre
        mean = (eyes / np.linalg.norm(eyes, axis=1, keepdims=True)).mean(axis=0)
        if np.linalg.norm(mean) < 0.2:  # they stand all around
            mean = np.array([0.55, -0.65, 0.5])
        c, s = np.cos(_ASIDE_RAD), np.sin(_ASIDE_RAD)
        away = np.array([c * mean[0] - s * mean[1], s * mean[0] + c * mean[1], max(abs(mean[2]), 0.35)])
        away /= np.linalg.norm(away)
        low = np.minimum(eyes.min(axis=0), -self._size_mm / 2)
        high = np.maximum(eyes.max(axis=0), self._size_mm / 2)
        middle = self._centre + (low + high) / 2
        radius = 0.5 * float(np.linalg.norm(high - low)) + 0.1 * self._size_mm
        self._look(middle + radius / np.tan(_NARROW * _FIELD_OF_VIEW_RAD / 2) * away, middle)

    def look_through(self, T_part_camera: NDArray[np.float64]) -> None:
        """As a viewpoint's camera sees the part."""
        self._look(T_part_camera[:3, 3], self._centre)

    def _look(self, eye: NDArray[np.float64], at: NDArray[np.float64]) -> None:
        with self._client.atomic():
            camera = self._client.camera
            camera.up_direction = (0.0, 0.0, 1.0)
            camera.position = tuple(eye)
            camera.look_at = tuple(at)

    def clear(self) -> None:
        """Take everything away."""
        for name in list(self._shown):
            self._take_away(name)
        self._frusta.clear()

    def show_answers(self, answers: Answers, chosen: str | None, *, names: bool) -> None:
        """The measurands, coloured by probability; what is not met is thick and has diamonds."""
        required = answers.setup.requirement.probability
        groups: dict[str, list[tuple[NDArray[np.float64], str]]] = {"met": [], "not_met": [], "unseen": []}
        labels: list[tuple[str, NDArray[np.float64]]] = []
        for answer in answers.characteristics:
            ends = np.stack([answer.measurand.start, answer.measurand.end])
            seen = answer.viewpoint is not None
            colour = probability_colour(answer.probability, required) if seen else UNSEEN_COLOUR
            groups["met" if answer.met else "not_met" if seen else "unseen"].append((ends, colour))
            if names or answer.characteristic.id == chosen:
                mark = "" if answer.met else "✗ "
                labels.append((mark + answer.characteristic.id, ends.mean(axis=0)))
        widths = {"met": 5.0, "not_met": 9.0, "unseen": 7.0}
        with self._client.atomic():
            for group, measurands in groups.items():
                segments = np.array([ends for ends, _ in measurands]) if measurands else None
                colours = np.array([[rgb(colour)] * 2 for _, colour in measurands], dtype=np.uint8)
                self._lines(f"/measurands/{group}", segments, colours, widths[group])
                marked = [(ends, NOT_MET_COLOUR) for ends, _ in measurands] if group == "unseen" else measurands
                self._ends(f"/measurands/{group}_ends", marked, 0.008 if group == "met" else 0.013)
            self._halo(answers, chosen)
            self._labels(labels[:_LABELS])

    def _halo(self, answers: Answers, chosen: str | None) -> None:
        """Around the chosen characteristic."""
        ends = [
            np.stack([a.measurand.start, a.measurand.end])
            for a in answers.characteristics
            if a.characteristic.id == chosen
        ]
        self._lines("/measurands/chosen", np.array(ends) if ends else None, (0xFF, 0xD0, 0x00), 14.0)

    def show_viewpoints(self, answers: Answers, chosen: str | None) -> None:
        """The cameras as pyramids; the chosen one with thicker lines."""
        camera = answers.setup.camera
        columns, rows = camera.resolution
        height = rows * camera.pixel_pitch_mm[1]
        aspect = columns * camera.pixel_pitch_mm[0] / height
        fov = 2 * float(np.arctan2(height / 2, camera.principal_distance_mm))
        colours = colours_of(answers.viewpoints)
        with self._client.atomic():
            for name in set(self._frusta) - set(answers.viewpoints):
                self._take_away(f"/viewpoints/{name}")
                self._frusta.pop(name)
            for name, T in answers.viewpoints.items():
                drawn_as = (round(fov, 9), round(aspect, 9), name == chosen)
                if self._frusta.get(name) != drawn_as:
                    self._frusta[name] = drawn_as
                    self._put(
                        f"/viewpoints/{name}",
                        self._scene.add_camera_frustum(
                            f"/viewpoints/{name}",
                            fov,
                            aspect,
                            scale=APEX_TO_BASE * self._size_mm,
                            thickness=5.0 if name == chosen else 2.5,
                            thickness_units="screen",
                            color=rgb(colours[name]),
                        ),
                    )
                    self._put(f"/viewpoints/{name}/name", self._scene.add_label(f"/viewpoints/{name}/name", name))
                handle = self._shown[f"/viewpoints/{name}"]
                handle.wxyz, handle.position = _quaternions(T), T[:3, 3]

    def show_candidates(self, poses: NDArray[np.float64] | None, share: NDArray[np.float64]) -> None:
        """Candidate viewpoints as small pyramids, the bluer the more they measure; None for none."""
        if poses is None or not len(poses):
            self._take_away("/candidates")
            return
        vertices = np.array([[0, 0, 0], [-0.6, -0.45, 1], [0.6, -0.45, 1], [0.6, 0.45, 1], [-0.6, 0.45, 1]])
        faces = np.array([[0, 2, 1], [0, 3, 2], [0, 4, 3], [0, 1, 4], [1, 2, 3], [1, 3, 4]], dtype=np.uint32)
        colours = np.array([rgb(probability_colour(float(s), 0.5)) for s in share], dtype=np.uint8)
        self._put(
            "/candidates",
            self._scene.add_batched_meshes_simple(
                "/candidates",
                (0.05 * self._size_mm * vertices).astype(np.float32),
                faces,
                _quaternions(poses),
                poses[:, :3, 3],
                batched_colors=before_tone_curve(colours, of_vertices=True),
                flat_shading=True,
                side="double",
                opacity=0.65,
                cast_shadow=False,
                receive_shadow=False,
                lod="off",
            ),
        )

    def show_directions(self, found: DirectionMap | None, required: float) -> None:
        """Directions around the part, a small sphere, coloured by the probability of one characteristic; None for
        none.
        """
        if found is None:
            self._take_away("/directions")
            return
        seen = found.reason == ""
        colours = [
            rgb(probability_colour(float(p), required) if s else UNSEEN_COLOUR)
            for p, s in zip(found.probability, seen, strict=True)
        ]
        self._put(
            "/directions",
            self._scene.add_point_cloud(
                "/directions",
                found.target_mm + self._size_mm * found.directions,
                np.array(colours, dtype=np.uint8),
                point_size=0.03 * self._size_mm,
                point_shape="circle",
            ),
        )

    def drag_handle(self, T_part_camera: NDArray[np.float64] | None) -> Any:
        """Something to drag a camera by; None takes it away."""
        if T_part_camera is None:
            self._take_away("/drag")
            return None
        handle = self._scene.add_transform_controls(
            "/drag",
            scale=0.22 * self._size_mm,
            wxyz=_quaternions(T_part_camera),
            position=T_part_camera[:3, 3],
            translation_limits=((-1e6, 1e6),) * 3,
            depth_test=False,
        )
        self._put("/drag", handle)
        return handle

    def picked(
        self, answers: Answers, origin: NDArray[np.float64], direction: NDArray[np.float64]
    ) -> tuple[str, str] | None:
        """What a click along a ray means (:func:`~viewgauge.web.picking.picked`)."""
        return picked(answers, self._size_mm, origin, direction)

    def _lines(
        self,
        name: str,
        segments: NDArray[np.float64] | None,
        colours: NDArray[np.uint8] | tuple[int, int, int],
        width: float,
    ) -> None:
        if segments is None:
            self._take_away(name)
        else:
            drawn = before_tone_curve(np.asarray(colours, dtype=np.uint8), of_vertices=np.ndim(colours) > 1)
            handle = self._scene.add_line_segments(name, segments, drawn, thickness=width, thickness_units="screen")
            self._put(name, handle)

    def _ends(self, name: str, measurands: list[tuple[NDArray[np.float64], str]], size: float) -> None:
        if not measurands:
            self._take_away(name)
            return
        vertices, faces = _OCTAHEDRON
        places = np.concatenate([ends for ends, _ in measurands])
        colours = np.array([rgb(colour) for _, colour in measurands for _ in range(2)], dtype=np.uint8)
        self._put(
            name,
            self._scene.add_batched_meshes_simple(
                name,
                vertices * np.float32(size * self._size_mm),
                faces,
                np.tile([1.0, 0.0, 0.0, 0.0], (len(places), 1)),
                places,
                batched_colors=before_tone_curve(colours, of_vertices=True),
                flat_shading=True,
                cast_shadow=False,
                lod="off",
            ),
        )

    def _labels(self, labels: list[tuple[str, NDArray[np.float64]]]) -> None:
        for name in [name for name in self._shown if name.startswith("/names/")]:
            self._take_away(name)
        for k, (text, place) in enumerate(labels):
            self._put(f"/names/{k}", self._scene.add_label(f"/names/{k}", text, position=place))

    def _put(self, name: str, handle: Any) -> None:
        """What has a name already is replaced by viser itself."""
        self._shown[name] = handle

    def _take_away(self, name: str) -> None:
        handle = self._shown.pop(name, None)
        for child in [other for other in self._shown if other.startswith(f"{name}/")]:
            self._shown.pop(child)  # viser takes it away with its parent
        if handle is not None:
            handle.remove()


def _quaternions(T_a_b: NDArray[np.float64]) -> NDArray[np.float64]:
    """Unit quaternions ``(..., 4)``, scalar first, of poses ``(..., 4, 4)``: how viser takes rotations."""
    return np.asarray(Rotation.from_matrix(T_a_b[..., :3, :3]).as_quat(canonical=True, scalar_first=True))
