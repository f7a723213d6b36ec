"""Archive of results, forms and cutting patterns: one file that is opened without the script.

It is a zip of arrays and a JSON document, and holds numbers and texts only. Opening it runs no code of the file.
"""

from __future__ import annotations

import importlib.metadata
import json
import zipfile
import zlib
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, cast, get_args

import numpy as np
from mpi4py import MPI
from numpy.typing import NDArray

from ..assembly.actions import ActingPond, Actions
from ..assembly.gas import ChamberResult
from ..checks import paths, validation
from ..form_finding.form import Form, FormStep
from ..model import materials
from ..model.basins import Basin, StandingWater
from ..model.cable_changes import FixedLength, GivenForce, UnstressedLength
from ..model.chambers import Chamber
from ..model.changes import LengthChange, NaturalStretch, PrestressFactor, TemperatureChange
from ..model.energy_terms import Acting
from ..model.gas import Air, Ambient, Gas, GasAmount, GasPressure, GasVolume, Seal
from ..model.loads import OwnLoad
from ..model.parts import Part
from ..model.stages import PrescribedDisplacement, Stage
from ..model.structure import Structure
from ..model.supports import Support
from ..model.water_events import BasinResult, WaterEvent
from ..patterns.flat_strips import CuttingPattern, FlatStrip, Side
from ..patterns.proofs import PatternProof
from ..patterns.seam_lengths import SeamLengths
from ..patterns.stress_fit import StressErrors, StressFit
from ..patterns.strip_proofs import StripProof
from ..patterns.strips import Edge, Strips
from ..results.balance import UnbalancedStateWarning
from ..results.forces_of_state import Equilibrium, PondResult, TermResult
from ..results.limits import Limits
from ..results.load_increments import Increment
from ..results.part_results import BarResult, MembraneResult, RopeResult
from ..results.shear_signs import ShearSignWarning
from ..results.states import StageResult, StageResults
from ..results.strain_limits import LargeStrainWarning
from ..results.told_states import CrushedGasWarning, LostPrestressWarning, UnstableStateWarning
from ..results.unfinished_stages import Failure
from ..runtime.processes import by_the_first, together
from ..solvers.base import Iteration
from ..solvers.outcome import Outcome
from .plain_data import Decoder, Encoder
from .whole_file import writing

FORMAT = 9  # counts up with fields
# Formats without them: 1 title, units and limits; 2 failure; 3 units of forms; 4 changes; 5 ropes, ponds and gas;
# 6 basins of ponds; 7 cutting patterns; 8 ways between basins, and utilisation of cells of strips.
KIND = "results of fx_membrane"
DOCUMENT = "document.json"
MODEL = (Structure, *get_args(Part), Support, Chamber, *materials.SHIPPED)
STAGES = (Stage, PrescribedDisplacement, *get_args(OwnLoad))
CHANGES = (
    *(NaturalStretch, TemperatureChange, LengthChange, PrestressFactor),
    *(GivenForce, UnstressedLength, FixedLength),
)
GAS = (Ambient, GasPressure, GasVolume, GasAmount, Seal, Gas, Air, ChamberResult)
STATES = (
    StageResult,
    Limits,
    Actions,
    Acting,
    Equilibrium,
    MembraneResult,
    BarResult,
    RopeResult,
    TermResult,
    PondResult,
    *(ActingPond, Basin, StandingWater, BasinResult, WaterEvent),
)
HISTORY = (Increment, Iteration, Outcome)
FORMS = (Form, FormStep)
PATTERNS = (
    Strips,
    Edge,
    CuttingPattern,
    FlatStrip,
    Side,
    PatternProof,
    StripProof,
    SeamLengths,
    StressFit,
    StressErrors,
)
REMARKS = (
    *(UnstableStateWarning, LostPrestressWarning, UnbalancedStateWarning, LargeStrainWarning, ShearSignWarning),
    CrushedGasWarning,
)
DAMAGED = (  # what a file raises that is none
    *(zipfile.BadZipFile, json.JSONDecodeError, UnicodeDecodeError, KeyError, TypeError, IndexError, AttributeError),
    *(EOFError, NotImplementedError, zlib.error, RuntimeError, OverflowError, MemoryError, RecursionError),
)
CLASSES: dict[str, type] = {
    cls.__name__: cls for cls in (*MODEL, *STAGES, *CHANGES, *GAS, *STATES, *HISTORY, *REMARKS, *FORMS, *PATTERNS)
}
GROWN = (*STATES, *HISTORY, *FORMS, *PATTERNS)  # classes whose fields are None where an earlier version had none
WHOLE = (Form, Strips, CuttingPattern, PatternProof)  # kept as they are; results of stages have names beside them
Saved = StageResults | Form | Strips | CuttingPattern | PatternProof


