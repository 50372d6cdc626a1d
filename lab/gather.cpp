// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
//
// fitting --names: prints the names of the features.
// fitting JOBS [--inputs FILE] [--pairs FILE] [--regions FILE] [--bias FILE] [--planes FILE] [--floor FILE] [--min-score S]:
// gathers the data for fit_hints.py and fit.py, and measures how well the result performs.
//
// Each line of JOBS is the folder of a frame, `colour` or `grey`, and three files: a fitted network and two
// sets of fitted trees; `-` for the library's. For each line it prints what was found in the frame, and of each true
// object the area, the greatest IoU of a set of superpixels and of a region, and the score of that region. The FILEs
// receive records of floats: for each pair of regions that was judged, the job's number, whether they show
// the same object, how pure they are, and the features; for each region that may be an object, the job's
// number, its greatest IoU with a true object, whether the truth is partial, and the features; for each object
// that was found, the job's number, the true disparity minus the measured one, the latter's px per metre of
// depth, and the features of its bias; for each plane that a group of pixels may take, the job's number, the share
// of pixels that are right then, their number, and the features; for each group of pixels that may show the floor,
// the job's number, the share that does, their number (far ones count less), and the features, of
// the frame and of a close-up of its largest object; for the inputs, see record_input().
#include <cairn/cairn.hpp>
#include <cairn/objects/floor_probability.hpp>
#include <cairn/pipeline/methods.hpp>
#include <cairn/regions/choose_objects.hpp>
#include <cairn/timing/clock.hpp>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <map>
#include <memory>
#include <span>
#include <sstream>

#include "scored_frames.hpp"

namespace cairn::lab {
namespace {

constexpr double kMinArea = 0.0006;  // share of the image; candidate regions: below objects.min_area
constexpr double kMaxArea = 0.7;
constexpr float kBothBackground =
    0.3F;  // weight of pairs that are both background: the truth does not separate its surfaces
constexpr float kMinPurity = 0.1F;

/// Fitted trees in a file: base, numbers of roots and nodes; the roots; one node per line.
std::shared_ptr<const FittedTrees> load_trees(const std::string& path) {
  std::ifstream in(path);
  float base = 0;
  std::size_t root_count = 0;
  std::size_t node_count = 0;
  in >> base >> root_count >> node_count;
  std::vector<std::int16_t> roots(root_count);
  std::vector<FittedTrees::Node> nodes(node_count);
  for (std::int16_t& root : roots) in >> root;
  for (FittedTrees::Node& node : nodes) in >> node.feature >> node.below >> node.value;
  if (!in) throw Error(path + ": no file of fitted trees");
  return std::make_shared<FittedTrees>(base, roots, nodes);
}

/// Models by file name, each read once; `-` is the library's.
template <class T>
class FittedCache {
 public:
  explicit FittedCache(std::shared_ptr<const T> (*load)(const std::string& path)) : load_(load) {}
  const T& at(const std::string& path, const T& of_the_library) {
    if (path == "-") return of_the_library;
    std::shared_ptr<const T>& known = known_[path];
    if (!known) known = load_(path);
    return *known;
  }

