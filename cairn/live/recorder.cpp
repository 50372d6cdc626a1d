// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/live/recorder.hpp>

#include <array>
#include <atomic>
#include <cairn/core/error.hpp>
#include <cairn/io/calibration_files.hpp>
#include <cairn/io/config_files.hpp>
#include <cairn/output/follow_files.hpp>
#include <condition_variable>
#include <cstdio>
#include <ctime>
#include <deque>
#include <mutex>
#include <nlohmann/json.hpp>
#include <system_error>
#include <thread>

#include <cairn/input/camera/without_password.hpp>
#include <cairn/ros/mcap.hpp>

namespace cairn::live {
namespace {

using Json = nlohmann::ordered_json;

/// Step between the pixels of a cloud.
constexpr int kCloudStride = 2;

std::string config_text(const std::string& preset, const FollowConfig& config) {
  return "preset: " + preset + "\n" + io::options_yaml(options(config));
}

std::string utc_text(const char* format) {
  const std::time_t now = std::time(nullptr);
  std::tm parts{};
  ::gmtime_r(&now, &parts);
  std::array<char, 64> text{};
  return {text.data(), std::strftime(text.data(), text.size(), format, &parts)};
}

bool is_same(View<const Gray> a, View<const Gray> b) {
  for (int y = 0; y < a.height(); ++y)
    if (!std::equal(a.row(y), a.row(y) + a.width(), b.row(y))) return false;
  return true;
}

/// A recording file and its channels.
class Recording {
 public:
  Recording(const std::filesystem::path& path, const RecordedRun& run, const RecorderOptions& options)
      : run_(run), what_(options.what), file_(path) {
    file_.metadata("cairn", {{"version", CAIRN_VERSION},
                             {"source", run.source},
                             {"stamps_from", run.stamps_from},
                             {"preset", run.preset},
                             {"tracks", run.tracks ? "yes" : "no"},
                             {"started_utc", utc_text("%Y-%m-%dT%H:%M:%SZ")}});
    if (run.rig) {
      file_.attachment("calib.txt", "text/plain",
                       io::calibration_text(*run.rig, run.size, run.disparities, run.ground));
    }
    if (what_.input) {
      left_ = add<ros::Image>("/stereo/left/image_rect");
      right_ = add<ros::Image>("/stereo/right/image_rect");
      if (run.rig) {
        left_info_ = add<ros::CameraInfo>("/stereo/left/camera_info");
        right_info_ = add<ros::CameraInfo>("/stereo/right/camera_info");
      }
    }
    if (what_.objects) {
      objects_ = add<ros::Detection3DArray>("/cairn/objects");
      frames_ = add<ros::String>("/cairn/frames");
      stats_ = add<ros::String>("/cairn/stats");
      transforms_ = add<ros::TFMessage>("/tf");
    }
    if (what_.disparity) disparity_ = add<ros::DisparityImage>("/cairn/disparity");
    if (what_.masks) {
      labels_ = add<ros::Image>("/cairn/labels");
      reject_ = add<ros::Image>("/cairn/reject");
    }
    if (what_.clouds) {
      obstacles_ = add<ros::PointCloud2>("/cairn/obstacles");
      floor_ = add<ros::PointCloud2>("/cairn/floor");
    }
    if (what_.grid) grid_ = add<ros::OccupancyGrid>("/cairn/grid");
  }

  void add_frame(const LiveFrame& frame, std::uint64_t skipped_before);
  void flush() { file_.flush(); }
  void close() { file_.close(); }
  [[nodiscard]] std::uint64_t bytes() const { return file_.bytes(); }

 private:
  template <class M>
  std::uint16_t add(const char* topic) {
    return file_.channel(topic, M::kType, ros::schema_of<M>());
  }
  template <class M>
  void write(std::uint16_t channel, Stamp stamp, const M& message) {
    file_.message(channel, stamp, ros::encode(message));
  }
  void write_text(std::uint16_t& channel, const char* topic, Stamp stamp, const std::string& text) {
    if (channel == 0) channel = add<ros::String>(topic);
    write(channel, stamp, ros::String{text});
  }
  void add_input(const LiveFrame& frame, const ros::Header& header);
  void add_objects(const LiveFrame& frame, const ros::Header& header);
  void add_config(const LiveFrame& frame);

