# SPDX-License-Identifier: GPL-3.0-or-later
"""Landmarks, registration points and regions of the skull template (head frame, mm)."""
import numpy as np
from scipy import ndimage

import skull_parts

FRONT, LEFT = (0, 0, -1), (-1, 0, 0)
# Midline landmarks found on the profile: name, range of heights (mm) and what is sought there.
PROFILE = {
    'g': ('glabella', 32, 46, 'front'),
    'n': ('nasion', 18, 36, 'deep'),
    'ss': ('subspinale', -33, -25, 'deep'),
    'sm': ('supramentale', -76, -63, 'deep'),
    'pg': ('pogonion', -86, -76, 'front'),
}
# code: (name, a point in front of the bone, direction towards it). The landmark is where the ray
# first meets the surface. Paired ones are given for the left side.
MIDLINE = {
    'v': ('vertex', (0, 150, 0), (0, -1, 0)),
    'sg': ('supraglabella', (0, 53, 140), FRONT),
    'mn': ('mid-nasal', (0, 17, 140), FRONT),
    'rhi': ('rhinion', (0, 7, 140), FRONT),
    'mp': ('mid-philtrum', (0, -35.5, 140), FRONT),
    'pr': ('prosthion', (0, -41, 140), FRONT),
    'id': ('infradentale', (0, -62, 140), FRONT),
    'gn': ('gnathion', (0, -126, 122), (0, 0.707, -0.707)),
    'me': ('menton', (0, -140, 77), (0, 1, 0)),
}
PAIRED = {
    'mso': ('mid-supraorbital', (30, 41, 140), FRONT),
    'mio': ('mid-infraorbital', (33, -7, 140), FRONT),
    'ac': ('alar curvature', (17, -19, 140), FRONT),
    'go': ('gonion', (78, -76, -1), (-0.75, 0.5, 0.43)),
    'sC': ('supra-canine', (47, -41, 117), (-0.6, 0, -0.8)),
    'iC': ('infra-canine', (44, -62, 117), (-0.6, 0, -0.8)),
    'sM2': ('supra-M2', (100, -41, 50), LEFT),
    'iM2': ('infra-M2', (100, -62, 49), LEFT),
    'mr': ('mid-ramus', (100, -32, 28), LEFT),
    'mmb': ('mid-mandibular border', (90, -128, 48), (-0.707, 0.707, 0)),
    'fe': ('frontal eminence', (45, 85, 150), (-0.2, -0.3, -0.93)),
    'lo': ('lateral orbit', (88, -6, 113), (-0.6, 0, -0.8)),
    'im': ('inferior malar', (58, -17, 110), (-0.4, 0, -0.92)),
    'sgl': ('supraglenoid', (100, 5, 17), LEFT),
    'mm': ('mid-masseter, occlusal line', (100, -50, 28), LEFT),
    'po': ('porion', (100, 0, 0), LEFT),
}
# Skin points relative to the skull.
# Placed from mean relations: nose tip 18 mm in front of rhinion and 23 below it; nose corners at the
# aperture's lower third, 4 mm outside its rim; outer eye corners 4 mm medial to the lateral orbital
# rim and 9 mm in front of it. Checked against one CT pair of skin and skull (none of it is used).
REGISTRATION = {'nose_tip': (0, -16, 120), 'nose_corner': (17, -18.5, 102.5), 'eye_outer': (45, 14, 78)}
REGIONS = {0: 'none', 1: 'cranium', 2: 'forehead', 3: 'orbit', 4: 'eyebrow', 5: 'cheekbone',
           6: 'jaw', 7: 'chin'}


def first_hit(vertices, faces, origin, direction):
    """Point where a ray first meets the surface (Moeller and Trumbore 1997)."""
    o, d = np.asarray(origin, float), np.asarray(direction, float) / np.linalg.norm(direction)
    a = vertices[faces[:, 0]]
    e1, e2 = vertices[faces[:, 1]] - a, vertices[faces[:, 2]] - a
    p = np.cross(d, e2)
    det = (e1 * p).sum(1)
    det = np.where(np.abs(det) < 1e-12, np.inf, det)
    s = o - a
    u = (s * p).sum(1) / det
    q = np.cross(s, e1)
    v, t = (q @ d) / det, (e2 * q).sum(1) / det
    hit = (u >= -1e-9) & (v >= -1e-9) & (u + v <= 1 + 1e-9) & (t > 0)
    if not hit.any():
        raise ValueError(f'no surface along the ray from {origin}')
    return o + d * t[hit].min()


def smooth_normal(vertices, normals, point, reach=4.0):
    """Outward unit normal of the bone around a point: mean over the vertices within `reach` mm."""
    near = np.linalg.norm(vertices - point, axis=1) < reach
    n = normals[near].sum(0)
    return n / np.linalg.norm(n)


