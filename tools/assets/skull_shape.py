# SPDX-License-Identifier: GPL-3.0-or-later
"""The skull template's solid: a warped level set, closed and filled, with sculpted parts.

Frame (mm): origin midway between the porions, +x the subject's left, +y up, +z out of the face,
Frankfurt plane y = 0. Sizes aim at the middle of published adult craniometry (length 182, breadth
145, bizygomatic 130, nasion-gnathion 118, bigonial 100 mm).
"""
import numpy as np
from scipy import ndimage
from scipy.interpolate import RBFInterpolator

import fields as fd
import skull_parts as parts

VOXEL = np.array([3.94305, 3.65079, 3.94305])  # mm; x, up, front after reordering
MIDDLE = 30.5  # index of the volume's own mirror plane: |volume - mirrored| is below 1e-4 there
LEVEL = 2.6  # the level set's bone surface (the file's name says 2.9, thin bone survives to 2.5)


def read_level_set(path):
    """Values[x, up, front] of skull_2.9.inr: 256 byte header, then float32 in z, y, x order."""
    raw = open(path, 'rb').read()
    if not raw.startswith(b'#INRIMAGE-4#{') or len(raw) != 256 + 4 * 64**3:
        raise ValueError(f'{path}: not the expected 64^3 float INRIMAGE file')
    volume = np.frombuffer(raw, '<f4', 64**3, 256).reshape(64, 64, 64)
    return np.transpose(volume, (2, 0, 1))[:, :, ::-1].astype(float)


# Vault: similarity with the breadth set apart. (x off the mirror plane, up, front) of the porion in
# the volume, then scale and the tilt that makes the orbitale level with it.
PORION = np.array([0.0, 99.0, 106.0])
SCALE = np.array([0.945, 0.90, 0.90])
TILT = np.radians(2.0)


def vault_map(p):
    """Volume mm (x from mirror plane, up, front) -> head frame."""
    q = np.asarray(p, float) - PORION
    c, s = np.cos(TILT), np.sin(TILT)
    return np.stack([q[:, 0], c * q[:, 1] - s * q[:, 2], s * q[:, 1] + c * q[:, 2]], 1) * SCALE


# Face: the same point in the volume and in the head frame.
FACE_PAIRS = np.array([
    # volume x, up, front        head x, y, z
    [0, 128, 211, 0, 27, 93],  # nasion
    [0, 106, 213, 0, 6, 102],  # rhinion
    [28, 102, 188, 34, 2, 79],  # orbitale
    [28, 134, 203, 29, 34, 89],  # upper orbital rim
    [48, 117, 183, 49, 14, 69],  # lateral orbital rim
    [52, 128, 184, 52, 24, 69],  # frontozygomatic
    [15, 118, 204, 12, 17, 84],  # medial orbital rim
    [0, 84, 206, 0, -24, 93],  # nasal floor
    [9, 90, 204, 14, -15, 89],  # aperture's widest point
    [0, 69, 203, 0, -40, 92],  # lower end of the maxilla
    [33, 69, 172, 29, -40, 55],
    [47, 84, 178, 45, -21, 68],  # lower end of the cheekbone
    [70, 97, 130, 63, -4, 38],  # zygomatic arch
    [57, 98, 173, 55, -6, 64],  # cheekbone
    [70, 99, 106, 60, 0, 0],  # porion
    [66, 80, 98, 54, -20, -6],  # mastoid
    [0, 142, 214, 0, 38, 98],  # glabella
])
VAULT_ANCHORS = np.array([
    [0, 227, 100], [0, 215, 150], [0, 190, 195], [0, 165, 211], [0, 205, 50], [0, 170, 19],
    [0, 140, 12], [0, 110, 25], [0, 88, 60], [0, 85, 90], [75, 135, 97], [70, 170, 100],
    [73, 125, 80], [62, 110, 60], [66, 140, 130], [50, 190, 130], [50, 195, 80], [40, 170, 190],
    [45, 140, 190], [60, 150, 155], [50, 150, 40], [30, 100, 40], [40, 85, 70], [20, 95, 150]])


