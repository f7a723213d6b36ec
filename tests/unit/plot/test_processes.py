"""Pictures under MPI: the first process draws, all wait, all raise."""

import numpy as np
import pytest
from mpi4py import MPI

from fx_membrane import Fabric, Membrane, Structure, plot, rectangle
from fx_membrane.plot import windows


def test_the_first_process_draws(tmp_path, monkeypatch):
    pytest.importorskip("pyvista")
    monkeypatch.setattr(windows, "LONGER", 200)
    folder = MPI.COMM_WORLD.bcast(tmp_path)
    points, triangles = rectangle(2.0, 2.0, 2, 2)
    strip = Structure(points, {"strip": Membrane(triangles, Fabric(1e5, 0.3), (2e3, 1e3), warp=(1, 0, 0))})
    plot.trajectories(strip, folder / "strip.png", view=(0, 0, 1), spacing=0.5)
    plot.animation([strip, strip], folder / "strip.gif", fields=lambda shape: {"height": shape.points[:, 0]})
    assert (folder / "strip.png").exists()
    assert (folder / "strip.gif").exists()
    with pytest.raises(ValueError, match=r"^spacing"):
        plot.trajectories(strip, folder / "never.png", spacing=-np.pi)
