// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cairn/core/error.hpp>
#include <cairn/diagnosis/diagnose.hpp>
#include <cairn/diagnosis/synchrony.hpp>
#include <cairn/io/atomic_file.hpp>
#include <cairn/io/calibration_files.hpp>
#include <cairn/output/diagnosis_json.hpp>
#include <cairn/output/json.hpp>
#include <cmath>
#include <iostream>

#include "commands.hpp"
#include "common.hpp"
#include "findings.hpp"
#include "keep_inputs.hpp"
#include "rig_report.hpp"
#include "terminal.hpp"

namespace cairn::cli {
namespace {

using output::Json;
namespace fs = std::filesystem;

constexpr std::size_t kLongestSequence = 60;  // pairs held in memory at a time
constexpr std::size_t kMaxSequences = 4;      // of a longer folder: at its start, its end and in between

struct DoctorOptions {
  InputOptions input;
  ExecOptions exec;
  std::optional<std::string> json;
  std::optional<std::string> report;
  bool report_images = false;
  int frames = 40;
  bool strict = false;
};

/// The outcome of one pair.
struct ExaminedPair {
  std::string name;
  std::optional<Size> size;              // of the left image
  std::optional<PairMeasures> measures;  // nullopt if the images differ in size
  std::vector<Finding> findings;
  std::vector<SkippedCheck> not_checked;
};

// ---- one pair ----

/// The pair, or nullopt and a finding if the sizes differ. Throws Error for other faults.
std::optional<io::LoadedPair> load_or_find(const io::FrameFiles& files, ExaminedPair& examined,
                                           const Exec& exec) {
  const fs::path& right_file = right_of(files);
  try {
    io::LoadedPair images = io::load_pair(files, exec.pool);
    examined.size = images.left.gray.size();
    return images;
  } catch (const Error&) {
    const Size left = io::load_picture(files.left, exec.pool).gray.size();
    const Size right = io::load_picture(right_file, exec.pool).gray.size();
    if (left == right) throw;
    examined.size = left;
    examined.findings.push_back({FindingKind::sizes, Severity::broken,
                                 static_cast<double>(right.area()) / static_cast<double>(left.area()),
                                 "the left image is " + text(left) + ", the right one " + text(right)});
    return std::nullopt;
  }
}

/// The calibration; nullopt and a finding if it is impossible or belongs to other images.
io::Calibration calibration_or_find(const io::FrameFiles& files, const InputOptions& options,
                                    ExaminedPair& examined) {
  std::optional<fs::path> path = files.calib;
  if (!options.calib.empty()) path = options.calib;
  if (!path) return {};
  io::Calibration calibration;
  try {
    calibration = io::load_calibration(*path);
  } catch (const io::ImpossibleCalibration& error) {
    examined.findings.push_back(
        {FindingKind::impossible_calibration, Severity::broken, error.value(), error.what()});
    return {};
  }
  if (sets_search_range(options.config)) calibration.num_disparities.reset();
  io::check_search_range(calibration, *path);
  if (options.scale_calibration && examined.size) return io::suited(calibration, *examined.size, *path, true);
  if (calibration.image_size && examined.size && *calibration.image_size != *examined.size) {
    examined.findings.push_back({FindingKind::calibration, Severity::broken,
                                 static_cast<double>(calibration.image_size->width),
                                 "the calibration is of " + text(*calibration.image_size) +
                                     " images, these are " + text(*examined.size)});
    calibration.rig.reset();
  }
  return calibration;
}

/// For a calibration of raw cameras: judges by the rows whether the images are already rectified.
void examine_rectification(ExaminedPair& examined) {
  const auto is = [](FindingKind kind) {
    return [kind](const Finding& finding) { return finding.kind == kind; };
  };
  const auto& found = examined.findings;
  const auto rows = std::find_if(found.begin(), found.end(), [](const Finding& finding) {
    return finding.kind == FindingKind::rectification || finding.kind == FindingKind::rows ||
           finding.kind == FindingKind::nothing_in_common;
  });
  const bool is_unknown = std::any_of(found.begin(), found.end(), is(FindingKind::few_points));
  if (rows == found.end() && !is_unknown) return;
  const RowAlignment& measured = examined.measures->rows;
  examined.findings.push_back(
      {FindingKind::raw_calibration, is_unknown ? Severity::note : Severity::warning,
       static_cast<double>(std::abs(measured.offset_rows)),
       is_unknown ? "the file describes the distortion of the cameras; whether the images were rectified "
                    "with it cannot be determined"
                  : "the file describes the distortion of the cameras, and the images do not seem to be "
                    "rectified with it"});
}

ExaminedPair examine(const io::FrameFiles& files, const DoctorOptions& options, const Exec& exec) {
  ExaminedPair examined{files.name, {}, {}, {}, {}};
  const std::optional<io::LoadedPair> images = load_or_find(files, examined, exec);
  const io::Calibration calibration = calibration_or_find(files, options.input, examined);
  if (!images) return examined;
  const Config config = resolve(options.input.config, calibration.num_disparities).config;
  examined.measures = measure_pair(StereoPair::from(images->left.gray, images->right.gray), exec);
  for (Finding& finding : diagnose(*examined.measures, calibration.rig, config.match, DiagnosisConfig{}))
    examined.findings.push_back(std::move(finding));
  examined.not_checked = not_checked(*examined.measures, calibration.rig, DiagnosisConfig{});
  if (calibration.of_raw_cameras) examine_rectification(examined);
  return examined;
}

// ---- a folder ----

/// At most `most` indices of 0 … count − 1, spread evenly.
std::vector<std::size_t> spread(std::size_t count, std::size_t most) {
  std::vector<std::size_t> some(std::min(count, most));
  for (std::size_t i = 0; i < some.size(); ++i) some[i] = i * count / some.size();
  return some;
}

/// Consecutive pairs of a folder.
struct Sequence {
  std::size_t first = 0;  // index in the folder
  std::vector<std::string> names;
  Synchrony synchrony;
  std::optional<Finding> finding;  // its frames are indices in the folder

