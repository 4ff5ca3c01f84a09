"""The table viewpoint x characteristic: its contract, the best measurand, and values worked out by hand."""

from __future__ import annotations

from dataclasses import fields

import numpy as np
import pytest
import xarray as xr

from viewgauge.evaluation import COLUMNS, Requirement, Setup, as_dataset
from viewgauge.evaluation.evaluator import Evaluator
from viewgauge.geometry import PoseError, look_at
from viewgauge.part import Characteristic, LengthBetweenPoints, Mesh
from viewgauge.sensors import Camera
from viewgauge.visibility import REASONS, ObservationLimits

CAMERA = Camera(16.0, (0.00345, 0.00345), (2448, 2048), edge_resolution_px=0.1)
POSE_ERROR = PoseError.from_standard_deviations(translation_mm=0.1, rotation_rad=3e-4)
SURE = Requirement("accuracy", 0.999, 0.9)
UP = [[0.0, 0.0, 1.0]]


def block(*boxes) -> Mesh:
    """One mesh of several boxes, each given by its lowest and highest corner."""
    import trimesh

    made = trimesh.util.concatenate([trimesh.creation.box(bounds=box) for box in boxes])
    return Mesh(np.array(made.vertices), np.array(made.faces, dtype=np.int64))


STEPPED = block([[0, 0, 0], [100, 60, 20]], [[0, 0, 0], [60, 60, 40]])


def measurand(start, end, normals=UP) -> LengthBetweenPoints:
    return LengthBetweenPoints(*(np.array(a, dtype=float) for a in (start, end, normals, normals)))


def characteristic(name, *measurands, nominal=None, tolerance=(-0.1, 0.1), observed="ends") -> Characteristic:
    nominal = measurands[0].length_mm if nominal is None else nominal
    return Characteristic(name, "length", nominal, tolerance, measurands, observed)


FRONT, BACK, SIDE = [[0, 0, 1.0], [0, -1, 0]], [[0, 0, 1.0], [0, 1, 0]], [[0, 0, 1.0], [1, 0, 0]]
CHARACTERISTICS = (
    characteristic("upper", measurand([0, 0, 40], [60, 0, 40], FRONT), measurand([0, 60, 40], [60, 60, 40], BACK)),
    characteristic("foot", measurand([60, 10, 20], [60, 50, 20], SIDE)),
    characteristic(
        "depth",
        measurand([100, 0, 20], [100, 60, 20], SIDE),
        measurand([60, 0, 40], [60, 60, 40], SIDE),
        measurand([100, 0, 0], [100, 60, 0], [[1.0, 0, 0], [0, 0, -1]]),
    ),
)


