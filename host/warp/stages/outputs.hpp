/// @file outputs.hpp
/// The memory that a step writes: the arrays of its target, or memory of the executor that is then
/// downloaded to them.
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "host/base/warp_backend.hpp"
#include "host/warp/box_sums.hpp"
#include "host/warp/target.hpp"
#include "kernels/base/view.hpp"

namespace tetwarp {

/// Cells [begin, end) along j and k.
struct CellWindow {
  int begin[2];
  int end[2];
};

/// Two slots of memory, one per target of the steps in flight, and a record of the targets'
/// content.
template <class Exec>
class WarpOutputs {
 public:
  /// The arguments must outlive the object.
  WarpOutputs(Exec& exec, const WarpPlan& plan, const OutputFrame& frame)
      : exec_(exec),
        frame_(frame),
        volume_count_(plan.sources.size()),
        always_owns_(extends(plan.options.outside) || takes_gaussian(plan.options) ||
                     !plan.mid_nodes.empty()),
        voxel_bytes_(voxel_bytes_of(plan.sources)) {
    for (Slot& slot : slots_) slot.arrays.resize(voxel_bytes_.size());
  }

  /// Chooses the slot of a new step. The content of the target counts as undefined until finish().
  /// @returns age of the result that the target still holds according to `holds_previous`: 1 or 2
  ///          steps; 0 unknown
  int take(const WarpTarget& target) {
    ++step_;
    const auto wrote = [&](const Slot& slot) { return slot.held && slot.held->is(target); };
    const Slot* const found = std::ranges::find_if(slots_, wrote);
    std::int64_t age = 0;
    if (found != std::end(slots_)) {
      now_ = static_cast<int>(found - slots_);
      if (target.holds_previous) age = step_ - found->held->step;
    } else if (target.holds_previous || slots_[now_].is_leaving) {
      now_ = 1 - now_;  // two alternating targets use one slot each
    }
    slots_[now_].held.reset();
    slots_[now_].is_leaving = true;
    return age <= 2 ? static_cast<int>(age) : 0;
  }
  int slot() const { return now_; }
  /// Ends the use of a slot by its step, after the download or when there is none.
  void release(int slot) { slots_[slot].is_leaving = false; }

  /// Where an executor writes volume s.
  void* volume(std::size_t s, const WarpTarget& target) { return writable(s, target); }
  /// Where it writes the other arrays; null: not written. Owners have memory also when only a
  /// field, voxels outside, labels or curved maps are computed from them.
  WarpTarget extra(const WarpTarget& target) {
    WarpTarget arrays;
    for (std::size_t e = 0; e < extra_outputs.size(); ++e) {
      extra_outputs[e].set(arrays, writable(volume_count_ + e, target));
    }
    if (target.owner == nullptr && (always_owns_ || needs_owners(target.fields))) {
      const std::size_t place = volume_count_ + owner_output;
      const std::int64_t bytes = voxel_bytes_[place] * frame_.voxel_count();
      Buffer<std::byte>& own = slots_[now_].arrays[place];
      own.reserve(bytes);
      arrays.owner = reinterpret_cast<std::int32_t*>(own.view(bytes).data);
    }
    return arrays;
  }

  /// The smallest window that contains all cells marked 1; all cells when `marks` has size 0.
  CellWindow window_of(View<const std::uint8_t> marks) {
    if (marks.size == 0) return {{0, 0}, {frame_.cells[1], frame_.cells[2]}};
    std::vector<std::uint8_t> marked(static_cast<std::size_t>(marks.size));
    exec_.get(marks, marked.data());
    CellWindow window{{frame_.cells[1], frame_.cells[2]}, {0, 0}};
    std::size_t line = 0;
    for (int ck = 0; ck < frame_.cells[2]; ++ck) {
      for (int cj = 0; cj < frame_.cells[1];
           ++cj, line += static_cast<std::size_t>(frame_.cells[0])) {
        const auto first = marked.begin() + static_cast<std::ptrdiff_t>(line);
        if (std::find(first, first + frame_.cells[0], 1) == first + frame_.cells[0]) continue;
        window.begin[0] = std::min(window.begin[0], cj);
        window.begin[1] = std::min(window.begin[1], ck);
        window.end[0] = std::max(window.end[0], cj + 1);
        window.end[1] = std::max(window.end[1], ck + 1);
      }
    }
    return window;
  }

  /// True when download() to this target does not block the calling thread.
  bool downloads_async(const WarpTarget& target) const {
    return std::ranges::all_of(arrays_of(target), [&](const void* to) {
      return to == nullptr || exec_.downloads_async(to);
    });
  }

  /// Queues the download of a window of a slot to the target. The forward field does not depend on
  /// the cells that were written and is downloaded as a whole.
  void download(int from, const WarpTarget& target, const CellWindow& window) {
    const std::vector<void*> arrays = arrays_of(target);
    for (std::size_t a = 0; a < arrays.size(); ++a) {
      if (arrays[a] == nullptr) continue;
      download(slots_[from].arrays[a], voxel_bytes_[a], static_cast<std::byte*>(arrays[a]),
               a == volume_count_ + forward_output ? window_of({}) : window);
    }
  }

  /// Records that the target holds the result of the current step.
  void finish(const WarpTarget& target) {
    slots_[now_].held = Held{arrays_of(target), target.memory, step_};
  }

 private:
  template <class T>
  using Buffer = typename Exec::template Buffer<T>;

  /// A target, identified by its pointers, and the number of the step whose result it holds.
  struct Held {
    std::vector<void*> arrays;
    Memory memory;
    std::int64_t step;

    bool is(const WarpTarget& target) const {
      return memory == target.memory && arrays == arrays_of(target);
    }
  };

  struct Slot {
    std::vector<Buffer<std::byte>> arrays;
    std::optional<Held> held;
    bool is_leaving = false;  ///< a step in flight writes or downloads it
  };

  void* writable(std::size_t place, const WarpTarget& target) {
    void* const destination = arrays_of(target)[place];
    if (destination == nullptr || target.memory == Memory::device) return destination;
    return exec_.writable(static_cast<std::byte*>(destination),
                          voxel_bytes_[place] * frame_.voxel_count(), slots_[now_].arrays[place]);
  }

  /// One copy of the window's rows.
  void download(const Buffer<std::byte>& from,
                std::int64_t per_voxel,
                std::byte* to,
                const CellWindow& window) {
    int begin[2], end[2];
    for (int axis = 0; axis < 2; ++axis) {
      begin[axis] = std::max(window.begin[axis] * cell_edge, frame_.begin[axis + 1]);
      end[axis] = std::min(window.end[axis] * cell_edge, frame_.end[axis + 1]);
      if (begin[axis] >= end[axis]) return;
    }
    const std::int64_t first = frame_.offset_of(frame_.begin[0], begin[0], begin[1]) * per_voxel;
    const auto size = [](std::int64_t count) { return static_cast<std::size_t>(count); };
    exec_.download("warp/download", from.const_view(frame_.voxel_count() * per_voxel).data + first,
                   to + first,
                   {size((frame_.end[0] - frame_.begin[0]) * per_voxel), size(end[0] - begin[0]),
                    size(frame_.end[1] - frame_.begin[1]), size(end[1] - begin[1])});
  }

  Exec& exec_;
  const OutputFrame& frame_;
  std::size_t volume_count_;
  bool always_owns_;
  std::vector<std::int64_t> voxel_bytes_;  ///< per array of a target
  Slot slots_[2];
  int now_ = 0;  ///< slot of the current step
  std::int64_t step_ = 0;
};

}  // namespace tetwarp
