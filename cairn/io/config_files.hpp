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

/// Reads options from a YAML file (JSON is YAML too) into `config`; options absent from the file are kept.
///
///   preset: paper            # optional, first: start from this preset instead of from `config`
///   match:
///     window_size: 9
///   left_right.max_diff: -1  # or flat
///
/// Throws Error with one line that names file, line, key and the nearest known one, or the range, or the
/// condition that makes an option ineffective; `config` is then unchanged. `from_preset` creates the base of
/// a `preset:` line (the command adds the calibration there). `on_top` sets overrides of the file (--set,
/// keywords), which may make an option of the file effective. `elsewhere` is called first for every option
/// and returns true for options of another configuration (that of a sequence); it throws Error like set().
void load_config(const std::filesystem::path& path, Config& config,
                 const std::function<Config(std::string_view)>& from_preset = Config::preset,
                 const std::function<void(Config&)>& on_top = {},
                 const std::function<bool(std::string_view name, std::string_view value)>& elsewhere = {});

/// All options that `config` reads with their values, in the form of load_config(), with one comment per
/// option.
std::string config_yaml(const Config& config);
/// The same for options of any origin: those that are read.
std::string options_yaml(const std::vector<OptionInfo>& options);

/// A short form: the name of the preset and the options in which `config` differs from it, plus those in
/// `also`.
std::string changed_config_yaml(std::string_view preset, const Config& config,
                                const std::vector<std::string>& also = {});

}  // namespace cairn::io
