/// @file report.cpp
/// The report of a solve as JSON.
#include <nlohmann/json.hpp>
#include <tetwarp/contact.hpp>

namespace tetwarp {

std::string to_json(const ContactReport& report) {
  const ContactResidual& residual = report.residual;
  const nlohmann::ordered_json json = {{"version", report.version},
                                       {"backend", name_of(report.backend)},
                                       {"device", report.device},
                                       {"threads", report.threads},
                                       {"method", report.method},
                                       {"converged", report.status == ContactStatus::converged},
                                       {"status", name_of(report.status)},
                                       {"status_reason", report.status_reason},
                                       {"contacts", report.contacts},
                                       {"bilateral_rows", report.bilateral_rows},
                                       {"rolling_contacts", report.rolling_contacts},
                                       {"colors", report.colors},
                                       {"islands", report.islands},
                                       {"outer_iterations", report.outer_iterations},
                                       {"sweeps", report.sweeps},
                                       {"multiplier_steps", report.multiplier_steps},
                                       {"newton_iterations", report.newton_iterations},
                                       {"contact_updates", report.contact_updates},
                                       {"residual", residual.eta},
                                       {"fclib_error", residual.fclib},
                                       {"largest_contact_residual", residual.largest},
                                       {"largest_contact", residual.largest_contact},
                                       {"penetration", residual.penetration},
                                       {"balance", residual.balance},
                                       {"residual_history", report.residual_history},
                                       {"rows_skipped", report.rows_skipped},
                                       {"springs_skipped", report.springs_skipped},
                                       {"bodies_skipped", report.bodies_skipped},
                                       {"islands_stopped", report.islands_stopped},
                                       {"updates_skipped", report.updates_skipped},
                                       {"condensations_kept", report.condensations_kept},
                                       {"timings",
                                        {{"setup", report.setup_seconds},
                                         {"solve", report.solve_seconds},
                                         {"total", report.total_seconds}}}};
  return json.dump(2);
}

}  // namespace tetwarp
