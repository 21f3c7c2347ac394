/// @file provenance.cpp
/// Hashes inputs once, writes one file per output, and compares such files with what is there.
#include "host/cli/job/provenance.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <ctime>
#include <filesystem>
#include <fstream>
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

/// The file beside an output.
std::string provenance_file(const std::string& output) {
  return output + ".json";
}

Json facts_of(const std::string& role, const std::string& path) {
  std::error_code error;
  const std::string absolute = fs::absolute(path, error).string();
  return {{"role", role},
          {"file", error ? path : absolute},
          {"bytes", fs::file_size(path)},
          {"sha256", sha256_of_file(path)}};
}

/// Facts of an output, and of its samples where they are a file of their own.
Json facts_of_output(const std::string& output) {
  Json facts = {{"output", facts_of("output", output)}};
  const std::vector<std::string> files = files_of(output);
  if (files.size() > 1) facts["samples"] = facts_of("samples", files[1]);
  return facts;
}

Json given_as_json(const WarpArguments& arguments) {
  Json options = Json::object();
  for (const auto& [name, values] : arguments.given) {
    options[name] = values.size() == 1 ? Json(values.front()) : Json(values);
  }
  return options;
}

/// Options as given, but those that change no value.
Json deciding_options(Json options) {
  if (!options.is_object()) return {};
  for (const char* name : {"output", "resume", "provenance", "quiet", "report", "threads", "memory",
                           "strict", "dry-run", "no-skip", "device", "batch", "jobs"}) {
    options.erase(name);
  }
  return options;
}

/// Of files: role, size and hash, without their place.
Json contents_of(Json files) {
  for (Json& file : files) {
    if (file.is_object()) file.erase("file");
  }
  return files;
}

/// The object in OUT.json; null if the file is missing or holds something else.
Json read_facts(const std::string& file) {
  std::ifstream stream(file);
  const Json facts = Json::parse(stream, nullptr, false);
  return facts.is_object() ? facts : Json();
}

bool is_older(const std::string& file, const std::string& output) {
  std::error_code error;
  const auto written = fs::last_write_time(file, error);
  return error || written < fs::last_write_time(output);
}
}  // namespace

std::vector<std::string> files_to_write(const WarpArguments& arguments,
                                        const std::vector<std::string>& outputs) {
  std::vector<std::string> files = outputs;
  if (arguments.provenance) {
    for (const std::string& output : outputs) files.push_back(provenance_file(output));
  }
  if (!arguments.report.empty()) files.push_back(arguments.report);
  return files;
}

InputFacts input_facts(const WarpArguments& arguments) {
  InputFacts facts;
  if (!arguments.provenance || arguments.dry_run) return facts;
  Json inputs = Json::array();
  // Of a file that lists others, it and all of these.
  const auto add = [&](const std::string& role, const std::string& path) {
    for (const std::string& file : files_of(path)) {
      facts.times.emplace_back(file, fs::last_write_time(file));
      inputs.push_back(facts_of(role, file));
    }
  };
  for (const std::string& volume : arguments.volumes()) add("volume", volume);
  const bool is_transform = is_transform_file(arguments.mesh_file(), arguments.transform_options());
  add(is_transform ? "transform" : "mesh", arguments.mesh_file());
  if (arguments.mesh.rest_file) add("rest", *arguments.mesh.rest_file);
  if (arguments.grid.has_file()) add("grid", arguments.grid.base);
  facts.json = json_text(inputs, 0);
  return facts;
}

ProvenanceState provenance_state(const WarpArguments& arguments,
                                 const InputFacts& inputs,
                                 const std::vector<std::string>& outputs) {
  bool is_missing = false;
  const Json contents = contents_of(Json::parse(inputs.json));
  for (const std::string& output : outputs) {
    const Json facts = read_facts(provenance_file(output));
    std::error_code error;
    if (facts.is_null() || !fs::is_regular_file(output, error)) {
      is_missing = true;
      continue;
    }
    const Json now = facts_of_output(output);
    const auto is_as_written = [&](const char* file) {
      return contents_of(Json::array({facts.value(file, Json())})) ==
             contents_of(Json::array({now.value(file, Json())}));
    };
    const bool agrees = facts.value("tetwarp", Json()) == TETWARP_VERSION &&
                        deciding_options(facts.value("options", Json::object())) ==
                            deciding_options(given_as_json(arguments)) &&
                        contents_of(facts.value("inputs", Json::array())) == contents &&
                        is_as_written("output") && is_as_written("samples");
    if (!agrees) return ProvenanceState::contradicts;
  }
  return is_missing ? ProvenanceState::missing : ProvenanceState::agrees;
}

void write_provenance(const WarpArguments& arguments,
                      const InputFacts& inputs,
                      const std::vector<std::string>& files,
                      const JobResult& result) {
  if (inputs.json.empty()) return;
  for (const auto& [file, time] : inputs.times) {
    std::error_code error;
    if (fs::last_write_time(file, error) == time) continue;
    throw IoError(file, "",
                  "was written while it was warped: what " + files.front() +
                      " was made from is not known, and not written beside it; run again");
  }
  Json facts;
  for (const std::string& output : files) {
    const std::string file = provenance_file(output);
    if (!is_older(file, output)) continue;
    if (facts.is_null()) {
      facts = {{"tetwarp", TETWARP_VERSION},
               {"written", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)))},
               {"backend", name_of(result.report.backend)},
               {"options", given_as_json(arguments)},
               {"inputs", Json::parse(inputs.json)},
               {"warnings", result.warnings},
               {"notes", result.notes}};
    }
    Json own = facts;
    own.update(facts_of_output(output));
    write_finished_file(file, json_text(own, 2) + "\n");
  }
}

}  // namespace tetwarp::cli
