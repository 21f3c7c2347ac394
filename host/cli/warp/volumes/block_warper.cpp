/// @file block_warper.cpp
/// Makes a Warper for a volume or a block, and takes its results.
#include "host/cli/warp/volumes/block_warper.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace tetwarp::cli {
namespace {
/// Whether the outputs of a step equal those of the previous one.
bool changes_nothing(const Counts& counts, const ExtraChoice& extra) {
  const bool keeps_forward =
      !extra.contains(forward_output) || counts.tets_unchanged == counts.tetrahedra;
  return counts.cells > 0 && counts.cells_unchanged == counts.cells && keeps_forward;
}
}  // namespace

VolumePart BlockWarper::compute(VolumePart part,
                                const WarpBlock& block,
                                const Samples& windows,
                                const Progress& progress) {
  if (!task_.is_whole || !warper_) make_warper(block, windows);
  part.outputs = outputs_for(part.region);
  std::vector<void*> volumes;
  for (std::size_t s = 0; s < task_.volume.arrays.size(); ++s) {
    volumes.push_back((*part.outputs)[s].get());
  }
  WarpTarget target;
  target.volumes = volumes;
  target.holds_previous = task_.is_whole;
  std::size_t extra = volumes.size();
  for (const std::size_t e : task_.arguments.extra) {
    extra_outputs[e].set(target, (*part.outputs)[extra++].get());
  }
  const std::vector<Point3>& positions = part.step->positions;
  const std::vector<Point3> of_block =
      part_mesh_ ? part_mesh_->of(positions) : std::vector<Point3>();
  const StepReport computed = warper_->step(part_mesh_ ? of_block : positions, target, progress);
  VolumeStep& step = *part.step;
  step.report.timings += computed.timings;
  step.report.counts += computed.counts;
  step.report.totals = computed.totals;
  if (task_.is_whole) {
    step.is_repeat =
        task_.volume.is_series && changes_nothing(step.report.counts, task_.arguments.extra);
  } else {
    end_block(block, target.owner, step.report.counts);
  }
  return part;
}

/// Frees what was made for a block. Numbers of cells in the outputs become those of the whole mesh.
/// @param owners  array of the outputs; null: not written
void BlockWarper::end_block(const WarpBlock& block, std::int32_t* owners, Counts& counts) {
  warper_.reset();
  part_mesh_.reset();
  for (const ArrayHeader& array : task_.volume.arrays) {
    counts.bytes_read += static_cast<std::int64_t>(bytes_of(array, block.source));
  }
  if (owners == nullptr) return;
  std::for_each_n(owners, block.output.voxel_count(), [&](std::int32_t& t) {
    if (t >= 0) t = block.cells[static_cast<std::size_t>(t)];
  });
}

void BlockWarper::make_warper(const WarpBlock& block, const Samples& windows) {
  const Mesh& mesh = task_.job.mesh.mesh();
  const std::vector<MidNodes>& mid_nodes = task_.job.mesh.mid_nodes();
  if (task_.is_whole && !mid_nodes.empty()) {
    warper_.emplace(sources_.views(), CurvedMesh{mesh, mid_nodes}, task_.options);
  } else if (task_.is_whole) {
    warper_.emplace(sources_.views(), mesh, task_.options);
  } else {
    WarpOptions options = task_.options;
    options.region = block.output;
    options.source_window = SourceWindow{block.source, sources_.ranges()};
    BlockMesh& part = part_mesh_.emplace(block_mesh(mesh, block, mid_nodes));
    warper_.emplace(sources_.views_of(windows),
                    CurvedMesh{std::move(part.mesh), std::move(part.mid_nodes)}, options);
  }
  const Report& report = warper_->report();
  report_.device = report.device;
  report_.threads = report.threads;
  report_.position_quantum = report.position_quantum;
}

/// New memory for a block. For a whole volume the two sets of kept_ in turns, or a single one where
/// a step is not computed before the previous one is written.
std::shared_ptr<Samples> BlockWarper::outputs_for(const Region& region) {
  if (!task_.is_whole) return std::make_shared<Samples>(make_samples(task_.outputs, region));
  if (task_.writes_beside) now_ = 1 - now_;
  std::shared_ptr<Samples>& kept = kept_[now_];
  if (kept == nullptr) kept = std::make_shared<Samples>(make_samples(task_.outputs, region));
  return kept;
}

}  // namespace tetwarp::cli
