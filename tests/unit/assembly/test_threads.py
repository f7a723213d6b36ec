"""Compilation is safe in threads, which find the same code and leave the process as it was; PETSc is not."""

import logging
import threading
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
import ufl
from dolfinx import fem

from fx_membrane import _dolfinx


def test_threads_find_the_same_code():
    mesh = _dolfinx.create_mesh(np.eye(3), np.array([[0, 1, 2]]))
    dx = ufl.Measure("dx", domain=mesh, metadata={"quadrature_degree": 1})
    area = np.sqrt(3) / 2
    numbers = [2.0, 3.0, 5.0, 7.0] * 4

    def integral(number):
        return float(fem.assemble_scalar(_dolfinx.form(number * (ufl.SpatialCoordinate(mesh)[0] + 1) * dx)))

    with ThreadPoolExecutor(4) as threads:
        assert list(threads.map(integral, numbers)) == pytest.approx([n * 4 / 3 * area for n in numbers], rel=1e-12)


def test_threads_leave_logging_as_it_was(monkeypatch):
    """The second thread took the silence of the first for the state to restore, and kept the process silent."""
    monkeypatch.setattr(logging.root.manager, "disable", logging.NOTSET)
    inside, over = threading.Event(), threading.Event()

    def first():
        inside.set()
        over.wait(0.2)  # the second thread compiles meanwhile, if it may

    def second():
        over.wait(5)

    with ThreadPoolExecutor(2) as threads:
        one = threads.submit(_dolfinx._compile, first)
        assert inside.wait(5)
        other = threads.submit(_dolfinx._compile, second)
        one.result()
        over.set()
        other.result()
    assert logging.root.manager.disable == logging.NOTSET
