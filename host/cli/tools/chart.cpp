/// @file chart.cpp
/// Layout of plots, their axes, and lines in SVG.
#include "host/cli/tools/chart.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>

#include "io/files/xml_text.hpp"

namespace tetwarp::cli {
namespace {
constexpr int plot_width = 400, plot_height = 150;  // [pixel], as all lengths below
constexpr int margin = 4;                           // between the extremes of curves and the frame
constexpr int left = 84, top = 34, gap = 26, legend_width = 130, foot = 44;
constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
/// Colors that stay distinct under color blindness (Okabe and Ito 2008).
constexpr std::array<const char*, 8> colors{"#000000", "#e69f00", "#56b4e9", "#009e73",
                                            "#d55e00", "#0072b2", "#cc79a7", "#999933"};

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void add(double value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }

  /// With an extent, also of nothing and of a single value, both ends at most half the largest
  /// number, so that differences are finite.
  void widen() {
    if (low > high) low = high = 0;
    constexpr double most = std::numeric_limits<double>::max() / 4;
    low = std::clamp(low, -most, most);
    high = std::clamp(high, -most, most);
    constexpr double least = 1e-250;  // smaller numbers are drawn as 0
    const double size = std::max(std::abs(low), std::abs(high));
    if (size > least && high - low > 1e-12 * size) return;
    const double half = size > least ? size / 2 : 0.5;
    low -= half;
    high += half;
  }
};

/// The significant digits by which ticks differ, at least 6.
int tick_digits(const std::vector<double>& ticks) {
  constexpr int least = 6, most = 17;  // a double has no more
  if (ticks.size() < 2) return least;
  const double size = std::max(std::abs(ticks.front()), std::abs(ticks.back()));
  const double digits = std::floor(std::log10(size / (ticks[1] - ticks[0]))) + 2;
  return static_cast<int>(std::clamp<double>(digits, least, most));
}

std::string text_at(double x, double y, const std::string& text, const char* more = "") {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\"{}>{}</text>\n", x, y, more, xml_text(text));
}

std::string line_style(std::size_t index) {
  static constexpr std::array<const char*, 3> dashes{"", " stroke-dasharray=\"6,3\"",
                                                     " stroke-dasharray=\"2,2\""};
  return fmt::format("stroke=\"{}\"{}", colors[index % colors.size()],
                     dashes[index / colors.size() % dashes.size()]);
}

/// A drawing in which each plot of the grid has the same size.
class Drawing {
 public:
  explicit Drawing(const Chart& chart) : chart_(chart) {
    for (std::size_t c = 0; c < chart.columns.size(); ++c) {
      const ChartColumn& column = chart.columns[c];
      x_.add(column.first);
      for (const ChartRow& row : chart.rows) {
        for (const Curve& curve : row.columns[c]) {
          x_.add(column.first + column.step * (static_cast<double>(curve.values.size()) - 1));
        }
      }
    }
    x_.widen();
  }

