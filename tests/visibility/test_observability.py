"""What is seen and what is not, against an oracle in exact rational arithmetic, and every reason by itself."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from fractions import Fraction
from functools import cache

import numpy as np
import pytest
from box_solids import BOX, POCKET, SLOTTED, STEPPED, BoxSolid, edge_points

from viewgauge.exceptions import InputError
from viewgauge.geometry import VIEWS, look_at, view_block
from viewgauge.part import Characteristic, LengthBetweenPoints, Mesh
from viewgauge.part.measurand_table import MeasurandTable
from viewgauge.sensors import Camera
from viewgauge.visibility import REASONS, VISIBLE, ObservationLimits, Occluder, SightLines, observe

# a view of almost half the space, so that nothing but the part decides
WIDE = Camera(focal_length_mm=1.0, pixel_pitch_mm=(0.01, 0.01), resolution=(10_000_000, 10_000_000))
EVERYTHING = ObservationLimits(margin_px=0.0, minimum_length_px=0.0, grazing_angle_rad=0.0)
PLAIN = Camera(focal_length_mm=10.0, pixel_pitch_mm=(0.01, 0.01), resolution=(1000, 800))
MARGIN = Fraction(1, 2000)  # of the cells' size: fifty times the documented clearance of these solids
SOLIDS = {"box": BOX, "steps": STEPPED, "slot": SLOTTED, "pocket": POCKET}


def measurands(*pairs, observed="ends"):
    """A table of measurands from (start, end, normals at start, normals at end)."""
    return MeasurandTable.of(
        [
            Characteristic(
                str(k),
                "measurand",
                1.0,
                None,
                (LengthBetweenPoints(*(np.array(a, dtype=float) for a in pair)),),
                observed,
            )
            for k, pair in enumerate(pairs)
        ]
    )


def of_points(solid: BoxSolid, points, scale=1.0, shift=(0.0, 0.0, 0.0)):
    """Measurands whose two ends are the same point, so that a verdict is about that point alone."""
    placed = [np.array(p, dtype=float) * scale + shift for p in points]
    normals = [solid.normals(p) for p in points]
    return measurands(*((p, p, n, n) for p, n in zip(placed, normals, strict=True)))


def dyadic_eyes(count: int, rng: np.random.Generator, low: float, high: float) -> list[tuple[Fraction, ...]]:
    """Random positions whose coordinates are exact in binary, so that oracle and code mean the same place."""
    return [tuple(Fraction(int(n), 256) for n in row) for row in rng.integers(low * 256, high * 256, (count, 3))]


def degenerate_eyes(size: int) -> list[tuple[Fraction, ...]]:
    """In the planes of faces, along edges, exactly facing, and on diagonals, near and far."""
    places = [-40, -7, Fraction(-1, 2), 0, Fraction(1, 2), 1, Fraction(3, 2), 2, 3, size, size + 7, size + 40]
    eyes = [(x, y, z) for x in places for y in places for z in places]
    return [tuple(Fraction(c) for c in eye) for eye in eyes]


def outside(solid: BoxSolid, eyes):
    """Eyes that are not in or on the solid."""
    return [eye for eye in eyes if not any(all(lo[k] <= eye[k] <= hi[k] for k in range(3)) for lo, hi in solid.boxes)]


def poses(eyes, target):
    return look_at(np.array(eyes, dtype=float), np.broadcast_to(np.array(target, dtype=float), (len(eyes), 3)))


def compare(solid: BoxSolid, points, eyes):
    """Reasons (eyes x points), and the oracle's verdicts: 1 hidden, 0 not, -1 grazing."""
    occluder = Occluder(solid.mesh())
    table = of_points(solid, points)
    # each point is looked at by a camera of its own: in view always
    reason = np.empty((len(eyes), len(points)), dtype=object)
    for j, point in enumerate(points):
        one = MeasurandTable(
            table.points[[j]], table.normals[[j]], table.whole[[j]], np.zeros(1, int), np.zeros(1, int)
        )
        seen = observe(poses(eyes, point), one, WIDE, occluder, EVERYTHING)
        reason[:, j] = [REASONS[k] for k in seen[:, 0]]
    verdict = {None: -1, True: 1, False: 0}
    truth = np.array([[verdict[solid.hides(p, eye, MARGIN)] for p in points] for eye in eyes])
    return reason, truth


