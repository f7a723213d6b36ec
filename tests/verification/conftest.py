"""Record of values beside their references; the table of verification is made of these."""

import json
import math
import platform

import dolfinx
import pytest

from verification_table import readme_rows

PLATFORM = f"dolfinx {dolfinx.__version__}, {platform.machine()}"


@pytest.fixture
def verified(request, record_property):
    """Record a value beside its reference, and hold README to both.

    The error is relative to the reference, or to one where the reference is zero. The order is that of the error over
    the last refinement. Both keep the bounds in README's row of the file.
    """

    def record(quantity, exact, ours, order=None):
        error = abs(ours - exact) / (abs(exact) or 1.0)
        file = request.path.stem.removeprefix("test_")
        entry = {
            "file": file,
            "quantity": quantity,
            "source": request.module.SOURCE,
            "exact": float(exact),
            "ours": float(ours),
            "error": float(error),
            "order": None if order is None else float(order),
            "platform": PLATFORM,
        }
        record_property("verified", json.dumps(entry))
        bound, least = readme_rows().get(file, (math.inf, None))
        assert error <= bound, f"README: the error of {quantity} is below {bound:.0e}."
        assert order is None or order > (least or 0) - 0.1, f"README: the order of {quantity} is {least}."

    return record
