// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>
#include <zstd.h>
#include <zstd_errors.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <new>
#include <set>

#include <cairn/ros/mcap_format.hpp>

namespace cairn::ros {
namespace {

using mcap::kMagic;
using mcap::kRecordHeader;
using mcap::Op;
using mcap::Reader;

// Limits above any real recording; larger claims are rejected before memory is allocated.
constexpr std::uint64_t kMaxChunkBytes = std::uint64_t{256} << 20;
constexpr std::uint64_t kMaxSummaryBytes = std::uint64_t{256} << 20;
constexpr std::uint64_t kMaxAttachmentBytes = std::uint64_t{16} << 20;
constexpr std::size_t kMaxDefinitionBytes = std::size_t{64} << 20;  // of all channels
constexpr std::uint64_t kFooterBytes = 20;

/// A file read in pieces within its bounds.
class InFile {
 public:
  explicit InFile(const std::filesystem::path& path)
      : path_(path.string()), file_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
    struct stat status {};
    if (file_ < 0 || ::fstat(file_, &status) != 0)
      throw Error(path_ + ": cannot be read: " + std::strerror(errno));
    if (!S_ISREG(status.st_mode)) throw Error(path_ + ": is not a file, expected a recording (MCAP)");
    size_ = static_cast<std::uint64_t>(status.st_size);
  }
  ~InFile() {
    if (file_ >= 0) ::close(file_);
  }
  InFile(const InFile&) = delete;
  InFile& operator=(const InFile&) = delete;

  [[nodiscard]] std::uint64_t size() const { return size_; }
  [[nodiscard]] const std::string& path() const { return path_; }
  [[nodiscard]] bool holds(std::uint64_t offset, std::uint64_t length) const {
    return offset <= size_ && length <= size_ - offset;
  }
  [[nodiscard]] Bytes read(std::uint64_t offset, std::uint64_t length) const {
    if (!holds(offset, length)) throw Error("it ends too early");
    Bytes bytes(length);
    std::size_t done = 0;
    while (done < length) {
      const ssize_t got =
          ::pread(file_, bytes.data() + done, length - done, static_cast<off_t>(offset + done));
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) throw Error(got == 0 ? "it became shorter" : std::strerror(errno));
      done += static_cast<std::size_t>(got);
    }
    return bytes;
  }

 private:
  std::string path_;
  int file_ = -1;
  std::uint64_t size_ = 0;
};

struct Head {
  Op op{};
  std::uint64_t at = 0;  // offset of the content
  std::uint64_t length = 0;
};

struct Schema {
  std::string name;
  std::string encoding;
  std::string text;
};

/// A chunk, or a message outside of chunks.
struct Part {
  std::uint64_t at = 0;  // offset of the content
  std::uint64_t length = 0;
  bool is_chunk = true;
  std::set<std::uint16_t> channels;  // channels in it; empty = unknown
};

/// Decompresses the records of a chunk.
Bytes unpacked(const Bytes& content) {
  Reader in(content);
  (void)in.number<std::uint64_t>();
  (void)in.number<std::uint64_t>();
  const auto length = in.number<std::uint64_t>();
  const auto crc = in.number<std::uint32_t>();
  const std::string compression = in.text();
  const auto stored = in.take(in.number<std::uint64_t>());
  if (length > kMaxChunkBytes) {
    throw Error("a chunk claims " + std::to_string(length) + " bytes, expected at most " +
                std::to_string(kMaxChunkBytes));
  }
  Bytes records;
  if (compression.empty()) {
    if (stored.size() != length) throw Error("a chunk does not have the length it claims");
    records.assign(stored.begin(), stored.end());
  } else {
    const unsigned long long known = ::ZSTD_getFrameContentSize(stored.data(), stored.size());
    if (known == ZSTD_CONTENTSIZE_ERROR || (known != ZSTD_CONTENTSIZE_UNKNOWN && known != length))
      throw Error("a chunk does not have the length it claims");
    records.resize(length);
    const std::size_t got = ::ZSTD_decompress(records.data(), records.size(), stored.data(), stored.size());
    if (::ZSTD_getErrorCode(got) == ZSTD_error_memory_allocation) throw std::bad_alloc();
    if (::ZSTD_isError(got) != 0 || got != length) throw Error("a chunk cannot be unpacked");
  }
  if (crc != 0 && ::crc32_z(0, records.data(), records.size()) != crc)
    throw Error("a chunk's checksum is wrong");
  return records;
}

