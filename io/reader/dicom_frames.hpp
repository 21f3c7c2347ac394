/// @file dicom_frames.hpp
/// Frames of DICOM files that hold several: dose grids, and enhanced images.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include <gdcmDataSet.h>

#include "io/image/dicom_stack.hpp"

namespace tetwarp {

/// The numbers of an attribute of decimal strings; none if it is not there or one is no number.
std::vector<double> decimals_of(const gdcm::DataSet& attributes,
                                std::uint16_t group,
                                std::uint16_t element);

/// Numbers between backslashes; none where one is no number.
std::vector<double> decimals_in(const std::string& text);

/// The slices of the frames of a dose grid (RTDOSE), which lie along the normal, or of an enhanced
/// image (CT, MR, PET), whose functional groups place each frame. Of other files of one frame, that
/// frame.
/// @param first   what all frames have in common
/// @param frames  at least 1
/// @throws IoError for other files of several frames
std::vector<DicomSlice> slices_of_frames(const gdcm::DataSet& attributes,
                                         const DicomSlice& first,
                                         int frames);

}  // namespace tetwarp
