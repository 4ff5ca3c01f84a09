"""The JSON Schema of the inspection file: the examples keep to it, the usual mistakes do not."""

from __future__ import annotations

import copy
import json
from pathlib import Path

import jsonschema
import pytest
import yaml

from viewgauge.exceptions import InspectionFileError
from viewgauge.formats.inspection.inspection_file import read_inspection_file
from viewgauge.formats.inspection.schema import inspection_schema

ROOT = Path(__file__).resolve().parents[2]
SCHEMA = inspection_schema()
EXAMPLES = [path for path in sorted((ROOT / "examples").glob("*/*.yaml")) if path.name != "camera.yaml"]

EVERYTHING = """\
seed: 3
part:
  file: part.stl
  general_tolerance: 0.1 mm
  characteristics:
    - {id: A, points: [[0, 0, 40], [60, 0, 40]], unit: mm, tolerance: 0.1 mm, observed: whole}
    - {id: B, points: ["[0, 0, 40] mm", ["6 cm", 0 mm, "40 mm"]], tolerance: "[-0.05, 0.1] mm"}
    - {id: C, observed: ends}
    - {id: D, distance: [F12, F7], nominal: 15 mm, tolerance: 0.1 mm}
    - {id: E, diameter: H3, nominal: 9 mm, tolerance: "[0, 0.08] mm", observed: whole}
    - {id: F, position: H3, datums: [A, B], basic: "[15, 20] mm", zone: 0.2 mm}
  datums: {A: F1, B: F2}
camera:
  focal_length: 1 inch
  pixel_pitch: "[3.45, 3.5] um"
  resolution: "[2448, 2048] px"
  principal_point: "[1200, 1000.5] px"
  distortion: [-0.1, 0.02, 0, 0]
  distortion_model: radial-tangential
  calibration_uncertainty: {focal_length: 0.5 px, principal_point: "[0.8, 0.9] px", distortion: [0.01, 0.01, 0, 0]}
  edge_detector: {signal_to_noise: 50, blur: 0.7 px, samples: 5, edge_points: 14, clear_of_corner: 5 px}
  f_number: 8
  focus_distance: 45 cm
  blur_limit: 2 px
pose_uncertainty:
  translation: [0.1 mm, 0.2 mm, 0.3 mm]
  rotation: 0.02°
  common: {translation: 0 mm, rotation: "[1, 2, 3] mrad"}
  frame: {position: "[0, 0, -16] mm", quaternion: [0, 1, 0, 0]}
averaging: {viewpoints: 3}
requirement: {fraction_of_tolerance: 10 %, probability: 95 %}
candidates:
  distance: "[300, 600] mm"
  distances: 4
  directions: 50
  rolls: 3
  targets: 0
  cone: {axis: [0, 1, 1], half_angle: 60 deg}
  box: {lowest: "[-300, -300, 5] mm", highest: "[30, 30, 70] cm"}
  hemisphere: {centre: "[0, 0, 10] mm", axis: [0, 1, 1], radius: 0.6 m}
  forbidden:
    - {lowest: "[0, 0, 0] mm", highest: "[1, 1, 1] mm"}
  standoff: 0 mm
  viewpoints: poses.csv
observation: {margin: 0 px, minimum_length: 20 px, grazing_angle: 0.1 rad}
"""

OTHERS = [
    ("requirement", "{accuracy: 0.999, probability: 0.95}"),
    ("requirement", "{error: 0.05 mm, probability: 0.95}"),
    ("requirement", "{capability: {cgk: 1.33, bias: -0.002 mm, sigmas: 5.15, share: 20 %}}"),
    (
        "requirement",
        "{conformance: {rule: guarded, guard: 0.5, process: {standard_deviation: 20 um, offset: -0.005 mm}, "
        "consumer_risk: 1 %, producer_risk: 5 %}}",
    ),
    ("requirement", "{conformance: {rule: simple, process: {capability: 1.33}, producer_risk: 2 %}}"),
    ("camera.edge_detector", "{quantization: 0.1 px}"),
    ("camera.edge_detector", "{noise: 0.1 px, offset: 0.05 px}"),
    ("camera.pixel_pitch", "[3.45 um, 3.5 um]"),
    ("candidates", ""),
    ("observation", ""),
    ("part", ""),
]

