// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <cairn/pipeline/config.hpp>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace cairn::io {

/// Reads options from a YAML file (JSON is YAML too) into `config`; options that the file leaves out stay as
/// they are.
///
///   preset: paper            # optional, first: start from this preset instead of from `config`
///   match:
///     window_size: 9
///   left_right.max_diff: -1  # or flat
///
/// Throws Error with one line that names file, line, key and the nearest known one, or the range, or says
/// what keeps an option of the file from having any effect; `config` is then as it was. `from_preset` makes
/// what a `preset:` line starts from (the command adds there what a calibration says). `on_top` sets what
/// comes on top of the file (--set, keywords): an option that the file itself leaves without effect may get
/// one from it. `elsewhere` is asked first for every option, and takes those that are of another
/// configuration (that of a sequence) by returning true; it throws Error as set() does.
void load_config(const std::filesystem::path& path, Config& config,
                 const std::function<Config(std::string_view)>& from_preset = Config::preset,
                 const std::function<void(Config&)>& on_top = {},
                 const std::function<bool(std::string_view name, std::string_view value)>& elsewhere = {});

/// Every option that `config` reads with its value, in the form that load_config() reads, one comment per
/// option.
std::string config_yaml(const Config& config);
/// The same of options from anywhere: those that are read.
std::string options_yaml(const std::vector<OptionInfo>& options);

/// The same, short: the preset's name and the options in which `config` differs from it; those in `also`
/// whatever they are.
std::string changed_config_yaml(std::string_view preset, const Config& config,
                                const std::vector<std::string>& also = {});

}  // namespace cairn::io