 private:
  std::shared_ptr<const T> (*load_)(const std::string& path);
  std::map<std::string, std::shared_ptr<const T>> known_;
};

struct Files {
  std::ofstream pairs;
  std::ofstream regions;
  std::ofstream inputs;
  std::ofstream bias;
  std::ofstream planes;
  std::ofstream floor;
};

template <std::size_t N>
void record(std::ofstream& file, int job, float label, float more, const std::array<float, N>& features) {
  const std::array head{static_cast<float>(job), label, more};
  file.write(reinterpret_cast<const char*>(head.data()), sizeof head);
  file.write(reinterpret_cast<const char*>(features.data()), sizeof features);
}

/// Ground truth for the nodes of a tree. Kind 0: don't care, 1: no object, 2 …: objects.
class Truth {
 public:
  Truth(const TrueFrame& frame, const Superpixels& superpixels, const MergeTree& tree)
      : partial_(frame.partial), superpixels_(slot(tree.superpixels)) {
    const View<const TruthId> truth = frame.objects;
    for (int y = 0; y < truth.height(); ++y) {
      for (int x = 0; x < truth.width(); ++x) kinds_.try_emplace(truth(x, y), kinds_.size());
    }
    areas_.resize(kinds_.size());
    shares_.assign(tree.nodes.size(), std::vector<std::int64_t>(kinds_.size()));
    for (int y = 0; y < truth.height(); ++y) {
      for (int x = 0; x < truth.width(); ++x) {
        const std::size_t kind = kinds_.at(truth(x, y));
        ++areas_[kind];
        ++shares_[index(superpixels.labels(x, y))][kind];
      }
    }
    for (std::size_t i = slot(tree.superpixels); i < tree.nodes.size(); ++i) {
      for (std::size_t k = 0; k < kinds_.size(); ++k)
        shares_[i][k] = shares_[slot(tree.nodes[i].part_a)][k] + shares_[slot(tree.nodes[i].part_b)][k];
    }
  }
  [[nodiscard]] std::int64_t known(std::size_t node) const {
    std::int64_t sum = 0;
    for (std::size_t k = 1; k < areas_.size(); ++k) sum += shares_[node][k];
    return sum;
  }
  /// The kind of most of its pixels; 0 if unknown.
  [[nodiscard]] std::size_t kind(std::size_t node) const {
    const auto first = shares_[node].begin() + 1;
    return known(node) == 0
               ? 0
               : static_cast<std::size_t>(std::max_element(first, shares_[node].end()) - first) + 1;
  }
  [[nodiscard]] float purity(std::size_t node) const {
    const std::int64_t all = known(node);
    return all == 0 ? 0 : static_cast<float>(shares_[node][kind(node)]) / static_cast<float>(all);
  }
  [[nodiscard]] float best_iou(std::size_t node) const {
    float best = 0;
    for (std::size_t k = 2; k < areas_.size(); ++k) best = std::max(best, iou(node, k));
    return best;
  }
  /// The node with the greatest IoU with an object, and this IoU.
  [[nodiscard]] std::pair<std::size_t, float> best_node(TruthId object) const {
    const std::size_t kind = kinds_.at(object);
    std::pair<std::size_t, float> best;
    for (std::size_t i = 0; i < shares_.size(); ++i) {
      if (iou(i, kind) > best.second) best = {i, iou(i, kind)};
    }
    return best;
  }
  /// The greatest IoU of any set of superpixels: it has those that show most of the object, by their share.
  [[nodiscard]] float best_iou_of_superpixels(TruthId object) const {
    const std::size_t kind = kinds_.at(object);
    std::vector<std::pair<double, std::size_t>> by_share;
    for (std::size_t i = 0; i < superpixels_; ++i) {
      if (shares_[i][kind] > 0)
        by_share.emplace_back(static_cast<double>(shares_[i][kind]) / static_cast<double>(known(i)), i);
    }
    std::sort(by_share.rbegin(), by_share.rend());
    std::int64_t common = 0;
    std::int64_t all = areas_[kind];
    float best = 0;
    for (const auto& [share, i] : by_share) {
      common += shares_[i][kind];
      all += known(i) - shares_[i][kind];
      best = std::max(best, static_cast<float>(common) / static_cast<float>(all));
    }
    return best;
  }
  [[nodiscard]] bool partial() const { return partial_; }

 private:
  [[nodiscard]] float iou(std::size_t node, std::size_t kind) const {
    const auto common = static_cast<float>(shares_[node][kind]);
    return common / (static_cast<float>(known(node) + areas_[kind]) - common);
  }

