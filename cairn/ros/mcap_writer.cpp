// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <fcntl.h>
#include <unistd.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>

#include <cairn/ros/mcap_format.hpp>

namespace cairn::ros {
namespace {

using mcap::Op;
using mcap::Writer;
using Clock = std::chrono::steady_clock;

/// The quality of service of each topic, for players and people.
const Words kNoQuality{{"offered_qos_profiles", ""}};

std::uint64_t time_of_file(Stamp stamp) {
  return static_cast<std::uint64_t>(std::max<std::int64_t>(stamp.ns, 0));
}

std::uint32_t crc_of(std::uint32_t before, std::span<const std::uint8_t> bytes) {
  return static_cast<std::uint32_t>(::crc32_z(before, bytes.data(), bytes.size()));
}

/// The stamps of first and last message; both 0 without messages.
struct Range {
  std::uint64_t first = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t last = 0;
  void add(std::uint64_t time) {
    first = std::min(first, time);
    last = std::max(last, time);
  }
  [[nodiscard]] std::uint64_t begin() const {
    return first == std::numeric_limits<std::uint64_t>::max() ? 0 : first;
  }
};

/// A file that knows how many of its bytes are complete.
class OutFile {
 public:
  explicit OutFile(const std::filesystem::path& path)
      : path_(path.string()), file_(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644)) {
    if (file_ < 0) fail("cannot be written");
  }
  ~OutFile() {
    if (file_ >= 0) ::close(file_);
  }
  OutFile(const OutFile&) = delete;
  OutFile& operator=(const OutFile&) = delete;

  /// Appends all bytes, or none.
  void append(std::span<const std::uint8_t> bytes, bool sync) {
    std::size_t done = 0;
    while (done < bytes.size()) {
      const ssize_t wrote = ::write(file_, bytes.data() + done, bytes.size() - done);
      if (wrote < 0 && errno == EINTR) continue;
      if (wrote <= 0) end_here(wrote == 0 ? ENOSPC : errno);
      done += static_cast<std::size_t>(wrote);
    }
    // Pipes and devices do not support it.
    if (sync && ::fdatasync(file_) != 0 && errno != EINVAL && errno != EROFS) end_here(errno);
    crc_ = crc_of(crc_, bytes);
    size_ += bytes.size();
  }
  [[nodiscard]] std::uint64_t size() const { return size_; }
  [[nodiscard]] std::uint32_t crc() const { return crc_; }

 private:
  /// Removes an incomplete write.
  [[noreturn]] void end_here(int reason) const {
    [[maybe_unused]] const int ignored = ::ftruncate(file_, static_cast<off_t>(size_));
    [[maybe_unused]] const off_t at = ::lseek(file_, static_cast<off_t>(size_), SEEK_SET);
    errno = reason;
    fail("can no longer be written");
  }
  [[noreturn]] void fail(const char* what) const {
    throw Error(path_ + ": " + what + ": " + std::strerror(errno));
  }
  std::string path_;
  int file_ = -1;
  std::uint64_t size_ = 0;
  std::uint32_t crc_ = 0;
};

}  // namespace

struct McapWriter::State {
  State(const std::filesystem::path& path, const McapOptions& how) : options(how), file(path) {}

  struct IndexEntry {
    std::uint64_t time = 0;
    std::uint64_t offset = 0;
  };
  struct Channel {
    Bytes record;  // with its schema, as in the file
    std::uint16_t id = 0;
    std::uint32_t sequence = 0;
    std::uint64_t count = 0;
    bool is_written = false;
    std::vector<IndexEntry> index;  // for the current chunk
  };

  Writer add_message_indexes(Writer& records, std::uint64_t began) const;
  [[nodiscard]] Writer statistics() const;
  void finish_chunk();
  void drop_chunk();
  void write(const Writer& records, bool sync) {
    try {
      file.append(records.bytes(), sync);
    } catch (const Error&) {
      is_over = is_broken;  // after the first failure there may still be room for the summary
      is_broken = true;
      throw;
    }
  }

  McapOptions options;
  OutFile file;
  bool is_broken = false;  // no more messages can be written
  bool is_over = false;    // closed, or unusable
  std::map<std::string, std::uint16_t, std::less<>> schemas;
  Writer schema_records;
  Writer channel_records;
  std::vector<Channel> channels;
  // The current chunk.
  Writer chunk;
  Range chunk_range;
  Clock::time_point chunk_began;
  // For the summary.
  Writer chunk_indexes;
  Writer attachment_indexes;
  Writer metadata_indexes;
  std::uint32_t chunks = 0;
  std::uint32_t attachments = 0;
  std::uint32_t metadata = 0;
  std::uint64_t messages = 0;
  Range range;
};

bool has_mcap() {
  return true;
}

