// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// Small line plots as SVG: panels side by side that share their x axis.
namespace cairn::report {

struct Tick {
  double x = 0;
  std::string label;
};

/// One line; NaN = no value there, which parts the line.
struct Series {
  std::string name;
  std::string colour;  // as SVG has it
  std::vector<double> y;
};

struct Panel {
  std::string title = {};
  double y_max = 1;  // of the axis, which begins at 0; larger values are drawn at its end
  std::vector<Series> series = {};
};

struct Plot {
  std::string x_title = {};
  std::vector<double> x = {};  // ascending, one for each value of a series
  std::vector<Tick> ticks = {};
  bool connected = true;  // false: x are kinds, not strengths, and a line between two would mean nothing
  bool marked = true;     // a dot at each value
  std::vector<Panel> panels = {};
};

/// The least of 1, 2, 5, 10, 20, 50 … that is not below `value`: where an axis ends well.
inline double round_up_for_axis(double value) {
  if (!(value > 0)) return 1;
  const double power = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : {1.0, 2.0, 5.0}) {
    if (value <= step * power * (1 + 1e-9)) return step * power;
  }
  return 10 * power;
}

namespace svg {

inline std::string escaped(std::string_view text) {
  std::string all;
  for (const char c : text) {
    switch (c) {
      case '&':
        all += "&amp;";
        break;
      case '<':
        all += "&lt;";
        break;
      case '>':
        all += "&gt;";
        break;
      case '"':
        all += "&quot;";
        break;
      default:
        all += c;
    }
  }
  return all;
}

/// A tenth of a pixel is as fine as anybody sees, and keeps the files small and their differences readable.
inline std::string coordinate(double value) {
  std::array<char, 32> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%.1f", value);
  return buffer.data();
}

inline std::string number(double value) {
  std::array<char, 32> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%g", value);
  return buffer.data();
}

using Attributes = std::vector<std::pair<std::string_view, std::string>>;

/// <name a="…" b="…">content</name>, or <name a="…"/> without content.
inline std::string element(std::string_view name, const Attributes& attributes,
                           std::string_view content = {}) {
  std::string all = "<" + std::string(name);
  for (const auto& [key, value] : attributes) {
    all += ' ';
    all += key;
    all += "=\"";
    all += escaped(value);
    all += '"';
  }
  if (content.empty()) return all + "/>\n";
  all += '>';
  all += content;
  return all + "</" + std::string(name) + ">\n";
}

inline std::string text(double x, double y, std::string_view anchor, std::string_view words) {
  return element("text", {{"x", coordinate(x)}, {"y", coordinate(y)}, {"text-anchor", std::string(anchor)}},
                 escaped(words));
}

inline std::string line(double x1, double y1, double x2, double y2, std::string_view colour) {
  return element("line", {{"x1", coordinate(x1)},
                          {"y1", coordinate(y1)},
                          {"x2", coordinate(x2)},
                          {"y2", coordinate(y2)},
                          {"stroke", std::string(colour)}});
}

inline constexpr double kPanelWidth = 250;  // px, its margins counted
inline constexpr double kHeight = 225;
inline constexpr double kLeft = 38;  // margins around a panel's axes
inline constexpr double kRight = 12;
inline constexpr double kTop = 46;
inline constexpr double kBottom = 42;

/// Where data stand in the picture.
struct Axes {
  double left = 0;  // px
  double x_first = 0;
  double x_last = 1;
  double y_max = 1;

