"""Cushions of two films, for tests of enclosed gas."""

import numpy as np

from fx_membrane import (
    Ambient,
    Analysis,
    Chamber,
    Fabric,
    GasPressure,
    Membrane,
    Newton,
    Seal,
    Stage,
    Structure,
    Support,
    boundary_edges,
    rectangle,
)

AIR = 101_325.0
FABRIC = Fabric(Et=1e5, nu=0.3)
INFLATE = Stage("inflate", changes=[GasPressure(300.0, "gas")])
SEAL = Stage("seal", changes=[Ambient(AIR, 293.15), Seal("gas")], after="inflate")


def two_films(length: float, width: float, nx: int, ny: int):
    """Nodes of two films that share their rim, their triangles, and the rim nodes."""
    points, bottom = rectangle(length, width, nx, ny)
    rim = np.unique(boundary_edges(bottom))
    free = np.setdiff1d(np.arange(len(points)), rim)
    twin = np.arange(len(points))
    twin[free] = len(points) + np.arange(len(free))
    return np.vstack([points, points[free]]), twin[bottom], bottom, rim


def cushion(n: int = 4, prestress: float = 50.0, height: float = 0.2, kept: float = 1.0, **structure) -> Structure:
    """Square cushion, 2 x 2; its films are curved by a height, up and down."""
    points, top, bottom, rim = two_films(2.0, 2.0, n, n)
    bulge = height * (1 - points[:, 0] ** 2) * (1 - points[:, 1] ** 2)
    points[:, 2] = np.where(np.isin(np.arange(len(points)), top), 1.0, -1.0) * bulge
    films = {"top": top, "bottom": bottom}
    parts = {name: Membrane(film, FABRIC, prestress, compression_stiffness=kept) for name, film in films.items()}
    return Structure(points, parts, [Support(rim)], **structure)


def outward(structure: Structure) -> np.ndarray:
    """Triangles of a cushion, their normals outwards."""
    top, bottom = structure.parts["top"].cells, structure.parts["bottom"].cells
    return np.vstack([top, bottom[:, ::-1]])


def double_cushion(chambers, length: float = 2.0, n: int = 4) -> Structure:
    """Cushion of three films, length x length: the top, a flat wall, and the low one."""
    points, top, bottom, rim = two_films(length, length, n, n)
    middle, _ = rectangle(length, length, n, n)
    inner = np.setdiff1d(np.arange(len(middle)), rim)
    twin = np.arange(len(middle))
    twin[inner] = len(points) + np.arange(len(inner))
    points = np.vstack([points, middle[inner]])
    bulge = 0.2 * (1 - (2 * points[:, 0] / length) ** 2) * (1 - (2 * points[:, 1] / length) ** 2)
    nodes = np.arange(len(points))
    points[:, 2] = (2 * np.isin(nodes, top) - np.isin(nodes, bottom)) * bulge
    films = {"top": top, "low": bottom, "wall": twin[bottom]}
    parts = {name: Membrane(cells, FABRIC, 50.0) for name, cells in films.items()}
    return Structure(points, parts, [Support(rim)], chambers=chambers)


def airbag(n: int = 4, **chamber) -> Structure:
    """Square cushion with gas between its films."""
    return cushion(n, chambers={"gas": Chamber({"top": 1, "bottom": -1}, **chamber)})


def run(*stages, structure=None, solver=Newton(), **options):
    """Results of stages, of an airbag if no structure is given."""
    return Analysis(structure or airbag(), solver, progress=False).run(stages, **options)
