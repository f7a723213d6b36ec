"""Force density method: shapes by hand, balance of forces, and refused input."""

import numpy as np
import pytest

from fx_membrane import Analysis, Cable, Stage, Structure, Support, force_density
from fx_membrane.geometry.grids import rectangle

STAR = np.array([[2.0, 0, 0], [0, 2, 1], [-2, 0, 0], [0, -2, 3], [9, 9, 9]])  # four fixed nodes and a free one
ARMS = np.array([[4, 0], [1, 4], [4, 2], [3, 4]])
FOUR = [Support(range(4))]


def grid(n):
    """Square grid of (n + 1)^2 nodes: points, branches, the nodes of its rim."""
    points, _ = rectangle(2.0, 2.0, n, n)
    number = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    rows = np.column_stack([number[:, :-1].ravel(), number[:, 1:].ravel()])
    columns = np.column_stack([number[:-1].ravel(), number[1:].ravel()])
    rim = np.flatnonzero(np.abs(points[:, :2]).max(axis=1) == 1)
    return points, np.concatenate([rows, columns]), rim


def unbalanced(net, branches, q, loads):
    """Sum of branch forces and loads at each node, shape (n, 3)."""
    pull = np.broadcast_to(q, len(branches))[:, None] * (net.points[branches[:, 1]] - net.points[branches[:, 0]])
    total = np.array(loads, dtype=float)
    np.add.at(total, branches[:, 0], pull)
    np.add.at(total, branches[:, 1], -pull)
    return total


# Shapes


@pytest.mark.parametrize("q", [1.0, 250.0])
def test_one_free_node_is_at_the_mean_of_its_neighbours(q):
    net = force_density(STAR, ARMS, q, FOUR)
    assert net.points[4] == pytest.approx(STAR[:4].mean(axis=0), rel=1e-13, abs=1e-13)
    assert np.array_equal(net.points[:4], STAR[:4])
    lengths = np.linalg.norm(STAR[:4] - net.points[4], axis=1)
    assert net.forces["net"] == pytest.approx(q * lengths, rel=1e-13)


def test_one_free_node_is_at_the_weighted_mean_under_a_load():
    q = np.array([1.0, 2.0, 3.0, 4.0])
    loads = np.zeros((5, 3))
    loads[4] = 1.0, 0, -5.0
    net = force_density(STAR, ARMS, q, FOUR, loads)
    expected = (q @ STAR[:4] + loads[4]) / q.sum()
    assert net.points[4] == pytest.approx(expected, rel=1e-13)
    assert net.forces["net"] == pytest.approx(q * np.linalg.norm(STAR[:4] - expected, axis=1), rel=1e-13)


def test_positions_of_free_nodes_do_not_matter():
    other = STAR.copy()
    other[4] = -7, 3, 1e3
    assert force_density(other, ARMS, 1.0, FOUR).points == pytest.approx(force_density(STAR, ARMS, 1.0, FOUR).points)


def test_regular_net_of_equal_densities_is_discretely_harmonic():
    points, branches, rim = grid(12)
    # x y and x^2 - y^2 solve the five-point difference equation exactly.
    points[rim, 2] = (points[:, 0] * points[:, 1] + points[:, 0] ** 2 - points[:, 1] ** 2)[rim]
    net = force_density(points, branches, 3.0, [Support(rim)])
    assert net.points[:, :2] == pytest.approx(points[:, :2], abs=1e-12)
    x, y = points[:, 0], points[:, 1]
    assert net.points[:, 2] == pytest.approx(x * y + x**2 - y**2, abs=1e-12)


def test_regular_net_under_a_load_is_a_discrete_paraboloid():
    n, q, load = 10, 5.0, -0.2
    points, branches, rim = grid(n)
    points[rim, 2] = points[rim, 0] ** 2
    loads = np.zeros(points.shape)
    loads[:, 2] = load
    # q (z_left + z_right + z_up + z_down - 4 z) + load = 0, with z = a x^2 + b y^2 on the rim: a difference equation
    # that quadratic polynomials solve exactly.
    h = 2.0 / n
    b = -load / (2 * q * h**2) - 1.0
    points[rim, 2] = points[rim, 0] ** 2 + b * points[rim, 1] ** 2
    net = force_density(points, branches, q, [Support(rim)], loads)
    assert net.points[:, 2] == pytest.approx(points[:, 0] ** 2 + b * points[:, 1] ** 2, abs=1e-12)


def test_forces_and_loads_balance():
    rng = np.random.default_rng(2)
    points, branches, rim = grid(6)
    points = points + rng.normal(size=points.shape)
    q, loads = rng.uniform(0.5, 2, size=len(branches)), rng.normal(size=points.shape)
    corners = rim[[0, 6, -7, -1]]
    fixed = [Support(corners), Support(rim[3], "z"), Support([10, 24], "xy")]
    net = force_density(points, branches, q, fixed, loads)
    left, size = unbalanced(net, branches, q, loads), np.abs(net.reactions).max()
    assert left + net.reactions == pytest.approx(np.zeros(points.shape), abs=1e-12 * size)
    held = np.zeros(points.shape, dtype=bool)
    held[corners] = True
    held[rim[3], 2] = True
    held[np.array([10, 24]), :2] = True
    assert not net.reactions[~held].any()
    assert (np.abs(net.reactions[held]) > 1e-6).all()
    assert net.points[held].tolist() == points[held].tolist()
    assert net.reactions.sum(axis=0) == pytest.approx(-loads.sum(axis=0), abs=1e-12 * size * len(points))
    moments = np.cross(net.points, net.reactions + loads).sum(axis=0)
    assert moments == pytest.approx(np.zeros(3), abs=1e-11 * size * len(points))


