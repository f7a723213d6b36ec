"""Public names and their modules; `__init__.py` loads each from here on first use."""

from . import plot
from .analysis.arc_length import PathError, equilibrium_path
from .analysis.checkpoint import CheckpointWarning
from .analysis.convergence_error import ConvergenceError
from .analysis.modes import Modes, Stability, natural_frequencies, stability
from .analysis.path import EquilibriumPath, PathPoint
from .analysis.stages import Analysis
from .analysis.wave_speed import MassUnitWarning
from .analysis.work import WorkLimit
from .assembly.actions import Actions
from .assembly.constraints import Constraints
from .assembly.loaded_problem import LoadedProblem
from .assembly.problem import Problem
from .assembly.wrinkling_direction import tension_direction
from .files.archive import load_results, save_results
from .files.compas import Net, read_compas
from .files.dolfinx_functions import PartFunctions, to_dolfinx
from .files.dolfinx_mesh import structure_from_dolfinx
from .files.gmsh import structure_from_gmsh
from .files.mesh_files import structure_from_file
from .files.mesh_writer import write_mesh
from .files.paraview import ParaViewSeries, SeriesWarning, write_paraview
from .files.report.write import write_report
from .files.scene.write import write_scene
from .files.tables import write_tables
from .form_finding.constraints.kinds import (
    CableDensity,
    CableForce,
    CableLength,
    CableSag,
    EdgeAngle,
    RigidBody,
    Ring,
    Slide,
)
from .form_finding.force_density import force_density
from .form_finding.form import Form, FormStep
from .form_finding.masts.masts_and_stays import masts_and_stays
from .form_finding.natural_force_density import natural_force_density
from .form_finding.prescribed_stress import prescribed_stress
from .form_finding.projected_stress import projected_stress
from .form_finding.updated_reference import UnsettledFormWarning, updated_reference
from .form_finding.wishes import RadialDirection
from .geometry.edges import edges_where
from .geometry.grids import polyline, rectangle
from .geometry.topology import boundary_edges
from .model.coincidence import CoincidentNodesWarning
from .model.energy_terms import EnergyTerm, ForceTerm
from .model.laws import Law
from .model.loads import DistributedLoad, PlanLoad, PointLoad, Pressure
from .model.materials import Axial, Fabric, MooneyRivlin, NeoHooke, OrthotropicFabric
from .model.parts import Cable, Mast, Membrane
from .model.slivers import SliverWarning
from .model.stages import PrescribedDisplacement, Stage
from .model.structure import Structure
from .model.supports import Support
from .results.balance import UnbalancedStateWarning
from .results.part_results import BarResult, MembraneResult
from .results.report import report
from .results.states import (
    Equilibrium,
    Increment,
    LostPrestressWarning,
    StageResult,
    StageResults,
    TermResult,
    UnstableStateWarning,
)
from .results.strain_limits import LargeStrainWarning
from .solvers.base import Iteration, Solution, Solve, Solver
from .solvers.conjugate_gradient import ConjugateGradient, SteepestDescent
from .solvers.newton import Newton
from .solvers.outcome import Outcome
from .solvers.petsc_options import UnusedOptionWarning
from .surfaces.drainage import Depression, Drainage, drainage
from .surfaces.remeshing import Remeshed, remeshed
from .surfaces.round_hole import RoundHole
from .surfaces.sail import SailMesh, sail_mesh
from .surfaces.stress_lines import stress_trajectories, wrinkle_lines
from .surfaces.surface_lines import SurfaceLine, geodesic, warp_lines
from .surfaces.warp_along import warp_along

__all__ = [
    "Actions",
    "Analysis",
    "Axial",
    "BarResult",
    "Cable",
    "CableDensity",
    "CableForce",
    "CableLength",
    "CableSag",
    "CheckpointWarning",
    "CoincidentNodesWarning",
    "ConjugateGradient",
    "Constraints",
    "ConvergenceError",
    "Depression",
    "DistributedLoad",
    "Drainage",
    "EdgeAngle",
    "EnergyTerm",
    "Equilibrium",
    "EquilibriumPath",
    "Fabric",
    "ForceTerm",
    "Form",
    "FormStep",
    "Increment",
    "Iteration",
    "LargeStrainWarning",
    "Law",
    "LoadedProblem",
    "LostPrestressWarning",
    "MassUnitWarning",
    "Mast",
    "Membrane",
    "MembraneResult",
    "Modes",
    "MooneyRivlin",
    "NeoHooke",
    "Net",
    "Newton",
    "OrthotropicFabric",
    "Outcome",
    "ParaViewSeries",
    "PartFunctions",
    "PathError",
    "PathPoint",
    "PlanLoad",
    "PointLoad",
    "PrescribedDisplacement",
    "Pressure",
    "Problem",
    "RadialDirection",
    "Remeshed",
    "RigidBody",
    "Ring",
    "RoundHole",
    "SailMesh",
    "SeriesWarning",
    "Slide",
    "SliverWarning",
    "Solution",
    "Solve",
    "Solver",
    "Stability",
    "Stage",
    "StageResult",
    "StageResults",
    "SteepestDescent",
    "Structure",
    "Support",
    "SurfaceLine",
    "TermResult",
    "UnbalancedStateWarning",
    "UnsettledFormWarning",
    "UnstableStateWarning",
    "UnusedOptionWarning",
    "WorkLimit",
    "boundary_edges",
    "drainage",
    "edges_where",
    "equilibrium_path",
    "force_density",
    "geodesic",
    "load_results",
    "masts_and_stays",
    "natural_force_density",
    "natural_frequencies",
    "plot",
    "polyline",
    "prescribed_stress",
    "projected_stress",
    "read_compas",
    "rectangle",
    "remeshed",
    "report",
    "sail_mesh",
    "save_results",
    "stability",
    "stress_trajectories",
    "structure_from_dolfinx",
    "structure_from_file",
    "structure_from_gmsh",
    "tension_direction",
    "to_dolfinx",
    "updated_reference",
    "warp_along",
    "warp_lines",
    "wrinkle_lines",
    "write_mesh",
    "write_paraview",
    "write_report",
    "write_scene",
    "write_tables",
]

__version__: str
