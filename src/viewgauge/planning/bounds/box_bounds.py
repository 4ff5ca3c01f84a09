"""Bounds of the two errors of a measurand's image over a box of the ways in which it can lie before a camera.

Up to what changes nothing, a measurand of length l lies before a camera in a five-parameter family of ways: the middle
of its image, whose components along and across the image are ``alpha`` and ``beta`` (tangents); the image's direction
``phi`` from +u; ``w``, the mean of the reciprocal depths of the ends; and ``k``, with ``k w`` the difference of the
reciprocal depths per image length. With ``D = (1 - k alpha)² + k² (1 + beta²)`` and ``G = l w/sqrt(D)`` ::

    L = 2 G/(1 + sqrt(1 + (k G)²))                                        the image length (tangents)
    h = k L/2,   1/Z_1 = w (1 - h),   1/Z_2 = w (1 + h)                   the depths of the ends
    r_i = Z_i sqrt(1 + beta² + (alpha -/+ L/2)²)                          their distances from the eye
    e = w (k d_t - (1 + alpha k) d_z) + 2 alpha omega_n - beta omega_t    the relative error of L

where d and omega are the pose error at the centre of projection, t its component along the image of the measurand and n
the one across (t turned by +90 deg): the joint Jacobian of :func:`~viewgauge.evaluation.image_segment` over L.
The standard deviation of e is ``|R j|`` with j the row of e and ``R^T R`` the covariance.

Of a box the kernel finds lower bounds of that deviation and of the two relative half-widths of the quantization, in
interval arithmetic: the larger of ``(sum of squared distances of the rows of R j from 0)^(1/2)`` and, for the unit
vector n along R j at the middle, the mean value form of ``n . R j``. Of the half-widths ``a >= b`` only the least of a,
M, and of a + b, S, are used: of all such pairs ``(M, S - M)`` is the most peaked (Proschan, *Ann. Math. Statist.* 36
(1965) 1703: sums of symmetric log-concave errors are the more peaked the more equal their weights; and each is the more
peaked the smaller its weight, Anderson, *Proc. AMS* 6 (1955) 170).

Rounding is covered by widening what is found by 1e-9 of its size, a thousand times what the operations can lose.
"""

from __future__ import annotations

import math

import numba

__all__ = ["AXES", "OUT", "box_bounds"]

AXES = 5
"""alpha, beta, phi (within one quadrant), the arc tangent of k, the natural logarithm of w in 1/mm."""
OUT = 13
"""Values of a box: the three lower bounds; r_1 and r_2, least and largest; 0/1 whether its middle is feasible but for
the distances, the middle's three errors, and its two distances. The first is NaN where the box is infeasible."""

_SAFE = 1e-9


@numba.njit(error_model="numpy", forceinline=True)
def _times(a0, a1, b0, b1):  # type: ignore[no-untyped-def]
    p, q, r, s = a0 * b0, a0 * b1, a1 * b0, a1 * b1
    return min(min(p, q), min(r, s)), max(max(p, q), max(r, s))


@numba.njit(error_model="numpy", forceinline=True)
def _square(a0, a1):  # type: ignore[no-untyped-def]
    low = 0.0 if a0 <= 0.0 <= a1 else min(a0 * a0, a1 * a1)
    return low, max(a0 * a0, a1 * a1)


@numba.njit(error_model="numpy", forceinline=True)
def _scaled(x, a0, a1):  # type: ignore[no-untyped-def]
    return (x * a0, x * a1) if x >= 0.0 else (x * a1, x * a0)


@numba.njit(error_model="numpy", forceinline=True)
def _largest(a0, a1):  # type: ignore[no-untyped-def]
    return max(abs(a0), abs(a1))


