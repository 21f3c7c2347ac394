/// @file chart.hpp
/// Curves over steps as a drawing in SVG.
#pragma once
#include <array>
#include <string>
#include <vector>

namespace tetwarp::cli {

/// Numbers at equal distances along the horizontal axis.
struct Curve {
  std::string name;
  std::vector<double> values;  ///< those that are not finite are left out
};

/// A row of plots with one vertical axis, and the same curves in each.
struct ChartRow {
  std::string title;                        ///< along the vertical axis
  std::vector<std::vector<Curve>> columns;  ///< one per run; all have the same names in one order
};

/// A column of plots with the abscissas of its curves.
struct ChartColumn {
  std::string title;
  double first = 0;  ///< where its first value is
  double step = 1;   ///< from value to value, > 0
};

struct Chart {
  std::string x_title;  ///< along the horizontal axis
  std::vector<ChartColumn> columns;
  std::vector<ChartRow> rows;
};

/// Ticks at multiples of 1, 2 or 5 times a power of ten within a range, at most seven.
std::vector<double> chart_ticks(double low, double high);

/// Where a curve is drawn in `width` pixels: of values of one pixel the first, least, largest and
/// last, in their order, so that no peak is lost.
/// @param first, step  as of ChartColumn
/// @param low, high    the range of the horizontal axis
/// @returns pairs of place [pixel] and value; NaN where the curve is interrupted
std::vector<std::array<double, 2>> chart_points(const std::vector<double>& values,
                                                double first,
                                                double step,
                                                double low,
                                                double high,
                                                int width);

/// The drawing: one plot per row and column. Plots of a row have one vertical range, all plots one
/// horizontal range.
/// @pre every row has as many columns as the chart, one at least
std::string draw_chart(const Chart& chart);

}  // namespace tetwarp::cli
