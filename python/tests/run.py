#!/usr/bin/env python3
"""Runs the tests of the package with pytest; exits with 77 where pytest or NumPy is missing. Prints a
line "skipped: reason" for each reason, which `./dev test` lists."""

import importlib.util
import sys
from collections import Counter
from pathlib import Path


class Skips:
    """Plugin of pytest that counts the tests skipped for each reason."""

    def __init__(self):
        self.counts = Counter()

    def pytest_runtest_logreport(self, report):
        if report.skipped and isinstance(report.longrepr, tuple):
            self.counts[report.longrepr[2].removeprefix("Skipped: ")] += 1

    pytest_collectreport = pytest_runtest_logreport  # of whole files

    def pytest_terminal_summary(self, terminalreporter):
        for reason, count in sorted(self.counts.items()):
            terminalreporter.write_line(f"skipped: {reason} ({count} of the Python package)")


def main():
    missing = [name for name in ("numpy", "pytest") if importlib.util.find_spec(name) is None]
    if missing:
        print(f"skipped: {sys.executable} has no {' and no '.join(missing)}")
        return 77
    import pytest

    words = ["-q", "-p", "no:cacheprovider", str(Path(__file__).parent), *sys.argv[1:]]
    return pytest.main(words, plugins=[Skips()])


if __name__ == "__main__":
    sys.exit(main())
