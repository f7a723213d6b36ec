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
from .assembly.gas import ChamberResult
from .assembly.held_components import Constraints
from .assembly.problem import Problem
from .assembly.problem_under_actions import LoadedProblem
from .assembly.wrinkling_direction import tension_direction
from .files.archive import load_results, save_results
from .files.compas import Net, read_compas
from .files.dolfinx_functions import PartFunctions, to_dolfinx
from .files.dolfinx_mesh import structure_from_dolfinx
from .files.gmsh import structure_from_gmsh
from .files.mesh_files import structure_from_file
from .files.mesh_writer import write_mesh
from .files.paraview import ParaViewSeries, SeriesWarning, write_paraview
from .files.patterns.length_units import LengthUnitWarning
from .files.patterns.write import write_patterns
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
from .form_finding.force_density_method import force_density
from .form_finding.form import Form, FormStep
from .form_finding.masts.balanced_bars import masts_and_stays
from .form_finding.natural_densities import natural_force_density
from .form_finding.reference_updates import updated_reference
from .form_finding.stress_in_projection import projected_stress
from .form_finding.unsettled_form import UnsettledFormWarning
from .form_finding.wished_stress import prescribed_stress
from .form_finding.wishes import RadialDirection
from .geometry.edges import edges_where
from .geometry.grids import polyline, rectangle
from .geometry.topology import boundary_edges
from .model.axial_law import Axial
from .model.cable_changes import FixedLength, GivenForce, UnstressedLength
from .model.chambers import Chamber
from .model.changes import LengthChange, NaturalStretch, PrestressFactor, TemperatureChange
from .model.coincidence import CoincidentNodesWarning
from .model.energy_terms import EnergyTerm, ForceTerm
from .model.fabrics import Fabric, OrthotropicFabric
from .model.foils import MooneyRivlin, NeoHooke
from .model.gas import Ambient, GasAmount, GasPressure, GasVolume, Seal
from .model.laws import Law
from .model.loads import DistributedLoad, PlanLoad, PointLoad, Pressure
from .model.natural_shape import natural_stretch
from .model.parts import Cable, Mast, Membrane
from .model.ponds import Pond
from .model.ropes import Rope
from .model.slivers import SliverWarning
from .model.stages import PrescribedDisplacement, Stage
from .model.structure import Structure
from .model.supports import Support
from .model.water_events import BasinResult, WaterEvent
from .patterns.allowances import Allowances
from .patterns.biaxial_tests import BiaxialTests
from .patterns.cloth_pieces import Piece, cut_pieces
from .patterns.compensated_cloth import cutting_pattern
from .patterns.cutting import cut_strips
from .patterns.flat_shapes import flatten
from .patterns.flat_strips import CuttingPattern, FlatStrip, Side
from .patterns.outline_fitting import nearest_stress_pattern
from .patterns.parted import NarrowStripWarning
from .patterns.proofs import PatternProof, prove_pattern
from .patterns.reassembly import reassembled
from .patterns.roll_layout import RollLayout, laid_on_roll
from .patterns.seam_families import seams_between
from .patterns.seam_lengths import SeamLengths
from .patterns.stress_fit import StressErrors, StressFit
from .patterns.strip_copies import with_copies
from .patterns.strip_proofs import StripProof
from .patterns.strips import Edge, Strips
from .results.balance import UnbalancedStateWarning
from .results.forces_of_state import Equilibrium, PondResult, TermResult
from .results.load_increments import Increment
from .results.part_results import BarResult, MembraneResult, RopeResult
from .results.shear_signs import ShearSignWarning
from .results.states import StageResult, StageResults
from .results.strain_limits import LargeStrainWarning
from .results.table_of_stage import report
from .results.told_states import CrushedGasWarning, LostPrestressWarning, UnstableStateWarning
from .solvers.base import Iteration, Solution, Solve, Solver
from .solvers.conjugate_gradient import ConjugateGradient, SteepestDescent
from .solvers.newton import Newton
from .solvers.outcome import Outcome
from .solvers.petsc_options import UnusedOptionWarning
from .surfaces.depressions import Depression, Drainage
from .surfaces.geodesic_warp import GeodesicDirection
from .surfaces.planar_cuts import planar_cut
from .surfaces.remeshing import Remeshed, remeshed
from .surfaces.round_hole import RoundHole
from .surfaces.run_off import drainage
from .surfaces.sail import SailMesh, sail_mesh
from .surfaces.stress_lines import stress_trajectories, wrinkle_lines
from .surfaces.surface_lines import SurfaceLine, geodesic, warp_lines
from .surfaces.warp_directions import warp_along

