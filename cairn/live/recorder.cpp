// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/live/recorder.hpp>

#include <array>
#include <atomic>
#include <cairn/core/error.hpp>
#include <cairn/io/calibration_files.hpp>
#include <cairn/io/config_files.hpp>
#include <condition_variable>
#include <cstdio>
#include <ctime>
#include <deque>
#include <mutex>
#include <system_error>
#include <thread>

#include <cairn/input/camera/without_password.hpp>
#include <cairn/live/topics.hpp>
#include <cairn/ros/mcap.hpp>

namespace cairn::live {
namespace {

constexpr int kCloudStride = 2;  // px

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

/// A recording file and its channels.
class Recording {
 public:
  Recording(const std::filesystem::path& path, const RecordedRun& run, const RecorderOptions& options)
      : form_{.rig = run.rig, .cloud_stride = kCloudStride, .preset = run.preset, .tracks = run.tracks},
        file_(path) {
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
    for (const Topic& topic : topics()) {
      if (topic.recorded == nullptr || !(options.what.*topic.recorded)) continue;
      if (topic.declared == Announcement::with_rig && !run.rig) continue;
      const bool is_declared = topic.declared != Announcement::with_first_message;
      channels_.emplace_back(&topic, is_declared ? declare(topic) : std::uint16_t{0});
    }
  }

  void add_frame(const LiveFrame& frame, std::uint64_t skipped_before);
  void flush() { file_.flush(); }
  void close() { file_.close(); }
  [[nodiscard]] std::uint64_t bytes() const { return file_.bytes(); }

 private:
  std::uint16_t declare(const Topic& topic) {
    return file_.channel(full_name(topic), topic.type, topic.schema());
  }
  void write_text(std::uint16_t& channel, const char* topic, Stamp stamp, const std::string& text) {
    if (channel == 0) channel = file_.channel(topic, ros::String::kType, ros::schema_of<ros::String>());
    file_.message(channel, stamp, ros::encode(ros::String{text}));
  }
  void add_config(const LiveFrame& frame);

  MessageForm form_;
  ros::McapWriter file_;
  std::optional<std::uint64_t> revision_;
  // Channel ids; 0: not yet declared.
  std::vector<std::pair<const Topic*, std::uint16_t>> channels_;
  std::uint16_t config_ = 0;
  std::uint16_t skipped_ = 0;
};

void Recording::add_frame(const LiveFrame& frame, std::uint64_t skipped_before) {
  const Stamp stamp = frame.step.stamp;
  add_config(frame);
  if (skipped_before > 0)
    write_text(skipped_, "/cairn/skipped", stamp, output::json_text({{"frames", skipped_before}}));
  for (auto& [topic, channel] : channels_) {
    const MessagePtr message = message_of(*topic, frame, form_);
    if (!message) continue;
    if (channel == 0) channel = declare(*topic);
    file_.message(channel, stamp, *message);
  }
}

/// With the first frame as an attachment, which a later run can use; later changes as messages.
void Recording::add_config(const LiveFrame& frame) {
  if (revision_ == frame.revision) return;
  const std::string text = config_text(form_.preset, *frame.config);
  if (!revision_) {
    file_.attachment("config.yaml", "application/yaml", text);
  } else {
    write_text(config_, "/cairn/config", frame.step.stamp, text);
  }
  revision_ = frame.revision;
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
  std::snprintf(numbers.data(), numbers.size(), "%llu frame%s, %.1f MB",
                static_cast<unsigned long long>(now.frames), now.frames == 1 ? "" : "s",
                static_cast<double>(now.bytes) * 1e-6);
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

RecordedRun recorded_run(const input::Sequence& source, const std::string& name, const std::string& preset,
                         bool tracks) {
  return {input::without_password(name), source.rig(),    source.image_size(),
          source.disparities(),          source.ground(), preset,
          source.stamps_from(),          tracks};
}

std::string recording_name() {
  return utc_text("cairn-%Y%m%d-%H%M%S.mcap");
}

}  // namespace cairn::live
