"""Tables on disk and for pandas: every number comes back, names are no formulas."""

import csv
import json

import numpy as np
import pytest
from mpi4py import MPI

from fx_membrane import (
    Analysis,
    PointLoad,
    Pressure,
    Stage,
    write_tables,
)
from models import HEAD, masted_roof


@pytest.fixture(scope="module")
def results():
    structure = masted_roof(("=roof", 'edge, "A"', "mast"))
    up = Stage("Überdruck\n+1", [Pressure(50.0, "=roof")])
    return Analysis(structure).run([up, Stage("load", [PointLoad(HEAD, (0, 0, -5))])])


def rows(path):
    with path.open(encoding="utf-8-sig", newline="") as stream:
        return list(csv.DictReader(stream))


def numbers(table, head):
    return [float(row[head]) for row in table]


def test_tables_have_every_number(results, tmp_path):
    write_tables(results, tmp_path / "new" / "folder", force_unit="kN")
    folder = tmp_path / "new" / "folder"
    assert sorted(path.name for path in folder.iterdir()) == [
        "cables.csv",
        "masts.csv",
        "membranes.csv",
        "nodes.csv",
        "summary.json",
    ]
    nodes, cells, cables = rows(folder / "nodes.csv"), rows(folder / "membranes.csv"), rows(folder / "cables.csv")
    load, n = results["load"], len(results["load"].displacement)
    assert [row["stage"] for row in nodes[::n]] == ["Überdruck\n+1", "load"]
    for axis, letter in enumerate("xyz"):
        assert np.array_equal(
            [float(row[f"displacement {letter} [m]"]) for row in nodes[n:]], load.displacement[:, axis]
        )
        assert np.array_equal([float(row[f"reaction {letter} [kN]"]) for row in nodes[n:]], load.reactions[:, axis])
    assert {row["part"] for row in cells} == {"'=roof"}
    assert {row["part"] for row in cables} == {'edge, "A"'}
    membrane = load.membrane("=roof")
    half = len(membrane.state)
    assert [row["state"] for row in cells[half:]] == membrane.state.tolist()
    assert np.array_equal(
        [float(row["stress along warp [kN/m]"]) for row in cells[half:]], membrane.warp_weft_stress[:, 0]
    )
    assert sum(float(row["area [m2]"]) for row in cells[half:]) == pytest.approx(4.0, rel=1e-14)


def test_every_column_comes_back_to_the_last_bit(results, tmp_path):
    pytest.importorskip("pandas")
    write_tables(results, tmp_path)
    load = results["load"]
    parts = list(load.structure.parts)
    for file, names in [("nodes", [None]), ("membranes", parts[:1]), ("cables", parts[1:2]), ("masts", parts[2:])]:
        written = [row for row in rows(tmp_path / f"{file}.csv") if row["stage"] == "load"]
        for name in names:
            frame = load.to_dataframe(name)
            assert len(frame) == len(written)
            heads = [head for head in frame if frame[head].dtype.kind in "fiu"]
            assert len(heads) > 3
            assert set(frame) <= set(written[0])
            for head in heads:
                assert np.array_equal(numbers(written, head), frame[head], equal_nan=True), head


def test_summary(results, tmp_path):
    write_tables(results, tmp_path)
    found = json.loads((tmp_path / "summary.json").read_text())
    load, told = results["load"], found["stages"]["load"]
    assert found["units"] == {"force": "N", "length": "m"}
    assert told["sum of loads"] == load.equilibrium.loads.tolist()
    largest = told["parts"]['edge, "A"']["force"]["largest"]
    force = load.cable('edge, "A"').force
    assert largest["value"] == pytest.approx(force.max(), rel=1e-9)
    assert force[largest["cell"]] == largest["value"]
    assert told["parts"]["=roof"]["taut cells"] == int((load.membrane("=roof").state == "taut").sum())
    assert told["largest displacement"]["value"] == pytest.approx(load.largest_displacement)


def test_dataframes(results):
    pytest.importorskip("pandas")
    load = results["load"]
    nodes, cells = load.to_dataframe(length_unit="ft"), load.to_dataframe("=roof")
    assert np.array_equal(nodes["displacement z [ft]"], load.displacement[:, 2])
    assert np.array_equal(cells["principal stress I [N/m]"], load.membrane("=roof").principal[:, 0])
    with pytest.raises(ValueError, match=r"'other'.*=roof"):
        load.to_dataframe("other")


def test_refusals(results, tmp_path):
    (tmp_path / "file").write_text("x")
    with pytest.raises(ValueError, match="file"):
        write_tables(results, tmp_path / "file")
    with pytest.raises(ValueError, match="force_unit"):
        write_tables(results, tmp_path / "out", force_unit=5)
    with pytest.raises(ValueError, match="StageResults"):
        write_tables(results["load"], tmp_path / "out")
    assert not (tmp_path / "out").exists()


@pytest.mark.mpi
def test_first_process_writes(results, tmp_path_factory):
    folder = MPI.COMM_WORLD.bcast(tmp_path_factory.mktemp("tables"))
    write_tables(results, folder / "out")
    MPI.COMM_WORLD.barrier()
    assert len(rows(folder / "out" / "nodes.csv")) == 2 * len(results["load"].displacement)
