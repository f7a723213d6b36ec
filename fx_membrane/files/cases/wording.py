"""Words of messages of the package, which speak of Python, in those of case files."""

import re

OWNER = re.compile(
    r"^(?:Stage '[^']*': |(?:Fabric|OrthotropicFabric|NeoHooke|MooneyRivlin|Membrane|Cable|Mast|Support|PointLoad|"
    r"PlanLoad|DistributedLoad|Pressure|PrescribedDisplacement|RadialDirection|Slide|Ring|RigidBody|CableForce|"
    r"CableDensity|CableLength|CableSag|EdgeAngle|Newton|ConjugateGradient|SteepestDescent|WorkLimit|Limits) )"
    r"(?=[a-zA-Z])"
)
KEYS = "axial_stiffness|material|warp|prestress|direction|normal|radius|mass|displacement"
PHRASES = (
    (re.compile(r"an array of numbers with rows of equal length"), "a list of numbers with rows of equal length"),
    (re.compile(r"an array of whole numbers"), "a list of whole numbers"),
    (re.compile(r"which has a warp and a weft; give the warp as a vector, .*"), "give its warp, as warp = [1, 0, 0]"),
    (re.compile(rf"\b({KEYS})=\(x, y, z\)"), r"\1 = [x, y, z]"),
    (re.compile(rf"\b({KEYS})=\.\.\."), r"\1 = ..."),
    (re.compile(r"give axial_stiffness = \.\.\. \[N\], or a law as material = \.\.\."), "give one, or E and area"),
    (re.compile(r"neither an axial_stiffness nor a material"), "no axial_stiffness"),
    (re.compile(r"give \(3,\)"), "give three numbers [x, y, z]"),
    (re.compile(r"\(([a-zA-Z0-9_.+-]+), ([a-zA-Z0-9_.+-]+), ([a-zA-Z0-9_.+-]+)\)"), r"[\1, \2, \3]"),
    (re.compile(r"like \"xyz\" or \"z\""), 'as "xyz" or "z"'),
    (re.compile(r"\bFalse\b"), "false"),
    (re.compile(r"\bTrue\b"), "true"),
    (re.compile(r"\bNone\b"), "nothing"),
    (re.compile(r"\bDistributedLoad\b"), "load of kind 'line'"),
    (re.compile(r"\bPlanLoad\b"), "load of kind 'plan'"),
    (re.compile(r"\bPrescribedDisplacement\b"), "prescribed displacement"),
    (re.compile(r"\bOrthotropicFabric\b"), "fabric of kind 'woven'"),
    (re.compile(r"\ba Membrane\b"), "a membrane"),
    (re.compile(r"\ba Cable\b"), "a cable"),
    (re.compile(r"\ba Mast\b"), "a mast"),
)


def in_words_of_files(words: str) -> str:
    """Put a message in words of case files: of keys in the place of classes and arguments."""
    words = OWNER.sub("", words)
    for phrase, by in PHRASES:
        words = phrase.sub(by, words)
    return words