@by_the_first
def save_results(results: Saved, path: str | Path) -> None:
    """Save the results of an analysis, a form, or a cutting pattern, in one file.

    It has structure, stages, all arrays to the last bit, versions of the programs and a format number. It is written
    aside first: an existing file is replaced only by a complete one. Under MPI call it on all processes; the first one
    writes.

    Args:
        results: What `Analysis.run` returned, or `ConvergenceError.results`; a form; strips, a cutting pattern or its
            proof.
        path: The file, of any name; its folder is made.

    Raises:
        ValueError: The results are of another kind; a law or a term of your own is no dataclass of plain data; the file
            cannot be written.

    Example:
        >>> points = [(0, 0, 0), (3, 0, 0), (6, 0, 0)]
        >>> rope = Structure(points, {"rope": Cable(polyline([0, 1, 2]), 1e6, prestress=1e3)}, [Support([0, 2])])
        >>> results = Analysis(rope).run([Stage("pull", [PointLoad(1, (0, 0, -10.0))])])
        >>> save_results(results, "output/rope.fxm")
        >>> load_results("output/rope.fxm")["pull"].cable("rope").force.round(1).tolist()
        [1012.2, 1012.2]
    """
    write_archive(results, path)


def write_archive(results: Saved, path: str | Path) -> None:
    """Save results as `save_results`, on one process alone."""
    validation.instance("save_results results", results, Saved)
    file = paths.path("path", path)
    paths.check_writable("path", file)
    encode = Encoder(CLASSES)
    content = (
        encode(results)
        if isinstance(results, WHOLE)
        else {"results": encode(dict(results)), "stages": encode(results.stages), "names": _names(results)}
        | ({"limits": encode(results.limits)} if results.limits else {})
        | ({"failure": list(results.failure)} if results.failure else {})
        | ({"last": encode(results.last)} if results.last else {})
    )
    document = {
        "kind": KIND,
        "format": FORMAT,
        "versions": _versions(),
        "objects": encode.objects,
        "content": content,
    }
    _write(file, json.dumps(document), encode.arrays)


def load_results(path: str | Path, classes: Sequence[type] = ()) -> Any:
    """Open a file of `save_results`.

    The states are like those of the run. Whatever goes on from them (`stability`, `natural_frequencies`) makes meshes
    and forms anew. Under MPI each process reads the file.

    Args:
        path: The file.
        classes: Classes of your own laws and terms in it, which a file cannot hold.

    Returns:
        What was saved: `StageResults`, a `Form`, `Strips`, a `CuttingPattern` or a `PatternProof`. Fields
        unknown to the version that saved it are None.

    Raises:
        ValueError: The file does not exist; it is no archive of results, is damaged, or of a later format; it needs a
            class that is not given, or one that has other fields now.
    """
    with together(MPI.COMM_WORLD):
        file = paths.path("path", path)
        own = _own(classes)
        try:
            with zipfile.ZipFile(file) as archive:
                document = json.loads(archive.read(DOCUMENT))
                _check(document, CLASSES | own)
                arrays = {name[:-4]: _array(archive, name) for name in archive.namelist() if name != DOCUMENT}
            return _opened(document, Decoder(CLASSES | own, arrays, document["objects"], GROWN))
        except FileNotFoundError:
            raise ValueError(f"path is {str(file)!r}, which does not exist; correct the name.") from None
        except OSError as error:
            raise ValueError(f"path is {str(file)!r}, which cannot be read ({error.strerror}).") from None
        except DAMAGED:
            raise ValueError(
                f"{file} is no archive of results, or is damaged; give a file that `save_results` has written."
            ) from None
        except UnopenedError as error:
            raise ValueError(f"{file} {error}.") from None
        except ValueError as error:
            raise ValueError(
                f"{file} is an archive of results that cannot be opened: {error}{_origin(document)}."
            ) from None