std::string compression_of(const Bytes& content) {
  Reader in(content);
  (void)in.take(28);
  return in.text();
}

}  // namespace

struct McapReader::State {
  explicit State(const std::filesystem::path& path) : file(path) {}

  [[nodiscard]] Head head_at(std::uint64_t offset) const {
    const Bytes bytes = file.read(offset, kRecordHeader);
    Reader in(bytes);
    const auto op = in.number<Op>();
    return {op, offset + kRecordHeader, in.number<std::uint64_t>()};
  }
  void add(Op op, std::span<const std::uint8_t> content);
  void add_attachment(std::uint64_t at, std::uint64_t length);
  void add_metadata(std::uint64_t at, std::uint64_t length);
  [[nodiscard]] std::optional<Bytes> summary() const;
  bool add_chunk_index(Reader& content);
  std::uint64_t add_statistics(Reader& content);
  bool read_summary();
  void scan();
  void forget();
  [[nodiscard]] Bytes chunk_of(const Part& part) const;
  /// The channels declared in a chunk; empty if it is damaged.
  void learn_from(const Part& part);
  [[nodiscard]] bool is_wanted(const Part& part) const;
  bool open_next_part();
  void damaged(const std::string& why) {
    if (damaged_count++ == 0) first_damage = file.path() + ": " + why;
  }

  /// Limits repeated reads: their total must not exceed the file's size.
  [[nodiscard]] bool may_read(std::uint64_t length) {
    read_bytes += std::min(length, file.size() + 1);
    return read_bytes <= file.size();
  }

  InFile file;
  std::uint64_t read_bytes = 0;      // of attachments and metadata
  std::size_t definition_bytes = 0;  // of the channels' schemas
  std::map<std::uint16_t, Schema> schemas;
  std::map<std::uint16_t, McapChannel> channels;
  std::map<std::uint16_t, std::uint64_t> counts;
  std::vector<McapAttachment> attachments;
  std::map<std::string, Words> metadata;
  std::vector<Part> parts;
  bool is_whole = false;
  std::set<std::uint16_t> wanted;  // empty = all
  std::size_t damaged_count = 0;
  std::string first_damage;
  // The reading position.
  std::size_t next_part = 0;
  Bytes records;       // of the current part
  std::size_t at = 0;  // index in `records`
};

bool is_mcap(const std::filesystem::path& path) {
  try {
    const InFile file(path);
    return file.size() >= kMagic.size() && std::ranges::equal(file.read(0, kMagic.size()), kMagic);
  } catch (const Error&) {
    return false;
  }
}

McapReader::McapReader(const std::filesystem::path& path) : state_(std::make_unique<State>(path)) {
  State& s = *state_;
  const Bytes begin = s.file.read(0, std::min<std::uint64_t>(s.file.size(), kMagic.size()));
  if (!std::ranges::equal(begin, kMagic)) throw Error(path.string() + ": is not a recording, expected MCAP");
  try {
    if (s.read_summary()) return;
  } catch (const Error&) {  // a damaged summary: the data may be intact
  }
  s.forget();
  s.scan();
}
McapReader::~McapReader() = default;
McapReader::McapReader(McapReader&&) noexcept = default;
McapReader& McapReader::operator=(McapReader&&) noexcept = default;

void McapReader::State::forget() {
  read_bytes = 0;
  definition_bytes = 0;
  schemas.clear();
  channels.clear();
  counts.clear();
  attachments.clear();
  metadata.clear();
  parts.clear();
  is_whole = false;
}

