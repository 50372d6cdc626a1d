// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/input/camera/open_camera.hpp>

#include <algorithm>
#include <cairn/core/error.hpp>
#include <charconv>
#include <filesystem>
#include <optional>
#include <utility>

#include <cairn/input/camera/camera_sequence.hpp>
#include <cairn/input/camera/gst_camera.hpp>
#include <cairn/input/camera/without_password.hpp>

namespace cairn::input {
namespace {

constexpr std::string_view kV4l2 = "v4l2:";
constexpr std::string_view kGst = "gst:";
constexpr std::string_view kBetweenPipelines = " !! ";

std::vector<std::string> parts_of(std::string_view text, std::string_view between) {
  std::vector<std::string> parts;
  while (true) {
    const std::size_t end = text.find(between);
    parts.emplace_back(text.substr(0, end));
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + between.size());
  }
}

bool is_rtsp(std::string_view source) {
  return source.starts_with("rtsp://") || source.starts_with("rtsps://");
}

std::optional<double> number_in(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

int side_in(const std::string& source, const std::string& key, const std::string& value) {
  constexpr double kMax = 32768;
  const std::optional<double> number = number_in(value);
  if (!number || *number < 1 || *number > kMax || *number != static_cast<int>(*number))
    throw Error(source + ": " + key + ": found '" + value + "', expected 1 ... 32768 px");
  return static_cast<int>(*number);
}

/// A key=value option of a V4L2 source.
void set_key(V4l2Request& request, std::string& layout, const std::string& source, const std::string& part) {
  const std::size_t equals = part.find('=');
  const std::string key = part.substr(0, equals);
  const std::string value = equals == std::string::npos ? "" : part.substr(equals + 1);
  if (key == "w") {
    request.size.width = side_in(source, key, value);
  } else if (key == "h") {
    request.size.height = side_in(source, key, value);
  } else if (key == "fps") {
    const std::optional<double> fps = number_in(value);
    if (!fps || !(*fps > 0 && *fps <= 1000))
      throw Error(source + ": fps: found '" + value + "', expected a rate up to 1000 Hz");
    request.fps = *fps;
  } else if (key == "format") {
    if (value != "YUYV" && value != "GREY" && value != "MJPG" && value != "Y8I")
      throw Error(source + ": format: found '" + value + "', expected YUYV, GREY, MJPG or Y8I");
    request.format = value;
  } else if (key == "layout") {
    layout = value;
  } else {
    throw Error(source + ": found '" + part +
                "', expected a second device or w=, h=, fps=, format= or layout=");
  }
}

void check(const SourceOptions& options, const std::string& source) {
  if (options.rate_hz > 0)
    throw Error("--rate: is for sources without stamps, and the images of " + source + " have stamps");
}

GstRequest gst_request(const std::string& part, const std::string& source) {
  GstRequest request;
  if (is_rtsp(part)) {
    // A buffer of 50 ms compensates for network jitter; later packets are dropped.
    request.pipeline =
        "rtspsrc name=cairn_source latency=50 drop-on-latency=true ! application/x-rtp,media=video ! "
        "decodebin";
    request.location = part;
    request.must_not_end = true;
    return request;
  }
  request.pipeline = part;
  const std::size_t first = part.find_first_not_of(' ');
  if (first == std::string::npos)
    throw Error(source + ": found an empty pipeline, expected one for gst-launch-1.0, without the sink");
  return request;
}

std::unique_ptr<Sequence> open_pipelines(const std::string& source, const SourceOptions& options,
                                         const Pool& pool) {
  const std::string shown = without_password(source);
  check(options, shown);
  std::string_view text = source;
  if (text.starts_with(kGst)) text.remove_prefix(kGst.size());
  const std::vector<std::string> parts = parts_of(text, kBetweenPipelines);
  if (parts.size() > 2) {
    throw Error(shown + ": has " + std::to_string(parts.size()) +
                " pipelines, expected one with both images or LEFT !! RIGHT");
  }
  if (parts.size() == 2 && !options.layout.empty())
    throw Error("--layout " + options.layout + ": is for one pipeline with both images, found two");
  std::vector<CameraMaker> makers;
  for (const std::string& part : parts) {
    GstRequest request = gst_request(part, shown);
    request.layout = parts.size() == 2 ? Layout::one : layout_of(options.layout);
    request.with_colour = makers.empty();
    request.pool = pool;
    makers.emplace_back([request] { return open_gst(request); });
  }
  const std::string name = is_rtsp(text) ? "rtsp" : "gst";
  return camera_sequence({shown, name, "the pipeline"}, std::move(makers), options, pool);
}

}  // namespace

bool is_camera(std::string_view source) {
  return source.starts_with(kV4l2) || source.starts_with(kGst) || is_rtsp(source);
}

std::vector<V4l2Request> parse_v4l2(const std::string& source, const SourceOptions& options) {
  V4l2Request asked;
  std::string layout;
  std::vector<std::string> devices;
  for (const std::string& part : parts_of(std::string_view(source).substr(kV4l2.size()), ",")) {
    if (part.starts_with('/')) {
      devices.push_back(part);
    } else {
      set_key(asked, layout, source, part);
    }
  }
  if (devices.empty() || devices.size() > 2) {
    throw Error(source + ": has " + std::to_string(devices.size()) +
                " devices, expected one with both images or two, as v4l2:/dev/video0 or "
                "v4l2:/dev/video0,/dev/video2");
  }
  if ((asked.size.width > 0) != (asked.size.height > 0))
    throw Error(source + ": has one of w= and h=, expected both or none");
  if (!layout.empty() && !options.layout.empty() && layout != options.layout)
    throw Error("--layout " + options.layout + ": found layout=" + layout + " as well");
  if (layout.empty()) layout = options.layout;
  const bool has_two = devices.size() == 2;
  if (has_two && devices[0] == devices[1])
    throw Error(source + ": has the same device twice, expected one with both images or two");
  if (has_two && !layout.empty())
    throw Error(source + ": layout: is for one device with both images, found two devices");
  if (has_two && asked.format == "Y8I")
    throw Error(source + ": format=Y8I: has both images in one, found two devices");
  asked.layout = has_two ? Layout::one : layout_of(layout);
  std::vector<V4l2Request> requests;
  for (const std::string& device : devices) {
    requests.push_back(asked);
    requests.back().device = device;
    requests.back().with_colour = requests.size() == 1;
  }
  return requests;
}

std::unique_ptr<Sequence> open_v4l2_sequence(const std::string& source, const SourceOptions& options,
                                             const Pool& pool, V4l2Ops& ops, CameraTimes times) {
  check(options, source);
  std::vector<CameraMaker> makers;
  std::string name;
  for (const V4l2Request& request : parse_v4l2(source, options)) {
    name += (name.empty() ? "" : ",") + std::filesystem::path(request.device).filename().string();
    makers.emplace_back([request, &ops, pool] { return open_v4l2(request, ops, pool); });
  }
  return camera_sequence({source, name, "the kernel"}, std::move(makers), options, pool, times);
}

std::unique_ptr<Sequence> open_camera(const std::string& source, const SourceOptions& options,
                                      const Pool& pool) {
  if (source.starts_with(kV4l2)) return open_v4l2_sequence(source, options, pool, system_v4l2());
  return open_pipelines(source, options, pool);
}

}  // namespace cairn::input
