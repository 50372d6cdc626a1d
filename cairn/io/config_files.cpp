// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/io/config_files.hpp>
#include <cairn/io/read_file.hpp>
#include <functional>
#include <string_view>

#include <cairn/io/yaml_text.hpp>

namespace cairn::io {
namespace {

namespace fs = std::filesystem;

std::string at_line(const YAML::Mark& mark) {
  return mark.is_null() ? "" : "line " + std::to_string(mark.line + 1) + ": ";
}

std::string text_of(const YAML::Node& node) {
  if (node.IsScalar()) return node.Scalar();
  throw Error(at_line(node.Mark()) + "found a " +
              (node.IsMap()    ? "section"
               : node.IsNull() ? "nothing"
                               : "list") +
              " where a value was expected");
}

std::string key_of(const YAML::Node& key) {
  if (!key.IsScalar())
    throw Error(at_line(key.Mark()) + "found a key that is not a word, expected the name of an option");
  return key.Scalar();
}

/// An option set by the file.
struct SetAt {
  std::string option;
  std::string line;
};

using Elsewhere = std::function<bool(std::string_view, std::string_view)>;

/// Removed options are reported whatever their values, which may be lists.
void set_at(Config& config, const std::string& name, const YAML::Node& key, const YAML::Node& value,
            const Elsewhere& elsewhere, std::vector<SetAt>& options) {
  try {
    const std::string text = value.IsSequence() ? "a list" : text_of(value);
    if (elsewhere && elsewhere(name, text)) return;
    set(config, name, text);
  } catch (const Error& error) {
    const std::string what = error.what();
    throw Error(what.starts_with("line ") ? what : at_line(key.Mark()) + what);
  }
  options.push_back({name, at_line(key.Mark())});
}

void read_section(Config& config, const std::string& section, const YAML::Node& map,
                  const Elsewhere& elsewhere, std::vector<SetAt>& options) {
  for (const auto& entry : map) {
    set_at(config, section + "." + key_of(entry.first), entry.first, entry.second, elsewhere, options);
  }
}

using FromPreset = std::function<Config(std::string_view)>;

void read_preset(Config& config, const YAML::Node& value, const FromPreset& from_preset) {
  if (!value.IsScalar())
    throw Error(at_line(value.Mark()) + "preset is not a word, expected default or paper");
  try {
    config = from_preset(value.Scalar());
  } catch (const Error& error) {
    throw Error(at_line(value.Mark()) + error.what());
  }
}

void read_root(Config& config, const YAML::Node& root, const FromPreset& from_preset,
               const Elsewhere& elsewhere, std::vector<SetAt>& options) {
  if (!root.IsDefined() || root.IsNull()) return;  // an empty file, or comments only
  if (!root.IsMap()) throw Error("is not a map of options, expected lines such as 'match.window_size: 9'");
  bool first = true;
  for (const auto& entry : root) {
    const std::string key = key_of(entry.first);
    if (key == "preset" && !first) {
      throw Error(at_line(entry.first.Mark()) +
                  "preset comes after options, which it would undo; expected it first");
    }
    first = false;
    if (key == "preset") {
      read_preset(config, entry.second, from_preset);
    } else if (entry.second.IsMap()) {
      read_section(config, key, entry.second, elsewhere, options);
    } else if (entry.second.IsNull() && key.find('.') == std::string::npos) {
      continue;  // a section with only comments
    } else {
      set_at(config, key, entry.first, entry.second, elsewhere, options);
    }
  }
}

bool reads(const Config& config, const std::string& option) {
  try {
    require_active(config, option);
  } catch (const Error&) {
    return false;
  }
  return true;
}

/// Throws Error for options of the file without effect, both in its own configuration and in the final one.
void require_effects(const std::vector<SetAt>& options, const Config& of_file, const Config& with_all) {
  for (const auto& [option, line] : options) {
    if (reads(with_all, option)) continue;
    try {
      require_active(of_file, option);
    } catch (const Error& error) {
      throw Error(line + error.what());
    }
  }
}

}  // namespace

void load_config(const fs::path& path, Config& config, const FromPreset& from_preset,
                 const std::function<void(Config&)>& on_top, const Elsewhere& elsewhere) {
  const std::string text = read_file(path, kMaxTextBytes);
  Config read = config;
  std::vector<SetAt> options;
  try {
    if (text.find('\0') != std::string::npos) throw Error("is not text, expected options in YAML");
    const std::vector<YAML::Node> documents = yaml_documents(text);
    if (documents.size() > 1)
      throw Error("has " + std::to_string(documents.size()) + " documents, expected one");
    if (!documents.empty()) read_root(read, documents.front(), from_preset, elsewhere, options);
  } catch (const YAML::Exception& exception) {
    throw Error(path.string() + ": " + at_line(exception.mark) + "is not YAML: " + exception.msg);
  } catch (const Error& error) {
    throw Error(path.string() + ": " + error.what());
  }
  Config with_all = read;
  if (on_top) on_top(with_all);
  try {
    require_effects(options, read, with_all);
  } catch (const Error& error) {
    throw Error(path.string() + ": " + error.what());
  }
  config = std::move(read);
}

std::string options_yaml(const std::vector<OptionInfo>& options) {
  std::string text;
  std::string section;
  for (const OptionInfo& option : options) {
    if (!option.active) continue;
    const std::size_t dot = option.name.find('.');
    if (option.name.substr(0, dot) != section) {
      section = option.name.substr(0, dot);
      text += section + ":\n";
    }
    text += "  " + option.name.substr(dot + 1) + ": " + option.value + "  # ";
    if (!option.unit.empty()) text += option.unit + "; ";
    text += option.domain + "; " + option.help + "\n";
  }
  return text;
}

std::string config_yaml(const Config& config) {
  return options_yaml(options(config));
}

std::string changed_config_yaml(std::string_view preset, const Config& config,
                                const std::vector<std::string>& also) {
  const std::vector<OptionInfo> all = options(config);
  const std::vector<OptionInfo> known = options(Config::preset(preset));
  std::vector<OptionInfo> changed;
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool wanted = std::find(also.begin(), also.end(), all[i].name) != also.end();
    if (all[i].active && (wanted || all[i].value != known[i].value)) changed.push_back(all[i]);
  }
  return "preset: " + std::string(preset) + "\n" + options_yaml(changed);
}

}  // namespace cairn::io
