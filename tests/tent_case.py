"""A case file with form finding in several steps, a sail in plan, constraints and all outputs."""

TENT = """\
format = 1
title = "Tent"
units = { force = "kN", length = "m" }

[geometry]
kind = "points"
points = [[-2, -2, 0], [2, -2, "1 m"], [2, 2, 0], [-2, 2, 1], [0, 0, 0.5]]

[materials.foil]
kind = "fabric"
E = "500 MPa"
thickness = "1 mm"
nu = 0.3

[parts.film]
kind = "membrane"
material = "foil"
cells = [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]
prestress = "2 kN/m"
warp = { origin = [-9, 0, 0], axis = [0, 0, 1] }

[parts.edge]
kind = "cable"
edges_of = "film"
E = "160 GPa"
area = "1 cm2"
prestress = 40

[[supports]]
nodes = [0, 1, 2, 3]

[[form_finding]]
method = "force density"
net = [{ part = "edge", density = "5 kN/m" }, { lines = [[0, 4, 2], [1, 4, 3]], density = [1, 1, 2, 2] }]
supports = [{ nodes = [0, 1, 2, 3], components = "xyz" }]

[[form_finding]]
method = "projected stress"
cables = "force density"
direction = [0, 0, 1]
stress.film = { axis = [0, 0, 1], terms = [{ values = ["2 kN/m", 2], at = "1 m", power = 0 }] }
constraints = [
  { kind = "cable force", part = "edge", force = "20 kN", cells = [0] },
  { kind = "slide", nodes = [4], normal = [0, 0, 1] },
]
loads = [{ kind = "point", nodes = [4], force = [0, 0, "100 N"] }]

[[form_finding]]
method = "masts and stays"
points = [[-3, -3, 3], [-4, -1, -1], [-1, -4, -1]]
heads = { nodes = [0] }
components = "xyz"

[form_finding.bars.mast]
kind = "mast"
axial_stiffness = "20 MN"
cells = [[5, 0]]

[form_finding.bars.stays]
kind = "cable"
axial_stiffness = "10 MN"
lines = [[6, 0, 7]]

[[form_finding]]
method = "new mesh"
size = "1 m"
keep = { where = { x = 0, y = 0 } }

[solver]
method = "conjugate gradient"
beta = "PR"
preconditioner = "jacobi"

[limits]
displacement = "30 cm"
stress = { film = "20 kN/m" }
force = { edge = "60 kN", mast = 100 }

[work]
iterations = 100
seconds = 60

[[stages]]
name = "snow"
loads = [{ kind = "line", part = "edge", load = [0, 0, -0.1], where = { x = [-2, 2] } }]

[output]
mesh = ["obj"]
pictures = ["displacement"]
report = ["html"]
"""
