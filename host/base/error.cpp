/// @file error.cpp
/// The one line of text of an IoError.
#include <tetwarp/error.hpp>
#include <utility>

namespace tetwarp {
namespace {
std::string line_of(const std::string& file,
                    const std::string& dataset,
                    const std::string& problem) {
  return file + ": " + (dataset.empty() ? "" : dataset + ": ") + problem;
}
}  // namespace

IoError::IoError(std::string file, std::string dataset, const std::string& problem)
    : std::runtime_error(line_of(file, dataset, problem)),
      file_(std::move(file)),
      dataset_(std::move(dataset)) {}

}  // namespace tetwarp
