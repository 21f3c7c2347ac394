"""Checks of arguments: every error names the argument, what it is and what it should be."""

from __future__ import annotations

import os
import sys
from typing import Any, Callable, Sequence

import numpy as np

from . import _core
from ._values import is_masked, number_of

PIXEL_TYPES = (
    "uint8", "int8", "uint16", "int16", "uint32", "int32", "uint64", "int64", "float32", "float64",
)
_NATIVE_PIXELS = {np.dtype(name) for name in PIXEL_TYPES}
_NO_CELLS = {n: np.empty((0, n), np.int32) for n in (4, 6, 8)}
_SPLIT = "tetwarp.split_ten_nodes(cells)"
_FLOAT64, _INT32 = np.dtype(np.float64), np.dtype(np.int32)


def describe(array: np.ndarray) -> str:
    """Shape and type of an array, for messages."""
    return f"shape {tuple(array.shape)} of {array.dtype}"


#: Memory that the host reads, by the numbers of DLPack: plain, page-locked by CUDA or by ROCm.
_HOST_MEMORY = (1, 3, 11)


def is_foreign(value: Any) -> bool:
    """Whether it is an array of another library, which DLPack shows."""
    return hasattr(value, "__dlpack__") and not isinstance(value, np.ndarray)


def is_torch(value: Any) -> bool:
    """Whether it is a tensor of PyTorch or of a class made from it."""
    torch = sys.modules.get("torch")
    return torch is not None and isinstance(value, torch.Tensor)


def _is_jax(value: Any) -> bool:
    """Whether it is an array of JAX, which never changes; DLPack does not tell."""
    jax = sys.modules.get("jax")
    return jax is not None and isinstance(value, jax.Array)


def check_host(value: Any, name: str, reason: str = "") -> None:
    """Raises ValueError if an array of another library is not in memory of the host."""
    kind, number = value.__dlpack_device__()
    if int(kind) not in _HOST_MEMORY:
        raise ValueError(
            f"{name}: expected an array in memory of the host, got one of device {int(number)} "
            f"(DLPack type {int(kind)}); copy it to the host, such as by .cpu() or .get()"
            + (f" ({reason})" if reason else "")
        )


def array_of(value: Any, name: str) -> np.ndarray:
    """An array of another library (PyTorch, JAX, CuPy) in place, by DLPack; anything else as NumPy
    takes it, but for masked elements, whose mask would be lost.
    """
    if type(value) is np.ndarray:
        return value
    if not is_foreign(value):
        if is_masked(value):
            raise ValueError(f"{name}: has masked elements; use .filled(value)")
        try:
            return np.asarray(value)
        except (TypeError, ValueError, OverflowError) as error:
            raise ValueError(f"{name}: expected an array: {error}") from None
    check_host(value, name)
    try:
        return np.from_dlpack(value)
    except (BufferError, RuntimeError, TypeError) as error:
        raise ValueError(f"{name}: cannot be read by DLPack: {error}") from None


def as_array(array: np.ndarray, dtype: Any, copy: bool | None) -> np.ndarray:
    """What `__array__` of something that holds an array returns."""
    array = array_of(array, "array")
    if copy:
        return np.array(array, dtype=dtype)
    if copy is False and dtype is not None and np.dtype(dtype) != array.dtype:
        raise ValueError(f"copy: a conversion from {array.dtype} to {np.dtype(dtype)} makes one")
    return np.asarray(array, dtype=dtype)


def _same(array: np.ndarray) -> np.ndarray:
    return array


def maker_of(value: Any) -> Callable[[np.ndarray], Any]:
    """What makes an array of NumPy one of the library of `value`, in the same memory."""
    if not is_foreign(value):
        return _same
    namespace: Any
    if is_torch(value):
        namespace = sys.modules["torch"]
    elif hasattr(value, "__array_namespace__"):
        namespace = value.__array_namespace__()
    else:
        namespace = sys.modules[type(value).__module__.partition(".")[0]]
    return getattr(namespace, "from_dlpack", _same)


