// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cairn/batch/shard.hpp>
#include <cairn/core/error.hpp>
#include <cairn/io/atomic_file.hpp>
#include <cairn/io/names_and_numbers.hpp>
#include <cairn/io/sha256.hpp>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <system_error>

namespace cairn::batch {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxShards = 1'000'000;
constexpr std::size_t kRowsBetweenSyncs = 256;
constexpr double kSecondsBetweenSyncs = 60;
constexpr double kSecondsBetweenNotes = 2;
constexpr std::size_t kDigest = 16;  // hexadecimal digits before each row in work/

double now_s() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

std::optional<std::size_t> count_in(std::string_view text) {
  std::size_t count = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
  if (text.empty() || error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return count;
}

std::optional<std::size_t> count_of_variable(const char* name) {
  const char* text = std::getenv(name);
  if (text == nullptr || *text == '\0') return std::nullopt;
  const auto count = count_in(text);
  if (!count) throw Error(std::string(name) + ": found " + text + ", expected a whole number");
  return count;
}

std::string name_of(Shard shard) {
  return "part-" + std::to_string(shard.number) + "-of-" + std::to_string(shard.of);
}

/// A file for appending, with explicit synchronisation to disk.
class OpenFile {
 public:
  OpenFile(fs::path path, int flags) : path_(std::move(path)) {
    descriptor_ = ::open(path_.c_str(), flags | O_CLOEXEC, 0666);
    if (descriptor_ < 0) refuse();
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  ~OpenFile() { ::close(descriptor_); }

  [[noreturn]] void refuse() const {
    throw Error(path_.string() + ": cannot be written: " + std::generic_category().message(errno));
  }
  void append(std::string_view bytes) const {
    while (!bytes.empty()) {
      const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) refuse();
      bytes.remove_prefix(static_cast<std::size_t>(written));
    }
  }
  void cut(std::uintmax_t bytes) const {
    if (::ftruncate(descriptor_, static_cast<off_t>(bytes)) != 0) refuse();
    if (::lseek(descriptor_, 0, SEEK_END) < 0) refuse();
  }
  void sync() const {
    if (::fsync(descriptor_) != 0 && errno != EINVAL && errno != EROFS) refuse();
  }
  [[nodiscard]] int descriptor() const { return descriptor_; }

 private:
  fs::path path_;
  int descriptor_ = -1;
};

/// A new file name is durable only after its folder is synchronised.
void sync_folder(const fs::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  (void)::fsync(descriptor);
  ::close(descriptor);
}

std::string note_text(const WorkerNote& note) {
  return Json{{"host", note.host},           {"pid", note.pid},         {"started_s", note.started_s},
              {"updated_s", note.updated_s}, {"resumed", note.resumed}, {"rows", note.rows},
              {"errors", note.errors}}
             .dump() +
         "\n";
}

std::optional<WorkerNote> note_in(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string line;
  std::getline(in, line);
  const Json json = Json::parse(line, nullptr, false);
  if (!json.is_object()) return std::nullopt;
  try {
    WorkerNote note{json.at("host").get<std::string>(),    json.at("pid").get<long>(),
                    json.at("started_s").get<double>(),    json.at("updated_s").get<double>(),
                    json.at("resumed").get<std::size_t>(), json.at("rows").get<std::size_t>(),
                    json.at("errors").get<std::size_t>()};
    return note;
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;
  }
}

/// Exclusive access to a shard: a file lock, which the system releases however the process ends. The file is
/// not deleted: otherwise two processes could hold the lock.
class ShardLock {
 public:
  ShardLock(const fs::path& path, const std::function<void(const std::string&)>& on_wait)
      : file_(path, O_RDWR | O_CREAT) {
    if (::flock(file_.descriptor(), LOCK_EX | LOCK_NB) == 0) return;
    if (errno == EWOULDBLOCK) {
      const auto note = note_in(path);
      on_wait(note ? note->host + ", process " + std::to_string(note->pid) : "another worker");
      while (::flock(file_.descriptor(), LOCK_EX) != 0) {
        if (errno != EINTR) file_.refuse();
      }
      return;
    }
    is_held_ = false;  // the file system has no locks
  }
  [[nodiscard]] bool is_held() const { return is_held_; }

  /// For `cairn batch status`; failing to write it is not an error.
  void say(const WorkerNote& note) const {
    const std::string text = note_text(note);
    if (::pwrite(file_.descriptor(), text.data(), text.size(), 0) >= 0)
      (void)!::ftruncate(file_.descriptor(), static_cast<off_t>(text.size()));
  }

 private:
  OpenFile file_;
  bool is_held_ = true;
};

std::string digest_of(const Run& run, std::string_view row) {
  io::Sha256 sum;
  sum.add(run.id);
  sum.add(row);
  return sum.hex().substr(0, kDigest);
}

/// The row of a line in work/, if its digest shows that it is complete and of this run.
std::optional<std::string_view> row_in(const Run& run, std::string_view line) {
  if (line.size() < kDigest + 1 || line[kDigest] != ' ') return std::nullopt;
  const std::string_view row = line.substr(kDigest + 1);
  if (digest_of(run, row) != line.substr(0, kDigest)) return std::nullopt;
  return row;
}

/// The finished rows of a shard: its first ones, complete and in order.
class Checkpoint {
 public:
  Checkpoint(const Run& run, const fs::path& path, const std::vector<PlannedFrame>& frames)
      : run_(run), path_(path), file_(path, O_RDWR | O_CREAT | O_APPEND) {
    std::ifstream in(path, std::ios::binary);
    std::uintmax_t whole = 0;
    for (std::string line; rows_ < frames.size() && std::getline(in, line) && !in.eof();) {
      const auto row = row_in(run, line);
      if (!row || !row->starts_with(row_begin(frames[rows_].name))) break;
      errors_ += is_error_row(*row, frames[rows_].name) ? 1 : 0;
      whole += line.size() + 1;
      ++rows_;
    }
    file_.cut(whole);
  }

  [[nodiscard]] std::size_t rows() const { return rows_; }
  [[nodiscard]] std::size_t errors() const { return errors_; }

  void add(const std::string& row, const std::string& frame) {
    file_.append(digest_of(run_, row) + " " + row + "\n");
    errors_ += is_error_row(row, frame) ? 1 : 0;
    ++rows_;
    if (++unsynced_ < kRowsBetweenSyncs && now_s() - synced_s_ < kSecondsBetweenSyncs) return;
    file_.sync();
    unsynced_ = 0;
    synced_s_ = now_s();
  }

  /// Writes the rows to `made`, renames it to `part`, and deletes the checkpoint.
  void become(const fs::path& part, const fs::path& made) const {
    {
      const OpenFile out(made, O_WRONLY | O_CREAT | O_TRUNC);
      std::ifstream in(path_, std::ios::binary);
      std::size_t copied = 0;
      for (std::string line; std::getline(in, line); ++copied) {
        const auto row = row_in(run_, line);
        if (!row) break;
        out.append(std::string(*row) + "\n");
      }
      if (copied != rows_) {
        throw Error(path_.string() + ": row " + std::to_string(copied + 1) +
                    " is not what was written there; the same command continues from it");
      }
      out.sync();
    }
    std::error_code reason;
    fs::rename(made, part, reason);
    if (reason) throw Error(part.string() + ": cannot be written: " + reason.message());
    sync_folder(part.parent_path());
    fs::remove(path_, reason);
  }

 private:
  const Run& run_;
  fs::path path_;
  OpenFile file_;
  std::size_t rows_ = 0;
  std::size_t errors_ = 0;
  std::size_t unsynced_ = 0;
  double synced_s_ = now_s();
};

}  // namespace

std::string text(Shard shard) {
  return std::to_string(shard.number) + "/" + std::to_string(shard.of);
}

Shard parse_shard(std::string_view text) {
  const std::size_t slash = text.find('/');
  if (slash != std::string_view::npos) {
    const auto number = count_in(text.substr(0, slash));
    const auto of = count_in(text.substr(slash + 1));
    if (number && of && *number >= 1 && *number <= *of && *of <= kMaxShards) return {*number, *of};
  }
  throw Error("--shard: found " + std::string(text) + ", expected K/N with K from 1 to N (1/8 … 8/8)");
}

std::optional<Shard> shard_of_slurm() {
  const auto id = count_of_variable("SLURM_ARRAY_TASK_ID");
  if (!id) return std::nullopt;
  const std::size_t count = count_of_variable("SLURM_ARRAY_TASK_COUNT").value_or(0);
  const std::size_t first = count_of_variable("SLURM_ARRAY_TASK_MIN").value_or(0);
  const std::size_t step = std::max<std::size_t>(count_of_variable("SLURM_ARRAY_TASK_STEP").value_or(1), 1);
  if (count >= 1 && count <= kMaxShards && *id >= first && (*id - first) % step == 0 &&
      (*id - first) / step < count) {
    return Shard{(*id - first) / step + 1, count};
  }
  throw Error("SLURM_ARRAY_TASK_ID: found task " + std::to_string(*id) + " of an array of " +
              std::to_string(count) + " from " + std::to_string(first) +
              " on, expected one without gaps (--array=1-8), or --shard K/N");
}

FrameSpan span_of(Shard shard, const Run& run) {
  const std::size_t count = run.sequences.empty() ? run.frames : run.sequences.size();
  // Avoids the product of the two, which may overflow.
  const std::size_t each = count / shard.of;
  const std::size_t rest = count % shard.of;  // the first shards have one more
  const auto begin_of = [&](std::size_t before) {
    const std::size_t begin = each * before + std::min(before, rest);
    if (run.sequences.empty()) return begin;
    return begin < count ? run.sequences[begin] : run.frames;
  };
  return {begin_of(shard.number - 1), begin_of(shard.number)};
}

fs::path part_file(const Run& run, Shard shard) {
  return run.parts() / (name_of(shard) + ".jsonl");
}

std::optional<Shard> shard_of_file(const fs::path& file) {
  const std::string stem = file.stem().string();
  const std::size_t of = stem.find("-of-");
  if (!stem.starts_with("part-") || of == std::string::npos) return std::nullopt;
  const auto number = count_in(std::string_view(stem).substr(5, of - 5));
  const auto count = count_in(std::string_view(stem).substr(of + 4));
  if (!number || !count || *number < 1 || *number > *count || *count > kMaxShards) return std::nullopt;
  return Shard{*number, *count};
}

std::optional<SeenWorker> see_worker(const fs::path& lock_file) {
  const auto note = note_in(lock_file);
  if (!note) return std::nullopt;
  SeenWorker seen{*note, false};
  const int descriptor = ::open(lock_file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return seen;
  seen.is_held = ::flock(descriptor, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  ::close(descriptor);
  return seen;
}

WorkResult work_on(const Run& run, Shard shard, const MakeRow& make_row, const OnFrame& on_frame,
                   const std::function<void(const std::string&)>& on_wait) {
  const FrameSpan span = span_of(shard, run);
  WorkResult worked{false, span.end - span.begin};
  const fs::path part = part_file(run, shard);
  std::error_code unknown;
  if (fs::exists(part, unknown)) {
    worked.was_done = true;
    return worked;
  }
  io::make_folder(run.parts());
  io::make_folder(run.work());
  const ShardLock lock(run.work() / (name_of(shard) + ".lock"), on_wait);
  if (fs::exists(part, unknown)) {  // finished by the worker that held the lock
    worked.was_done = true;
    return worked;
  }
  std::vector<PlannedFrame> frames;
  each_planned(run, span.begin, span.end,
               [&](std::size_t, PlannedFrame frame) { frames.push_back(std::move(frame)); });
  const std::string host = io::host_name();
  WorkerNote note{host.empty() ? "unknown" : host, ::getpid(), now_s(), now_s()};
  // Without locks every worker has its own files: two may do the same work, and nothing is resumed.
  const std::string mine = lock.is_held() ? "" : "." + note.host + "-" + std::to_string(note.pid);
  Checkpoint rows(run, run.work() / (name_of(shard) + ".rows" + mine), frames);
  worked.resumed = note.resumed = rows.rows();
  double reported_s = 0;
  for (std::size_t i = rows.rows(); i < frames.size(); ++i) {
    if (now_s() - reported_s > kSecondsBetweenNotes) {
      reported_s = note.updated_s = now_s();
      note.rows = rows.rows();
      note.errors = rows.errors();
      lock.say(note);
    }
    on_frame(i, frames.size(), frames[i].name);
    rows.add(make_row(frames[i]), frames[i].name);
  }
  worked.errors = note.errors = rows.errors();
  note.rows = rows.rows();
  rows.become(part, run.work() / (name_of(shard) + ".jsonl" + mine));
  note.updated_s = now_s();
  lock.say(note);
  return worked;
}

}  // namespace cairn::batch
