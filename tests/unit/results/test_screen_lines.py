"""Lines on the screen: numbers with their units, and names, are not broken."""

import pytest

from fx_membrane.results.screen_lines import wrapped


@pytest.mark.parametrize("whole", ["27.2 %", "0.151 m", "6 kN/m", "cell 15", "strip 4", "'edge of the roof'", "3 m2"])
@pytest.mark.parametrize("margin", [0, 4])
def test_numbers_with_units_and_names_are_in_one_line(whole, margin):
    for before in range(40):
        text = f"{'x ' * before}{whole}, then more"
        lines = wrapped(text, margin, width=40).splitlines()
        assert any(whole in line for line in lines)
        assert max(map(len, lines)) <= 40
        assert " ".join(line.strip() for line in lines) == text


def test_null_characters_are_spaces_at_which_no_line_ends():
    lines = wrapped("names: " + ", ".join(["long\0name"] * 9), width=20).splitlines()
    assert "\0" not in "".join(lines)
    assert all(line.count("long") == line.count("name") - line.count("names") for line in lines)
