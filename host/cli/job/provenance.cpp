/// @file provenance.cpp
/// Hashes inputs once, and writes one file per output.
#include "host/cli/job/provenance.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <ctime>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <system_error>
#include <tetwarp/names.hpp>
#include <tetwarp/version.hpp>

#include "host/cli/common/json_text.hpp"
#include "io/files/finished_file.hpp"
#include "io/files/numbered_files.hpp"
#include "io/files/sha256.hpp"

namespace tetwarp::cli {
namespace {
namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

Json facts_of(const std::string& role, const std::string& path) {
  std::error_code error;
  const std::string absolute = fs::absolute(path, error).string();
  return {{"role", role},
          {"file", error ? path : absolute},
          {"bytes", fs::file_size(path)},
          {"sha256", sha256_of_file(path)}};
}

/// All files that a job reads; a list of files with those that it names.
Json facts_of_inputs(const WarpArguments& arguments) {
  Json inputs = Json::array();
  const auto add = [&](const std::string& role, const std::string& path) {
    for (const std::string& file : files_of(path)) inputs.push_back(facts_of(role, file));
  };
  for (const std::string& volume : arguments.volumes()) add("volume", volume);
  add("mesh", arguments.mesh_file());
  if (arguments.mesh.rest_file) add("rest", *arguments.mesh.rest_file);
  if (arguments.grid.base != "same" && arguments.grid.base != "bounds") {
    add("grid", arguments.grid.base);
  }
  return inputs;
}

Json given_as_json(const WarpArguments& arguments) {
  Json options = Json::object();
  for (const auto& [name, values] : arguments.given) {
    options[name] = values.size() == 1 ? Json(values.front()) : Json(values);
  }
  return options;
}

bool is_older(const std::string& file, const std::string& output) {
  std::error_code error;
  const auto written = fs::last_write_time(file, error);
  return error || written < fs::last_write_time(output);
}
}  // namespace

void write_provenance(const WarpArguments& arguments,
                      const JobPlan& plan,
                      const JobResult& result) {
  Json facts;
  for (const VolumePlan& volume : plan.volumes) {
    for (const std::string& output : volume.files) {
      const std::string file = output + ".json";
      if (!is_older(file, output)) continue;
      if (facts.is_null()) {
        facts = {{"tetwarp", TETWARP_VERSION},
                 {"written", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)))},
                 {"backend", name_of(result.report.backend)},
                 {"options", given_as_json(arguments)},
                 {"inputs", facts_of_inputs(arguments)},
                 {"warnings", result.warnings}};
      }
      Json own = facts;
      own["output"] = facts_of("output", output);
      write_finished_file(file, json_text(own, 2) + "\n");
    }
  }
}

}  // namespace tetwarp::cli