@numba.njit(error_model="numpy")
def _middle(alpha, beta, phi, k, w, length, R, view, out):  # type: ignore[no-untyped-def]
    """The errors of one way to lie, its distances and whether image, focus and length allow it; R j in the result."""
    c, s = math.cos(phi), math.sin(phi)
    G = length * w / math.sqrt((1.0 - k * alpha) ** 2 + k * k * (1.0 + beta * beta))
    L = 2.0 * G / (1.0 + math.sqrt(1.0 + (k * G) ** 2))
    h = 0.5 * k * L
    w1, w2 = w * (1.0 - h), w * (1.0 + h)
    j = (w * k * c, w * k * s, -w * (1.0 + alpha * k), -2.0 * alpha * s - beta * c, 2.0 * alpha * c - beta * s)
    u, v, hu, hv = alpha * c - beta * s, alpha * s + beta * c, 0.5 * L * abs(c), 0.5 * L * abs(s)
    inside = (u - hu >= view[0]) & (v - hv >= view[1]) & (u + hu <= view[2]) & (v + hv <= view[3])
    inside &= min(1.0 / w1, 1.0 / w2) >= view[4]
    inside &= max(1.0 / w1, 1.0 / w2) <= view[5]
    inside &= L * math.hypot(view[6] * c, view[7] * s) >= view[8]
    out[7] = 1.0 if inside else 0.0
    r = (0.0, 0.0, 0.0, 0.0, 0.0)
    r = (
        R[0, 0] * j[0] + R[0, 1] * j[1] + R[0, 2] * j[2] + R[0, 3] * j[3] + R[0, 4] * j[4],
        R[1, 1] * j[1] + R[1, 2] * j[2] + R[1, 3] * j[3] + R[1, 4] * j[4],
        R[2, 2] * j[2] + R[2, 3] * j[3] + R[2, 4] * j[4],
        R[3, 3] * j[3] + R[3, 4] * j[4],
        R[4, 4] * j[4],
    )
    camera = view[12] / L
    out[8] = math.sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + r[3] * r[3] + r[4] * r[4] + camera * camera)
    out[9], out[10] = view[9] * abs(c) / L, view[10] * abs(s) / L
    out[11] = math.sqrt(1.0 + beta * beta + (alpha - 0.5 * L) ** 2) / w1
    out[12] = math.sqrt(1.0 + beta * beta + (alpha + 0.5 * L) ** 2) / w2
    return r


