/// @file test_io_fclib_bad.cpp
/// Damaged and invalid contact files: each gives one line that names file and dataset.
#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "tests/support/contact/contact_files.hpp"
#include "tests/support/io_files.hpp"

namespace tetwarp::test {
namespace {
using Edit = std::function<void(Hdf5Editor&)>;
using Int = std::int32_t;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// A change to a good file, and words that the error must hold.
struct Damage {
  Edit edit;
  std::string dataset;
  std::string message;
};

class BadFclib : public testing::Test {
 protected:
  /// Reads `problem` after each damage alone.
  void expect_errors(const ContactProblem& problem, const std::vector<Damage>& damages) {
    for (const Damage& damage : damages) {
      write_contact_problem(file, problem);
      {
        Hdf5Editor editor(file);
        damage.edit(editor);
      }

      const std::string error = io_error([&] { read_contact_problem(file); });

      EXPECT_TRUE(error.starts_with(file + ": " + damage.dataset)) << error;
      EXPECT_NE(error.find(damage.message), std::string::npos)
          << error << " lacks " << damage.message;
      EXPECT_EQ(error.find('\n'), std::string::npos) << error;
    }
  }

  ScratchFolder folder;
  std::string file = folder / "problem.hdf5";
};

TEST_F(BadFclib, IsNamedWhenItHoldsNoProblem) {
  const Volume volume = counting_volume(PixelType::int16);
  write_volumes(file, {&volume});
  const std::string error = io_error([&] { read_contact_problem(file); });
  EXPECT_NE(error.find("expected /fclib_local or /fclib_global"), std::string::npos) << error;

  Hdf5Editor(file, Hdf5Editor::Mode::create).group("fclib_global_rolling");
  const std::string rolling = io_error([&] { read_contact_problem(file); });
  EXPECT_NE(rolling.find("rolling friction is not supported"), std::string::npos) << rolling;
}

TEST_F(BadFclib, IsNamedWhenItHoldsTwoProblems) {
  expect_errors(local_problem(),
                {{[](Hdf5Editor& e) { e.group("fclib_global"); }, "", "remove one of them"}});
}

TEST_F(BadFclib, IsNamedWhenPartsAreMissing) {
  std::vector<Damage> damages;
  for (const std::string part : {"spacedim", "vectors", "vectors/mu", "vectors/q", "W", "W/m",
                                 "W/n", "W/nz", "W/p", "W/i", "W/x"}) {
    damages.push_back({[part](Hdf5Editor& e) { e.remove("fclib_local/" + part); },
                       "/fclib_local/" + part, "missing"});
  }
  expect_errors(local_problem(), damages);
  damages.clear();
  for (const std::string part : {"vectors/f", "vectors/w", "M", "H"}) {
    damages.push_back({[part](Hdf5Editor& e) { e.remove("fclib_global/" + part); },
                       "/fclib_global/" + part, "missing"});
  }
  expect_errors(global_problem(), damages);
}

TEST_F(BadFclib, IsNamedWhenItHoldsWhatIsNotSupported) {
  expect_errors(
      local_problem(),
      {{[](Hdf5Editor& e) { e.dataset<Int>("fclib_local/spacedim", {1}, {2}); },
        "/fclib_local/spacedim", "is 2"},
       {[](Hdf5Editor& e) { e.group("fclib_local/R").dataset<Int>("fclib_local/R/n", {1}, {4}); },
        "/fclib_local/R", "equality constraints are not supported"}});
  expect_errors(
      global_problem(),
      {{[](Hdf5Editor& e) { e.group("fclib_global/G").dataset<Int>("fclib_global/G/n", {1}, {1}); },
        "/fclib_global/G", "missing"}});
}

TEST_F(BadFclib, IsNamedWhenVectorsHaveTheWrongLength) {
  expect_errors(local_problem(),
                {{[](Hdf5Editor& e) {
                    e.dataset<double>("fclib_local/vectors/q", {2}, {1, 2});
                  },
                  "/fclib_local/vectors/q", "holds 2 numbers, expected 6"},
                 {[](Hdf5Editor& e) { e.dataset<double>("fclib_local/vectors/mu", {1}, {0.5}); },
                  "/fclib_local/vectors/mu", "holds 1 numbers, expected 2: one per contact"},
                 {[](Hdf5Editor& e) { e.dataset<double>("fclib_local/vectors/mu", {0}, {}); },
                  "/fclib_local", ""},
                 {[](Hdf5Editor& e) {
                    e.dataset<Int>("fclib_local/W/m", {2}, {6, 6});
                  },
                  "/fclib_local/W/m", "expected one"}});
  expect_errors(adhesive_problem(),
                {{[](Hdf5Editor& e) {
                    e.dataset<double>("fclib_global/vectors/f", {5}, {1, 2, 3, 4, 5});
                  },
                  "/fclib_global/M", "is 6 x 6, expected 5 x 5"},
                 {[](Hdf5Editor& e) {
                    e.dataset<double>("fclib_global/vectors/mu", {3}, {0.5, 0.5, 0.5});
                  },
                  "/fclib_global/vectors/mu", "holds 3 numbers, expected 2: one per contact"},
                 {[](Hdf5Editor& e) { e.remove("adhesion/intensity"); }, "/adhesion/intensity",
                  "is missing, but there is a stiffness"},
                 {[](Hdf5Editor& e) {
                    e.dataset<double>("adhesion/area", {3}, {1, 1, 1});
                  },
                  "/adhesion/area", "expected 2: one per contact"},
                 {[](Hdf5Editor& e) {
                    e.dataset<double>("adhesion/gap", {2}, {0, 0});
                  },
                  "/adhesion/gap", "expected 6: normal and two tangents per contact"}});
}

TEST_F(BadFclib, IsNamedWhenMatricesContradictThemselves) {
  expect_errors(
      local_problem(),
      {{[](Hdf5Editor& e) { e.dataset<Int>("fclib_local/W/nz", {1}, {-3}); }, "/fclib_local/W/nz",
        "is -3"},
       {[](Hdf5Editor& e) { e.dataset<Int>("fclib_local/W/m", {1}, {1 << 30}); }, "/fclib_local/W",
        "is 1073741824 x 6, expected 6 x 6"},
       {[](Hdf5Editor& e) {
          e.dataset<Int>("fclib_local/W/p", {3}, {0, 1, 2});
        },
        "/fclib_local/W/p", "holds 3 offsets, expected 7"},
       {[](Hdf5Editor& e) {
          e.dataset<Int>("fclib_local/W/p", {7}, {1, 3, 6, 8, 11, 13, 16});
        },
        "/fclib_local/W/p", "begins with 1"},
       {[](Hdf5Editor& e) {
          e.dataset<Int>("fclib_local/W/p", {7}, {0, 3, 1, 8, 11, 13, 16});
        },
        "/fclib_local/W/p", "decreases"},
       {[](Hdf5Editor& e) {
          e.dataset<Int>("fclib_local/W/p", {7}, {0, 3, 6, 8, 11, 13, 17});
        },
        "/fclib_local/W/p", "i holds 16 entries"},
       {[](Hdf5Editor& e) {
          e.dataset<double>("fclib_local/W/x", {2}, {1, 2});
        },
        "/fclib_local/W/x", "holds 2 entries, expected 16"},
       {[](Hdf5Editor& e) { e.dataset<Int>("fclib_local/W/nz", {1}, {40}); }, "/fclib_local/W/p",
        "holds 7 entries, expected 40"},
       {[](Hdf5Editor& e) { e.dataset<Int>("fclib_local/W/i", {16}, std::vector<Int>(16, 6)); },
        "/fclib_local/W/i", "entry 0 is 6, expected 0 to 5"},
       {[](Hdf5Editor& e) { e.dataset<Int>("fclib_local/W/i", {16}, std::vector<Int>(16, -1)); },
        "/fclib_local/W/i", "entry 0 is -1"}});
}

TEST_F(BadFclib, IsNamedWhenHIsStoredTheOtherWayRound) {
  ContactProblem problem = global_problem();
  problem.jacobian = sparse({{1, 0, 0, 0, 0, 0}, {0, 1, 0, 0, 0, 0}, {0, 0, 1, 0, 0, 0}});
  problem.velocity_offset.resize(3);
  problem.friction.resize(1);
  expect_errors(problem, {{[](Hdf5Editor& e) {
                             e.dataset<Int>("fclib_global/H/m", {1}, {3});
                             e.dataset<Int>("fclib_global/H/n", {1}, {6});
                           },
                           "/fclib_global/H", "is 3 x 6, expected 6 x 3"}});
}

TEST_F(BadFclib, IsNamedWhenTypesAreNoNumbers) {
  expect_errors(
      local_problem(),
      {{[](Hdf5Editor& e) { e.dataset<double>("fclib_local/W/m", {1}, {6}); }, "/fclib_local/W/m",
        "expected integers"},
       {[](Hdf5Editor& e) { e.dataset<double>("fclib_local/vectors/q", {6}, {}, H5T_C_S1); },
        "/fclib_local/vectors/q", "holds no numbers"},
       {[](Hdf5Editor& e) { e.remove("fclib_local/W").dataset<Int>("fclib_local/W", {1}, {1}); },
        "/fclib_local/W", "missing group"}});
}

TEST_F(BadFclib, IsNamedWhenNumbersAreNotFinite) {
  expect_errors(local_problem(),
                {{[](Hdf5Editor& e) {
                    e.dataset<double>("fclib_local/vectors/q", {6}, {0, 0, nan, 0, 0, 0});
                  },
                  "/fclib_local/vectors/q", "entry 2 is nan"},
                 {[](Hdf5Editor& e) {
                    e.dataset<double>("fclib_local/W/x", {16}, std::vector<double>(16, nan));
                  },
                  "/fclib_local/W/x", "entry 0 is nan"}});
}

TEST_F(BadFclib, IsNamedWithTheDatasetThatTheProblemsCheckObjectsTo) {
  expect_errors(
      adhesive_problem(),
      {{[](Hdf5Editor& e) {
          e.dataset<double>("fclib_global/vectors/mu", {2}, {0.5, -1});
        },
        "/fclib_global/vectors/mu", "friction[1]"},
       {[](Hdf5Editor& e) {
          e.dataset<double>("adhesion/intensity", {2}, {0.5, 1.5});
        },
        "/adhesion/intensity", "adhesion.intensity[1]"},
       {[](Hdf5Editor& e) {
          e.dataset<double>("adhesion/saturation", {2}, {-1, 1});
        },
        "/adhesion/saturation", "adhesion.saturation_pressure[0]"},
       {[](Hdf5Editor& e) { e.attribute<double>("adhesion", "time_step", {-1}); },
        "/adhesion/time_step", "adhesion.time_step"},
       {[](Hdf5Editor& e) {
          e.dataset<Int>("blocks/block_ptr", {3}, {0, 4, 3});
        },
        "/blocks/block_ptr", "block_start"},
       {[](Hdf5Editor& e) {
          e.dataset<double>("fclib_global/M/x", {6}, std::vector<double>{2, 2, -2, 4, 4, 4});
        },
        "/fclib_global/M", "system"}});
}

TEST_F(BadFclib, IsNamedWhenTheAdhesionHasNoTimeStep) {
  expect_errors(adhesive_problem(),
                {{[](Hdf5Editor& e) { e.remove_attribute("adhesion", "time_step"); }, "/adhesion",
                  "missing attribute time_step"}});
}

TEST_F(BadFclib, IsNamedWhenTheStartHasTheWrongLength) {
  write_contact_problem(file, adhesive_problem());
  Hdf5Editor(file).dataset<double>("guesses/1/r", {3}, {1, 2, 3});

  const std::string error = io_error([&] { read_contact_problem(file, ContactStart::stored); });

  EXPECT_TRUE(error.starts_with(file + ": /guesses/1/r: holds 3 numbers, expected 6")) << error;
}

/// A small file may claim any size; reading it must not allocate that much.
TEST_F(BadFclib, IsNamedWhenSizesAreAbsurd) {
  constexpr hsize_t huge = hsize_t{1} << 40;
  expect_errors(local_problem(),
                {{[](Hdf5Editor& e) { e.dataset<double>("fclib_local/vectors/mu", {huge}, {}); },
                  "/fclib_local/vectors/mu", "more than 2^31 - 1 numbers"},
                 {[](Hdf5Editor& e) {
                    e.dataset<double>("fclib_local/vectors/q", {huge, huge, huge}, {});
                  },
                  "/fclib_local/vectors/q", "more than 2^31 - 1 numbers"},
                 {[](Hdf5Editor& e) { e.dataset<Int>("fclib_local/W/i", {huge}, {}); },
                  "/fclib_local/W/i", "more than 2^31 - 1 numbers"}});
}
}  // namespace
}  // namespace tetwarp::test
