"""Shapes in equilibrium under prestress alone: the force density method."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import sparse
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import splu

from ..checks import validation
from ..model.supports import Support
from .constraints.kinds import Constraint, NodeConstraint
from .form import Form
from .net_balance import constrained_net
from .reasons.few_supports import ALL_HELD, check_spread
from .unsettled_form import warn_of_doubt

MAX_DISTANCE = 1e3  # distance, in sizes of the fixed nodes, that counts as no shape


def force_density(
    points: ArrayLike,
    branches: ArrayLike,
    q: ArrayLike,
    fixed: Sequence[Support],
    loads: ArrayLike | None = None,
    constraints: Sequence[Constraint] = (),
    tolerance: float = 1e-6,
    max_iterations: int = 100,
) -> Form:
    """Shape of a net whose branches have given force densities: ratios of force to length.

    At the nodes the branch forces, q times their vectors, balance the loads. This is a linear system for each
    component, D x = p, with D the graph's weighted Laplacian.

    Args:
        points: Positions, shape (n, 3) [m]; only those of the fixed components matter.
        branches: Pairs of node numbers, shape (b, 2).
        q: Force densities, a number or one per branch, shape (b,) [N/m]. Positive ones are cables, and always have a
            shape. Negative ones are struts. If all are negative, without loads, the shape is that of the positive ones,
            in compression. With both signs, branches may fold over each other, or no shape exist. A branch of zero
            carries nothing; if its nodes coincide it has no length, and `Structure` refuses it as a cable: leave it
            out.
        fixed: Constrained nodes, by component: a node fixed in "x" alone slides in the plane normal to x.
        loads: Loads on the nodes, shape (n, 3) [N]; none if not given.
        constraints: Branches by force, length, sag or angle, as `CableLength("net", 12.0, cells=...)` with the numbers
            of branches as cells; nodes that slide; rings and rigid bodies, which start at the positions given. Force
            densities follow from forces and geometry step by step, each step a linear solve.
        tolerance: Accepted relative difference of forces from those of constraints [-].
        max_iterations: Maximum number of these steps.

    Returns:
        The form. Cables with its forces as prestress are in equilibrium under the same loads:
        `Structure(form.points, {"net": Cable(branches, EA, prestress=form.forces["net"])}, form.supports)`.

    Raises:
        ValueError: Force densities of both signs throw a node a thousand times farther than the fixed nodes are apart;
            numbers are not finite or do not fit; in some component a part of the net is tied to no fixed node; the
            system is singular. Force densities at or below zero can make it singular: if those at a free node add up to
            zero, its place is undefined. So can positive ones that differ by twelve powers of ten. A constraint does
            not fit the net, or contradicts its supports.
        RuntimeError: A constraint is out of reach in the first step.

    Warns:
        UnsettledFormWarning: Constraints are not met; it says by how much and where. The form is that of the last step,
            in equilibrium with its forces.

    Source:
        H.-J. Schek, The force density method for form finding and computation of general networks, Computer Methods
        in Applied Mechanics and Engineering 3 (1974) 115-134.

    Example:
        >>> corners = [(0, 0, 0), (2, 0, 1), (2, 2, 0), (0, 2, 1), (9, 9, 9)]
        >>> net = force_density(corners, [[0, 4], [1, 4], [2, 4], [3, 4]], 100.0, [Support(range(4))])
        >>> net.points[4].round(9).tolist()
        [1.0, 1.0, 0.5]
        >>> {name: forces.round(2).tolist() for name, forces in net.forces.items()}
        {'net': [150.0, 150.0, 150.0, 150.0]}
    """
    points = validation.positions("points", points)
    n = len(points)
    branches = validation.cells("branches", branches, 2, distinct=False)
    validation.in_range("branches", branches.ravel(), n, "node")
    densities = validation.finite("q", q)
    if densities.shape not in ((), (len(branches),)):
        raise ValueError(
            f"q has shape {densities.shape}; give a number or one for each of the {len(branches)} branches."
        )
    densities = np.broadcast_to(densities, len(branches))
    force = np.zeros_like(points) if loads is None else validation.finite("loads", loads)
    if force.shape != points.shape:
        raise ValueError(f"loads has shape {force.shape}; give three components for each of the {n} nodes.")

    held = _held(fixed, n)
    constraints = validation.instances("constraints", constraints, Constraint)
    tolerance = validation.positive("tolerance", tolerance)
    max_iterations = validation.positive_integer("max_iterations", max_iterations)
    if not constraints and densities.min(initial=1.0) > 0 and not force.any():
        check_spread(points, held, [], [branches], "The piece of the branches")
    if not constraints:
        shape, reactions = _balanced(points, branches, densities, held, force)
        lengths = np.linalg.norm(np.diff(shape[branches], axis=1)[:, 0], axis=1)
        remarks = ALL_HELD if held[branches].all() else ()
        return Form(shape, {"net": densities * lengths}, reactions, supports=tuple(fixed), remarks=remarks)
    first = _balanced(points, branches, densities, _guided(held, constraints), force)[0]
    form, trouble = constrained_net(first, branches, densities, fixed, force, constraints, tolerance, max_iterations)
    _check_size(form.points, form.forces["net"], branches, held, force)
    warn_of_doubt(trouble, stacklevel=2, carried="forces")
    return form


def _guided(held: NDArray[np.bool_], constraints: Sequence[Constraint]) -> NDArray[np.bool_]:
    """Components held by supports, or in the hands of constraints of nodes, shape (n, 3)."""
    guided = held.copy()
    for constraint in constraints:
        if isinstance(constraint, NodeConstraint):
            nodes = np.asarray(constraint.nodes)
            validation.in_range(type(constraint).__name__, nodes, len(held), "node")
            guided[nodes] = True
    return guided


def _balanced(
    points: NDArray[np.float64],
    branches: NDArray[np.int64],
    densities: NDArray[np.float64],
    fixed: NDArray[np.bool_],
    force: NDArray[np.float64],
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Shape in balance and reactions at the fixed components, all of shape (n, 3).

    Raises:
        ValueError: There is none.
    """
    n = len(points)
    a, b = branches.T
    weights = sparse.coo_matrix((np.tile(densities, 2), (np.r_[a, b], np.r_[b, a])), shape=(n, n)).tocsr()
    laplacian = (sparse.diags(np.asarray(weights.sum(axis=1)).ravel()) - weights).tocsr()
    links = sparse.coo_matrix((np.ones(len(branches)), (a, b)), shape=(n, n))
    piece = connected_components(links, directed=False)[1]
    used = np.zeros(n, dtype=bool)
    used[branches] = True
    held = ~used[:, None] | fixed

    shape = points.copy()
    shape.setflags(write=True)
    for component in range(3):
        loose = np.setdiff1d(piece, piece[held[:, component]])
        if len(loose):
            node = int(np.flatnonzero(piece == loose[0])[0])
            raise ValueError(
                f"The part of the net with node {node} is tied to no fixed node in {'xyz'[component]}; fix one of it."
            )
        shape[:, component] = _solve(laplacian, held[:, component], points[:, component], force[:, component])
        if not np.isfinite(shape[:, component]).all():
            raise ValueError(_not_unique(densities, branches))
    _check_size(shape, densities, branches, held, force)
    return shape, np.where(held & used[:, None], laplacian @ shape - force, 0.0)


