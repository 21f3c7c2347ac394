/// @file chunks_noio.cpp
/// Without HDF5 no files are written.
#include "bench/chunks.hpp"

namespace tetwarp::bench {

void register_chunk_rows(int) {}

}  // namespace tetwarp::bench
