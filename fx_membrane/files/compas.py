"""COMPAS JSON: networks, graphs and meshes of compas, compas_fd and jax_fdm, of versions 0, 1 and 2."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..checks import paths
from .drawing import Drawing

EDGES, FACES, SUPPORTS = "edges", "faces", "supports"


class Net(NamedTuple):
    """Network or mesh of COMPAS, for `force_density` or as parts of a structure.

    Attributes:
        points: Positions of the nodes, in the order of the file, shape (n, 3).
        edges: Rows of the nodes of the edges, shape (edges, 2).
        faces: Rows of the nodes of the faces by number of corners, each of shape (faces, corners).
        supports: Rows of the nodes whose attribute `is_support` or `is_anchor` is true, shape (s,).
        force_densities: Attribute `q` of the edges, shape (edges,); zero without it.
        loads: Attributes `px`, `py`, `pz` of the nodes, shape (n, 3); zero without them.

    Example:
        >>> import json
        >>> from pathlib import Path
        >>> nodes = {"a": {"x": 0, "y": 0, "z": 0, "is_support": True}, "b": {"x": 3, "y": 0, "z": 1}}
        >>> _ = Path("net.json").write_text(json.dumps({"node": nodes, "edge": {"a": {"b": {"q": 2.0}}}}))
        >>> net = read_compas("net.json")
        >>> net.edges.tolist(), net.supports.tolist(), net.force_densities.tolist()
        ([[0, 1]], [0], [2.0])
    """

    points: NDArray[np.float64]
    edges: NDArray[np.int64]
    faces: dict[int, NDArray[np.int64]]
    supports: NDArray[np.int64]
    force_densities: NDArray[np.float64]
    loads: NDArray[np.float64]


def read_compas(source: str | Path) -> Net:
    """Read a network, graph or mesh that COMPAS wrote as JSON.

    Raises:
        ValueError: The file does not exist, is no JSON, or has no nodes.
    """
    file = paths.path("source", source, spare=0)
    try:
        data = _data(json.loads(file.read_text(encoding="utf-8")))
        nodes = data.get("node") or data.get("vertex")
        defaults = _first(data, "dna", "dva", "default_node_attributes", "default_vertex_attributes")
        row = _Rows({str(key): number for number, key in enumerate(nodes)})
        entries = [defaults | values for values in nodes.values()]
        pairs, weights = _edges(data, row)
        faces: dict[int, list[list[int]]] = {}
        for corners in data.get("face", {}).values():
            faces.setdefault(len(corners), []).append([row[str(key)] for key in corners])
        return Net(
            _numbers(entries, "xyz"),
            np.array(pairs, dtype=np.int64).reshape(-1, 2),
            {count: np.array(rows, dtype=np.int64) for count, rows in faces.items()},
            np.flatnonzero([bool(entry.get("is_support") or entry.get("is_anchor")) for entry in entries]),
            np.array(weights, dtype=np.float64),
            _numbers(entries, ("px", "py", "pz")),
        )
    except OSError as error:
        raise ValueError(f"source is {str(file)!r}: {error.strerror}; correct the name.") from None
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise ValueError(
            f"{file} is no network or mesh of COMPAS in JSON ({_reason(error)}); export it anew from COMPAS."
        ) from None


def read(file: Path) -> Drawing:
    """Read a net as a drawing, with the groups "edges", "faces" and "supports"."""
    net = read_compas(file)
    drawing = Drawing(str(file), "group", net.points)
    if len(net.edges):
        drawing.add(EDGES, net.edges)
    for count, faces in net.faces.items():
        if count in (3, 4):
            drawing.add(FACES, faces)
        else:
            words = f"{file} has a face with {count} corners; give triangles or quadrilaterals."
            drawing.refused[FACES] = words
            drawing.cells.setdefault(FACES, {})
    if len(net.supports):
        drawing.add(SUPPORTS, net.supports[:, None])
    return drawing


class _Rows(dict[str, int]):
    """Rows of nodes by their names in the file."""

    def __missing__(self, name: str) -> int:
        raise _UnfitError(f"an edge or a face names node {name[:40]!r}, which the file does not have")


class _UnfitError(ValueError):
    """Content that is no net, told in words of the file."""


def _reason(error: Exception) -> str:
    """Reason for which a file is no net, in words of the file."""
    if isinstance(error, json.JSONDecodeError):
        return f"line {error.lineno}, column {error.colno} is no JSON"
    if isinstance(error, UnicodeDecodeError):
        return "it is no text in UTF-8"
    return str(error) if isinstance(error, _UnfitError) else "its content has another form"


def _data(document: Any) -> Any:
    """Find the nodes below the wrappers of the versions."""
    while "node" not in document and "vertex" not in document:
        if not isinstance(document, dict) or not document.keys() & {"data", "value"}:
            raise _UnfitError("it has no nodes")
        document = document["data"] if "data" in document else document["value"]
    if not (document.get("node") or document.get("vertex")):
        raise _UnfitError("it has no nodes")
    return document


def _first(data: Any, *names: str) -> dict[str, Any]:
    return next((data[name] for name in names if data.get(name)), {})


def _edges(data: Any, row: dict[str, int]) -> tuple[list[tuple[int, int]], list[float]]:
    """Edges and their force densities: nested by node, or under names "u-v" or "(u, v)" beside a mesh."""
    defaults = _first(data, "dea", "default_edge_attributes")
    found: dict[tuple[int, int], float] = {}
    for start, ends in data.get("edge", {}).items():
        for end, values in (ends or {}).items():
            found[row[str(start)], row[str(end)]] = _number("q", (defaults | (values or {})).get("q"))
    if not found and data.get("face"):
        named = {
            frozenset(key.strip("()").replace(",", "-").replace(" ", "").split("-")): values
            for key, values in (data.get("edgedata") or {}).items()
        }
        for corners in data["face"].values():
            keys = [str(key) for key in corners]
            for start, end in zip(keys, keys[1:] + keys[:1], strict=True):
                if (row[end], row[start]) not in found:
                    values = named.get(frozenset((start, end))) or {}
                    found[row[start], row[end]] = _number("q", (defaults | values).get("q"))
    return list(found), list(found.values())


def _numbers(entries: list[dict[str, Any]], names: Any) -> NDArray[np.float64]:
    values = [[_number(name, entry.get(name)) for name in names] for entry in entries]
    return np.array(values, dtype=np.float64).reshape(-1, 3)


def _number(name: str, value: Any) -> float:
    """Read the number of an attribute; 0 without one."""
    try:
        found = float(value or 0.0)
    except (TypeError, ValueError):
        found = float("nan")
    if not math.isfinite(found):
        raise _UnfitError(f"the attribute {name!r} has {str(value)[:40]!r}, which is no number")
    return found