def check_samples(name: str, shape: tuple[int, ...], dtype: str) -> None:
    """Raises ValueError if samples cannot have this shape and type."""
    if dtype not in PIXEL_TYPES:
        hint = "; use .view(numpy.uint8)" if dtype == "bool" else ""
        raise ValueError(f"{name}: expected samples of {', '.join(PIXEL_TYPES)}, got {dtype}{hint}")
    if len(shape) not in (3, 4):
        raise ValueError(f"{name}: expected shape (z, y, x) or (z, y, x, components), got {shape}")
    if len(shape) == 4 and not 1 <= shape[3] <= 9:
        raise ValueError(f"{name}: expected 1 to 9 components, got shape {shape}")
    if 0 in shape:
        raise ValueError(f"{name}: expected at least one voxel along each axis, got {shape}")


def samples_of(value: Any, name: str) -> np.ndarray:
    """Samples of shape (z, y, x) or (z, y, x, c) in C order; copied only if they are not."""
    if type(value) is not np.ndarray:
        if isinstance(value, (str, os.PathLike)):
            raise ValueError(
                f"{name}: expected samples, got the name {value!r}; tetwarp.read reads it")
        if hasattr(value, "dataobj") or hasattr(value, "GetPixelIDTypeAsString"):
            raise ValueError(f"{name}: expected samples, got an image; tetwarp.volume_from takes it")
    array = array_of(value, name)
    dtype = array.dtype if array.dtype.isnative else array.dtype.newbyteorder("=")
    is_pixel = dtype in _NATIVE_PIXELS  # whose name takes longer
    check_samples(name, array.shape, PIXEL_TYPES[0] if is_pixel else dtype.name)
    return in_order(array, dtype)


def renamed(error: Exception, names: dict[str, str]) -> Exception:
    """An error of the library with the name that the argument has in this package."""
    name, colon, rest = str(error).partition(":")
    return type(error)(f"{names[name]}:{rest}") if colon and name in names else error


def integers_of(value: Any, name: str, dtype: Any = np.int32) -> np.ndarray:
    """Whole numbers of one axis; copied only if they are not of this type."""
    array = np.asarray(array_of(value, name)).reshape(-1)
    if array.size and array.dtype.kind not in "iu":
        raise ValueError(f"{name}: expected integers, got {array.dtype}")
    if array.size and max(int(array.max()), -int(array.min())) > np.iinfo(dtype).max:
        raise ValueError(f"{name}: expected numbers up to {np.iinfo(dtype).max}, found "
                         f"{array.min()} to {array.max()}")
    return in_order(array, dtype)


def nodes_of(value: Any, name: str, count: int | None = None) -> np.ndarray:
    """Positions of nodes: as points_of(), and finite."""
    array = points_of(value, name, count)
    check_finite(array, name)
    return array


def check_finite(points: np.ndarray, name: str) -> None:
    """Raises ValueError if a position is not finite."""
    finite = np.isfinite(points)
    if not finite.all():
        row = int(finite.all(axis=1).argmin())
        raise ValueError(f"{name}: expected finite positions, row {row} is not")


def _is_plain(value: Any, dtype: np.dtype) -> bool:
    """Whether it is an array of NumPy of this type in C order, each number where the processor wants
    it.
    """
    if type(value) is not np.ndarray or value.dtype is not dtype:
        return False
    flags = value.flags
    return flags.c_contiguous and flags.aligned


def in_order(array: np.ndarray, dtype: Any = None) -> np.ndarray:
    """An array in C order, each number where the processor wants it; copied only if it is not."""
    flags = array.flags
    if flags.c_contiguous and flags.aligned and array.ndim and type(array) is np.ndarray and (
            dtype is None or array.dtype == dtype):
        return array
    result = np.ascontiguousarray(array, dtype=dtype)
    return result if result.flags.aligned else result.copy()


def floats_of(value: Any, name: str) -> np.ndarray:
    """Real numbers as float64 in C order; copied only if they are not."""
    if _is_plain(value, _FLOAT64):
        return value
    if hasattr(value, "cells"):
        raise ValueError(f"{name}: expected an array of numbers; *mesh gives nodes and cells")
    array = array_of(value, name)
    if array.dtype.kind not in "biuf":
        raise ValueError(f"{name}: expected an array of numbers, got {array.dtype}")
    return in_order(array, np.float64)