McapWriter::McapWriter(const std::filesystem::path& path, const McapOptions& options)
    : state_(std::make_unique<State>(path, options)) {
  Writer header;
  header.text("ros2");
  header.text("cairn " CAIRN_VERSION);
  Writer begin;
  begin.raw(mcap::kMagic);
  begin.record(Op::header, header);
  state_->write(begin, options.sync);
}

McapWriter::~McapWriter() {
  try {
    if (state_ && !state_->is_over) close();
  } catch (const std::exception&) {  // callers that need the error call close() themselves
  }
}

std::uint16_t McapWriter::channel(std::string_view topic, std::string_view type, std::string_view schema) {
  State& s = *state_;
  State::Channel channel;
  channel.id = static_cast<std::uint16_t>(s.channels.size() + 1);
  Writer records;
  auto known = s.schemas.find(type);
  if (known == s.schemas.end()) {
    known = s.schemas.emplace(type, static_cast<std::uint16_t>(s.schemas.size() + 1)).first;
    Writer content;
    content.number(known->second);
    content.text(type);
    content.text("ros2msg");
    content.text(schema);
    records.record(Op::schema, content);
    s.schema_records.record(Op::schema, content);
  }
  Writer content;
  content.number(channel.id);
  content.number(known->second);
  content.text(topic);
  content.text("cdr");
  content.words(kNoQuality);
  records.record(Op::channel, content);
  s.channel_records.record(Op::channel, content);
  channel.record = records.bytes();
  s.channels.push_back(std::move(channel));
  return s.channels.back().id;
}

void McapWriter::message(std::uint16_t id, Stamp stamp, std::span<const std::uint8_t> bytes) {
  State& s = *state_;
  if (s.is_over || s.is_broken) return;
  if (s.chunk.size() > 0 && s.chunk.size() + bytes.size() > s.options.chunk_bytes) s.finish_chunk();
  if (s.chunk.size() == 0) s.chunk_began = Clock::now();
  // All known channels are in the first chunk, so a reader of a truncated file has them at once.
  for (State::Channel& known : s.channels) {
    if (!known.is_written) s.chunk.raw(known.record);
    known.is_written = true;
  }
  State::Channel& channel = s.channels.at(id - 1U);
  const std::uint64_t time = time_of_file(stamp);
  channel.index.push_back({time, s.chunk.size()});
  s.chunk_range.add(time);
  constexpr std::uint64_t kFields = 22;
  s.chunk.number(static_cast<std::uint8_t>(Op::message));
  s.chunk.number(kFields + bytes.size());
  s.chunk.number(id);
  s.chunk.number(channel.sequence++);
  s.chunk.number(time);
  s.chunk.number(time);
  s.chunk.raw(bytes);
  flush();
}

/// Adds the index of each channel to the records of a chunk, and returns where each is. `began`: of the records.
Writer McapWriter::State::add_message_indexes(Writer& records, std::uint64_t began) const {
  Writer offsets;
  for (const Channel& channel : channels) {
    if (channel.index.empty()) continue;
    offsets.number(channel.id);
    offsets.number(began + records.size());
    Writer index;
    index.number(channel.id);
    index.number(static_cast<std::uint32_t>(channel.index.size() * 16));
    for (const IndexEntry& entry : channel.index) {
      index.number(entry.time);
      index.number(entry.offset);
    }
    records.record(Op::message_index, index);
  }
  return offsets;
}

/// The record of what the file holds.
Writer McapWriter::State::statistics() const {
  Writer content;
  content.number(messages);
  content.number(static_cast<std::uint16_t>(schemas.size()));
  content.number(static_cast<std::uint32_t>(channels.size()));
  content.number(attachments);
  content.number(metadata);
  content.number(chunks);
  content.number(range.begin());
  content.number(range.last);
  content.number(static_cast<std::uint32_t>(channels.size() * 10));
  for (const Channel& channel : channels) {
    content.number(channel.id);
    content.number(channel.count);
  }
  Writer record;
  record.record(Op::statistics, content);
  return record;
}

void McapWriter::State::finish_chunk() {
  if (chunk.size() == 0) return;
  Bytes packed;
  if (options.compress) {
    packed.resize(::ZSTD_compressBound(chunk.size()));
    const std::size_t length =
        ::ZSTD_compress(packed.data(), packed.size(), chunk.bytes().data(), chunk.size(), 1);
    if (::ZSTD_isError(length) != 0) throw Error(std::string("zstd: ") + ::ZSTD_getErrorName(length));
    packed.resize(length);
  }
  const std::string compression = options.compress ? "zstd" : "";
  const Bytes& stored = options.compress ? packed : chunk.bytes();
  Writer content;
  content.number(chunk_range.begin());
  content.number(chunk_range.last);
  content.number(std::uint64_t{chunk.size()});
  content.number(crc_of(0, chunk.bytes()));
  content.text(compression);
  content.number(std::uint64_t{stored.size()});
  content.raw(stored);

  Writer records;
  const std::uint64_t began = file.size();
  records.record(Op::chunk, content);
  const std::uint64_t length = records.size();
  const Writer offsets = add_message_indexes(records, began);
  Writer summary;
  summary.number(chunk_range.begin());
  summary.number(chunk_range.last);
  summary.number(began);
  summary.number(length);
  summary.number(static_cast<std::uint32_t>(offsets.size()));
  summary.raw(offsets.bytes());
  summary.number(std::uint64_t{records.size()} - length);
  summary.text(compression);
  summary.number(std::uint64_t{stored.size()});
  summary.number(std::uint64_t{chunk.size()});

  write(records, options.sync);
  chunk_indexes.record(Op::chunk_index, summary);
  ++chunks;
  range.add(chunk_range.first);
  range.add(chunk_range.last);
  for (Channel& channel : channels) {
    channel.count += channel.index.size();
    messages += channel.index.size();
  }
  drop_chunk();
}