  RecordedRun run_;
  RecordWhat what_;
  ros::FrameNames names_;  // of the previous frame
  ros::McapWriter file_;
  std::optional<std::uint64_t> revision_;
  // Channel ids; 0 = none.
  std::uint16_t left_ = 0;
  std::uint16_t left_grey_ = 0;
  std::uint16_t right_ = 0;
  std::uint16_t left_info_ = 0;
  std::uint16_t right_info_ = 0;
  std::uint16_t objects_ = 0;
  std::uint16_t frames_ = 0;
  std::uint16_t stats_ = 0;
  std::uint16_t transforms_ = 0;
  std::uint16_t disparity_ = 0;
  std::uint16_t labels_ = 0;
  std::uint16_t reject_ = 0;
  std::uint16_t obstacles_ = 0;
  std::uint16_t floor_ = 0;
  std::uint16_t grid_ = 0;
  std::uint16_t config_ = 0;
  std::uint16_t skipped_ = 0;
};

void Recording::add_frame(const LiveFrame& frame, std::uint64_t skipped_before) {
  const Stamp stamp = frame.step.stamp;
  names_ = ros::frame_names(frame.pair->frame_id);
  const ros::Header header = ros::header_of(stamp, names_.camera);
  add_config(frame);
  if (skipped_before > 0)
    write_text(skipped_, "/cairn/skipped", stamp, Json{{"frames", skipped_before}}.dump());
  if (what_.input) add_input(frame, header);
  if (what_.objects) add_objects(frame, header);
  const Frame& found = frame.step.frame;
  if (what_.disparity) {
    write(disparity_, stamp,
          ros::disparity_image_of(header, found, run_.rig, frame.config->segmentation.match));
  }
  if (what_.masks) {
    write(labels_, stamp, ros::labels_of(header, frame.step));
    write(reject_, stamp, ros::reject_of(header, found));
  }
  if (what_.clouds) {
    const io::LoadedImage& left = frame.pair->left;
    for (const auto& [channel, space] :
         {std::pair{obstacles_, ObstacleLabel::obstacle}, {floor_, ObstacleLabel::floor}})
      write(channel, stamp, ros::cloud_of(header, found, space, run_.rig, left.gray, left.rgb, kCloudStride));
  }
  if (what_.grid) {
    if (const auto grid = ros::grid_of(ros::header_of(stamp, names_.floor), found, run_.rig,
                                       frame.config->segmentation.obstacles))
      write(grid_, stamp, *grid);
  }
}

/// With the first frame as an attachment, which a later run can use; later changes as messages.
void Recording::add_config(const LiveFrame& frame) {
  if (revision_ == frame.revision) return;
  const std::string text = config_text(run_.preset, *frame.config);
  if (!revision_) {
    file_.attachment("config.yaml", "application/yaml", text);
  } else {
    write_text(config_, "/cairn/config", frame.step.stamp, text);
  }
  revision_ = frame.revision;
}

void Recording::add_input(const LiveFrame& frame, const ros::Header& header) {
  const io::SequenceFrame& pair = *frame.pair;
  if (pair.left.rgb.empty()) {
    write(left_, pair.stamp, ros::image_of(header, pair.left.gray.view()));
  } else {
    write(left_, pair.stamp, ros::image_of(header, pair.left.rgb.view()));
    // In pairs rectified here, colour and grey are interpolated separately, so grey may differ.
    const Image<Gray> grey = io::grey_of(pair.left.rgb.view());
    if (!is_same(grey, pair.left.gray)) {
      if (left_grey_ == 0) left_grey_ = add<ros::Image>("/stereo/left/image_grey");
      write(left_grey_, pair.stamp, ros::image_of(header, pair.left.gray.view()));
    }
  }
  write(right_, pair.stamp, ros::image_of(header, pair.right.view()));
  if (!run_.rig) return;
  write(left_info_, pair.stamp, ros::camera_info_of(header, *run_.rig, run_.size, ros::Side::left));
  write(right_info_, pair.stamp, ros::camera_info_of(header, *run_.rig, run_.size, ros::Side::right));
}

void Recording::add_objects(const LiveFrame& frame, const ros::Header& header) {
  const Stamp stamp = frame.step.stamp;
  write(objects_, stamp, ros::detections_of(header, frame.step, run_.rig));
  if (run_.tracks) {
    LandmarkUpdate marked;
    marked.tracks = frame.landmarks;
    marked.events = frame.events;
    write(frames_, stamp,
          ros::String{io::step_json(frame.step, frame.pair->name, marked, frame.pair->frame_id)});
  } else {
    write(frames_, stamp,
          ros::String{io::objects_json(
              frame.step.frame,
              {run_.preset, frame.config->segmentation, run_.rig, {}, false, frame.step.stamp.ns})});
  }
  Json stages = Json::object();
  for (const io::StageTime& stage : frame.stages) stages[stage.stage] = stage.milliseconds;
  const Json stats{{"name", frame.pair->name},
                   {"index", frame.pair->index},
                   {"rate_hz", frame.rate_hz},
                   {"waited_ms", ms_between(frame.arrived, frame.started)},
                   {"worked_ms", ms_between(frame.started, frame.done)},
                   {"stages_ms", stages},
                   {"not_worked_on",
                    {{"at_source", frame.drops.at_source},
                     {"replaced", frame.drops.replaced},
                     {"too_old", frame.drops.too_old}}}};
  write(stats_, stamp, ros::String{stats.dump(-1, ' ', false, Json::error_handler_t::replace)});
  ros::TFMessage transforms = ros::transforms_of(names_, frame.step, run_.rig);
  if (!transforms.transforms.empty()) write(transforms_, stamp, transforms);
}

}  // namespace

struct Recorder::State {
  State(RecordedRun of, RecorderOptions how) : run(std::move(of)), options(std::move(how)) {}

