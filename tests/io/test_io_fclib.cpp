/// @file test_io_fclib.cpp
/// Contact problems to and from FCLIB files, ours and those of other programs.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "tests/support/contact/contact_files.hpp"
#include "tests/support/io_files.hpp"

namespace tetwarp::test {
namespace {
class Fclib : public testing::Test {
 protected:
  /// Writes W of local_problem() in another storage.
  template <class Index>
  void store_delassus(Index nz,
                      const std::vector<Index>& p,
                      const std::vector<Index>& i,
                      const std::vector<double>& x,
                      hid_t index_type = H5I_INVALID_HID) {
    Hdf5Editor edit(file);
    edit.dataset("fclib_local/W/nz", {1}, std::vector<Index>{nz});
    edit.dataset("fclib_local/W/p", {p.size()}, p, index_type);
    edit.dataset("fclib_local/W/i", {i.size()}, i, index_type);
    edit.dataset("fclib_local/W/x", {x.size()}, x);
  }

  ScratchFolder folder;
  std::string file = folder / "problem.hdf5";
};

TEST_F(Fclib, KeepsALocalProblem) {
  write_contact_problem(file, local_problem());

  EXPECT_EQ(contents(read_contact_problem(file)), contents(local_problem()));
}

TEST_F(Fclib, KeepsAGlobalProblemWithAdhesionBlocksAndAStart) {
  write_contact_problem(file, adhesive_problem());

  EXPECT_EQ(contents(read_contact_problem(file, ContactStart::stored)),
            contents(adhesive_problem()));
}

/// Files of finite-element programs hold one triangle of M.
TEST_F(Fclib, CompletesASymmetricMatrixOfOneTriangle) {
  ContactProblem whole = global_problem();
  std::vector<std::vector<double>> rows = dense(whole.system);
  rows[0][2] = rows[2][0] = 0.25;
  rows[1][2] = rows[2][1] = -0.125;
  whole.system = sparse(rows);
  for (const bool is_upper : {true, false}) {
    std::vector<std::vector<double>> triangle = rows;
    for (std::size_t row = 0; row < rows.size(); ++row) {
      for (std::size_t column = 0; column < rows.size(); ++column) {
        if (is_upper ? column < row : column > row) triangle[row][column] = 0;
      }
    }
    const SparseMatrix half = sparse(triangle);
    write_contact_problem(file, whole);
    const std::string m = "fclib_global/M/";
    const std::vector<std::int32_t> starts(half.row_start.begin(), half.row_start.end());
    {
      Hdf5Editor edit(file);
      edit.dataset<std::int32_t>(m + "p", {starts.size()}, starts);
      edit.dataset<std::int32_t>(m + "i", {half.column.size()}, half.column);
      edit.dataset<double>(m + "x", {half.value.size()}, half.value);
    }

    EXPECT_EQ(dense(read_contact_problem(file).system), rows) << (is_upper ? "upper" : "lower");
  }
}

TEST_F(Fclib, CompletesALocalMatrixOfOneTriangle) {
  ContactProblem whole = local_problem();
  std::vector<std::vector<double>> rows = dense(whole.delassus), lower = rows;
  for (std::size_t row = 0; row < rows.size(); ++row) {
    for (std::size_t column = 0; column < row; ++column) {
      rows[row][column] = rows[column][row] = lower[row][column] = 0.01;
      lower[column][row] = 0;
    }
  }
  whole.delassus = sparse(lower);
  write_contact_problem(file, whole);

  EXPECT_EQ(dense(read_contact_problem(file).delassus), rows);
}

TEST_F(Fclib, ReadsALocalProblemWithoutContacts) {
  write_contact_problem(file, local_problem());
  {
    Hdf5Editor edit(file);
    for (const char* name : {"vectors/mu", "vectors/q", "W/x"}) {
      edit.dataset<double>(std::string("fclib_local/") + name, {0}, {});
    }
    for (const char* name : {"m", "n"}) {
      edit.dataset<std::int32_t>(std::string("fclib_local/W/") + name, {1}, {0});
    }
    edit.dataset<std::int32_t>("fclib_local/W/p", {1}, {0});
    edit.dataset<std::int32_t>("fclib_local/W/i", {0}, {});
  }

  const ContactProblem problem = read_contact_problem(file);

  EXPECT_EQ(problem.contact_count(), 0);
  const ContactSolution solution = solve_contacts(problem);
  EXPECT_TRUE(solution.converged());
  EXPECT_TRUE(solution.impulse.empty() && solution.velocity.empty());
}

TEST_F(Fclib, KeepsAProblemWithoutContacts) {
  ContactProblem problem = global_problem();
  problem.jacobian = {};
  problem.velocity_offset = {};
  problem.friction = {};
  write_contact_problem(file, problem);

  const ContactProblem again = read_contact_problem(file);

  EXPECT_EQ(again.contact_count(), 0);
  EXPECT_EQ(again.load, problem.load);
  EXPECT_EQ(dense(again.system), dense(problem.system));
  EXPECT_EQ(again.jacobian.rows, 0);
  EXPECT_EQ(again.jacobian.columns, 6);
}

TEST_F(Fclib, ReadsTheStartOnlyIfRequested) {
  write_contact_problem(file, adhesive_problem());

  EXPECT_TRUE(read_contact_problem(file).impulse_guess.empty());
}

TEST_F(Fclib, WritesTheSameBytesTwice) {
  write_contact_problem(file, adhesive_problem());
  write_contact_problem(folder / "again.hdf5", adhesive_problem());

  const auto bytes_of = [](const std::string& path) {
    std::ifstream stream(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(stream), {});
  };
  EXPECT_EQ(bytes_of(file), bytes_of(folder / "again.hdf5"));
  EXPECT_EQ(folder.entry_count(), 2);
}

/// FCLIB reads int32 and double arrays of one axis: sizes of one number, texts with a final zero.
TEST_F(Fclib, WritesWhatFclibsReaderExpects) {
  write_contact_problem(file, adhesive_problem(), "a title");

  for (const char* name : {"nzmax", "m", "n", "nz"}) {
    EXPECT_EQ(numbers_of(file, std::string("fclib_global/M/") + name).size(), 1u) << name;
  }
  EXPECT_EQ(numbers_of(file, "fclib_global/spacedim"), (std::vector<double>{3}));
  EXPECT_EQ(numbers_of(file, "fclib_global/M/nz"), (std::vector<double>{-2}));
  EXPECT_EQ(numbers_of(file, "fclib_global/M/p").size(), 7u);
  EXPECT_EQ(numbers_of(file, "fclib_global/H/nz"), (std::vector<double>{-1}));
  EXPECT_EQ(numbers_of(file, "fclib_global/H/m"), (std::vector<double>{6}));
  EXPECT_EQ(numbers_of(file, "guesses/number_of_guesses"), (std::vector<double>{1}));
  const double entries = numbers_of(file, "fclib_global/H/nzmax")[0];
  EXPECT_EQ(numbers_of(file, "fclib_global/H/x").size(), entries);
  for (const char* vector : {"guesses/1/u", "guesses/1/v", "guesses/1/r"}) {
    EXPECT_EQ(numbers_of(file, vector).size(), 6u) << vector;
  }
}

TEST_F(Fclib, ReadsMatricesByColumns) {
  write_contact_problem(file, local_problem());
  store_delassus<std::int32_t>(
      -1, {0, 3, 6, 8, 11, 13, 16}, {0, 1, 3, 0, 1, 4, 2, 5, 0, 3, 5, 1, 4, 2, 3, 5},
      {2, 0.25, 0.500244140625, 0.25, 2, 0.5, 2, 0.125, 0.5, 3, 0.25, 0.5, 3, 0.125, 0.25, 3});

  EXPECT_EQ(contents(read_contact_problem(file)), contents(local_problem()));
}

/// Triplets in any order; the arrays are longer than the `nz` entries in use.
TEST_F(Fclib, ReadsMatricesOfTriplets) {
  write_contact_problem(file, local_problem());
  store_delassus<std::int32_t>(
      16, {5, 0, 1, 3, 1, 4, 2, 5, 0, 3, 0, 1, 4, 2, 3, 5, 77},
      {5, 0, 0, 0, 1, 1, 2, 2, 3, 3, 1, 4, 4, 5, 5, 3, 77, 78},
      {3, 2, 0.25, 0.5, 2, 0.5, 2, 0.125, 0.500244140625, 3, 0.25, 0.5, 3, 0.125, 0.25, 0.25, 9});

  EXPECT_EQ(dense(read_contact_problem(file).delassus), dense(local_problem().delassus));
}

TEST_F(Fclib, KeepsRepeatedTripletsThatAddUp) {
  write_contact_problem(file, sliding_point());
  store_delassus<std::int32_t>(4, {0, 1, 2, 0}, {0, 1, 2, 0}, {0.25, 1, 1, 0.75});

  EXPECT_EQ(dense(read_contact_problem(file).delassus), dense(sliding_point().delassus));
}

/// FCLIB's documentation and its writers differ in which of p and i is the row of a triplet.
TEST_F(Fclib, ReadsTripletsWithRowsInPWhereOnlyThatFits) {
  ContactProblem problem = sliding_point();
  problem.delassus = {};
  problem.free_velocity = {};
  problem.system = sparse({{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}});
  problem.jacobian = sparse({{1, 0, 0, 0.5}, {0, 1, 0, 0}, {0, 0, 1, 0}});
  problem.load = {-1, 0.5, 0.25, 0};
  problem.velocity_offset = {0, 0, 0};
  write_contact_problem(file, problem);
  for (const bool rows_in_p : {false, true}) {
    const std::vector<std::int32_t> dof = {0, 1, 2, 3};
    const std::vector<std::int32_t> row = {0, 1, 2, 0};
    Hdf5Editor(file)
        .dataset<std::int32_t>("fclib_global/H/nz", {1}, {4})
        .dataset<std::int32_t>("fclib_global/H/p", {4}, rows_in_p ? dof : row)
        .dataset<std::int32_t>("fclib_global/H/i", {4}, rows_in_p ? row : dof)
        .dataset<double>("fclib_global/H/x", {4}, {1, 1, 1, 0.5});

    EXPECT_EQ(dense(read_contact_problem(file).jacobian), dense(problem.jacobian)) << rows_in_p;
  }
}

TEST_F(Fclib, ReadsIndicesOfAnyWidthAndByteOrder) {
  const ContactProblem problem = sliding_point();
  write_contact_problem(file, problem);
  for (const hid_t type :
       {H5T_STD_U8LE, H5T_STD_I16BE, H5T_STD_I32BE, H5T_STD_U32LE, H5T_STD_I64LE, H5T_STD_U64BE}) {
    store_delassus<std::int64_t>(-1, {0, 1, 2, 3}, {0, 1, 2}, {1, 1, 1}, type);

    EXPECT_EQ(contents(read_contact_problem(file)), contents(problem));
  }
}

TEST_F(Fclib, ReadsNumbersOfAnyShape) {
  const ContactProblem problem = local_problem();
  write_contact_problem(file, problem);
  Hdf5Editor(file)
      .dataset<double>("fclib_local/vectors/q", {2, 3}, problem.free_velocity)
      .dataset<double>("fclib_local/vectors/mu", {2, 1}, problem.friction, H5T_IEEE_F32BE)
      .dataset<std::int64_t>("fclib_local/spacedim", {}, {3})
      .dataset<std::int16_t>("fclib_local/W/m", {1, 1}, {6});

  EXPECT_EQ(contents(read_contact_problem(file)), contents(problem));
}

TEST_F(Fclib, TakesMissingAdhesionVectorsAsNone) {
  write_contact_problem(file, adhesive_problem());
  for (const char* name : {"stiffness", "intensity", "tangential_stiffness", "gap", "energy",
                           "viscosity", "bonding_rate", "saturation"}) {
    Hdf5Editor(file).remove(std::string("adhesion/") + name);
  }

  const AdhesionState adhesion = read_contact_problem(file).adhesion;

  EXPECT_EQ(adhesion.time_step, 0.0078125);
  EXPECT_EQ(adhesion.intensity, (std::vector<double>{0, 0}));
  EXPECT_EQ(adhesion.area, (std::vector<double>{0.5, 0.25}));
  EXPECT_TRUE(adhesion.stiffness.empty() && adhesion.tangential_stiffness.empty());
  EXPECT_TRUE(adhesion.gap.empty());
  EXPECT_TRUE(adhesion.energy.empty() && adhesion.saturation_pressure.empty());
}

/// Files with empty equality constraints, other groups or other attributes are accepted.
TEST_F(Fclib, IgnoresWhatItDoesNotKnow) {
  write_contact_problem(file, local_problem());
  Hdf5Editor(file)
      .group("fclib_local/V")
      .dataset<std::int32_t>("fclib_local/V/n", {1}, {0})
      .group("more")
      .dataset<double>("fclib_local/W/determinant", {1}, {0.5})
      .attribute<double>("fclib_local/W", "rank", {6})
      .remove("fclib_local/info");

  EXPECT_EQ(contents(read_contact_problem(file)), contents(local_problem()));
}

TEST_F(Fclib, StartsFromTheSolutionUnlessItIsZero) {
  const ContactProblem problem = adhesive_problem();
  write_contact_problem(file, problem);
  Hdf5Editor(file).group("solution").dataset<double>("solution/r", {6}, {0, 0, 0, 0, 0, 0});
  EXPECT_EQ(read_contact_problem(file, ContactStart::stored).impulse_guess, problem.impulse_guess);

  Hdf5Editor(file).dataset<double>("solution/r", {6}, {0, 0, 0, 0, 0.5, 0});
  EXPECT_EQ(read_contact_problem(file, ContactStart::stored).impulse_guess,
            (std::vector<double>{0, 0, 0, 0, 0.5, 0}));
}

TEST_F(Fclib, RefusesToStartFromNothing) {
  write_contact_problem(file, local_problem());

  const std::string error = io_error([&] { read_contact_problem(file, ContactStart::stored); });

  EXPECT_NE(error.find("neither /solution/r nor /guesses/1/r"), std::string::npos) << error;
}

TEST_F(Fclib, RefusesToWriteAProblemThatCannotBeSolved) {
  ContactProblem problem = local_problem();
  problem.friction[1] = -0.5;

  const std::string error = io_error([&] { write_contact_problem(file, problem); });

  EXPECT_TRUE(error.starts_with(file + ": /fclib_local/vectors/mu: friction[1]")) << error;
  EXPECT_EQ(folder.entry_count(), 0);
}
}  // namespace
}  // namespace tetwarp::test
