/// @file nifti_facts.hpp
/// Facts of a NIfTI header as attributes of a VTKHDF dataset.
#pragma once
#include <optional>

#include <tetwarp/nifti.hpp>

#include "io/h5/h5.hpp"

namespace tetwarp {

/// Writes the attributes `tetwarp_nifti_...`; empty texts are left out.
void write_fact_attributes(const h5::Object& dataset, const NiftiFacts& facts);

/// Reads them; nothing when the dataset has none. Throws IoError on values that NIfTI cannot hold.
std::optional<NiftiFacts> read_fact_attributes(const h5::Object& dataset);

}  // namespace tetwarp