  bool partial_;
  std::size_t superpixels_;
  std::map<TruthId, std::size_t> kinds_{{TruthId::dont_care, 0}, {TruthId::none, 1}};
  std::vector<std::int64_t> areas_;
  std::vector<std::vector<std::int64_t>> shares_;
};

/// The network's input and the truth, as a record of integers for each job: its number, width, height,
/// whether the truth is partial; the channels of each cell; its true object: 0 none, −1 don't care.
void record_input(std::ofstream& file, int job, const Image<std::int16_t>& input, const TrueFrame& frame) {
  const Size cells{input.width() / kHintChannels - 2, input.height() - 2};
  const std::array<std::int16_t, 4> head{
      static_cast<std::int16_t>(job), static_cast<std::int16_t>(cells.width),
      static_cast<std::int16_t>(cells.height), static_cast<std::int16_t>(frame.partial ? 1 : 0)};
  const auto write = [&file](const std::int16_t* values, std::size_t n) {
    file.write(reinterpret_cast<const char*>(values), static_cast<std::streamsize>(n * sizeof *values));
  };
  write(head.data(), head.size());
  for (int y = 0; y < cells.height; ++y)
    write(input.row(y + 1) + kHintChannels, slot(cells.width * kHintChannels));
  const View<const TruthId> truth = frame.objects;
  std::map<TruthId, std::int16_t> kinds{{TruthId::dont_care, -1}, {TruthId::none, 0}};
  for (int y = 0; y < cells.height; ++y) {
    for (int x = 0; x < cells.width; ++x) {
      const TruthId id = truth((2 * x + 1) * truth.width() / (2 * cells.width),
                               (2 * y + 1) * truth.height() / (2 * cells.height));
      write(&kinds.try_emplace(id, static_cast<std::int16_t>(kinds.size() - 1)).first->second, 1);
    }
  }
}

/// A network in a file, as written by fit_hints.py: sizes of the layers, weights, biases and scales.
std::shared_ptr<const HintNetwork> load_network(const std::string& path) {
  std::ifstream in(path);
  std::array<HintLayer, kHintLayers> layers;
  std::size_t weights = 0;
  std::size_t outputs = 0;
  for (HintLayer& l : layers) {
    in >> l.inputs >> l.outputs >> l.side >> l.stride >> l.least;
    weights += l.weights();
    outputs += slot(l.outputs);
  }
  std::vector<std::int8_t> weight(weights);
  std::vector<std::int32_t> bias(outputs);
  std::vector<float> scale(outputs);
  for (std::int8_t& v : weight) {
    int number = 0;
    in >> number;
    v = static_cast<std::int8_t>(number);
  }
  for (std::int32_t& v : bias) in >> v;
  for (float& v : scale) in >> v;
  if (!in) throw Error(path + ": no file of a fitted network");
  return std::make_shared<HintNetwork>(layers, weight, bias, scale);
}

struct Pair {
  std::int32_t a;
  std::int32_t b;
  MergeFeatures features;
};

void record_pairs(std::ofstream& file, int job, const std::vector<Pair>& pairs, const Truth& truth) {
  for (const Pair& pair : pairs) {
    const std::size_t a = truth.kind(slot(pair.a));
    const std::size_t b = truth.kind(slot(pair.b));
    if (a == 0 || b == 0) continue;
    float purity = truth.purity(slot(pair.a)) * truth.purity(slot(pair.b));
    if (a == 1 && b == 1) {
      if (truth.partial()) continue;  // both may belong to unlabelled objects
      purity *= kBothBackground;
    }
    if (purity >= kMinPurity) record(file, job, a == b ? 1.0F : 0.0F, purity, pair.features);
  }
}

void record_regions(std::ofstream& file, int job, const MergeTree& tree, const Truth& truth, Size size) {
  const auto image = static_cast<double>(size.area());
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    const MergeNode& node = tree.nodes[i];
    const auto area = static_cast<double>(node.area);
    if (area < kMinArea * image || area > kMaxArea * image) continue;
    if (2 * truth.known(i) < node.area) continue;
    const float iou = truth.best_iou(i);
    // An unlabelled region may be an object.
    if (truth.partial() && truth.kind(i) == 1 && iou < 0.1F && truth.purity(i) > 0.9F) continue;
    record(file, job, iou, truth.partial() ? 1.0F : 0.0F, node.features);
  }
}

/// The objects with an IoU of at least one half: the median of the true disparities of the true object, minus
/// the measured disparity.
void record_bias(std::ofstream& file, int job, const TrueFrame& frame, const Objects& objects,
                 const DisparityMap& disparity, View<const Gray> right, const Exec& exec) {
  const View<const Gray> left = frame.images.left.gray;
  const std::vector<double> shifts = image_shifts(objects, disparity, left, right, exec);
  const std::vector<BiasFeatures> features = bias_features(objects, shifts, disparity, left, right, exec);
  std::map<TruthId, std::vector<float>> true_px;
  std::map<TruthId, std::int64_t> areas;
  std::map<std::pair<ObjectId, TruthId>, std::int64_t> common;
  for (int y = 0; y < left.height(); ++y) {
    for (int x = 0; x < left.width(); ++x) {
      const TruthId id = frame.objects(x, y);
      if (id == TruthId::none || id == TruthId::dont_care) continue;
      ++areas[id];
      ++common[{objects.labels(x, y), id}];
      if (!std::isnan(frame.truth_px(x, y))) true_px[id].push_back(frame.truth_px(x, y));
    }
  }
  for (const auto& [ids, shared] : common) {
    const auto& [ours, id] = ids;
    std::vector<float>& values = true_px[id];
    if (ours == ObjectId::none || values.empty()) continue;
    const std::size_t i = slot(number(ours) - 1);
    const Object& object = objects.list[i];
    if (3 * shared < object.pixel_count + areas[id]) continue;  // IoU < 0.5
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    const double off = static_cast<double>(*middle) - static_cast<double>(object.disparity_px) - shifts[i];
    const float px_per_m = *middle * *middle / (frame.rig->focal_px * frame.rig->baseline_m);
    record(file, job, static_cast<float>(off), px_per_m, features[i]);
  }
}

/// Right: within 1 px of the true disparity.
void record_plane(std::ofstream& file, int job, const JudgedPlane& judged, View<const float> truth_px) {
  int known = 0;
  int right = 0;
  for (const SuperpixelPixel& pixel : judged.pixels) {
    const float truth = truth_px(pixel.x, pixel.y);
    if (std::isnan(truth)) continue;
    ++known;
    right += std::abs(disparity_on(judged.plane, pixel) - truth) <= 1 ? 1 : 0;
  }
  if (known > 0)
    record(file, job, static_cast<float>(right) / static_cast<float>(known),
           static_cast<float>(known * judged.pixels_per_sample / 2), judged.features);
}

/// A part of a frame and of its truth.
struct Part {
  FrameInput in;
  std::optional<StereoRig> rig;
  int num_disparities;
  View<const TruthId> objects;
  View<const float> truth_px;
  View<const Gray> ground;
};

Part part_of(const TrueFrame& frame, bool grey, Rect window) {
  const io::LoadedImage& left = frame.images.left;
  const io::LoadedImage& right = frame.images.right;
  Part part{{{left.gray.view().sub(window),
              grey || left.rgb.empty() ? View<const Rgb>{} : left.rgb.view().sub(window)},
             right.gray.view().sub(window)},
            frame.rig,
            std::min(frame.num_disparities, window.width),
            frame.objects.view().sub(window),
            frame.truth_px.view().sub(window),
            frame.ground.view().sub(window)};
  if (part.rig) {
    part.rig->cx_px -= static_cast<float>(window.x);
    part.rig->cy_px -= static_cast<float>(window.y);
  }
  return part;
}

/// The window, at least 140 px wide and of the image's proportions, of which the largest object fills two fifths: what a
/// robot sees that comes close. The whole image without an object.
Rect close_up(View<const TruthId> objects) {
  constexpr double kFilled = 0.4;
  constexpr int kMinWidth = 140;
  std::map<TruthId, std::pair<std::int64_t, Rect>> seen;
  for (int y = 0; y < objects.height(); ++y) {
    for (int x = 0; x < objects.width(); ++x) {
      const TruthId id = objects(x, y);
      if (id == TruthId::none || id == TruthId::dont_care) continue;
      auto& [pixels, box] = seen[id];
      ++pixels;
      box = united(box, {x, y, 1, 1});
    }
  }
  const Size size = objects.size();
  if (seen.empty()) return {0, 0, size.width, size.height};
  const auto& [pixels, box] = std::max_element(seen.begin(), seen.end(), [](const auto& a, const auto& b) {
                                return a.second.first < b.second.first;
                              })->second;
  const double scale = std::sqrt(static_cast<double>(pixels) / kFilled / static_cast<double>(size.area()));
  const double kept = std::clamp(scale, static_cast<double>(kMinWidth) / size.width, 1.0);
  const int width = static_cast<int>(kept * size.width);
  const int height = static_cast<int>(kept * size.height);
  return {std::clamp(box.x + (box.width - width) / 2, 0, size.width - width),
          std::clamp(box.y + (box.height - height) / 2, 0, size.height - height), width, height};
}

/// The fitted numbers of a job.
struct Models {
  const HintNetwork& network;
  const FittedTrees& same_thing;
  const FittedTrees& whole_object;
};

void record_floor(std::ofstream& file, int job, Part part, const Models& by) {
  constexpr float kFar_m = 12;
  constexpr double kWeightOfFar = 0.3;
  // Of the floor from the plane that was found, as a share of the camera's height: beyond, that is another one.
  constexpr float kMaxOff = 0.25F;
  Config config;
  config.match.num_disparities = part.num_disparities;
  const Exec exec;
  const Run run{part.rig, config, exec};
  StageClock stage(exec);
  RegionCandidates cut = superpixel_candidates(part.in, run, by.network, stage);
  cut.tree = grow_merge_tree(cut.superpixels, cut.cues(part.in.left), by.same_thing, exec);
  cut.match.stereo.confidence = estimate_confidence(cut.match.matches, cut.match.stereo.disparity,
                                                    confidence_model(config.match.method), exec);
  const Background background = cut.background;
  const Image<float> surface_disparity_px = cut.surface_disparity_px.clone();
  const Image<ObjectHint> hints = cut.hints.clone();
  const auto choose = [&](const RegionCandidates& candidates, const ChoiceLimits& limits) {
    return choose_objects(candidates.tree, by.whole_object, limits, exec);
  };
  const Frame frame = frame_of_candidates(part.in, std::move(cut), run, choose);
  if (!frame.ground.plane) return;
  const View<const RegionId> superpixels = frame.superpixels.labels;
  const ObstacleCues cues{frame.disparity,
                          surface_disparity_px,
                          frame.confidence,
                          frame.ground,
                          background,
                          superpixels,
                          frame.objects.labels,
                          frame.refined.disparity_px,
                          frame.refined.confidence};
  const FloorGroups groups = group_by_floor(cues, hints, part.rig, config.ground, exec);
  const float infinity_px = part.rig ? -part.rig->doffs_px : 0;
  std::vector<std::array<double, 2>> known(groups.features.size());  // weights: of all, of floor
  for (int y = 0; y < superpixels.height(); ++y) {
    for (int x = 0; x < superpixels.width(); ++x) {
      if (groups.kinds(x, y) == FloorKind::not_judged || part.objects(x, y) == TruthId::dont_care) continue;
      const float d = part.truth_px(x, y) - infinity_px;
      const float floor_px =
          frame.ground.plane->disparity_px(static_cast<float>(x), static_cast<float>(y)) - infinity_px;
      const bool is_floor = part.ground(x, y) == 255;
      if (is_floor && !(std::abs(d / floor_px - 1) <= kMaxOff)) continue;
      const bool is_far = !part.rig || !(d * kFar_m > part.rig->focal_px * part.rig->baseline_m);
      const double weight = is_far ? kWeightOfFar : 1;
      auto& [all, floor] = known[FloorGroups::group(superpixels(x, y), groups.kinds(x, y))];
      all += weight;
      floor += is_floor ? weight : 0;
    }
  }
  for (std::size_t i = 0; i < known.size(); ++i) {
    const auto [all, floor] = known[i];
    if (all > 0 && groups.pixels[i] > 0)
      record(file, job, static_cast<float>(floor / all), static_cast<float>(all), groups.features[i]);
  }
}

void print_found(int job, const TrueFrame& frame, const ObjectErrors& errors, const ChosenObjects& chosen,
                 const Truth& known, const std::vector<float>& node_scores, double milliseconds) {
  int right = 0;
  int ours = 0;
  int phantoms = 0;
  std::ostringstream scores;
  for (const FoundObjectScore& found : errors.ours) {
    if (found.mostly_dont_care) continue;
    ++ours;
    right += found.iou >= 0.5 ? 1 : 0;
    phantoms += found.phantom ? 1 : 0;
    scores << chosen.scores[slot(number(found.id))] << ':' << (found.iou >= 0.5 ? 1 : 0) << ',';
  }
  std::ostringstream ious;
  std::ostringstream stages;
  for (const TrueObjectScore& truth : errors.truth) {
    ious << truth.iou << ',';
    const auto [node, iou_of_node] = known.best_node(truth.id);
    stages << truth.pixel_count << ':' << known.best_iou_of_superpixels(truth.id) << ':' << iou_of_node << ':'
           << node_scores[node] << ',';
  }
  std::cout << job << ' ' << frame.name << ' ' << frame.partial << ' ' << ours << ' ' << right << ' '
            << phantoms << " =" << ious.str() << " =" << scores.str() << ' ' << milliseconds << " ="
            << stages.str() << '\n';
}

struct Job {
  int number = 0;
  std::string folder;
  bool grey = false;
  Models by;
};

void work(const Job& of, float min_score, Files& files) {
  const auto& [job, folder, grey, by] = of;
  const auto& [network, same_thing, whole_object] = by;
  const TrueFrame frame = load_true_frame(io::find_frames(folder).front());
  if (files.floor.is_open()) {
    std::cout << job << '\n';
    if (frame.truth_px.empty() || frame.partial || frame.ground.empty()) return;
    const Size whole = frame.objects.size();
    record_floor(files.floor, job, part_of(frame, grey, {0, 0, whole.width, whole.height}), by);
    record_floor(files.floor, job, part_of(frame, grey, close_up(frame.objects)), by);
    return;
  }
  Config config;
  config.match.num_disparities = frame.num_disparities;
  const Exec exec;
  const View<const Gray> left = frame.images.left.gray;
  StageClock stage(exec);
  FrameInput in{{left, grey ? View<const Rgb>{} : frame.images.left.rgb.view()}, frame.images.right.gray};
  RegionCandidates cut = superpixel_candidates(in, {frame.rig, config, exec}, network, stage);
  const Superpixels& superpixels = cut.superpixels;
  if (files.inputs.is_open()) {
    record_input(files.inputs, job, hint_input(superpixels.edges, cut.cues(in.left), exec), frame);
    std::cout << job << '\n';
    return;
  }
  std::vector<Pair> pairs;
  JudgedPair on_judged;
  if (files.pairs.is_open())
    on_judged = [&](std::int32_t a, std::int32_t b, const MergeFeatures& f) { pairs.push_back({a, b, f}); };
  const double start = timing::now_ms(CLOCK_THREAD_CPUTIME_ID);
  const MergeTree tree = grow_merge_tree(superpixels, cut.cues(in.left), same_thing, exec, on_judged);
  config.objects.min_confidence = min_score;
  const ChoiceLimits limits = limits_of(config.objects, left.size());
  const std::vector<float> scores = score_nodes(tree, whole_object, limits);
  const ChosenObjects chosen = choose_by_scores(tree, scores, limits);
  const double milliseconds = timing::now_ms(CLOCK_THREAD_CPUTIME_ID) - start;
  const Truth truth(frame, superpixels, tree);
  if (files.pairs.is_open()) record_pairs(files.pairs, job, pairs, truth);
  if (files.regions.is_open()) record_regions(files.regions, job, tree, truth, left.size());
  if (files.bias.is_open() && !frame.truth_px.empty() && !frame.partial && frame.rig) {
    const DisparityMap& disparity = cut.match.stereo.disparity;
    const Segmentation groups = object_regions(superpixels, chosen, disparity, exec);
    const Objects objects = measure(groups.labels, chosen.scores, disparity, in.left, exec);
    record_bias(files.bias, job, frame, objects, disparity, in.right, exec);
  }
  if (files.planes.is_open() && !frame.truth_px.empty()) {
    const DisparityMap& disparity = cut.match.stereo.disparity;
    const Image<float> confidence =
        estimate_confidence(cut.match.matches, disparity, confidence_model(config.match.method), exec);
    refine_disparity(
        {superpixels, tree, chosen, cut.cues(in.left), confidence}, FittedTrees{}, exec,
        [&](const JudgedPlane& judged) { record_plane(files.planes, job, judged, frame.truth_px); });
  }
  Image<ObjectId> ours(left.size());
  for (int y = 0; y < left.height(); ++y) {
    for (int x = 0; x < left.width(); ++x)
      ours(x, y) = ObjectId{chosen.object_of[index(superpixels.labels(x, y))]};
  }
  print_found(job, frame, object_errors(ours, frame.objects, {}), chosen, truth, scores, milliseconds);
}

/// The features, one per line: those of pairs, an empty line, those of regions, an empty line, those of the
/// bias, an empty line, those of planes, an empty line, those of the floor.
int print_names() {
  for (const std::string_view name : merge_feature_names()) std::cout << name << '\n';
  std::cout << '\n';
  for (const std::string_view name : object_feature_names()) std::cout << name << '\n';
  std::cout << '\n';
  for (const std::string_view name : bias_feature_names()) std::cout << name << '\n';
  std::cout << '\n';
  for (const std::string_view name : plane_feature_names()) std::cout << name << '\n';
  std::cout << '\n';
  for (const std::string_view name : floor_feature_names()) std::cout << name << '\n';
  return 0;
}

int run(std::span<char*> arguments) {
  if (std::string_view(arguments[1]) == "--names") return print_names();
  Files files;
  float min_score = Config{}.objects.min_confidence;
  for (std::size_t i = 2; i + 1 < arguments.size(); i += 2) {
    const std::string option = arguments[i];
    const std::string value = arguments[i + 1];
    if (option == "--pairs") files.pairs.open(value, std::ios::binary);
    if (option == "--regions") files.regions.open(value, std::ios::binary);
    if (option == "--inputs") files.inputs.open(value, std::ios::binary);
    if (option == "--bias") files.bias.open(value, std::ios::binary);
    if (option == "--planes") files.planes.open(value, std::ios::binary);
    if (option == "--floor") files.floor.open(value, std::ios::binary);
    if (option == "--min-score") min_score = std::stof(value);
  }
  std::ifstream jobs(arguments[1]);
  FittedCache<FittedTrees> trees(load_trees);
  FittedCache<HintNetwork> networks(load_network);
  std::string folder;
  std::string colour;
  std::string hints;
  std::string same_thing;
  std::string whole_object;
  for (int job = 0; jobs >> folder >> colour >> hints >> same_thing >> whole_object; ++job) {
    work({job,
          folder,
          colour == "grey",
          {networks.at(hints, hint_network()), trees.at(same_thing, merge_classifier()),
           trees.at(whole_object, object_classifier())}},
         min_score, files);
  }
  return 0;
}

}  // namespace
}  // namespace cairn::lab

int main(int argc, char** argv) {
  try {
    if (argc < 2) throw cairn::Error("fitting: which jobs?");
    return cairn::lab::run({argv, static_cast<std::size_t>(argc)});
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 2;
  }
}