# what is put in place of the value at a path; None takes the key away
MISTAKES = [
    ("color", "red"),
    ("camera.focal-length", "16 mm"),
    ("part.fiel", "a.step"),
    ("camera", None),
    ("camera.focal_length", None),
    ("camera.focal_length", "16"),
    ("camera.focal_length", "16 s"),
    ("camera.focal_length", "0 mm"),
    ("camera.focal_length", "-16 mm"),
    ("camera.focal_length", "'[1, 2] mm'"),
    ("camera.focal_length", "true"),
    ("camera.pixel_pitch", "[3.45, 3.5]"),
    ("camera.pixel_pitch", "'[3, 3, 3] um'"),
    ("camera.resolution", "[2448]"),
    ("camera.resolution", "[2448.5, 2048]"),
    ("camera.calibration", "camera.yaml"),
    ("camera.edge_detector", "{}"),
    ("camera.edge_detector", "{noise: 0.1 px, quantization: 0.1 px}"),
    ("camera.edge_detector", "{noise: 0.1 px, blur: 1 px}"),
    ("camera.edge_detector", "{signal_to_noise: 40}"),
    ("camera.edge_detector", "{nosie: 0.1 px}"),
    ("camera.edge_detector", "subpixel"),
    ("camera.calibration_uncertainty", "{focal_length: 1 px}"),
    ("pose_uncertainty.rotation", None),
    ("pose_uncertainty.rotation", "0.02 mm"),
    ("pose_uncertainty.translation", "'[1, 2] mm'"),
    ("pose_uncertainty.covariance", "c.yaml"),
    ("pose_uncertainty.common.rotation", None),
    ("pose_uncertainty.common.frame", "{}"),
    ("pose_uncertainty.frame.quaternion", "[1, 0, 0]"),
    ("pose_uncertainty.frame.position", "[0, 0, 1]"),
    ("pose_uncertainty.pivot", "'[0, 0, 1] mm'"),
    ("averaging.viewpoints", "1"),
    ("averaging.viewpoints", "many"),
    ("requirement.probability", None),
    ("requirement.error", "0.1 mm"),
    ("requirement.fraction_of_tolerance", "1 mm"),
    ("requirement", "{capability: {cg: 1, cgk: 1}}"),
    ("requirement", "{capability: {cg: 1}, probability: 0.9}"),
    ("requirement", "{conformance: {rule: simple, process: {capability: 1}}}"),
    ("requirement", "{conformance: {rule: simple, guard: 1, process: {capability: 1}, producer_risk: 1 %}}"),
    ("candidates.distance", "[300, 600]"),
    ("candidates.rolls", "0"),
    ("candidates.rolls", "1.5"),
    ("candidates.cone.half_angle", None),
    ("candidates.cone.axis", "'[0, 0, 1] mm'"),
    ("candidates.box.highest", None),
    ("candidates.forbidden", "{}"),
    ("candidates.forbidden", "[7]"),
    ("observation.margin", "-1 px"),
    ("seed", "-1"),
    ("part.characteristics", "[{id: A}]"),
    ("part.characteristics", "[{id: 5, tolerance: 0.1 mm}]"),
    ("part.characteristics", "[{id: A, points: [[0, 0, 0], [1, 0, 0]]}]"),
    ("part.characteristics", "[{id: A, points: [[0, 0, 0]], unit: mm}]"),
    ("part.characteristics", "[{id: A, unit: mm, tolerance: 0.1 mm}]"),
    ("part.characteristics", "[{id: A, tolerance: -0.1 mm}]"),
    ("part.characteristics", "[{id: A, observed: middle}]"),
    ("part.characteristics", "[{id: A, distance: [F1], tolerance: 0.1 mm}]"),
    ("part.characteristics", "[{id: A, diameter: [H1], tolerance: 0.1 mm}]"),
    ("part.characteristics", "[{id: A, nominal: 8 mm, tolerance: 0.1 mm}]"),
    ("part.characteristics", "[{id: A, diameter: H1, zone: 0.1 mm}]"),
    ("part.characteristics", "[{id: A, position: H1, basic: 15}]"),
    ("part.datums", "[F1, F2]"),
]


def valid(document):
    return jsonschema.Draft7Validator(SCHEMA).is_valid(document)


def changed(key, text):
    document = copy.deepcopy(yaml.safe_load(EVERYTHING))
    *sections, last = key.split(".")
    place = document
    for section in sections:
        place = place[section]
    if text is None:
        del place[last]
    else:
        place[last] = yaml.safe_load(text)
    return document


def read(folder, document):
    path = folder / "inspection.yaml"
    path.write_text(yaml.safe_dump(document, allow_unicode=True))
    return read_inspection_file(path)


def keys_without_description(schema, path=""):
    for name, below in schema.get("properties", {}).items():
        if below is False:
            continue
        here = f"{path}.{name}"
        if not below.get("title") or len(below.get("description", "")) < 12:
            yield here
        yield from keys_without_description(below, here)
        yield from keys_without_description(below.get("items", {}), here)
        for branch in ("then", "else"):
            yield from keys_without_description(below.get(branch, {}), here)


def test_it_is_a_schema_and_every_key_is_described():
    jsonschema.Draft7Validator.check_schema(SCHEMA)
    assert list(keys_without_description(SCHEMA)) == []


def test_the_schema_of_the_project_is_this_one():
    written = json.loads((ROOT / "docs" / "inspection.schema.json").read_text(encoding="utf-8"))
    assert written == SCHEMA, "write it again: viewgauge schema -o docs/inspection.schema.json"


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: f"{path.parent.name}/{path.name}")
def test_the_examples_keep_to_it_and_name_it(path):
    text = path.read_text(encoding="utf-8")
    jsonschema.Draft7Validator(SCHEMA).validate(yaml.safe_load(text))
    assert text.startswith("# yaml-language-server: $schema=../../docs/inspection.schema.json\n")
    assert (path.parent / "../../docs/inspection.schema.json").is_file()


def test_every_key_at_once_is_valid_and_read(tmp_path):
    document = yaml.safe_load(EVERYTHING)
    jsonschema.Draft7Validator(SCHEMA).validate(document)
    read(tmp_path, document)


@pytest.mark.parametrize(("key", "text"), OTHERS)
def test_other_ways_are_valid_and_read(tmp_path, key, text):
    document = changed(key, text)
    jsonschema.Draft7Validator(SCHEMA).validate(document)
    read(tmp_path, document)


def test_a_calibrated_camera_is_valid():
    assert valid(changed("camera", "{calibration: camera.yaml, calibration_camera: cam0, pixel_pitch: 3.45 um}"))
    assert not valid(changed("camera", "{calibration: camera.yaml, focal_length: 16 mm, pixel_pitch: 3.45 um}"))
    assert not valid(changed("camera", "{calibration: camera.yaml}"))


@pytest.mark.parametrize(("key", "text"), MISTAKES)
def test_a_mistake_is_invalid_for_the_schema_and_for_the_reader(tmp_path, key, text):
    document = changed(key, text)
    assert not valid(document)
    with pytest.raises(InspectionFileError):
        read(tmp_path, document)