  struct WaitingFrame {
    LiveFramePtr frame;
    std::uint64_t skipped_before = 0;
  };
  void write_all();
  void fail(const std::string& why);

  const RecordedRun run;
  const RecorderOptions options;
  std::mutex starting;  // serialises start() and stop()
  std::unique_ptr<Recording> recording;
  std::thread thread;
  mutable std::mutex mutex;  // guards all members below
  std::condition_variable changed;
  std::deque<WaitingFrame> queue;
  std::uint64_t skipped_before = 0;
  std::uint64_t in_file = 0;  // frames written; those in the current chunk are not
  bool is_stopping = false;
  RecorderStatus status;
};

Recorder::Recorder(RecordedRun run, RecorderOptions options)
    : state_(std::make_unique<State>(std::move(run), std::move(options))) {}

Recorder::~Recorder() {
  stop();
}

void Recorder::start(const std::filesystem::path& path) {
  State& s = *state_;
  const std::lock_guard one_at_a_time(s.starting);
  if (status().is_recording)
    throw Error(path.string() + ": cannot be recorded, " + s.status.path + " is being recorded");
  if (s.thread.joinable()) s.thread.join();  // a recording that ended by itself
  std::error_code unknown;
  if (std::filesystem::exists(path, unknown) && !std::filesystem::is_character_file(path, unknown))
    throw Error(path.string() + ": already exists, expected a new file to record into");
  try {
    s.recording = std::make_unique<Recording>(path, s.run, s.options);
  } catch (...) {
    if (std::filesystem::is_regular_file(path, unknown)) std::filesystem::remove(path, unknown);
    throw;
  }
  {
    const std::lock_guard lock(s.mutex);
    s.queue.clear();
    s.skipped_before = 0;
    s.in_file = 0;
    s.is_stopping = false;
    s.status = {true, path.string(), 0, 0, s.recording->bytes(), {}};
  }
  s.thread = std::thread([&s] { s.write_all(); });
}

void Recorder::stop() {
  State& s = *state_;
  const std::lock_guard one_at_a_time(s.starting);
  {
    const std::lock_guard lock(s.mutex);
    s.is_stopping = true;
  }
  s.changed.notify_all();
  if (s.thread.joinable()) s.thread.join();
}

RecorderStatus Recorder::status() const {
  const std::lock_guard lock(state_->mutex);
  return state_->status;
}

void Recorder::offer(const LiveFramePtr& frame) {
  State& s = *state_;
  std::unique_lock lock(s.mutex);
  const auto has_room = [&] {
    return s.queue.size() < s.options.most_waiting || !s.status.is_recording || s.is_stopping;
  };
  if (s.options.waits) s.changed.wait(lock, has_room);
  if (!s.status.is_recording || s.is_stopping) return;
  if (!has_room()) {
    ++s.skipped_before;
    ++s.status.skipped;
    return;
  }
  s.queue.push_back({frame, std::exchange(s.skipped_before, 0)});
  lock.unlock();
  s.changed.notify_all();
}

/// Runs on its own thread until stopped, or until the file cannot be written.
void Recorder::State::write_all() {
  try {
    while (true) {
      WaitingFrame next;
      {
        std::unique_lock lock(mutex);
        changed.wait_for(lock, std::chrono::seconds(1), [&] { return !queue.empty() || is_stopping; });
        if (queue.empty() && is_stopping) break;
        if (!queue.empty()) {
          next = std::move(queue.front());
          queue.pop_front();
        }
      }
      changed.notify_all();
      if (next.frame) {
        recording->add_frame(*next.frame, next.skipped_before);
      } else {
        recording->flush();
      }
      const std::lock_guard lock(mutex);
      // The messages written by now include all earlier frames.
      if (recording->bytes() != status.bytes) in_file = status.frames;
      status.frames += next.frame ? 1 : 0;
      status.bytes = recording->bytes();
    }
    recording->close();
    const std::lock_guard lock(mutex);
    status.bytes = recording->bytes();
    status.is_recording = false;
  } catch (const std::exception& error) {
    fail(error.what());
  }
  recording.reset();
}

void Recorder::State::fail(const std::string& why) {
  std::string line;
  {
    const std::lock_guard lock(mutex);
    status.is_recording = false;
    status.frames = in_file;
    status.trouble = why;
    queue.clear();
    line = "recording stopped: " + why;
  }
  changed.notify_all();
  if (options.on_trouble) options.on_trouble(line);
}

std::string Recorder::summary() const {
  const RecorderStatus now = status();
  if (now.path.empty()) return {};
  std::array<char, 160> numbers{};
  std::snprintf(numbers.data(), numbers.size(), "%llu frames, %.1f MB",
                static_cast<unsigned long long>(now.frames), static_cast<double>(now.bytes) * 1e-6);
  std::string text = "recorded " + now.path + ": " + numbers.data();
  if (now.skipped > 0) text += ", " + std::to_string(now.skipped) + " skipped because the disk was too slow";
  if (!now.trouble.empty()) text += "; stopped: " + now.trouble;
  return text;
}

RecordWhat parse_record_what(std::string_view text) {
  RecordWhat what;
  const std::array<std::pair<std::string_view, bool RecordWhat::*>, 6> known{
      {{"input", &RecordWhat::input},
       {"objects", &RecordWhat::objects},
       {"disparity", &RecordWhat::disparity},
       {"masks", &RecordWhat::masks},
       {"clouds", &RecordWhat::clouds},
       {"grid", &RecordWhat::grid}}};
  std::string_view rest = text;
  while (true) {
    const std::size_t comma = rest.find(',');
    const std::string_view word = rest.substr(0, comma);
    bool is_known = word == "all";
    for (const auto& [name, member] : known) {
      if (word != name && word != "all") continue;
      what.*member = true;
      is_known = true;
    }
    if (!is_known) {
      throw Error("--record-what: found \"" + std::string(word) +
                  "\", expected a list of input, objects, disparity, masks, clouds, grid, or all");
    }
    if (comma == std::string_view::npos) return what;
    rest.remove_prefix(comma + 1);
  }
}

RecordedRun recorded_run(const io::Sequence& source, const std::string& name, const std::string& preset,
                         bool tracks) {
  return {io::without_password(name), source.rig(),    source.image_size(),
          source.disparities(),       source.ground(), preset,
          source.stamps_from(),       tracks};
}

std::string recording_name() {
  return utc_text("cairn-%Y%m%d-%H%M%S.mcap");
}

}  // namespace cairn::live
