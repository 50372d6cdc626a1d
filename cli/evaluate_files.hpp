// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/evaluation/object_error.hpp>
#include <cairn/io/dataset.hpp>
#include <cairn/io/image_files.hpp>
#include <cairn/output/web/html_page.hpp>
#include <filesystem>
#include <optional>
#include <string>

/// The input files of `cairn evaluate`.
namespace cairn::cli {

struct ResultFiles {
  std::string name;
  std::optional<std::filesystem::path> objects;
  std::optional<std::filesystem::path> disparity;
  std::optional<std::filesystem::path> reject;
  std::optional<std::filesystem::path> confidence;
  std::optional<std::filesystem::path> space;
  std::optional<std::filesystem::path> json;
};

/// nullopt if the folder contains no result.
std::optional<ResultFiles> result_in(const std::filesystem::path& folder);

Image<ObjectId> ours_of(const io::Labels& labels);

/// Throws Error naming both.
void require_equal_size(const std::filesystem::path& ours, Size our_size, const std::filesystem::path& theirs,
                        Size their_size);

/// A result next to its truth, for the page of --html. The left image is the one next to the truth, if any.
/// Throws Error if two maps differ in size.
output::EncodedFrame encode_frame(const ResultFiles& result, const io::TruthFiles& truth);

}  // namespace cairn::cli
