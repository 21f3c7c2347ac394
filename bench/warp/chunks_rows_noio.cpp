/// @file chunks_rows_noio.cpp
/// A build without HDF5 writes no files.
#include "bench/warp/rows.hpp"

namespace tetwarp::bench {

void add_chunk_rows(const Selection&) {}

}  // namespace tetwarp::bench
