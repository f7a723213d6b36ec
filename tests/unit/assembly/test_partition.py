"""Ownership and numbering of nodes."""

import numpy as np
import pytest

from fx_membrane import rectangle
from fx_membrane.assembly.partition import bisect, number_nodes
from fx_membrane.geometry.topology import node_graph


def test_node_graph_is_the_union_of_all_parts():
    graph = node_graph([np.array([[0, 1, 2], [1, 2, 3]]), np.array([[3, 4]])], 6).toarray()
    expected = np.zeros((6, 6), dtype=bool)
    for cell in ([0, 1, 2], [1, 2, 3], [3, 4]):
        expected[np.ix_(cell, cell)] = True
    assert (graph != 0).tolist() == expected.tolist()


@pytest.mark.parametrize("size", [1, 2, 3, 5, 8])
def test_bisect_gives_equal_shares(size):
    points, _ = rectangle(3.0, 1.0, 9, 6)
    shares = np.bincount(bisect(points, size), minlength=size)
    assert len(shares) == size
    assert shares.max() - shares.min() <= 1


@pytest.mark.parametrize("size", [2, 5])
def test_bisect_of_fewer_points_than_owners(size):
    owner = bisect(np.array([[0.0, 0, 0]]), size)
    assert owner.shape == (1,)
    assert 0 <= owner[0] < size


def test_bisect_cuts_across_the_longest_side():
    points = np.array([[0.0, 0, 0], [0, 0, 10], [1, 0, 0], [1, 0, 10]])
    owner = bisect(points, 2)
    assert owner[0] == owner[2] != owner[1] == owner[3]


@pytest.mark.parametrize("size", [1, 3])
def test_numbers_are_a_permutation_with_owners_in_order(size):
    points, triangles = rectangle(1.0, 1.0, 5, 5)
    owner = bisect(points, size)
    number = number_nodes(owner, node_graph([triangles], len(points)))
    assert sorted(number) == list(range(len(points)))
    assert (np.diff(owner[np.argsort(number)]) >= 0).all()


def test_numbering_keeps_neighbours_close():
    order = np.random.default_rng(7).permutation(50)
    chain = np.stack([order[:-1], order[1:]], axis=1)
    number = number_nodes(np.zeros(50, dtype=np.int32), node_graph([chain], 50))
    assert (np.abs(np.diff(number[order])) == 1).all()
