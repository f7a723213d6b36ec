"""Nets and meshes of COMPAS, from JSON files."""

import json

import numpy as np
import pytest

from fx_membrane import Support, force_density, read_compas, structure_from_file
from square_roofs import PARTS, POINTS, RIM, TRIANGLES

NODES = {str(10 + row): dict(zip("xyz", point, strict=True)) for row, point in enumerate(POINTS.tolist())}
NETWORK = {
    "dna": {"is_support": False, "pz": -2.0},
    "dea": {"q": 3.0},
    "node": {
        key: values | ({"is_support": True} if row in np.unique(RIM) else {})
        for row, (key, values) in enumerate(NODES.items())
    },
    "edge": {"10": {"11": {"q": 5.0}}, "14": {"15": {}, "18": None}},
}
MESH = {
    "vertex": NODES,
    "face": {str(row): [str(10 + node) for node in cell] for row, cell in enumerate(TRIANGLES.tolist())},
}


@pytest.mark.parametrize(
    "wrap",
    [
        lambda data: data,
        lambda data: {"dtype": "compas.datastructures/Graph", "data": data},
        lambda data: {"dtype": "compas.datastructures/Network", "value": {"compas": "1.0", "data": data}},
    ],
)
def test_compas(wrap, tmp_path):
    (tmp_path / "net.json").write_text(json.dumps(wrap(NETWORK)))
    net = read_compas(tmp_path / "net.json")
    assert np.array_equal(net.points, POINTS)
    assert net.edges.tolist() == [[0, 1], [4, 5], [4, 8]]
    assert net.force_densities.tolist() == [5.0, 3.0, 3.0]
    assert net.supports.tolist() == np.unique(RIM).tolist()
    assert net.loads.tolist() == [[0.0, 0.0, -2.0]] * len(POINTS)
    found = structure_from_file(tmp_path / "net.json", {"edges": PARTS["edge"]})
    assert len(found.points) == 5
    (tmp_path / "mesh.json").write_text(json.dumps(wrap(MESH)))
    found = structure_from_file(tmp_path / "mesh.json", {"faces": PARTS["Dach süd"], "edges": PARTS["edge"]})
    assert found.parts["faces"].cells.tolist() == TRIANGLES.tolist()
    assert len(found.parts["edges"].cells) == len(POINTS) + len(TRIANGLES) - 1  # Euler


def test_numbers_of_compas_come_to_the_last_bit(tmp_path):
    """JSON has the shortest decimals that give a number back."""
    points, branches = np.random.default_rng(5).normal(size=(4, 3)) * [1e-7, 1.0, 1e7], [[0, 1], [1, 2], [2, 3]]
    densities, loads = np.array([1 / 3, np.pi * 1e5, 1e-9 / 7]), np.sqrt(2.0) * points
    names = [
        dict(zip(("x", "y", "z", "px", "py", "pz"), [*at, *load], strict=True))
        for at, load in zip(points.tolist(), loads.tolist(), strict=True)
    ]
    edges = {str(a): {str(b): {"q": q}} for (a, b), q in zip(branches, densities.tolist(), strict=True)}
    net = {"dna": {}, "dea": {}, "node": {str(row): name for row, name in enumerate(names)}, "edge": edges}
    (tmp_path / "net.json").write_text(json.dumps(net))
    found = read_compas(tmp_path / "net.json")
    assert np.array_equal(found.points, points)
    assert np.array_equal(found.loads, loads)
    assert np.array_equal(found.force_densities, densities)


def test_edges_of_faces_with_many_corners_are_taken(tmp_path):
    mesh = MESH | {"face": {"0": [str(10 + node) for node in range(5)]}}
    (tmp_path / "mesh.json").write_text(json.dumps(mesh))
    found = structure_from_file(tmp_path / "mesh.json", {"edges": PARTS["edge"]})
    assert len(found.parts["edges"].cells) == 5
    with pytest.raises(ValueError, match="face with 5 corners"):
        structure_from_file(tmp_path / "mesh.json", {"faces": PARTS["Dach süd"]})


def test_compas_net_finds_its_form(tmp_path):
    data = NETWORK | {"edge": {str(10 + a): {str(10 + b): {}} for a, b in [(4, 5)]}}
    data["edge"] = {"14": {"15": {}, "18": {}, "13": {}, "11": {}}, "15": {"12": {}, "16": {}}}
    (tmp_path / "net.json").write_text(json.dumps(data))
    net = read_compas(tmp_path / "net.json")
    form = force_density(net.points, net.edges, net.force_densities, [Support(net.supports)])
    assert form.points.shape == POINTS.shape


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "line 1, column 1 is no JSON"),
        ("[]", "it has no nodes"),
        ("3", "it has no nodes|another form"),
        ('{"data": {}}', "it has no nodes"),
        ('{"node": {}}', "it has no nodes"),
        ('{"node": {"1": {}}, "edge": {"1": {"5": {}}}}', "names node '5'"),
        ('{"node": {"1": {}}, "face": {"0": [1, 7, 8]}}', "names node '7'"),
        ('{"vertex": {"1": {"x": "a"}}}', "'x' has 'a', which is no number"),
        ('{"vertex": {"1": {"x": 1e999}}}', "'x' has 'inf', which is no number"),
        ('{"node": [1, 2]}', "another form"),
        ('{"node": {"1": 3}}', "another form"),
    ],
)
def test_damaged_nets_are_told_in_words_of_the_file(text, words, tmp_path):
    (tmp_path / "a.json").write_text(text)
    with pytest.raises(ValueError, match=words) as told:
        read_compas(tmp_path / "a.json")
    assert "Error" not in str(told.value)
    assert "object" not in str(told.value)
