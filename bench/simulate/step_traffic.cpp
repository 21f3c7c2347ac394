/// @file step_traffic.cpp
/// tetwarp_step_traffic: bytes and operations of the stages of a step of an elastic cube, counted.
///
/// Usage: tetwarp_step_traffic CELLS. Prints a table in Markdown for a cube of CELLS^3 cells of
/// five tetrahedra. Bytes are those that must cross the memory of a device: every array once per
/// stage, for gathers what is gathered without repetition. Operations of an element's force are
/// counted by running it with numbers that count; of other stages they follow from the number of
/// blocks and items. The last columns are bytes over a rate: estimates, which nobody measured.
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <vector>

#include "host/simulate/step/system_pattern.hpp"
#include "kernels/body/tet_force.hpp"
#include "tests/simulate/body_models.hpp"

namespace tetwarp {
namespace {

/// A number that counts what is done with it.
struct Counted {
  double v = 0;
  static std::int64_t operations;  ///< additions, multiplications, divisions, roots

  Counted() = default;
  explicit Counted(double value) : v(value) {}
  static Counted of(double value) {
    ++operations;
    return Counted(value);
  }
  friend Counted operator+(Counted a, Counted b) { return of(a.v + b.v); }
  friend Counted operator-(Counted a, Counted b) { return of(a.v - b.v); }
  friend Counted operator*(Counted a, Counted b) { return of(a.v * b.v); }
  friend Counted operator/(Counted a, Counted b) { return of(a.v / b.v); }
  friend Counted operator-(Counted a) { return Counted(-a.v); }
  friend bool operator<(Counted a, Counted b) { return a.v < b.v; }
  friend bool operator>(Counted a, Counted b) { return a.v > b.v; }
  friend bool operator<=(Counted a, Counted b) { return a.v <= b.v; }
};
std::int64_t Counted::operations = 0;

Counted select(bool condition, Counted yes, Counted no) {
  return condition ? yes : no;
}
Counted root_of(Counted x) {
  return Counted::of(std::sqrt(x.v));
}

/// Mean of elements that are sheared and turned at random, by a tenth of their size.
double operations_of_force() {
  constexpr int samples = 1000;
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0, 0.1);
  Counted::operations = 0;
  for (int sample = 0; sample < samples; ++sample) {
    Counted x[12], g[9], f[9], r[9], turned[12], force[12];
    for (int k = 0; k < 12; ++k) x[k] = Counted((k % 4 == 3 ? 1 : 0) + normal(random));
    for (int k = 0; k < 9; ++k) g[k] = Counted(k % 4 == 0 ? 1 : 0);
    deformation_gradient(x, g, f);
    rotation_by_quartic(f, r);
    corotated_forces(f, r, g, Counted(1), Counted(1), turned, force);
  }
  return static_cast<double>(Counted::operations) / samples;
}

struct Stage {
  const char* name;
  double bytes, operations;
  int launches;
};

std::vector<Stage> stages_of(int cells) {
  Model model = test::empty_model();
  test::add_block(model, {.cells = {cells, cells, cells}});
  const SystemPattern pattern = make_system_pattern(model);
  const auto size = [](const auto& list) { return static_cast<double>(list.size()); };
  const double tets = size(model.tets.nodes), nodes = model.node_count;
  const double places = size(pattern.column), upper = size(pattern.upper);
  const double items = size(pattern.tets.blocks.item), corners = size(pattern.tets.rows.item);
  // Indices are 4 bytes, numbers 8, three of them per node, nine per block.
  const double forces = nodes * (3 * 24 + 1) + tets * (16 + 72 + 16 + 2) +  // in
                        nodes * 24 + tets * (96 + 96);                      // out, positions
  const double assembly = tets * (128 + 1) + items * 4 + upper * (16 + 4 + 32 + 1) + places * 72;
  const double load = tets * 96 + corners * 4 + places * (4 + 16) + nodes * (5 * 24 + 20);
  const double inverse = nodes * (2 * 72 + 4);
  const double product = places * 76 + nodes * (2 * 24 + 8);
  const double step = nodes * (72 + 4 * 24 + 3 * 24), turn = nodes * 3 * 24;
  return {{"forces", forces, tets * operations_of_force(), 2},
          // Of an item: three columns, the shear, the scaled moduli.
          {"assembly of the system", assembly, items * (3 * 14 + 7 + 4), 1},
          {"right-hand side", load, corners * 3 + places * 12 + nodes * 9, 1},
          {"inverse diagonal blocks", inverse, nodes * 40, 1},
          {"start of conjugate gradients", product + nodes * 6 * 24, places * 18 + nodes * 45, 2},
          {"an iteration", product + step + turn, places * 18 + nodes * (6 + 30 + 6 + 6), 7},
          {"update", nodes * (24 * 5 + 24 * 2), nodes * 6, 3},
          {"check and sums", nodes * (2 * 24 + 3 * 24), nodes * 40, 4}};
}

void print(int cells) {
  const double tets = 5.0 * cells * cells * cells;
  std::printf("%.0f tetrahedra, %d nodes\n\n", tets, (cells + 1) * (cells + 1) * (cells + 1));
  std::printf(
      "| stage | bytes per tetrahedron | operations per tetrahedron | operations per byte "
      "| launches | estimate at 3.3 TB/s [us] | at 4.3 TB/s [us] |\n");
  std::printf("|---|---|---|---|---|---|---|\n");
  for (const Stage& stage : stages_of(cells)) {
    std::printf("| %s | %.0f | %.0f | %.2f | %d | %.1f | %.1f |\n", stage.name, stage.bytes / tets,
                stage.operations / tets, stage.operations / stage.bytes, stage.launches,
                stage.bytes / 3.3e6, stage.bytes / 4.3e6);
  }
}

}  // namespace
}  // namespace tetwarp

// NOLINTNEXTLINE(bugprone-exception-escape): an exception ends the program with its message
int main(int argc, char** argv) {
  const int cells = argc == 2 ? std::atoi(argv[1]) : 0;
  if (cells < 1 || cells > 100) {
    std::fprintf(stderr, "usage: tetwarp_step_traffic CELLS, from 1 to 100\n");
    return 2;
  }
  tetwarp::print(cells);
  return 0;
}
