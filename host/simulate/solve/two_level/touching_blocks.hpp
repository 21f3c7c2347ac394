/// @file touching_blocks.hpp
/// Contacts in the metric of a two-level iteration: what their impulses move, and sweeps over them.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include <tetwarp/contact_problem.hpp>

#include "host/simulate/solve/problem/contact_constants.hpp"
#include "host/simulate/solve/problem/contact_rows.hpp"
#include "host/simulate/solve/two_level/elastic_groups.hpp"
#include "host/simulate/solve/two_level/solved_islands.hpp"
#include "kernels/body/row_product.hpp"

namespace tetwarp {

/// How far contacts are from their law, and the work of their impulses.
struct TouchingSums {
  double natural = 0;  ///< sum of natural_square() [J]
  double work = 0;     ///< r . (u - free)
};

/// Vectors y hold velocities of all rows of the system [rows][3], then velocities of the nodes of
/// elastic bodies that contacts touch, in the frames of these bodies at rest. With M^-1 = omega
/// D^-1 a contact sees u = J y_rows + w; of elastic bodies, whose M^-1 = R A_0^-1 R^T, u = J R
/// y_touched + w.
class TouchingBlocks {
 public:
  explicit TouchingBlocks(int threads) : threads_(threads) {}

  /// @param laws        friction, offsets, adhesion of the contacts, and their guess
  /// @param contacts    numbers of the contacts in `rows`
  /// @param relaxation  omega of rows that A couples to others; of single rigid bodies it is 1
  void set(const StepSystem& system,
           const SolvedIslands& islands,
           const ElasticSpace& elastic,
           const ContactRows& rows,
           const std::vector<std::int32_t>& contacts,
           const ContactProblem& laws,
           const DiagonalInverse<double>& inverse,
           double relaxation);

  /// Groups of ElasticGroups, and that of a contact of working(); since begin_sweeps().
  std::int32_t group_count() const { return groups_.count(); }
  std::int32_t group_of(std::int32_t contact) const {
    return groups_.of_contact(static_cast<std::size_t>(contact));
  }

  std::int64_t count() const { return static_cast<std::int64_t>(laws_.constants.size()); }

  /// Prepares sweeps over contacts of working(), and puts these in the order of sweeps.
  void begin_sweeps();
  /// Projected Gauss-Seidel over some contacts, a group of ElasticGroups after the other, small
  /// ones in several passes, and where they move elastic bodies alone two groups side by side:
  /// each from the velocities before both. For two blocks of a symmetric positive definite matrix
  /// such sweeps converge, too.
  /// @param list     contacts, in the order of working()
  /// @param y        in and out
  /// @param impulse  in and out, [3 list]
  void sweep(ContactSwitches switches,
             const std::vector<std::int32_t>& list,
             double* y,
             double* impulse);
  /// Multiplications of all sweeps since set().
  std::int64_t operations() const { return operations_; }
  /// y += M^-1 J^T (after - before), [3 list] each. @pre no elastic bodies
  void push(const std::vector<std::int32_t>& list,
            const double* before,
            const double* after,
            double* y) const;
  /// Places of y that impulses of contacts change, ascending; of contacts that have been swept.
  void list_moved(const std::vector<std::int32_t>& list, std::vector<std::int64_t>& places);
  /// Diagonal of the blocks J M^-1 J^T of the contacts, [3 contacts].
  const std::vector<double>& diagonal() const { return diagonal_; }
  /// u = J x + w of all contacts. @param x  [rows][3]. @param velocity  out [3 contacts]
  void velocities_of_rows(const double* x, double* velocity) const;
  /// @param free  u without impulses
  TouchingSums measure(ContactSwitches switches,
                       const double* impulse,
                       const double* velocity,
                       const double* free);
  /// Contacts that had an impulse or were off their law in the last measure(), ascending until
  /// begin_sweeps(). Most contacts of bodies that sink in without contact are neither: what holds
  /// the bodies up are few.
  const std::vector<std::int32_t>& working() const { return working_; }
  /// force = load + J^T r in the rows that contacts touch.
  void add_impulses(View<const double> load, const double* impulse, double* force) const;
  /// force = J^T (after - before) in the rows that contacts touch.
  void set_changes(const double* before, const double* after, double* force) const;

  /// ContactConstantsList::preload.
  const std::vector<double>& preload() const { return laws_.preload; }

 private:
  /// Numbers of y that a contact moves.
  struct Part {
    std::int64_t first = 0;  ///< in vectors of rows
    std::int64_t place = 0;  ///< in y
    std::int64_t value = 0;  ///< in jacobian_ and response_, both 3 x size
    std::int32_t size = 0;   ///< a multiple of 3
  };

