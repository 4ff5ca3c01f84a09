"""Usual sensor formats and focal lengths, from which a camera is specified; no maker's products."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["FOCAL_LENGTHS_MM", "SENSORS", "SensorFormat"]


@dataclass(frozen=True)
class SensorFormat:
    """A sensor: its name, columns and rows, and the size of a (square) pixel, mm."""

    name: str
    resolution: tuple[int, int]
    pixel_pitch_mm: float


SENSORS = (
    SensorFormat("0.4 MP, 1/2.9 in", (720, 540), 0.0069),
    SensorFormat("1.6 MP, 1/2.9 in", (1440, 1080), 0.00345),
    SensorFormat("5 MP, 2/3 in", (2448, 2048), 0.00345),
    SensorFormat("12 MP, 1.1 in", (4096, 3000), 0.00345),
    SensorFormat("20 MP, 1 in", (5472, 3648), 0.0024),
    SensorFormat("25 MP, 1.1 in", (5120, 5120), 0.0025),
)
"""Formats that several makers sell, fewest pixels first."""

FOCAL_LENGTHS_MM = (8.0, 12.0, 16.0, 25.0, 35.0, 50.0)
