"""Files of pictures: their format, and refused names."""

import pytest

from fx_membrane import plot
from pictures import POINTS, TRIANGLES


@pytest.mark.parametrize("name", ["roof.foo", "roof.v2", "roof.xlsx"])
def test_path_of_no_picture_is_refused(result, tmp_path, name):
    path = tmp_path / "pictures" / name
    message = rf"^path is '.*{name}', which ends in no format of pictures; give \.png, or one of \[.*'pdf', .*'png'"
    for draw in (
        lambda: plot.wireframe(POINTS, {"roof": TRIANGLES}, path),
        lambda: plot.contours(result, {"height": POINTS[:, 2]}, path),
        lambda: plot.convergence(result, path),
        lambda: plot.compare_convergence({"Newton": [entry for _, entry in result.history]}, {"Newton": 1.0}, path),
    ):
        with pytest.raises(ValueError, match=message):
            draw()
    assert not path.parent.exists()


@pytest.mark.parametrize("name", ["plan", "plan.PNG", "plan.svg"])
def test_path_of_a_picture(tmp_path, name):
    plot.wireframe(POINTS, {"roof": TRIANGLES}, str(tmp_path / name))
    assert len(list(tmp_path.glob("plan*"))) == 1
