# SPDX-License-Identifier: GPL-3.0-or-later
"""Skull template: level set -> warped, closed and sculpted solid -> symmetric surface, landmarks.

Usage: skull_template.py skull_2.9.inr TOOLS_FOLDER OUTPUT_FOLDER
(TOOLS_FOLDER holds the built remesh_half). Writes skull_template.ply and skull_template.json.
"""
import json
import os
import subprocess
import sys

import numpy as np
from skimage import measure

import fields as fd
import plylib
import skull_marks
import skull_shape

EDGE = 2.5  # mm, target edge length
FRAME = ('origin midway between the porions, +x the subject\'s left, +y up, +z out of the face, '
         'Frankfurt plane y = 0')


def surface(grid, field, tools):
    """Half surface by marching cubes, remeshed and joined with its mirror image."""
    half = field[grid.plane:].copy()
    half[0] += 1e-6 * (half[0] == 0)  # no vertex exactly on a grid node of the plane
    v, f, _, _ = measure.marching_cubes(half, 0, spacing=(grid.step,) * 3)
    v = v + [0, grid.low[1], grid.low[2]]
    rough, fine = os.path.join(tools, 'skull_half.off'), os.path.join(tools, 'skull_whole.off')
    plylib.write_off(rough, v, f)
    subprocess.run([os.path.join(tools, 'remesh_half'), rough, fine, str(EDGE), '6'], check=True)
    return plylib.read_off(fine)


def to_frankfurt(vertices):
    """Turns about the axis through the porions until the orbitale is level with them."""
    p = skull_marks.orbitale(vertices)
    angle = np.arctan2(p[1], p[2])
    c, s = np.cos(angle), np.sin(angle)
    return vertices @ np.array([[1, 0, 0], [0, c, -s], [0, s, c]]).T


def main():
    level_set, tools, output = sys.argv[1:4]
    grid = fd.Grid()
    field = skull_shape.template_field(grid, skull_shape.read_level_set(level_set))
    vertices, faces = surface(grid, field, tools)
    region = skull_marks.regions(grid, vertices)
    vertices = to_frankfurt(vertices).astype(np.float32).astype(float)
    normals = plylib.vertex_normals(vertices, faces)
    plylib.write_ply(os.path.join(output, 'skull_template.ply'), vertices, faces,
                     ['Palpate skull template, mm, CC0-1.0',
                      'region 0 none 1 cranium 2 forehead 3 orbit 4 eyebrow 5 cheekbone '
                      '6 jaw 7 chin'],
                     region)
    doc = {'name': 'Palpate skull template', 'unit': 'mm', 'frame': FRAME, 'licence': 'CC0-1.0',
           'source': 'level set skull_2.9.inr of Debian libcgal-demo 5.5.1-2 (CC0-1.0), warped, '
                     'closed and sculpted; see data/README.md',
           'landmarks': skull_marks.landmarks(vertices, faces, normals),
           'registration_points': skull_marks.registration_points(),
           'regions': {str(k): v for k, v in skull_marks.REGIONS.items() if k}}
    with open(os.path.join(output, 'skull_template.json'), 'w') as f:
        json.dump(doc, f, indent=1)
        f.write('\n')


if __name__ == '__main__':
    main()
