"""Cases of form finding in small: bars, masts, rings and bodies, cables, slides, and wishes, by group and name."""

import sys
from collections.abc import Callable, Iterator
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[1]))

import numpy as np

from constrained import canopy, cone, rope
from fx_membrane import (
    Cable,
    CableDensity,
    CableForce,
    CableLength,
    CableSag,
    DistributedLoad,
    EdgeAngle,
    Mast,
    Membrane,
    PointLoad,
    Pressure,
    RadialDirection,
    RigidBody,
    Ring,
    Slide,
    Structure,
    Support,
    natural_force_density,
    polyline,
    prescribed_stress,
    projected_stress,
    updated_reference,
)
from fx_membrane.form_finding.constraints.bodies import settled
from fx_membrane.form_finding.constraints.motions import motions_of
from masted_sails import guys, sail
from wished_films import WOVEN, saddle, tent
from wished_films import canopy as woven_canopy
from wished_films import cone as woven_cone
from wished_films import loads as loads_of_canopy

Case = Callable[[], Any]


def guyed(push: float, head: tuple[float, float, float] = (0, 0, 4), count: int = 1) -> Structure:
    """Free mast between three guys of 1 kN, each of some cells."""
    angle = np.radians([0, 120, 240])
    feet = np.column_stack([3 * np.cos(angle), 3 * np.sin(angle), 0 * angle])
    points, cells, ends = [np.zeros(3), np.array(head, dtype=float)], list[tuple[int, int]](), [0]
    for foot in feet:
        nodes = [1, *range(len(points), len(points) + count)]
        points += [points[1] + share * (foot - points[1]) for share in np.linspace(0, 1, count + 1)[1:]]
        cells += list(pairwise(nodes))
        ends.append(nodes[-1])
    parts = {"mast": Mast([[0, 1]], 2e8, -push), "guys": Cable(cells, 12e6, 1e3)}
    return Structure(np.array(points), parts, [Support(ends)])


def bars() -> Iterator[tuple[str, Case]]:
    """Masts between guys, upright, oblique, of several cells, near their limit, beyond it, and loaded."""
    for push in (100.0, 500.0, 2399.0, 2900.0, 2999.0, 3001.0):
        yield f"guyed {push:g}", partial(updated_reference, guyed(push))
    for push, head in ((2390.0, (0.5, 0.2, 4)), (2000.0, (-0.3, 0.4, 3)), (1000.0, (1.0, 0, 2))):
        yield f"oblique {push:g}", partial(updated_reference, guyed(push, head))
    for push, count in ((2300.0, 2), (2300.0, 3), (2900.0, 4)):
        yield f"{count} cells {push:g}", partial(updated_reference, guyed(push, count=count))
    for load in ((200.0, 0, 0), (0, 0, 200.0), (900.0, 300.0, -100.0)):
        yield f"loaded {load}", partial(updated_reference, guyed(2300.0), [PointLoad(1, load)])


def masts() -> Iterator[tuple[str, Case]]:
    """Sails on masts of given length, whose stays have some force."""
    held, corners = sail(4)
    for pull in (1e4, 2e4):
        bare = masted(held, corners, pull)
        given = [RigidBody(cell) for cell in bare.parts["masts"].cells]
        yield f"of given length {pull:g}", partial(natural_force_density, bare, iterations=3, constraints=given)


def masted(held: Structure, corners: Any, pull: float) -> Structure:
    """Sail whose high corners are free heads of masts with stays."""
    bars_of, feet = guys(held, corners)
    mast, stays = (next(bar for bar in bars_of.values() if bar.is_strut is kind) for kind in (True, False))
    parts = {
        **held.parts,
        "masts": Mast(mast.cells, 1e8),
        "stays": Cable(stays.cells, 1e7, pull),
    }
    points = np.concatenate([held.points, feet])
    free = np.unique(mast.cells[mast.cells < len(held.points)])
    low = np.setdiff1d(np.flatnonzero(held.supported.all(axis=1)), free)
    return Structure(points, parts, [Support(low), Support(np.arange(len(held.points), len(points)))])


def bodies() -> Iterator[tuple[str, Case]]:
    """Rings and rigid bodies: from afar, of given and free radius, under loads, in stays, and with a hoop."""
    structure, ring = cone()
    weight = [PointLoad(ring, (0, 0, 400.0))]
    for name, constraint in (("radius", Ring(ring, 1.3)), ("free", Ring(ring)), ("rigid", RigidBody(ring))):
        yield (
            f"natural {name}",
            partial(natural_force_density, structure, weight, iterations=3, constraints=[constraint]),
        )
        yield (
            f"updated {name}",
            partial(updated_reference, structure, weight, constraints=[constraint], max_iterations=20),
        )
    yield "hoop", partial(natural_force_density, cone(hoop=-3e3)[0], weight, constraints=[Ring(ring, 1.1)])
    for radius in (1.0, None):
        for seed in range(6):
            yield f"afar {radius} {seed}", partial(from_afar, radius, seed)
    for name, of in (("radius", Ring(ring, 1.0)), ("rigid", RigidBody(ring))):
        loads = [PointLoad(ring, (0, 0, 6400.0 / len(ring)))]
        yield f"lifted {name}", partial(radial, woven(structure), loads, [of])
        yield f"stayed {name}", partial(radial, stayed(structure, ring), [], [of])
    lifted = replace_film(structure)
    parts = {"film": lifted.parts["film"], "hoop": Cable(polyline([*ring, 0]), 1e7, 2.6e3)}
    hooped = Structure(lifted.points, parts, lifted.supports)
    yield "lifted hoop", partial(radial, hooped, [PointLoad(ring, (0, 0, 400.0))], [Ring(ring)])


