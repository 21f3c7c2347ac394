/// @file vtk_file_list.cpp
/// Names of files are relative to the folder of their list.
#include "io/reader/vtk_file_list.hpp"

#include <vtkNew.h>
#include <vtkSmartPointer.h>
#include <vtkXMLDataElement.h>
#include <vtkXMLUtilities.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <tetwarp/error.hpp>

namespace tetwarp {
namespace {
namespace fs = std::filesystem;

[[noreturn]] void refuse(const std::string& path, const std::string& problem) {
  throw IoError(path, "", problem + ": damaged, or of another kind");
}

std::string located(const std::string& list, const std::string& file) {
  return (fs::path(list).parent_path() / file).string();
}
}  // namespace

std::vector<VtkListStep> read_pvd(const std::string& path) {
  const auto root =
      vtkSmartPointer<vtkXMLDataElement>::Take(vtkXMLUtilities::ReadElementFromFile(path.c_str()));
  vtkXMLDataElement* const list = root ? root->FindNestedElementWithName("Collection") : nullptr;
  if (list == nullptr) refuse(path, "holds no <Collection>");
  std::map<double, std::vector<std::string>> steps;
  for (int n = 0; n < list->GetNumberOfNestedElements(); ++n) {
    vtkXMLDataElement& entry = *list->GetNestedElement(n);
    const char* const file = entry.GetAttribute("file");
    double time = 0;
    if (file == nullptr) refuse(path, "has an entry without a file");
    if (entry.GetAttribute("timestep") != nullptr &&
        (entry.GetScalarAttribute("timestep", time) == 0 || !std::isfinite(time))) {
      refuse(path, "has a timestep that is no number");
    }
    steps[time].push_back(located(path, file));
  }
  if (steps.empty()) refuse(path, "lists no file");
  std::vector<VtkListStep> all;
  for (auto& [time, files] : steps) all.push_back({time, std::move(files)});
  return all;
}

std::vector<VtkListStep> read_series(const std::string& path) {
  using Json = nlohmann::json;
  std::ifstream in(path);
  const Json list = Json::parse(in, nullptr, false);
  if (!list.is_object() || !list.contains("files") || !list["files"].is_array() ||
      list["files"].empty()) {
    refuse(path, "holds no list 'files'");
  }
  std::vector<VtkListStep> all;
  for (const Json& entry : list["files"]) {
    const bool is_named = entry.is_object() && entry.contains("name") && entry["name"].is_string();
    if (!is_named) refuse(path, "has an entry without a name");
    VtkListStep& step = all.emplace_back();
    step.files = {located(path, entry["name"].get<std::string>())};
    if (entry.contains("time") && entry["time"].is_number())
      step.time = entry["time"].get<double>();
  }
  std::ranges::stable_sort(all, {}, [](const VtkListStep& step) { return step.time.value_or(0); });
  return all;
}

}  // namespace tetwarp
