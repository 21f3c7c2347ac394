/// @file touching_blocks.hpp
/// J of the contacts of a two-level iteration, and what their impulses change in its metric.
#pragma once
#include <cstdint>
#include <vector>

#include <tetwarp/contact_problem.hpp>

#include "host/simulate/solve/problem/contact_constants.hpp"
#include "host/simulate/solve/problem/contact_rows.hpp"
#include "host/simulate/solve/two_level/elastic_space.hpp"
#include "host/simulate/solve/two_level/taken_islands.hpp"
#include "kernels/body/row_product.hpp"

namespace tetwarp {

/// How far contacts are from their law, and the work of their impulses.
struct TouchingSums {
  double natural = 0;  ///< sum of natural_square() [J]
  double work = 0;     ///< r . (u - free)
};

/// Vectors x and forces hold three numbers of each row of the system. Vectors y hold the same, and
/// after these the velocities of the nodes of elastic bodies that contacts touch, in the frames of
/// their bodies at rest (ElasticBody::first).
///
/// The velocity of a contact is u = J y + w, a sum over its parts. Impulses r of a contact change y
/// by M^-1 J^T r: rows by omega D^-1 J^T r, the touched nodes of an elastic body by A_0^-1 (J R)^T
/// r, where R turns from the body at rest to the world.
class TouchingBlocks {
 public:
  /// The rows of a node or of a rigid body on which a contact acts.
  struct Part {
    std::int64_t first = 0;  ///< its first number in x and in forces
    std::int64_t place = 0;  ///< its first number in y
    std::int64_t value =
        0;  ///< its first number in the arrays of jacobian(), turned() ..., [3][size]
    std::int32_t size = 0;  ///< its numbers: 3, of a rigid body 6
    bool is_elastic() const { return place != first; }
  };

  explicit TouchingBlocks(int threads) : threads_(threads) {}

  /// @param laws        friction, offsets, adhesion of the contacts, and their guess
  /// @param contacts    numbers of the contacts in `rows`
  /// @param relaxation  omega of rows that A couples to others; of single rigid bodies it is 1
  void set(const StepSystem& system,
           const TakenIslands& islands,
           const ElasticSpace& elastic,
           const ContactRows& rows,
           const std::vector<std::int32_t>& contacts,
           const ContactProblem& laws,
           const DiagonalInverse<double>& inverse,
           double relaxation);

  std::int64_t count() const { return static_cast<std::int64_t>(laws_.constants.size()); }
  const ContactConstants<double>& law(std::size_t contact) const {
    return laws_.constants[contact];
  }
  /// w of a contact [m/s].
  const double* offset(std::size_t contact) const { return offset_.data() + 3 * contact; }
  /// Diagonal of the blocks J M^-1 J^T of the contacts, [3 contacts].
  const std::vector<double>& diagonal() const { return diagonal_; }
  /// ContactConstantsList::preload.
  const std::vector<double>& preload() const { return laws_.preload; }

  /// [contacts + 1] the parts of each contact.
  const std::vector<std::int32_t>& part_start() const { return part_start_; }
  /// [parts] the first row of each.
  const std::vector<std::int32_t>& part_row() const { return part_row_; }
  const Part& part(std::int32_t p) const { return parts_[static_cast<std::size_t>(p)]; }
  /// J of a part, [3][size].
  const double* jacobian(const Part& part) const { return jacobian_.data() + part.value; }
  /// M^-1 J^T of a part of rows, [3][size].
  const double* response(const Part& part) const { return response_.data() + part.value; }
  /// J R of a part of an elastic body, [3][3], and the same rounded to float32.
  const double* turned(const Part& part) const { return turned_.data() + part.value; }
  const float* rounded(const Part& part) const { return rounded_.data() + part.value; }

  /// y += M^-1 J^T (after - before), [3 list] each. @pre no elastic bodies
  void push(const std::vector<std::int32_t>& list,
            const double* before,
            const double* after,
            double* y) const;
  /// u = J x + w of all contacts. @param velocity  out [3 contacts]
  void velocities_of_rows(const double* x, double* velocity) const;
  /// force = load + J^T r in the rows that contacts touch.
  void add_impulses(View<const double> load, const double* impulse, double* force) const;
  /// force += J^T r.
  void add_pushes(const double* impulse, double* force) const;
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
  void set_parts(const StepSystem& system,
                 const TakenIslands& islands,
                 const ElasticSpace& elastic,
                 const ContactRows& rows,
                 const std::vector<std::int32_t>& contacts);
  void set_jacobian(const ContactRows& rows, std::size_t contact);
  void set_responses(const ContactRows& rows,
                     const TakenIslands& islands,
                     const ElasticSpace& elastic,
                     const DiagonalInverse<double>& inverse,
                     double relaxation);
  void add_elastic_block(const ElasticSpace& elastic, std::size_t contact, std::int32_t part);
  void add_push(std::size_t contact, const double* r, double* force) const;
  void velocity_at(std::size_t contact, const double* x, double* velocity) const;

  int threads_;
  ContactConstantsList laws_;
  std::vector<double> offset_, diagonal_;
  std::vector<std::int32_t> part_start_;
  std::vector<Part> parts_;
  std::vector<std::int32_t> part_row_, part_entry_;  ///< [parts] row; entry of ContactRows
  std::vector<double> jacobian_, response_, turned_;
  std::vector<float> rounded_;
  std::vector<std::int32_t> touched_;       ///< rows, ascending
  std::vector<std::uint8_t> is_touched_;    ///< [unknown rows]
  std::vector<std::int32_t> row_of_block_;  ///< [blocks of the system] row, -1: not solved
};

}  // namespace tetwarp