/// Reads a schema or a channel.
void McapReader::State::add(Op op, std::span<const std::uint8_t> content) {
  Reader in(content);
  if (op == Op::schema) {
    const auto id = in.number<std::uint16_t>();
    Schema schema;
    schema.name = in.text();
    schema.encoding = in.text();
    schema.text = in.text();
    schemas.insert_or_assign(id, std::move(schema));
  } else if (op == Op::channel) {
    McapChannel channel;
    channel.id = in.number<std::uint16_t>();
    const Schema& schema = schemas[in.number<std::uint16_t>()];  // 0 = none
    channel.topic = in.text();
    channel.encoding = in.text();
    channel.type = schema.name;
    channel.schema_encoding = schema.encoding;
    // Limits the total, as many channels may share one large schema.
    const auto before = channels.find(channel.id);
    if (before != channels.end()) definition_bytes -= before->second.schema.size();
    definition_bytes += schema.text.size();
    if (definition_bytes > kMaxDefinitionBytes)
      throw Error("definitions of more than " + std::to_string(kMaxDefinitionBytes) + " bytes");
    channel.schema = schema.text;
    channels.insert_or_assign(channel.id, std::move(channel));
  }
}

void McapReader::State::add_attachment(std::uint64_t content_at, std::uint64_t length) {
  if (length > kMaxAttachmentBytes || !may_read(length)) return;  // not written by cairn
  const Bytes content = file.read(content_at, length);
  Reader in(content);
  (void)in.take(16);
  McapAttachment attachment;
  attachment.name = in.text();
  attachment.media_type = in.text();
  const auto bytes = in.take(in.number<std::uint64_t>());
  const auto crc = in.number<std::uint32_t>();
  if (crc != 0 && ::crc32_z(0, content.data(), content.size() - 4) != crc) return;
  attachment.bytes.assign(bytes.begin(), bytes.end());
  attachments.push_back(std::move(attachment));
}

void McapReader::State::add_metadata(std::uint64_t content_at, std::uint64_t length) {
  if (length > kMaxAttachmentBytes || !may_read(length)) return;
  const Bytes content = file.read(content_at, length);
  Reader in(content);
  std::string name = in.text();
  metadata.insert_or_assign(std::move(name), in.words());
}

/// The summary section; nullopt without one that can be read.
std::optional<Bytes> McapReader::State::summary() const {
  const std::uint64_t tail = kRecordHeader + kFooterBytes + kMagic.size();
  if (file.size() < 2 * kMagic.size() + tail) return std::nullopt;
  const std::uint64_t footer_at = file.size() - tail;
  const Bytes end = file.read(footer_at, tail);
  if (!std::equal(kMagic.begin(), kMagic.end(), end.end() - kMagic.size())) return std::nullopt;
  Reader footer(end);
  if (footer.number<Op>() != Op::footer || footer.number<std::uint64_t>() != kFooterBytes)
    return std::nullopt;
  const auto start = footer.number<std::uint64_t>();
  (void)footer.number<std::uint64_t>();
  const auto crc = footer.number<std::uint32_t>();
  if (start == 0 || start > footer_at || footer_at - start > kMaxSummaryBytes) return std::nullopt;
  Bytes summary = file.read(start, footer_at - start + kRecordHeader + kFooterBytes - 4);
  if (crc != 0 && ::crc32_z(0, summary.data(), summary.size()) != crc) return std::nullopt;
  return summary;
}

/// Adds a chunk index. False if its length is impossible.
bool McapReader::State::add_chunk_index(Reader& content) {
  (void)content.take(16);
  Part part;
  part.at = content.number<std::uint64_t>() + kRecordHeader;
  part.length = content.number<std::uint64_t>();
  if (part.length < kRecordHeader) return false;
  part.length -= kRecordHeader;
  Reader offsets = content.part();
  while (!offsets.empty()) {
    part.channels.insert(offsets.number<std::uint16_t>());
    (void)offsets.number<std::uint64_t>();
  }
  parts.push_back(std::move(part));
  return true;
}

