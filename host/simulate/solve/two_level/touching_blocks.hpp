/// @file touching_blocks.hpp
/// J of the contacts of a two-level iteration, and what their impulses change in its metric.
#pragma once
#include <cstdint>
#include <vector>

#include <tetwarp/contact_problem.hpp>

#include "host/base/vector_view.hpp"
#include "host/simulate/solve/problem/block_jacobian.hpp"
#include "host/simulate/solve/problem/contact_constants.hpp"
#include "host/simulate/solve/two_level/elastic_space.hpp"
#include "kernels/body/row_product.hpp"
#include "kernels/contact/touching_rows.hpp"

namespace tetwarp {

/// How far contacts are from their law, and the work of their impulses.
struct TouchingSums {
  double natural = 0;  ///< sum of natural_square() [J]
  double work = 0;     ///< r . (u - free)
};

/// Vectors x and forces hold three numbers of each row of the lists. Vectors y hold the same, and
/// after these the velocities of the nodes of elastic bodies that contacts touch, in the frames of
/// their bodies at rest (ElasticBody::first).
///
/// The velocity of a contact is u = J y + w, a sum over its blocks. Impulses r of a contact change
/// y by M^-1 J^T r: rows by omega D^-1 J^T r, the touched nodes of an elastic body by A_0^-1 (J
/// R)^T r, where R turns from the body at rest to the world.
class TouchingBlocks {
 public:
  explicit TouchingBlocks(int threads) : threads_(threads) {}

  /// @param lists     kept by the caller
  /// @param contacts  numbers of the contacts in `rows`
  /// @param start     their laws and offsets
  void set(const CompliantLists& lists,
           const ElasticSpace& elastic,
           const ContactRows& rows,
           const std::vector<std::int32_t>& contacts,
           const TwoLevelStart& start,
           const DiagonalInverse<double>& inverse);

  std::int64_t count() const { return static_cast<std::int64_t>(laws_.constants.size()); }
  const ContactConstants<double>& law(std::size_t contact) const {
    return laws_.constants[contact];
  }
  View<const ContactConstants<double>> constants() const {
    return {laws_.constants.data(), count()};
  }
  /// w of a contact [m/s].
  const double* offset(std::size_t contact) const { return offset_.data() + 3 * contact; }
  /// Diagonal of the blocks J M^-1 J^T of the contacts, [3 contacts].
  const std::vector<double>& diagonal() const { return diagonal_; }

  /// The blocks of each contact, one for each of the rows on which it acts.
  TouchingRows rows() const { return jacobian_.rows(offset_); }
  /// Calls visit(b) for the blocks of a contact.
  template <class Visit>
  void for_blocks(std::size_t contact, const Visit& visit) const {
    jacobian_.for_blocks(contact, visit);
  }
  /// [contacts + 1]
  const std::vector<std::int32_t>& block_start() const { return jacobian_.block_start(); }
  const std::vector<std::int32_t>& row() const { return jacobian_.row(); }  ///< [blocks]
  /// Its first number in y.
  std::int64_t place(std::size_t block) const { return place_[block]; }
  bool is_elastic(std::size_t block) const { return place_[block] != first(block); }
  /// Its first number in x and in forces.
  std::int64_t first(std::size_t block) const { return 3 * std::int64_t{row()[block]}; }
  /// J, row by row: velocities along the axes of the contact per velocity of the row.
  const double* jacobian(std::size_t block) const { return jacobian_.block(block); }
  /// M^-1 J^T of a row of no elastic body, the three numbers for each axis of the contact.
  const double* response(std::size_t block) const { return response_.data() + 9 * block; }
  /// J R of a row of an elastic body, and the same rounded to float32.
  const double* turned(std::size_t block) const { return turned_.data() + 9 * block; }
  const float* rounded(std::size_t block) const { return rounded_.data() + 9 * block; }

  /// y += M^-1 J^T (after - before), [3 list] each. @pre no elastic bodies
  void push(const std::vector<std::int32_t>& list,
            const double* before,
            const double* after,
            double* y) const;
  /// u = J x + w of all contacts.
  /// @param x         [rows][3]
  /// @param velocity  out: u, [3 contacts]
  void velocities_of_rows(const std::vector<double>& x, std::vector<double>& velocity) const {
    jacobian_.velocities(view_of(x), offset_, threads(), view_of(velocity));
  }
  /// force = load + J^T r in the rows that contacts touch. @param load  of the system
  void add_impulses(View<const double> load, const double* impulse, double* force) const;
  /// force += J^T r.
  void add_pushes(const double* impulse, double* force) const {
    jacobian_.add_pushes(impulse, force);
  }
  /// force = J^T (after - before) in the rows that contacts touch.
  void set_changes(const double* before, const double* after, double* force) const;
  /// @param free     u without impulses
  /// @param working  out: contacts that have an impulse or are off their law, ascending. Most
  ///                 contacts of bodies that sink in without contact are neither.
  TouchingSums measure(ContactSwitches switches,
                       const double* impulse,
                       const double* velocity,
                       const double* free,
                       std::vector<std::int32_t>& working) const;

 private:
  /// Threads of loops over contacts: with few contacts starting threads takes longer than the loop.
  int threads() const { return count() < 256 ? 1 : threads_; }
  void list_touched(const ElasticSpace& elastic);
  void set_response(const DiagonalInverse<double>& inverse, std::size_t contact, std::size_t block);
  void add_elastic_block(const ElasticSpace& elastic, std::size_t contact, std::size_t block);
  void set_own_block(const ElasticSpace& elastic,
                     const DiagonalInverse<double>& inverse,
                     std::size_t contact);

  int threads_;
  const CompliantLists* lists_ = nullptr;
  ContactConstantsList laws_;
  std::vector<double> offset_, diagonal_;
  BlockJacobian jacobian_;
  std::vector<std::int64_t> place_;
  std::vector<double> response_, turned_;
  std::vector<float> rounded_;
  std::vector<std::int32_t> touched_;     ///< rows, ascending
  std::vector<std::uint8_t> is_touched_;  ///< [rows]
};

}  // namespace tetwarp
