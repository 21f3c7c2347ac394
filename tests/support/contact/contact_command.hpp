/// @file contact_command.hpp
/// `tetwarp contact` in a temporary folder, for the tests of the command.
#pragma once
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/contact/contact_files.hpp"
#include "tests/support/run_command.hpp"

namespace tetwarp::test {

using Json = nlohmann::json;
using Names = std::vector<std::string>;

/// A folder with problem.hdf5.
class ContactCommand : public testing::Test {
 protected:
  void store(const ContactProblem& problem) const {
    write_contact_problem(folder / "problem.hdf5", problem);
  }

  /// Runs `tetwarp contact problem.hdf5 -o solved.hdf5` with more words.
  CommandResult solve(Names words = {}, const RunOptions& options = {}) const {
    words.insert(words.begin(), {"contact", "problem.hdf5", "-o", "solved.hdf5"});
    return run_command(folder, words, options);
  }

  std::vector<double> solved(const std::string& dataset) const {
    return numbers_of(folder / "solved.hdf5", dataset);
  }

  double solution_attribute(const std::string& name) const {
    return attribute_of(folder / "solved.hdf5", "solution", name);
  }

  Json report() const { return Json::parse(text_of(folder / "report.json")); }

  TemporaryFolder folder;
};

}  // namespace tetwarp::test
