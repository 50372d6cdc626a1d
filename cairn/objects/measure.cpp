// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <algorithm>
#include <array>
#include <cairn/core/parallel.hpp>
#include <cairn/core/scratch.hpp>
#include <cairn/objects/measure.hpp>
#include <cairn/objects/ranks.hpp>
#include <cairn/regions/runs.hpp>
#include <cairn/stereo/label_kernels.hpp>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <span>
#include <utility>

namespace cairn {
namespace {

constexpr int kGrain = 64;  // rows

/// The outline of an object, in steps from one of its pixels to a 4-neighbour outside.
struct Rim {
  std::int64_t length = 0;
  std::int64_t at_edge = 0;
  std::int64_t cut = 0;

  void add(bool is_edge) {
    ++length;
    at_edge += is_edge ? 1 : 0;
  }
  void add_cut(int steps) {
    length += steps;
    cut += steps;
  }
};

/// Properties of a candidate that need no disparities. All are integers, so the order of additions does not
/// matter.
struct Outline {
  std::int64_t pixel_count = 0;
  int first_pixel = 0;
  Rect box;
  std::array<std::int64_t, 3> colour_sum{};
  Rim rim;

  /// `more`: of rows further down.
  void absorb(const Outline& more) {
    if (pixel_count == 0) first_pixel = more.first_pixel;
    pixel_count += more.pixel_count;
    box = united(box, more.box);
    for (std::size_t c = 0; c < 3; ++c) colour_sum[c] += more.colour_sum[c];
    rim.length += more.rim.length;
    rim.at_edge += more.rim.at_edge;
    rim.cut += more.rim.cut;
  }
};

struct Inputs {
  View<const RegionId> candidates;
  std::size_t count;  // of the candidates
  const Image<float>& disparity_px;
  View<const Gray> left;
  View<const Rgb> left_rgb;
  int edge_min;  // grey levels: a larger difference across the outline is an edge
};

constexpr float kEdgeMin = 4.0F;          // grey levels …
constexpr float kEdgeNoiseFactor = 3.0F;  // … plus deviations of the image noise

constexpr int kMaxSummed = 8192;  // pixels whose colours are looked up at once

/// Surveys a band of rows.
class Survey {
 public:
  Survey(const Inputs& in, const Exec& exec)
      : in_(in),
        run_(kernels::label_kernels(exec)),
        outlines_(in.count),
        ends_(slot(in.candidates.width()) + kernels::kListSlack),
        upper_(ends_.size()),
        lower_(ends_.size()),
        up_to_(ends_.size()) {}

  void add_rows(int first, int last) {
    for (int y = first; y < last; ++y) {
      add_runs(y);
      if (y > 0) look_up(y);
    }
  }

  [[nodiscard]] std::vector<Outline>& outlines() { return outlines_; }
  /// Visits runs in raster order.
  [[nodiscard]] const std::vector<Run>& runs() const { return runs_; }

 private:
  void add_runs(int y) {
    const auto [width, height] = in_.candidates.size();
    const RegionId* const label = in_.candidates.row(y);
    const int count = run_.find_runs(label, label, width, ends_.data());
    sum_colours(y, width);
    const int at_border = (y == 0 ? 1 : 0) + (y + 1 == height ? 1 : 0);
    outlines_[index(label[0])].rim.add_cut(1);
    outlines_[index(label[width - 1])].rim.add_cut(1);
    for (int k = 0, x = 0; k < count; ++k) {
      const Run run{label[x], y, x, ends_[slot(k)]};
      runs_.push_back(run);
      Outline& outline = outlines_[index(run.label)];
      if (outline.pixel_count == 0) outline.first_pixel = y * width + x;
      outline.pixel_count += run.length();
      outline.box = united(outline.box, run.box());
      for (int first = x; first < run.last; first += kMaxSummed)
        add_colours(first, std::min(first + kMaxSummed, run.last), outline.colour_sum);
      outline.rim.add_cut(at_border * run.length());
      if (x > 0) add_step(outlines_[index(label[x - 1])], outline, is_edge(x - 1, y, x, y));
      x = run.last;
    }
  }

