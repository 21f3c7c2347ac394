/// @file refused_line.hpp
/// Expects that the command refuses bad input: one line, an exit code, nothing written.
#pragma once
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/run_command.hpp"

namespace tetwarp::test {

/// Runs a command that must fail with one line that holds `phrase`, and must not leave a file.
/// @param exit_code  1, or 2 for errors of usage
inline void expect_refused_line(const TemporaryFolder& folder,
                                const std::vector<std::string>& words,
                                const std::string& phrase,
                                const RunOptions& options = {},
                                int exit_code = 1) {
  const std::vector<std::string> before = folder.names();
  const CommandResult result = run_command(folder, words, options);
  EXPECT_EQ(result.exit_code, exit_code) << phrase << ": " << result.err;
  EXPECT_TRUE(result.has_one_line_error()) << result.err;
  EXPECT_NE(result.err.find(phrase), std::string::npos) << phrase << ": " << result.err;
  EXPECT_EQ(folder.names(), before) << phrase;
}

}  // namespace tetwarp::test
