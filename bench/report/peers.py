"""Times of other programs on the same problems: Siconos, and PyTorch and CuPy on a device."""
import re

from rows import Row

SOLVE_LINE = re.compile(
    r"(?P<file>\S+)\s+contacts\s+(?P<contacts>\d+)\s+tol\s+(?P<tolerance>\S+)\s+(?:ok|FAIL)"
    r"\s+sweeps\s+(?P<sweeps>\d+)\s+(?P<solver>\w+)\s+\S+\s+fclib\s+(?P<error>\S+)"
    r"\s+(?P<seconds>\S+)\s+s"
)
DEVICE_LINE = re.compile(r"(?P<device>.+): copy (?P<rate>[\d.]+) GB/s")
TORCH_LINE = re.compile(
    r"W2 (?P<n>\d+)\^3 .*floor (?P<floor>[\d.]+) ms, torch grid_sample.* (?P<time>[\d.]+) ms"
)
CUPY_LINE = re.compile(r"\s+cupy affine_transform.* (?P<time>[\d.]+) ms")


def parse_solves(text):
    """Rows of the lines that bench/peers/siconos_nsgs.py prints:

    FILE.hdf5 contacts N tol T ok sweeps N SOLVER ITS-OWN-ERROR fclib ERROR SECONDS s
    """
    rows = []
    for match in filter(None, map(SOLVE_LINE.match, text.splitlines())):
        counters = {key: float(match[key]) for key in ("contacts", "sweeps", "error")}
        time = 1e3 * float(match["seconds"])
        rows.append(
            Row(
                kind="contact",
                workload=match["file"].removesuffix(".hdf5"),
                method=match["solver"],
                tolerance=float(match["tolerance"]),
                time=time,
                low=time,
                high=time,
                counters=counters,
            )
        )
    return rows


def parse_samplers(text):
    """(device, {workload: {"floor", "torch", "cupy"}}) [ms] of what bench/peers/gpu_samplers.py
    prints; what was not measured is left out."""
    device, peers, times = "", {}, None
    for line in text.splitlines():
        if match := DEVICE_LINE.match(line):
            device = match["device"]
        elif match := TORCH_LINE.match(line):
            times = {"floor": float(match["floor"]), "torch": float(match["time"])}
            peers[f"W2_rotated_{match['n']}"] = times
        elif (match := CUPY_LINE.match(line)) and times is not None:
            times["cupy"] = float(match["time"])
    return device, peers


def read(path, parse):
    with open(path, encoding="utf-8") as file:
        return parse(file.read())


def self_test():
    device, peers = parse_samplers(
        "Some GPU: copy 3900 GB/s (read + write)\n"
        "W2 128^3 -> 8.7 M voxels: floor 0.011 ms, torch grid_sample (field given) 0.113 ms\n"
        "    cupy affine_transform (one affine map, no field) 0.071 ms\n"
        "W2 256^3 -> 69.4 M voxels: floor 0.088 ms, torch grid_sample (field given) 0.912 ms\n"
    )
    assert device == "Some GPU", device
    assert peers == {
        "W2_rotated_128": {"floor": 0.011, "torch": 0.113, "cupy": 0.071},
        "W2_rotated_256": {"floor": 0.088, "torch": 0.912},
    }, peers
    (row,) = parse_solves(
        "a.hdf5   contacts    23 tol 1e-08 ok   sweeps   1100 siconos 9.9e-09 fclib 8e-09  0.0057 s"
    )
    assert (row.workload, row.method, row.tolerance) == ("a", "siconos", 1e-8), row
    assert (row.time, row["sweeps"], row.reaches(1e-8)) == (5.7, 1100, True), row