@numba.njit(error_model="numpy")
def _box(box, shortest, longest, R, view, out):  # type: ignore[no-untyped-def]
    """Values of one box into ``out`` (:data:`OUT`); returns the axis along which to split it."""
    a0, a1, b0, b1, f0, f1 = box[0, 0], box[0, 1], box[1, 0], box[1, 1], box[2, 0], box[2, 1]
    k0, k1, w0, w1 = math.tan(box[3, 0]), math.tan(box[3, 1]), math.exp(box[4, 0]), math.exp(box[4, 1])
    out[0] = math.nan
    out[7] = 0.0
    c0, c1 = math.cos(f1), math.cos(f0)  # within a quadrant both are monotone
    s0, s1 = min(math.sin(f0), math.sin(f1)), max(math.sin(f0), math.sin(f1))
    am, bm, fm, km, wm = 0.5 * (a0 + a1), 0.5 * (b0 + b1), 0.5 * (f0 + f1), 0.5 * (k0 + k1), 0.5 * (w0 + w1)
    ar, br, fr, kr, wr = 0.5 * (a1 - a0), 0.5 * (b1 - b0), 0.5 * (f1 - f0), 0.5 * (k1 - k0), 0.5 * (w1 - w0)
    # D, naturally and in mean value form
    x0, x1 = _times(k0, k1, a0, a1)  # k alpha
    y0, y1 = 1.0 - x1, 1.0 - x0
    kk0, kk1 = _square(k0, k1)
    bb0, bb1 = _square(b0, b1)
    q0, q1 = _square(y0, y1)
    D0, D1 = q0 + kk0 * (1.0 + bb0), q1 + kk1 * (1.0 + bb1)
    ya0, ya1 = _times(y0, y1, a0, a1)
    kb0, kb1 = _times(k0, k1, 1.0 + bb0, 1.0 + bb1)
    yk0, yk1 = _times(y0, y1, k0, k1)
    D_k = 2.0 * _largest(kb0 - ya1, kb1 - ya0)
    D_a = 2.0 * _largest(yk0, yk1)
    D_b = 2.0 * kk1 * _largest(b0, b1)
    D_middle = (1.0 - km * am) ** 2 + km * km * (1.0 + bm * bm)
    D_spread = D_k * kr + D_a * ar + D_b * br
    # D k^-2 = (1/k - alpha)^2 + 1 + beta^2 is at least 1 + beta^2, and D at least its least over k
    floor = (1.0 + bb0) / (1.0 + bb0 + max(a0 * a0, a1 * a1))
    D0 = max(max(D0, D_middle - D_spread - 1e-12 * (D_middle + D_spread)), floor) * (1.0 - _SAFE)
    D1 = min(D1, D_middle + D_spread) * (1.0 + _SAFE)
    # image length and difference of depths
    G0, G1 = shortest * w0 / math.sqrt(D1), longest * w1 / math.sqrt(D0)
    cap = longest * w1 / math.sqrt(1.0 + bb0)
    X0, X1 = _times(k0, k1, G0, G1)
    X0, X1 = max(X0, -cap), min(X1, cap)
    XX0, XX1 = _square(X0, X1)
    L0 = 2.0 * G0 / (1.0 + math.sqrt(1.0 + XX1)) * (1.0 - _SAFE)
    L1 = 2.0 * G1 / (1.0 + math.sqrt(1.0 + XX0)) * (1.0 + _SAFE)
    h0 = X0 / (1.0 + math.sqrt(1.0 + X0 * X0)) - _SAFE
    h1 = X1 / (1.0 + math.sqrt(1.0 + X1 * X1)) + _SAFE
    # inside the image
    small_c, large_c = min(abs(c0), abs(c1)), _largest(c0, c1)
    ca0, ca1 = _times(c0, c1, a0, a1)
    sb0, sb1 = _times(s0, s1, b0, b1)
    sa0, sa1 = _times(s0, s1, a0, a1)
    cb0, cb1 = _times(c0, c1, b0, b1)
    room_u = min(ca1 - sb0 - view[0], view[2] - ca0 + sb1) + _SAFE
    room_v = min(sa1 + cb1 - view[1], view[3] - sa0 - cb0) + _SAFE
    if room_u < 0.5 * L0 * small_c or room_v < 0.5 * L0 * s0:
        return -1
    L1 = min(L1, 2.0 * room_u / small_c if small_c > 0.0 else math.inf)
    L1 = min(L1, 2.0 * room_v / s0 if s0 > 0.0 else math.inf)
    if L1 * math.hypot(view[6] * large_c, view[7] * s1) * (1.0 + _SAFE) < view[8]:
        return -1
    # depths and distances
    z10, z11 = 1.0 / (w1 * (1.0 - h0)), 1.0 / (w0 * (1.0 - h1)) if h1 < 1.0 else math.inf
    z20, z21 = 1.0 / (w1 * (1.0 + h1)), 1.0 / (w0 * (1.0 + h0)) if h0 > -1.0 else math.inf
    if max(z10, z20) > view[5] * (1.0 + _SAFE) or min(z11, z21) < view[4] * (1.0 - _SAFE):
        return -1
    n0, n1 = _square(a0 - 0.5 * L1, a1 - 0.5 * L0)
    m0, m1 = _square(a0 + 0.5 * L0, a1 + 0.5 * L1)
    out[3] = z10 * math.sqrt(1.0 + bb0 + n0) * (1.0 - _SAFE)
    out[4] = z11 * math.sqrt(1.0 + bb1 + n1) * (1.0 + _SAFE)
    out[5] = z20 * math.sqrt(1.0 + bb0 + m0) * (1.0 - _SAFE)
    out[6] = z21 * math.sqrt(1.0 + bb1 + m1) * (1.0 + _SAFE)
    # standard deviation, rows of R j each by itself
    j3 = _middle(am, bm, fm, km, wm, shortest, R, view, out)
    wk0, wk1 = _times(w0, w1, k0, k1)
    e00, e01 = _times(wk0, wk1, c0, c1)
    e10, e11 = _times(wk0, wk1, s0, s1)
    e20, e21 = _times(-w1, -w0, 1.0 + x0, 1.0 + x1)
    e30, e31 = -2.0 * sa1 - cb1, -2.0 * sa0 - cb0
    e40, e41 = 2.0 * ca0 - sb1, 2.0 * ca1 - sb0
    total = 0.0
    for i in range(5):
        low, high, slack = 0.0, 0.0, 0.0
        for p in range(i, 5):
            if p == 0:
                t0, t1 = _scaled(R[i, p], e00, e01)
            elif p == 1:
                t0, t1 = _scaled(R[i, p], e10, e11)
            elif p == 2:
                t0, t1 = _scaled(R[i, p], e20, e21)
            elif p == 3:
                t0, t1 = _scaled(R[i, p], e30, e31)
            else:
                t0, t1 = _scaled(R[i, p], e40, e41)
            low, high, slack = low + t0, high + t1, slack + _SAFE * 1e-3 * _largest(t0, t1)
        nearest = max(max(low, -high) - slack, 0.0)
        total += nearest * nearest
    sigma = math.sqrt(total)
    # mean value form along n = R j/|R j| at the middle, p = R^T n
    size = math.sqrt(j3[0] * j3[0] + j3[1] * j3[1] + j3[2] * j3[2] + j3[3] * j3[3] + j3[4] * j3[4])
    per = 1.0 / size if size > 0.0 else 0.0
    px = R[0, 0] * j3[0] * per
    py = (R[0, 1] * j3[0] + R[1, 1] * j3[1]) * per
    pz = (R[0, 2] * j3[0] + R[1, 2] * j3[1] + R[2, 2] * j3[2]) * per
    qx = (R[0, 3] * j3[0] + R[1, 3] * j3[1] + R[2, 3] * j3[2] + R[3, 3] * j3[3]) * per
    qy = (R[0, 4] * j3[0] + R[1, 4] * j3[1] + R[2, 4] * j3[2] + R[3, 4] * j3[3] + R[4, 4] * j3[4]) * per
    t0, t1 = _scaled(px, c0, c1)
    u0, u1 = _scaled(py, s0, s1)
    P0, P1 = t0 + u0, t1 + u1  # along the image
    t0, t1 = _scaled(py, c0, c1)
    u0, u1 = _scaled(-px, s0, s1)
    N0, N1 = t0 + u0, t1 + u1  # across
    t0, t1 = _scaled(qx, c0, c1)
    u0, u1 = _scaled(qy, s0, s1)
    Qt0, Qt1 = t0 + u0, t1 + u1
    t0, t1 = _scaled(qy, c0, c1)
    u0, u1 = _scaled(-qx, s0, s1)
    Qn0, Qn1 = t0 + u0, t1 + u1
    t0, t1 = _times(k0, k1, P0, P1)
    u0, u1 = _scaled(-pz, 1.0 + x0, 1.0 + x1)
    d_w = _largest(t0 + u0, t1 + u1) * wr
    u0, u1 = _scaled(-pz, a0, a1)
    d_k = w1 * _largest(P0 + u0, P1 + u1) * kr
    u0, u1 = _scaled(-pz, wk0, wk1)
    d_a = _largest(u0 + 2.0 * Qn0, u1 + 2.0 * Qn1) * ar
    d_b = _largest(Qt0, Qt1) * br
    t0, t1 = _times(wk0, wk1, N0, N1)
    u0, u1 = _times(a0, a1, Qt0, Qt1)
    v0, v1 = _times(b0, b1, Qn0, Qn1)
    d_f = _largest(t0 - 2.0 * u1 - v1, t1 - 2.0 * u0 - v0) * fr
    sigma = max(sigma, size - d_w - d_k - d_a - d_b - d_f)
    out[0] = math.hypot(max(sigma * (1.0 - _SAFE) - 1e-9 * size, 0.0), view[12] / L1 * (1.0 - _SAFE))
    # quantization: the least of the larger half-width and of the sum of both
    su, sv = view[9], view[10]
    A0, A1, B0, B1 = su * abs(math.cos(f0)), su * abs(math.cos(f1)), sv * math.sin(f0), sv * math.sin(f1)
    wide = min(max(A0, B0), max(A1, B1))
    if (A0 - B0) * (A1 - B1) < 0.0:
        wide = min(wide, su * sv / math.hypot(su, sv))
    both = min(A0 + B0, A1 + B1)
    wide = max(wide, 0.5 * both)
    out[1] = wide / L1 * (1.0 - _SAFE)
    out[2] = max(both - wide, 0.0) / L1 * (1.0 - _SAFE)
    # what moves the two errors most is split
    q = (out[9] * out[9] + out[10] * out[10]) * (1 / 6)
    variance = size * size + q
    s_ = size / variance if variance > 0.0 else 0.0
    q = q / variance if variance > 0.0 else 0.0
    reach_u, reach_f, reach_k, reach_w = 0.02 / view[11], 0.02 / 3.0, 0.02, 0.02
    worth = 0.5 / D_middle
    best, axis = s_ * d_a + q * D_a * ar * worth + reach_u * ar, 0
    here = s_ * d_b + q * D_b * br * worth + reach_u * br
    best, axis = (here, 1) if here > best else (best, axis)
    here = s_ * d_f + q * fr + reach_f * fr
    best, axis = (here, 2) if here > best else (best, axis)
    here = s_ * d_k + q * D_k * kr * worth + reach_k * (box[3, 1] - box[3, 0])
    best, axis = (here, 3) if here > best else (best, axis)
    here = s_ * d_w + q * wr / wm + reach_w * (box[4, 1] - box[4, 0])
    best, axis = (here, 4) if here > best else (best, axis)
    return axis


@numba.njit(
    "void(float64[:,:,::1], float64, float64, float64[:,::1], float64[::1], float64[:,::1], int64[::1])",
    cache=True,
    nogil=True,
    error_model="numpy",
)
def box_bounds(boxes, shortest, longest, R, view, out, axis):  # type: ignore[no-untyped-def]
    """Values of n boxes.

    Parameters
    ----------
    boxes
        ``(n, 5, 2)``: least and largest of each of :data:`AXES`.
    shortest, longest
        Between which the measurand's length lies, mm.
    R
        ``(5, 5)`` upper triangular, ``R^T R`` the covariance of the first five of [x, y, z, rx, ry, rz] at the centre
        of projection, camera frame, mm and rad (a turn about the optical axis changes no length).
    view
        ``(13,)``: least u, v and largest u, v of an end, tangents; least and largest depth, mm; px per tangent along
        u and v and the least image length, px; quantization steps along u and v, tangents; the largest tangent; the
        least standard deviation of the image length by edge location, tangents.
    out, axis
        ``(n, 13)`` (:data:`OUT`) and ``(n,)``, written: the values, and the axis to split (-1: infeasible).
    """
    for n in range(len(boxes)):
        axis[n] = _box(boxes[n], shortest, longest, R, view, out[n])