  void sum_colours(int y, int width) {
    if (in_.left_rgb.empty()) {
      run_.sum_grey(in_.left.row(y), width, up_to_.data());
    } else {
      run_.sum_colours(in_.left_rgb.row(y), width, up_to_.data());
    }
  }
  void add_colours(int first, int last, std::array<std::int64_t, 3>& sum) const {
    constexpr unsigned kBits = 21;
    const std::uint64_t packed = up_to_[slot(last)] - up_to_[slot(first)];
    for (unsigned c = 0; c < 3; ++c) {
      const std::uint64_t of_channel = in_.left_rgb.empty() ? packed >> 40U : packed >> c * kBits;
      sum[c] += static_cast<std::int64_t>(of_channel & ((1U << kBits) - 1));
    }
  }

  /// Steps from each pixel to the one above.
  void look_up(int y) {
    const int count = run_.differing(in_.candidates.row(y), in_.candidates.row(y - 1), in_.left.width(),
                                     ends_.data(), {upper_.data(), lower_.data()});
    for (std::size_t k = 0; k < slot(count); ++k) {
      const int x = ends_[k];
      add_step(outlines_[slot(upper_[k])], outlines_[slot(lower_[k])], is_edge(x, y, x, y - 1));
    }
  }

  /// A step between two regions belongs to the rims of both.
  static void add_step(Outline& p, Outline& q, bool is_edge) {
    p.rim.add(is_edge);
    q.rim.add(is_edge);
  }

  [[nodiscard]] bool is_edge(int x, int y, int u, int v) const {
    if (in_.left_rgb.empty()) return std::abs(in_.left(x, y) - in_.left(u, v)) > in_.edge_min;
    const Rgb p = in_.left_rgb(x, y);
    const Rgb q = in_.left_rgb(u, v);
    return std::max({std::abs(p.r - q.r), std::abs(p.g - q.g), std::abs(p.b - q.b)}) > in_.edge_min;
  }

  const Inputs& in_;
  const kernels::LabelKernels& run_;
  std::vector<Outline> outlines_;
  std::vector<Run> runs_;
  std::vector<std::int32_t> ends_;  // of a row's runs; then its pixels at a rim
  std::vector<std::int32_t> upper_;
  std::vector<std::int32_t> lower_;
  std::vector<std::uint64_t> up_to_;  // sums of a row's colours, as the kernels pack them
};

/// One band per thread, from the top down.
std::vector<Survey> survey(const Inputs& in, const Exec& exec) {
  const int height = in.left.height();
  std::vector<Survey> bands(slot(std::min(exec.threads(), height)), Survey(in, exec));
  const auto count = static_cast<int>(bands.size());
  const auto first_row = [&](int band) { return static_cast<int>(std::int64_t{height} * band / count); };
  parallel_for(exec, count, 1, [&](int first, int last) {
    for (int band = first; band < last; ++band)
      bands[slot(band)].add_rows(first_row(band), first_row(band + 1));
  });
  return bands;
}

/// The outlines of the whole image, merged into those of the first band.
const std::vector<Outline>& outlines_of(std::vector<Survey>& bands) {
  std::vector<Outline>& all = bands.front().outlines();
  for (std::size_t band = 1; band < bands.size(); ++band) {
    const std::vector<Outline>& more = bands[band].outlines();
    // Includes regions without a pixel in the band: the rim of a region just above belongs to it as well.
    for (std::size_t i = 0; i < all.size(); ++i) all[i].absorb(more[i]);
  }
  return all;
}

int borders_touched(Rect box, Size image) {
  return (box.x == 0 ? 1 : 0) + (box.y == 0 ? 1 : 0) + (box.x + box.width == image.width ? 1 : 0) +
         (box.y + box.height == image.height ? 1 : 0);
}

bool may_be_object(const Outline& outline, Size image, const ObjectsConfig& config) {
  const double percent = 100.0 * static_cast<double>(outline.pixel_count) / static_cast<double>(image.area());
  return percent >= config.min_area && percent <= config.max_area && borders_touched(outline.box, image) < 3;
}

/// The median; the mean of the two middle values if their number is even. Reorders `values`, which must not
/// be empty.
float median(std::span<float> values, const Exec& exec) {
  const std::size_t upper = values.size() / 2;
  if (values.size() % 2 == 1) return values_at_ranks(values, upper, upper, exec).first;
  const auto [below, above] = values_at_ranks(values, upper - 1, upper, exec);
  return (above + below) / 2;
}

/// The valid disparities of an object, gathered run by run.
class ObjectDisparities {
 public:
  /// The number of floats needed by an object.
  static std::size_t room_for(std::size_t pixels) { return pixels + kernels::kListSlack; }
  ObjectDisparities(const Inputs& in, float* room, const Exec& exec)
      : in_(in), labels_(kernels::label_kernels(exec)), room_(room) {}