void McapWriter::State::drop_chunk() {
  chunk.clear();
  chunk_range = {};
  for (Channel& channel : channels) channel.index.clear();
}

void McapWriter::attachment(std::string_view name, std::string_view media_type, std::string_view bytes) {
  State& s = *state_;
  if (s.is_over || s.is_broken) return;
  s.finish_chunk();
  Writer content;
  content.number(std::uint64_t{0});  // creation time: that of the recording
  content.number(std::uint64_t{0});
  content.text(name);
  content.text(media_type);
  content.number(std::uint64_t{bytes.size()});
  content.raw(bytes);
  content.number(crc_of(0, content.bytes()));
  Writer records;
  records.record(Op::attachment, content);
  Writer index;
  index.number(s.file.size());
  index.number(std::uint64_t{records.size()});
  index.number(std::uint64_t{0});
  index.number(std::uint64_t{0});
  index.number(std::uint64_t{bytes.size()});
  index.text(name);
  index.text(media_type);
  s.write(records, s.options.sync);
  s.attachment_indexes.record(Op::attachment_index, index);
  ++s.attachments;
}

void McapWriter::metadata(std::string_view name, const Words& words) {
  State& s = *state_;
  if (s.is_over || s.is_broken) return;
  s.finish_chunk();
  Writer content;
  content.text(name);
  content.words(words);
  Writer records;
  records.record(Op::metadata, content);
  Writer index;
  index.number(s.file.size());
  index.number(std::uint64_t{records.size()});
  index.text(name);
  s.write(records, s.options.sync);
  s.metadata_indexes.record(Op::metadata_index, index);
  ++s.metadata;
}

void McapWriter::flush(bool now) {
  State& s = *state_;
  if (s.is_over || s.is_broken || s.chunk.size() == 0) return;
  if (now || s.chunk.size() >= s.options.chunk_bytes || Clock::now() - s.chunk_began >= s.options.chunk_time)
    s.finish_chunk();
}

void McapWriter::close() {
  State& s = *state_;
  if (s.is_over) return;
  if (s.is_broken) {
    s.drop_chunk();  // the chunk that could not be written
  } else {
    s.finish_chunk();
  }
  Writer end;
  Writer data_end;
  data_end.number(s.file.crc());
  end.record(Op::data_end, data_end);
  s.write(end, false);

  // The summary, grouped by kind of record.
  const std::uint64_t summary_start = s.file.size();
  const Writer statistics = s.statistics();
  Writer summary;
  Writer offsets;
  for (const auto& [op, group] : {std::pair<Op, const Writer*>{Op::schema, &s.schema_records},
                                  {Op::channel, &s.channel_records},
                                  {Op::statistics, &statistics},
                                  {Op::chunk_index, &s.chunk_indexes},
                                  {Op::attachment_index, &s.attachment_indexes},
                                  {Op::metadata_index, &s.metadata_indexes}}) {
    if (group->size() == 0) continue;
    Writer offset;
    offset.number(static_cast<std::uint8_t>(op));
    offset.number(summary_start + summary.size());
    offset.number(std::uint64_t{group->size()});
    offsets.record(Op::summary_offset, offset);
    summary.raw(group->bytes());
  }
  const std::uint64_t offsets_start = summary_start + summary.size();
  summary.raw(offsets.bytes());
  // The checksum covers the footer up to the checksum itself.
  constexpr std::uint64_t kFooterBytes = 20;
  summary.number(static_cast<std::uint8_t>(Op::footer));
  summary.number(kFooterBytes);
  summary.number(summary_start);
  summary.number(offsets_start);
  summary.number(crc_of(0, summary.bytes()));
  summary.raw(mcap::kMagic);
  s.write(summary, s.options.sync);
  s.is_over = true;
}

std::uint64_t McapWriter::messages() const {
  std::uint64_t waiting = 0;
  for (const State::Channel& channel : state_->channels) waiting += channel.index.size();
  return state_->messages + waiting;
}

std::uint64_t McapWriter::bytes() const {
  return state_->file.size();
}

}  // namespace cairn::ros
