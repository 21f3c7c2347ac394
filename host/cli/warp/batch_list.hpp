/// @file batch_list.hpp
/// The jobs of a batch file as JSON objects: from JSON, or from CSV with one job per row.
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace tetwarp::cli {

/// Reads the jobs of a file: {"jobs": [...]}, or CSV where the name ends in .csv. The first row of
/// CSV names the keys; a cell that is empty sets none, true and false are those of switches, and
/// several volumes have semicolons between them.
///
/// A '*' in `volume` stands for any letters of the names of files: there is a job for each file,
/// and a '*' in other paths of the job becomes what it stands for.
/// @throws IoError  when it holds no list of jobs
std::vector<nlohmann::ordered_json> read_job_list(const std::string& path);

}  // namespace tetwarp::cli
