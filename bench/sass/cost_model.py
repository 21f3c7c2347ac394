#!/usr/bin/env python3
"""Times of a step of the warp on an NVIDIA H200, predicted from counts of the emulated device.

    cost_model.py PROGRAM [WORKLOAD...]     counts with PROGRAM, prints counts and predictions
    cost_model.py --counts FILE             the same of counts that were written before
    cost_model.py --counts FILE --fit       finds the constants anew
    cost_model.py --test                    checks this script

PROGRAM: tetwarp_step_counts of a build. A launch takes

    launch + max(operations x cycles / (4 x multiprocessors) + sectors x cycles / multiprocessors,
                 operations of its longest warp x latency, bytes / bandwidth)
"""
import argparse
import csv
import json
import math
import subprocess
import sys
import tempfile
from pathlib import Path

import weights

ROOT = Path(__file__).resolve().parents[2]
MULTIPROCESSORS, CYCLES = 132, 1980.0  # of an H200; cycles of a microsecond
# Fitted by --fit to what was measured of the workloads FITTED.
CONSTANTS = {
    "launch": 1.65,      # from one launch of a graph to the next [us]
    "operation": 1.22,   # of a scheduler, per operation of a warp [cycles]
    "sector": 0.10,      # of a multiprocessor, per sector of a request [cycles]
    "latency": 13.1,     # of a warp, per operation, while others do not fill its gaps [cycles]
    "bandwidth": 1490.0  # different bytes of the blocks of a launch [GB/s]
}
FITTED = ("W1_torso_700", "W3_waved_256_5000")
LEFT_OUT = ("W1_torso_700", "floor")  # events around a launch are a large part of so short a one
WORKLOADS = FITTED + (
    "W6_orange_160", "W4_fish_35", "W3_waved_256_50000", "W3_waved_256_500000", "W2_rotated_256",
    "W2_rotated_384")
MEASURED = ("2026-11-27-h200-resident.json", "2026-11-27-h200-figures.json")
# Durations of single kernels: those of the commit c1b1dae that are the same now but for a name, and
# the raster of groups as docs/cuda.md has it.
KERNELS = "2026-11-26-h200-kernels.csv"
SAME = {"StepBeginBody": "StepBeginOp", "CellSumBody": "CellSumOp"}
RUNS = {"256x160x122, 700 tetrahedra": "W1_torso_700",
        "256^3 waved, 500,000 tetrahedra": "W3_waved_256_500000"}
GROUPS = {"W3_waved_256_5000": {"raster of groups": 207.0}}


def time_of(launch, constants):
    """Predicted microseconds of a launch."""
    issued = launch["operations"] * constants["operation"] / 4
    moved = launch["sectors"] * constants["sector"]
    return constants["launch"] + max(
        (issued + moved) / (MULTIPROCESSORS * CYCLES),
        launch["longest_warp"] * constants["latency"] / CYCLES,
        launch["bytes"] / (1e3 * constants["bandwidth"]))


def step_time(launches, constants):
    return sum(time_of(launch, constants) for launch in launches)


def floor_time(launches, constants):
    """The floor is the better of two shapes."""
    return min(time_of(launch, constants) for launch in launches)


def measured_rows(folder=ROOT / "bench/results"):
    """Workload -> measured (step from the workload's pose, from the other one, floor) [us]: the
    rows alternate between two poses, so quartiles are medians of one where they differ."""
    rows = {}
    for name in MEASURED:
        for row in json.loads((folder / name).read_text())["benchmarks"]:
            parts = row["name"].split("/")
            if parts[:1] + parts[2:4] == ["resident", "linear", "float32"] \
                    and not row["name"].count("without"):
                rows[parts[1]] = [1e3 * row[key] for key in ("high", "low", "floor")]
    return rows


