/// @file error.hpp
/// Errors of the emulated runtime. As in CUDA, a failed call also sets the last error of its
/// thread, which stays until cudaGetLastError() reads it.
#pragma once

// NOLINTBEGIN(readability-identifier-naming): CUDA's own names and numbers
enum cudaError_t {
  cudaSuccess = 0,
  cudaErrorInvalidValue = 1,
  cudaErrorMemoryAllocation = 2,
  cudaErrorInvalidDevice = 101,
  cudaErrorInvalidResourceHandle = 400,
  cudaErrorNotReady = 600,
  cudaErrorIllegalAddress = 700,
  cudaErrorStreamCaptureUnsupported = 900
};
// NOLINTEND(readability-identifier-naming)

namespace tetwarp::simt {

inline thread_local cudaError_t last_error = cudaSuccess;
inline thread_local int current_device = 0;

}  // namespace tetwarp::simt

// NOLINTBEGIN(readability-identifier-naming): CUDA's own names
inline const char* cudaGetErrorString(cudaError_t error) {
  switch (error) {
    case cudaSuccess:
      return "no error";
    case cudaErrorInvalidValue:
      return "invalid argument";
    case cudaErrorMemoryAllocation:
      return "out of memory";
    case cudaErrorInvalidDevice:
      return "invalid device ordinal";
    case cudaErrorInvalidResourceHandle:
      return "invalid resource handle";
    case cudaErrorNotReady:
      return "device not ready";
    case cudaErrorIllegalAddress:
      return "an illegal memory access was encountered";
    case cudaErrorStreamCaptureUnsupported:
      return "operation not permitted when stream is capturing";
  }
  return "unknown error";
}
inline cudaError_t cudaPeekAtLastError() {
  return tetwarp::simt::last_error;
}
inline cudaError_t cudaGetLastError() {
  const cudaError_t error = tetwarp::simt::last_error;
  tetwarp::simt::last_error = cudaSuccess;
  return error;
}
// NOLINTEND(readability-identifier-naming)
