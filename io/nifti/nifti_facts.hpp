/// @file nifti_facts.hpp
/// What a NIfTI header can hold, and its facts as attributes of a VTKHDF dataset.
#pragma once
#include <optional>
#include <string>

#include <tetwarp/nifti.hpp>

#include "io/h5/h5.hpp"

namespace tetwarp {

/// Which fact a NIfTI header cannot hold, and why; empty: it holds all.
std::string facts_problem(const NiftiFacts& facts);

/// Writes the attributes `tetwarp_nifti_...`; empty texts are left out.
/// @throws IoError  see facts_problem()
void write_fact_attributes(const h5::Object& dataset, const NiftiFacts& facts);

/// Reads them; nothing when the dataset has none. Throws IoError on values that NIfTI cannot hold.
std::optional<NiftiFacts> read_fact_attributes(const h5::Object& dataset);

}  // namespace tetwarp
