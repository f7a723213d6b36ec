"""Ranges of material data."""

import pytest

from fx_membrane import Fabric, OrthotropicFabric

NAN = float("nan")


@pytest.mark.parametrize("Et", [0, -1.0, NAN, float("inf")])
def test_stiffness_must_be_positive(Et):
    with pytest.raises(ValueError, match=f"^Fabric Et is {Et}; "):
        Fabric(Et=Et, nu=0.3)


@pytest.mark.parametrize("nu", [-1, -1.5, 0.500001, 2, NAN, float("inf")])
def test_poissons_ratio_out_of_range(nu):
    with pytest.raises(ValueError, match=f"^Fabric nu is {nu}; "):
        Fabric(Et=1e5, nu=nu)


@pytest.mark.parametrize("nu", [-0.999, 0, 0.5])
def test_poissons_ratio_in_range(nu):
    assert Fabric(Et=1e5, nu=nu).nu == nu


def test_from_modulus_multiplies():
    assert Fabric.from_modulus(E=2e9, nu=0.3, thickness=1e-3) == Fabric(Et=2e6, nu=0.3)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        ({"E": -2e9, "thickness": 1e-3}, r"^Fabric E is -2000000000\.0.*positive"),
        ({"E": 2e9, "thickness": -1e-3}, r"^Fabric thickness is -0\.001.*positive"),
        ({"E": 2e9, "thickness": 0}, "^Fabric thickness is 0.*positive"),
        ({"E": -2e9, "thickness": -1e-3}, "^Fabric .* must be positive"),  # though their product is
    ],
)
def test_from_modulus_names_the_factor(data, message):
    with pytest.raises(ValueError, match=message):
        Fabric.from_modulus(nu=0.3, **data)


@pytest.mark.parametrize("name", ["Et_warp", "Et_weft", "Gt"])
@pytest.mark.parametrize("value", [0, -3.0, NAN])
def test_orthotropic_stiffness_must_be_positive(name, value):
    data = {"Et_warp": 2e5, "Et_weft": 1e5, "nu": 0.2, "Gt": 1e4, name: value}
    with pytest.raises(ValueError, match=f"^OrthotropicFabric {name} is {value}; "):
        OrthotropicFabric(**data)


@pytest.mark.parametrize("nu", [2.0, -2.0, 2.5, NAN])
def test_orthotropic_energy_must_be_positive(nu):
    with pytest.raises(ValueError, match=f"^OrthotropicFabric nu is {nu}; "):  # the limit is sqrt(4e5 / 1e5) = 2
        OrthotropicFabric(Et_warp=4e5, Et_weft=1e5, nu=nu, Gt=1e4)


@pytest.mark.parametrize("nu", [1.999, -1.999, 0])
def test_orthotropic_poissons_ratio_in_range(nu):
    assert OrthotropicFabric(Et_warp=4e5, Et_weft=1e5, nu=nu, Gt=1e4).nu == nu
