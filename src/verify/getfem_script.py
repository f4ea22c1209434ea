# SPDX-License-Identifier: GPL-3.0-or-later
# Solves the slab that `palpate verify` wrote with GetFEM: same tetrahedra, same nodal forces, the
# energy in GetFEM's own weak-form language, its own shape functions, assembly and Newton.
# Arguments: the case (text), the answer (text).
import sys

import getfem as gf
import numpy as np

gf.util_trace_level(0)
gf.util_warning_level(0)
words = open(sys.argv[1]).read().split()
at = 0


def take(count, kind=float):
    global at
    block = np.array(words[at : at + count], dtype=kind)
    at += count
    return block


order, node_count, tet_count, load_count, step_count = take(5, int)
lam, mu = take(2)
nodes = take(3 * node_count).reshape(-1, 3)
tets = take(4 * tet_count, int).reshape(-1, 4)
loads = take(4 * load_count).reshape(-1, 4)  # node, then the force per newton
steps = take(step_count)

mesh = gf.Mesh("empty", 3)
mesh.add_convex(gf.GeoTrans("GT_PK(3,1)"), nodes[tets].transpose(2, 1, 0))
FLOOR = 1
mesh.set_region(FLOOR, mesh.outer_faces_with_direction([0.0, 0.0, -1.0], 0.01))
field = gf.MeshFem(mesh, 3)
field.set_fem(gf.Fem("FEM_PK(3,%d)" % order))
points = gf.MeshIm(mesh, gf.Integ("IM_TETRAHEDRON(%d)" % order))


def key(p):
    return tuple(np.round(p, 6) + 0.0)


# GetFEM numbers its degrees of freedom itself: three in a row per node.
dof_of = {key(p): 3 * i for i, p in enumerate(field.basic_dof_nodes().T[::3])}
dofs = np.array([dof_of[key(p)] for p in nodes])

model = gf.Model("real")
model.add_fem_variable("u", field)
model.add_initialized_data("lam", lam)
model.add_initialized_data("mu", mu)
F = "(Id(3)+Grad_u)"
model.add_nonlinear_term(
    points,
    "mu/2*(Norm_sqr({F})-3) - mu*log(Det({F})) + lam/2*sqr(log(Det({F})))".format(F=F),
)
model.add_Dirichlet_condition_with_simplification("u", FLOOR)
unit = np.zeros(field.nbdof())
for load in loads:
    first = dofs[int(load[0])]
    unit[first : first + 3] += load[1:]
push = model.add_explicit_rhs("u", 0 * unit)

with open(sys.argv[2], "w") as out:
    force = 0.0
    for step in steps:
        substeps = max(1, int(np.ceil((step - force) / 0.25 - 1e-9)))
        for share in np.linspace(0, 1, substeps + 1)[1:]:
            model.set_private_rhs(push, (force + share * (step - force)) * unit)
            model.solve("max_res", 1e-11, "max_iter", 60, "lsolver", "mumps")
        force = step
        u = model.variable("u")
        for first in dofs:
            out.write("%.17g %.17g %.17g\n" % tuple(u[first : first + 3]))