def test_load_on_a_fixed_node_goes_into_its_reaction():
    loads = np.zeros((5, 3))
    loads[0] = 1, 2, 3
    net, bare = force_density(STAR, ARMS, 1.0, FOUR, loads), force_density(STAR, ARMS, 1.0, FOUR)
    assert net.points == pytest.approx(bare.points)
    assert net.reactions - bare.reactions == pytest.approx(-loads, abs=1e-13)


def test_node_fixed_in_one_component_slides_in_a_plane():
    # A node held in x alone, between two fixed ones: it goes to their mean in y and z.
    points = [[0.0, 0, 0], [0, 2, 4], [7, 5, 5]]
    net = force_density(points, [[0, 2], [1, 2]], 1.0, [Support([0, 1]), Support(2, "x")])
    assert net.points[2] == pytest.approx([7, 1, 2], rel=1e-13)
    assert net.reactions[2] == pytest.approx([14, 0, 0], rel=1e-13)


def test_negative_densities_may_have_an_equilibrium():
    # A strut under compression between pulling cables.
    points = [[-1.0, 0, 0], [1, 0, 0], [0, 0, -1], [0, 0, 0]]
    net = force_density(points, [[0, 3], [1, 3], [2, 3]], [2.0, 2.0, -1.0], [Support([0, 1, 2])])
    assert net.points[3] == pytest.approx([0, 0, 1 / 3], abs=1e-14)
    assert net.forces["net"][2] == pytest.approx(-4 / 3, rel=1e-13)


def test_negative_densities_throughout_are_the_same_net_in_compression():
    points, branches, rim = grid(6)
    points[rim, 2] = (points[:, 0] * points[:, 1])[rim]
    q = np.random.default_rng(3).uniform(0.5, 2, size=len(branches))
    net, strut = (force_density(points, branches, sign * q, [Support(rim)]) for sign in (1, -1))
    assert strut.points == pytest.approx(net.points, abs=1e-13)
    assert strut.forces["net"] == pytest.approx(-net.forces["net"], rel=1e-12)
    assert strut.reactions == pytest.approx(-net.reactions, abs=1e-12)


def test_nodes_that_no_branch_uses_stay():
    points = np.vstack([STAR, [[1.0, 2, 3], [4, 5, 6]]])
    loads = np.ones(points.shape)
    net = force_density(points, ARMS, 1.0, [*FOUR, Support(5)], loads)
    assert net.points[5:].tolist() == points[5:].tolist()
    assert net.reactions[5:].tolist() == [[0, 0, 0], [0, 0, 0]]


def test_all_nodes_fixed():
    net = force_density(STAR, ARMS, 1.0, [Support(range(5))])
    assert np.array_equal(net.points, STAR)
    assert net.reactions.sum(axis=0) == pytest.approx(np.zeros(3), abs=1e-12)


def test_two_nets_at_once():
    points = np.vstack([STAR, STAR + np.array([0, 0, 50])])
    net = force_density(points, np.vstack([ARMS, ARMS + 5]), 1.0, [Support([0, 1, 2, 3, 5, 6, 7, 8])])
    assert net.points[9] - net.points[4] == pytest.approx([0, 0, 50], rel=1e-13, abs=1e-13)


def test_parallel_branches_add_up():
    twice = force_density(STAR, [*ARMS.tolist(), [4, 0]], 1.0, FOUR)
    double = force_density(STAR, ARMS, [2.0, 1, 1, 1], FOUR)
    assert twice.points == pytest.approx(double.points, rel=1e-13)
    assert twice.reactions == pytest.approx(double.reactions, abs=1e-13)


def test_hundred_thousand_branches():
    points, branches, rim = grid(223)
    assert len(branches) > 99_000
    points[rim, 2] = (points[:, 0] * points[:, 1])[rim]
    net = force_density(points, branches, 1.0, [Support(rim)])
    assert net.points[:, 2] == pytest.approx(points[:, 0] * points[:, 1], abs=1e-9)


# Refusals


@pytest.mark.parametrize(
    ("fixed", "message"),
    [
        ([], r"^The part.*net.*node 0.*tied.*no fixed node"),
        ([Support(range(4), "xy")], r"^The part.*net.*node 0.*tied.*no fixed node"),
        ([Support(5)], r"^The part.*net.*node 0.*tied.*no fixed node"),
        ([Support(range(4)), Support(6, "yz")], r"^The part.*net.*node 6.*tied.*no fixed node"),
    ],
    ids=["no support", "free in z", "support on an unused node only", "second piece free in x"],
)
def test_net_without_enough_fixed_nodes(fixed, message):
    points = np.vstack([STAR, np.zeros((3, 3))])
    branches = ARMS.tolist()
    if any(6 in np.asarray(support.nodes) for support in fixed):
        branches.append([6, 7])
    with pytest.raises(ValueError, match=message):
        force_density(points, branches, 1.0, fixed)


