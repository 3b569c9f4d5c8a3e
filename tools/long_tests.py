#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 Edged USLAM developers
# SPDX-License-Identifier: Apache-2.0
"""Passes on what ctest prints, with the time since a begin after each result, and warns, before the summary, of tests
that take longer than 20 s without a reason in tests/long_tests.txt. A warning fails nothing, as machines differ.
Usage: ctest ... | tools/long_tests.py [--since UNIX_SECONDS] [--no-warnings]
"""
import argparse
import pathlib
import re
import sys
import time

LONGEST_S = 20.0
REASONS = pathlib.Path(__file__).resolve().parent.parent / "tests" / "long_tests.txt"
RESULT = re.compile(r"^ *\d+/\d+ +Test +#\d+: (\S+) .* ([\d.]+) sec")
SUMMARY = re.compile(r"^\d+% tests passed")


def patterns():
    """Regular expressions that a whole name of a test must match: what stands before `: ` in each line."""
    lines = (line.strip() for line in REASONS.read_text().splitlines())
    rows = [line.partition(": ") for line in lines if line and not line.startswith("#")]
    missing = [pattern for pattern, _, reason in rows if not reason.strip()]
    if missing:
        sys.exit(f"{REASONS.name}: no reason is given for {', '.join(missing)}")
    return [re.compile(pattern) for pattern, _, _ in rows]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--since", type=float)
    parser.add_argument("--no-warnings", action="store_true")
    args = parser.parse_args()
    known, unexplained = patterns(), []
    for line in sys.stdin:
        if SUMMARY.match(line):
            for name, seconds in unexplained:
                print(f"warning: {name} took {seconds:.0f} s: make it shorter, or state why in tests/{REASONS.name}")
        result = RESULT.match(line)
        if result and args.since:
            line = f"{line.rstrip()}  [{(time.time() - args.since) / 60:.0f} min]\n"
        if result and not args.no_warnings and float(result[2]) > LONGEST_S and not any(p.fullmatch(result[1]) for p in known):
            unexplained.append((result[1], float(result[2])))
        print(line, end="", flush=True)


if __name__ == "__main__":
    main()
