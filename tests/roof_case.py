"""A case file that uses most keys, and changes of case files."""

ROOF = """\
format = 1
title = "Roof"
units = { force = "kN", length = "m" }

[geometry]
kind = "grid"
width = "4 m"
height = 4.0
columns = 4
rows = 4

[materials.pvc]   # a comment
kind = "fabric"
Et = "500 kN/m"
nu = 0.3

[parts.roof]
kind = "membrane"
group = "grid"
material = "pvc"
prestress = ["1 kN/m", 1500e-3]
warp = [1, 0, 0]

[parts."edge, left"]
kind = "cable"
edges_of = "roof"
where = { x = -2 }
axial_stiffness = "12 MN"
prestress = "20 kN"

[[supports]]
rim_of = "roof"
components = "z"

[[supports]]
where = { x = [-2, "200 cm"], y = "-2 m" }

[[supports]]
nodes = [20, 24]

[solver]
method = "newton"
rtol = 1e-11

[[stages]]
name = "lift"
displacements = [{ nodes = [24], displacement = [0, 0, 0] }]

[[stages]]
name = "snow"
after = "lift"
increments = 2

  [[stages.loads]]
  kind = "plan"
  part = "roof"
  load = [0, 0, "-0.6 kN/m2"]

  [[stages.loads]]
  kind = "pressure"
  part = "roof"
  pressure = "-100 Pa"
  where = { x = [0, 2] }

  [[stages.loads]]
  kind = "point"
  nodes = [12]
  force = [0, 0, "-50 N"]

  [[stages.loads]]
  kind = "area"
  part = "roof"
  load = [0.01, 0, 0]
  cells = [0, 1]

[output]
folder = "out"
"""


def changed(text, *changes, count=-1):
    """Text of a case with the first of each two texts, which it has, replaced by the second."""
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, count)
    return text
