# SPDX-License-Identifier: GPL-3.0-or-later
"""Sculpted parts of the template (head frame, mm, left half; the right half is its mirror image).

The level set shows a toothless skull with a wide open jaw, blurred to about 8 mm. What it lost is
modelled here from mean adult proportions: mandible, alveolar arches and teeth in closed bite,
zygomatic arches, nasal bones and spine, mastoids. Rows are x, y, z and the ball's radius.
"""
import numpy as np

import fields as fd

# Mandible: body between its lower border and the alveolar base, ramus, processes.
BODY_LOWER = [(0, -83, 77, 6.5), (10, -83.5, 75, 6.5), (20, -82, 69, 6), (29, -79, 59, 5.5),
              (37, -73, 44, 5), (43, -65, 29, 4.5), (46.5, -57, 17, 4)]
BODY_UPPER = [(0, -66, 80, 4.5), (10, -65, 78, 5), (18, -64, 71, 5.5), (24, -62, 58, 6),
              (30, -58, 43, 5.5), (37, -53, 35, 4.5), (44, -46, 23, 4)]
RAMUS_BACK = [(46.5, -57, 17, 4), (49, -42, 13, 3.8), (50, -24, 12.5, 3.5), (50, -12, 13.5, 4)]
RAMUS_FRONT = [(38, -58, 37, 4.5), (42, -46, 40, 3.5), (45.5, -28, 43, 3), (47, -12, 44, 2.5)]
CONDYLE = [(45, -4, 14, 4.2), (50, -3.5, 14, 4.5), (54, -4.5, 14, 3.8)]
CHIN = [(0, -81, 80.5, 6.5), (8, -83, 77.5, 6)]

# Maxilla: alveolar process from the nasal floor's level to the necks of the teeth.
MAXILLA_UPPER = [(0, -30, 84, 5), (10, -30, 81.5, 5.5), (17, -30, 74, 6), (23, -30, 61, 6.5),
                 (27, -31, 46, 6)]
MAXILLA_LOWER = [(0, -40, 87, 4.5), (10, -40, 84.5, 4.8), (18, -40, 75, 5), (24, -40, 61, 5.5),
                 (28, -40, 45, 5.5)]

# Cheekbone and arch. The shelf closes the gap between arch and skull (no handle in the surface).
ARCH_UPPER = [(55, 0, 62, 3.5), (59.5, 0, 51, 2.8), (61.6, 0.5, 39, 2.5), (61, 1, 25, 2.8),
              (58, 2, 11, 3.5)]
ARCH_LOWER = [(55, -12, 61, 4), (59.5, -8.5, 51, 3), (61.6, -7, 39, 2.5), (61, -5.5, 25, 2.8),
              (57, -4, 13, 3.5)]
SHELF_OUTER = [(52, -6, 60, 4), (57, -5, 50, 3.5), (58, -4.5, 38, 3.5), (57, -3, 25, 4),
               (54, -1, 12, 4)]
SHELF_INNER = [(38, -6, 60, 4), (38, -6, 50, 4), (40, -6, 38, 4), (42, -4, 25, 4),
               (46, -1, 12, 4)]
CHEEK_UPPER = [(33, -5, 76, 4), (42, -3, 72.5, 4), (50, -1, 66.5, 4)]
CHEEK_LOWER = [(30, -18, 73, 4), (38, -17, 70, 4), (47, -13.5, 65, 4)]
RIM_OUTER = [(50, 27, 69, 3.5), (48, 14, 67, 3), (49.5, 2, 67.5, 4)]  # orbit's lateral rim
RIM_INNER = [(42, 27, 61, 3), (41, 14, 58, 3), (42, 2, 60, 3)]
CREST = [(42, -17, 67, 4.5), (36, -24, 63.5, 5), (30, -33, 60, 5)]
NASAL_RIDGE = [(0, 27, 88.5, 4.5), (0, 20, 92, 3.8), (0, 12, 96.5, 3.0), (0, 6, 100.2, 2.2)]
NASAL_SIDE = [(8, 27, 84, 3.5), (8.5, 18, 85, 3.2), (9.5, 8, 87, 3), (11.5, -2, 87, 3)]
SPINE = [(0, -24, 87, 4), (0, -23.5, 92.5, 2.4), (0, -23, 95.5, 1.8)]
MASTOID = [(54, -2, -8, 8), (53, -13, -7, 7.5), (51.5, -21, -5, 5.5)]

# Hollows: temporal fossa, infratemporal and cheek region (blurred shut in the level set).
TEMPORAL = [(80, 18, 18, 16), (73, 16, 36, 19), (65, 14, 54, 21.5)]
TEMPORAL_TOP = [(86, 38, 26, 20), (82, 42, 38, 23), (76, 42, 50, 22)]
INFRATEMPORAL = [(64, -36, 30, 18), (63, -36, 44, 22), (60, -36.5, 58, 24)]
CANINE_INNER = [(28, -13, 94.5, 12), (26, -24, 95.5, 12)]
CANINE_OUTER = [(44, -14, 90, 13.5), (44, -24, 89, 13.5)]
BRIDGE_TOP = [(0, 40, 112), (0, 28, 98.5), (0, 6, 107.5), (0, -6, 113)]  # above the nasal bones

# Wall behind the last molars: closes the way from the cheek's pocket to the throat.
RETROMOLAR_UPPER = [(24, -26, 41, 4.5), (33, -26, 40, 4.5), (42, -26, 38, 4)]
RETROMOLAR_LOWER = [(24, -60, 41, 4.5), (31, -60, 40, 4.5), (38, -58, 37, 4)]

