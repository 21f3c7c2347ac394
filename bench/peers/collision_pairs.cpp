/// @file collision_pairs.cpp
/// Pairs of features that meet by construction, and random ones, with the answers of tetwarp: for
/// comparison with other programs (collision_ipctk.py).
///
///     tetwarp_collision_pairs FILE HITS RANDOM
///
/// FILE gets float64 numbers, 31 per pair: 0 vertex-face or 1 edge-edge, kind (-1: random), size,
/// time of the constructed meeting or 2, distance and slack of the limits, time of touch, then the
/// four points at the start and at the end. HITS pairs of each of 12 kinds and RANDOM ones, for
/// both features. Prints nanoseconds and evaluations per pair.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "tests/collide/constructed_hits.hpp"

namespace {

using namespace tetwarp;
using namespace tetwarp::test;

struct Record {
  double edges, kind, size, meeting, distance, slack, touch;
  std::array<Point3, 4> start, end;
};
static_assert(sizeof(Record) == 31 * sizeof(double));

struct Cost {
  double nanoseconds = 0, evaluations = 0, pairs = 0;
};

/// Answers of pairs in one go, so that the clock is read rarely.
Cost answer(const std::vector<MovingPair>& pairs, int kind, bool edges, std::ofstream& file) {
  std::vector<CcdResult> results(pairs.size());
  const auto start = std::chrono::steady_clock::now();
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    results[k] = ccd_of(pairs[k], edges, detection_limits(1e-3 * pairs[k].size));
  }
  const std::chrono::duration<double, std::nano> time = std::chrono::steady_clock::now() - start;
  Cost cost{time.count(), 0, static_cast<double>(pairs.size())};
  for (std::size_t k = 0; k < pairs.size(); ++k) {
    const MovingPair& pair = pairs[k];
    const CcdLimits limits = detection_limits(1e-3 * pair.size);
    const Record record{double(edges), double(kind),    pair.size,  pair.time, limits.distance,
                        limits.slack,  results[k].time, pair.start, pair.end};
    file.write(reinterpret_cast<const char*>(&record), sizeof(record));
    cost.evaluations += results[k].evaluations;
  }
  return cost;
}

void print(const char* name, bool edges, const Cost& cost) {
  std::printf("tetwarp, %s, %s: %.0f ns and %.1f evaluations per pair\n",
              edges ? "edge-edge" : "vertex-face", name, cost.nanoseconds / cost.pairs,
              cost.evaluations / cost.pairs);
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 4) {
    std::fprintf(stderr, "usage: tetwarp_collision_pairs FILE HITS RANDOM\n");
    return 2;
  }
  std::ofstream file(arguments[1], std::ios::binary);
  std::mt19937_64 random(1);
  for (const bool edges : {false, true}) {
    Cost hits;
    for (const HitKind kind : all_hit_kinds) {
      std::vector<MovingPair> pairs(static_cast<std::size_t>(std::atoi(arguments[2])));
      for (MovingPair& pair : pairs) pair = constructed_hit(kind, edges, random);
      const Cost own = answer(pairs, static_cast<int>(kind), edges, file);
      hits.nanoseconds += own.nanoseconds;
      hits.evaluations += own.evaluations;
      hits.pairs += own.pairs;
    }
    std::vector<MovingPair> pairs(static_cast<std::size_t>(std::atoi(arguments[3])));
    for (MovingPair& pair : pairs) pair = random_pair(random);
    const Cost others = answer(pairs, -1, edges, file);
    print("meetings", edges, hits);
    print("random", edges, others);
  }
  file.flush();
  if (file) return 0;
  std::fprintf(stderr, "%s: cannot be written\n", arguments[1]);
  return 1;
}