/// Adds the counts of messages, by channel, and returns the number of all.
std::uint64_t McapReader::State::add_statistics(Reader& content) {
  const auto messages = content.number<std::uint64_t>();
  (void)content.take(2 + 4 + 4 + 4 + 4 + 8 + 8);
  Reader of_channels = content.part();
  while (!of_channels.empty()) {
    const auto id = of_channels.number<std::uint16_t>();
    counts[id] = of_channels.number<std::uint64_t>();
  }
  return messages;
}

/// False if there is no summary, or one without chunk indexes.
bool McapReader::State::read_summary() {
  const std::optional<Bytes> bytes = summary();
  if (!bytes) return false;
  std::optional<std::uint64_t> messages;  // as counted
  Reader in(*bytes);
  while (in.rest().size() > kRecordHeader + kFooterBytes - 4) {
    const auto op = in.number<Op>();
    Reader content(in.take(in.number<std::uint64_t>()));
    if (op == Op::schema || op == Op::channel) {
      add(op, content.rest());
    } else if (op == Op::chunk_index) {
      if (!add_chunk_index(content)) return false;
    } else if (op == Op::statistics) {
      messages = add_statistics(content);
    } else if (op == Op::attachment_index || op == Op::metadata_index) {
      const auto at_record = content.number<std::uint64_t>();
      const auto length = content.number<std::uint64_t>();
      if (length < kRecordHeader) return false;
      if (op == Op::attachment_index)
        add_attachment(at_record + kRecordHeader, length - kRecordHeader);
      else
        add_metadata(at_record + kRecordHeader, length - kRecordHeader);
    }
  }
  if (parts.empty() && messages != std::uint64_t{0}) return false;  // messages outside of chunks
  std::ranges::sort(parts, {}, &Part::at);
  for (const Part& part : parts) {
    if (!file.holds(part.at, part.length)) return false;
    for (const std::uint16_t id : part.channels)
      if (!channels.contains(id)) return false;
  }
  is_whole = true;
  return true;
}

Bytes McapReader::State::chunk_of(const Part& part) const {
  if (part.length > kMaxChunkBytes) {
    throw Error("a chunk of " + std::to_string(part.length) + " bytes, expected at most " +
                std::to_string(kMaxChunkBytes));
  }
  return file.read(part.at, part.length);
}

void McapReader::State::learn_from(const Part& part) {
  try {
    const Bytes content = chunk_of(part);
    const std::string compression = compression_of(content);
    if (!compression.empty() && compression != "zstd") return;  // next() rejects it
    const Bytes chunk = unpacked(content);
    Reader in(chunk);
    while (!in.empty()) {
      const auto op = in.number<Op>();
      add(op, in.take(in.number<std::uint64_t>()));
    }
  } catch (const Error&) {  // next() counts it
  }
}

/// Scans the file up to its last complete record.
void McapReader::State::scan() {
  std::uint64_t at_record = kMagic.size();
  bool has_new_channel = false;
  const auto finish_chunk = [&](bool is_last) {
    if (parts.empty() || !parts.back().is_chunk) return;
    Part& part = parts.back();
    const bool is_cut = is_last && !is_whole;
    if (has_new_channel || part.channels.empty() || is_cut) learn_from(part);
    if (is_cut) part.channels.clear();  // its own index may be cut off
    has_new_channel = false;
  };
  while (file.holds(at_record, kRecordHeader)) {
    const Head head = head_at(at_record);
    if (!file.holds(head.at, head.length)) break;
    at_record = head.at + head.length;
    if (head.op == Op::message_index && head.length >= 2) {
      const Bytes id = file.read(head.at, 2);
      const auto channel = Reader(id).number<std::uint16_t>();
      if (!parts.empty() && parts.back().is_chunk) parts.back().channels.insert(channel);
      has_new_channel = has_new_channel || !channels.contains(channel);
      continue;
    }
    if (head.op == Op::data_end || head.op == Op::footer) {
      is_whole = true;
      break;
    }
    try {
      if (head.op == Op::chunk) {
        finish_chunk(false);
        parts.push_back({head.at, head.length, true, {}});
      } else if (head.op == Op::message && head.length >= 22) {
        const Bytes id = file.read(head.at, 2);
        parts.push_back({head.at, head.length, false, {Reader(id).number<std::uint16_t>()}});
      } else if ((head.op == Op::schema || head.op == Op::channel) && head.length <= kMaxAttachmentBytes) {
        add(head.op, file.read(head.at, head.length));
      } else if (head.op == Op::attachment) {
        add_attachment(head.at, head.length);
      } else if (head.op == Op::metadata) {
        add_metadata(head.at, head.length);
      }
    } catch (const Error& error) {
      damaged(error.what());
    }
  }
  finish_chunk(true);
}