@pytest.mark.parametrize("name", SOLIDS)
def test_agrees_with_exact_arithmetic_from_everywhere(name):
    rng = np.random.default_rng(11)
    solid = SOLIDS[name]
    points = edge_points(solid, 1, rng)
    points = [points[k] for k in rng.permutation(len(points))[:40]]
    eyes = outside(solid, dyadic_eyes(60, rng, -6, 10) + dyadic_eyes(60, rng, -300, 300) + dyadic_eyes(30, rng, 1, 3))
    reason, truth = compare(solid, points, eyes)
    assert (truth < 0).mean() < 0.01, "almost nothing is excluded"
    seen = reason == ""
    assert set(np.unique(reason)) <= {"", "occluded", "facing_away"}
    wrong = np.argwhere((truth >= 0) & (seen != (truth == 0)))
    assert len(wrong) == 0, [(points[j], eyes[i], reason[i, j], truth[i, j]) for i, j in wrong[:5]]
    assert 0.1 < seen.mean() < 0.9


@pytest.mark.parametrize("name", SOLIDS)
def test_agrees_with_exact_arithmetic_in_the_planes_of_faces_and_along_edges(name):
    rng = np.random.default_rng(12)
    solid = SOLIDS[name]
    points = edge_points(solid, 1, rng)
    points = [points[k] for k in rng.permutation(len(points))[:12]]
    eyes = outside(solid, degenerate_eyes(max(max(hi) for _, hi in solid.boxes)))
    eyes = [eyes[k] for k in rng.permutation(len(eyes))[:250]]
    reason, truth = compare(solid, points, eyes)
    # exactly in the plane of the only faces that might be seen: they are seen as a line, which faces nobody
    edge_on = np.array(
        [
            [max(sum(n[k] * (e[k] - p[k]) for k in range(3)) for n in solid.normals(p)) <= 0 for p in points]
            for e in eyes
        ]
    )
    assert (reason[edge_on] == "facing_away").all()
    judged = (truth >= 0) & ~edge_on
    assert judged.mean() > 0.5
    wrong = np.argwhere(judged & ((reason == "") != (truth == 0)))
    assert len(wrong) == 0, [(points[j], eyes[i], reason[i, j], truth[i, j]) for i, j in wrong[:5]]


@cache
def views_of_the_slot():
    """Points, eyes, and where the exact verdict is not within the margin of grazing."""
    rng = np.random.default_rng(13)
    points = edge_points(SLOTTED, 1, rng)
    points = [points[k] for k in rng.permutation(len(points))[:60]]
    eyes = outside(SLOTTED, dyadic_eyes(150, rng, -8, 12))
    return points, eyes, np.array([[SLOTTED.hides(p, eye, MARGIN) is not None for p in points] for eye in eyes])


@pytest.mark.parametrize(
    ("scale", "shift"),
    [(1.0, (1e4, -1e4, 1e4)), (1e-2, (0, 0, 0)), (1e3, (0, 0, 0)), (50.0, (1e4, 1e4, -1e4)), (1e-2, (1e2, 0, 0))],
)
def test_verdicts_depend_neither_on_place_nor_on_scale(scale, shift):
    points, eyes, certain = views_of_the_slot()
    reference = observe(
        poses(eyes, (2, 1.5, 1.5)), of_points(SLOTTED, points), WIDE, Occluder(SLOTTED.mesh()), EVERYTHING
    )
    moved = observe(
        poses(np.array(eyes, dtype=float) * scale + shift, np.array([2, 1.5, 1.5]) * scale + shift),
        of_points(SLOTTED, points, scale, shift),
        WIDE,
        Occluder(SLOTTED.mesh(scale, shift)),
        EVERYTHING,
    )
    # being in the image does not count here: with rounding it may differ for a point 90 degrees off the axis
    in_view = (reference > REASONS.index("out_of_view")) & (moved > REASONS.index("out_of_view"))
    judged = certain & in_view
    assert judged.mean() > 0.5
    np.testing.assert_array_equal(moved[judged] == VISIBLE, reference[judged] == VISIBLE)


def test_many_pairs_in_threads_equal_one_by_one():
    rng = np.random.default_rng(14)
    points = edge_points(POCKET, 1, rng)
    table = of_points(POCKET, points)
    lines = SightLines(table, Occluder(POCKET.mesh()))
    eyes = rng.uniform(-20, 20, (VIEWS, 3))
    views = view_block(poses(eyes, (0, 0, 0)))
    n = 150_000  # several casts
    viewpoint, measurand = rng.integers(0, VIEWS, n), rng.integers(0, len(points), n)
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(lambda _: lines.hidden(views, viewpoint, measurand), range(4)))
    assert all((one == together[0]).all() for one in together)
    some = rng.choice(n, 300, replace=False)
    alone = [lines.hidden(views, viewpoint[[k]], measurand[[k]])[0] for k in some]
    np.testing.assert_array_equal(together[0][some], alone)
    assert 0.1 < together[0].mean() < 0.9


