/// @file report_fields.hpp
/// The members of Timings and Counts with their names in reports: the list that sums, JSON and the
/// exchange between processes use.
#pragma once
#include <cstdint>
#include <iterator>

#include <tetwarp/report.hpp>

namespace tetwarp {

template <class Record, class Number>
struct ReportField {
  const char* name;  ///< in the JSON
  Number Record::*member;
};

inline constexpr ReportField<Timings, double> timing_fields[] = {
    {"read", &Timings::read},     {"upload", &Timings::upload},     {"setup", &Timings::setup},
    {"mask", &Timings::mask},     {"cull", &Timings::cull},         {"raster", &Timings::raster},
    {"fields", &Timings::fields}, {"download", &Timings::download}, {"write", &Timings::write},
    {"total", &Timings::total}};

inline constexpr ReportField<Counts, std::int64_t> count_fields[] = {
    {"voxels", &Counts::voxels},
    {"covered", &Counts::covered},
    {"outside", &Counts::outside},
    {"tetrahedra", &Counts::tetrahedra},
    {"inverted", &Counts::inverted},
    {"flat", &Counts::flat},
    {"folded", &Counts::folded},
    {"cells", &Counts::cells},
    {"candidate_pairs", &Counts::candidate_pairs},
    {"pairs_rejected", &Counts::pairs_rejected},
    {"pairs_accepted", &Counts::pairs_accepted},
    {"pairs_partial", &Counts::pairs_partial},
    {"inside_tests", &Counts::inside_tests},
    {"exact_tests", &Counts::exact_tests},
    {"steps_unchanged", &Counts::steps_unchanged},
    {"tets_unchanged", &Counts::tets_unchanged},
    {"cells_unchanged", &Counts::cells_unchanged},
    {"cells_constant", &Counts::cells_constant},
    {"voxels_copied", &Counts::voxels_copied},
    {"voxels_straightened", &Counts::voxels_straightened},
    {"chunks_background", &Counts::chunks_background},
    {"tets_averaged", &Counts::tets_averaged},
    {"values_clipped", &Counts::values_clipped},
    {"blocks", &Counts::blocks},
    {"bytes_read", &Counts::bytes_read},
    {"bytes_written", &Counts::bytes_written}};

static_assert(sizeof(Timings) == sizeof(double) * std::size(timing_fields), "a timing is missing");
static_assert(sizeof(Counts) == sizeof(std::int64_t) * std::size(count_fields),
              "a count is missing");

}  // namespace tetwarp