bool McapReader::State::is_wanted(const Part& part) const {
  return wanted.empty() || part.channels.empty() ||
         std::ranges::any_of(part.channels, [&](std::uint16_t id) { return wanted.contains(id); });
}

/// Loads the records of the next part; false at the end.
bool McapReader::State::open_next_part() {
  while (next_part < parts.size()) {
    const Part& part = parts[next_part++];
    if (!is_wanted(part)) continue;
    try {
      if (part.is_chunk) {
        const Bytes content = chunk_of(part);
        if (const std::string compression = compression_of(content);
            !compression.empty() && compression != "zstd") {
          throw std::domain_error(file.path() + ": is compressed with " + compression +
                                  ", expected zstd or none (mcap compress --compression zstd converts it)");
        }
        records = unpacked(content);
      } else {
        records = file.read(part.at - kRecordHeader, part.length + kRecordHeader);
      }
    } catch (const Error& error) {
      damaged(error.what());
      continue;
    } catch (const std::domain_error& error) {
      throw Error(error.what());
    }
    at = 0;
    return true;
  }
  return false;
}

std::optional<McapMessage> McapReader::next() {
  State& s = *state_;
  while (true) {
    if (s.at >= s.records.size() && !s.open_next_part()) return std::nullopt;
    try {
      Reader in(std::span<const std::uint8_t>(s.records).subspan(s.at));
      const std::size_t before = in.rest().size();
      const auto op = in.number<Op>();
      Reader content(in.take(in.number<std::uint64_t>()));
      s.at += before - in.rest().size();
      if (op == Op::schema || op == Op::channel) s.add(op, content.rest());
      if (op != Op::message) continue;
      McapMessage message;
      message.channel = content.number<std::uint16_t>();
      (void)content.number<std::uint32_t>();
      message.logged.ns = content.number<std::int64_t>();
      constexpr std::int64_t kMaxNs = std::numeric_limits<std::int64_t>::max() / 2;  // differences fit
      if (message.logged.ns < 0 || message.logged.ns > kMaxNs)
        throw Error("a message has a time after the year 2116");
      (void)content.number<std::uint64_t>();
      message.bytes = content.rest();
      if (s.wanted.empty() || s.wanted.contains(message.channel)) return message;
    } catch (const Error& error) {
      s.damaged(error.what());
      s.at = s.records.size();
    }
  }
}

void McapReader::only(const std::vector<std::uint16_t>& channels) {
  state_->wanted = {channels.begin(), channels.end()};
}

void McapReader::rewind() {
  state_->next_part = 0;
  state_->records.clear();
  state_->at = 0;
}

const std::map<std::uint16_t, McapChannel>& McapReader::channels() const {
  return state_->channels;
}
const std::map<std::uint16_t, std::uint64_t>& McapReader::counts() const {
  return state_->counts;
}
const std::vector<McapAttachment>& McapReader::attachments() const {
  return state_->attachments;
}
const std::map<std::string, Words>& McapReader::metadata() const {
  return state_->metadata;
}
bool McapReader::is_whole() const {
  return state_->is_whole;
}
std::size_t McapReader::damaged_chunks() const {
  return state_->damaged_count;
}
const std::string& McapReader::first_damage() const {
  return state_->first_damage;
}

std::optional<std::string> attachment_of(const McapReader& reader, std::string_view name) {
  for (const McapAttachment& attachment : reader.attachments()) {
    if (attachment.name == name) return attachment.bytes;
  }
  return std::nullopt;
}

}  // namespace cairn::ros
