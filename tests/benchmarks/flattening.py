"""Time of flattening and compensation, of a catenoid of 24 gores with 20 000 triangles, on one core.

    python tests/benchmarks/flattening.py

It prints processor seconds, each in a process that has compiled its forms before.
"""

import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from fx_membrane import Fabric, OrthotropicFabric, cutting_pattern, flatten, prove_pattern
from gores import catenoid

LAWS = {"isotropic": Fabric(5e5, 0.3), "woven": OrthotropicFabric(6e5, 4e5, 0.3, 2e4)}


def seconds(function, *given, **more):
    """Processor seconds of a call, and its result."""
    start = time.process_time()
    result = function(*given, **more)
    return time.process_time() - start, result


for name, law in LAWS.items():
    flatten(catenoid(8, 2, 4, law=law))  # compiles
    strips = catenoid(24, 8, 52, law=law)
    triangles = sum(len(strips.membrane(strip).cells) for strip in strips.names)
    flattening, _ = seconds(flatten, strips)
    both, pattern = seconds(cutting_pattern, strips)
    proof, _ = seconds(prove_pattern, pattern, progress=False)
    print(
        f"{name}, {triangles} triangles: flatten {flattening:.1f} s, cutting_pattern {both:.1f} s, proof {proof:.1f} s"
    )
