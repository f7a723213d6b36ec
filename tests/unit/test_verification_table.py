"""README's table of verification names every file of tests/verification, and is made of records as they are."""

import json

from verification_table import CASES, ROOT, ROW, long_table, read_records, readme_rows, short_table, title


def test_readme_has_a_row_for_each_case():
    files = {file.stem.removeprefix("test_") for file in CASES.glob("test_*.py")}
    assert set(readme_rows()) == files
    for row in ROW.finditer((ROOT / "README.md").read_text()):
        assert row["case"] == title(row["file"])


def record(quantity, error, order=None):
    return {
        "file": "drum",
        "quantity": quantity,
        "source": "Morse",
        "exact": 2.0,
        "ours": 2.0 * (1 + error),
        "error": error,
        "order": order,
        "platform": "here",
    }


def test_tables_of_records(tmp_path):
    """Of a case that runs twice the worse is told; the bound has one digit."""
    properties = "".join(
        f"<testcase><properties><property name='verified' value='{json.dumps(entry)}'/></properties></testcase>"
        for entry in (record("f", 3e-5, 2.04), record("f", 1e-5, 2.1), record("g", 6e-4, 1.96), record("h", 0.0))
    )
    report = tmp_path / "report.xml"
    report.write_text(f"<testsuites><testsuite>{properties}</testsuite></testsuites>")
    records = read_records(report)
    assert [entry["error"] for entry in records] == [3e-5, 6e-4, 0.0]
    assert (
        short_table(records).splitlines()[-1] == f"| [{title('drum')}](tests/verification/test_drum.py) | 9e-04 | 2.0 |"
    )
    assert long_table(records).splitlines()[2] == (
        f"| {title('drum')} | f | Morse | 2 | 2.00006 | 3.0e-05 | 2.04 | here |"
    )
