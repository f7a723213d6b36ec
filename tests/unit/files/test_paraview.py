"""Series for ParaView, read back by pyvista's own readers."""

import errno
import os
import subprocess
import sys
import textwrap
from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI

from fx_membrane import (
    Analysis,
    Cable,
    Fabric,
    Membrane,
    ParaViewSeries,
    PointLoad,
    Pressure,
    SeriesWarning,
    Stage,
    Structure,
    Support,
    boundary_edges,
    rectangle,
    write_paraview,
)

pyvista = pytest.importorskip("pyvista")

POINTS, TRIANGLES = rectangle(2.0, 2.0, 4, 4)
RIM = boundary_edges(TRIANGLES)
STAGES = [
    Stage("wind", [Pressure(50.0, 'roof <"A"> & co')], increments=2),
    Stage("load", [PointLoad(12, (0, 0, -5.0))], after="wind"),
]


def structure():
    parts = {
        'roof <"A"> & co': Membrane(TRIANGLES, Fabric(4e5, 0.3), (2e3, 1e3), warp=(1, 0, 0)),
        "edge": Cable(RIM, 1e6, 1e2),
    }
    return Structure(POINTS, parts, [Support(np.unique(RIM))])


def steps(folder):
    """Read the series as ParaView does: times, and blocks by name at each of them."""
    reader = pyvista.PVDReader(folder / "series.pvd")
    found = {}
    for time in reader.time_values:
        reader.set_active_time_value(time)
        found[time] = reader.read()[0]
    return found


def test_series_has_every_increment(tmp_path):
    states = []
    series = ParaViewSeries(tmp_path / "out", force_unit="kN")

    def observe(state):
        states.append(state)
        series(state)

    results = Analysis(structure()).run(STAGES, observe=observe)
    found = steps(tmp_path / "out")
    assert list(found) == [0.5, 1.0, 2.0]
    assert [state.name for state in states] == ["wind", "wind", "load"]
    for blocks, state in zip(found.values(), states, strict=True):
        assert blocks.keys() == list(state.parts)
        roof, edge = blocks[0], blocks[1]
        membrane = state.membrane('roof <"A"> & co')
        assert np.array_equal(roof.points, POINTS)
        assert np.array_equal(roof.cells_dict[5], state.structure.parts['roof <"A"> & co'].cells)
        assert np.array_equal(roof["displacement"], state.displacement)
        assert np.array_equal(roof["principal stress I [kN/m]"], membrane.principal[:, 0])
        assert np.array_equal(roof["Cauchy stress [kN/m]"].reshape(-1, 3, 3), membrane.cauchy)
        assert np.array_equal(edge["force [kN]"], state.cable("edge").force)
        assert np.array_equal(edge["displacement"], state.displacement[edge["node"]])
        assert roof.field_data["stage"][0] == state.name
    assert np.array_equal(states[-1].displacement, results["load"].displacement)


def test_final_states(tmp_path):
    results = Analysis(structure()).run(STAGES)
    write_paraview(results, tmp_path)
    assert list(steps(tmp_path)) == [1.0, 2.0]
    write_paraview(results, tmp_path)
    assert list(steps(tmp_path)) == [1.0, 2.0]


def test_continued_run_appends(tmp_path):
    Analysis(structure()).run(STAGES[:1], tmp_path / "checkpoint", ParaViewSeries(tmp_path / "out"))
    Analysis(structure()).run(STAGES, tmp_path / "checkpoint", ParaViewSeries(tmp_path / "out", append=True))
    assert list(steps(tmp_path / "out")) == [0.5, 1.0, 2.0]