def replace_film(structure: Structure) -> Structure:
    """Give a structure its membrane with warp unlike weft."""
    film = Membrane(structure.parts["film"].cells, WOVEN, (3e3, 2e3), warp=(1, 0, 0))
    return Structure(structure.points, {**structure.parts, "film": film}, structure.supports)


def woven(structure: Structure) -> Structure:
    """Give it without its hoop."""
    found = replace_film(structure)
    return Structure(found.points, {"film": found.parts["film"]}, found.supports)


def stayed(structure: Structure, ring: Any) -> Structure:
    """Hang the ring to four stays beside its axis."""
    found, n = woven(structure), len(structure.points)
    points = np.vstack([found.points, [(2.5, 1, 5), (-1, 2.5, 5), (-2.5, -1, 5), (1, -2.5, 5)]])
    tops = n + np.arange(4)
    stays = Cable(np.stack([ring[:: len(ring) // 4], tops], axis=1), 1e7, 4e3)
    return Structure(points, {**found.parts, "stays": stays}, [*found.supports, Support(tops)])


def radial(structure: Structure, loads: Any, constraints: Any) -> Any:
    """Form of a wish about the axis."""
    return prescribed_stress(structure, loads, warp={"film": RadialDirection()}, constraints=constraints)


def from_afar(radius: float | None, seed: int) -> Any:
    """Ring alone that goes to the least energy of a random stiffness."""
    structure, ring = cone()
    found, random = motions_of(structure, [Ring(ring, radius)]).bodies, np.random.default_rng(seed)
    size = found[0].ways.shape[1]
    root = random.normal(size=(size, size))
    return settled(found, root @ root.T + np.eye(size), 2 * random.normal(size=size), np.zeros(size))[0]


def cables() -> Iterator[tuple[str, Case]]:
    """Cables by force, density, length, sag and angle in each method; ropes under loads; values that none gives."""
    structure, edge = canopy(8, force=25e3), partial(CableForce, "edge")
    kinds = {
        "force": edge(30e3),
        "horizontal force": edge(28e3, horizontal=True),
        "density": CableDensity("edge", 18e3),
        "length": CableLength("edge", 12.7),
        "sag": CableSag("edge", 0.8),
        "angle": EdgeAngle("edge", 14.0),
    }
    for name, constraint in kinds.items():
        yield f"projected {name}", partial(projected_stress, structure, cables="force", constraints=[constraint])
        yield f"natural {name}", partial(natural_force_density, structure, iterations=5, constraints=[constraint])
    yield "updated length", partial(updated_reference, structure, constraints=[kinds["length"]], max_iterations=10)
    for constraint in (CableSag("edge", 0.6), CableLength("edge", 8.7), EdgeAngle("edge", 35.0)):
        yield f"wish {type(constraint).__name__}", partial(prescribed_stress, woven_canopy(), constraints=[constraint])
    pull = [PointLoad(range(1, 8), (0, 0, -1e3))]
    for length in (100.001, 101.0, 110.0, 200.0, 99.0):
        yield f"rope {length}", partial(projected_stress, rope(), pull, constraints=[CableLength("rope", length)])
    for sag in (0.01, 1.0, 10.0, 60.0):
        for prestress in (0.0, 1e7):
            start = rope(prestress=prestress)
            yield (
                f"rope sag {sag} {prestress:g}",
                partial(projected_stress, start, pull, constraints=[CableSag("rope", sag)]),
            )
    yield "rope unloaded", partial(projected_stress, rope(), constraints=[CableSag("rope", 1.0)])
    weight = [DistributedLoad((0, 0, -50.0), "rope")]
    yield "rope by weight", partial(projected_stress, rope(), weight, constraints=[CableLength("rope", 110.0)])


def slides() -> Iterator[tuple[str, Case]]:
    """Nodes on inclined planes and lines, and one that supports leave no way."""
    structure = saddle()
    corner = np.flatnonzero((structure.points[:, 1] == 4) & (np.abs(structure.points[:, 0]) < 4))
    held = np.setdiff1d(np.flatnonzero(structure.supported.all(axis=1)), corner)
    free = Structure(structure.points, structure.parts, [Support(held)])
    for slide in ({"normal": (0.2, 1, 0.1)}, {"direction": (0, 0.3, 1)}, {"normal": (0, 1, 1e-9)}):
        for method in (projected_stress, natural_force_density):
            yield f"{slide} {method.__name__}", partial(method, free, constraints=[Slide(corner, **slide)])


def wishes() -> Iterator[tuple[str, Case]]:
    """Canopies, cones, tents and saddles with warp unlike weft, under loads, and with cables too weak."""
    for ratio in ((3e3, 2e3), (4e3, 1e3)):
        yield f"canopy {ratio}", partial(prescribed_stress, woven_canopy(4, prestress=ratio))
        yield f"saddle {ratio}", partial(prescribed_stress, saddle(4, prestress=ratio))
    yield "loaded", partial(prescribed_stress, woven_canopy(), loads_of_canopy())
    yield "blown", partial(prescribed_stress, woven_canopy(), [Pressure(400.0, "film")])
    yield "tent", partial(radial, tent(20e3, radius=1.2), (), ())
    yield "cone", partial(radial, woven_cone(), (), ())
    yield "high cone", partial(radial, woven_cone(h=9.0), (), ())


GROUPS = {group.__name__: group for group in (bars, masts, bodies, cables, slides, wishes)}
