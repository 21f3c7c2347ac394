/// @file text_points.hpp
/// Points as lines of text: tables (.csv, .tsv, .txt) and landmarks of 3D Slicer (.fcsv).
#pragma once
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/points/point_document.hpp"

namespace tetwarp {

class TextPoints : public PointDocument {
 public:
  /// @throws IoError  as PointFile
  TextPoints(const std::string& path, Axes axes);

  const std::vector<Point3>& points() const override { return points_; }
  bool takes_axes() const override { return !names_axes_; }
  std::vector<std::string> output_extensions() const override;
  std::string write(const std::string& path, const PlacedPoints& placed) const override;

 private:
  struct Field {
    std::size_t begin, end;  // in the text
  };
  struct Line {
    std::size_t begin, end;  // without the end of the line
    bool is_point;
  };

  std::vector<Field> fields_of(const Line& line) const;
  std::string name_in(const Field& field) const;
  std::optional<double> number_in(const Field& field) const;
  [[noreturn]] void fail(const Line& line, const std::string& problem) const;

  void split_lines();
  void read_comment(const Line& line);
  void choose_separator(const Line& line);
  bool set_columns(const std::vector<std::string>& names);
  void read_first(Line& line);
  void read_point(const Line& line);

  std::string path_;
  std::string text_;
  bool is_slicer_;
  char separator_ = ',';
  Axes axes_;
  bool names_axes_ = false;
  std::vector<Line> lines_;
  std::size_t names_line_ = 0;                   // of the columns; lines_.size(): there is none
  std::size_t column_count_ = 0;                 // 0: lines may differ
  std::array<std::size_t, 3> columns_{0, 1, 2};  // of the position
  std::optional<std::size_t> inside_column_;
  std::vector<Point3> points_;
};

}  // namespace tetwarp
