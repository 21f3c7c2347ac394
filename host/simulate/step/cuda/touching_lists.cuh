/// @file touching_lists.cuh
/// TouchingLists: makes the rows and lists of contacts on compliant bodies in memory of a device.
#pragma once
#include <algorithm>
#include <cstdint>
#include <tuple>
#include <vector>

#include "host/simulate/solve/two_level/compliant_lists.hpp"
#include "kernels/contact/majorant.hpp"
#include "kernels/contact/touch_lists.hpp"
#include "kernels/exec/exec_cuda.cuh"
#include "kernels/exec/staged_arrays.cuh"

namespace tetwarp {

/// Where contacts are on surfaces, in memory of the device.
struct SurfacesOnDevice {
  View<const SurfacePoint> points;  ///< [vertices]
  View<const double> center;        ///< of frames, [frames][3]
  std::int32_t node_count;          ///< of the model
};

class TouchingLists {
 public:
  /// Copies the bodies of a solve to the device; their lists only if they have changed.
  /// @param bodies  those of the lists, with inverses
  void set_bodies(CudaExec& exec,
                  const CompliantLists& lists,
                  const std::vector<CompliantBody>& bodies) {
    exec.put(bodies, bodies_);
    if (lists.version == version_) return;
    std::tie(body_of_row_, system_row_, model_block_, diagonal_rows_, row_of_block_) =
        lists_.put(exec, lists.body_of_row, lists.system_row, lists.model_block,
                   lists.diagonal_rows, lists.row_of_block);
    version_ = lists.version;
  }

  /// Makes the lists of contacts on these bodies.
  void make(CudaExec& exec, const SurfacesOnDevice& surfaces, View<const ContactSides> contacts) {
    const TouchListInput in = {contacts,
                               {surfaces.points, surfaces.center, surfaces.node_count},
                               row_of_block_,
                               body_of_row_};
    const std::int64_t rows = body_of_row_.size;
    const View<CompliantBody> bodies = bodies_.view();
    exec.make_zeros(sums_, TouchSums::size(contacts.size, rows));
    squares_.resize(bodies.size + 1);
    totals_.resize(1);
    const TouchSums counted = {sums_.view(), contacts.size};
    exec.for_each(label, contacts.size, TouchCountOp{in, counted});
    exec.exclusive_scan(label, sums_.view());
    exec.for_each(label, bodies.size + 1, BodyNodesOp{counted, bodies, squares_.view()});
    exec.exclusive_scan(label, squares_.view());
    exec.once(label, TouchTotalsOp{counted, rows, const_view(squares_), totals_.view().data});
    const TouchTotals totals = exec.load(totals_.view().data);
    node_pairs_ = totals.node_pairs;
    resize(contacts.size, totals);
    exec.for_each(label, rows + 1,
                  NodeListOp{counted, body_of_row_, const_view(squares_), bodies,
                             row_of_node_.view(), pair_start_.view()});
    exec.for_each(
        label, contacts.size + 1,
        TouchListOp{in, counted, bodies, block_start_.view(), part_start_.view(), row_.view(),
                    node_.view(), contact_.view(), part_.view(), part_block_.view(),
                    part_body_.view(), jacobian_.view(), touches_.view()});
    int bits = 1;
    while (rows >> bits > 0) ++bits;
    exec.sort_pairs(label, touches_.view(), {}, bits);
    exec.for_each(label, std::max(rows + 1, totals.blocks),
                  RowTouchesOp{const_view(touches_), touch_start_.view(), touch_.view()});
  }

  /// Sets the views of the lists.
  void set(TouchingNodes& touching) const {
    touching.bodies.bodies = bodies_.view();
    touching.bodies.body_of_row = body_of_row_;
    touching.bodies.row_of_node = row_of_node_.view();
    TouchingRows& rows = touching.rows;
    rows.block_start = block_start_.view();
    rows.row = row_.view();
    rows.node = node_.view();
    rows.contact = contact_.view();
    rows.part = part_.view();
    rows.jacobian = jacobian_.view();
    rows.touch_start = touch_start_.view();
    rows.touch = touch_.view();
    touching.part_start = part_start_.view();
    touching.part_block = part_block_.view();
    touching.part_body = part_body_.view();
  }
  View<const std::int32_t> system_row() const { return system_row_; }         ///< [rows]
  View<const std::int32_t> model_block() const { return model_block_; }       ///< [rows]
  View<const std::int32_t> diagonal_rows() const { return diagonal_rows_; }   ///< bodies by D^-1
  View<const std::int64_t> pair_start() const { return pair_start_.view(); }  ///< [nodes + 1]
  std::int64_t node_pairs() const { return node_pairs_; }                     ///< of the same body

 private:
  static constexpr const char* label = "body/contact";

  void resize(std::int64_t contacts, const TouchTotals& totals) {
    for (DeviceVector<std::int32_t>* const of : {&block_start_, &part_start_}) {
      of->resize(contacts + 1);
    }
    for (DeviceVector<std::int32_t>* const of : {&row_, &node_, &contact_, &part_, &touch_}) {
      of->resize(totals.blocks);
    }
    part_block_.resize(totals.parts + 1);
    part_body_.resize(totals.parts);
    jacobian_.resize(9 * totals.blocks);
    touches_.resize(totals.blocks);
    touch_start_.resize(body_of_row_.size + 1);
    row_of_node_.resize(totals.nodes);
    pair_start_.resize(totals.nodes + 1);
  }

  std::int64_t version_ = 0;  ///< of the lists
  StagedArrays lists_;
  View<const std::int32_t> body_of_row_, system_row_, model_block_, diagonal_rows_, row_of_block_;
  DeviceVector<CompliantBody> bodies_;
  std::int64_t node_pairs_ = 0;
  DeviceVector<std::int64_t> sums_, squares_, pair_start_;
  DeviceVector<TouchTotals> totals_;
  DeviceVector<std::int32_t> block_start_, part_start_, row_, node_, contact_, part_, part_block_,
      part_body_, touch_start_, touch_, row_of_node_;
  DeviceVector<double> jacobian_;
  DeviceVector<KeyValue> touches_;
};

}  // namespace tetwarp
