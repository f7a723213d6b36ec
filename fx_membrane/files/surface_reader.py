"""Reader of STL and PLY by pyvista, run as a script in a process of its own: VTK aborts on some damaged files."""

from __future__ import annotations

import sys


def main(source: str, target: str) -> None:
    """Write points, and the offsets and nodes of faces, as a NumPy archive."""
    import numpy as np  # noqa: PLC0415
    import pyvista  # noqa: PLC0415

    mesh = pyvista.read(source)
    faces = mesh.GetPolys()
    begin = pyvista.convert_array(faces.GetOffsetsArray())
    nodes = pyvista.convert_array(faces.GetConnectivityArray())
    np.savez(target, points=np.asarray(mesh.points, dtype=np.float64), begin=begin, nodes=nodes)


if __name__ == "__main__":
    main(*sys.argv[1:])
