"""Times of PyTorch and CuPy on the same device, and rows of ours beside them.

What a peer program prints for the rotated n^3 volume of workload W2, in milliseconds:

    DEVICE: copy 3900 GB/s (read + write)
    W2 256^3 -> 69.4 M voxels: floor 0.088 ms, torch grid_sample (...) 0.912 ms
        cupy affine_transform (...) 0.655 ms
"""
import re

DEVICE_LINE = re.compile(r"(?P<device>.+): copy (?P<rate>[\d.]+) GB/s")
TORCH_LINE = re.compile(
    r"W2 (?P<n>\d+)\^3 .*floor (?P<floor>[\d.]+) ms, torch grid_sample.* (?P<time>[\d.]+) ms"
)
CUPY_LINE = re.compile(r"\s+cupy affine_transform.* (?P<time>[\d.]+) ms")
PEERS = ("torch", "cupy")


def parse_peers(text):
    """(device, {workload: {"floor", "torch", "cupy"}}) [ms]; what was not measured is not there."""
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


def rows_with_peers(rows, peers):
    """Pairs of a row of ours and the peers' times of its workload."""
    return [
        (row, peers[row.workload])
        for row in rows
        if (row.kind, row.backend, row.filter, row.type) == ("warp", "cuda", "linear", "float32")
        and row.components == 1
        and not row.without
        and row.workload in peers
    ]


def self_test():
    device, peers = parse_peers(
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
    print("gpu_rows.py: parsed as expected")


if __name__ == "__main__":
    self_test()