def volume_points(head_points):
    """Head frame -> volume mm, by a thin-plate spline through the pairs and their mirror images."""
    source = np.concatenate([FACE_PAIRS[:, :3], VAULT_ANCHORS])
    target = np.concatenate([FACE_PAIRS[:, 3:], vault_map(VAULT_ANCHORS)])
    off = target[:, 0] != 0
    flip = np.array([-1.0, 1, 1])
    source = np.concatenate([source, source[off] * flip])
    target = np.concatenate([target, target[off] * flip])
    spline = RBFInterpolator(target, source, kernel='thin_plate_spline', smoothing=30.0)
    return spline(head_points)


def cranium(grid, volume):
    """Warped level set without jaw and vertebrae, its inside filled."""
    coarse = fd.Grid(step=grid.step * 4)  # the spline is smooth: evaluate it coarsely
    p = volume_points(coarse.points()).reshape(*coarse.shape, 3)
    at = np.indices(grid.shape).reshape(3, -1) / 4.0
    v = np.stack([ndimage.map_coordinates(p[..., k], at, order=1, mode='nearest')
                  for k in range(3)])
    index = np.stack([v[0] / VOXEL[0] + MIDDLE, v[1] / VOXEL[1], v[2] / VOXEL[2]])
    value = ndimage.map_coordinates(volume, index, order=3, mode='constant').reshape(grid.shape)
    x, up, front = (c.reshape(grid.shape) for c in v)
    jaw = (up < 82) & (np.abs(x) > 34) & (front > 116) & (front < 168) | (up < 62)
    spine = (front < 122) & (up < 77 + 0.06 * np.abs(front - 95))
    value = np.where(jaw | spine, 0, value)
    field = fd.redistance(LEVEL - value, grid.step)
    padded = np.pad(field < 0, 12, mode='edge')
    inside = ndimage.binary_closing(padded, iterations=4)[12:-12, 12:-12, 12:-12]
    inside = np.concatenate([inside[:grid.plane:-1], inside[grid.plane:]])
    inside = ndimage.binary_fill_holes(inside)
    inside = inside[-(grid.shape[0] - grid.plane):]
    filled = np.concatenate([inside[grid.plane:0:-1], inside])
    core = ndimage.binary_erosion(filled, iterations=3)
    field = np.where(core, np.minimum(field, -3 * grid.step), field)
    return grid.symmetrise(ndimage.gaussian_filter(field, 1.0))


def blend_vault(grid, field):
    """Smooths the vault by 4 mm (its ripples come from the 4 mm voxels), the face not at all."""
    soft = ndimage.gaussian_filter(field, 4.0 / grid.step)
    back = np.minimum((42 - grid.z) / 30, (grid.y - 4) / 14)
    t = np.clip(np.maximum((grid.y - 42) / 16, back), 0, 1)
    t = np.broadcast_to(t * t * (3 - 2 * t), field.shape)
    return grid.symmetrise(field * (1 - t) + soft * t)


def fill_cavities(grid, field):
    """Closes every hollow that the outside does not reach, so that one outer surface is left."""
    full = np.concatenate([field[:grid.plane:-1], field[grid.plane:]])
    label, count = ndimage.label(full >= 0)
    outside = np.bincount(label.ravel())[1:].argmax() + 1
    cavity = ndimage.binary_dilation((label > 0) & (label != outside), iterations=2)
    cavity &= label != outside
    half = cavity[full.shape[0] // 2:]
    field[grid.plane:][half] = -2 * grid.step
    return grid.symmetrise(field)


def template_field(grid, volume):
    """The whole solid."""
    field = cranium(grid, volume)
    for hollow, fillet in zip(parts.hollows(grid), (9.0, 5.0, 4.0, 6.0)):
        field = fd.smooth_cut(field, hollow, fillet)
    field = fd.smooth_union(field, parts.vault_core(grid), 5.0)
    field = blend_vault(grid, grid.symmetrise(field))
    field = fd.smooth_union(field, parts.floors(grid), 3.0)
    field = fd.smooth_union(field, parts.face(grid), 4.0)
    field = fd.smooth_union(field, parts.mandible(grid), 3.0)
    field = fd.smooth_union(field, parts.teeth(grid), 1.5)
    field = fill_cavities(grid, grid.symmetrise(field))
    field = grid.symmetrise(ndimage.gaussian_filter(field, 0.8))
    return fill_cavities(grid, field)
