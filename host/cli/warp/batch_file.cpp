/// @file batch_file.cpp
/// Reads a batch file: each job becomes the words of a command line, parsed like one.
#include "host/cli/warp/batch_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <system_error>
#include <tetwarp/backend.hpp>
#include <tetwarp/io.hpp>
#include <tetwarp/transform_file.hpp>
#include <utility>

#include "host/cli/common/declare.hpp"
#include "host/cli/warp/batch_list.hpp"
#include "host/cli/warp/transform_job.hpp"
#include "host/cli/warp/warp_job.hpp"

namespace tetwarp::cli {
namespace {
namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

using Words = std::vector<std::string>;

/// Options of the whole batch; a job may not have them.
const Words batch_options{"help", "batch", "jobs", "quiet"};

/// Options whose values are names of arrays, which may hold commas.
const Words name_options{"array", "vectors", "tensors"};

/// Options that take several values.
const Words list_options{"array", "vectors", "tensors", "outputs", "no-skip",  "steps",
                         "roi",   "dims",    "origin",  "spacing", "direction"};

bool is_one_of(const std::string& word, const Words& words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

/// The words of an option: repeated where a value may hold commas, else with one comma list.
Words option_words(const std::string& name, const Words& values) {
  if (!is_one_of(name, name_options)) return {"--" + name + "=" + CLI::detail::join(values, ",")};
  Words words;
  for (const std::string& value : values) words.push_back("--" + name + "=" + value);
  return words;
}

std::string scalar_text(const std::string& key, const Json& value) {
  if (value.is_string() && !value.get<std::string>().empty()) return value.get<std::string>();
  if (value.is_number()) return value.dump();
  throw std::invalid_argument(
      fmt::format("'{}' holds {}, expected text or numbers", key, value.dump()));
}

Words value_texts(const std::string& key, const Json& value) {
  Words texts;
  if (!value.is_array()) return {scalar_text(key, value)};
  for (const Json& item : value) texts.push_back(scalar_text(key, item));
  if (texts.empty()) throw std::invalid_argument(fmt::format("'{}' is an empty list", key));
  return texts;
}

/// Names of files, which are texts.
Words file_names(const std::string& key, const Json& value) {
  for (const Json& one : value.is_array() ? value : Json::array({value})) {
    if (one.is_string()) continue;
    throw std::invalid_argument(
        fmt::format("'{}' holds {}, expected the name of a file", key, one.dump()));
  }
  return value_texts(key, value);
}

/// Turns a job into the words of a command line, which are parsed like one.
class JobReader {
 public:
  JobReader(fs::path folder, const CLI::App& defaults)
      : folder_(std::move(folder)), defaults_(defaults) {}

  /// @param is_by_transform  as of that function
  /// @param left_out         out: BatchJob::left_out
  Words words_of(const Json& job, bool is_by_transform, Words& left_out) const {
    if (!job.is_object()) throw std::invalid_argument("is not a JSON object");
    Words files;
    Words options;
    if (job.contains("mesh") && job.contains("transform")) {
      throw std::invalid_argument("has a 'mesh' and a 'transform'; leave out one");
    }
    for (const std::string& key : {std::string("volume"), deformation_key(job)}) {
      if (!job.contains(key)) throw std::invalid_argument("has no '" + key + "'");
      for (const std::string& name : file_names(key, job[key])) files.push_back(located(name));
    }
    for (const auto& [key, value] : job.items()) {
      if (key == "volume" || key == deformation_key(job)) continue;
      const Words some = words_of_key(key, value);
      options.insert(options.end(), some.begin(), some.end());
    }
    for (const CLI::Option* option : defaults_.get_options()) {
      if (!is_default(*option) || sets(job, option->get_lnames().front())) continue;
      const bool is_taken = refusal(*option, job, is_by_transform).empty();
      const Words some = words_of_default(*option);
      Words& all = is_taken ? options : left_out;
      all.insert(all.end(), some.begin(), some.end());
    }
    files.insert(files.end(), options.begin(), options.end());
    return files;
  }

  /// Also where a file cannot be opened: the job reports what is wrong with it.
  static bool is_nifti_or_unreadable(const std::string& file) {
    try {
      return !is_there(file) || kind_of(file) == FileKind::nifti;
    } catch (const IoError&) {
      return true;
    }
  }

  /// Whether a job warps by a transform: by its key, or because the file called `mesh` is one.
  bool is_by_transform(const Json& job) const {
    if (!job.is_object() || job.contains("transform")) return job.is_object();
    for (const std::string& file : located_names(job, "mesh")) {
      try {
        if (kind_of(file) == FileKind::nifti || is_transform_file(file)) return true;
      } catch (const IoError&) {
        // The job reports what is wrong with its file.
      }
    }
    return false;
  }

  /// Why a job does not take a default, with a remedy; empty: it takes it, or its files, which an
  /// earlier job may write, are not there to tell.
  std::string refusal(const CLI::Option& option, const Json& job, bool is_by_transform) const {
    const std::string& name = option.get_lnames().front();
    if (!job.is_object()) return {};
    const Words files = located_names(job, deformation_key(job));
    if (is_by_transform && (name == "axes" || name == "steps")) {
      if (files.empty() || !std::ranges::all_of(files, is_there)) return {};
      if (name == "axes") return axes_refusal_of(files.back());
      if (has_steps_or_error(files.back())) return {};
    }
    if (is_by_transform && name != "fsl") {
      const bool has_provenance = job.contains("provenance")
                                      ? job["provenance"] == true
                                      : defaults_.get_option("--provenance")->count() > 0;
      const std::string reason = transform_refusal(name, option.results(), has_provenance);
      if (!reason.empty()) return reason;
    }
    for (const std::string& file : files) {
      if (name != "fsl" || is_nifti_or_unreadable(file)) continue;
      return "--fsl is for warp fields of FSL, which are NIfTI images; leave it out";
    }
    return refusal_beside(name, job);
  }

  /// Throws IoError for a default that no job takes.
  /// @param path              the batch file
  /// @param are_by_transform  of each job
  void check_defaults(const std::string& path,
                      const std::vector<Json>& jobs,
                      const std::vector<bool>& are_by_transform) const {
    for (const CLI::Option* option : defaults_.get_options()) {
      if (!is_default(*option)) continue;
      std::string reason;
      for (std::size_t j = 0; j < jobs.size(); ++j) {
        reason = refusal(*option, jobs[j], are_by_transform[j]);
        if (reason.empty()) break;
      }
      if (!reason.empty()) throw IoError(path, "", "no job takes a default: " + reason);
    }
  }

  /// Stores the names of files that are given as text, for the report of a job that may have
  /// errors.
  void name_files(const Json& job, BatchJob& named) const {
    named.volumes = located_names(job, "volume");
    if (!job.is_object()) return;
    for (const std::string& mesh : located_names(job, deformation_key(job))) named.mesh = mesh;
    for (const std::string& output : located_names(job, "output")) named.output = output;
  }

 private:
  /// The key of the file that deforms the volume.
  static std::string deformation_key(const Json& job) {
    return job.contains("transform") ? "transform" : "mesh";
  }

  static bool is_there(const std::string& file) {
    std::error_code error;
    return fs::exists(file, error);
  }

  /// The value of an option for a job: its own, or the default; empty: none.
  std::string value_of(const Json& job, const std::string& name) const {
    if (!job.contains(name)) {
      const CLI::Option& option = *defaults_.get_option("--" + name);
      return option.count() > 0 ? option.results().front() : "";
    }
    return job[name].is_string() ? job[name].get<std::string>() : job[name].dump();
  }

  /// Whether a job sets what an option sets: --like is another name of --grid.
  static bool sets(const Json& job, const std::string& name) {
    return job.contains(name) || (name == "grid" && job.contains("like")) ||
           (name == "like" && job.contains("grid"));
  }

  /// The word or the file of which a job takes its grid; empty: none is given.
  std::string grid_base(const Json& job) const {
    for (const char* const key : {"like", "grid"}) {
      const std::string value = sets(job, key) && !job.contains(key) ? "" : value_of(job, key);
      if (value.empty() || is_one_of(value, {"same", "bounds"})) continue;
      return job.contains(key) ? located(value) : value;
    }
    return {};
  }

  /// Why a default cannot stand beside the other options and the files of a job.
  std::string refusal_beside(const std::string& name, const Json& job) const {
    if (name == "device" || (name == "backend" && job.contains("device"))) {
      const std::string backend = value_of(job, "backend");
      const Words taken{"", name_of(Backend::automatic), name_of(Backend::cuda)};
      if (is_one_of(backend, taken)) return {};
      return "--device is of cuda, --backend is " + backend + "; leave out one";
    }
    if (name == "series" && !may_have_series(located_names(job, "volume"))) {
      return "--series is for folders of DICOM images; leave it out";
    }
    const std::string base = grid_base(job);
    if (name == "like-series" && (base.empty() || !may_have_series({base}))) {
      return "--like-series is of the folder of DICOM images that --like names; add --like FOLDER, "
             "or leave it out";
    }
    const bool has_report = job.contains("report") || defaults_.get_option("--report")->count() > 0;
    if (name != "count-folded" || has_report) return {};
    return std::string("--count-folded ") + count_folded_refusal;
  }

  /// Whether one is a folder, or is not there to tell.
  static bool may_have_series(const Words& paths) {
    return std::ranges::any_of(paths, [](const std::string& path) {
      std::error_code error;
      return !is_there(path) || fs::is_directory(path, error);
    });
  }

  /// A field that cannot be read is an error of its job.
  static std::string axes_refusal_of(const std::string& transform) {
    try {
      return axes_refusal(transform);
    } catch (const IoError&) {
      return {};
    }
  }

  /// A field that cannot be read is an error of its job.
  static bool has_steps_or_error(const std::string& transform) {
    try {
      return transform_step_count(transform) > 1;
    } catch (const IoError&) {
      return true;
    }
  }

  std::string located(const std::string& path) const { return (folder_ / path).string(); }

  /// The files of a key that are given as text.
  Words located_names(const Json& job, const std::string& key) const {
    Words names;
    const Json value = job.is_object() && job.contains(key) ? job[key] : Json();
    for (const Json& one : value.is_array() ? value : Json::array({value})) {
      if (one.is_string()) names.push_back(located(one.get<std::string>()));
    }
    return names;
  }

  Words words_of_key(const std::string& key, const Json& value) const {
    const CLI::Option* option = defaults_.get_option_no_throw("--" + key);
    if (option == nullptr || is_one_of(key, batch_options)) {
      throw std::invalid_argument(
          "unknown key '" + key +
          "'; keys are volume, mesh, transform and the options of tetwarp warp");
    }
    if (option->get_items_expected_max() == 0) {
      if (!value.is_boolean()) {
        throw std::invalid_argument("'" + key + "' holds " + value.dump() +
                                    ", expected true or false");
      }
      return value.get<bool>() ? Words{"--" + key} : Words{};
    }
    Words texts = key == "output" ? file_names(key, value) : value_texts(key, value);
    if (texts.size() > 1 && !is_one_of(key, list_options)) {
      throw std::invalid_argument(
          fmt::format("'{}' holds a list of {}, expected one value", key, texts.size()));
    }
    const bool is_path = key == "output" || key == "report" || key == "rest" || key == "like" ||
                         (key == "grid" && !is_one_of(texts.front(), {"same", "bounds"}));
    if (is_path) texts.front() = located(texts.front());
    return option_words(key, texts);
  }

  /// Whether an option of the command line is a default of jobs. With --batch, --report names the
  /// report of the whole batch.
  static bool is_default(const CLI::Option& option) {
    if (option.count() == 0 || option.get_lnames().empty()) return false;
    const std::string& name = option.get_lnames().front();
    return name != "report" && !is_one_of(name, batch_options);
  }

  static Words words_of_default(const CLI::Option& option) {
    const std::string& name = option.get_lnames().front();
    if (option.get_items_expected_max() == 0) return {"--" + name};
    return option_words(name, option.results());
  }

  fs::path folder_;
  const CLI::App& defaults_;
};
}  // namespace

std::vector<BatchJob> read_batch(const std::string& path, const CLI::App& defaults) {
  const JobReader reader(fs::path(path).parent_path(), defaults);
  const std::vector<Json> list = read_job_list(path);
  std::vector<bool> are_by_transform;
  for (const Json& job : list) are_by_transform.push_back(reader.is_by_transform(job));
  reader.check_defaults(path, list, are_by_transform);
  std::vector<BatchJob> jobs;
  for (const Json& job : list) {
    BatchJob& parsed = jobs.emplace_back();
    parsed.keys = job;
    reader.name_files(job, parsed);
    read_again(path, defaults, parsed);
  }
  return jobs;
}

void read_again(const std::string& path, const CLI::App& defaults, BatchJob& job) {
  const JobReader reader(fs::path(path).parent_path(), defaults);
  job.left_out.clear();
  job.error.clear();
  try {
    job.words = reader.words_of(job.keys, reader.is_by_transform(job.keys), job.left_out);
    job.arguments = parse_warp_arguments(job.words);
    const bool is_reported =
        !job.arguments.report.empty() || defaults.get_option("--report")->count() > 0;
    if (job.arguments.warp.count_folded && !is_reported) {
      throw CLI::ValidationError("--count-folded", count_folded_refusal);
    }
  } catch (const CLI::ParseError& error) {
    job.error = path + ": " + one_line(error.what());
  } catch (const std::invalid_argument& error) {
    job.error = path + ": " + one_line(error.what());
  }
}

}  // namespace tetwarp::cli