def measured_kernels(folder=ROOT / "bench/results"):
    """Workload -> kernel -> measured, the median of its launches that are no update [us]."""
    found = {}
    with (folder / KERNELS).open(newline="") as file:
        for row in csv.DictReader(file):
            for old, name in SAME.items():
                if old in row["kernel"] and row["workload"] in RUNS:
                    kernels = found.setdefault(RUNS[row["workload"]], {})
                    kernels.setdefault(name, []).append(float(row["microseconds"]))
    medians = {workload: {name: sorted(times)[(len(times) - 1) // 2]
                          for name, times in kernels.items()}
               for workload, kernels in found.items()}
    return medians | GROUPS


def is_fitted(workload, part):
    return workload["workload"] in FITTED and (workload["workload"], part) != LEFT_OUT


def rows_of(counts):
    """(workload, part, measured or None) [us] of each step, floor and single kernel."""
    steps, kernels = measured_rows(), measured_kernels()
    for workload in counts:
        name = workload["workload"]
        yield from ((workload, part, value) for part, value in zip(
            ("pose", "nudged", "floor"), steps.get(name, [None, None, None])))
        yield from ((workload, part, value) for part, value in kernels.get(name, {}).items())


def predicted(workload, part, constants):
    if part == "floor":
        return floor_time(workload[part], constants)
    if part in workload:
        return step_time(workload[part], constants)
    return step_time([one for one in workload["pose"] if short(one["kernel"]) == part], constants)


def fit(counts):
    """The constants with the least squares of logarithms of predicted over measured, by steps along
    one of them at a time."""
    rows = [row for row in rows_of(counts) if row[2] and is_fitted(*row[:2])]

    def error_of(constants):
        return sum(math.log(predicted(workload, part, constants) / value) ** 2
                   for workload, part, value in rows)

    found, step = dict(CONSTANTS), 1.5
    best = error_of(found)
    while step > 1.0005:
        is_better = False
        for name in found:
            for factor in (step, 1 / step):
                tried = {**found, name: found[name] * factor}
                error = error_of(tried)
                if error < best - 1e-6:
                    found, best, is_better = tried, error, True
        if not is_better:
            step = math.sqrt(step)
    return found


def short(kernel):
    """Name of a kernel from the types of its arguments."""
    for part, name in (("AffineDeviceJob", "floor"), ("RasterJob<float>, int", "raster of groups"),
                       ("RasterJob", "general raster")):
        if part in kernel:
            return name
    text = kernel.replace("tetwarp::", "")
    words = [word.split("<")[0] for word in text.replace("(", ",").replace(")", ",").split(",")]
    ops = [word.strip() for word in words if word.strip().endswith("Op")]
    return ops[-1] if ops else text


def print_counts(workload, constants):
    print(f"\n{workload['workload']}: {workload['tets']} tetrahedra, "
          f"{workload['voxels'] / 1e6:.1f} M output voxels")
    print(f"{'us':>7} {'blocks':>7} {'threads':>7} {'longest':>8} {'per voxel':>9} {'lanes':>6} "
          f"{'requests':>9} {'sectors':>8} {'least':>6} {'barriers':>8} {'MB':>7}  kernel")
    for launch in workload["pose"] + workload["floor"]:
        requests = launch["requests"] or 1
        print(f"{time_of(launch, constants):7.1f} {launch['blocks']:7d} {launch['threads']:7d} "
              f"{launch['longest_warp']:8.0f} "
              f"{32 * launch['operations'] / workload['voxels']:9.2f} "
              f"{launch['lane_operations'] / launch['operations']:6.1f} "
              f"{launch['requests']:9.3g} {launch['sectors'] / requests:8.2f} "
              f"{launch['least_sectors'] / requests:6.2f} {launch['barriers']:8.3g} "
              f"{launch['bytes'] / 1e6:7.1f}  {short(launch['kernel'])}")


def print_predictions(counts, constants):
    print(f"\n{'workload':24} {'part':16} {'predicted':>9} {'measured':>9} {'error':>6}")
    for workload, part, value in rows_of(counts):
        time = predicted(workload, part, constants)
        known = f"{value:9.1f} {100 * (time / value - 1):+5.0f}%" if value else ""
        fitted = " fitted" if value and is_fitted(workload, part) else ""
        print(f"{workload['workload']:24} {part:16} {time:9.1f} {known}{fitted}")


def count(program, workloads):
    """Counts of workloads, by the program."""
    kernels = {path.name for folder in ("kernels", "bench/measure")
               for path in (ROOT / folder).rglob("*") if path.suffix in (".hpp", ".cuh")}
    lines = weights.Lines(program)
    found = weights.weights_of(weights.disassembly(program),
                               lambda address: lines.file_of(address) in kernels)
    with tempfile.NamedTemporaryFile("w", suffix=".txt") as file:
        file.writelines(f"{address} {operations}\n" for address, operations in found.items())
        file.flush()
        result = subprocess.run([program, file.name, *workloads], check=False, text=True,
                                stdout=subprocess.PIPE)
    if result.returncode:
        sys.exit(result.returncode)
    return json.loads(result.stdout)


def check():
    """Checks weights, times and fit by hand-made counts."""
    assert [weights.weight_of(*one) for one in (
        ("vfmadd231ss", "%xmm0,%xmm1,%xmm2"), ("vmulsd", "%xmm0,%xmm1,%xmm1"),
        ("vmovss", "(%rax),%xmm0"), ("mov", "%eax,%ebx"), ("movslq", "%eax,%rax"),
        ("movzbl", "(%rax),%eax"), ("add", "$0x1,%eax"), ("add", "%rbx,%rax"),
        ("add", "$0x8,%rsp"), ("imul", "%ebx,%eax"), ("imul", "%rbx,%rax"), ("mul", "%rbx"),
        ("xor", "%eax,%eax"), ("xor", "%ebx,%eax"), ("jne", "401000"), ("idiv", "%ecx"))
    ] == [1, 2, 0, 0, 1, 0, 1, 2, 0, 1, 4, 8, 0, 1, 1, 20]
    text = """
0000000000401000 <kernel>:
  401000:\tcall   402000 <__sanitizer_cov_trace_pc>
  401005:\tadd    %ebx,%eax
  401007:\tvaddss %xmm0,%xmm1,%xmm1
  40100b:\tcall   402000 <__sanitizer_cov_trace_pc>
  401010:\timul   %ebx,%eax
"""
    assert weights.weights_of(text, lambda address: True) == {0x401005: 2, 0x401010: 1}
    assert weights.weights_of(text, lambda address: address > 0x401006) == {0x401005: 1,
                                                                            0x401010: 1}
    ones = dict.fromkeys(CONSTANTS, 1.0)
    none = {"operations": 0, "sectors": 0, "longest_warp": 0, "bytes": 0}
    device = MULTIPROCESSORS * CYCLES
    assert time_of(none, ones) == 1
    assert time_of({**none, "operations": 8 * device, "sectors": 3 * device}, ones) == 1 + 2 + 3
    assert time_of({**none, "longest_warp": 5 * CYCLES, "bytes": 4000}, ones) == 1 + 5
    assert time_of({**none, "longest_warp": 5 * CYCLES, "bytes": 9000}, ones) == 1 + 9
    rows = measured_rows()
    assert rows["W1_torso_700"][0] > rows["W1_torso_700"][2] > 0
    assert all(name in rows for name in WORKLOADS)


def main():
    options = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    options.add_argument("program", nargs="?", help="tetwarp_step_counts")
    options.add_argument("workloads", nargs="*", help="names as in the rows of the benchmarks")
    options.add_argument("--counts", help="file of counts, written where PROGRAM is given")
    options.add_argument("--fit", action="store_true")
    options.add_argument("--test", action="store_true")
    given = options.parse_args()
    if given.test:
        return check()
    if not given.program and not given.counts:
        options.error("PROGRAM or --counts is needed")
    if given.program:
        counts = count(given.program, given.workloads or WORKLOADS)
        if given.counts:
            Path(given.counts).write_text(json.dumps(counts))
    else:
        counts = json.loads(Path(given.counts).read_text())
    constants = fit(counts) if given.fit else CONSTANTS
    if given.fit:
        print(*(f"{name} {value:.4g}" for name, value in constants.items()), sep="\n")
    for workload in counts:
        print_counts(workload, constants)
    print_predictions(counts, constants)


if __name__ == "__main__":
    main()