# --- every reason by itself: the top edge of a unit box, seen from straight above unless said otherwise -------------

EDGE = ([0, 0, 1], [1, 0, 1], [[0, 0, 1], [0, -1, 0]], [[0, 0, 1], [0, -1, 0], [1, 0, 0]])


def reason_of(T_part_camera, pair=EDGE, camera=PLAIN, limits=None, mesh=None, observed="ends"):
    occluder = Occluder(BOX.mesh() if mesh is None else mesh)
    limits = limits or ObservationLimits(minimum_length_px=10.0)
    seen = observe(np.asarray(T_part_camera)[None], measurands(pair, observed=observed), camera, occluder, limits)
    name = REASONS[int(seen[0, 0])]
    assert (seen[0, 0] == VISIBLE) == (name == "")
    return name


def looking_down(x, y, z):
    """Camera at (x, y, z), image x along part x, image y along part -y."""
    return np.array([[1, 0, 0, x], [0, -1, 0, y], [0, 0, -1, z], [0, 0, 0, 1]], dtype=float)


def test_visible_from_above():
    assert reason_of(looking_down(0.5, 0.5, 11.0)) == ""


def test_behind_camera():
    away = looking_down(0.5, 0.5, 11.0)
    away[:3, 1:3] *= -1  # the same place, looking up
    assert reason_of(away) == "behind_camera"
    assert reason_of(looking_down(0.5, 0.5, 1.0)) == "behind_camera", "in the plane of the centre of projection"
    slanted = look_at([0.5, -3.0, 1.0], [3.5, -3.0, 1.0])
    assert reason_of(slanted) == "behind_camera", "one end of the edge is enough"


@pytest.mark.parametrize("margin", [0.0, 8.0, 100.0])
def test_out_of_view_begins_at_the_margin(margin):
    # 10 mm above the edge one px is 0.01 mm there; the image ends half a px beyond its last pixel
    limits = ObservationLimits(margin_px=margin)
    right = 0.01 * (1000 / 2 - margin)  # from the axis to the margin, mm
    assert reason_of(looking_down(1 - right + 1e-6, 0.5, 11.0), limits=limits) == ""
    assert reason_of(looking_down(1 - right - 1e-6, 0.5, 11.0), limits=limits) == "out_of_view"
    assert reason_of(looking_down(right - 1e-6, 0.5, 11.0), limits=limits) == ""
    assert reason_of(looking_down(right + 1e-6, 0.5, 11.0), limits=limits) == "out_of_view"
    up = 0.01 * (800 / 2 - margin)
    assert reason_of(looking_down(0.5, up - 1e-6, 11.0), limits=limits) == ""
    assert reason_of(looking_down(0.5, up + 1e-6, 11.0), limits=limits) == "out_of_view"
    assert reason_of(looking_down(0.5, -up - 1e-6, 11.0), limits=limits) == "out_of_view"


def test_the_image_follows_the_principal_point():
    shifted = Camera(10.0, (0.01, 0.01), (1000, 800), principal_point_px=(0.0, 399.5))
    limits = ObservationLimits(margin_px=0.0)
    assert reason_of(looking_down(0.5, 0.5, 11.0), camera=shifted, limits=limits) == "out_of_view"
    assert reason_of(looking_down(-0.01, 0.5, 11.0), camera=shifted, limits=limits) == ""


def test_facing_away_and_the_grazing_angle():
    assert reason_of(look_at([0.5, 0.5, -10.0], [0.5, 0.5, 0.5])) == "facing_away"
    # from beyond y = 1 only the top faces the edge; its elevation decides
    limits = ObservationLimits(grazing_angle_rad=np.deg2rad(10.0), minimum_length_px=1.0)
    for elevation, expected in ((9.9, "facing_away"), (10.1, "")):
        angle = np.deg2rad(elevation)
        # the start of the edge is the end without a side face towards the camera
        eye = np.array([0.0, 20 * np.cos(angle), 1 + 20 * np.sin(angle)])
        pair = (EDGE[0], EDGE[1], EDGE[2], EDGE[3][:2])
        # the other end is nearly as far: its elevation is less by 20 (1 - 1/sqrt(1 + 1/400)) / 20 = 0.13 %
        assert reason_of(look_at(eye, [0.5, 0, 1]), pair, limits=limits) == expected