def points_of(value: Any, name: str, count: int | None = None) -> np.ndarray:
    """Positions of shape (n, 3), float64 in C order; copied only if they are not."""
    array = floats_of(value, name)
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"{name}: expected shape (n, 3), x y z per row, got {array.shape}")
    if count is not None and array.shape[0] != count:
        raise ValueError(f"{name}: expected {count} rows, one per node, got {array.shape[0]}")
    return array


def check_indices(array: np.ndarray, name: str, node_count: int, least: int = 0) -> None:
    """Raises ValueError for a number that no node has; -1 passes where `least` is -1."""
    if array.size and (array.min() < least or array.max() >= node_count):
        wrong = int(array.min()) if array.min() < least else int(array.max())
        raise ValueError(
            f"{name}: expected numbers of nodes from 0 to {node_count - 1}, found {wrong}"
        )


def _integers(array: np.ndarray, name: str, node_count: int, least: int = 0) -> np.ndarray:
    """Numbers of nodes as int32 in C order; those that are int32 are not checked."""
    if _is_plain(array, _INT32):
        return array
    if array.dtype.kind not in "iu":
        raise ValueError(f"{name}: expected integers, numbers of nodes, got {array.dtype}")
    check_indices(array, name, node_count, least)  # before they are cut
    return in_order(array, np.int32)


def _cells_of_one_kind(value: Any, name: str, node_count: int) -> np.ndarray:
    array = array_of(value, name)
    if array.ndim != 2 or array.shape[1] not in (4, 8, 10):
        raise ValueError(
            f"{name}: expected shape (m, 4) or (m, 10) for tetrahedra or (m, 8) for hexahedra, "
            f"got {array.shape}"
        )
    return _integers(array, name, node_count, -1 if array.shape[1] == 10 else 0)


def triangles_of(value: Any, name: str, node_count: int) -> np.ndarray:
    """Triangles (m, 3) as int32."""
    array = array_of(value, name)
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"{name}: expected shape (m, 3), got {array.shape}")
    triangles = _integers(array, name, node_count)
    check_indices(triangles, name, node_count)
    return triangles


