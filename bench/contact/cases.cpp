#include "bench/contact/cases.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <sstream>

#include <tetwarp/io.hpp>
#include <tetwarp/names.hpp>

#include "host/contact/sweeps/method_names.hpp"
#include "tests/support/contact/contact_scenes.hpp"

namespace tetwarp::bench {
namespace {
/// A packing has four to five contacts per sphere, fewer when small.
ContactInput packing(const std::string& name, const scenes::SpherePacking& choice) {
  return {name, [choice] { return scenes::sphere_packing(choice); }};
}

/// Contacts of one body with all others: as many colors as spheres.
ContactInput tray(std::int64_t edge) {
  return {fmt::format("tray_{}", edge), [edge] { return scenes::tray({.edge = edge}); }};
}

ContactInput large(ContactInput input) {
  input.is_large = true;
  return input;
}

ContactInput stack(const std::string& name, const scenes::BoxStack& choice) {
  return {name, [choice] { return scenes::box_stack(choice); }};
}

/// 10,000 elastic tetrahedra on adhesive contacts, lifted at one end.
ContactInput slab(std::int64_t contacts) {
  return {fmt::format("slab_{}", contacts),
          [contacts] { return scenes::elastic_slab({.contacts = contacts}); }};
}

ContactInput small_slab() {
  return {"slab_small", [] { return scenes::elastic_slab({.cubes = {8, 6, 3}, .contacts = 40}); }};
}

/// Spheres in pairs, held together by ball joints.
ContactInput linked_packing() {
  return {"packing_1k_linked", [] {
            ContactProblem problem = scenes::sphere_packing({.edge = 6});
            scenes::add_ball_joints(problem, 108, 0.05);
            return problem;
          }};
}

ContactInput jam(const std::string& name, const scenes::Jam& choice) {
  return {name, [choice] { return scenes::jam(choice); }};
}

ContactInput lattice(const std::string& name, const scenes::BoxedLattice& choice) {
  return {name, [choice] { return scenes::boxed_lattice(choice); }};
}

std::vector<ContactInput> recorded(const std::string& folders) {
  std::vector<ContactInput> inputs;
  std::istringstream list(folders);
  for (std::string folder; std::getline(list, folder, ':');) {
    for (const auto& file : std::filesystem::directory_iterator(folder)) {
      const std::filesystem::path& path = file.path();
      if (path.extension() != ".hdf5") continue;
      inputs.push_back(
          {path.stem().string(), [text = path.string()] { return read_contact_problem(text); }});
    }
  }
  std::sort(inputs.begin(), inputs.end(),
            [](const ContactInput& a, const ContactInput& b) { return a.name < b.name; });
  return inputs;
}

/// Problems on which single methods differ the most, beside those of contact_inputs().
std::vector<ContactInput> hard_inputs() {
  return {
      stack("stack_6_ratio_3^5", {.boxes = 6, .mass_ratio = 243}),
      stack("stack_20", {.boxes = 20}),
      jam("jam_48", {}),
      jam("jam_150",
          {.seed = 3, .bodies = 30, .contacts = 150, .mass_ratio = 1e4, .friction = 0.5}),
      jam("jam_48_glued", {.glue = {.stiffness = 1e7}}),
      packing("packing_touching_mu_0.3", {.edge = 4, .friction = 0.3, .gaps = 0}),
      packing("packing_touching_mu_0.5", {.edge = 4, .friction = 0.5, .gaps = 0}),
      packing("packing_1k_mu_0.8", {.edge = 6, .friction = 0.8}),
      packing("packing_1k_glued", {.edge = 6, .glue = {.stiffness = 1e7}}),
      linked_packing(),
      lattice("lattice_90", {.edge = 3}),
      lattice("lattice_720_mu_0.5", {.edge = 6, .friction = 0.5}),
      lattice("lattice_1664", {}),
      lattice("lattice_3200", {.edge = 10}),
  };
}

/// A switch of ContactSkipOptions and a scene that has work for it to leave out.
struct SkipChoice {
  ContactInput input;
  std::string without;
  bool ContactSkipOptions::*choice;
  ContactMethod method = ContactMethod::automatic;
};

std::vector<SkipChoice> skip_choices() {
  const ContactInput beside = {"slab_beside_free_slab", [] {
                                 return scenes::beside(
                                     scenes::elastic_slab({.cubes = {8, 6, 3}, .contacts = 40}),
                                     scenes::elastic_slab({.cubes = {24, 6, 3}, .contacts = 0}));
                               }};
  return {
      {packing("packing_1k_frictionless", {.edge = 6, .friction = 0}), "frictionless_rows",
       &ContactSkipOptions::frictionless_rows},
      {packing("packing_1k_debonded", {.edge = 6, .glue = {.stiffness = 1e7, .intensity = 0}}),
       "debonded_springs", &ContactSkipOptions::debonded_springs},
      {beside, "contactless_bodies", &ContactSkipOptions::contactless_bodies},
      {packing("packing_1k_loose", {.edge = 9, .kept = 0.15}), "converged_islands",
       &ContactSkipOptions::converged_islands},
      {packing("packing_1k", {.edge = 6}), "frozen_contacts", &ContactSkipOptions::frozen_contacts,
       ContactMethod::gauss_seidel},
  };
}

/// Methods of the command.
constexpr ContactMethod methods[] = {ContactMethod::gauss_seidel, ContactMethod::nonlinear_cg,
                                     ContactMethod::anderson, ContactMethod::newton,
                                     ContactMethod::automatic};

std::vector<double> tolerances(Extent extent, ContactPrecision precision) {
  if (precision == ContactPrecision::float32) {
    if (extent == Extent::brief) return {1e-2, 1e-4};
    return {1e-2, 1e-3, 1e-4, 1e-5};
  }
  if (extent == Extent::brief) return {1e-2, 1e-4, 1e-8};
  return {1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10};
}

class Rows {
 public:
  Rows(Extent extent, int threads) : extent_(extent), threads_(threads) {}

