/// @file declare.cpp
/// Usage lines, validators and texts.
#include "host/cli/common/declare.hpp"

#include <fmt/format.h>

#include <cctype>
#include <charconv>
#include <cmath>
#include <memory>
#include <system_error>

namespace tetwarp::cli {
namespace {
/// The help of CLI11 with a given usage line: that of CLI11 cannot express "VOLUME... MESH".
class UsageFormatter : public CLI::Formatter {
 public:
  explicit UsageFormatter(std::string synopsis) : synopsis_(std::move(synopsis)) {
    column_width(34);
  }

  std::string make_usage(const CLI::App* app, std::string name) const override {
    // For --help CLI11 passes the names of the command and its parents, else nothing.
    return "Usage: " + (name.empty() ? "tetwarp " + app->get_name() : name) + " " + synopsis_ +
           "\n";
  }

 private:
  std::string synopsis_;
};

/// @param range  the accepted numbers in words, for the message
CLI::Validator whole_number(std::int64_t low, std::int64_t high, const std::string& range) {
  const auto check = [=](const std::string& text) -> std::string {
    std::int64_t number = 0;
    const char* const end = text.data() + text.size();
    const auto [past, error] = std::from_chars(text.data(), end, number);
    const bool is_whole = past == end && !text.empty();
    if (is_whole && error == std::errc() && number >= low && number <= high) return {};
    const bool is_large =
        is_whole && text.front() != '-' && (error != std::errc() || number > high);
    return is_large ? fmt::format("'{}' is above {}", text, high)
                    : fmt::format("'{}' is not a whole number {}", text, range);
  };
  return {check, ""};
}
}  // namespace

void add_quiet(CLI::App& app, bool& is_quiet) {
  app.add_flag("--quiet", is_quiet, "print nothing but errors");
}

CLI::Option* add_series(CLI::App& app, std::string& series, const std::string& option) {
  const std::string whose = option == "--like-series" ? " that --like names" : "";
  return app
      .add_option(
          option, series,
          "of a folder of DICOM images" + whose + ": UID of the series to read [the only one]")
      ->type_name("UID");
}

CLI::App* add_subcommand(CLI::App& app,
                         const std::string& name,
                         const std::string& description,
                         const std::string& synopsis,
                         const std::string& examples) {
  CLI::App* command = app.add_subcommand(name, description);
  command->formatter(std::make_shared<UsageFormatter>(synopsis));
  command->footer("Example:\n" + examples);
  return command;
}

void check_device(const CLI::App& app, Backend backend) {
  if (app.get_option("--device")->count() == 0) return;
  if (backend == Backend::automatic || backend == Backend::cuda) return;
  throw CLI::ValidationError(
      "--device", std::string("is of cuda, --backend is ") + name_of(backend) + "; leave out one");
}

std::string one_line(const std::string& text) {
  std::string line;
  for (std::size_t i = 0; i < text.size();) {
    std::size_t end = i;
    bool breaks = false;
    while (end < text.size() && std::isspace(static_cast<unsigned char>(text[end])) != 0) {
      breaks = breaks || text[end] == '\n';
      ++end;
    }
    if (end == i) {
      line += text[i++];
    } else {
      if (end < text.size() && !line.empty()) line += breaks ? "; " : " ";
      i = end;
    }
  }
  return line;
}

std::string listed(const std::vector<std::string>& words) {
  return CLI::detail::join(words, ", ");
}

CLI::Validator between(std::int64_t low, std::int64_t high) {
  return whole_number(low, high, fmt::format("from {} to {}", low, high));
}

CLI::Validator at_least(std::int64_t low, std::int64_t high) {
  return whole_number(low, high, fmt::format("of {} or more", low));
}

CLI::Validator above_zero() {
  const auto check = [](const std::string& text) -> std::string {
    double number = 0;
    if (CLI::detail::lexical_cast(text, number) && number > 0) return {};
    return "'" + text + "' is not a number above 0";
  };
  return {check, ""};
}

CLI::Validator finite_number() {
  const auto check = [](const std::string& text) -> std::string {
    double number = 0;
    if (CLI::detail::lexical_cast(text, number) && std::isfinite(number)) return {};
    return "'" + text + "' is not a finite number";
  };
  return {check, ""};
}

CLI::Validator representable_number() {
  const auto check = [](const std::string& text) -> std::string {
    double number = 0;
    const bool is_number = CLI::detail::lexical_cast(text, number);
    const bool is_word = text.find_first_of("iI") != std::string::npos;
    if (is_number && (is_word || !std::isinf(number))) return {};
    return "'" + text + (is_number ? "' is beyond the numbers of float64" : "' is not a number");
  };
  return {check, ""};
}

}  // namespace tetwarp::cli
