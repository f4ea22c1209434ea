"""Scans with known landmarks and what is done to them: turned, scaled, noisy, holed, cut, mirrored."""
import json, os
import numpy as np

HERE = os.path.dirname(os.path.abspath(__file__))
MM = {'mm': 1.0, 'cm': 10.0, 'dm': 100.0, 'm': 1000.0, 'inch': 25.4}
TREATMENTS = ['noise', 'outliers', 'holes', 'missing', 'mirrored', 'inverted']
FLOATS = {'float': '<f4', 'float32': '<f4', 'double': '<f8'}


def read_ply(path):
    """Points [scan's unit] and triangles of a little-endian triangle PLY."""
    raw = open(path, 'rb').read()
    end = raw.index(b'end_header\n') + 11
    lines = [l.split() for l in raw[:end].decode('latin-1').split('\n')]
    n, m = (next(int(l[2]) for l in lines if l[:2] == ['element', e]) for e in ('vertex', 'face'))
    kind = FLOATS[next(l[1] for l in lines if l[:1] == ['property'])]
    points = np.frombuffer(raw, kind, 3 * n, end).reshape(-1, 3).astype(float)
    face = np.frombuffer(raw, np.dtype([('n', 'u1'), ('i', '<i4', 3)]), m, end + points.shape[0] * 3 * int(kind[2]))
    return points, face['i'].copy()


def write_ply(path, points, triangles):
    head = (f'ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\nproperty float x\nproperty float y\n'
            f'property float z\nelement face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n')
    faces = np.empty(len(triangles), np.dtype([('n', 'u1'), ('i', '<i4', 3)]))
    faces['n'], faces['i'] = 3, triangles
    with open(path, 'wb') as f:
        f.write(head.encode() + points.astype('<f4').tobytes() + faces.tobytes())


def heads(shared):
    """(name, skin file, unit, landmarks, true skull file or None): the bundled head, then the development heads."""
    own = json.load(open(os.path.join(HERE, '../data/head.json')))
    yield 'bundled', os.path.join(HERE, '../data/head.ply'), own['unit'], own['landmarks'], None
    folder = os.path.join(shared, 'heads')
    if not os.path.exists(os.path.join(folder, 'heads.json')):
        return
    for name, m in json.load(open(os.path.join(folder, 'heads.json'))).items():
        if 'file' in m and 'landmarks' in m:
            yield name, os.path.join(folder, m['file']), m['unit'], m['landmarks'], None
        elif 'skin' in m and name == 'ct':
            yield name, os.path.join(folder, m['skin']), m['unit'], {}, os.path.join(folder, m['skull'])


def rotation(rng):
    q = rng.normal(size=4)
    w, x, y, z = q / np.linalg.norm(q)
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


def enclosed(points, ball=12, deep=2, cell=1.5):
    """Which points [mm] of a bone's surface lie more than `deep` inside what a ball of radius `ball` rolling over it leaves free."""
    from scipy import ndimage
    low = points.min(axis=0) - 2 * ball
    shape = np.ceil((points.max(axis=0) + 2 * ball - low) / cell).astype(int)
    at = ((points - low) / cell).astype(int)
    bone = np.zeros(shape, bool)
    bone[tuple(at.T)] = True
    centre = ndimage.distance_transform_edt(~bone, sampling=cell) >= ball  # where the ball fits
    part, _ = ndimage.label(centre)
    swept = ndimage.distance_transform_edt(part != part[0, 0, 0], sampling=cell)
    return swept[tuple(at.T)] > ball + deep


def swapped(name):
    """The name that a point has on a mirrored head."""
    side = {'left': 'right', 'right': 'left'}
    stem, _, last = name.rpartition('_')
    return f'{stem}_{side[last]}' if last in side else name


def without(points, triangles, gone):
    """Drops the triangles that touch a point of `gone`."""
    return points, triangles[~gone[triangles].any(axis=1)]


def treat(kind, points, triangles, marks, rng):
    """One defect, in mm, in the head's upright frame: every kind but `mirrored` and `inverted` comes with 0.5 mm of noise."""
    face = np.mean(list(marks.values()), axis=0)
    if kind == 'mirrored':
        flip = np.array([-1, 1, 1])
        return points * flip, triangles[:, ::-1], {swapped(n): p * flip for n, p in marks.items()}
    if kind == 'inverted':
        return points, triangles[:, ::-1], marks
    points = points + rng.normal(size=points.shape) * 0.5
    if kind == 'outliers':  # 5 % of the points 2 to 10 mm off, any way
        out = rng.random(len(points)) < 0.05
        way = rng.normal(size=(out.sum(), 3))
        points[out] += way / np.linalg.norm(way, axis=1)[:, None] * rng.uniform(2, 10, out.sum())[:, None]
    if kind == 'holes':  # five round holes of 8 to 15 mm radius, anywhere but on a landmark
        gone = np.zeros(len(points), bool)
        for centre in points[rng.integers(len(points), size=5)]:
            radius = min(rng.uniform(8, 15), min(np.linalg.norm(p - centre) for p in marks.values()) - 12)
            gone |= np.linalg.norm(points - centre, axis=1) < radius
        points, triangles = without(points, triangles, gone)
    if kind == 'missing':  # a fifth of the points, from the back or from one side
        away = np.array([[0, 0, -1.0], [0, 0, -1.0], [0.5, 0, -1], [-0.5, 0, -1]])[rng.integers(4)]
        along = (points - face) @ (away / np.linalg.norm(away))
        points, triangles = without(points, triangles, along > np.quantile(along, 0.8))
    return points, triangles, marks


