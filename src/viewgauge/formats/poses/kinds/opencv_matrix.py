"""4x4 matrices in OpenCV's YAML."""

from __future__ import annotations

import re

import numpy as np

from ..pose_file import PoseConventions, PoseDocument, PoseFile
from .matrix_rows import poses_of_matrices

__all__ = ["OpenCvMatrix"]

_MATRIX = re.compile(
    r"^(?P<indent>[ \t]*)(?P<name>[\w-]+)\s*:\s*!!opencv-matrix\s*\n\s*rows:\s*(?P<rows>\d+)"
    r"\s*\n\s*cols:\s*(?P<cols>\d+)\s*\n\s*dt:\s*\"?(?P<type>\w+)\"?\s*\n\s*data:\s*\[(?P<data>[^\]]*)\]",
    re.M,
)


class OpenCvMatrix:
    """Every matrix of the file that is 4x4; another key is an error."""

    key = "opencv"
    name = "4x4 matrix in OpenCV's YAML"
    form = "!!opencv-matrix of 4 rows and 4 columns, one or more"
    cannot_say = "the unit of lengths: --unit"

    def recognises(self, document: PoseDocument) -> bool:
        """By a matrix of 4 x 4."""
        return any(match["rows"] == match["cols"] == "4" for match in _MATRIX.finditer(document.text))

    def read(self, document: PoseDocument, conventions: PoseConventions) -> PoseFile:
        """The poses, by the names of the matrices."""
        names, lines, matrices = [], [], []
        for match in _MATRIX.finditer(document.text):
            line = document.text.count("\n", 0, match.start("name")) + 1
            if (match["rows"], match["cols"]) != ("4", "4"):
                got = f"{match['rows']} x {match['cols']}"
                raise document.error("not a pose", line=line, key=match["name"], got=got, expected="4 x 4")
            try:
                numbers = np.array([float(cell) for cell in match["data"].split(",")])
            except ValueError:
                numbers = np.zeros(0)
            if len(numbers) != 16 or not np.isfinite(numbers).all() or np.abs(numbers).max() > 1e7:
                raise document.error("not 16 finite numbers", line=line, key=match["name"])
            names.append(match["name"])
            lines.append(line)
            matrices.append(numbers.reshape(4, 4))
        left = [
            (document.text.count("\n", 0, at.start()) + 1, at[1])
            for at in re.finditer(r"^([\w-]+)\s*:(?!\s*!!opencv-matrix)", _MATRIX.sub("", document.text), re.M)
            if at[1] not in ("calibration_time", "time", "date", "comment", "unit", "units")
        ]
        if left:
            raise document.error("a key is not used", key=left[0][1], hint="take it out", expected="4x4 matrices")
        poses, notes = poses_of_matrices(document, tuple(lines), np.array(matrices), conventions)
        return PoseFile(self.name, tuple(names), poses, notes)