  [[nodiscard]] double right() const { return left + kPanelWidth - kLeft - kRight; }
  [[nodiscard]] static double bottom() { return kHeight - kBottom; }
  [[nodiscard]] double x_px(double x) const {
    const double share = x_last > x_first ? (x - x_first) / (x_last - x_first) : 0.5;
    return left + share * (right() - left);
  }
  [[nodiscard]] double y_px(double y) const {
    return bottom() - std::clamp(y / y_max, 0.0, 1.0) * (bottom() - kTop);
  }
};

inline std::string grid(const Plot& plot, const Panel& panel, const Axes& axes) {
  std::string all;
  constexpr int kSteps = 4;
  for (int i = 0; i <= kSteps; ++i) {
    const double y = panel.y_max * i / kSteps;
    all += line(axes.left, axes.y_px(y), axes.right(), axes.y_px(y), i == 0 ? "#666" : "#ddd");
    all += text(axes.left - 4, axes.y_px(y) + 4, "end", number(y));
  }
  for (const Tick& tick : plot.ticks) {
    all += line(axes.x_px(tick.x), Axes::bottom(), axes.x_px(tick.x), Axes::bottom() + 3, "#666");
    all += text(axes.x_px(tick.x), Axes::bottom() + 15, "middle", tick.label);
  }
  all += text((axes.left + axes.right()) / 2, kHeight - 8, "middle", plot.x_title);
  return all + text(axes.left - kLeft + 6, kTop - 10, "start", panel.title);
}

inline std::string curve(const Plot& plot, const Series& series, const Axes& axes) {
  std::string path;
  std::string dots;
  bool pen_down = false;
  for (std::size_t i = 0; i < std::min(plot.x.size(), series.y.size()); ++i) {
    if (std::isnan(series.y[i])) {
      pen_down = false;
      continue;
    }
    const std::string x = coordinate(axes.x_px(plot.x[i]));
    const std::string y = coordinate(axes.y_px(series.y[i]));
    path += pen_down ? 'L' : 'M';
    path += x;
    path += ' ';
    path += y;
    dots += element("circle", {{"cx", x}, {"cy", y}, {"r", "3"}, {"fill", series.colour}});
    pen_down = true;
  }
  std::string all;
  if (plot.connected && !path.empty()) {
    all =
        element("path", {{"d", path}, {"fill", "none"}, {"stroke", series.colour}, {"stroke-width", "1.8"}});
  }
  return plot.marked ? all + dots : all;
}

/// The names of the first panel's series, in one row over all panels.
inline std::string legend(const Plot& plot) {
  constexpr double kEntryWidth = 90;
  std::string all;
  double x = kLeft;
  for (const Series& series : plot.panels.front().series) {
    all += element(
        "rect",
        {{"x", coordinate(x)}, {"y", "8"}, {"width", "10"}, {"height", "10"}, {"fill", series.colour}});
    all += text(x + 15, 17, "start", series.name);
    x += kEntryWidth;
  }
  return all;
}

}  // namespace svg

/// The whole file. Its ground is white, so that it can be read on a dark page, too.
inline std::string svg_of(const Plot& plot) {
  using namespace svg;
  const double width = kPanelWidth * static_cast<double>(plot.panels.size());
  std::string all = element("rect", {{"width", "100%"}, {"height", "100%"}, {"fill", "#fff"}});
  if (!plot.panels.empty()) all += legend(plot);
  for (std::size_t p = 0; p < plot.panels.size(); ++p) {
    const Panel& panel = plot.panels[p];
    Axes axes{.left = kPanelWidth * static_cast<double>(p) + kLeft, .y_max = panel.y_max};
    if (!plot.x.empty()) {
      // Kinds stand in the middle of their share of the axis, so that their names do not hang over its ends.
      const double beyond =
          plot.connected ? 0 : (plot.x.back() - plot.x.front()) / static_cast<double>(2 * plot.x.size());
      axes.x_first = plot.x.front() - beyond;
      axes.x_last = plot.x.back() + beyond;
    }
    all += grid(plot, panel, axes);
    for (const Series& series : panel.series) all += curve(plot, series, axes);
  }
  return element("svg",
                 {{"xmlns", "http://www.w3.org/2000/svg"},
                  {"width", number(width)},
                  {"height", number(kHeight)},
                  {"viewBox", "0 0 " + number(width) + " " + number(kHeight)},
                  {"font-family", "sans-serif"},
                  {"font-size", "11"},
                  {"fill", "#222"}},
                 "\n" + all);
}

}  // namespace cairn::report