# Teeth from the midline back: mesiodistal width (mm) of upper and lower crowns.
UPPER_WIDTHS = [8.5, 6.6, 7.6, 7.0, 6.8, 10.2, 9.8]
LOWER_WIDTHS = [5.3, 5.9, 6.8, 7.0, 7.1, 11.0, 10.5]
UPPER_ARCH = [(0, 0, 91.5), (9, 0, 89.5), (17, 0, 82), (22, 0, 71), (25.5, 0, 58),
              (28, 0, 45), (29, 0, 38)]
LOWER_ARCH = [(0, 0, 89), (7, 0, 87.5), (14, 0, 81), (19.5, 0, 70), (23.5, 0, 57),
              (26.5, 0, 44), (27.5, 0, 36)]
OCCLUSAL = -51.0  # mm, height where the crowns meet


def tooth_row(arch, widths, root, crown):
    """Balls of a row of teeth: one upright lens per tooth between heights `root` and `crown`."""
    curve = fd.polyline([(*p, 0.0) for p in arch], 0.2)
    s = np.r_[0, np.cumsum(np.linalg.norm(np.diff(curve[:, :3], axis=0), axis=1))]
    balls, start = [], 0.0
    for number, width in enumerate(widths):
        deep = 2.6 if number < 3 else 4.2  # half depth from lip to tongue side
        for part in (0.3, 0.5, 0.7):
            centre = [np.interp(start + part * width, s, curve[:, k]) for k in range(3)]
            radius = deep + (0.35 if part == 0.5 else 0.0)
            for y in np.arange(root, crown, np.sign(crown - root) * 0.8):
                balls.append((centre[0], y, centre[2] - deep + 0.4, radius))
        start += width
    return balls


def smooth_fields(parts, radius):
    """Smooth union of several fields."""
    total = parts[0]
    for part in parts[1:]:
        total = fd.smooth_union(total, part, radius)
    return total


def mandible(grid):
    """Body, ramus, condyle and chin."""
    sheets = [fd.ruled(BODY_LOWER, BODY_UPPER), fd.ruled(RAMUS_BACK, RAMUS_FRONT),
              fd.stroke(CONDYLE), fd.stroke(CHIN)]
    return smooth_fields([fd.balls_field(grid, s) for s in sheets], 6.0)


def face(grid):
    """Alveolar arches, cheekbones with arches, nasal bones, spine, mastoids."""
    sheets = [fd.ruled(MAXILLA_UPPER, MAXILLA_LOWER), fd.ruled(ARCH_UPPER, ARCH_LOWER),
              fd.ruled(SHELF_OUTER, SHELF_INNER), fd.ruled(CHEEK_UPPER, CHEEK_LOWER),
              fd.ruled(RIM_OUTER, RIM_INNER), fd.stroke(CREST),
              fd.ruled(NASAL_RIDGE, NASAL_SIDE), fd.stroke(SPINE), fd.stroke(MASTOID)]
    return smooth_fields([fd.balls_field(grid, s) for s in sheets], 4.0)


def hollows(grid):
    """What is cut out of the level set: fossae, the bulges above the nasal bones and in the canine fossa."""
    temporal = fd.balls_field(grid, fd.ruled(TEMPORAL, TEMPORAL_TOP, 1.5))
    below = fd.balls_field(grid, fd.stroke(INFRATEMPORAL, 1.5))
    nose = fd.balls_field(grid, fd.stroke([(*p, 6.5) for p in BRIDGE_TOP]))
    canine = fd.balls_field(grid, fd.ruled(CANINE_INNER, CANINE_OUTER, 1.5))
    return [temporal, below, nose, canine]


def lower_teeth(grid):
    return fd.balls_field(grid, tooth_row(LOWER_ARCH, LOWER_WIDTHS, -64, OCCLUSAL - 1.0))


def teeth(grid):
    upper = fd.balls_field(grid, tooth_row(UPPER_ARCH, UPPER_WIDTHS, -38, OCCLUSAL + 1.5))
    return fd.smooth_union(upper, lower_teeth(grid), 1.5)


def vault_core(grid):
    """Solid inside of the brain case and the skull base."""
    parts = [fd.ellipsoid_field(grid, (0, 55, 2), (62, 54, 78)),
             fd.ellipsoid_field(grid, (0, 8, -8), (46, 30, 55)),
             fd.ellipsoid_field(grid, (0, 20, 26), (54, 36, 42))]  # floor of the temporal fossa
    return smooth_fields(parts, 8.0)


def floors(grid):
    """Solids that close the orbits, the nose, the mouth's inside and the throat."""
    x, y, z = grid.x, grid.y, grid.z
    # Orbit: concave floor 13 mm behind the plane of the rim.
    u, v = (x - 31.0) / 19.0, (y - 16.0) / 17.0
    rim = 80.0 - 0.4 * (x - 31.0) + 0.28 * (y - 16.0)
    orbit = np.maximum(z - (rim - 13.0 + 4.0 * np.minimum(u * u + v * v, 1.6)),
                       np.maximum(np.maximum(np.hypot(x - 31, y - 16) - 21, x - 44), 45 - z))
    # Nose: concave floor about 12 mm behind the aperture's rim.
    nose = np.maximum(z - (77 + 0.05 * (y + 8) + 0.0125 * x * x),
                      np.maximum(np.abs(y + 9) - 22, x - 16))
    nose = np.maximum(nose, 40 - z)
    # Throat between the rami, mouth between the bodies; both stay above the jaw's lower border.
    throat = fd.ellipsoid_field(grid, (0, -24, 33), (46, 37, 27))
    mouth = fd.ellipsoid_field(grid, (0, -44, 50), (24, 22, 33))
    wall = fd.balls_field(grid, fd.ruled(RETROMOLAR_UPPER, RETROMOLAR_LOWER))
    return smooth_fields([orbit, nose, throat, mouth, wall], 3.0)
