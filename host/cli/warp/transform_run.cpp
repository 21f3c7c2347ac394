/// @file transform_run.cpp
/// Plans memory, resamples and writes step by step.
#include "host/cli/warp/transform_run.hpp"

#include <fmt/format.h>
#include <malloc.h>

#include <algorithm>
#include <cstddef>
#include <span>
#include <stdexcept>
#include <utility>
#include <variant>

#include "host/cli/common/interrupt.hpp"
#include "host/cli/job/disk_plan.hpp"
#include "host/cli/job/memory_plan.hpp"
#include "host/cli/job/output_grid.hpp"
#include "host/cli/job/source_scan.hpp"
#include "host/cli/warp/volumes/samples.hpp"
#include "io/files/memory.hpp"

namespace tetwarp::cli {
namespace {
/// The fields of a transform, null for its other links.
std::vector<DisplacementField*> fields_of(Transform& transform) {
  std::vector<DisplacementField*> fields;
  if (auto* const chain = std::get_if<TransformChain>(&transform)) {
    for (SingleTransform& link : chain->links) {
      fields.push_back(std::get_if<DisplacementField>(&link));
    }
  } else {
    fields.push_back(std::get_if<DisplacementField>(&transform));
  }
  return fields;
}

/// How the transform is read: for the world of the source and, of a field with several steps, the
/// one that --steps chooses.
TransformReadOptions read_options(const WarpArguments& arguments, const TransformSource& source) {
  TransformReadOptions options = arguments.transform_options();
  options.takes_inverted = true;
  const std::string& path = arguments.files.back();
  options.world = source.world ? source.world : base_factor(arguments.grid);
  const bool says_steps = std::ranges::any_of(
      arguments.given, [](const auto& option) { return option.first == "steps"; });
  if (!says_steps) return options;
  const std::vector<std::int64_t> steps =
      arguments.steps.of(transform_step_count(path, options), path);
  if (steps.size() > 1) {
    throw IoError(path, "",
                  fmt::format("--steps chooses {} steps of the field; a warp is by one, such as "
                              "--steps {}",
                              steps.size(), steps.front()));
  }
  options.step = steps.front();
  return options;
}

/// Bytes of a voxel of the largest array.
double largest_voxel(const std::vector<ArrayHeader>& arrays) {
  double most = 0;
  for (const ArrayHeader& array : arrays) most = std::max(most, voxel_bytes({array}));
  return most;
}
}  // namespace

TransformRun::TransformRun(const WarpArguments& arguments,
                           const TransformSource& source,
                           const ResampleOptions& options)
    : arguments_(arguments),
      source_(source),
      read_(read_options(arguments, source)),
      parts_(open_transform(arguments.files.back(), read_)),
      options_(options) {
  const bool says_outside = std::ranges::any_of(
      arguments.given, [](const auto& option) { return option.first == "outside"; });
  if (parts_.file.ends_with_field && !says_outside) options_.only_in_field = true;
  if (inverts() && options_.only_in_field) {
    throw IoError(arguments.files.back(), "",
                  "is inverted, and positions without an inverse keep their place; leave out "
                  "--outside background");
  }
  plan_.path = arguments.files.front();
  plan_.read = source.read;
  plan_.read.scratch = arguments.output;
  plan_.arrays = source.arrays;
  plan_.fields = parts_.fields;
  plan_.source_grid = source.header.grid;
  plan_.output_grid = plan_.written_grid = *options.output_grid;
  for (const std::int64_t step : source.steps) plan_.steps.push_back({step, 0, step, 0});
  plan_.is_series = source.is_series;
  plan_.outputs = {arguments.output};
  plan_memory();
}

bool TransformRun::inverts() const {
  return std::ranges::count(parts_.file.is_inverted, true) > 0;
}

std::string TransformRun::convention() const {
  if (!inverts()) return parts_.file.convention;
  return fmt::format("{}, inverted within {:.2g}", parts_.file.convention, notes_.largest_residual);
}

void TransformRun::plan_memory() {
  const double spline = options_.filter == Filter::bspline ? 16 : 0;  // bytes of a sample, at most
  const auto from = static_cast<double>(plan_.source_grid.voxel_count());
  const auto to = static_cast<double>(plan_.output_grid.voxel_count());
  double samples = 0, displacements = 0;
  for (const ArrayHeader& array : plan_.arrays) {
    const double voxel = voxel_bytes({array});
    samples = std::max(samples, from * (voxel + array.components * spline) + to * voxel);
  }
  const std::vector<DisplacementField*> fields = fields_of(parts_.file.transform);
  for (std::size_t n = 0; n < fields.size(); ++n) {
    if (fields[n] == nullptr) continue;
    displacements +=
        parts_.fields[n].voxel_bytes * static_cast<double>(fields[n]->grid.voxel_count());
  }
  if (inverts()) displacements += compose_memory(plan_.output_grid, arguments_.warp.threads);
  fixed_bytes_ = fixed_memory(plan_, arguments_, MeshHeader{});
  plan_.memory = fixed_bytes_ + samples + displacements;
  set_memory_limit(plan_, arguments_);
  check_room({&plan_, 1}, arguments_);
  if (is_whole()) return;
  if (inverts()) {
    const std::string& path = arguments_.files.back();
    throw IoError(
        path, "",
        fmt::format("leads from the source to the output, and its inverse needs all voxels "
                    "at once; give --memory at least {}, or write the inverse by tetwarp "
                    "compose {} -o FIELD --like IMAGE, and warp by FIELD",
                    limit_text(plan_.memory), path));
  }
  mallopt(M_MMAP_THRESHOLD, 1 << 20);  // the memory of a part is returned when it is freed
}

PartLimits TransformRun::limits() const {
  const std::array<std::int64_t, 3> step = block_step(plan_.output_grid, plan_.arrays);
  const double voxel = largest_voxel(plan_.arrays);
  return {plan_.memory_limit - fixed_bytes_, voxel, voxel, {step[1], step[2]}};
}

ResampleBlocks TransformRun::blocks(const PartLimits& limits) const {
  return {plan_.source_grid, plan_.output_grid, parts_.file.transform,
          parts_.fields,     options_.filter,   limits};
}

/// Memory of the largest of the smallest parts, or of the whole if that is less [byte].
double TransformRun::least_part_bytes() const {
  PartLimits smallest = limits();
  smallest.bytes = plan_.memory - fixed_bytes_;
  smallest.most_voxels = 1;
  ResampleBlocks all = blocks(smallest);
  double bytes = 0;
  try {
    while (all.next()) {
      stop_if_interrupted();
      bytes = std::max(bytes, all.bytes());
    }
  } catch (const std::invalid_argument&) {
    return smallest.bytes;
  }
  return bytes;
}

std::optional<ResamplePart> TransformRun::next_part(ResampleBlocks& blocks) const {
  try {
    return blocks.next();
  } catch (const std::invalid_argument&) {
    if (blocks.bytes() <= limits().bytes) throw;
    const double least = least_part_bytes();
    throw std::invalid_argument(fmt::format(
        "{}: --memory is too low: the program takes {}, a part of the output with its source and "
        "fields {} more; give at least {}",
        plan_.path, bytes_text(fixed_bytes_), bytes_text(least), limit_text(fixed_bytes_ + least)));
  }
}

StepPlan TransformRun::plan_of_a_step() const {
  StepPlan plan{.volume = plan_.path, .dims = plan_.output_grid.dims};
  if (is_whole() || !plan_.refusal.empty()) {
    plan.memory = plan_.memory;
    plan.disk = temporary_disk(plan_, arguments_, is_whole() ? 0 : 2);
    return plan;
  }
  ResampleBlocks all = blocks(limits());
  while (const std::optional<ResamplePart> part = next_part(all)) {
    stop_if_interrupted();
    const std::int64_t window = part->source.region.voxel_count();
    ++plan.blocks;
    plan.memory = std::max(plan.memory, fixed_bytes_ + all.bytes());
    plan.largest_block = std::max(plan.largest_block, part->output.voxel_count());
    plan.largest_window = std::max(plan.largest_window, window);
    plan.bytes_read += static_cast<double>(window) * voxel_bytes(plan_.arrays);
    for (const FieldWindow& field : part->fields) {
      plan.bytes_read += static_cast<double>(sizeof(float) * field.displacement.size());
    }
  }
  plan.disk = temporary_disk(plan_, arguments_, plan.blocks);
  return plan;
}

void TransformRun::plan(JobResult& result) {
  // All steps are read through the same windows.
  StepPlan plan = plan_of_a_step();
  for (const std::int64_t step : source_.steps) {
    plan.step = step;
    result.plans.push_back(plan);
  }
  result.refusal = plan_.refusal;
}

/// Reads the transform as a whole and replaces it by the field that it means.
void TransformRun::invert() {
  ChainLink link(arguments_.files.back(), MeshReadOptions{}, read_.axes, read_.world);
  link.choose(read_.step.value_or(0));
  const Grid& grid = plan_.output_grid;
  DisplacementField field{grid,
                          std::vector<float>(3 * static_cast<std::size_t>(grid.voxel_count()))};
  notes_ = composed({&link, 1}, grid, arguments_.warp.threads, field.displacement);
  parts_.file.transform = std::move(field);
}

void TransformRun::read_fields() {
  const std::vector<DisplacementField*> fields = fields_of(parts_.file.transform);
  for (std::size_t n = 0; n < fields.size(); ++n) {
    if (fields[n] == nullptr) continue;
    stop_if_interrupted();
    const Grid& grid = fields[n]->grid;
    fields[n]->displacement.resize(3 * static_cast<std::size_t>(grid.voxel_count()));
    parts_.fields[n].read({{0, 0, 0}, grid.dims}, fields[n]->displacement.data());
  }
}

void TransformRun::run_step(std::int64_t step, OutputWriter& writer, ProgressBar& bar) {
  const Grid& output = plan_.output_grid;
  for (std::size_t a = 0; a < plan_.arrays.size(); ++a) {
    const Volume volume = read_volume(plan_.path, plan_.arrays[a].name, step, plan_.read);
    stop_if_interrupted();
    Volume result = make_volume(output, volume.type, volume.components, volume.name);
    const VolumeView view(volume);
    void* const data = result.data.data();
    const auto share = static_cast<double>(plan_.arrays.size());
    resample(std::span(&view, 1), parts_.file.transform, options_, std::span(&data, 1),
             [&](double fraction) {
               const double done = (static_cast<double>(a) + fraction) / share;
               bar.update(done, done * static_cast<double>(output.voxel_count()));
               return !is_interrupted();
             });
    writer.write(a, {{0, 0, 0}, output.dims}, data);
  }
  bar.finish_step();
}

void TransformRun::run_parts(std::int64_t step,
                             OutputWriter& writer,
                             ProgressBar& bar,
                             JobResult& result) {
  std::vector<VolumeReader> readers;
  std::vector<std::vector<double>> ranges;
  const bool needs_range = options_.overshoot == Overshoot::clamp;
  for (const ArrayHeader& array : plan_.arrays) {
    readers.emplace_back(plan_.path, array.name, step, plan_.read);
    Fingerprint unused;
    if (needs_range) ranges.push_back(scan_source(readers.back(), 1e6, true, unused));
  }
  const auto count = static_cast<double>(plan_.arrays.size());
  const auto all = static_cast<double>(plan_.output_grid.voxel_count());
  double done = 0;  // output voxels
  ResampleBlocks left = blocks(limits());
  while (std::optional<ResamplePart> part = next_part(left)) {
    const double share = static_cast<double>(part->output.voxel_count()) / count;
    for (std::size_t a = 0; a < plan_.arrays.size(); ++a) {
      stop_if_interrupted();
      const ArrayHeader& array = plan_.arrays[a];
      if (needs_range) part->source.ranges = {ranges[a]};
      const Samples window = make_samples({array}, part->source.region);
      readers[a].read(part->source.region, window.front().get());
      const VolumeView view(plan_.source_grid, array.type, array.components, window.front().get(),
                            Memory::host);
      const Samples output = make_samples({array}, part->output);
      void* const data = output.front().get();
      resample_part(std::span(&view, 1), parts_.file.transform, options_, *part,
                    std::span(&data, 1), [&](double fraction) {
                      bar.update((done + fraction * share) / all, done + fraction * share);
                      return !is_interrupted();
                    });
      writer.write(a, part->output, data);
      done += share;
    }
    ++result.report.counts.blocks;
  }
  bar.finish_step();
}

void TransformRun::run(const JobContext& context, JobResult& result) {
  ProgressBar bar(context.shows_progress, context.label, source_.steps.size());
  if (inverts()) {
    invert();
    add_notes(lines_of(notes_, plan_.output_grid.voxel_count()), context, result);
  } else if (is_whole()) {
    read_fields();
  }
  OutputWriter writer(arguments_.output, plan_.output_grid, plan_.arrays,
                      {.compress = arguments_.compress,
                       .background = arguments_.warp.background,
                       .scalars = source_.header.active},
                      source_.is_series, plan_.arrays.size(),
                      is_whole() ? ChunkShape::rows : ChunkShape::bricks);
  for (const std::int64_t step : source_.steps) {
    if (source_.is_series) {
      writer.begin_step(source_.header.times[static_cast<std::size_t>(step)]);
    }
    if (is_whole()) {
      run_step(step, writer, bar);
    } else {
      run_parts(step, writer, bar, result);
    }
  }
  writer.finish();
  result.written = 1;
}

}  // namespace tetwarp::cli
