#!/usr/bin/env python3
"""Tell faster from slower between two results files.

    compare.py OLD.json NEW.json [--threshold 0.05]    table, then counts; 1 when a row is slower
    compare.py --self-test

A row is faster or slower when its median changed by more than the threshold and the quartile
ranges do not overlap; the same when it changed by less and both ranges are narrow; else undecided:
measure again. Rows that lost their processors to others are always undecided.
"""
import argparse
import sys

from rows import Row, parse_name, read_rows


def verdict(old, new, threshold):
    """faster, slower, same or undecided."""
    if old.contended or new.contended or old.time <= 0:
        return "undecided"
    change = new.time / old.time - 1
    if change < -threshold and new.high < old.low:
        return "faster"
    if change > threshold and new.low > old.high:
        return "slower"
    spread = max((row.high - row.low) / row.time for row in (old, new))
    return "same" if abs(change) <= threshold and spread <= 2 * threshold else "undecided"


def compare(old_rows, new_rows, threshold):
    """(name, old, new, verdict) of the rows in both, in the order of the old ones."""
    return [
        (name, old, new_rows[name], verdict(old, new_rows[name], threshold))
        for name, old in old_rows.items()
        if name in new_rows
    ]


def print_table(compared, missing):
    width = max((len(name) for name, *_ in compared), default=4)
    print(f"{'row':{width}}  {'old ms':>10} {'new ms':>10} {'new/old':>8}")
    for name, old, new, decision in compared:
        ratio = new.time / old.time
        print(f"{name:{width}}  {old.time:10.3f} {new.time:10.3f} {ratio:8.3f}  {decision}")
    for what in ("faster", "slower", "same", "undecided"):
        print(f"{sum(decision == what for *_, decision in compared)} {what}", end=", ")
    print(f"{missing} only in one file")


def self_test():
    def row(time, spread=0.02, contended=False):
        half = time * spread / 2
        return Row("r", time=time, low=time - half, high=time + half, contended=contended)

    cases = [
        (row(100), row(80), "faster"),
        (row(100), row(125), "slower"),
        (row(100), row(101), "same"),
        (row(100), row(100, spread=0.5), "undecided"),  # nothing can be said
        (row(100, spread=0.6), row(80, spread=0.6), "undecided"),  # ranges overlap
        (row(100), row(80, contended=True), "undecided"),
        (row(0), row(80), "undecided"),
    ]
    for old, new, expected in cases:
        found = verdict(old, new, 0.05)
        assert found == expected, f"{old} to {new}: {found}, not {expected}"
    assert [v for *_, v in compare({"a": row(1), "b": row(1)}, {"b": row(2)}, 0.05)] == ["slower"]
    parsed = parse_name("W2_rotated_256/linear/float32/cpu/threads:2/without:culling")
    fields = (parsed.kind, parsed.workload, parsed.filter, parsed.type, parsed.backend)
    assert fields == ("warp", "W2_rotated_256", "linear", "float32", "cpu"), fields
    assert (parsed.threads, parsed.without) == (2, "culling"), parsed
    parsed = parse_name("W1_torso_700/linear/uint8x3/cpu/threads:2")
    assert (parsed.type, parsed.components) == ("uint8", 3), parsed
    assert parse_name("position/W1_torso_700/float32/cpu").kind == "position"
    print("compare.py: all verdicts as expected")


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("files", nargs="*", metavar="FILE")
    parser.add_argument("--threshold", type=float, default=0.05, help="share of the old time")
    parser.add_argument("--self-test", action="store_true")
    arguments = parser.parse_args()
    if arguments.self_test:
        self_test()
        return 0
    if len(arguments.files) != 2:
        parser.error("expected two results files")
    (_, old), (_, new) = (read_rows(path) for path in arguments.files)
    compared = compare(old, new, arguments.threshold)
    print_table(compared, len(old.keys() ^ new.keys()))
    return 1 if any(decision == "slower" for *_, decision in compared) else 0


if __name__ == "__main__":
    sys.exit(main())