def _check_size(
    shape: NDArray[np.float64],
    densities: NDArray[np.float64],
    branches: NDArray[np.int64],
    held: NDArray[np.bool_],
    force: NDArray[np.float64],
) -> None:
    """Refuse a shape far from its fixed nodes, from nearly cancelling force densities of both signs."""
    if densities.min() > 0 or densities.max() <= 0:
        return
    used = np.unique(branches)
    fixed = shape[used][held[used].any(axis=1)]
    size = np.ptp(fixed, axis=0).max() + np.abs(force).sum() / np.abs(densities).max()
    distance = np.linalg.norm(shape[used] - fixed.mean(axis=0), axis=1)
    far = int(distance.argmax())
    if distance[far] > MAX_DISTANCE * size:
        raise ValueError(
            f"These force densities put node {used[far]} {distance[far]:.3g} away, more than {MAX_DISTANCE:g} times "
            f"the size of the net's fixed nodes, {size:.3g}: those of both signs nearly cancel; give positive ones."
        )


def _not_unique(densities: NDArray[np.float64], branches: NDArray[np.int64]) -> str:
    least = int(np.argmin(densities))
    a, b = branches[least]
    remedy = "give positive ones"
    if densities[least] > 0:
        remedy = f"beside the largest, {densities.max():g}, it is lost in rounding: give ones nearer to each other"
    return (
        f"These force densities, down to {densities[least]:g} in branch {least} between nodes {a} and {b}, leave free "
        f"nodes without a unique equilibrium; {remedy}."
    )


def _held(fixed: Sequence[Support], n: int) -> NDArray[np.bool_]:
    held = np.zeros((n, 3), dtype=bool)
    for support in validation.instances("fixed", fixed, Support):
        nodes = np.asarray(support.nodes)
        validation.in_range("fixed", nodes, n, "node")
        for component in validation.components("Support components", support.components):
            held[nodes, component] = True
    return held


def _solve(
    laplacian: sparse.csr_matrix,
    held: NDArray[np.bool_],
    value: NDArray[np.float64],
    force: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Solve for one component of the shape; NaN if there is no unique solution."""
    free = ~held
    result = value.copy()
    if free.any():
        matrix = laplacian[free][:, free].tocsc()
        right = force[free] - laplacian[free][:, held] @ value[held]
        try:
            factors = splu(matrix, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})
            singular = np.abs(factors.U.diagonal()).min() <= 1e-13 * np.abs(laplacian).max()  # up to rounding
            result[free] = np.nan if singular else factors.solve(right)
        except RuntimeError:  # SuperLU: exactly singular
            result[free] = np.nan
    return result
