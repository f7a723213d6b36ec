"""Words of messages of the package, which speak of Python, in those of case files."""

from __future__ import annotations

import re

from ...results.reader_words import for_readers

OWNER = re.compile(
    r"^(?:Stage '[^']*': |(?:Fabric|OrthotropicFabric|NeoHooke|MooneyRivlin|Membrane|Cable|Mast|Support|PointLoad|"
    r"PlanLoad|DistributedLoad|Pressure|PrescribedDisplacement|RadialDirection|RoundHole|Slide|Ring|RigidBody|CableForce|"
    r"CableDensity|CableLength|CableSag|EdgeAngle|Newton|ConjugateGradient|SteepestDescent|WorkLimit|Limits|"
    r"NaturalStretch|TemperatureChange|LengthChange|PrestressFactor|Chamber(?: part)?|Ambient|GasPressure|GasVolume|"
    r"GasAmount|Seal) )"
    r"(?=[a-zA-Z])"
)
KEYS = "axial_stiffness|material|warp|prestress|natural_stretch|direction|normal|radius|mass|displacement"
PHRASES = (
    (re.compile(r"^source is "), "it is "),
    (re.compile(r"\ba str of (\d+) entr(?:y|ies)"), r"a text of \1 letters"),
    (re.compile(r"\ba dict of "), "a table of "),
    (re.compile(r"datetime\.(?:date|time|datetime)\((?:[^()]|\([^()]*\))*\)"), "a date or time"),
    (
        re.compile(r"(?<=; give )\(3,\), or \((\d+), 3\) for one at each node"),
        r"[x, y, z], or one for each of the \1 nodes",
    ),
    (re.compile(r"(?<=; give )\(3,\) or \((\d+), 3\)"), r"[x, y, z], or one for each of the \1 cells"),
    (re.compile(r"a \(warp, weft\) pair or a \(2, 2\) tensor, "), "[warp, weft] or [[a, b], [b, c]], "),
    (re.compile(r"( for each of the \d+ cells): \(\d+, 1\), \(\d+, 2\) or \(\d+, 2, 2\)"), r"\1"),
    (re.compile(r"has shape \(\)"), "is one number"),
    (re.compile(r"has shape \((\d+),\)"), r"is a list of length \1"),
    (re.compile(r"has shape \((\d+), (\d+)\)"), r"is a list of \1 rows of length \2"),
    (re.compile(r"has shape \((\d+(?:, \d+)+)\)"), r"is lists in lists, of lengths \1"),
    (re.compile(r"give \(n, 3\), one row x, y, z for each node"), "give rows [x, y, z], one for each node"),
    (re.compile(r"of shape \(n, (\d)\) with n >= 1"), r"in rows of \1, one row at least"),
    (re.compile(r", of shape \(n, (\d)\)"), r", in rows of \1"),
    (re.compile(r"(?<=, not )\S+ of shape \((\d+(?:, \d+)+)\)"), r"lists in lists, of lengths \1"),
    (
        re.compile(r"one of direction=\(x, y, z\), normal=\(x, y, z\)"),
        "one of direction = [x, y, z], normal = [x, y, z]",
    ),
    (re.compile(r"; allow for rounding, numpy\.isclose\(\.\.\.\)"), "; correct the range"),
    (re.compile(r"\(x, y\)"), "[x, y]"),
    (re.compile(r", or a RoundHole"), ", or its centre and radius"),
    (re.compile(r"\bA Slide is on\b"), "nodes slide on"),
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
    (re.compile(r"Ambient\(101325\.0\), in pascals"), "a change of kind 'air', its pressure about '1013 hPa'"),
    (re.compile(r"Ambient\(101325\.0, (\S+)\)"), r"it in the same change, about '1013 hPa'"),
    (re.compile(r"\(GasPressure\)"), "(a change of kind 'gas pressure')"),
    (re.compile(r"\ban (?=(Ambient|OrthotropicFabric)\b)"), "a "),
    (re.compile(r"\bAmbient\b"), "change of kind 'air'"),
    (re.compile(r"\bGasPressure\b"), "change of kind 'gas pressure'"),
    (re.compile(r"\bGasVolume\b"), "change of kind 'gas volume'"),
    (re.compile(r"\bGasAmount\b"), "change of kind 'gas amount'"),
    (re.compile(r"\bSeal\b"), "change of kind 'seal'"),
    (re.compile(r'"([^"]+)": (-?1)(?=[,}])'), r"\1 = \2"),
    (re.compile(r"\bparts=\{"), "parts = {"),
    (re.compile(r"rigid_walls=True"), "rigid_walls = true"),
    (re.compile(r"\bFalse\b"), "false"),
    (re.compile(r"\bTrue\b"), "true"),
    (re.compile(r"\bNone\b"), "nothing"),
    (re.compile(r"\bDistributedLoad\b"), "load of kind 'line'"),
    (re.compile(r"\bPlanLoad\b"), "load of kind 'plan'"),
    (re.compile(r"\bTemperatureChange\b"), "change of kind 'temperature'"),
    (re.compile(r"\bLengthChange\b"), "change of kind 'length'"),
    (re.compile(r"\bNaturalStretch\b"), "change of kind 'stretch'"),
    (re.compile(r"\bPrestressFactor\b"), "change of kind 'prestress factor'"),
    (re.compile(r"\bPrescribedDisplacement\b"), "prescribed displacement"),
    (re.compile(r"\bOrthotropicFabric\b"), "fabric of kind 'woven'"),
    (re.compile(r"\ba Membrane\b"), "a membrane"),
    (re.compile(r"\ba Cable\b"), "a cable"),
    (re.compile(r"\ba Mast\b"), "a mast"),
)


def in_words_of_files(words: str) -> str:
    """Put a message in words of case files: of keys in the place of classes and arguments."""
    return in_keys_of_files(OWNER.sub("", words))


def in_keys_of_files(words: str) -> str:
    """Put a message of a run in words of case files, with the name of its object."""
    words = for_readers(words)
    for phrase, by in PHRASES:
        words = phrase.sub(by, words)
    return words