def test_each_end_needs_a_facing_surface():
    left = look_at([-10.0, 0.5, 0.5], [0.0, 0.5, 0.5])
    near, far = ([0, 0, 1], [[-1, 0, 0]]), ([1, 0, 1], [[1, 0, 0]])
    pair = (near[0], far[0], near[1], far[1])
    assert reason_of(left, pair, limits=ObservationLimits(minimum_length_px=0)) == "facing_away"


def test_too_short():
    # one mm at 10 mm in front of a 10 mm lens is 100 px
    for shortest, expected in ((99.9, ""), (100.1, "too_short")):
        limits = ObservationLimits(minimum_length_px=shortest)
        assert reason_of(looking_down(0.5, 0.5, 11.0), limits=limits) == expected


def test_too_short_counts_pixels_of_their_own_width():
    wide = Camera(10.0, (0.02, 0.01), (1000, 800))
    limits = ObservationLimits(minimum_length_px=51.0)
    assert reason_of(looking_down(0.5, 0.5, 11.0), camera=wide, limits=limits) == "too_short", "50 px along u"
    turned = looking_down(0.5, 0.5, 11.0) @ np.diag([1.0, 1.0, 1.0, 1.0])[[1, 0, 2, 3]] @ np.diag([1, -1, 1, 1])
    assert reason_of(turned, camera=wide, limits=limits) == "", "100 px along v"


def test_out_of_focus():
    # thin lens f/2 at 100 mm: a point at 110 mm images 10*100/90 mm behind the lens, the sensor; one at Z at
    # 10 Z / (Z - 10) mm; similar triangles give the blur circle of a 5 mm pupil
    pupil, sensor = 5.0, 10 * 100 / 90

    def blur_px(depth):
        focus = 10 * depth / (depth - 10)
        return pupil * abs(sensor - focus) / focus / 0.01

    for depth in (60.0, 90.0, 110.0, 200.0):
        pair = ([-1, 0, 1], [2, 0, 1], EDGE[2], EDGE[3])
        for factor, expected in ((1.001, ""), (0.999, "out_of_focus")):
            camera = Camera(
                10.0,
                (0.01, 0.01),
                (1000, 800),
                f_number=2.0,
                focus_distance_mm=100.0,
                blur_limit_px=blur_px(depth) * factor,
            )
            assert reason_of(looking_down(0.5, 0.5, 1 + depth), pair, camera) == expected
    sharp = Camera(10.0, (0.01, 0.01), (1000, 800))
    assert reason_of(looking_down(0.5, 0.5, 91.0), ([-1, 0, 1], [2, 0, 1], EDGE[2], EDGE[3]), sharp) == ""


def with_plate(low, high):
    """The unit box and, apart from it, a plate that may stand in the way."""
    box = BOX.mesh()
    low, high = np.array(low, dtype=float), np.array(high, dtype=float)
    plate = box.vertices * (high - low) + low
    return Mesh(np.vstack([box.vertices, plate]), np.vstack([box.triangles, box.triangles + len(box.vertices)]))


def test_occluded_by_something_else():
    from_above = looking_down(0.5, 0.5, 11.0)
    assert reason_of(from_above, mesh=with_plate([0.8, -0.2, 5], [1.2, 0.2, 5.01])) == "occluded"
    assert reason_of(from_above, mesh=with_plate([1.2, -0.2, 5], [1.4, 0.2, 5.01])) == ""
    assert reason_of(from_above, mesh=with_plate([0, 0, 12], [1, 1, 13])) == "", (
        "what is behind the camera hides nothing"
    )


def test_ends_see_past_what_hides_the_middle_and_whole_does_not():
    from_above = looking_down(0.5, 0.5, 11.0)
    middle = with_plate([0.45, -0.2, 5], [0.55, 0.7, 5.01])
    assert reason_of(from_above, mesh=middle, observed="ends") == ""
    assert reason_of(from_above, mesh=middle, observed="whole") == "occluded"
    beside = with_plate([0.45, 0.6, 5], [0.55, 0.9, 5.01])
    assert reason_of(from_above, mesh=beside, observed="whole") == ""


