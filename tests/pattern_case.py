"""Case file of a flat roof with a cutting pattern."""

SHEET = """\
format = 1
title = "Flat roof"
units = { force = "kN", length = "m" }

[geometry]
kind = "grid"
width = 6
height = 4
columns = 6
rows = 4

[materials.pvc]
kind = "fabric"
Et = 500
nu = 0.3

[parts.roof]
kind = "membrane"
group = "grid"
material = "pvc"
prestress = 2

[[supports]]
rim_of = "roof"

[[stages]]
name = "rest"

[limits.stress]
roof = 20

[output]
paraview = false
"""
PATTERNS = """
[patterns]
planes = [{ point = [0, 0, 0], normal = [0, 1, 0] }]
roll_width = "2.2 m"
material = "PVC"
allowances = { seam = "20 mm", border = "50 mm" }
"""


def case(folder, patterns=PATTERNS):
    file = folder / "roof.toml"
    file.write_text(SHEET + patterns, encoding="utf-8")
    return file
