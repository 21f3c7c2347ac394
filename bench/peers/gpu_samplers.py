#!/usr/bin/env python3
"""Time the sampling half of a warp on a CUDA device by PyTorch and, where installed, CuPy.

The map is that of workload W2: n^3 voxels turned by 45 degrees about z and x; the output grid holds
the turned cube. PyTorch gets the dense field of positions for nothing, CuPy the affine map. Prints
median milliseconds and a floor: input read once and output written once at the copy bandwidth
measured here. `bench/report tables` reads the lines with --gpu-peers. Needs PyTorch.
"""
import argparse
import math
import time

import torch


def rotation():
    """45 degrees about z, then about x."""
    c = math.cos(math.pi / 4)
    about_z = torch.tensor([[c, -c, 0], [c, c, 0], [0, 0, 1]], dtype=torch.float64)
    about_x = torch.tensor([[1, 0, 0], [0, c, -c], [0, c, c]], dtype=torch.float64)
    return about_x @ about_z


def milliseconds_of(device, work, repetitions):
    """Median, after two calls that do not count."""
    times = []
    for repetition in range(-2, repetitions):
        if device == "cuda":
            begin, end = (torch.cuda.Event(enable_timing=True) for _ in range(2))
            begin.record()
            work()
            end.record()
            torch.cuda.synchronize()
            milliseconds = begin.elapsed_time(end)
        else:
            start = time.perf_counter()
            work()
            milliseconds = 1e3 * (time.perf_counter() - start)
        if repetition >= 0:
            times.append(milliseconds)
    return sorted(times)[len(times) // 2]


def copy_bandwidth(device, repetitions):
    """Bytes read plus bytes written per second [GB/s]."""
    count = 1 << (28 if device == "cuda" else 24)
    source, target = torch.rand(count, device=device), torch.empty(count, device=device)
    return 8e-6 * count / milliseconds_of(device, lambda: target.copy_(source), repetitions)


def time_torch(device, volume, extent, turn, repetitions):
    size = volume.shape[-1]
    scale = torch.tensor([e / size for e in extent], dtype=torch.float64)
    theta = torch.zeros(1, 3, 4, dtype=torch.float64)
    theta[0, :, :3] = turn.T * scale[None, :]
    shape = (1, 1, *reversed(extent))
    functional = torch.nn.functional
    grid = functional.affine_grid(theta.to(device, torch.float32), shape, align_corners=False)
    with torch.no_grad():
        return milliseconds_of(
            device,
            lambda: functional.grid_sample(
                volume, grid, mode="bilinear", padding_mode="zeros", align_corners=False
            ),
            repetitions,
        )


def time_cupy(device, volume, extent, turn, repetitions):
    import cupy
    from cupyx.scipy import ndimage

    source = cupy.from_dlpack(volume[0, 0].contiguous())
    matrix = cupy.asarray(turn.T.numpy()[::-1, ::-1].copy())
    middle = cupy.asarray([(volume.shape[-1] - 1) / 2] * 3)
    offset = middle - matrix @ cupy.asarray([(e - 1) / 2 for e in reversed(extent)])
    shape = tuple(reversed(extent))
    return milliseconds_of(
        device,
        lambda: ndimage.affine_transform(source, matrix, offset, shape, order=1, prefilter=False),
        repetitions,
    )


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--device", default="cuda" if torch.cuda.is_available() else "cpu")
    parser.add_argument("--sizes", default="128,256,384")
    parser.add_argument("--repetitions", type=int, default=20)
    arguments = parser.parse_args()
    device, repetitions = arguments.device, arguments.repetitions
    bandwidth = copy_bandwidth(device, repetitions)
    name = torch.cuda.get_device_name() if device == "cuda" else "cpu"
    print(f"{name}: copy {bandwidth:.0f} GB/s (read + write)")
    turn = rotation()
    for size in map(int, arguments.sizes.split(",")):
        extent = [math.ceil(size * float(reach)) for reach in turn.abs().sum(1)]  # x, y, z
        voxels = math.prod(extent)
        volume = torch.rand(1, 1, size, size, size, device=device)
        floor = 4e-6 * (size**3 + voxels) / bandwidth
        time_given = time_torch(device, volume, extent, turn, repetitions)
        print(
            f"W2 {size}^3 -> {voxels / 1e6:.1f} M voxels: floor {floor:.3f} ms, "
            f"torch grid_sample (field given, 12 bytes a voxel) {time_given:.3f} ms"
        )
        try:
            time_affine = time_cupy(device, volume, extent, turn, repetitions)
        except ImportError:
            continue
        print(f"    cupy affine_transform (one affine map, no field) {time_affine:.3f} ms")


if __name__ == "__main__":
    main()
