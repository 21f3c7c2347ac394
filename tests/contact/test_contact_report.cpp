#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <tetwarp/contact.hpp>

#include "tests/support/json_names.hpp"

namespace tetwarp::test {
namespace {
using Json = nlohmann::json;

/// A report whose numbers all differ, in the order of its fields.
ContactReport counting_report() {
  ContactReport report;
  report.version = "1.2.3";
  report.backend = Backend::reference;
  report.device = "a processor";
  report.method = "anderson, newton";
  report.status = ContactStatus::not_converged;
  report.status_reason = "out of sweeps";
  std::int64_t next = 1;
  report.threads = static_cast<int>(next++);
  for (std::int64_t ContactReport::*count :
       {&ContactReport::contacts, &ContactReport::colors, &ContactReport::islands,
        &ContactReport::outer_iterations, &ContactReport::sweeps, &ContactReport::multiplier_steps,
        &ContactReport::newton_iterations, &ContactReport::contact_updates,
        &ContactReport::rows_skipped, &ContactReport::springs_skipped,
        &ContactReport::bodies_skipped, &ContactReport::islands_stopped,
        &ContactReport::updates_skipped, &ContactReport::condensations_kept}) {
    report.*count = next++;
  }
  report.residual = {0.5, 0.25, 0.125, 7, 0.0625, 0.03125};
  report.residual_history = {1, 0.75, 0.5};
  report.setup_seconds = 2.5;
  report.solve_seconds = 3.5;
  report.total_seconds = 6.25;
  return report;
}

/// The names are stable.
TEST(ContactReport, HasExactlyTheNamesOfTheInterface) {
  const Json json = Json::parse(to_json(counting_report()));

  EXPECT_EQ(names_of(json), (std::set<std::string>{"version",
                                                   "backend",
                                                   "device",
                                                   "threads",
                                                   "method",
                                                   "converged",
                                                   "status",
                                                   "status_reason",
                                                   "contacts",
                                                   "bilateral_rows",
                                                   "rolling_contacts",
                                                   "colors",
                                                   "islands",
                                                   "outer_iterations",
                                                   "sweeps",
                                                   "multiplier_steps",
                                                   "newton_iterations",
                                                   "contact_updates",
                                                   "residual",
                                                   "fclib_error",
                                                   "largest_contact_residual",
                                                   "largest_contact",
                                                   "penetration",
                                                   "balance",
                                                   "residual_history",
                                                   "rows_skipped",
                                                   "springs_skipped",
                                                   "bodies_skipped",
                                                   "islands_stopped",
                                                   "updates_skipped",
                                                   "condensations_kept",
                                                   "timings"}));
  EXPECT_EQ(names_of(json["timings"]), (std::set<std::string>{"setup", "solve", "total"}));
}

/// Each field is in the entry of its name; all values differ.
TEST(ContactReport, MixesUpNoField) {
  const Json json = Json::parse(to_json(counting_report()));

  std::int64_t value = 1;
  for (const char* name : {"threads", "contacts", "colors", "islands", "outer_iterations", "sweeps",
                           "multiplier_steps", "newton_iterations", "contact_updates",
                           "rows_skipped", "springs_skipped", "bodies_skipped", "islands_stopped",
                           "updates_skipped", "condensations_kept"}) {
    EXPECT_EQ(json[name], value++) << name;
  }
  double residual = 1;
  for (const char* name :
       {"residual", "fclib_error", "largest_contact_residual", "penetration", "balance"}) {
    EXPECT_EQ(json[name], residual /= 2) << name;
  }
  EXPECT_EQ(json["largest_contact"], 7);
  EXPECT_EQ(json["residual_history"], (std::vector<double>{1, 0.75, 0.5}));
  EXPECT_EQ(json["timings"]["setup"], 2.5);
  EXPECT_EQ(json["timings"]["solve"], 3.5);
  EXPECT_EQ(json["timings"]["total"], 6.25);
}

TEST(ContactReport, NamesWhatRanAndHowItEnded) {
  const Json json = Json::parse(to_json(counting_report()));

  EXPECT_EQ(json["version"], "1.2.3");
  EXPECT_EQ(json["backend"], "reference");
  EXPECT_EQ(json["device"], "a processor");
  EXPECT_EQ(json["method"], "anderson, newton");
  EXPECT_EQ(json["converged"], false);
  EXPECT_EQ(json["status"], "not converged");
  EXPECT_EQ(json["status_reason"], "out of sweeps");
}

TEST(ContactReport, IsConvergedForThatStatusOnly) {
  ContactReport report;
  for (const ContactStatus status :
       {ContactStatus::converged, ContactStatus::not_converged, ContactStatus::infeasible}) {
    report.status = status;

    const Json json = Json::parse(to_json(report));

    EXPECT_EQ(json["converged"], status == ContactStatus::converged);
    EXPECT_EQ(json["status"], name_of(status));
  }
}

TEST(ContactReport, StaysJsonWhenAResidualIsNotFinite) {
  ContactReport report;
  report.residual.eta = std::numeric_limits<double>::quiet_NaN();

  EXPECT_TRUE(Json::parse(to_json(report))["residual"].is_null());
}

TEST(ContactReport, NamesTheStatuses) {
  EXPECT_STREQ(name_of(ContactStatus::converged), "converged");
  EXPECT_STREQ(name_of(ContactStatus::not_converged), "not converged");
  EXPECT_STREQ(name_of(ContactStatus::infeasible), "infeasible");
}
}  // namespace
}  // namespace tetwarp::test