def origin_of(path: Path) -> dict[str, str]:
    """Class of what is in an archive, its format and versions, read without arrays; empty for a file that is none."""
    try:
        with zipfile.ZipFile(path) as archive:
            document = json.loads(archive.read(DOCUMENT))
        if document["kind"] != KIND:
            return {}
        content, objects = document["content"], document["objects"]
        held = objects[content["object"]]["class"] if "object" in content else StageResults.__name__
        return {"holds": str(held), "format": str(document["format"]), **document["versions"]}
    except (OSError, *DAMAGED):
        return {}


class UnopenedError(Exception):
    """Archive of a later format, or of classes that are not given."""


def _opened(document: Any, decode: Decoder) -> Saved:
    content = document["content"]
    if "object" in content:
        return cast(Saved, decode(content))
    found = StageResults(decode(content["results"]), decode(content["stages"]))
    if "names" in content:
        found.title, found.force_unit, found.length_unit = map(str, content["names"])
    found.limits = decode(content["limits"]) if "limits" in content else None
    found.failure = Failure(*content["failure"]) if "failure" in content else None
    found.last = decode(content["last"]) if "last" in content else None
    return found


def _origin(document: Any) -> str:
    """Format and version of an archive, in a message."""
    version = document.get("versions", {}).get("fx-membrane", "unknown")
    return f" (format {document['format']}, by fx_membrane {version}; this program reads formats 1 to {FORMAT})"


def _names(results: StageResults) -> list[str]:
    return [results.title, results.force_unit, results.length_unit]


def _write(file: Path, document: str, arrays: dict[str, NDArray[Any]]) -> None:
    with writing(file, "wb") as stream, zipfile.ZipFile(stream, "w") as archive:
        archive.writestr(DOCUMENT, document, zipfile.ZIP_DEFLATED)
        for name, array in arrays.items():
            with archive.open(f"{name}.npy", "w", force_zip64=True) as entry:
                np.save(entry, array, allow_pickle=False)


def _array(archive: zipfile.ZipFile, name: str) -> NDArray[Any]:
    with archive.open(name) as entry:
        return np.load(entry, allow_pickle=False)


def _check(document: Any, classes: Mapping[str, type]) -> None:
    if document["kind"] != KIND or not isinstance(document["format"], int):
        raise KeyError(KIND)
    if document["format"] > FORMAT:
        raise UnopenedError(f"is an archive of results of a later version{_origin(document)}: install a newer one")
    missing = sorted({entry["class"] for entry in document["objects"]} - set(classes))
    if missing:
        raise UnopenedError(
            f"holds objects of classes that no file can hold, {', '.join(missing)}: import them and open it by "
            f"load_results(path, classes=[{', '.join(missing)}])"
        )


def _own(classes: Sequence[type]) -> dict[str, type]:
    if not isinstance(classes, list | tuple):
        raise ValueError(f"classes is {validation.short_repr(classes)}; give a list of classes of your own, [Foam].")
    for cls in classes:
        if not isinstance(cls, type) or cls.__name__ in CLASSES:
            raise ValueError(
                f"classes has {validation.short_repr(cls)}; give the classes of your own laws and terms, [Foam]."
            )
    return {cls.__name__: cls for cls in classes}


def _versions() -> dict[str, str]:
    versions = {"numpy": np.__version__}
    for name in ("fx-membrane", "fenics-dolfinx", "petsc4py"):
        try:
            versions[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            continue
    return versions