  std::string draw() {
    const auto rows = static_cast<int>(chart_.rows.size());
    const int width =
        left + static_cast<int>(chart_.columns.size()) * (plot_width + gap) + legend_width;
    const int height = top + rows * (plot_height + gap) + foot - gap;
    out_ = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} "
        "{1}\" font-family=\"sans-serif\" font-size=\"12\">\n"
        "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
        width, height);
    for (std::size_t c = 0; c < chart_.columns.size(); ++c) {
      out_ += text_at(place_of_column(c), top - 12, chart_.columns[c].title);
    }
    for (std::size_t r = 0; r < chart_.rows.size(); ++r) draw_row(r);
    out_ += text_at(left + plot_width / 2.0, height - 8, chart_.x_title, " text-anchor=\"middle\"");
    return out_ + "</svg>\n";
  }

 private:
  static double place_of_column(std::size_t column) {
    return left + static_cast<double>(column) * (plot_width + gap);
  }

  double pixel_of_x(double x) const { return plot_width * ((x - x_.low) / (x_.high - x_.low)); }

  void draw_row(std::size_t index) {
    const ChartRow& row = chart_.rows[index];
    Range range;
    for (const auto& column : row.columns) {
      for (const Curve& curve : column) {
        for (const double value : curve.values) range.add(value);
      }
    }
    range.widen();
    const double y0 = top + static_cast<double>(index) * (plot_height + gap);
    out_ += fmt::format(
        "<text transform=\"translate(14,{:.1f}) rotate(-90)\" text-anchor=\"middle\">{}</text>\n",
        y0 + plot_height / 2.0, xml_text(row.title));
    for (std::size_t c = 0; c < row.columns.size(); ++c) {
      draw_plot(row.columns[c], chart_.columns[c], {place_of_column(c), y0}, range, c == 0,
                index + 1 == chart_.rows.size());
    }
    const double x = place_of_column(row.columns.size()) - gap + 10;
    for (std::size_t k = 0; k < row.columns.front().size(); ++k) {
      const double y = y0 + 8 + 15 * static_cast<double>(k);
      out_ +=
          fmt::format("<line x1=\"{0:.1f}\" y1=\"{1:.1f}\" x2=\"{2:.1f}\" y2=\"{1:.1f}\" {3}/>\n",
                      x, y, x + 18, line_style(k));
      out_ += text_at(x + 23, y + 4, row.columns.front()[k].name);
    }
  }

  /// @param corner  the upper left one of the plot
  void draw_plot(const std::vector<Curve>& curves,
                 const ChartColumn& column,
                 std::array<double, 2> corner,
                 const Range& range,
                 bool has_y,
                 bool has_x) {
    const auto pixel_of_y = [&](double y) {
      const double share = (range.high - y) / (range.high - range.low);
      return corner[1] + margin + (plot_height - 2 * margin) * share;
    };
    const std::vector<double> y_ticks = chart_ticks(range.low, range.high);
    for (const double tick : y_ticks) {
      const double y = pixel_of_y(tick);
      out_ += fmt::format(
          "<line x1=\"{0:.1f}\" y1=\"{1:.1f}\" x2=\"{2:.1f}\" y2=\"{1:.1f}\" stroke=\"#ddd\"/>\n",
          corner[0], y, corner[0] + plot_width, y);
      if (has_y) {
        out_ += text_at(corner[0] - 5, y + 4, fmt::format("{:.{}g}", tick, tick_digits(y_ticks)),
                        " text-anchor=\"end\"");
      }
    }
    const std::vector<double> x_ticks = chart_ticks(x_.low, x_.high);
    for (const double tick : x_ticks) {
      const double x = corner[0] + pixel_of_x(tick);
      out_ += fmt::format(
          "<line x1=\"{0:.1f}\" y1=\"{1:.1f}\" x2=\"{0:.1f}\" y2=\"{2:.1f}\" stroke=\"#ddd\"/>\n",
          x, corner[1], corner[1] + plot_height);
      if (has_x) {
        out_ +=
            text_at(x, corner[1] + plot_height + 16,
                    fmt::format("{:.{}g}", tick, tick_digits(x_ticks)), " text-anchor=\"middle\"");
      }
    }
    out_ += fmt::format(
        "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{}\" height=\"{}\" fill=\"none\" "
        "stroke=\"#444\"/>\n",
        corner[0], corner[1], plot_width, plot_height);
    for (std::size_t k = 0; k < curves.size(); ++k) {
      const auto points =
          chart_points(curves[k].values, column.first, column.step, x_.low, x_.high, plot_width);
      draw_line(points, k, corner[0], pixel_of_y);
    }
  }

  /// One path, which begins anew behind values that are not finite.
  template <class PixelOfY>
  void draw_line(const std::vector<std::array<double, 2>>& points,
                 std::size_t index,
                 double x0,
                 const PixelOfY& pixel_of_y) {
    std::string path;
    char letter = 'M';
    for (const auto& [x, value] : points) {
      if (std::isnan(value)) {
        letter = 'M';
        continue;
      }
      path += fmt::format("{}{:.1f},{:.1f}", letter, x0 + x, pixel_of_y(value));
      letter = 'L';
    }
    if (path.empty()) return;
    out_ += fmt::format("<path d=\"{}\" fill=\"none\" stroke-width=\"1.2\" {}/>\n", path,
                        line_style(index));
  }

  const Chart& chart_;
  Range x_;
  std::string out_;
};
}  // namespace

std::vector<double> chart_ticks(double low, double high) {
  constexpr double most_intervals = 6;
  const double rough = (high - low) / most_intervals;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  double distance = 10 * power;
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= rough) {
      distance = factor * power;
      break;
    }
  }
  std::vector<double> ticks;
  constexpr double slack = 1e-9;  // [distance], since quotients are rounded
  const auto last = static_cast<std::int64_t>(std::floor(high / distance + slack));
  for (auto k = static_cast<std::int64_t>(std::ceil(low / distance - slack)); k <= last; ++k) {
    ticks.push_back(static_cast<double>(k) * distance);
  }
  return ticks;
}

std::vector<std::array<double, 2>> chart_points(const std::vector<double>& values,
                                                double first,
                                                double step,
                                                double low,
                                                double high,
                                                int width) {
  std::vector<std::array<double, 2>> points;
  const auto pixel_of = [&](std::size_t n) {
    return width * (first + step * static_cast<double>(n) - low) / (high - low);
  };
  for (std::size_t begin = 0; begin < values.size();) {
    std::size_t end = begin;
    const double pixel = std::floor(pixel_of(begin));
    while (end < values.size() && std::floor(pixel_of(end)) == pixel &&
           std::isfinite(values[end])) {
      ++end;
    }
    if (end == begin) {
      points.push_back({pixel_of(begin), not_a_number});
      ++begin;
      continue;
    }
    const auto [least, largest] = std::minmax_element(values.begin() + std::ptrdiff_t(begin),
                                                      values.begin() + std::ptrdiff_t(end));
    std::array<std::size_t, 4> chosen{begin, static_cast<std::size_t>(least - values.begin()),
                                      static_cast<std::size_t>(largest - values.begin()), end - 1};
    std::sort(chosen.begin(), chosen.end());
    const auto behind = std::unique(chosen.begin(), chosen.end());
    std::for_each(chosen.begin(), behind, [&](std::size_t n) {
      points.push_back({pixel_of(n), values[n]});
    });
    begin = end;
  }
  return points;
}

std::string draw_chart(const Chart& chart) {
  return Drawing(chart).draw();
}

}  // namespace tetwarp::cli
