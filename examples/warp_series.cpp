/// @file warp_series.cpp
/// Warps a volume through a series of deformations and writes all steps to series.vtkhdf. Two
/// result buffers are used alternately: while this program writes one step to the file, a CUDA
/// device, where there is one, computes the next.
#include <cstddef>
#include <cstdio>
#include <tetwarp/io.hpp>
#include <tetwarp/tetwarp.hpp>

int main() {
  constexpr std::size_t step_count = 5;
  const tetwarp::Volume source = tetwarp::make_phantom({128, 80, 61});
  const tetwarp::Mesh mesh = tetwarp::make_lattice_mesh(source, {.cells = 12});
  tetwarp::Warper warper(source, mesh);

  tetwarp::Volume results[2];
  tetwarp::PageLock locks[2];  // a device copies to and from locked memory without the host
  for (std::size_t buffer = 0; buffer < 2; ++buffer) {
    results[buffer] = tetwarp::make_volume(warper.output_grid(), source.type);
    locks[buffer] = tetwarp::PageLock(results[buffer].data.data(), results[buffer].data.size());
  }
  const auto begin = [&](std::size_t step) {
    const double time = static_cast<double>(step) / (step_count - 1);
    void* const samples = results[step % 2].data.data();
    warper.begin_step(tetwarp::deform_positions(mesh, {.kind = tetwarp::Deformation::bend}, time),
                      {.volumes = {&samples, 1}});
  };

  tetwarp::TemporalVolumeWriter writer("series.vtkhdf");
  begin(0);
  for (std::size_t step = 0; step < step_count; ++step) {
    if (step + 1 < step_count) begin(step + 1);
    const tetwarp::StepReport report = warper.finish_step();
    writer.append(static_cast<double>(step), {&results[step % 2]});
    std::printf("step %zu: %lld voxels covered, %.1f ms\n", step,
                static_cast<long long>(report.counts.covered), 1e3 * report.timings.total);
  }
  writer.finish();

  const bool has_all_steps =
      tetwarp::read_volume_header("series.vtkhdf").times.size() == step_count;
  const tetwarp::Volume first = tetwarp::read_volume("series.vtkhdf", {}, 0);
  return has_all_steps && first.data != results[(step_count - 1) % 2].data ? 0 : 1;
}
