"""Form finding refuses gas, and says how its pressure is given."""

import pytest

from cushions import airbag
from fx_membrane import GasPressure, natural_force_density, prescribed_stress, projected_stress, updated_reference


@pytest.mark.parametrize("method", [updated_reference, projected_stress, natural_force_density, prescribed_stress])
def test_gas_among_the_loads_names_the_remedy(method):
    with pytest.raises(ValueError, match=r"a change of gas; form finding knows no gas: .* as Pressure\(300.0, part\)"):
        method(airbag(), loads=[GasPressure(300.0, "gas")])
