"""Mesh files in a process that has not started gmsh; files that would run commands, or end gmsh."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI

from fx_membrane import Cable, Fabric, Membrane, structure_from_gmsh
from fx_membrane.files import gmsh_file, gmsh_reader

pytest.importorskip("gmsh")
PARTS = {
    "fabric": lambda cells: Membrane(cells, Fabric(Et=500e3, nu=0.3), prestress=1e3),
    "cable": lambda cells: Cable(cells, axial_stiffness=1e6, prestress=1e4),
}
SOURCES = str(Path(__file__).parents[3])  # where the package is not installed
FORMATS = [(2.2, 0), (2.2, 1), (4.0, 0), (4.1, 0), (4.1, 1)]  # version, binary (gmsh writes no binary 4.0)
WRITE = """
import gmsh
gmsh.initialize(readConfigFiles=False)
gmsh.option.setNumber("General.Terminal", 0)
surface = gmsh.model.occ.addRectangle(0, 0, 0, 2, 1)
gmsh.model.occ.synchronize()
sides = [tag for _, tag in gmsh.model.getBoundary([(2, surface)], oriented=False)]
for name, dimension, tags in [("fabric", 2, [surface]), ("cable", 1, sides[:1]), ("fixed", 1, sides[2:3])]:
    gmsh.model.setPhysicalName(dimension, gmsh.model.addPhysicalGroup(dimension, tags), name)
gmsh.option.setNumber("Mesh.MeshSizeMax", 0.5)
gmsh.model.mesh.generate(2)
for version, binary in FORMATS:
    gmsh.option.setNumber("Mesh.MshFileVersion", version)
    gmsh.option.setNumber("Mesh.Binary", binary)
    gmsh.write(f"{version}-{binary}.msh")
"""
READ = """
import sys
from fx_membrane import Cable, Fabric, Membrane, structure_from_gmsh
structure = structure_from_gmsh(
    sys.argv[1],
    {"fabric": lambda cells: Membrane(cells, Fabric(5e5, 0.3), 1e3), "cable": lambda cells: Cable(cells, 1e6)},
    {"fixed": "xyz"},
)
print(len(structure.points), structure.supported.all(axis=1).sum(), len(structure.parts["cable"].cells))
assert "gmsh" not in sys.modules
"""
REFUSED = """
import sys
from fx_membrane import structure_from_gmsh

def read(*names):
    for name in names:
        try:
            structure_from_gmsh(name, {"fabric": list})
        except ValueError as error:
            print(str(error).split(",")[0])

