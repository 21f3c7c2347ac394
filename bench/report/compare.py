"""Which rows became faster or slower from one results file to another.

A row is faster or slower when its median changed by more than the threshold and the quartile
ranges do not overlap; the same when it changed by less and both ranges are narrow; else undecided:
measure again. Rows whose repetitions lacked processors are always undecided.
"""
from rows import Row, read_rows


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


def print_comparison(old_path, new_path, threshold):
    """A line per row and the counts; 1 when a row is slower."""
    (_, old_rows), (_, new_rows) = read_rows(old_path), read_rows(new_path)
    compared = compare(old_rows, new_rows, threshold)
    width = max((len(name) for name, *_ in compared), default=4)
    print(f"{'row':{width}}  {'old ms':>10} {'new ms':>10} {'new/old':>8}")
    for name, old, new, decision in compared:
        ratio = new.time / old.time
        print(f"{name:{width}}  {old.time:10.3f} {new.time:10.3f} {ratio:8.3f}  {decision}")
    for what in ("faster", "slower", "same", "undecided"):
        print(f"{sum(decision == what for *_, decision in compared)} {what}", end=", ")
    print(f"{len(old_rows.keys() ^ new_rows.keys())} only in one file")
    return 1 if any(decision == "slower" for *_, decision in compared) else 0


def self_test():
    def row(time, spread=0.02, contended=False):
        half = time * spread / 2
        return Row("r", time=time, low=time - half, high=time + half, contended=contended)

    cases = [
        (row(100), row(80), "faster"),
        (row(100), row(125), "slower"),
        (row(100), row(101), "same"),
        (row(100), row(100, spread=0.5), "undecided"),  # too wide a range
        (row(100, spread=0.6), row(80, spread=0.6), "undecided"),  # ranges overlap
        (row(100), row(80, contended=True), "undecided"),
        (row(0), row(80), "undecided"),
    ]
    for old, new, expected in cases:
        found = verdict(old, new, 0.05)
        assert found == expected, f"{old} to {new}: {found}, not {expected}"
    assert [v for *_, v in compare({"a": row(1), "b": row(1)}, {"b": row(2)}, 0.05)] == ["slower"]