  /// Every method, precision and tolerance; large problems in the brief list only by quick methods.
  void add_work(const ContactInput& input) {
    for (const ContactMethod method : methods) {
      for (const auto precision : {ContactPrecision::float64, ContactPrecision::float32}) {
        const bool is_tried = is_quick(method) && precision == ContactPrecision::float64;
        if (input.is_large && extent_ == Extent::brief && !is_tried) continue;
        for (const double tolerance : tolerances(extent_, precision)) {
          ContactOptions options = options_for(tolerance);
          options.method = method;
          options.precision = precision;
          add({.input = input, .options = options});
        }
      }
    }
  }

  /// First solve, following solves, and following solves that start from the last impulses.
  void add_visits(const ContactInput& input) {
    ContactOptions options = options_for(1e-4);
    for (const int threads : thread_counts()) {
      options.threads = threads;
      for (const auto visit : {ContactVisit::first, ContactVisit::kept, ContactVisit::warm}) {
        // add_work() has this row in the full list.
        if (extent_ == Extent::full && visit == ContactVisit::first && threads == threads_)
          continue;
        add({.input = input, .options = options, .visit = visit});
      }
    }
  }

  void add_couplings(const ContactInput& input) {
    for (const double tolerance : {1e-4, 1e-8}) {
      ContactOptions options = options_for(tolerance);
      for (const auto coupling : {ContactCoupling::iterated, ContactCoupling::condensed}) {
        options.expert.coupling = coupling;
        for (const auto visit : {ContactVisit::first, ContactVisit::kept}) {
          add({.kind = ContactKind::coupling, .input = input, .options = options, .visit = visit});
        }
      }
    }
  }

  void add_skip(const SkipChoice& choice) {
    ContactOptions options = options_for(1e-6);
    options.method = choice.method;
    add({.kind = ContactKind::skip, .input = choice.input, .options = options});
    options.expert.skip.*choice.choice = false;
    add({.kind = ContactKind::skip,
         .input = choice.input,
         .options = options,
         .without = choice.without});
  }

  void add_scale(const ContactInput& input) {
    ContactOptions options = options_for(1e-4);
    for (const ContactMethod method : {ContactMethod::gauss_seidel, ContactMethod::automatic}) {
      options.method = method;
      for (const int threads : thread_counts()) {
        options.threads = threads;
        add({.kind = ContactKind::scale, .input = input, .options = options});
      }
    }
  }

  /// The methods that have stages on a device, on the device: the first and the following solves.
  void add_device(const ContactInput& input) {
    ContactOptions options = options_for(1e-4);
    options.backend = Backend::cuda;
    for (const auto precision : {ContactPrecision::float64, ContactPrecision::float32}) {
      options.precision = precision;
      for (const ContactMethod method : {ContactMethod::gauss_seidel, ContactMethod::anderson}) {
        options.method = method;
        for (const auto visit : {ContactVisit::first, ContactVisit::kept}) {
          add({.input = input, .options = options, .visit = visit});
        }
      }
    }
  }

  /// Every method of the command on one thread, with both rules where springs differ by them.
  void add_methods(const ContactInput& input) {
    for (const AdhesionRule rule : {AdhesionRule::parallel, AdhesionRule::restrictive}) {
      for (const ContactMethod method : methods) {
        for (const double tolerance : {1e-4, 1e-6}) {
          ContactOptions options = options_for(tolerance);
          options.rule = rule;
          options.method = method;
          options.threads = 1;
          options.max_newton = 400;
          rows_.push_back({.kind = ContactKind::method,
                           .input = input,
                           .options = options,
                           .max_updates = 100'000'000});
        }
      }
    }
  }

