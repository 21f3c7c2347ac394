/// @file cases.hpp
/// The rows of the contact benchmark, as data.
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <tetwarp/contact.hpp>

#include "bench/measure/program.hpp"

namespace tetwarp::bench {

/// A problem by name, made when its first row runs.
struct ContactInput {
  std::string name;
  std::function<ContactProblem()> make;
  bool is_large = false;  ///< most methods take minutes
};

/// What a row measures.
enum class ContactKind {
  work,      ///< time to one tolerance, by one method
  skip,      ///< with one switch of ContactSkipOptions off, and with all switches on
  scale,     ///< problems of one kind, smaller and larger
  coupling,  ///< elastic bodies, iterated and condensed
  method,    ///< processor time of every method on one thread, by eta
};

/// Which solve of a solver is timed.
enum class ContactVisit {
  first,  ///< of a new solver: buffers, structure and all
  kept,   ///< of a solver that has solved the same structure; loads alternate by one percent
  warm    ///< as kept, starting from the impulses of the solve before
};

/// One timed solve.
struct ContactCase {
  ContactKind kind = ContactKind::work;
  ContactInput input;
  ContactOptions options;  ///< measure and max_sweeps follow from the problem
  ContactVisit visit = ContactVisit::first;
  std::int64_t max_updates = 0;  ///< largest number of local solves, which bounds the time
  std::string without = {};      ///< name of the switch that is off, or empty
};

/// contact/packing_1k/anderson/float64/cpu/threads:2/tolerance:1e-04, on a device cuda instead of
/// cpu/threads:2; other kinds are contact_skip,
/// contact_scale, contact_coupling and contact_method; then, where not the default, /visit:kept,
/// /without:frozen_contacts, /coupling:condensed and /rule:restrictive.
std::string name_of(const ContactCase& row);

/// Problems of all methods: stacks, packings, elastic blocks, then those of the folders.
/// @param folders  of recorded problems, *.hdf5, with colons between them; empty: none
std::vector<ContactInput> contact_inputs(Extent extent, const std::string& folders);

/// The rows for a processor with `threads` threads, those of one problem next to each other, loose
/// tolerances first.
/// @param folders    as in contact_inputs()
/// @param with_cuda  adds rows of back end cuda
std::vector<ContactCase> contact_cases(Extent extent,
                                       int threads,
                                       const std::string& folders,
                                       bool with_cuda = false);

}  // namespace tetwarp::bench