  void add(const Run& run) {
    const float* const disparity = in_.disparity_px.row(run.y);
    count_ += slot(labels_.keep_known(disparity, disparity, run.first, run.last, room_ + count_));
  }
  [[nodiscard]] std::span<float> disparities() const { return {room_, count_}; }

 private:
  const Inputs& in_;
  const kernels::LabelKernels& labels_;
  float* room_;
  std::size_t count_ = 0;
};

Rgb mean_colour(const std::array<std::int64_t, 3>& sum, std::int64_t pixels) {
  const auto mean = [&](std::size_t c) { return static_cast<std::uint8_t>((sum[c] + pixels / 2) / pixels); };
  return {mean(0), mean(1), mean(2)};
}

Inputs inputs_of(View<const RegionId> candidates, std::size_t count, const DisparityMap& disparity,
                 const LeftImage& left) {
  const auto weakest_edge = static_cast<int>(kEdgeMin + kEdgeNoiseFactor * left.noise_sigma);
  return {candidates, count, disparity.disparity_px, left.gray, left.rgb, weakest_edge};
}

float confidence_of(const Object& object, Size image) {
  const double size = std::log(static_cast<double>(object.pixel_count) / static_cast<double>(image.area()));
  const double sum = 1.53 * size + 11.72 * object.edge_share - 4.72 * object.cut_share - 2.41;
  const double supported = std::min(2.0 * object.valid_share, 1.0);
  return static_cast<float>(supported / (1.0 + std::exp(-sum)));
}

/// nullopt if no pixel has a disparity.
std::optional<Object> measured(const Outline& outline, const ObjectDisparities& gathered, Size image,
                               const Exec& exec) {
  const std::span<float> disparities = gathered.disparities();
  if (disparities.empty()) return std::nullopt;
  Object object;
  object.box_px = outline.box;
  object.pixel_count = static_cast<int>(outline.pixel_count);
  object.valid_share = static_cast<float>(disparities.size()) / static_cast<float>(outline.pixel_count);
  object.mean_colour = mean_colour(outline.colour_sum, outline.pixel_count);
  const Rim& rim = outline.rim;
  const auto share = [&](std::int64_t part) {
    return static_cast<float>(part) / static_cast<float>(std::max<std::int64_t>(rim.length, 1));
  };
  object.edge_share = share(rim.at_edge);
  object.cut_share = share(rim.cut);
  object.confidence = confidence_of(object, image);
  object.disparity_px = median(disparities, exec);
  return object;
}

/// A candidate for an object.
struct Candidate {
  std::size_t region;
  std::size_t room = 0;  // where its lists begin
  std::optional<Object> object = {};
};

std::size_t pixels_of(const Candidate& candidate, const std::vector<Outline>& outline) {
  return static_cast<std::size_t>(outline[candidate.region].pixel_count);
}

/// Measures all candidates in one pass over the image; one pass per region would fetch every row again.
void measure_range(const Inputs& in, const std::vector<Survey>& bands, const std::vector<Outline>& outline,
                   std::span<Candidate> range, float* room, const Exec& exec) {
  std::vector<ObjectDisparities> gathered;
  gathered.reserve(range.size());
  std::vector<ObjectDisparities*> of_region(outline.size(), nullptr);
  for (const Candidate& candidate : range) {
    of_region[candidate.region] = &gathered.emplace_back(in, room + candidate.room, exec);
  }
  for (const Survey& band : bands) {
    for (const Run& run : band.runs()) {
      if (ObjectDisparities* const of = of_region[index(run.label)]; of != nullptr) of->add(run);
    }
  }
  for (std::size_t i = 0; i < range.size(); ++i) {
    range[i].object = measured(outline[range[i].region], gathered[i], in.left.size(), exec);
  }
}

/// Splits the candidates into lists of about equally many pixels: first candidates of the lists, and the end.
/// Each list takes one pass over the image.
std::vector<std::size_t> shares(const std::vector<Candidate>& candidates, const std::vector<Outline>& outline,
                                const Exec& exec) {
  const int parts = exec.threads() == 1 ? 1 : 2 * exec.threads();
  std::int64_t all = 0;
  for (const Candidate& candidate : candidates) all += outline[candidate.region].pixel_count;
  std::vector<std::size_t> begins{0};
  std::int64_t pixels = 0;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (pixels * parts > all * static_cast<std::int64_t>(begins.size())) begins.push_back(i);
    pixels += outline[candidates[i].region].pixel_count;
  }
  begins.push_back(candidates.size());
  return begins;
}

/// Measures the regions for which may_be() holds, and keeps those for which is() holds, nearest first.
template <class MayBe, class Is>
Objects measure_those(const Inputs& in, MayBe may_be, Is is, const Exec& exec) {
  const Size size = in.candidates.size();
  std::vector<Survey> bands = survey(in, exec);
  const std::vector<Outline>& outline = outlines_of(bands);

  std::vector<Candidate> found;
  std::size_t room = 0;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    if (!may_be(i, outline[i])) continue;
    found.push_back({i, room});
    room += ObjectDisparities::room_for(pixels_of(found.back(), outline));
  }
  Scratch<float> lists(room, exec.pool);
  const std::vector<std::size_t> begins = shares(found, outline, exec);
  parallel_for(exec, static_cast<int>(begins.size()) - 1, 1, [&](int first, int last) {
    for (auto i = slot(first); i < slot(last); ++i) {
      measure_range(in, bands, outline, std::span(found).subspan(begins[i], begins[i + 1] - begins[i]),
                    lists.data(), exec);
    }
  });
  std::erase_if(found, [&](Candidate& candidate) { return !candidate.object || !is(candidate); });
  std::sort(found.begin(), found.end(), [&](const Candidate& a, const Candidate& b) {
    if (a.object->disparity_px != b.object->disparity_px)
      return a.object->disparity_px > b.object->disparity_px;
    return outline[a.region].first_pixel < outline[b.region].first_pixel;
  });

