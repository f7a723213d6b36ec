"""Table of verification: what the tests in tests/verification record, and the rows of README that they keep true."""

import json
import math
import re
from collections import defaultdict
from pathlib import Path
from xml.etree import ElementTree

ROOT = Path(__file__).parent.parent
CASES = ROOT / "tests" / "verification"
ROW = re.compile(
    r"\| \[(?P<case>[^]]+)\]\(tests/verification/test_(?P<file>\w+)\.py\) \| (?P<error>\S+) \| (?P<order>\S*) \|"
)


def title(file):
    """Case of a file, by the first clause of its docstring."""
    first = (CASES / f"test_{file}.py").read_text().split('"""')[1].split("\n")[0]
    return re.split(r"[.:] ?", first)[0]


def readme_rows():
    """Bound of the error and least order that README states, or None for no order, by file."""
    rows = ROW.finditer((ROOT / "README.md").read_text())
    return {row["file"]: (float(row["error"]), float(row["order"]) if row["order"] else None) for row in rows}


def read_records(report):
    """Return the records in a JUnit report; of a case that runs several times, the one of the largest error."""
    worst = {}
    for case in ElementTree.parse(report).iter("testcase"):
        for entry in case.iterfind("properties/property[@name='verified']"):
            record = json.loads(entry.get("value"))
            key = record["file"], record["quantity"]
            if key not in worst or record["error"] > worst[key]["error"]:
                worst[key] = record
    return [worst[key] for key in sorted(worst)]


def long_table(records):
    """Markdown of all records, a row each."""
    lines = [
        "| case | quantity | source | exact | found | error | order | platform |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for record in records:
        order = "" if record["order"] is None else f"{record['order']:.2f}"
        case = f"{title(record['file'])} | {record['quantity']} | {record['source']}"
        numbers = f"{record['exact']:.8g} | {record['ours']:.8g} | {record['error']:.1e} | {order}"
        lines.append(f"| {case} | {numbers} | {record['platform']} |")
    return "\n".join(lines) + "\n"


def bound_of(error):
    """Bound of one digit above 1.5 times an error; the power of ten above ten times one that is rounding."""
    if error < 1e-8:
        return 10.0 ** math.ceil(math.log10(10 * max(error, 1e-16)))
    digit = 10.0 ** math.floor(math.log10(1.5 * error))
    return math.ceil(1.5 * error / digit) * digit


def short_table(records):
    """Markdown of README, a row for each file: a bound of its largest error, and its least order."""
    of_file = defaultdict(list)
    for record in records:
        of_file[record["file"]].append(record)
    lines = ["| case | error below | order |", "|---|---|---|"]
    for file, found in sorted(of_file.items()):
        bound = bound_of(max(record["error"] for record in found))
        orders = [record["order"] for record in found if record["order"] is not None]
        least = f"{min(orders):.1f}" if orders else ""
        lines.append(f"| [{title(file)}](tests/verification/test_{file}.py) | {bound:.0e} | {least} |")
    return "\n".join(lines) + "\n"