def given_cells_of(
    value: Any, name: str, node_count: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """As curved_cells_of(); numbers of nodes that are int32 are not checked."""
    if isinstance(value, (tuple, list)) and len(value) == 2 and array_of(value[0], name).ndim == 2:
        parts = [_cells_of_one_kind(part, name, node_count) for part in value]
        if parts[0].shape[1] not in (4, 10) or parts[1].shape[1] != 8:
            raise ValueError(
                f"{name}: a pair is tetrahedra (m, 4) or (m, 10), then hexahedra (m, 8)")
        tets, hexes = parts
    else:
        one = _cells_of_one_kind(value, name, node_count)
        tets, hexes = (_NO_CELLS[4], one) if one.shape[1] == 8 else (one, _NO_CELLS[8])
    if len(tets) + len(hexes) == 0:
        raise ValueError(f"{name}: expected at least one cell")
    if tets.shape[1] == 4:
        return tets, hexes, _NO_CELLS[6]
    return np.ascontiguousarray(tets[:, :4]), hexes, np.ascontiguousarray(tets[:, 4:])


def check_cells(cells: Sequence[np.ndarray], name: str, node_count: int) -> None:
    """Raises ValueError if a number in what given_cells_of() returns is none of a node."""
    tets, hexes, mids = cells
    for part in (tets, hexes, mids[(mids != -1).any(axis=1)]):
        check_indices(part, name, node_count)


def curved_cells_of(
    value: Any, name: str, node_count: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Corners of tetrahedra (m, 4), hexahedra (k, 8), and the nodes on edges of tetrahedra (m, 6), -1
    for those of four nodes, or (0, 6) where there is no tetrahedron of ten; all int32. `value` is
    (m, 4), (m, 10), (k, 8), or a pair of tetrahedra and hexahedra.
    """
    cells = given_cells_of(value, name, node_count)
    check_cells(cells, name, node_count)
    return cells


def cells_of(value: Any, name: str, node_count: int) -> tuple[np.ndarray, np.ndarray]:
    """Tetrahedra (m, 4) and hexahedra (k, 8) as int32; refuses tetrahedra of ten nodes."""
    tets, hexes, mids = curved_cells_of(value, name, node_count)
    if (mids >= 0).any():
        raise ValueError(f"{name}: tetrahedra of ten nodes are for warps, fields and points; "
                         f"{_SPLIT} cuts them into straight ones")
    return tets, hexes


def with_remedy(error: Exception) -> Exception:
    """An error of the library about tetrahedra of ten nodes with what splits them."""
    refused = str(error).endswith("tetrahedra of ten nodes do not have; split them")
    return type(error)(f"{error} by {_SPLIT}") if refused else error


def numbers_of(value: Any, name: str, count: int | None = None) -> np.ndarray:
    """Numbers as a flat float64 array in C order."""
    array = floats_of(value, name).reshape(-1)
    if count is not None and array.size != count:
        raise ValueError(f"{name}: expected {count} numbers, got {array.size}")
    return array


def pair_of(value: Any, name: str) -> tuple[float, float]:
    """Two numbers."""
    if type(value) is tuple and len(value) == 2 and type(value[0]) is type(value[1]) is float:
        return value
    first, second = numbers_of(value, name, 2)
    return float(first), float(second)


def vector_of(value: Any, name: str) -> tuple[float, float, float]:
    """Three numbers x, y, z."""
    if type(value) is tuple and len(value) == 3 and {*map(type, value)} <= {float, int}:
        return number_of(value[0], name), number_of(value[1], name), number_of(value[2], name)
    numbers = numbers_of(value, name)
    if numbers.size != 3:
        raise ValueError(f"{name}: expected three numbers x, y, z, got {numbers.size}")
    return float(numbers[0]), float(numbers[1]), float(numbers[2])


def out_of(value: Any, name: str, shape: Sequence[int], dtype: Any) -> np.ndarray:
    """An array to write to: exactly of this shape and type, writable, in C order; of another
    library its memory, as an array of NumPy.
    """
    shape, dtype = tuple(shape), np.dtype(dtype)
    if is_torch(value) and value.requires_grad:
        raise ValueError(f"{name}: expected a tensor that needs no gradient; use .detach()")
    if _is_jax(value):
        raise ValueError(f"{name}: expected an array that may be written to; those of JAX never change")
    if is_foreign(value):
        check_host(value, name)
        try:
            value = _core.writable_array(value)
        except (TypeError, BufferError, RuntimeError) as error:
            raise ValueError(f"{name}: cannot be written to by DLPack: {error}") from None
    if is_masked(value):
        raise ValueError(f"{name}: has masked elements, which would hide what is written")
    if not isinstance(value, np.ndarray):
        raise ValueError(f"{name}: expected an array of {dtype} to write to, of NumPy or by DLPack")
    if value.shape != shape or value.dtype != dtype:
        raise ValueError(f"{name}: expected shape {shape} of {dtype}, got {describe(value)}")
    if not value.flags.c_contiguous:
        raise ValueError(f"{name}: expected an array in C order, got strides {value.strides}")
    if not value.flags.aligned:
        raise ValueError(f"{name}: expected an array whose numbers are aligned in memory")
    if not value.flags.writeable:
        raise ValueError(f"{name}: expected a writable array")
    return value


def listed_outs(out: Any, count: int) -> list[tuple[str, Any]]:
    """Arrays to write to, one per source, with their names in messages."""
    given = list(out) if isinstance(out, (list, tuple)) else [out]
    if len(given) != count:
        raise ValueError(f"out: expected {count} arrays, got {len(given)}")
    return [("out" if count == 1 else f"out[{n}]", array) for n, array in enumerate(given)]


def outs_of(out: Any, shapes: Sequence[Sequence[int]], sources: Sequence[Any]) -> list[np.ndarray]:
    """One array to write to per source, of these shapes and the types of the sources."""
    given = listed_outs(out, len(shapes))
    return [out_of(array, name, shape, source.dtype)
            for (name, array), shape, source in zip(given, shapes, sources)]
