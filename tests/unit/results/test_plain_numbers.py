"""Numbers as texts: no exponent where they need none."""

import numpy as np
import pytest

from fx_membrane.results.plain_numbers import plain


@pytest.mark.parametrize(
    ("value", "digits", "text"),
    [
        (2e4, 5, "20000"),
        (123456.0, 5, "123460"),
        (-1.2e7, 5, "-12000000"),
        (0.0, 5, "0"),
        (3.25e-4, 5, "0.000325"),
        (1.8e2, 1, "200"),
        (1.2345e9, 3, "1.23e+09"),
        (-6.54321e-9, 3, "-6.54e-09"),
        (np.inf, 5, "inf"),
        (np.nan, 5, "nan"),
    ],
)
def test_exponents_are_of_very_large_and_small_numbers_only(value, digits, text):
    assert plain(value, digits) == text
    assert plain(np.float64(value), digits) == text