__all__ = [
    "Actions",
    "Allowances",
    "Ambient",
    "Analysis",
    "Axial",
    "BarResult",
    "BasinResult",
    "BiaxialTests",
    "Cable",
    "CableDensity",
    "CableForce",
    "CableLength",
    "CableSag",
    "Chamber",
    "ChamberResult",
    "CheckpointWarning",
    "CoincidentNodesWarning",
    "ConjugateGradient",
    "Constraints",
    "ConvergenceError",
    "CrushedGasWarning",
    "CuttingPattern",
    "Depression",
    "DistributedLoad",
    "Drainage",
    "Edge",
    "EdgeAngle",
    "EnergyTerm",
    "Equilibrium",
    "EquilibriumPath",
    "Fabric",
    "FixedLength",
    "FlatStrip",
    "ForceTerm",
    "Form",
    "FormStep",
    "GasAmount",
    "GasPressure",
    "GasVolume",
    "GeodesicDirection",
    "GivenForce",
    "Increment",
    "Iteration",
    "LargeStrainWarning",
    "Law",
    "LengthChange",
    "LengthUnitWarning",
    "LoadedProblem",
    "LostPrestressWarning",
    "MassUnitWarning",
    "Mast",
    "Membrane",
    "MembraneResult",
    "Modes",
    "MooneyRivlin",
    "NarrowStripWarning",
    "NaturalStretch",
    "NeoHooke",
    "Net",
    "Newton",
    "OrthotropicFabric",
    "Outcome",
    "ParaViewSeries",
    "PartFunctions",
    "PathError",
    "PathPoint",
    "PatternProof",
    "Piece",
    "PlanLoad",
    "PointLoad",
    "Pond",
    "PondResult",
    "PrescribedDisplacement",
    "Pressure",
    "PrestressFactor",
    "Problem",
    "RadialDirection",
    "Remeshed",
    "RigidBody",
    "Ring",
    "RollLayout",
    "Rope",
    "RopeResult",
    "RoundHole",
    "SailMesh",
    "Seal",
    "SeamLengths",
    "SeriesWarning",
    "ShearSignWarning",
    "Side",
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
    "StressErrors",
    "StressFit",
    "StripProof",
    "Strips",
    "Structure",
    "Support",
    "SurfaceLine",
    "TemperatureChange",
    "TermResult",
    "UnbalancedStateWarning",
    "UnsettledFormWarning",
    "UnstableStateWarning",
    "UnstressedLength",
    "UnusedOptionWarning",
    "WaterEvent",
    "WorkLimit",
    "boundary_edges",
    "cut_pieces",
    "cut_strips",
    "cutting_pattern",
    "drainage",
    "edges_where",
    "equilibrium_path",
    "flatten",
    "force_density",
    "geodesic",
    "laid_on_roll",
    "load_results",
    "masts_and_stays",
    "natural_force_density",
    "natural_frequencies",
    "natural_stretch",
    "nearest_stress_pattern",
    "planar_cut",
    "plot",
    "polyline",
    "prescribed_stress",
    "projected_stress",
    "prove_pattern",
    "read_compas",
    "reassembled",
    "rectangle",
    "remeshed",
    "report",
    "sail_mesh",
    "save_results",
    "seams_between",
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
    "with_copies",
    "wrinkle_lines",
    "write_mesh",
    "write_paraview",
    "write_patterns",
    "write_report",
    "write_scene",
    "write_tables",
]

__version__: str
