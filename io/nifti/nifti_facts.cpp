/// @file nifti_facts.cpp
/// Writes facts as attributes, and reads them back.
#include "io/nifti/nifti_facts.hpp"

#include <nifti1.h>

#include <cmath>
#include <string>

#include "io/h5/h5_attribute.hpp"
#include "io/h5/h5_write.hpp"

namespace tetwarp {
namespace {
const std::string prefix = "tetwarp_nifti_";
// Of the fields of a header.
constexpr int largest_code = 32767, largest_units = 255;
constexpr std::size_t name_bytes = 16, description_bytes = 80;

int read_code(const h5::Object& dataset, const std::string& name, std::int64_t largest) {
  const std::int64_t value = h5::read_integer_attribute(dataset, prefix + name, 1)[0];
  if (value >= 0 && value <= largest) return static_cast<int>(value);
  dataset.fail("attribute " + prefix + name + " is " + std::to_string(value) + ", expected 0 to " +
               std::to_string(largest));
}

std::string read_text(const h5::Object& dataset, const std::string& name, std::size_t largest) {
  if (!h5::has_attribute(dataset, prefix + name)) return {};
  std::string text = h5::read_text_attribute(dataset, prefix + name);
  if (text.size() <= largest) return text;
  dataset.fail("attribute " + prefix + name + " has " + std::to_string(text.size()) +
               " bytes, expected at most " + std::to_string(largest));
}

void write_text(const h5::Object& dataset, const std::string& name, const std::string& text) {
  if (!text.empty()) h5::write_text_attribute(dataset, prefix + name, text);
}
}  // namespace

NiftiFacts default_nifti_facts(int components) {
  NiftiFacts facts;
  if (components == 6) {
    facts.intent_code = NIFTI_INTENT_SYMMATRIX;
    facts.intent_p[0] = 3;  // rows
  } else if (components > 1) {
    facts.intent_code = NIFTI_INTENT_VECTOR;
  }
  return facts;
}

std::string facts_problem(const NiftiFacts& facts) {
  const auto of_code = [](const std::string& name, int value, int largest) {
    return value >= 0 && value <= largest ? std::string()
                                          : name + " is " + std::to_string(value) +
                                                ", expected 0 to " + std::to_string(largest);
  };
  const auto of_text = [](const std::string& name, const std::string& text, std::size_t largest) {
    return text.size() <= largest ? std::string()
                                  : name + " has " + std::to_string(text.size()) +
                                        " bytes, expected at most " + std::to_string(largest);
  };
  const auto of_number = [](const std::string& name, double value) {
    return std::isfinite(static_cast<float>(value)) ? std::string()
                                                    : name + " is no finite number of 32 bits";
  };
  const auto of_time_step = [](double value) {
    return static_cast<float>(value) > 0 ? std::string() : "time_step is not above 0 in 32 bits";
  };
  for (const std::string& problem :
       {of_code("sform_code", facts.sform_code, largest_code),
        of_code("qform_code", facts.qform_code, largest_code),
        of_code("xyzt_units", facts.xyzt_units, largest_units),
        of_code("intent_code", facts.intent_code, largest_code),
        of_text("intent_name", facts.intent_name, name_bytes),
        of_text("description", facts.description, description_bytes),
        of_number("cal_min", facts.cal_min), of_number("cal_max", facts.cal_max),
        of_number("time_step", facts.time_step), of_time_step(facts.time_step),
        of_number("intent_p[0]", facts.intent_p[0]), of_number("intent_p[1]", facts.intent_p[1]),
        of_number("intent_p[2]", facts.intent_p[2])}) {
    if (!problem.empty()) return "NIfTI header: " + problem;
  }
  return {};
}

void write_fact_attributes(const h5::Object& dataset, const NiftiFacts& facts) {
  if (const std::string problem = facts_problem(facts); !problem.empty()) dataset.fail(problem);
  const auto write_code = [&](const char* name, int value) {
    h5::write_scalar_attribute(dataset, prefix + name, static_cast<std::int64_t>(value));
  };
  write_code("sform_code", facts.sform_code);
  write_code("qform_code", facts.qform_code);
  write_code("xyzt_units", facts.xyzt_units);
  write_code("intent_code", facts.intent_code);
  h5::write_attribute(dataset, prefix + "intent_p", std::span<const double>(facts.intent_p));
  write_text(dataset, "intent_name", facts.intent_name);
  write_text(dataset, "descrip", facts.description);
  write_text(dataset, "component_axes", name_of(facts.component_axes));
  const NiftiFacts usual;
  const auto write_number = [&](const char* name, double value, double usual_value) {
    if (value != usual_value) h5::write_scalar_attribute(dataset, prefix + name, value);
  };
  write_number("cal_min", facts.cal_min, usual.cal_min);
  write_number("cal_max", facts.cal_max, usual.cal_max);
  write_number("time_step", facts.time_step, usual.time_step);
}

std::optional<NiftiFacts> read_fact_attributes(const h5::Object& dataset) {
  if (!h5::has_attribute(dataset, prefix + "sform_code")) return std::nullopt;
  NiftiFacts facts;
  facts.sform_code = read_code(dataset, "sform_code", largest_code);
  facts.qform_code = read_code(dataset, "qform_code", largest_code);
  facts.xyzt_units = read_code(dataset, "xyzt_units", largest_units);
  facts.intent_code = read_code(dataset, "intent_code", largest_code);
  const std::vector<double> p = h5::read_real_attribute(dataset, prefix + "intent_p", 3);
  facts.intent_p = {p[0], p[1], p[2]};
  facts.intent_name = read_text(dataset, "intent_name", name_bytes);
  facts.description = read_text(dataset, "descrip", description_bytes);
  const std::string axes = read_text(dataset, "component_axes", 3);
  try {
    facts.component_axes = parse<Axes>(axes);
  } catch (const std::invalid_argument& error) {
    dataset.fail("attribute " + prefix + "component_axes: " + error.what());
  }
  const auto read_number = [&](const char* name, double& value) {
    if (!h5::has_attribute(dataset, prefix + name)) return;
    value = h5::read_real_attribute(dataset, prefix + name, 1)[0];
    if (!std::isfinite(value)) dataset.fail("attribute " + prefix + name + " is not finite");
  };
  read_number("cal_min", facts.cal_min);
  read_number("cal_max", facts.cal_max);
  read_number("time_step", facts.time_step);
  return facts;
}

}  // namespace tetwarp
