/// @file cuda_runtime.h
/// Stands in for CUDA's header where g++ compiles `.cuh` files: the emulated device.
#pragma once
#include "tests/emulator/runtime.hpp"  // IWYU pragma: export