@pytest.mark.parametrize("q", [0.0, [1.0, 1, -1, -1], [0.1, 0.2, -0.3, 0.0]], ids=str)
def test_densities_without_a_unique_equilibrium(q):
    with pytest.raises(ValueError, match=r"branch \d between nodes \d.*\d, leave.*without.*unique equilibrium.*p"):
        force_density(STAR, ARMS, q, FOUR)


def test_positive_densities_that_differ_too_much():
    points, branches = np.linspace([0.0, 0, 0], [1, 0, 0], 9), np.column_stack([range(8), range(1, 9)])
    q = np.where(np.arange(8) == 4, 1e14, 1.0)
    with pytest.raises(ValueError, match=r"1.*branch 0.*beside.*largest, 1e\+14.*lost.*rounding"):
        force_density(points, branches, q, [Support([0, 8])])


def test_densities_that_cancel_deep_in_a_net():
    points, branches, rim = grid(4)
    q = np.ones(len(branches))
    q[(branches == 12).any(axis=1)] = 0.0  # the node in the middle hangs on nothing
    with pytest.raises(ValueError, match=r"without.*unique equilibrium"):
        force_density(points, branches, q, [Support(rim)])


@pytest.mark.parametrize("rest", [1e-7, -1e-7])
def test_densities_that_nearly_cancel(rest):
    points = [[-1.0, 0, 0], [1, 0, 0], [0, 1, 0.5], [0, 0, 0]]
    with pytest.raises(ValueError, match=r"^These force densities.*node 3.*signs.*cancel"):
        force_density(points, [[3, 0], [3, 1], [3, 2]], [1.0, 1.0, -2.0 + rest], [Support([0, 1, 2])])


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"points": STAR[:, :2]}, r"^points has shape \(5, 2\); give \(n, 3\)"),
        ({"points": np.where(np.arange(5)[:, None] == 1, np.nan, STAR)}, r"^points has .* not finite \(nan\)"),
        ({"branches": [[0, 5]]}, "^branches names node 5.*not exist; nodes.*numbered 0 to 4"),
        ({"branches": [[-1, 0]]}, "^branches names node -1.*not exist"),
        ({"branches": [[0, 1, 2]]}, r"^branches must be .*\(n, 2\)"),
        ({"branches": [[0.0, 1.0]]}, "^branches.*array.*whole numbers"),
        ({"branches": np.empty((0, 2), dtype=int)}, "^branches must be .* n >= 1"),
        ({"branches": [[2, 2]]}, r"^branches: cell 0.*node twice"),
        ({"q": np.nan}, r"^q.*value.*not finite \(nan\)"),
        ({"q": [1.0, 1, np.inf, 1]}, r"^q.*value.*not finite \(inf\).*index \(2,\)"),
        ({"q": "tight"}, "^q.*array.*numbers"),
        ({"q": [1.0, 2.0]}, r"^q has shape \(2,\)"),
        ({"q": np.ones((4, 1))}, r"^q has shape \(4, 1\)"),
        ({"loads": np.zeros((4, 3))}, r"^loads.*shape \(4, 3\).*three components.*5 nodes"),
        ({"loads": (0.0, 0, -1)}, r"^loads has shape \(3,\)"),
        ({"loads": np.full((5, 3), np.inf)}, r"^loads.*value.*not finite"),
        ({"fixed": [Support([0, 5])]}, "^fixed names node 5.*not exist"),
        ({"fixed": [0, 1]}, "^fixed.*0.*list.*Support"),
        ({"fixed": Support(range(4))}, "^fixed.*list.*Support.*Support.*brackets"),
    ],
    ids=lambda value: value if isinstance(value, str) else next(iter(value)),
)
def test_refusals(change, message):
    with pytest.raises(ValueError, match=message):
        force_density(**{"points": STAR, "branches": ARMS, "q": 1.0, "fixed": FOUR, **change})


def test_input_is_not_changed():
    points, loads = STAR.copy(), np.ones(STAR.shape)
    net = force_density(points, ARMS, 1.0, FOUR, loads)
    assert np.array_equal(points, STAR)
    assert (loads == 1).all()
    assert not np.shares_memory(net.points, points)


def test_form_of_a_net_has_no_structure():
    form = force_density(STAR, ARMS, 1.0, FOUR)
    with pytest.raises(ValueError, match=r"no stiffness.*Cable\(branches"):
        _ = form.structure
    assert repr(form) == "Form(5 points, 0 steps, converged=True)"
    net = Structure(form.points, {"net": Cable(ARMS, 1e6, form.forces["net"])}, FOUR)
    rest = Analysis(net).run([Stage("rest")])["rest"]
    assert np.abs(rest.displacement).max() < 1e-14
    assert rest.reactions == pytest.approx(form.reactions, abs=1e-12)
