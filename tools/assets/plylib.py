# SPDX-License-Identifier: GPL-3.0-or-later
"""Small mesh files: OFF in and out (for the C++ tool), binary PLY out, vertex normals."""
import numpy as np


def write_off(path, vertices, faces):
    with open(path, 'w') as f:
        f.write(f'OFF\n{len(vertices)} {len(faces)} 0\n')
        np.savetxt(f, vertices, '%.7g')
        np.savetxt(f, np.column_stack([np.full(len(faces), 3), faces]), '%d')


def read_off(path):
    with open(path) as f:
        words = f.read().split()
    if words[0] != 'OFF':
        raise ValueError(f'{path}: not an OFF file')
    n, m = int(words[1]), int(words[2])
    vertices = np.array(words[4:4 + 3 * n], float).reshape(n, 3)
    faces = np.array(words[4 + 3 * n:4 + 3 * n + 4 * m], int).reshape(m, 4)[:, 1:]
    return vertices, faces


def write_ply(path, vertices, faces, comments=(), region=None):
    """Binary little-endian PLY: float x y z, optional uchar region, uchar/int faces."""
    fields = [('x', '<f4'), ('y', '<f4'), ('z', '<f4')]
    head = ['ply', 'format binary_little_endian 1.0', *(f'comment {c}' for c in comments),
            f'element vertex {len(vertices)}', *(f'property float {c}' for c in 'xyz')]
    if region is not None:
        fields.append(('region', 'u1'))
        head.append('property uchar region')
    head += [f'element face {len(faces)}', 'property list uchar int vertex_indices', 'end_header']
    rows = np.zeros(len(vertices), fields)
    for k, c in enumerate('xyz'):
        rows[c] = vertices[:, k]
    if region is not None:
        rows['region'] = region
    tri = np.zeros(len(faces), [('n', 'u1'), ('i', '<i4', 3)])
    tri['n'], tri['i'] = 3, faces
    with open(path, 'wb') as f:
        f.write(('\n'.join(head) + '\n').encode() + rows.tobytes() + tri.tobytes())


def vertex_normals(vertices, faces):
    """Area-weighted outward unit normals."""
    n = np.cross(vertices[faces[:, 1]] - vertices[faces[:, 0]],
                 vertices[faces[:, 2]] - vertices[faces[:, 0]])
    out = np.zeros_like(vertices)
    for k in range(3):
        np.add.at(out, faces[:, k], n)
    return out / np.maximum(np.linalg.norm(out, axis=1), 1e-30)[:, None]