def test_whole_segment_across_a_slot_is_seen_from_above_and_along_an_edge_of_the_wall_not_through_it():
    top = [[0, 0, 1], [1, 0, 0]], [[0, 0, 1], [-1, 0, 0]]
    mesh = SLOTTED.mesh()
    across = ([1, 1, 3], [2, 1, 3], *top)
    assert reason_of(look_at([1.5, 1, 20], [1.5, 1, 3]), across, mesh=mesh, observed="whole") == ""
    # the bottom's two corners seen through the slot's open end; the slot's depth hides them from a shallow side view
    bottom = ([1, 1, 1], [2, 1, 1], [[0, 0, 1], [1, 0, 0]], [[0, 0, 1], [-1, 0, 0]])
    for observed in ("ends", "whole"):
        assert reason_of(look_at([1.5, 1, 20], [1.5, 1, 1]), bottom, mesh=mesh, observed=observed) == ""
        assert reason_of(look_at([1.5, -15, 8], [1.5, 1, 1]), bottom, mesh=mesh, observed=observed) == ""
        assert reason_of(look_at([20, 1, 5], [1.5, 1, 1]), bottom, mesh=mesh, observed=observed) == "occluded"


def test_conditions_are_named_in_their_order():
    """A measurand that fails several conditions has the name of the first."""
    order = ["behind_camera", "out_of_view", "facing_away", "too_short", "out_of_focus", "occluded", ""]
    assert list(REASONS) == order
    below = look_at([0.5, 0.5, -10.0], [0.5, 0.5, 0.5])
    strict = ObservationLimits(minimum_length_px=1e6)
    blind = Camera(10.0, (0.01, 0.01), (1000, 800), f_number=1.0, focus_distance_mm=1000.0, blur_limit_px=1e-3)
    hidden = with_plate([0, -0.5, 5], [1, 1, 5.01])
    assert reason_of(below, limits=strict, camera=blind) == "facing_away"
    above = looking_down(0.5, 0.5, 11.0)
    assert reason_of(above, limits=strict, camera=blind, mesh=hidden) == "too_short"
    assert reason_of(above, camera=blind, mesh=hidden) == "out_of_focus"
    aside = looking_down(50.0, 0.5, 11.0)
    assert reason_of(aside, limits=strict, camera=blind, mesh=hidden) == "out_of_view"


@pytest.mark.parametrize("value", [-1.0, np.nan, np.inf])
@pytest.mark.parametrize("name", ["margin_px", "minimum_length_px", "grazing_angle_rad"])
def test_bad_limits(name, value):
    with pytest.raises(InputError, match=name):
        ObservationLimits(**{name: value})


# --- round edges: the true circle is off the mesh by its chord error ------------------------------------------------


