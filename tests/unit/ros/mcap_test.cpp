// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cairn/core/error.hpp>
#include <cairn/ros/mcap_format.hpp>
#include <csignal>

#include "support/recordings.hpp"
#include "support/temporary_folder.hpp"

namespace cairn::ros {
namespace {

namespace fs = std::filesystem;
using recordings::content;
using recordings::write;
using support::TemporaryFolder;

class Mcap : public testing::Test {
 protected:
  [[nodiscard]] fs::path at(const std::string& name) const { return folder_.path() / name; }

  /// Numbers 0 … count−1 as text, alternating between two topics, padded so that a chunk holds few of them.
  [[nodiscard]] fs::path numbers(int count, McapOptions options) const {
    fs::path path = at("numbers.mcap");
    options.sync = false;
    McapWriter file(path, options);
    file.metadata("cairn", {{"version", "1"}, {"preset", "default"}});
    file.attachment("calib.txt", "text/plain", "fx=1\n");
    const std::uint16_t a = file.channel("/a", String::kType, schema_of<String>());
    const std::uint16_t b = file.channel("/b", String::kType, schema_of<String>());
    std::mt19937 random(1);
    for (int i = 0; i < count; ++i) {
      std::string text = std::to_string(i) + " ";
      for (int n = 0; n < 100; ++n) text += static_cast<char>('a' + random() % 26);
      file.message(i % 2 == 0 ? a : b, {i * 1000}, encode(String{text}));
    }
    file.close();
    return path;
  }
  static std::vector<int> read(McapReader& reader) {
    std::vector<int> numbers;
    while (const auto message = reader.next())
      numbers.push_back(std::stoi(decode<String>(message->bytes).data));
    return numbers;
  }
  static std::vector<int> read(const fs::path& path) {
    McapReader reader(path);
    return read(reader);
  }
  static std::vector<int> up_to(int count) {
    std::vector<int> numbers(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) numbers[static_cast<std::size_t>(i)] = i;
    return numbers;
  }
  /// The end of each chunk, and the number of messages up to there.
  static std::vector<std::pair<std::size_t, int>> chunk_ends(const std::string& bytes) {
    std::vector<std::pair<std::size_t, int>> ends;
    std::size_t at = 8;
    int messages = 0;
    while (at + 9 <= bytes.size()) {
      mcap::Reader head({reinterpret_cast<const std::uint8_t*>(bytes.data()) + at, 9});
      const auto op = head.number<mcap::Op>();
      const auto length = head.number<std::uint64_t>();
      at += 9 + length;
      if (op == mcap::Op::data_end) break;
      if (op == mcap::Op::chunk) ends.emplace_back(at, messages);
      if (op == mcap::Op::message_index) messages += static_cast<int>((length - 6) / 16);
    }
    // Counted after each chunk: the count at the next one is this one's.
    for (std::size_t i = 0; i < ends.size(); ++i)
      ends[i].second = i + 1 < ends.size() ? ends[i + 1].second : messages;
    return ends;
  }

