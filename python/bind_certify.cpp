/// @file bind_certify.cpp
/// Proofs about moving surfaces.
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <array>
#include <cstdint>
#include <string>
#include <tetwarp/certify.hpp>
#include <utility>
#include <vector>

#include "python/arrays.hpp"
#include "python/bind.hpp"
#include "python/interpreter_lock.hpp"

namespace tetwarp::python {
namespace {
const char* word_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::free:
      return "free";
    case Verdict::meets:
      return "meets";
    default:
      return "undecided";
  }
}

nb::dict certify_arrays(const std::vector<InPoints>& starts,
                        const std::vector<InPoints>& ends,
                        const std::vector<InTriangles>& triangles,
                        bool self,
                        std::int64_t most_intervals,
                        int threads) {
  std::vector<MovingSurface> surfaces;
  for (std::size_t s = 0; s < starts.size(); ++s) {
    surfaces.push_back({points_of(starts[s]), points_of(ends[s]), triangles_of(triangles[s])});
  }
  Certificate found;
  {
    const LockReleased release;
    found = certify(surfaces, {self, most_intervals, threads});
  }
  std::vector<std::array<std::int32_t, 2>> pair_surfaces, pair_triangles;
  std::vector<std::array<double, 2>> times;
  std::vector<std::uint8_t> meets;
  for (const CertifiedPair& pair : found.pairs) {
    pair_surfaces.push_back(pair.surfaces);
    pair_triangles.push_back(pair.triangles);
    times.push_back({pair.from, pair.until});
    meets.push_back(pair.verdict == Verdict::meets);
  }
  nb::dict result;
  result["verdict"] = word_of(found.verdict);
  result["surfaces"] = array_of<std::int32_t>(std::move(pair_surfaces));
  result["triangles"] = array_of<std::int32_t>(std::move(pair_triangles));
  result["times"] = array_of<double>(std::move(times));
  result["meets"] = array_of<std::uint8_t>(std::move(meets));
  result["near_pairs"] = found.near_pairs;
  return result;
}
}  // namespace

void bind_certify(nb::module_& module) {
  module.def("certify", &certify_arrays, nb::arg("starts"), nb::arg("ends"), nb::arg("triangles"),
             nb::kw_only(), nb::arg("self"), nb::arg("most_intervals"), nb::arg("threads"));
}

}  // namespace tetwarp::python
