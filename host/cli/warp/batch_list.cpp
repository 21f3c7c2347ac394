/// @file batch_list.cpp
/// Text to jobs, and one job per file that a pattern matches.
#include "host/cli/warp/batch_list.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <tetwarp/error.hpp>

#include "io/files/extension.hpp"
#include "io/files/numbered_files.hpp"
#include "io/files/text_file.hpp"
#include "io/scene/scene_json.hpp"

namespace tetwarp::cli {
namespace {
namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// One row of CSV.
struct Row {
  std::vector<std::string> cells;
  std::ptrdiff_t line;  ///< where it begins, from 1
};

std::vector<Json> json_jobs(const std::string& path, const std::string& text) {
  const Json batch = parse_json(text, path);
  if (!batch.is_object() || batch.size() != 1 || !batch.contains("jobs") ||
      !batch["jobs"].is_array() || batch["jobs"].empty()) {
    throw IoError(path, "", "expected {\"jobs\": [...]} with one job or more and no other key");
  }
  return batch["jobs"].get<std::vector<Json>>();
}

/// The rows of RFC 4180: cells between commas, in quotes where they hold commas, quotes or line
/// breaks. Rows without a letter are left out.
std::vector<Row> csv_rows(const std::string& path, const std::string& text) {
  std::vector<Row> rows;
  std::vector<std::string> row(1);
  std::ptrdiff_t line = 1, lines = 1;  // of the row, so far
  bool is_quoted = false;
  const auto end_row = [&] {
    if (row.size() > 1 || !row[0].empty()) rows.push_back({row, line});
    row.assign(1, "");
    line = lines;
  };
  for (std::size_t at = text.starts_with("\xef\xbb\xbf") ? 3 : 0; at < text.size(); ++at) {
    const char letter = text[at];
    if (letter == '\n') ++lines;
    if (is_quoted && letter == '"' && at + 1 < text.size() && text[at + 1] == '"') {
      row.back() += letter;
      ++at;
    } else if (letter == '"') {
      is_quoted = !is_quoted;
    } else if (is_quoted) {
      row.back() += letter;
    } else if (letter == ',') {
      row.emplace_back();
    } else if (letter == '\n') {
      end_row();
    } else if (letter != '\r') {
      row.back() += letter;
    }
  }
  if (is_quoted) {
    throw IoError(path, fmt::format("line {}", line),
                  "has a quote without an end; write \"\" for a quote");
  }
  end_row();
  return rows;
}

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") + 1 - first);
}

/// The value of a cell.
Json cell_value(const std::string& key, const std::string& cell) {
  if (cell == "true" || cell == "false") return cell == "true";
  if (key != "volume") return cell;
  Json volumes = Json::array();
  for (std::size_t at = 0; at <= cell.size();) {
    const std::size_t past = std::min(cell.find(';', at), cell.size());
    volumes.push_back(trimmed(cell.substr(at, past - at)));
    at = past + 1;
  }
  return volumes.size() == 1 ? volumes[0] : volumes;
}

std::vector<Json> csv_jobs(const std::string& path, const std::string& text) {
  const std::vector<Row> rows = csv_rows(path, text);
  if (rows.size() < 2) {
    throw IoError(path, "", "expected a row of keys such as volume,mesh,output, and rows of jobs");
  }
  std::vector<std::string> keys;
  for (const std::string& cell : rows[0].cells) {
    const std::string key = trimmed(cell);
    if (std::ranges::find(keys, key) != keys.end()) {
      throw IoError(path, fmt::format("line {}", rows[0].line),
                    fmt::format("names the key '{}' twice; remove one column{}", key,
                                key == "volume" ? ", or write volumes with ';' between them" : ""));
    }
    keys.push_back(key);
  }
  std::vector<Json> jobs;
  for (std::size_t r = 1; r < rows.size(); ++r) {
    const std::vector<std::string>& cells = rows[r].cells;
    if (cells.size() != keys.size()) {
      throw IoError(path, fmt::format("line {}", rows[r].line),
                    fmt::format("has {} cells, the row of keys has {}; write an empty cell for a "
                                "key that is not set",
                                cells.size(), keys.size()));
    }
    Json& job = jobs.emplace_back(Json::object());
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const std::string cell = trimmed(cells[c]);
      if (!cell.empty()) job[keys[c]] = cell_value(keys[c], cell);
    }
  }
  return jobs;
}

/// Keys whose '*' becomes what the '*' of `volume` stands for.
constexpr const char* path_keys[] = {"mesh", "transform", "output", "report",
                                     "rest", "grid",      "like"};

/// One job for each file that the pattern in `volume` matches; others stay as they are.
std::vector<Json> expanded(const std::string& list, const Json& job) {
  const bool has_name = job.is_object() && job.contains("volume") && job["volume"].is_string();
  const std::string pattern =
      has_name ? (fs::path(list).parent_path() / job["volume"].get<std::string>()).string() : "";
  if (!is_pattern(pattern)) return {job};
  const std::string name = fs::path(pattern).filename().string();
  const std::size_t star = name.find('*');
  if (name.find('*', star + 1) != std::string::npos) {
    throw IoError(list, "volume", "'" + pattern + "' has several '*', one is possible");
  }
  std::vector<Json> jobs;
  for (const std::string& file : numbered_files(pattern)) {
    const std::string found = fs::path(file).filename().string();
    const std::string letters = found.substr(star, found.size() + 1 - name.size());
    Json one = job;
    one["volume"] = (fs::path(job["volume"].get<std::string>()).parent_path() / found).string();
    for (const char* key : path_keys) {
      if (!one.contains(key) || !one[key].is_string()) continue;
      std::string text = one[key].get<std::string>();
      if (const std::size_t at = text.find('*'); at != std::string::npos) {
        one[key] = text.replace(at, 1, letters);
      }
    }
    jobs.push_back(std::move(one));
  }
  return jobs;
}
}  // namespace

std::vector<Json> read_job_list(const std::string& path) {
  const std::string text = read_text(path);
  std::vector<Json> jobs;
  for (const Json& job :
       has_extension(path, ".csv") ? csv_jobs(path, text) : json_jobs(path, text)) {
    for (Json& one : expanded(path, job)) jobs.push_back(std::move(one));
  }
  return jobs;
}

}  // namespace tetwarp::cli
