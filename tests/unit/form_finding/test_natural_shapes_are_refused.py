"""Form finding and new meshes refuse natural shapes, in one sentence."""

from dataclasses import replace

import numpy as np
import pytest

from fx_membrane import (
    masts_and_stays,
    natural_force_density,
    prescribed_stress,
    projected_stress,
    remeshed,
    updated_reference,
)
from models import sheet

FABRIC = replace(sheet().parts["fabric"], natural_stretch=0.99)
STRUCTURE = replace(sheet(), parts={"fabric": FABRIC})
MESSAGE = r"^Form finding: part 'fabric' has a natural stretch, .*; leave it out, and give the stress as prestress\.$"


@pytest.mark.parametrize(
    "method", [projected_stress, natural_force_density, updated_reference, prescribed_stress], ids=lambda m: m.__name__
)
def test_methods_refuse_natural_shapes(method):
    with pytest.raises(ValueError, match=MESSAGE):
        method(STRUCTURE)


def test_masts_refuse_forms_of_natural_shapes():
    form = updated_reference(sheet())
    odd = replace(form, made=STRUCTURE)
    with pytest.raises(ValueError, match=MESSAGE):
        masts_and_stays(odd, bars=[], points=[])


def test_new_meshes_keep_one_natural_shape_and_refuse_those_of_cells():
    pytest.importorskip("gmsh")
    found = remeshed(STRUCTURE, 0.4).structure
    assert np.allclose(found.parts["fabric"].natural_tensors(), 0.99 * np.eye(2))
    per_cell = replace(FABRIC, natural_stretch=np.linspace(0.98, 0.99, len(FABRIC.cells))[:, None])
    with pytest.raises(ValueError, match=r"^Part 'fabric' has a natural stretch that differs from cell to cell, .*;"):
        remeshed(replace(sheet(), parts={"fabric": per_cell}), 0.4)