def round_part(sides: int, boss: bool) -> Mesh:
    """A plate 40 x 40 with a hole of radius 5 through its 10 mm, or with a boss 10 mm high, as a mesh of chords."""
    import trimesh

    outline = np.array([[-20.0, -20], [20, -20], [20, 20], [-20, 20]])
    turn = 2 * np.pi * np.arange(sides) / sides
    circle = 5 * np.stack([np.cos(turn), np.sin(turn)], axis=1)
    vertices, triangles = [], []

    def add(*corners):
        triangles.append([len(vertices), len(vertices) + 1, len(vertices) + 2])
        vertices.extend(corners)

    def quad(a, b, c, d):
        add(a, b, c)
        add(a, c, d)

    def ring(z, up):
        # the plate's face between circle and square: each chord to the corner of its quadrant
        for k in range(sides):
            a, b = circle[k], circle[(k + 1) % sides]
            corner = outline[(2 + int(4 * k // sides)) % 4]
            tri = [(*a, z), (*corner, z), (*b, z)]
            add(*(tri if up else tri[::-1]))
        for quadrant in range(4):
            a = circle[(quadrant * sides) // 4]
            before, after = outline[(1 + quadrant) % 4], outline[(2 + quadrant) % 4]
            tri = [(*a, z), (*before, z), (*after, z)]
            add(*(tri if up else tri[::-1]))

    for k in range(4):
        a, b = outline[k], outline[(k + 1) % 4]
        quad((*a, 0), (*b, 0), (*b, 10), (*a, 10))
    low, high = (10, 20) if boss else (0, 10)
    for k in range(sides):
        a, b = circle[k], circle[(k + 1) % sides]
        wall = [(*a, low), (*b, low), (*b, high), (*a, high)]
        quad(*(wall if boss else wall[::-1]))
        if boss:
            add((0, 0, 20), (*a, 20), (*b, 20))
    ring(10, up=True)
    if boss:
        quad((*outline[0], 0), (*outline[3], 0), (*outline[2], 0), (*outline[1], 0))
    else:
        ring(0, up=False)
    made = trimesh.Trimesh(np.array(vertices), np.array(triangles))
    assert made.is_watertight
    expected = 40 * 40 * 10 + (1 if boss else -1) * 10 * sides / 2 * 25 * np.sin(2 * np.pi / sides)
    assert made.volume == pytest.approx(expected)
    chord_error = 5 * (1 - np.cos(np.pi / sides))
    return Mesh(np.array(made.vertices), np.array(made.faces, dtype=np.int64), chord_error)


@pytest.mark.parametrize("sides", [12, 48, 200])
@pytest.mark.parametrize("boss", [False, True])
def test_a_rim_is_seen_from_above_though_its_points_are_off_the_mesh(sides, boss):
    mesh = round_part(sides, boss)
    z = 20.0 if boss else 10.0
    turns = 2 * np.pi * (np.arange(3 * sides) / (3 * sides) + 0.001)  # between and near the mesh's corners
    rim = np.stack([5 * np.cos(turns), 5 * np.sin(turns), np.full(len(turns), z)], axis=1)
    away = np.stack([np.cos(turns), np.sin(turns), np.zeros(len(turns))], axis=1) * (1 if boss else -1)
    table = measurands(*((p, p, [[0, 0, 1], n], [[0, 0, 1], n]) for p, n in zip(rim, away, strict=True)))
    around = np.deg2rad(np.arange(0, 360, 15))
    for elevation in (30, 45, 60, 75, 90):
        up = np.deg2rad(elevation)
        eyes = 200 * np.stack([np.cos(up) * np.cos(around), np.cos(up) * np.sin(around), np.full(24, np.sin(up))], 1)
        seen = observe(poses(eyes, (0, 0, z)), table, WIDE, Occluder(mesh), EVERYTHING)
        assert (seen == VISIBLE).all(), f"elevation {elevation}: {(seen != VISIBLE).mean():.1%} hidden"


@pytest.mark.parametrize("sides", [24, 48, 200])
def test_the_far_rim_of_a_hole_is_seen_through_it_only_when_the_line_of_sight_passes(sides):
    mesh = round_part(sides, boss=False)
    turns = 2 * np.pi * (np.arange(36) / 36 + 0.001)
    lower = np.stack([5 * np.cos(turns), 5 * np.sin(turns), np.zeros(36)], axis=1)
    inward = -np.stack([np.cos(turns), np.sin(turns), np.zeros(36)], axis=1)
    table = measurands(*((p, p, [[0, 0, -1], n], [[0, 0, -1], n]) for p, n in zip(lower, inward, strict=True)))
    eyes = np.array([[60.0, 0, 110], [200, 0, 110], [0, 0, 110], [0, 90, 110], [20, -30, 200]])
    judged = 0
    seen = observe(poses(eyes, (0, 0, 5)), table, WIDE, Occluder(mesh), EVERYTHING) == VISIBLE
    for i, eye in enumerate(eyes):
        # where the line of sight leaves the plate's top: inside the true circle or not
        crossing = lower + (eye - lower) * (10 / eye[2])
        distance = np.linalg.norm(crossing[:, :2], axis=1)
        clear = np.abs(distance - 5) > 5 * mesh.chord_error_mm
        np.testing.assert_array_equal(seen[i][clear], (distance < 5)[clear])
        judged += clear.sum()
    assert judged > 60


def test_the_foot_of_a_boss_is_hidden_behind_it_and_seen_before_it():
    mesh = round_part(48, boss=True)
    turns = 2 * np.pi * (np.arange(36) / 36 + 0.001)
    radial = np.stack([np.cos(turns), np.sin(turns), np.zeros(36)], axis=1)
    foot = 5 * radial + [0, 0, 10]
    table = measurands(*((p, p, [[0, 0, 1], n], [[0, 0, 1], n]) for p, n in zip(foot, radial, strict=True)))
    seen = observe(look_at([100.0, 0, 80], [0, 0, 10])[None], table, WIDE, Occluder(mesh), EVERYTHING)[0] == VISIBLE
    assert seen[radial[:, 0] > 0.1].all()
    assert not seen[radial[:, 0] < -0.1].any()
