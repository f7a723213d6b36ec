"""Fixtures of several tests of wrinkling."""

import pytest

from wrinkled import COLUMN, FABRICS, ROW, Formula, compliance, strains, tensor


@pytest.fixture(scope="module", params=list(FABRICS))
def case(request):
    """Fabric, its formulas, total strains and prestresses."""
    fabric = FABRICS[request.param]
    e, sigma0 = strains(fabric, len(request.param))
    return fabric, Formula(fabric, len(e)), e, sigma0, e - tensor(sigma0[:, ROW, COLUMN] @ compliance(fabric), 0.5)
