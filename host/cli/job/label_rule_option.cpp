/// @file label_rule_option.cpp
/// Reads a rule for labels and the numbers behind it.
#include "host/cli/job/label_rule_option.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include "host/cli/common/declare.hpp"

namespace tetwarp::cli {
namespace {
void set_label_rule(const std::string& text, WarpOptions& warp) {
  std::vector<std::string> parts = CLI::detail::split(text, ':');
  warp.label_rule = meaning_of("--label-rule", parts.front(), choices_of<LabelRule>());
  const bool is_gaussian = warp.label_rule == LabelRule::gaussian;
  if (parts.size() > 1 && !is_gaussian) {
    throw CLI::ValidationError("--label-rule", "only gaussian takes numbers");
  }
  if (parts.size() > 3) {
    throw CLI::ValidationError("--label-rule", "expected gaussian:SIGMA:CUTOFF, got " + text);
  }
  double* const numbers[] = {&warp.label_gaussian.sigma, &warp.label_gaussian.cutoff};
  for (std::size_t n = 1; n < parts.size(); ++n) {
    double& number = *numbers[n - 1];
    if (!CLI::detail::lexical_cast(parts[n], number) || !(number > 0)) {
      throw CLI::ValidationError("--label-rule", "'" + parts[n] + "' is not a number above 0");
    }
  }
}
}  // namespace

void declare_label_rule(CLI::App& app, WarpOptions& warp) {
  app.add_option_function<std::string>(
         "--label-rule", [&warp](const std::string& text) { set_label_rule(text, warp); },
         "with --filter labels, the label of most weight at the voxel's center, of most volume in "
         "its box (for larger voxels, meshes that shrink), or of most Gaussian weight as in ITK, "
         "with SIGMA in source voxels and a cutoff in sigmas [linear; of gaussian 1:1]")
      ->type_name("linear|volume|gaussian[:SIGMA[:CUTOFF]]");
}

void check_label_rule(const WarpOptions& warp) {
  if (warp.label_rule == LabelRule::linear) return;
  const std::string rule = name_of(warp.label_rule);
  if (warp.filter != Filter::labels) {
    throw CLI::ValidationError("--label-rule", rule + " is for --filter labels; add it");
  }
  if (warp.label_rule == LabelRule::volume && warp.outside != Outside::background) {
    throw CLI::ValidationError("--outside",
                               "--label-rule volume knows labels in the mesh alone; leave it out");
  }
  if (extends(warp.outside)) {
    throw CLI::ValidationError("--outside",
                               "with --label-rule gaussian it is background or identity");
  }
}

}  // namespace tetwarp::cli
