"""Table of verification: runs tests/verification and prints each recorded value beside its reference.

    python tests/benchmarks/verification.py                      the long table, Markdown
    python tests/benchmarks/verification.py --short              README's table, a row for each file
    python tests/benchmarks/verification.py --reports A.xml B.xml   of reports that `pytest --junitxml` has written

One platform for each report: with the reports of several dolfinx versions the table shows each.
"""

import argparse
import os
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))

from verification_table import CASES, ROOT, long_table, read_records, short_table


def reported(folder):
    """Report of a run of all cases, here and now."""
    report = Path(folder, "verification.xml")
    command = [sys.executable, "-m", "pytest", "-q", "--numprocesses", "2", f"--junitxml={report}", str(CASES)]
    print("Running tests/verification", file=sys.stderr, flush=True)
    done = subprocess.run(command, cwd=ROOT, stdout=sys.stderr, env={**os.environ, "OMP_NUM_THREADS": "1"}, check=False)
    if not report.exists():
        raise SystemExit(done.returncode)
    return report


def main():
    """Print a table; exit with 1 if a case failed to be recorded."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--short", action="store_true", help="README's table")
    parser.add_argument("--reports", nargs="+", type=Path, help="reports of pytest instead of a run")
    options = parser.parse_args()
    table = short_table if options.short else long_table
    with tempfile.TemporaryDirectory() as folder:
        records = [record for report in options.reports or [reported(folder)] for record in read_records(report)]
    print(table(records), end="")
    missing = {file.stem.removeprefix("test_") for file in CASES.glob("test_*.py")} - {
        entry["file"] for entry in records
    }
    if missing:
        sys.exit(f"No record of {', '.join(sorted(missing))}.")


if __name__ == "__main__":
    main()
