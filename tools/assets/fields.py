# SPDX-License-Identifier: GPL-3.0-or-later
"""Distance-field sculpting on a half grid (x >= 0) of a mirror-symmetric solid.

A field is negative inside, in mm, and near its zero level close to the signed distance. A solid is
built from strokes (sheets of balls along a ruled patch), blended by smooth unions and cuts.
Everything is deterministic: no random numbers, no dependence on time.
"""
import numpy as np
from scipy import ndimage
from scipy.spatial import cKDTree

STEP = 1.25  # mm, grid spacing: a third of the thinnest sculpted bone
LOW = np.array([-6 * STEP, -106.25, -106.25])  # mm; x starts below 0 so that filters see both sides
HIGH = np.array([86.25, 132.5, 116.25])  # mm


class Grid:
    """Regular grid over the half box; `plane` is the index of x = 0."""

    def __init__(self, low=LOW, high=HIGH, step=STEP):
        self.step, self.low = step, np.asarray(low, float)
        self.shape = tuple(np.round((np.asarray(high) - self.low) / step).astype(int) + 1)
        axes = [self.low[k] + step * np.arange(self.shape[k]) for k in range(3)]
        self.x, self.y, self.z = np.meshgrid(*axes, indexing='ij', sparse=True)
        self.plane = int(round(-self.low[0] / step))

    def points(self):
        full = np.broadcast_arrays(self.x, self.y, self.z)
        return np.stack([a.ravel() for a in full], 1)

    def index(self, points):
        return ((np.asarray(points) - self.low) / self.step).T

    def symmetrise(self, field):
        """Overwrites the layers x < 0 with the mirror of the layers x > 0."""
        p = self.plane
        field[:p] = field[2 * p:p:-1]
        return field


def smooth_union(a, b, radius):
    """Smooth minimum (polynomial); `radius` [mm] is the fillet's size."""
    h = np.clip(0.5 + 0.5 * (b - a) / radius, 0, 1)
    return b * (1 - h) + a * h - radius * h * (1 - h)


def smooth_cut(a, b, radius):
    """a without b."""
    return -smooth_union(-a, b, radius)


def polyline(points, spacing):
    """Samples (any number of columns) along a Catmull-Rom curve through the rows of `points`."""
    p = np.asarray(points, float)
    p = np.concatenate([2 * p[:1] - p[1:2], p, 2 * p[-1:] - p[-2:-1]])
    out = []
    for i in range(1, len(p) - 2):
        n = max(2, int(np.ceil(np.linalg.norm(p[i + 1, :3] - p[i, :3]) / spacing)))
        t = (np.arange(n) / n)[:, None]
        a, b, c, d = p[i - 1], p[i], p[i + 1], p[i + 2]
        out.append(0.5 * (2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t**2
                          + (3 * b - a - 3 * c + d) * t**3))
    return np.concatenate(out + [p[-2:-1]])


def resample(curve, n):
    """n rows evenly spaced along a sampled curve."""
    s = np.r_[0, np.cumsum(np.linalg.norm(np.diff(curve[:, :3], axis=0), axis=1))]
    at = np.linspace(0, s[-1], n)
    return np.stack([np.interp(at, s, curve[:, k]) for k in range(curve.shape[1])], 1)


def ruled(first, second, spacing=0.8):
    """Balls (x, y, z, radius) on the ruled patch between two curves given by (x, y, z, radius)."""
    a, b = polyline(first, spacing), polyline(second, spacing)
    n = max(len(a), len(b))
    a, b = resample(a, n), resample(b, n)
    m = max(2, int(np.ceil(np.linalg.norm(a - b, axis=1).max() / spacing)))
    t = np.linspace(0, 1, m)[:, None, None]
    return ((1 - t) * a + t * b).reshape(-1, 4)


def stroke(points, spacing=0.8):
    """Balls along one curve."""
    return polyline(points, spacing)


def balls_field(grid, balls, reach=14.0):
    """Field of a union of balls; exact within `reach` [mm], capped beyond it."""
    balls = np.asarray(balls, float)
    low = balls[:, :3].min(0) - reach - balls[:, 3].max()
    high = balls[:, :3].max(0) + reach + balls[:, 3].max()
    lo = np.clip(np.floor((low - grid.low) / grid.step).astype(int), 0, grid.shape)
    hi = np.clip(np.ceil((high - grid.low) / grid.step).astype(int) + 1, 0, grid.shape)
    field = np.full(grid.shape, reach)
    box = tuple(slice(a, b) for a, b in zip(lo, hi))
    sub = np.broadcast_arrays(grid.x[box[0]], grid.y[:, box[1]], grid.z[:, :, box[2]])
    points = np.stack([a.ravel() for a in sub], 1)
    k = min(12, len(balls))
    distance, index = cKDTree(balls[:, :3]).query(points, k=k)
    distance, index = distance.reshape(len(points), k), index.reshape(len(points), k)
    value = (distance - balls[:, 3][index]).min(1)
    field[box] = np.minimum(value, reach).reshape(sub[0].shape)
    return field


def ellipsoid_field(grid, centre, radii):
    """First-order distance to an ellipsoid."""
    c, r = centre, radii
    q = ((grid.x - c[0]) / r[0])**2 + ((grid.y - c[1]) / r[1])**2 + ((grid.z - c[2]) / r[2])**2
    k0 = np.sqrt(q)
    k1 = np.sqrt(((grid.x - c[0]) / r[0]**2)**2 + ((grid.y - c[1]) / r[1]**2)**2
                 + ((grid.z - c[2]) / r[2]**2)**2)
    return np.where(k0 > 1e-6, k0 * (k0 - 1) / np.maximum(k1, 1e-9), -min(r))


def redistance(field, step):
    """Turns any level function into a distance with the same zero level (to first order)."""
    inside = field < 0
    edt = (ndimage.distance_transform_edt(~inside) - ndimage.distance_transform_edt(inside)) * step
    edt = np.where(inside, edt + 0.5 * step, edt - 0.5 * step)
    slope = np.sqrt(sum(g**2 for g in np.gradient(field, step)))
    near = field / np.maximum(slope, 0.05)
    return np.where(np.abs(edt) < 1.5 * step, np.clip(near, -2 * step, 2 * step), edt)
