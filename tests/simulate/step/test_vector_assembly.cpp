/// @file test_vector_assembly.cpp
/// The assembly of the system by vectors of every instruction set against single blocks.
#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <vector>

#include "tests/simulate/usable_stages.hpp"

namespace tetwarp::test {
namespace {

/// Blocks that gather random numbers of tetrahedra, edges and springs, some of them none, some at
/// rest, in random values; the numbers need not belong to a mesh.
class AssemblyScene {
 public:
  explicit AssemblyScene(std::int32_t blocks) : blocks_(blocks) {
    fill(tets_, tet_turned_);
    fill(edges_, edge_turned_);
    for (EdgePull& edge : edges_) edge_gamma_.push_back(1e-3 * edge.block[0] * edge.block[0]);
    for (SpringPull& pull : pulls_) fill(pull);
    for (SpringConstants& spring : springs_) {
      spring = {};
      spring.a.rigid = random_() % 2 == 0 ? 0 : -1;
      spring.b.rigid = -1;
      for (int k = 0; k < 4; ++k) spring.a.weight[k] = normal(), spring.b.weight[k] = normal();
    }
    for (auto* list : {&scalar_, &mass_, &inertia_}) {
      for (double& number : *list) number = 1 + normal() * normal();
    }
    for (std::int32_t k = 0; k < blocks; ++k) {
      const std::int32_t what = static_cast<std::int32_t>(random_() % 8);
      upper_.push_back({2 * k, what == 0 ? 2 * k : 2 * k + 1, what < 5 ? k % 16 : -1,
                        what == 7 ? static_cast<std::int32_t>(random_() % 4) : -1});
    }
    list_items(tet_list_, 26, tets_.size(), 16);
    list_items(edge_list_, 3, edges_.size(), 4);
    list_items(spring_list_, 2, springs_.size(), 64);
    values_.resize(18 * static_cast<std::size_t>(blocks) + 1);
    for (double& number : values_) number = normal();
  }

  struct Result {
    std::vector<double> values;
    std::vector<std::uint8_t> is_skipped;
  };
  /// @param run  (body): all blocks
  template <class Run>
  Result result_of(bool skips, const Run& run) const {
    Result result{values_, std::vector<std::uint8_t>(static_cast<std::size_t>(blocks_))};
    BlockAssembleOp body{};
    body.rows.upper = view(upper_);
    body.rows.tets.blocks = view(tet_list_);
    body.rows.edges.blocks = view(edge_list_);
    body.rows.springs.blocks = view(spring_list_);
    body.from.tets = view(tets_);
    body.from.tet_has_turned = view(tet_turned_);
    body.from.edges = view(edges_);
    body.from.edge_gamma = view(edge_gamma_);
    body.from.edge_has_turned = view(edge_turned_);
    body.from.springs = view(springs_);
    body.from.spring_pulls = view(pulls_);
    body.scalars = {{}, view(scalar_), view(scalar_), view(scalar_), view(scalar_)};
    body.rigid = {view(mass_), view(mass_), view(inertia_)};
    body.time_step = 7e-3;
    body.skips = skips;
    body.values = {result.values.data(), static_cast<std::int64_t>(result.values.size())};
    body.is_skipped = {result.is_skipped.data(), blocks_};
    run(body);
    return result;
  }

 private:
  struct Lists {
    std::vector<std::int32_t> start;
    std::vector<std::uint32_t> item;
  };

  template <class T>
  static View<const T> view(const std::vector<T>& values) {
    return {values.data(), static_cast<std::int64_t>(values.size())};
  }
  static ItemLists view(const Lists& lists) { return {view(lists.start), view(lists.item)}; }

  double normal() { return normal_(random_); }
  template <class T>
  void fill(T& numbers) {
    for (double* x = reinterpret_cast<double*>(&numbers);
         x < reinterpret_cast<double*>(&numbers + 1); ++x) {
      *x = normal();
    }
  }
  /// Half of the elements are at rest.
  template <class T>
  void fill(std::vector<T>& elements, std::vector<std::uint8_t>& turned) {
    for (T& element : elements) {
      fill(element);
      turned.push_back(random_() % 2 == 0);
    }
  }
  /// @param slots  items of an element
  void list_items(Lists& lists, unsigned most, std::size_t elements, unsigned slots) {
    lists.start = {0};
    for (std::int32_t k = 0; k < blocks_; ++k) {
      const std::size_t count = random_() % 3 == 0 ? 0 : random_() % most;
      for (std::size_t i = 0; i < count; ++i) {
        lists.item.push_back(static_cast<std::uint32_t>(random_() % (slots * elements)));
      }
      lists.start.push_back(static_cast<std::int32_t>(lists.item.size()));
    }
  }

  std::mt19937 random_{11};
  std::normal_distribution<double> normal_;
  std::int32_t blocks_;
  std::vector<TetTurned> tets_{60};
  std::vector<EdgePull> edges_{40};
  std::vector<SpringConstants> springs_{12};
  std::vector<SpringPull> pulls_{12};
  std::vector<std::uint8_t> tet_turned_, edge_turned_;
  std::vector<double> edge_gamma_, values_;
  std::vector<double> scalar_ = std::vector<double>(16), mass_ = std::vector<double>(2),
                      inertia_ = std::vector<double>(18);
  std::vector<UpperBlock> upper_;
  Lists tet_list_, edge_list_, spring_list_;
};

bool have_equal_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

void expect_bits_of_single_blocks(const char* name) {
  const VectorStages* const stages = usable_stages(name);
  if (stages == nullptr) GTEST_SKIP() << "this processor has no " << name;
  for (const std::int32_t blocks : {0, 1, 7, 500}) {
    const AssemblyScene scene(blocks);
    for (const bool skips : {false, true}) {
      const auto single = scene.result_of(skips, [&](const BlockAssembleOp& body) {
        for (std::int64_t k = 0; k < blocks; ++k) body(k);
      });
      const auto vectors = scene.result_of(skips, [&](const BlockAssembleOp& body) {
        stages->assemble(body, 0, blocks / 2);
        stages->assemble(body, blocks / 2, blocks);
      });
      EXPECT_TRUE(have_equal_bits(vectors.values, single.values)) << blocks << " blocks";
      EXPECT_EQ(vectors.is_skipped, single.is_skipped);
    }
  }
}

TEST(VectorAssembly, BaseHasTheBitsOfSingleBlocks) {
  expect_bits_of_single_blocks(vector_stages_base.name);
}

#if defined(__x86_64__)
TEST(VectorAssembly, Avx2HasTheBitsOfSingleBlocks) {
  expect_bits_of_single_blocks(vector_stages_avx2.name);
}
TEST(VectorAssembly, Avx512HasTheBitsOfSingleBlocks) {
  expect_bits_of_single_blocks(vector_stages_avx512.name);
}
#endif

}  // namespace
}  // namespace tetwarp::test
