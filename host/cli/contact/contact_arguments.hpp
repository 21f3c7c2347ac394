/// @file contact_arguments.hpp
/// The arguments of `tetwarp contact`.
#pragma once
#include <CLI/CLI.hpp>
#include <string>

#include <tetwarp/contact.hpp>
#include <tetwarp/io.hpp>

namespace tetwarp::cli {

/// Their syntax is checked; files are not read.
struct ContactArguments {
  std::string problem;
  std::string output;
  ContactOptions options;
  ContactStart start = ContactStart::zero;
  bool evolve = false;
  bool modes = false;   ///< also write mode and residual of each contact
  bool energy = false;  ///< also report the balance of energy
  std::string report;
  bool quiet = false;
};

/// Declares every option and binds it to `arguments`, which must outlive `app`.
void declare_contact_options(CLI::App& app, ContactArguments& arguments);

}  // namespace tetwarp::cli
