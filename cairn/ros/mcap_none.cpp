// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/core/error.hpp>
#include <fstream>

#include <cairn/ros/mcap.hpp>

namespace cairn::ros {
namespace {

[[noreturn]] void not_built_in(const std::filesystem::path& path) {
  throw Error(path.string() + ": recordings are not built in: they need zstd (libzstd-dev)");
}
[[noreturn]] void never() {
  not_built_in({});
}

}  // namespace

struct McapWriter::State {};
struct McapReader::State {};

bool has_mcap() {
  return false;
}
/// Recognises MCAP files even in a build without a reader, for a helpful error message.
bool is_mcap(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string begin(8, '\0');
  return file.read(begin.data(), 8) && begin == "\x89MCAP0\r\n";
}

McapWriter::McapWriter(const std::filesystem::path& path, const McapOptions& /*options*/) {
  not_built_in(path);
}
McapWriter::~McapWriter() = default;
std::uint16_t McapWriter::channel(std::string_view, std::string_view, std::string_view) {
  never();
}
void McapWriter::message(std::uint16_t, Stamp, std::span<const std::uint8_t>) {
  never();
}
void McapWriter::attachment(std::string_view, std::string_view, std::string_view) {
  never();
}
void McapWriter::metadata(std::string_view, const Words&) {
  never();
}
void McapWriter::flush(bool) {
  never();
}
void McapWriter::close() {
  never();
}
std::uint64_t McapWriter::messages() const {
  never();
}
std::uint64_t McapWriter::bytes() const {
  never();
}

McapReader::McapReader(const std::filesystem::path& path) {
  not_built_in(path);
}
McapReader::~McapReader() = default;
McapReader::McapReader(McapReader&&) noexcept = default;
McapReader& McapReader::operator=(McapReader&&) noexcept = default;
const std::map<std::uint16_t, McapChannel>& McapReader::channels() const {
  never();
}
const std::map<std::uint16_t, std::uint64_t>& McapReader::counts() const {
  never();
}
const std::vector<McapAttachment>& McapReader::attachments() const {
  never();
}
const std::map<std::string, Words>& McapReader::metadata() const {
  never();
}
bool McapReader::is_whole() const {
  never();
}
std::size_t McapReader::damaged_chunks() const {
  never();
}
const std::string& McapReader::first_damage() const {
  never();
}
void McapReader::only(const std::vector<std::uint16_t>&) {
  never();
}
std::optional<McapMessage> McapReader::next() {
  never();
}
void McapReader::rewind() {
  never();
}
std::optional<std::string> attachment_of(const McapReader&, std::string_view) {
  never();
}

}  // namespace cairn::ros