def face_alone(points, triangles, marks):
    """From the hairline to below the chin, cut askew 48 mm behind the eyes; of an upright head, in mm."""
    eye, tip = marks['eye_outer_left'], marks['nose_tip']
    p = points[triangles[:, 0]]
    kept = triangles[(p[:, 2] + 0.1 * p[:, 0] > eye[2] - 48) & (p[:, 1] < eye[1] + 75) & (p[:, 1] > tip[1] - 85)]
    used, back = np.unique(kept, return_inverse=True)
    return points[used], back.reshape(-1, 3).astype(np.int32)


def rims(triangles):
    """The borders of a surface, each a list of points in order."""
    sides = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    both = set(map(tuple, sides))
    after = {a: b for a, b in both if (b, a) not in both}
    while after:
        at, rim = next(iter(after)), []
        while at in after:
            rim.append(at)
            at = after.pop(at)
        yield rim


def open_mouth(points, triangles, marks, degrees):
    """An upright head [mm] that is open between its lips, its jaw turned about the joint (and glided forwards, as jaws do): the
    turn's share rises from 0 at the upper lip to 1 at the lower one and over the body of the jaw, smoothly between.
    None where there is no rim between lips; else the points and where the chin came to lie."""
    from scipy.sparse import coo_matrix, diags
    from scipy.sparse.linalg import spsolve
    x, y, z = points.T
    eye, tip = (marks['eye_outer_left'] + marks['eye_outer_right']) / 2, marks['nose_tip']
    lips = [r for r in rims(triangles) if len(r) > 30 and np.ptp(x[r]) > 30 and abs(x[r].mean() - tip[0]) < 5 and tip[1] - 60 < y[r].mean() < tip[1]]
    if not lips: return None
    rim = lips[0]
    corner = [int(np.argmin(x[rim])), int(np.argmax(x[rim]))]
    rim = rim[corner[0]:] + rim[:corner[0]]
    end = (corner[1] - corner[0]) % len(rim)
    upper, lower = sorted((rim[1:end], rim[end + 1:]), key=lambda r: -y[r].mean())
    mouth = points[rim].mean(axis=0)
    joint = np.array([0, eye[1] - 19, eye[2] - 61])
    share = np.full(len(points), np.nan)
    share[lower], share[upper] = 1, 0
    share[(y > mouth[1] + 9) | (z < joint[2] + 8)] = 0
    border = mouth[1] - 47 + 0.35 * (mouth[2] - z)  # of the jaw, below
    share[(y < mouth[1] - 13) & (z > mouth[2] - 35) & (y > border)] = 1
    share[(y < border - 22) | (z < joint[2] + 25) & (y < border)] = 0
    edges = np.unique(np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1), axis=0)
    a, b = edges.T
    w = 1 / np.linalg.norm(points[a] - points[b], axis=1)
    near = coo_matrix((np.r_[w, w], (np.r_[a, b], np.r_[b, a])), shape=(len(points),) * 2).tocsr()
    laplace = diags(np.asarray(near.sum(axis=1)).ravel()) - near
    bend, free = (laplace @ laplace + 1e-9 * diags(np.ones(len(points)))).tocsr(), np.isnan(share)
    share[free] = spsolve(bend[free][:, free].tocsc(), -bend[free][:, ~free] @ share[~free])
    turn = np.radians(degrees) * np.clip(share, 0, 1)
    arm, c, s = points - joint, np.cos(turn), np.sin(turn)
    glide = 20.7 * turn[:, None] * np.array([0, -np.sin(0.6), np.cos(0.6)])
    opened = joint + np.stack([arm[:, 0], c * arm[:, 1] - s * arm[:, 2], s * arm[:, 1] + c * arm[:, 2]], 1) + glide
    chin = np.argmax(np.where((abs(x - tip[0]) < 4) & (y < mouth[1] - 22) & (y > mouth[1] - 45), z, -np.inf))
    return opened, opened[chin]


def in_millimetres(path, unit, marks):
    points, triangles = read_ply(path)
    return points * MM[unit], triangles, {n: np.array(p, float) * MM[unit] for n, p in marks.items()}