  Objects objects{Image<ObjectId>(size, exec.pool), {}};
  std::vector<ObjectId> id_of(outline.size(), ObjectId::none);
  for (Candidate& candidate : found) {
    candidate.object->id = ObjectId{static_cast<std::int32_t>(objects.list.size()) + 1};
    id_of[candidate.region] = candidate.object->id;
    objects.list.push_back(*candidate.object);
  }
  parallel_for(exec, size.height, kGrain, [&](int first, int last) {
    for (int y = first; y < last; ++y) {
      const RegionId* const in_row = in.candidates.row(y);
      ObjectId* const out = objects.labels.row(y);
      for (int x = 0; x < size.width; ++x) out[x] = id_of[index(in_row[x])];
    }
  });
  return objects;
}

}  // namespace

Objects measure(View<const RegionId> candidates, const std::vector<bool>& is_background,
                const DisparityMap& disparity, const LeftImage& left, const ObjectsConfig& config,
                const Exec& exec) {
  const Inputs in = inputs_of(candidates, is_background.size(), disparity, left);
  const auto may_be = [&](std::size_t region, const Outline& outline) {
    return !is_background[region] && may_be_object(outline, candidates.size(), config);
  };
  const auto is = [&](const Candidate& candidate) {
    return candidate.object->confidence >= config.min_confidence;
  };
  return measure_those(in, may_be, is, exec);
}

Objects measure(View<const RegionId> chosen, const std::vector<float>& scores, const DisparityMap& disparity,
                const LeftImage& left, const Exec& exec) {
  const Inputs in = inputs_of(chosen, scores.size(), disparity, left);
  const auto may_be = [&](std::size_t region, const Outline&) { return scores[region] > 0; };
  const auto is = [&](Candidate& candidate) {
    candidate.object->confidence = scores[candidate.region];
    return true;
  };
  return measure_those(in, may_be, is, exec);
}

}  // namespace cairn