  std::vector<ContactCase> take() { return std::move(rows_); }

 private:
  static bool is_quick(ContactMethod method) {
    return method == ContactMethod::automatic || method == ContactMethod::gauss_seidel ||
           method == ContactMethod::anderson;
  }
  std::vector<int> thread_counts() const {
    return threads_ > 1 ? std::vector<int>{1, threads_} : std::vector<int>{1};
  }
  void add(ContactCase row) {
    row.max_updates = extent_ == Extent::full ? 200'000'000 : 1'000'000;
    rows_.push_back(std::move(row));
  }
  ContactOptions options_for(double tolerance) const {
    return {.tolerance = tolerance, .backend = Backend::cpu, .threads = threads_};
  }

  Extent extent_;
  int threads_;
  std::vector<ContactCase> rows_;
};

/// Words of row names. They are spelled out, unlike the command's words (tetwarp/names.hpp).
const char* word_of(ContactVisit visit) {
  static constexpr const char* words[] = {"first", "kept", "warm"};
  return words[static_cast<int>(visit)];
}

const char* word_of(ContactKind kind) {
  static constexpr const char* words[] = {"contact", "contact_skip", "contact_scale",
                                          "contact_coupling", "contact_method"};
  return words[static_cast<int>(kind)];
}

const char* word_of(ContactPrecision precision) {
  return precision == ContactPrecision::float64 ? "float64" : "float32";
}
}  // namespace

std::string name_of(const ContactCase& row) {
  const ContactOptions& options = row.options;
  const std::string place =
      options.backend == Backend::cuda ? "cuda" : fmt::format("cpu/threads:{}", options.threads);
  std::string name = fmt::format("{}/{}/{}/{}/{}/tolerance:{:.0e}", word_of(row.kind),
                                 row.input.name, report_name_of(options.method),
                                 word_of(options.precision), place, options.tolerance);
  if (row.visit != ContactVisit::first) name += fmt::format("/visit:{}", word_of(row.visit));
  if (!row.without.empty()) name += "/without:" + row.without;
  if (options.expert.coupling != ContactCoupling::automatic) {
    name += fmt::format("/coupling:{}", tetwarp::name_of(options.expert.coupling));
  }
  if (options.rule != AdhesionRule::parallel) name += "/rule:restrictive";
  return name;
}

std::vector<ContactInput> contact_inputs(Extent extent, const std::string& folders) {
  std::vector<ContactInput> inputs = {
      stack("stack_10", {.boxes = 10}),
      packing("packing_1k", {.edge = 6}),
      packing("packing_10k", {.edge = 13}),
      large(packing("packing_100k", {.edge = 28})),
      small_slab(),
  };
  if (extent == Extent::full) {
    inputs.push_back(stack("stack_30_ratio_1e4", {.boxes = 30, .mass_ratio = 1e4}));
    inputs.push_back(stack("stack_100", {.boxes = 100}));
    inputs.push_back(packing("packing_10k_glued", {.edge = 13, .glue = {.stiffness = 1e7}}));
    inputs.push_back(slab(151));
    inputs.push_back(slab(531));
  }
  for (ContactInput& input : recorded(folders)) inputs.push_back(std::move(input));
  return inputs;
}

std::vector<ContactCase> contact_cases(Extent extent,
                                       int threads,
                                       const std::string& folders,
                                       bool with_cuda) {
  Rows rows(extent, threads);
  for (const ContactInput& input : contact_inputs(extent, folders)) rows.add_work(input);
  for (const std::int64_t contacts : {151, 531}) {
    rows.add_visits(slab(contacts));
    rows.add_couplings(slab(contacts));
  }
  for (const SkipChoice& choice : skip_choices()) rows.add_skip(choice);
  for (const std::int64_t edge : {3, 4, 6, 9, 13, 19, 28}) {
    rows.add_scale(packing(fmt::format("packing_edge_{}", edge), {.edge = edge}));
  }
  for (const std::int64_t edge : {32, 64, 128}) rows.add_scale(tray(edge));
  if (extent == Extent::full) {
    for (const ContactInput& input : contact_inputs(extent, folders)) rows.add_methods(input);
    for (const ContactInput& input : hard_inputs()) rows.add_methods(input);
  }
  if (!with_cuda) return rows.take();
  for (const ContactInput& input : contact_inputs(Extent::brief, folders)) {
    rows.add_device(input);
  }
  rows.add_device(slab(531));
  rows.add_device(tray(64));
  return rows.take();
}

}  // namespace tetwarp::bench