 private:
  TemporaryFolder folder_;
};

TEST_F(Mcap, IsReadBackInOrderWithItsMetadata) {
  for (const bool compress : {false, true}) {
    const fs::path path = numbers(100, {.chunk_bytes = 1000, .compress = compress});
    McapReader reader(path);
    EXPECT_TRUE(reader.is_whole());
    EXPECT_EQ(read(reader), up_to(100));
    ASSERT_EQ(reader.channels().size(), 2U);
    EXPECT_EQ(reader.channels().at(1).topic, "/a");
    EXPECT_EQ(reader.channels().at(2).type, "std_msgs/msg/String");
    EXPECT_EQ(reader.channels().at(2).schema, "string data\n");
    EXPECT_EQ(reader.counts().at(1), 50U);
    EXPECT_EQ(attachment_of(reader, "calib.txt"), "fx=1\n");
    EXPECT_EQ(reader.metadata().at("cairn").at("preset"), "default");
    EXPECT_EQ(reader.damaged_chunks(), 0U);
    EXPECT_GT(chunk_ends(content(path)).size(), 10U);
  }
}

TEST_F(Mcap, GivesOnlyTheRequestedChannels) {
  McapReader reader(numbers(10, {.chunk_bytes = 300}));
  reader.only({2});
  EXPECT_EQ(read(reader), (std::vector<int>{1, 3, 5, 7, 9}));
  reader.only({});
  reader.rewind();
  EXPECT_EQ(read(reader), up_to(10));
}

TEST_F(Mcap, AnEmptyRecordingIsValid) {
  McapWriter(at("empty.mcap"), {.sync = false}).close();
  McapReader reader(at("empty.mcap"));
  EXPECT_TRUE(reader.is_whole());
  EXPECT_FALSE(reader.next());
}

TEST_F(Mcap, TruncatedAnywhereItGivesAllCompleteChunks) {
  for (const bool compress : {false, true}) {
    const std::string bytes = content(numbers(100, {.chunk_bytes = 1000, .compress = compress}));
    const auto ends = chunk_ends(bytes);
    std::mt19937 random(7);
    for (int i = 0; i < 200; ++i) {
      const std::size_t size = random() % bytes.size();
      write(at("cut.mcap"), bytes.substr(0, size));
      if (size < 8) {
        EXPECT_THROW(McapReader{at("cut.mcap")}, Error) << size;
        continue;
      }
      int expected = 0;
      for (const auto& [end, messages] : ends)
        if (end <= size) expected = messages;
      EXPECT_EQ(read(at("cut.mcap")), up_to(expected)) << size << " of " << bytes.size();
      if (expected > 0) {
        McapReader reader(at("cut.mcap"));
        EXPECT_EQ(attachment_of(reader, "calib.txt"), "fx=1\n");
        reader.only({1});
        EXPECT_EQ(static_cast<int>(read(reader).size()), (expected + 1) / 2);
      }
    }
  }
}

TEST_F(Mcap, DamageAnywhereIsSkippedOrRefused) {
  const std::string bytes = content(numbers(60, {.chunk_bytes = 1000}));
  std::mt19937 random(3);
  for (int i = 0; i < 500; ++i) {
    std::string damaged = bytes;
    for (int n = 0; n < 2; ++n) damaged[random() % damaged.size()] = static_cast<char>(random());
    write(at("damaged.mcap"), damaged);
    try {
      McapReader reader(at("damaged.mcap"));
      while (reader.next()) {
      }
    } catch (const Error&) {
    }
  }
}

TEST_F(Mcap, ADamagedChunkIsCountedAndTheOthersAreRead) {
  const fs::path path = numbers(60, {.chunk_bytes = 1000, .compress = false});
  std::string bytes = content(path);
  const auto ends = chunk_ends(bytes);
  ASSERT_GT(ends.size(), 3U);
  bytes[ends[1].first - 20] = static_cast<char>(bytes[ends[1].first - 20] ^ 1);
  write(path, bytes);
  McapReader reader(path);
  const std::vector<int> found = read(reader);
  EXPECT_EQ(static_cast<int>(found.size()), 60 - (ends[1].second - ends[0].second));
  EXPECT_EQ(reader.damaged_chunks(), 1U);
  EXPECT_NE(reader.first_damage().find("checksum"), std::string::npos) << reader.first_damage();
}

/// A file with one chunk, as other writers may write it.
std::string foreign(const std::string& compression, std::uint64_t claimed, const Bytes& records) {
  mcap::Writer chunk;
  chunk.number(std::uint64_t{0});
  chunk.number(std::uint64_t{0});
  chunk.number(claimed);
  chunk.number(std::uint32_t{0});
  chunk.text(compression);
  chunk.number(std::uint64_t{records.size()});
  chunk.raw(records);
  mcap::Writer file;
  file.raw(mcap::kMagic);
  file.record(mcap::Op::chunk, chunk);
  return {file.bytes().begin(), file.bytes().end()};
}

TEST_F(Mcap, ImplausibleSizesAreRefusedBeforeAllocation) {
  write(at("bomb.mcap"), foreign("zstd", std::uint64_t{1} << 60, Bytes(100)));
  McapReader reader(at("bomb.mcap"));
  EXPECT_FALSE(reader.next());
  EXPECT_EQ(reader.damaged_chunks(), 1U);
  EXPECT_NE(reader.first_damage().find("claims 1152921504606846976 bytes"), std::string::npos);
}

/// Records that refer to the same place repeatedly would take unlimited memory.
TEST_F(Mcap, AChunkIndexedRepeatedlyIsReadOnce) {
  mcap::Writer file;
  file.raw(mcap::kMagic);
  mcap::Writer header;
  header.text("");
  header.text("");
  file.record(mcap::Op::header, header);
  const std::uint64_t attachment_at = file.size();
  mcap::Writer attachment;
  attachment.number(std::uint64_t{0});
  attachment.number(std::uint64_t{0});
  attachment.text("calib.txt");
  attachment.text("text/plain");
  attachment.number(std::uint64_t{1} << 20);
  attachment.raw(std::string(std::size_t{1} << 20, 'x'));
  attachment.number(std::uint32_t{0});
  file.record(mcap::Op::attachment, attachment);
  const std::uint64_t attachment_bytes = file.size() - attachment_at;
  file.record(mcap::Op::data_end, [] {
    mcap::Writer end;
    end.number(std::uint32_t{0});
    return end;
  }());
  const std::uint64_t summary_at = file.size();
  mcap::Writer statistics;
  statistics.number(std::uint64_t{0});
  statistics.raw(std::string(2 + 4 + 4 + 4 + 4 + 8 + 8 + 4, '\0'));
  file.record(mcap::Op::statistics, statistics);
  for (int k = 0; k < 10'000; ++k) {
    mcap::Writer index;
    index.number(attachment_at);
    index.number(attachment_bytes);
    file.record(mcap::Op::attachment_index, index);
  }
  mcap::Writer footer;
  footer.number(summary_at);
  footer.number(std::uint64_t{0});
  footer.number(std::uint32_t{0});
  file.record(mcap::Op::footer, footer);
  file.raw(mcap::kMagic);
  write(at("many.mcap"), {reinterpret_cast<const char*>(file.bytes().data()), file.size()});
  const McapReader reader(at("many.mcap"));
  EXPECT_EQ(reader.attachments().size(), 1U);
}

TEST_F(Mcap, ManyChannelsOfALargeDefinitionAreRefused) {
  const fs::path path = at("definitions.mcap");
  {
    McapOptions options;
    options.sync = false;
    McapWriter writer(path, options);
    const std::string definition(std::size_t{1} << 20, ' ');
    for (int k = 0; k < 100; ++k) {
      const std::uint16_t channel = writer.channel("/t" + std::to_string(k), String::kType, definition);
      writer.message(channel, {k}, encode(String{"x"}));
    }
    writer.close();
  }
  std::size_t bytes = 0;
  try {
    const McapReader reader(path);
    for (const auto& [id, channel] : reader.channels()) bytes += channel.schema.size();
  } catch (const Error&) {
  }
  EXPECT_LE(bytes, std::size_t{64} << 20);
}

TEST_F(Mcap, OtherCompressionsAreRefusedByName) {
  write(at("lz4.mcap"), foreign("lz4", 100, Bytes(100)));
  McapReader reader(at("lz4.mcap"));
  try {
    (void)reader.next();
    FAIL();
  } catch (const Error& error) {
    const std::string text = error.what();
    EXPECT_TRUE(text.starts_with((at("lz4.mcap")).string() + ": is compressed with lz4, expected zstd"))
        << text;
    EXPECT_EQ(text.find('\n'), std::string::npos);
  }
}

TEST_F(Mcap, MessagesOutsideOfChunksAreRead) {
  mcap::Writer file;
  file.raw(mcap::kMagic);
  mcap::Writer schema;
  schema.number(std::uint16_t{1});
  schema.text(String::kType);
  schema.text("ros2msg");
  schema.text("string data");
  file.record(mcap::Op::schema, schema);
  mcap::Writer channel;
  channel.number(std::uint16_t{5});
  channel.number(std::uint16_t{1});
  channel.text("/t");
  channel.text("cdr");
  channel.words({});
  file.record(mcap::Op::channel, channel);
  for (int i = 0; i < 3; ++i) {
    mcap::Writer message;
    message.number(std::uint16_t{5});
    message.number(std::uint32_t{0});
    message.number(std::uint64_t{1});
    message.number(std::uint64_t{1});
    message.raw(encode(String{std::to_string(i)}));
    file.record(mcap::Op::message, message);
  }
  write(at("bare.mcap"), {file.bytes().begin(), file.bytes().end()});
  EXPECT_EQ(read(at("bare.mcap")), up_to(3));
}

TEST_F(Mcap, AFullDiskIsReported) {
  try {
    McapWriter file("/dev/full");
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "/dev/full: can no longer be written: No space left on device");
  }
  EXPECT_THROW(McapWriter(at("no/such/folder/a.mcap")), Error);
}

TEST_F(Mcap, TheDataOnAFullDiskIsACompleteRecording) {
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  rlimit small = before;
  small.rlim_cur = 10'000;
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  EXPECT_THROW((void)numbers(1000, {.chunk_bytes = 4000, .compress = false}), Error);
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_LE(fs::file_size(at("numbers.mcap")), 10'000U);
  McapReader reader(at("numbers.mcap"));
  EXPECT_TRUE(reader.is_whole());
  const std::vector<int> found = read(reader);
  EXPECT_GT(found.size(), 20U);
  EXPECT_EQ(found, up_to(static_cast<int>(found.size())));
  EXPECT_EQ(reader.counts().at(1) + reader.counts().at(2), found.size());
  EXPECT_EQ(reader.damaged_chunks(), 0U);
}

TEST_F(Mcap, RefusesOtherFiles) {
  write(at("text"), "some text that is no recording");
  EXPECT_FALSE(is_mcap(at("text")));
  EXPECT_FALSE(is_mcap(at("missing")));
  EXPECT_FALSE(is_mcap(at("")));
  EXPECT_THROW(McapReader{at("text")}, Error);
  EXPECT_TRUE(is_mcap(numbers(1, {})));
}

}  // namespace
}  // namespace cairn::ros
