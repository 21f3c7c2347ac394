/// @file contact_rows.cpp
/// Sets the blocks of nodes and frames along the axes of each contact.
#include "host/simulate/solve/problem/contact_rows.hpp"

#include <algorithm>
#include <numeric>

#include "host/base/index_of.hpp"
#include "host/base/parallel.hpp"

namespace tetwarp {
namespace {

constexpr std::size_t part_size = 64;  // contacts per task

/// Calls task(part, first contact, index after its last contact).
template <class Task>
void for_parts(int threads, std::size_t contacts, const Task& task) {
  parallel_tasks(threads, static_cast<std::int64_t>((contacts + part_size - 1) / part_size),
                 [&](std::int64_t p) {
                   const std::size_t part = index_of(p), first = part_size * part;
                   task(part, first, std::min(contacts, first + part_size));
                 });
}

}  // namespace

void set_contact_rows(const SceneSurfaces& scene,
                      const Model& model,
                      const ModelState& state,
                      std::span<const ContactSides> sides,
                      std::span<const std::uint8_t> takes,
                      int threads,
                      ContactRows& rows) {
  const std::size_t count = sides.size();
  const auto is_frame = [&](const BlockArm& arm) { return arm.block >= model.node_count; };
  const ArmFinder<ModelPoint> finder = {
      {scene.vertex_point.data(), std::ssize(scene.vertex_point)},
      {state.position.front().data() + 3 * std::int64_t{model.node_count}, 3 * model.rigid_count},
      model.node_count};
  rows.start.assign(count + 1, 0);
  rows.arm_start.assign(count + 1, 0);
  rows.parts.resize((count + part_size - 1) / part_size);
  for_parts(threads, count, [&](std::size_t part, std::size_t first, std::size_t end) {
    std::vector<BlockArm>& own = rows.parts[part];
    own.clear();
    ArmList arms;
    for (std::size_t c = first; c < end; ++c) {
      if (!takes.empty() && takes[c] == 0) continue;
      finder.find(sides[c], arms);
      rows.arm_start[c + 1] = rows.start[c + 1] = arms.size();
      for (int a = 0; a < arms.size(); ++a) {
        own.push_back(arms[a]);
        rows.start[c + 1] += is_frame(arms[a]);
      }
    }
  });
  for (auto* const sums : {&rows.start, &rows.arm_start}) {
    std::partial_sum(sums->begin(), sums->end(), sums->begin());
  }
  rows.block.resize(index_of(rows.start[count]));
  rows.value.resize(rows.block.size());
  rows.arms.resize(index_of(rows.arm_start[count]));
  rows.places.resize(rows.arms.size());
  rows.axes.resize(9 * count);
  const auto arm_count = static_cast<std::int64_t>(rows.arms.size());
  const ContactRowsOp op = {{rows.axes.data(), static_cast<std::int64_t>(rows.axes.size())},
                            {rows.arms.data(), arm_count},
                            {rows.places.data(), arm_count},
                            {reinterpret_cast<double*>(rows.value.data()),
                             9 * static_cast<std::int64_t>(rows.value.size())}};
  for_parts(threads, count, [&](std::size_t part, std::size_t first, std::size_t end) {
    const BlockArm* own = rows.parts[part].data();
    for (std::size_t c = first; c < end; ++c) {
      std::copy_n(sides[c].axes, 9, rows.axes.data() + 9 * c);
      std::int32_t next = rows.start[c];
      for (std::int32_t a = rows.arm_start[c]; a < rows.arm_start[c + 1]; ++a, ++own) {
        rows.arms[index_of(a)] = own->arm;
        rows.places[index_of(a)] = {static_cast<std::int32_t>(c), 9 * next, 3,
                                    is_frame(*own) ? 9 : 0};
        rows.block[index_of(next++)] = own->block;
        if (is_frame(*own)) rows.block[index_of(next++)] = own->block + 1;
        op(a);
      }
    }
  });
}

}  // namespace tetwarp