def test_kill_leaves_a_readable_series(tmp_path):
    script = f"""
        import os, signal
        from fx_membrane import Analysis, ParaViewSeries, Pressure, Stage
        import sys
        sys.path.insert(0, {str(Path(__file__).parent)!r})
        from test_paraview import structure
        series, count = ParaViewSeries({str(tmp_path / "out")!r}), []
        def observe(state):
            count.append(state)
            if len(count) == 4:
                os.kill(os.getpid(), signal.SIGKILL)
            series(state)
        Analysis(structure()).run([Stage("wind", [Pressure(50.0, 'roof <"A"> & co')], increments=8)], observe=observe)
    """
    ended = subprocess.run([sys.executable, "-c", textwrap.dedent(script)], check=False, capture_output=True)
    assert ended.returncode == -9, ended.stderr.decode()
    found = steps(tmp_path / "out")
    assert list(found) == [0.125, 0.25, 0.375]


def test_full_disk_warns_and_the_run_goes_on(tmp_path, monkeypatch):
    """The second of the steps meets a full disk, in a new folder and in that of an earlier series."""
    for _ in range(2):
        series, written = ParaViewSeries(tmp_path), []

        def fsync(number, whole=os.fsync, written=written):
            written.append(number)
            if len(written) > 5:  # two parts, the step, the series, and a part of the second step
                raise OSError(errno.ENOSPC, "No space left on device")
            whole(number)

        monkeypatch.setattr(os, "fsync", fsync)
        with pytest.warns(SeriesWarning, match="No space left"):
            results = Analysis(structure()).run(STAGES, observe=series)
        monkeypatch.undo()
        assert list(results) == ["wind", "load"]
        assert list(steps(tmp_path)) == [0.5]
        assert sorted(entry.name for entry in tmp_path.iterdir()) == ["0001", "0001.vtm", "series.pvd"]


def test_file_system_without_room_ends_no_process(tmp_path):
    script = f"""
        import resource, signal, sys
        sys.path.insert(0, {str(Path(__file__).parent)!r})
        from test_paraview import STAGES, structure
        from fx_membrane import Analysis, write_paraview
        results = Analysis(structure()).run(STAGES[:1])
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000))
        write_paraview(results, {str(tmp_path / "out")!r})
        print("goes on")
    """
    ended = subprocess.run([sys.executable, "-c", textwrap.dedent(script)], check=False, capture_output=True, text=True)
    assert ended.returncode == 0, ended.stderr
    assert "goes on" in ended.stdout
    assert "SeriesWarning: Stage 'wind' is not in the series" in ended.stderr
    assert "cannot be written" in ended.stderr


def test_fields_have_the_order_of_the_tables(tmp_path):
    write_paraview(Analysis(structure()).run(STAGES[:1]), tmp_path)
    fields = steps(tmp_path)[1.0]["edge"].cell_data.keys()
    assert fields == ["state", "cell", "length [m]", "strain [-]", "force [N]"]


def test_refusals(tmp_path):
    (tmp_path / "file").write_text("x")
    with pytest.raises(ValueError, match="file"):
        ParaViewSeries(tmp_path / "file")
    with pytest.raises(ValueError, match="observe"):
        Analysis(structure()).run(STAGES, observe="series")


@pytest.mark.mpi
def test_first_process_writes(tmp_path_factory):
    folder = MPI.COMM_WORLD.bcast(tmp_path_factory.mktemp("series"))
    results = Analysis(structure()).run(STAGES, observe=ParaViewSeries(folder))
    MPI.COMM_WORLD.barrier()
    assert np.array_equal(steps(folder)[2.0][0]["displacement"], results["load"].displacement)


def test_state_that_was_saved_but_not_shown_is_shown_after_a_restart(tmp_path):
    """A kill may come between the two."""
    stages = [Stage("wind", [Pressure(50.0, 'roof <"A"> & co')], increments=4)]
    shown = []

    def observe(state):
        shown.append(state.increments[-1].load_factor)
        if len(shown) == 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        Analysis(structure()).run(stages, checkpoint_file=tmp_path / "run.sqlite", observe=observe)
    Analysis(structure()).run(stages, checkpoint_file=tmp_path / "run.sqlite", observe=observe)
    assert shown == [0.25, 0.5, 0.5, 0.75, 1.0]