def profile_point(middle, low, high, kind):
    """Foremost point of the profile between two heights, or the deepest against its chord."""
    part = middle[(middle[:, 1] >= low) & (middle[:, 1] <= high) & (middle[:, 2] > 60)]
    part = part[part[:, 2] > part[:, 2].max() - 12]  # the face's side of the jaw
    part = part[np.argsort(part[:, 1])]
    if kind == 'front':
        return part[part[:, 2].argmax()]
    chord = np.interp(part[:, 1], part[[0, -1], 1], part[[0, -1], 2])
    return part[(part[:, 2] - chord).argmin()]


def orbitale(vertices):
    """Crest of the lower orbital rim below the orbit's middle (left)."""
    x, y, z = vertices.T
    near = vertices[(np.abs(x - 34) < 2) & (np.abs(y) < 9) & (z > 68)]
    return near[(near @ [0, 0.64, 0.77]).argmax()]


def landmarks(vertices, faces, normals):
    """code -> {name, position, normal}, paired codes with _left and _right."""
    found = {}
    middle = vertices[np.abs(vertices[:, 0]) < 1e-6]
    for code, (name, low, high, kind) in PROFILE.items():
        found[code] = (name, profile_point(middle, low, high, kind))
    back = middle[middle[:, 2] < -40]
    reach = np.linalg.norm(back - found['g'][1], axis=1)
    found['op'] = ('opisthocranion', back[reach.argmax()])
    for code, (name, origin, direction) in MIDLINE.items():
        hit = first_hit(vertices, faces, np.add(origin, (1e-7, 0, 0)), direction)
        found[code] = (name, hit * [0, 1, 1])
    for code, (name, origin, direction) in PAIRED.items():
        found[code + '_left'] = (name, first_hit(vertices, faces, origin, direction))
    y, z = vertices[:, 1], vertices[:, 2]
    arch = vertices[(y > -14) & (y < 6) & (z > 22) & (z < 58)]
    found['zy_left'] = ('zygion', arch[arch[:, 0].argmax()])
    found['or_left'] = ('orbitale', orbitale(vertices))
    out = {}
    for code in sorted(found):
        name, point = found[code]
        n = smooth_normal(vertices, normals, point)
        if not code.endswith('_left'):
            n[0] = 0.0
        n = np.round(n / np.linalg.norm(n), 4) + 0.0
        point = np.round(point, 3) + 0.0
        out[code] = {'name': name, 'position': point.tolist(), 'normal': n.tolist()}
        if code.endswith('_left'):
            out[code[:-4] + 'right'] = {'name': name,
                                        'position': (point * [-1, 1, 1] + 0.0).tolist(),
                                        'normal': (n * [-1, 1, 1] + 0.0).tolist()}
    return out


def registration_points():
    out = {}
    for name, p in REGISTRATION.items():
        if p[0] == 0:
            out[name] = list(map(float, p))
        else:
            out[name + '_left'] = list(map(float, p))
            out[name + '_right'] = [-float(p[0]), float(p[1]), float(p[2])]
    return out


def regions(grid, vertices):
    """Region code per vertex; what only closes holes (mouth, throat, nose) is none."""
    x, y, z = np.abs(vertices[:, 0]), vertices[:, 1], vertices[:, 2]
    at = grid.index(np.stack([x, y, z], 1))
    bone = np.minimum(skull_parts.mandible(grid), skull_parts.lower_teeth(grid))
    jaw = ndimage.map_coordinates(bone, at, order=1) < 2.5
    code = np.zeros(len(vertices), np.uint8)
    code[(y > 0) | ((z < 5) & (y > -25))] = 1
    front = z > 48 + 0.35 * np.maximum(0, 45 - y) - 0.55 * np.maximum(0, y - 45)
    code[(y > 43) & front & (y < 100)] = 2
    code[(y <= 43) & (y > 24) & (z > 62)] = 4
    ellipse = ((x - 31) / 22.5)**2 + ((y - 16) / 20.5)**2
    code[(ellipse < 1) & (z > 45)] = 3
    code[(x <= 14) & (y <= 24) & (y > -45) & (z > 40) & (code != 3)] = 0
    cheek = (y <= 8) & (y > -34) & (x > 30) & (z > 18) & (x > 30 + (60 - z) * 0.5)
    code[cheek & (code != 3)] = 5
    code[(y > -16) & (y < 5) & (x > 54) & (z > 14)] = 5
    code[jaw & (y < -14) & (z > 0)] = 6
    code[(code == 6) & (y < -66) & (x < 21) & (z > 62)] = 7
    return code