  /// Of loops over contacts; few are faster on one.
  int threads() const { return count() < 256 ? 1 : threads_; }
  void set_parts(const StepSystem& system,
                 const ContactRows& rows,
                 const std::vector<std::int32_t>& contacts);
  void set_jacobian(const ContactRows& rows, std::size_t contact);
  void set_responses(const ContactRows& rows,
                     const SolvedIslands& islands,
                     const ElasticSpace& elastic,
                     const DiagonalInverse<double>& inverse,
                     double relaxation);
  void add_elastic_block(const ElasticSpace& elastic, std::size_t contact, std::int32_t part);
  void pack(std::size_t contact);
  void pack_elastic(std::size_t contact);
  void add_push_of_elastic(std::size_t contact, const double* change);
  void set_unit_velocities(std::size_t contact, float* z);
  struct GroupMatrix;
  static void set_entries(GroupMatrix& matrix, std::size_t k, std::size_t m, const float* block);
  void set_matrix(std::int32_t group);
  bool has_matrix(std::int32_t group) const;
  void update(ContactSwitches switches, std::size_t contact, double* y, double* impulse);
  /// A group and its contacts in a list.
  struct Range {
    std::int32_t group = 0;
    std::size_t begin = 0, end = 0;
    std::int64_t operations = 0;
  };
  int passes_over(const Range& range, const std::vector<std::int32_t>& list) const;
  void sweep_in_turn(ContactSwitches switches,
                     const Range& range,
                     const std::vector<std::int32_t>& list,
                     double* y,
                     double* impulse);
  void sweep_matrix(ContactSwitches switches,
                    const Range& range,
                    const std::vector<std::int32_t>& list,
                    const double* y,
                    double* impulse);
  void gather(std::size_t contact, const double* y);
  void scatter(std::size_t contact, double* y) const;
  void add_push(std::size_t contact, const double* r, double* force) const;
  void velocity_at(std::size_t contact, const double* x, double* velocity) const;

  ContactConstantsList laws_;
  std::vector<double> offset_, diagonal_;
  std::vector<std::int32_t> part_start_;  ///< [contacts + 1]
  std::vector<Part> parts_;
  std::vector<std::int32_t> part_row_, part_entry_;  ///< [parts] row; entry of ContactRows
  std::vector<double> jacobian_, response_;  ///< response_: of rows of other than elastic bodies
  std::vector<std::int32_t> touched_;        ///< rows, ascending
  std::vector<std::uint8_t> is_touched_;     ///< [unknown rows]
  std::vector<std::int64_t> packed_start_;   ///< [contacts] in packed_, -1: not there yet
  std::vector<std::int32_t> packed_size_;    ///< [contacts]
  std::vector<std::uint8_t> moves_rows_;  ///< [contacts] not elastic bodies alone, of packed ones
  std::vector<double> packed_;            ///< of contacts three rows of J, three of responses
  std::vector<double> gathered_;          ///< velocities of one contact
  std::vector<double> turned_;            ///< J of rows of elastic bodies, in their frames
  std::vector<float> rounded_;            ///< the same
  ElasticGroups groups_;
  std::vector<std::int64_t> elastic_start_;  ///< [contacts] in elastic_response_, -1: not there yet
  std::vector<float> elastic_response_;  ///< of contacts 3 x size of their group, rounded: z for
                                         ///< unit impulses
  std::vector<std::array<std::int64_t, 2>> moved_;
  /// J M^-1 J^T of the contacts of a group, rounded; three columns of each contact.
  struct GroupMatrix {
    std::int64_t stride = 0;
    std::vector<float> values;
    std::vector<double> velocity;  ///< u of its contacts, [stride]
    std::vector<double> before;    ///< impulses
    std::vector<float> moved;      ///< z for unit impulses of two contacts, [2][3][size of z]
    std::vector<float> columns;    ///< the same, [size of z][2][4]
  };
  std::vector<GroupMatrix> matrices_;       ///< [groups] of those that have one
  std::vector<std::int32_t> matrix_place_;  ///< [contacts] in the matrix of its group
  std::vector<Range> ranges_;               ///< groups with a matrix of the present sweep
  const ElasticSpace* elastic_ = nullptr;
  std::vector<std::int32_t> working_;
  std::int64_t operations_ = 0;
  int threads_;
  std::vector<std::int32_t> row_of_block_;
};

}  // namespace tetwarp