  [[nodiscard]] Severity severity() const { return finding ? finding->severity : Severity::note; }
};

struct Diagnosis {
  std::size_t pairs_in_all = 0;
  std::vector<ExaminedPair> pairs;
  std::vector<std::size_t> indices;  // index in the folder of each pair
  SkippedFiles left_out;             // pairs with unusable files
  std::optional<Sequence> sequence;
  std::vector<Finding> findings;
};

std::optional<Finding> find_sizes(const std::vector<ExaminedPair>& pairs) {
  Finding finding{FindingKind::sizes, Severity::note, 1, {}};
  for (std::size_t i = 1; i < pairs.size(); ++i) {
    if (pairs[i].size == pairs[0].size) continue;
    finding.value = static_cast<double>(pairs[i].size->area()) / static_cast<double>(pairs[0].size->area());
    if (finding.says.empty()) {
      finding.says = pairs[0].name + " is " + text(*pairs[0].size) + ", " + pairs[i].name + " is " +
                     text(*pairs[i].size) + ": more than one rig, or more than one setting";
    }
    finding.frames.push_back(i);
  }
  if (finding.says.empty()) return std::nullopt;
  return finding;
}

/// nullopt if it is unusable, which ends the consecutive pairs.
std::optional<io::LoadedPair> load_if_possible(const io::FrameFiles& files, const Exec& exec) {
  try {
    return load_images(files, exec.pool);
  } catch (const Error&) {
    return std::nullopt;
  }
}

/// Consecutive usable pairs of one size, from `first` on.
Sequence sequence_from(std::size_t first, const std::vector<io::FrameFiles>& frames, const Exec& exec) {
  std::vector<io::LoadedPair> images;
  std::vector<StereoPair> pairs;
  Sequence sequence;
  sequence.first = first;
  for (std::size_t i = first; i < std::min(frames.size(), first + kLongestSequence); ++i) {
    std::optional<io::LoadedPair> one = load_if_possible(frames[i], exec);
    if (!one) break;
    if (!images.empty() && one->left.gray.size() != images.front().left.gray.size()) break;
    images.push_back(std::move(*one));
    sequence.names.push_back(frames[i].name);
  }
  pairs.reserve(images.size());
  for (const io::LoadedPair& one : images) pairs.push_back(StereoPair::from(one.left.gray, one.right.gray));
  sequence.synchrony = measure_synchrony(pairs, exec);
  sequence.finding = diagnose(sequence.synchrony, sequence.names);
  if (!sequence.finding) return sequence;
  for (std::size_t& frame : sequence.finding->frames) frame += first;
  if (frames.size() > sequence.names.size() && !sequence.synchrony.change)
    sequence.finding->says += ", in " + sequence.names.front() + " to " + sequence.names.back();
  return sequence;
}

/// The most significant result: the cameras are out of step; else that they are in step; else inconclusive.
Sequence telling_sequence(const std::vector<io::FrameFiles>& frames, const Exec& exec) {
  const std::size_t rest = frames.size() - std::min(frames.size(), kLongestSequence);
  const std::size_t count =
      std::min(kMaxSequences, (frames.size() + kLongestSequence - 1) / kLongestSequence);
  Sequence best = sequence_from(0, frames, exec);
  for (std::size_t k = 1; k < count && best.severity() < Severity::broken; ++k) {
    Sequence next = sequence_from(k * rest / (count - 1), frames, exec);
    const bool tells_first = best.finding && !next.finding && best.severity() == Severity::note;
    if (next.severity() > best.severity() || tells_first) best = std::move(next);
  }
  return best;
}

/// On a moving rig, pairs out of step appear misaligned in rows: downgrade that finding to a note.
void explain_rows(Diagnosis& diagnosis) {
  const Finding& lost = *diagnosis.sequence->finding;
  if (lost.severity != Severity::broken) return;
  const bool to_the_end =
      lost.frames.back() + 1 == diagnosis.sequence->first + diagnosis.sequence->names.size();
  const auto is_out_of_step = [&](std::size_t pair) {
    const std::size_t at = diagnosis.indices[pair];
    return at >= lost.frames.front() && (to_the_end || at <= lost.frames.back());
  };
  for (Finding& finding : diagnosis.findings) {
    if (finding.kind != FindingKind::rectification && finding.kind != FindingKind::rows) continue;
    if (!std::all_of(finding.frames.begin(), finding.frames.end(), is_out_of_step)) continue;
    finding.severity = Severity::note;
    finding.says += "; these pairs are out of step, which alone can cause this";
  }
}

/// The finding with its frames renumbered as indices of the measured pairs.
Finding of_measured_pairs(Finding finding, const Diagnosis& diagnosis) {
  std::vector<std::size_t> measured;
  for (std::size_t i = 0; i < diagnosis.indices.size(); ++i) {
    if (std::find(finding.frames.begin(), finding.frames.end(), diagnosis.indices[i]) != finding.frames.end())
      measured.push_back(i);
  }
  finding.frames = std::move(measured);
  return finding;
}

/// An unreadable calibration is bad input; an impossible one is a finding.
void check_calibration(const std::string& path) {
  if (path.empty()) return;
  try {
    (void)io::load_calibration(path);
  } catch (const io::ImpossibleCalibration&) {
    return;
  }
}

Diagnosis examine_all(const DoctorOptions& options, const std::vector<io::FrameFiles>& frames) {
  (void)resolve(options.input.config);  // reports bad options before any work
  check_calibration(options.input.calib);
  const Exec exec = make_exec(options.exec);
  const std::vector<std::size_t> tried = spread(frames.size(), static_cast<std::size_t>(options.frames));
  Diagnosis diagnosis;
  diagnosis.pairs_in_all = frames.size();
  std::vector<std::vector<Finding>> findings;
  {
    const Progress progress(tried.size());
    for (std::size_t i = 0; i < tried.size(); ++i) {
      const io::FrameFiles& frame = frames[tried[i]];
      progress.at(i, frame.name);
      try {
        diagnosis.pairs.push_back(examine(frame, options, exec));
      } catch (const Error& error) {
        if (frames.size() == 1) throw;
        progress.clear();
        diagnosis.left_out.add(frame.name, error.what());
        continue;
      }
      diagnosis.indices.push_back(tried[i]);
      findings.push_back(diagnosis.pairs.back().findings);
    }
  }
  if (diagnosis.pairs.empty()) throw Error(options.input.left + ": none of its pairs can be used");
  diagnosis.findings = united(findings);
  const auto add = [&](const std::optional<Finding>& finding) {
    if (!finding) return;
    const auto after = std::find_if(diagnosis.findings.begin(), diagnosis.findings.end(),
                                    [&](const Finding& other) { return other.kind >= finding->kind; });
    if (after == diagnosis.findings.end() || after->kind != finding->kind)
      diagnosis.findings.insert(after, *finding);
  };
  const bool measured = std::all_of(diagnosis.pairs.begin(), diagnosis.pairs.end(),
                                    [](const ExaminedPair& one) { return one.measures.has_value(); });
  if (frames.size() > 1 && measured) {
    diagnosis.sequence = telling_sequence(frames, exec);
    if (diagnosis.sequence->finding) {
      explain_rows(diagnosis);
      add(of_measured_pairs(*diagnosis.sequence->finding, diagnosis));
    }
  }
  add(find_sizes(diagnosis.pairs));
  return diagnosis;
}

// ---- numbers ----

std::string numbers_text(const std::vector<ExaminedPair>& pairs) {
  const bool several = pairs.size() > 1;
  if (std::none_of(pairs.begin(), pairs.end(),
                   [](const ExaminedPair& pair) { return pair.measures.has_value(); }))
    return {};
  Table table(several ? std::vector<std::string>{"measured", "least", "median", "most"}
                      : std::vector<std::string>{"measured", ""});
  for (const output::PairNumber& number : output::pair_numbers()) {
    std::vector<double> values;
    for (const ExaminedPair& pair : pairs) {
      if (pair.measures) values.push_back(number.of(*pair.measures));
    }
    std::erase_if(values, [](double value) { return std::isnan(value); });
    std::sort(values.begin(), values.end());
    if (values.empty()) {
      const std::string none = "not measured";
      table.add(several ? std::vector<std::string>{number.name, "", none, ""}
                        : std::vector<std::string>{number.name, none});
      continue;
    }
    const std::string median = text_of(number.format, values[values.size() / 2]);
    if (several) {
      table.add({number.name, text_of(number.format, values.front()), median,
                 text_of(number.format, values.back())});
    } else {
      table.add({number.name, median});
    }
  }
  return table.text();
}

using Histogram = decltype(RowAlignment::histogram);

Histogram histogram_of(const std::vector<ExaminedPair>& pairs) {
  Histogram sum{};
  for (const ExaminedPair& pair : pairs) {
    for (std::size_t i = 0; pair.measures && i < sum.size(); ++i) sum[i] += pair.measures->rows.histogram[i];
  }
  return sum;
}

/// A histogram as two lines, "rows off       -1     0    +1" and the numbers of points, without empty bins at
/// the ends.
std::string histogram_text(const Histogram& histogram) {
  const auto is_used = [](int count) { return count > 0; };
  const auto first = std::find_if(histogram.begin(), histogram.end(), is_used);
  const auto last = std::find_if(histogram.rbegin(), histogram.rend(), is_used).base();
  if (first == histogram.end()) return {};
  std::vector<std::string> rows{"rows off"};
  std::vector<std::string> counts{"points"};
  for (auto bin = first; bin != last; ++bin) {
    const int at = static_cast<int>(bin - histogram.begin()) - RowAlignment::kMaxBins;
    const std::string beyond = std::abs(at) == RowAlignment::kMaxBins ? " or more" : "";
    rows.push_back(text_of(at == 0 ? "%.0f" : "%+.0f", at) + beyond);
    counts.push_back(std::to_string(*bin));
  }
  Table table(std::move(rows));
  table.add(std::move(counts));
  return table.text();
}

// ---- text ----

std::vector<std::string> names_of(const std::vector<ExaminedPair>& pairs) {
  std::vector<std::string> names;
  names.reserve(pairs.size());
  for (const ExaminedPair& pair : pairs) names.push_back(pair.name);
  return names;
}

std::string findings_text(const Diagnosis& diagnosis) {
  std::string all;
  for (const Finding& finding : diagnosis.findings) {
    std::string severity = name_of(finding.severity);
    severity.resize(9, ' ');
    all += severity + std::string(info(finding.kind).name) + ": " + finding.says +
           frames_text(finding, names_of(diagnosis.pairs), "pairs") + "\n         " +
           std::string(info(finding.kind).remedy) + "\n";
  }
  return all;
}

/// A check that was not possible for some pairs.
struct Omission {
  SkippedCheck first;  // from the first of these pairs
  std::vector<std::size_t> pairs;
};

std::vector<Omission> omissions(const Diagnosis& diagnosis) {
  std::vector<Omission> all;
  const auto add = [&](const SkippedCheck& one, std::size_t pair) {
    const auto known =
        std::find_if(all.begin(), all.end(), [&](const Omission& o) { return o.first.check == one.check; });
    if (known != all.end()) {
      known->pairs.push_back(pair);
    } else {
      all.push_back({one, {pair}});
    }
  };
  for (std::size_t i = 0; i < diagnosis.pairs.size(); ++i) {
    for (const SkippedCheck& one : diagnosis.pairs[i].not_checked) add(one, i);
    if (!diagnosis.pairs[i].measures)
      add({"everything but the sizes", "the two images differ in size", false}, i);
  }
  const auto frames = diagnosis.sequence ? diagnosis.sequence->synchrony.frames : 1;
  if (diagnosis.pairs_in_all == 1 || frames < Synchrony::kMinFrames) {
    all.push_back({{"synchrony",
                    std::to_string(diagnosis.sequence ? frames : static_cast<int>(diagnosis.pairs_in_all)) +
                        (frames == 1 ? " pair" : " pairs") + " in a row, expected " +
                        std::to_string(Synchrony::kMinFrames),
                    false},
                   {}});
  }
  return all;
}

std::string omissions_text(const std::vector<Omission>& omitted, const Diagnosis& diagnosis) {
  std::string all;
  for (const Omission& one : omitted) {
    Finding pairs;
    pairs.frames = one.pairs;
    all += (one.first.is_for_want_of_it ? "cannot tell  " : "not checked  ") + std::string(one.first.check) +
           ": " + one.first.why + frames_text(pairs, names_of(diagnosis.pairs), "pairs") + "\n";
  }
  return all;
}

std::string names_of(const std::vector<Finding>& findings, Severity severity) {
  std::string all;
  for (const Finding& finding : findings) {
    if (finding.severity == severity) all += (all.empty() ? "" : ", ") + std::string(info(finding.kind).name);
  }
  return all;
}

/// The worst findings by name, and the checks that were possible for no pair.
std::string verdict(const Diagnosis& diagnosis, const std::vector<Omission>& omitted) {
  std::string all = "verdict: ";
  std::string unknown;
  for (const Omission& one : omitted) {
    if (one.first.is_for_want_of_it && one.pairs.size() == diagnosis.pairs.size())
      unknown += (unknown.empty() ? "; cannot tell: " : ", ") + std::string(one.first.check);
  }
  if (const std::string broken = names_of(diagnosis.findings, Severity::broken); !broken.empty()) {
    return all + "broken: " + broken + "\n";
  }
  const std::string warnings = names_of(diagnosis.findings, Severity::warning);
  return all + (warnings.empty() ? "nothing wrong found" : "warning: " + warnings) + unknown + "\n";
}

// ---- JSON ----

Json diagnosis_json(const Diagnosis& diagnosis, bool is_broken) {
  Json j{{"cairn", CAIRN_VERSION}, {"broken", is_broken}, {"pairs_in_all", diagnosis.pairs_in_all}};
  j["findings"] = Json::array();
  for (const Finding& finding : diagnosis.findings)
    j["findings"].push_back(output::json_of(finding, names_of(diagnosis.pairs)));
  j["not_checked"] = Json::array();
  for (const Omission& one : omissions(diagnosis)) {
    Json pairs = Json::array();
    for (const std::size_t i : one.pairs) pairs.push_back(diagnosis.pairs[i].name);
    j["not_checked"].push_back({{"check", one.first.check},
                                {"why", one.first.why},
                                {"cannot_tell", one.first.is_for_want_of_it},
                                {"pairs", pairs}});
  }
  j["left_out"] = diagnosis.left_out.frames();
  j["pairs"] = Json::array();
  for (const ExaminedPair& pair : diagnosis.pairs) {
    Json one{{"name", pair.name}, {"width", pair.size->width}, {"height", pair.size->height}};
    one["measured"] = pair.measures ? output::json_of(*pair.measures) : Json(nullptr);
    j["pairs"].push_back(std::move(one));
  }
  j["synchrony"] = nullptr;
  if (diagnosis.sequence && !diagnosis.sequence->names.empty())
    j["synchrony"] = output::json_of(diagnosis.sequence->synchrony, diagnosis.sequence->names);
  return j;
}

/// Everything about the rig that helps to find a fault from afar.
std::string report_text(const std::vector<io::FrameFiles>& frames, const Diagnosis& diagnosis,
                        const DoctorOptions& options, bool is_broken) {
  const io::FrameFiles& first = frames[diagnosis.indices.front()];
  Json report = rig_report(first, options.input, options.exec, options.report_images);
  report["diagnosis"] = diagnosis_json(diagnosis, is_broken);
  return output::json_text(without_folders(std::move(report), frames, options.input), 1) + "\n";
}

int examine_and_tell(const DoctorOptions& options) {
  if (options.report) require_writable(*options.report);
  const std::vector<io::FrameFiles> frames = frames_of(options.input);
  if (options.report) {
    for (const io::FrameFiles& frame : frames) keep_inputs({*options.report}, frame, options.input);
  }
  const Diagnosis diagnosis = examine_all(options, frames);
  const bool broken = is_broken(diagnosis.findings);
  if (options.json)
    io::write_file(*options.json, output::json_text(diagnosis_json(diagnosis, broken), 1) + "\n");
  if (options.report) io::write_file(*options.report, report_text(frames, diagnosis, options, broken));
  const std::vector<Omission> omitted = omissions(diagnosis);
  for (const std::string& part :
       {numbers_text(diagnosis.pairs), histogram_text(histogram_of(diagnosis.pairs)),
        findings_text(diagnosis), omissions_text(omitted, diagnosis)}) {
    if (!part.empty()) std::cout << part << "\n";
  }
  std::cout << verdict(diagnosis, omitted);
  const int left_out =
      diagnosis.left_out.exit_code(diagnosis.pairs.size() + diagnosis.left_out.frames().size());
  const bool warned = !names_of(diagnosis.findings, Severity::warning).empty();
  return broken || (options.strict && warned) ? 1 : left_out;
}

/// All findings with number and remedy, and all limits.
std::string explanation() {
  std::string all;
  for (const FindingInfo& known : kFindings) {
    all += std::string(known.name) + "\n    measured: " + std::string(known.number) +
           (known.unit.empty() ? "" : " (" + std::string(known.unit) + ")") +
           "\n    remedy:   " + std::string(known.remedy) + "\n";
  }
  DiagnosisConfig config;
  std::string lines;
  fields(config, [&](const char* name, const auto& value, const char* unit, const char* help, const auto&) {
    std::string start = name;
    start.resize(20, ' ');
    std::string amount = text_of("%g ", static_cast<double>(value)) + unit;
    amount.resize(std::max<std::size_t>(amount.size(), 16), ' ');
    lines += start + amount + help + "\n";
  });
  return all + "\nlimits\n" + lines;
}

}  // namespace

Work declare_doctor(CLI::App& app) {
  auto options = std::make_shared<DoctorOptions>();
  add_input_options(app, options->input);
  add_exec_options(app, options->exec);
  app.add_option("--frames", options->frames, "number of pairs of a folder to measure, spread evenly")
      ->check(CLI::Range(1, 100000).name(""))
      ->type_name("N")
      ->capture_default_str();
  app.add_option("--json", options->json, "JSON file for findings and measurements")->type_name("FILE");
  auto* report = app.add_option("--report", options->report,
                                "JSON file to attach to an issue; no images, no folder names")
                     ->type_name("FILE");
  app.add_flag("--report-images", options->report_images, "the first pair's images in --report, too")
      ->needs(report);
  app.add_flag("--strict", options->strict, "exit code 1 for warnings too");
  app.add_flag_callback(
         "--explain",
         [] {
           std::cout << explanation();
           throw CLI::Success();
         },
         "list of all findings with measured quantity and remedy, and of all limits")
      ->trigger_on_parse();
  app.footer(
      "Lists the faults of the rig, each with the measured value and the remedy.\n"
      "The last line is the verdict; above it are the measurements, the findings, and the "
      "checks that were not possible, with the reason.\n"
      "Exit codes: 0 nothing is broken, 1 something is (with --strict: or a warning), 2 bad "
      "usage, file or option.\n"
      "docs/doctor.md explains each finding.");
  return [options] { return examine_and_tell(*options); };
}

}  // namespace cairn::cli
