/// @file coupled_islands.hpp
/// Islands of bodies that A couples: iterated, condensed, or first iterated and then condensed.
#pragma once
#include <cstdint>
#include <memory>
#include <vector>

#include <tetwarp/contact.hpp>

#include "host/contact/solve/engine_result.hpp"
#include "host/contact/solve/island_solver.hpp"
#include "host/contact/structure/structure.hpp"

namespace tetwarp {

struct Condensation;

/// Keeps what problems of a series with the same A and J share.
class CoupledIslands {
 public:
  /// @param device  solves the contacts of condensed islands, kept by the caller; null: the host
  CoupledIslands(const ContactOptions& options, int threads, ContactDevice* device)
      : options_(options), threads_(threads), device_(device) {}

  /// Forgets all islands; call when the structure has changed.
  void clear();
  /// Forgets all islands if numbers of A or J have changed.
  void begin(const ContactProblem& problem, const ContactStructure& structure);
  /// Solves all coupled islands.
  /// @param islands  has the problem
  void solve(const ContactProblem& problem,
             IslandSolver& islands,
             SolveBudget& budget,
             EngineResult& result);

 private:
  /// What is kept of an island.
  struct Island {
    std::shared_ptr<Condensation> condensation;  ///< null: not condensed so far
    std::int64_t outer_iterations = 0;           ///< of all problems of the series
  };
  /// How an island is solved: by at most `outer_iterations` outer iterations, and by condensing if
  /// these are 0 or do not converge.
  struct Route {
    std::int64_t outer_iterations;
    bool condenses;
  };
  /// The arguments of solve().
  struct Solve {
    const ContactProblem& problem;
    IslandSolver& islands;
    SolveBudget& budget;
    EngineResult& result;
  };

  Route planned_route(const ContactIsland& island) const;
  Route route_of(const Solve& all, std::int64_t island) const;
  void solve_island(const Solve& all, std::int64_t island);
  void condense(const Solve& all, std::int64_t island);

  ContactOptions options_;
  int threads_;
  ContactDevice* device_;
  std::vector<double> system_, jacobian_;  ///< stored numbers of A and J
  std::vector<Island> kept_;               ///< empty: nothing is kept
};

}  // namespace tetwarp
