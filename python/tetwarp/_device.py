"""Arrays in the memory of a CUDA device, of PyTorch or CuPy: read and written where they are, on
the stream that their library uses."""

from __future__ import annotations

import sys
from typing import Any, Sequence

from . import _core
from ._arrays import check_host, check_samples, describe, is_foreign, is_torch
from ._values import integer_of

_CUDA = (2, 13)  # numbers of DLPack: plain and managed memory


def available_backends(device: int = 0) -> list[dict[str, Any]]:
    """A dict per back end, of the CUDA device of a number: backend, usable, device, and the reason why
    it is not usable.

    >>> [status["usable"] for status in available_backends() if status["backend"] == "cpu"]
    [True]
    """
    return list(_core.available_backends(integer_of(device, "device")))


def on_device(value: Any) -> bool:
    """Whether it is in the memory of a CUDA device."""
    return is_foreign(value) and int(value.__dlpack_device__()[0]) in _CUDA


def type_of(value: Any) -> str:
    """The type of the elements as NumPy calls it; PyTorch puts its own name before."""
    return str(value.dtype).rpartition(".")[2]


class Device:
    """The device of an array, and the library that the array is of."""

    def __init__(self, value: Any, name: str) -> None:
        """Raises ValueError, with what to do, if one of them cannot be used."""
        self.number = int(value.__dlpack_device__()[1])
        self._is_torch = is_torch(value)
        library = "torch" if self._is_torch else type(value).__module__.partition(".")[0]
        self._library: Any = sys.modules[library]
        if not self._is_torch and self._library.__name__ != "cupy":
            check_host(value, name, f"arrays of {self._library.__name__} are not taken there")
        for status in _core.available_backends(self.number):
            if status["backend"] == "cuda" and not status["usable"]:
                check_host(value, name, status["reason"])

    def _current(self) -> Any:
        if self._is_torch:
            return self._library.cuda.current_stream(self.number)
        with self._library.cuda.Device(self.number):
            return self._library.cuda.get_current_stream()

    @property
    def stream(self) -> int:
        """The cudaStream_t on which the library works now."""
        current = self._current()
        return current.cuda_stream if self._is_torch else current.ptr

    def empty(self, shape: Sequence[int], dtype: str) -> Any:
        """A new array of the library on the device."""
        element = getattr(self._library, dtype)
        if self._is_torch:
            return self._library.empty(tuple(shape), dtype=element, device=f"cuda:{self.number}")
        with self._library.cuda.Device(self.number):
            return self._library.empty(tuple(shape), dtype=element)

    def backend(self, backend: str) -> str:
        """The back end of a warp there."""
        if backend not in ("auto", "cuda"):
            raise ValueError(
                'backend: expected "cuda" or "auto" for a volume in the memory of a device, got '
                f"{backend!r}"
            )
        return "cuda"

    def sources_of(self, volumes: Sequence[Any]) -> list[Any]:
        """Samples on one grid, as those of NumPy, after the work on them that is queued."""
        shape = tuple(volumes[0].shape[:3])
        for number, array in enumerate(volumes):
            name = "volume" if len(volumes) == 1 else f"volume[{number}]"
            self._check(array, name)
            check_samples(name, tuple(array.shape), type_of(array))
            if tuple(array.shape[:3]) != shape:
                raise ValueError(
                    f"{name}: expected the grid of volume[0], {shape}, got {tuple(array.shape[:3])}"
                )
        self._current().synchronize()
        return list(volumes)

    def array_of(self, value: Any, name: str, shape: Sequence[int], dtype: str) -> Any:
        """An array on the device, exactly of this shape and type."""
        self._check(value, name)
        if tuple(value.shape) != tuple(shape) or type_of(value) != dtype:
            raise ValueError(
                f"{name}: expected shape {tuple(shape)} of {dtype}, got {describe(value)}"
            )
        return value

    def empty_like(self, value: Any, shape: Sequence[int]) -> Any:
        """A new array of the type of another one."""
        return self.empty(shape, type_of(value))

    def _check(self, value: Any, name: str) -> None:
        if not on_device(value) or int(value.__dlpack_device__()[1]) != self.number:
            raise ValueError(f"{name}: expected an array on device {self.number}, as the volume is")
        if is_torch(value) and value.requires_grad:
            raise ValueError(
                f"{name}: expected a tensor that needs no gradient; use .detach() or autograd_warp"
            )
        ordered = value.is_contiguous() if is_torch(value) else value.flags.c_contiguous
        if not ordered:
            raise ValueError(f"{name}: expected an array in C order; it is not copied on a device")
