/// @file dicom_stack.hpp
/// Slices of DICOM files as one volume: which belong together, in which order, and where they are.
#pragma once
#include <string>
#include <vector>

#include <tetwarp/volume.hpp>

namespace tetwarp {

/// What DICOM says of one slice: a file, or a frame of a file. Lengths are in mm, positions in LPS.
struct DicomSlice {
  std::string file;
  int frame = 0;       ///< of the file, from 0
  std::string series;  ///< SeriesInstanceUID
  std::string label;   ///< of the series, for messages: its modality and description
  int columns = 0, rows = 0;
  int components = 1;                    ///< SamplesPerPixel
  int bits = 8;                          ///< BitsStored
  bool is_signed = false;                ///< PixelRepresentation
  std::string colors = {};               ///< PhotometricInterpretation
  bool has_table = false;                ///< ModalityLUTSequence, values by a table
  std::vector<double> position = {};     ///< ImagePositionPatient, 3 numbers
  std::vector<double> orientation = {};  ///< ImageOrientationPatient, 6 numbers
  std::vector<double> spacing = {};      ///< PixelSpacing: between rows, between columns
  double thickness = 0;  ///< SpacingBetweenSlices, else SliceThickness; of a single slice
  double slope = 1;      ///< value = slope * stored + intercept
  double intercept = 0;
};

/// A volume of slices.
struct DicomStack {
  Grid grid;  ///< in RAS
  PixelType type = PixelType::int16;
  int components = 1;
  std::vector<DicomSlice> slices;  ///< in the order of k
  std::vector<std::string> notes;  ///< VolumeHeader::notes
};

/// Makes a volume of the slices of a series, sorted by their position along the normal of the
/// first one. Each must lie within 2 % of the mean distance of where equal distances put it. Where
/// they are shifted against each other within their planes (a tilted gantry) the grid is sheared.
///
/// Values are of an integer type where the rescaling keeps integers, else float32, of more than 24
/// bits float64.
/// @param path    the folder, for messages
/// @param series  UID of the series; empty: the only one
/// @throws IoError  no slices, several series, slices that differ or are not equally spaced
DicomStack stack_of(const std::string& path,
                    std::vector<DicomSlice> slices,
                    const std::string& series);

}  // namespace tetwarp
