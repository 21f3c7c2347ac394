/// @file item_boxes.hpp
/// ItemBoxes: the boxes of the items that can have a partner, and their sizes.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "host/collide/body_partners.hpp"
#include "host/collide/surface_buffers.hpp"
#include "kernels/collide/item_box.hpp"

namespace tetwarp {

/// @tparam Exec  CpuExec or CudaExec
template <class Exec>
class ItemBoxes {
 public:
  /// @param surfaces  kept by the caller
  ItemBoxes(Exec& exec, const SurfaceBuffers<Exec>& surfaces)
      : exec_(exec), surfaces_(surfaces), count_(surfaces.scene().items.size) {
    exec_.resize(boxes_, count_);
    exec_.resize(sizes_, count_);
    exec_.resize(size_counts_, (count_ + size_run - 1) / size_run * item_sizes);
    exec_.resize(size_sums_, item_sizes);
  }

  /// Finds the boxes. An item whose box touches no partner of its body is skipped.
  /// @param vertex_boxes  of the search
  void find(const BodyPartners& partners, View<const Box> vertex_boxes) {
    const Box& space = partners.boxes.back();
    double extent = 0;
    for (int k = 0; k < 3; ++k) extent = std::max(extent, space.high[k] - space.low[k]);
    largest_ = std::ilogb(extent);
    exec_.put(partners.boxes, body_boxes_);
    exec_.put(partners.start, partner_start_);
    exec_.put(partners.bodies, partner_bodies_);
    exec_.for_each(
        "collide/item_box", count_,
        ItemBoxOp{surfaces_.scene(), vertex_boxes, view(body_boxes_), view(partner_start_),
                  view(partner_bodies_), largest_, exec_.view(boxes_), exec_.view(sizes_)});
  }

  /// @returns number of boxes of each size, skipped ones left out
  std::array<std::int64_t, item_sizes> count_sizes() {
    exec_.for_each("collide/item_box", (count_ + size_run - 1) / size_run,
                   SizeCountOp{sizes(), exec_.view(size_counts_)});
    exec_.for_each("collide/item_box", item_sizes,
                   SizeSumOp{view(size_counts_), exec_.view(size_sums_)});
    const View<const std::int32_t> sums = exec_.on_host(view(size_sums_), host_size_sums_);
    std::array<std::int64_t, item_sizes> counts{};
    std::copy_n(sums.data, item_sizes, counts.begin());
    return counts;
  }

  std::int64_t count() const { return count_; }
  View<const Box> boxes() const { return view(boxes_); }
  /// As ItemBoxOp::sizes.
  View<const std::int8_t> sizes() const { return view(sizes_); }
  /// Boxes of size 0 are 2^largest() to 2^(largest() + 1) [m].
  int largest() const { return largest_; }

 private:
  template <class T>
  using Vector = typename Exec::template Vector<T>;
  template <class T>
  View<const T> view(const Vector<T>& values) const {
    return exec_.view(values);
  }

  Exec& exec_;
  const SurfaceBuffers<Exec>& surfaces_;
  std::int64_t count_;
  int largest_ = 0;
  Vector<Box> body_boxes_;
  Vector<std::int32_t> partner_start_, partner_bodies_;
  Vector<Box> boxes_;
  Vector<std::int8_t> sizes_;
  Vector<std::int32_t> size_counts_, size_sums_;
  std::vector<std::int32_t> host_size_sums_;
};

}  // namespace tetwarp