def around(count, seed=5):
    """Camera poses all around the block, some of them looking past it."""
    rng = np.random.default_rng(seed)
    direction = rng.normal(size=(count, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    eyes = [50, 30, 20] + rng.uniform(200, 400, (count, 1)) * direction
    return look_at(eyes, np.array([50, 30, 20]) + rng.normal(0, 25, (count, 3)), rng.uniform(0, 3, count))


LIMITS = ObservationLimits()


def table_of(
    poses,
    characteristics=CHARACTERISTICS,
    camera=CAMERA,
    pose_error=POSE_ERROR,
    requirement=SURE,
    mesh=STEPPED,
    limits=LIMITS,
    **options,
):
    evaluator = Evaluator(characteristics, mesh, Setup(camera, pose_error, requirement, limits), **options)
    values = evaluator.table(poses)
    columns = {name: getattr(values, name) for name in (*COLUMNS, "measurand", "validity") if name != "accepted"}
    columns["accepted"] = values.visible & (values.probability >= requirement.probability)
    names = [f"C{k}" for k in range(len(poses))]
    attrs = {"method": "joint", "required_probability": requirement.probability}
    return as_dataset(columns, names, characteristics, evaluator.allowed_error_mm, attrs)


def above(x, y, height, *, turned=False):
    """A camera at a height that acquisitions straight down; its image's u is part x, or part y where turned."""
    right, down = ([0, 1, 0], [1, 0, 0]) if turned else ([1, 0, 0], [0, -1, 0])
    pose = np.eye(4)
    pose[:3, 0], pose[:3, 1], pose[:3, 2], pose[:3, 3] = right, down, [0, 0, -1], [x, y, height]
    return pose[None]


@pytest.fixture(scope="module")
def table() -> xr.Dataset:
    return table_of(around(400))


def test_the_contract(table):
    contract = (
        "visible, reason, image_length_px, angle_rad, relative_tolerance, sigma_displacement_px, "
        "sigma_quantization_px, probability, expected_accuracy, accepted"
    )
    assert list(COLUMNS) == contract.split(", ")
    assert set(table.data_vars) == {*COLUMNS, "measurand", "validity"}
    for name in table.data_vars:
        assert table[name].dims == ("viewpoint", "characteristic")
    assert table["viewpoint"].values.tolist() == [f"C{k}" for k in range(400)]
    assert table["characteristic"].values.tolist() == ["upper", "foot", "depth"]
    np.testing.assert_array_equal(table["nominal_mm"], [60, 40, 60])
    np.testing.assert_allclose(table["allowed_error_mm"], [0.06, 0.04, 0.06])
    assert table["visible"].dtype == table["accepted"].dtype == bool
    assert table.attrs == {"method": "joint", "required_probability": 0.9}


def test_reasons_and_what_follows_from_them(table):
    visible, probability = table["visible"].values, table["probability"].values
    assert set(np.unique(table["reason"].values.astype(str))) <= set(REASONS)
    assert {"out_of_view", "facing_away", "occluded", ""} <= set(table["reason"].values.ravel())
    np.testing.assert_array_equal(visible, table["reason"].values == "")
    assert 0.05 < visible.mean() < 0.95
    for name in ("probability", "expected_accuracy"):
        assert (table[name].values[~visible] == 0).all(), "0 and not NaN"
        assert ((table[name].values >= 0) & (table[name].values <= 1)).all()
    np.testing.assert_array_equal(table["accepted"].values, visible & (probability >= 0.9))
    assert 0 < table["accepted"].values.sum() < visible.sum()
    for name in ("sigma_displacement_px", "sigma_quantization_px", "image_length_px", "angle_rad"):
        assert (table[name].values[visible] > (-4 if name == "angle_rad" else 0)).all()
    assert np.isfinite(table["relative_tolerance"].values).all()


def test_accepted_includes_the_required_probability_itself(table):
    reached = float(table["probability"].max())
    for required, count in ((reached, 1), (np.nextafter(reached, 1), 0)):
        again = table_of(around(400), requirement=Requirement("accuracy", 0.999, required))
        assert again["accepted"].values.sum() == count


def test_a_required_probability_accepts_nothing_that_is_not_visible():
    assert not table_of(around(50), requirement=Requirement("accuracy", 0.999, 1e-300))["accepted"].values.all()


def test_the_best_measurand_is_the_one_a_search_by_hand_finds(table):
    for d in CHARACTERISTICS:
        alone = [table_of(around(400), [characteristic(d.id, g)]).isel(characteristic=0) for g in d.measurands]
        ours = table.sel(characteristic=d.id)
        rank = [{name: k for k, name in enumerate(REASONS)}[r] for a in alone for r in a["reason"].values]
        rank = np.array(rank).reshape(len(alone), -1)
        probability = np.stack([a["probability"].values for a in alone])
        for k in range(400):
            chosen = int(ours["measurand"].values[k])
            if (rank[:, k] == len(REASONS) - 1).any():
                assert ours["visible"].values[k]
                assert ours["probability"].values[k] == probability[:, k].max() == probability[chosen, k]
            else:
                assert not ours["visible"].values[k]
                assert rank[chosen, k] == rank[:, k].max(), "the one that got farthest tells why"
            for name in COLUMNS:
                a, b = ours[name].values[k], alone[chosen][name].values[k]
                assert a == b or (a != a and b != b), name


def test_how_viewpoints_are_cut_in_pieces_changes_nothing():
    poses = around(700)
    whole = table_of(poses)
    for size in (1, 97, 256, 300):
        pieces = [table_of(poses[k : k + size]) for k in range(0, len(poses), size)][: 40 if size == 1 else None]
        together = xr.concat(pieces, "viewpoint")
        part = whole.isel(viewpoint=slice(0, together.sizes["viewpoint"]))
        for name in (*COLUMNS, "measurand", "validity"):
            if together[name].dtype == float:
                np.testing.assert_allclose(together[name].values, part[name].values, rtol=0, atol=1e-12)
            else:
                np.testing.assert_array_equal(together[name].values, part[name].values)


def test_threads_do_not_change_a_bit():
    poses = around(1500)
    blocks = [
        Evaluator(CHARACTERISTICS, STEPPED, Setup(CAMERA, POSE_ERROR, SURE), threads=threads).table(poses)
        for threads in (1, 2, 5)
    ]
    for other in blocks[1:]:
        for field in fields(blocks[0]):
            np.testing.assert_array_equal(getattr(other, field.name), getattr(blocks[0], field.name))


def test_what_is_accepted_is_the_accepted_part_of_the_table():
    poses = around(600)
    evaluator = Evaluator(CHARACTERISTICS, STEPPED, Setup(CAMERA, POSE_ERROR, SURE))
    accepted, table = evaluator.accepted(poses), evaluator.table(poses)
    sure = table.visible & (table.probability >= SURE.probability)
    assert 0.02 < sure.mean() < 0.98
    np.testing.assert_array_equal(accepted.probability, np.where(sure, table.probability, 0.0))
    assert not (accepted.certain & ~sure).any()
    assert not (accepted.certain & (table.validity > 0)).any(), "what carries a warning is not certain"


def test_no_viewpoint_and_no_characteristic():
    assert dict(table_of(around(0)).sizes) == {"viewpoint": 0, "characteristic": 3}
    assert dict(table_of(around(3), ()).sizes) == {"viewpoint": 3, "characteristic": 0}


@pytest.mark.parametrize(
    ("requirement", "expected"),
    [
        (Requirement("accuracy", 0.998, 0.9), 0.002 * 10.0 / 9.0),
        (Requirement("error", 0.05, 0.9), 0.05 / 9.0),
        (Requirement("fraction_of_tolerance", 0.1, 0.9), 0.1 * (0.02 + 0.10) / 2 / 9.0),
    ],
)
def test_relative_tolerance_refers_to_the_measurand_that_is_imaged(requirement, expected):
    # a characteristic of 10 mm that is measured by a chord of 9 mm: the error allowed in mm is that of the
    # characteristic
    chord = characteristic("chord", measurand([10, 10, 40], [19, 10, 40]), nominal=10.0, tolerance=(-0.02, 0.10))
    row = table_of(above(15, 10, 340), [chord], requirement=requirement).isel(viewpoint=0, characteristic=0)
    assert float(row["relative_tolerance"]) == pytest.approx(expected, rel=1e-12)
    assert bool(row["visible"])


def test_a_fraction_of_no_tolerance_is_refused():
    basic = characteristic("basic", measurand([10, 10, 40], [19, 10, 40]), tolerance=None)
    with pytest.raises(ValueError, match="basic has no tolerance"):
        table_of(above(15, 10, 340), [basic], requirement=Requirement("fraction_of_tolerance", 0.1, 0.9))


@pytest.mark.parametrize("turned", [False, True])
def test_pixel_columns_by_hand_also_where_pixels_are_not_square(turned):
    # 30 mm along part x, 300 mm below a lens of 15 mm: 1.5 mm in the image, along u, or along v where turned;
    # the head errs along the optical axis only, by 0.3 mm: one part in a thousand of the distance
    pitch_u, pitch_v = 0.003, 0.006
    camera = Camera(15.0, (pitch_u, pitch_v), (2000, 2000), edge_resolution_px=0.5)
    pose_error = PoseError(np.diag([0, 0, 0.3**2, 0, 0, 0]))
    line = characteristic("line", measurand([10, 30, 40], [40, 30, 40]))
    row = table_of(above(25, 30, 340, turned=turned), [line], camera, pose_error).isel(viewpoint=0, characteristic=0)
    length = 1.5 / (pitch_v if turned else pitch_u)
    assert float(row["image_length_px"]) == pytest.approx(length, rel=1e-12)
    assert np.cos(float(row["angle_rad"])) == pytest.approx(0.0 if turned else 1.0, abs=1e-12)
    assert float(row["sigma_displacement_px"]) == pytest.approx(length / 1000, rel=1e-9)
    # two uniform errors of half a px each, subtracted: a triangle of standard deviation 0.5 / sqrt(6) px
    assert float(row["sigma_quantization_px"]) == pytest.approx(0.5 / np.sqrt(6), rel=1e-9)


def test_expected_accuracy_is_one_less_the_mean_relative_error():
    # no pixels, and a normal error of one part in a thousand: its mean absolute value is sqrt(2/pi) of that
    camera = Camera(15.0, (0.003, 0.003), (2000, 2000), edge_resolution_px=0.0)
    pose_error = PoseError(np.diag([0, 0, 0.3**2, 0, 0, 0]))
    line = characteristic("line", measurand([10, 30, 40], [40, 30, 40]))
    row = table_of(above(25, 30, 340), [line], camera, pose_error).isel(viewpoint=0, characteristic=0)
    assert float(row["expected_accuracy"]) == pytest.approx(1 - 1e-3 * np.sqrt(2 / np.pi), rel=1e-9)
    assert float(row["sigma_quantization_px"]) == 0.0
    # allowed is one part in a thousand: one standard deviation
    assert float(row["probability"]) == pytest.approx(0.682689492137086, abs=1e-9)


@pytest.mark.parametrize(
    ("start", "end", "eye"),
    [
        ([60, 30, 40], [100, 30, 20], [-140, 30, 140]),  # from one step's edge to the next: equal but for rounding
        ([60, 30, 40], [60, 30, 20], [60, 30, 340]),  # down the step's wall: exactly equal
    ],
)
def test_a_measurand_seen_end_on_has_no_length_and_is_never_right(start, end, eye):
    line = characteristic("line", measurand(start, end, SIDE))
    pose = look_at(np.array(eye, dtype=float), start)[None]
    row = table_of(pose, [line], limits=ObservationLimits(minimum_length_px=0.0)).isel(viewpoint=0, characteristic=0)
    assert bool(row["visible"])
    assert float(row["image_length_px"]) == pytest.approx(0.0, abs=1e-9)
    assert float(row["probability"]) == pytest.approx(0.0, abs=1e-6)
    assert float(row["expected_accuracy"]) == 0.0
    assert np.isfinite(float(row["sigma_displacement_px"]))
    assert np.isfinite(float(row["sigma_quantization_px"]))


def test_a_method_that_is_not_known_is_refused():
    with pytest.raises(ValueError, match="joint or independent"):
        table_of(above(25, 30, 340), method="exact")