read(None, *sys.argv[1:])
import gmsh
read(None)
gmsh.initialize()
read(*sys.argv[1:])
gmsh.finalize()
read(None)
"""


def python(code, *arguments, **options):
    command = [sys.executable, "-c", code, *map(str, arguments)]
    environment = options.pop("env", os.environ) | {"PYTHONPATH": SOURCES}
    return subprocess.run(command, capture_output=True, text=True, check=False, env=environment, **options)


def script(folder):
    """Script that gmsh would run, in any working directory of the reader."""
    return f'SystemCall "touch {folder}/ran";\nPrintf("hi") > "{folder}/printed";\n'


@pytest.fixture(scope="module")
def meshes(tmp_path_factory):
    """Write one mesh in all formats in another process: this one has not started gmsh."""
    folder = tmp_path_factory.mktemp("meshes")
    written = python(WRITE.replace("FORMATS", str(FORMATS)), cwd=folder)
    assert written.returncode == 0, written.stderr
    return folder


@pytest.fixture
def good(meshes, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return Path(shutil.copy(meshes / "4.1-0.msh", tmp_path / "roof.msh"))


def test_mesh_in_a_fresh_process_that_reads_no_configuration_of_the_user(good, tmp_path):
    (tmp_path / ".gmshrc").write_text(script(tmp_path))
    read = python(READ, good, cwd=tmp_path, env={**os.environ, "HOME": str(tmp_path), "GMSH_HOME": str(tmp_path)})
    assert read.returncode == 0, read.stderr
    nodes, held, segments = map(int, read.stdout.split())
    assert nodes > 15
    assert held == segments + 1  # the opposite side, of the same length
    assert not (tmp_path / "ran").exists()


@pytest.mark.mpi
def test_all_formats_give_the_same(meshes):
    formats = FORMATS if MPI.COMM_WORLD.size == 1 else FORMATS[::4]  # each is a process of gmsh
    first, *others = (
        structure_from_gmsh(meshes / f"{version}-{binary}.msh", PARTS, {"fixed": "xyz"}) for version, binary in formats
    )
    assert first.supported.any()
    for other in others:
        np.testing.assert_allclose(other.points, first.points, rtol=0, atol=1e-14)
        np.testing.assert_array_equal(other.supported, first.supported)
        for name in PARTS:
            np.testing.assert_array_equal(other.parts[name].cells, first.parts[name].cells)


def test_script_is_not_run_and_no_model_is_told(tmp_path):
    """Before gmsh is loaded, while it is initialized, and after it has ended."""
    names = ["roof.msh", "roof.geo", "roof.msh.opt", "roof.opt", "roof.py"]
    for name in names:
        (tmp_path / name).write_text(script(tmp_path))
    told = python(REFUSED, *names, cwd=tmp_path).stdout.splitlines()
    asked = [None, *names, None, *names, None]
    for line, source in zip(told, asked, strict=True):
        wanted = (source, "$MeshFormat") if source else ("No gmsh model is open", "gmsh.initialize()")
        assert all(words in line for words in wanted)
    assert sorted(file.name for file in tmp_path.iterdir()) == sorted(names)


@pytest.mark.parametrize("where", ["beside", "comments", "between", "after", "post"])
def test_script_with_a_good_mesh_is_not_run(where, good):
    text, evil = good.read_text(), script(good.parent)
    beside = good.with_name("roof.msh.opt")
    begin, post = "$EndMeshFormat\n", "$PostFormat\n1.4 0 8\n$EndPostFormat\n"
    file, content = {
        "beside": (beside, evil),
        "comments": (good, text.replace(begin, f"{begin}$Comments\n{evil}$EndComments\n")),
        "between": (good, text.replace(begin, begin + evil)),
        "after": (good, text + evil),
        "post": (good, text + post + evil),
    }[where]
    file.write_text(content)
    assert len(structure_from_gmsh(good, PARTS).points) > 15
    assert {file.name for file in Path().iterdir()} <= {good.name, beside.name}


def test_what_the_user_has_open_stays(good):
    import gmsh  # noqa: PLC0415

    gmsh.initialize()
    try:
        gmsh.model.add("mine")
        gmsh.option.setNumber("General.Terminal", 1)
        before = gmsh.model.list(), gmsh.model.getCurrent()
        structure_from_gmsh(good, PARTS)
        assert (gmsh.model.list(), gmsh.model.getCurrent()) == before
        assert gmsh.option.getNumber("General.Terminal") == 1
    finally:
        gmsh.finalize()


@pytest.mark.mpi_once
@pytest.mark.parametrize("share", [0.02, 0.2, 0.5, 0.8, 0.97])
@pytest.mark.parametrize("name", ["2.2-0", "4.1-1"])
def test_truncated_mesh(name, share, meshes, tmp_path):
    whole = (meshes / f"{name}.msh").read_bytes()
    file = tmp_path / "roof.msh"
    file.write_bytes(whole[: int(share * len(whole))])
    with pytest.raises(ValueError, match=r"roof\.msh (is not a file.*gmsh can|begins.*mesh.*no)"):
        structure_from_gmsh(file, PARTS)


@pytest.mark.mpi_once
@pytest.mark.parametrize(
    ("ending", "words"),
    [
        ("import time; time.sleep(60)", "gmsh.*stopped, after 1 s"),
        ("while True: pass", "gmsh.*stopped, after 1 s"),
        ("import os; os.abort()", "gmsh ended by SIGABRT"),
        ("import os, signal; os.kill(os.getpid(), signal.SIGSEGV)", "gmsh ended by SIGSEGV"),
        ("raise MemoryError('8 TB')", "MemoryError: 8 TB"),
    ],
)
def test_reader_that_aborts_or_never_ends(ending, words, good, tmp_path, monkeypatch):
    reader = tmp_path / "reader.py"
    reader.write_text(ending)
    monkeypatch.setattr(gmsh_reader, "__file__", str(reader))
    monkeypatch.setattr(gmsh_file, "SECONDS", 1)
    monkeypatch.setattr(gmsh_file, "BUSY", 1 if "stopped" in words else 60)
    with pytest.raises(ValueError, match=rf"roof\.msh.*damaged.*no file.*gmsh.*read \({words}"):
        structure_from_gmsh(good, PARTS)


def test_reader_that_waits_for_a_busy_machine(good, tmp_path, monkeypatch):
    """A sound file was called damaged where gmsh was 60 s by the clock without a core."""
    reader = tmp_path / "reader.py"
    script = gmsh_reader.__file__
    reader.write_text(f"import runpy, time\ntime.sleep(3)\nrunpy.run_path({script!r}, run_name='__main__')\n")
    monkeypatch.setattr(gmsh_reader, "__file__", str(reader))
    monkeypatch.setattr(gmsh_file, "SECONDS", 2)
    assert structure_from_gmsh(good, PARTS).points.size


@pytest.mark.mpi_once
@pytest.mark.parametrize(
    ("source", "message"),
    [
        (5, "^source is 5; give"),
        ("no.msh", "^There.*no file no.msh.*name"),
        ("", "^source is ''; give"),
        ("..", r"^\.\..*folder.*name.*gmsh mesh"),
        ("/dev/zero", "^/dev/zero.*no ordinary file"),
        ("a\0b.msh", "^source is .* without zero bytes"),
        ("/proc/self/mem", r"^/proc/self/mem.*read \(Input/output error\).*readable"),
    ],
)
def test_source_that_is_no_file(source, message):
    with pytest.raises(ValueError, match=message):
        structure_from_gmsh(source, PARTS)


def test_cells_at_nodes_that_the_file_does_not_have(good):
    """A damaged file; its large node number once made an array of that size."""
    good.write_text(
        '$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 1 "fabric"\n$EndPhysicalNames\n'
        "$Nodes\n3\n1 0 0 0\n2 1 0 0\n999999999 0 1 0\n$EndNodes\n$Elements\n1\n1 2 2 1 1 1 2 999999999\n$EndElements\n"
    )
    assert structure_from_gmsh(good, {"fabric": PARTS["fabric"]}).points.shape == (3, 3)
