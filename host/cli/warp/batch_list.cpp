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

namespace tetwarp::cli {
namespace {
namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using Row = std::vector<std::string>;

/// "line L, column C" of a byte offset, both from 1.
std::string position_text(const std::string& text, std::size_t offset) {
  const std::string before = text.substr(0, offset == 0 ? 0 : offset - 1);
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const std::size_t line_start =
      before.rfind('\n') == std::string::npos ? 0 : before.rfind('\n') + 1;
  return fmt::format("line {}, column {}", line, before.size() - line_start + 1);
}

std::vector<Json> json_jobs(const std::string& path, const std::string& text) {
  Json batch;
  try {
    batch = Json::parse(text);
  } catch (const nlohmann::json::parse_error& error) {
    throw IoError(path, position_text(text, error.byte), "not valid JSON; correct it");
  }
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
  Row row(1);
  bool is_quoted = false;
  const auto end_row = [&] {
    if (row.size() > 1 || !row[0].empty()) rows.push_back(row);
    row = Row(1);
  };
  for (std::size_t at = text.starts_with("\xef\xbb\xbf") ? 3 : 0; at < text.size(); ++at) {
    const char letter = text[at];
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
  if (is_quoted) throw IoError(path, "", "has a quote without an end; write \"\" for a quote");
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
  std::vector<Json> jobs;
  for (std::size_t r = 1; r < rows.size(); ++r) {
    if (rows[r].size() != rows[0].size()) {
      throw IoError(
          path, fmt::format("row {}", r + 1),
          fmt::format("has {} cells, the row of keys has {}", rows[r].size(), rows[0].size()));
    }
    Json& job = jobs.emplace_back(Json::object());
    for (std::size_t c = 0; c < rows[r].size(); ++c) {
      const std::string key = trimmed(rows[0][c]), cell = trimmed(rows[r][c]);
      if (!cell.empty()) job[key] = cell_value(key, cell);
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
