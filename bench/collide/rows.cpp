#include "bench/collide/rows.hpp"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <functional>
#include <span>
#include <vector>

#include "bench/collide/sort_and_sweep.hpp"
#include "bench/measure/row.hpp"
#include "host/collide/detector_pipeline.hpp"
#include "host/exec/exec_cpu.hpp"

namespace tetwarp::bench {
namespace {
/// Rows of one size follow each other, so only the last scene is kept.
const test::CollideScene& pile_of(int triangles, bool touches_itself) {
  static int known = 0;
  static bool known_self = false;
  static test::CollideScene scene;
  if (known == triangles && known_self == touches_itself) return scene;
  scene = test::pile_scene(20, triangles, {.touches_itself = touches_itself});
  std::vector<Point3>& end = scene.motion.end.vertices;
  for (std::size_t v = 0; v < end.size(); ++v) {
    const Point3& start = scene.motion.start.vertices[v];
    end[v] = plus(start, times(0.1, minus(end[v], start)));
  }
  known = triangles;
  known_self = touches_itself;
  return scene;
}

Protocol protocol_for(double first_seconds) {
  const int repetitions = std::clamp(static_cast<int>(2 / std::max(first_seconds, 1e-9)), 3, 41);
  return {.repetitions = repetitions, .attempts = 2 * repetitions, .seconds = 10};
}

class Pile {
 public:
  Pile(const test::CollideScene& scene, int threads)
      : scene_(scene), exec_(threads), pipeline_(exec_, scene.surfaces, {}) {}

  void detect() {
    pipeline_.begin_step();
    again();
  }
  void again() { pipeline_.detect(scene_.motion); }
  DetectionCounts counts() { return pipeline_.take_counts(); }
  /// Seconds since the last call, up to the pairs of triangles and of the rest.
  std::pair<double, double> seconds() {
    double broad = 0, narrow = 0;
    for (const char* label : {"collide/vertex_box", "collide/item_box", "collide/item_cells",
                              "collide/sort", "collide/entry_pairs"}) {
      broad += exec_.times().of(label);
    }
    for (const char* label : {"collide/pair_features", "collide/pair_touch"}) {
      narrow += exec_.times().of(label);
    }
    exec_.times().clear();
    return {broad, narrow};
  }

 private:
  const test::CollideScene& scene_;
  CpuExec exec_;
  DetectorPipeline<CpuExec> pipeline_;
};

void run_detect(benchmark::State& state, int triangles, bool self, int threads, bool again) {
  const test::CollideScene& scene = pile_of(triangles, self);
  Pile pile(scene, threads);
  pile.detect();
  const DetectionCounts counts = pile.counts();
  if (counts.box_pairs != sort_and_sweep(scene)) {
    return refuse(state, "the pairs of boxes differ from those of the sort-and-sweep");
  }
  const std::function<void()> job = [&] { again ? pile.again() : pile.detect(); };
  const double first_seconds = seconds_of(job);
  pile.counts();
  pile.seconds();
  int runs = 0;
  const std::function<void()> counted = [&] {
    job();
    ++runs;
  };
  count_timing(state, time_in_turn(std::span(&counted, 1), protocol_for(first_seconds)).front());
  const auto [broad, narrow] = pile.seconds();
  state.counters["broad"] = 1e3 * broad / runs;
  state.counters["narrow"] = 1e3 * narrow / runs;
  const auto count = static_cast<double>(scene.surfaces.triangles.size());
  state.counters["entries"] = static_cast<double>(counts.grid_entries) / count;
  state.counters["box_tests"] = static_cast<double>(counts.box_tests) / count;
  state.counters["box_pairs"] = static_cast<double>(counts.box_pairs) / count;
  state.counters["pairs"] = static_cast<double>(counts.pairs);
}

void run_sweep(benchmark::State& state, int triangles, bool self) {
  const test::CollideScene& scene = pile_of(triangles, self);
  std::int64_t pairs = 0;
  const std::function<void()> job = [&] { pairs = sort_and_sweep(scene); };
  const double first_seconds = seconds_of(job);
  count_timing(state, time_in_turn(std::span(&job, 1), protocol_for(first_seconds)).front());
  state.counters["box_pairs"] =
      static_cast<double>(pairs) / static_cast<double>(scene.surfaces.triangles.size());
}

std::vector<int> sizes_of(Extent extent) {
  std::vector<int> sizes = {10000, 100000};
  if (extent == Extent::full) sizes.push_back(1000000);
  return sizes;
}

template <class T>
void write(std::ofstream& file, const std::vector<T>& values) {
  file.write(reinterpret_cast<const char*>(values.data()),
             static_cast<std::streamsize>(values.size() * sizeof(T)));
}
}  // namespace

void add_collide_rows(Extent extent) {
  std::vector<int> counts = {1};
  if (processor_threads() > 1) counts.push_back(2);
  for (const int triangles : sizes_of(extent)) {
    for (const bool self : {false, true}) {
      const std::string axes =
          "/triangles:" + std::to_string(triangles) + "/self:" + std::to_string(self);
      for (const int threads : counts) {
        const std::string all = axes + "/threads:" + std::to_string(threads);
        add_row("detect" + all, [=](benchmark::State& state) {
          run_detect(state, triangles, self, threads, false);
        });
        add_row("again" + all, [=](benchmark::State& state) {
          run_detect(state, triangles, self, threads, true);
        });
      }
      add_row("sweep" + axes, [=](benchmark::State& state) { run_sweep(state, triangles, self); });
    }
  }
}

int export_piles(const std::string& folder, Extent extent) {
  for (const int triangles : sizes_of(extent)) {
    const test::CollideScene& scene = pile_of(triangles, true);
    const CollisionSurfaces& s = scene.surfaces;
    const std::string path = folder + "/pile_" + std::to_string(triangles) + ".bin";
    std::ofstream file(path, std::ios::binary);
    write(file, std::vector<std::int64_t>{static_cast<std::int64_t>(s.vertex_body.size()),
                                          static_cast<std::int64_t>(s.edges.size()),
                                          static_cast<std::int64_t>(s.triangles.size())});
    write(file, scene.motion.start.vertices);
    write(file, scene.motion.end.vertices);
    write(file, s.edges);
    write(file, s.triangles);
    if (!file.flush()) {
      std::fprintf(stderr, "cannot write %s\n", path.c_str());
      return 1;
    }
  }
  return 0;
}

}  // namespace tetwarp::bench
