// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/input/mcap_topics.hpp>

#include <algorithm>
#include <array>
#include <cairn/core/error.hpp>
#include <tuple>
#include <utility>
#include <vector>

#include <cairn/input/ros_depth.hpp>

namespace cairn::input {
namespace {

using ros::McapChannel;
using Channels = std::map<std::uint16_t, McapChannel>;

bool is_image(const McapChannel& channel) {
  return channel.encoding == "cdr" &&
         (channel.type == ros::Image::kType || channel.type == ros::CompressedImage::kType);
}
bool is_disparity(const McapChannel& channel) {
  return channel.encoding == "cdr" && channel.type == ros::DisparityImage::kType;
}
/// Whether it is what depth cameras publish beside an image, by type and name.
bool is_depth_of(const McapChannel& channel, const McapChannel& image) {
  return is_disparity(channel) || (is_image(channel) && is_named_depth_of(channel.topic, image.topic));
}
bool is_compressed(const McapChannel& channel) {
  return channel.type == ros::CompressedImage::kType;
}

const McapChannel* find(const Channels& channels, const std::string& topic) {
  const auto found =
      std::ranges::find_if(channels, [&](const auto& entry) { return entry.second.topic == topic; });
  return found == channels.end() ? nullptr : &found->second;
}

/// The topic with every `from` replaced; empty if `from` does not occur.
std::string replaced(std::string topic, const std::string& from, const std::string& to) {
  std::size_t at = topic.find(from);
  if (at == std::string::npos) return {};
  for (; at != std::string::npos; at = topic.find(from, at + to.size())) topic.replace(at, from.size(), to);
  return topic;
}

/// The topic of the right camera; nullptr if there is none.
const McapChannel* partner(const Channels& channels, const McapChannel& left) {
  constexpr std::array<std::pair<const char*, const char*>, 3> kSides{
      {{"left", "right"}, {"infra1", "infra2"}, {"cam0", "cam1"}}};
  for (const auto& [from, to] : kSides) {
    const std::string topic = replaced(left.topic, from, to);
    if (topic.empty()) continue;
    if (const McapChannel* right = find(channels, topic); right != nullptr && is_image(*right)) return right;
  }
  return nullptr;
}

/// "image_rect" of "/stereo/left/image_rect/compressed".
std::pair<std::string, std::string> split(const McapChannel& channel) {
  std::string topic = channel.topic;
  if (is_compressed(channel) && topic.ends_with("/compressed")) topic.resize(topic.size() - 11);
  const std::size_t slash = topic.rfind('/');
  if (slash == std::string::npos) return {"", topic};
  return {topic.substr(0, slash), topic.substr(slash + 1)};
}

bool is_raw(const McapChannel& channel) {
  return split(channel).second.find("raw") != std::string::npos;
}
/// Rank; lower is better.
std::tuple<bool, bool, bool, bool> rank(const McapChannel& channel) {
  const std::string name = split(channel).second;
  return {is_raw(channel), is_compressed(channel), name.find("rect") == std::string::npos,
          name.find("color") == std::string::npos};
}

std::string image_topics(const Channels& channels) {
  std::string all;
  for (const auto& [id, channel] : channels) {
    if (is_image(channel) || is_disparity(channel)) all += (all.empty() ? "" : ", ") + channel.topic;
  }
  return all;
}

std::optional<std::uint16_t> info_of(const Channels& channels, const McapChannel& image) {
  const McapChannel* info = find(channels, split(image).first + "/camera_info");
  if (info == nullptr || info->type != ros::CameraInfo::kType || info->encoding != "cdr") return std::nullopt;
  return info->id;
}

StereoTopics with_companions(const Channels& channels, const McapChannel& left, const McapChannel& right) {
  StereoTopics topics;
  topics.left = left;
  topics.right = right;
  topics.has_depth = is_disparity(right) || right.topic.ends_with("/compressedDepth");
  topics.is_raw = is_raw(left) && !topics.has_depth;
  topics.left_info = info_of(channels, left);
  topics.right_info = info_of(channels, right);
  if (const McapChannel* grey = find(channels, split(left).first + "/image_grey");
      grey != nullptr && grey->type == ros::Image::kType && split(left).second != "image_grey")
    topics.left_grey = grey->id;
  return topics;
}

/// The image that a depth image belongs to, by the names of the usual drivers; else the only image of the recording.
const McapChannel* image_with(const Channels& channels, const McapChannel& depth) {
  constexpr std::array<std::pair<const char*, const char*>, 5> kNames{{{"aligned_depth_to_color", "/color/"},
                                                                       {"depth_registered", "/rgb/"},
                                                                       {"/depth/", "/infra1/"},
                                                                       {"disparity", "/left/"},
                                                                       {"depth", "/left/"}}};
  std::vector<const McapChannel*> images;
  for (const auto& [id, channel] : channels)
    if (is_image(channel) && is_depth_of(depth, channel)) images.push_back(&channel);
  std::ranges::stable_sort(images, {}, [](const McapChannel* image) { return rank(*image); });
  for (const auto& [of_depth, of_image] : kNames) {
    if (depth.topic.find(of_depth) == std::string::npos) continue;
    for (const McapChannel* image : images)
      if (image->topic.find(of_image) != std::string::npos) return image;
  }
  return images.size() == 1 ? images.front() : nullptr;
}

/// Images with their depth.
std::vector<std::pair<const McapChannel*, const McapChannel*>> with_depth(const Channels& channels) {
  std::vector<std::pair<const McapChannel*, const McapChannel*>> found;
  for (const auto& [id, depth] : channels) {
    if (!is_disparity(depth) && !is_image(depth)) continue;
    if (const McapChannel* image = image_with(channels, depth)) found.emplace_back(image, &depth);
  }
  // A recording of cairn has its results, too, in a namespace of their own.
  const auto is_elsewhere = [](const auto& pair) {
    const auto first_of = [](const McapChannel* channel) {
      return channel->topic.substr(0, channel->topic.find('/', 1));
    };
    return first_of(pair.first) != first_of(pair.second);
  };
  if (!std::ranges::all_of(found, is_elsewhere)) std::erase_if(found, is_elsewhere);
  const auto is_packed = [](const auto& pair) { return is_compressed(*pair.second); };
  if (!std::ranges::all_of(found, is_packed)) std::erase_if(found, is_packed);
  return found;
}

}  // namespace

StereoTopics find_stereo_topics(const Channels& channels, const std::string& wanted,
                                const std::string& file) {
  const std::string all = image_topics(channels);
  const std::string there = all.empty() ? "it has no image topic in CDR" : "its images: " + all;
  if (!wanted.empty()) {
    const std::vector<std::string> names = split_topics(wanted);
    std::vector<const McapChannel*> images;
    for (const std::string& name : names) {
      images.push_back(find(channels, name));
      const bool may_be_disparity = images.size() == names.size();
      if (images.back() == nullptr ||
          !(is_image(*images.back()) || (may_be_disparity && is_disparity(*images.back()))))
        throw Error("--topics: " + file + " has no image topic " + name + "; " + there);
    }
    StereoTopics topics = with_companions(channels, *images.front(), *images.back());
    if (images.size() == 3) {
      topics.checking = *images[1];
      topics.right_info = info_of(channels, *images[1]);
    }
    return topics;
  }
  std::vector<std::pair<const McapChannel*, const McapChannel*>> best;
  for (const auto& [id, left] : channels) {
    if (!is_image(left)) continue;
    const McapChannel* right = partner(channels, left);
    if (right == nullptr) continue;
    if (!best.empty() && rank(left) < rank(*best.front().first)) best.clear();
    if (best.empty() || rank(left) == rank(*best.front().first)) best.emplace_back(&left, right);
  }
  const bool has_pair = !best.empty();
  if (!has_pair) best = with_depth(channels);
  if (best.empty()) {
    throw Error(file +
                ": has no topics of left and right images, nor of an image and its depth, expected --topics "
                "LEFT,RIGHT, IMAGE,DEPTH or LEFT,RIGHT,DEPTH; " +
                there);
  }
  if (best.size() > 1) {
    std::string pairs;
    for (const auto& [left, right] : best)
      pairs += (pairs.empty() ? "" : "; ") + left->topic + "," + right->topic;
    throw Error(file + ": has more than one pair, expected --topics with one of them: " + pairs);
  }
  StereoTopics topics = with_companions(channels, *best.front().first, *best.front().second);
  if (!has_pair) topics.has_depth = true, topics.is_raw = false;
  return topics;
}

}  // namespace cairn::input
