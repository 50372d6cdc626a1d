// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#pragma once

#include <array>
#include <atomic>
#include <cairn/core/pair_copy.hpp>
#include <cairn/device/device.hpp>
#include <cairn/device/engine.hpp>
#include <chrono>
#include <cstdint>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace cairn::device {

/// How a device is trusted.
struct Trust {
  bool must_be_faster = false;            // than the processor, on the first pairs; else it is given up
  std::chrono::seconds reopen_after{10};  // after a loss …
  int most_reopenings = 3;
};

/// A MatchDevice from an engine that may fail. Each kind of kernel is compared with the processor before its first pair;
/// whatever the engine cannot do, or begins and loses, the processor computes. No result depends on any of it.
class CarefulDevice final : public MatchDevice {
 public:
  using Open = std::function<std::unique_ptr<Engine>()>;
  using Clock = std::chrono::steady_clock;

  /// Opens the engine at once, and throws Unfit or Lost like `open`, or if it computes something else; or, if it must be
  /// faster, on a thread of its own, where a failure gives the device up.
  CarefulDevice(Open open, Trust trust, Notice notice, std::string wanted = {});
  /// Waits for an engine that is being opened, or is at work.
  ~CarefulDevice() override;

  [[nodiscard]] bool takes_early(const MatchConfig& config) const override;
  void begin(const StereoPair& pair, const MatchConfig& config, const SemiGlobalConfig& penalties) override;
  std::optional<Matches> match(const StereoPair& pair, const MatchConfig& config,
                               const SemiGlobalConfig& penalties, const Exec& exec) override;
  [[nodiscard]] DeviceReport report() const override;

 private:
  struct Task {
    PairCopy images;
    MatchConfig config;
    SemiGlobalConfig penalties;
    Task(const StereoPair& pair, const MatchConfig& match, const SemiGlobalConfig& semi_global,
         const Pool& pool);
    [[nodiscard]] bool equals(const StereoPair& pair, const MatchConfig& match,
                              const SemiGlobalConfig& semi_global) const;
  };
  struct Done {
    Task task;
    Matches matches;
    std::vector<DeviceKernel> work;
  };
  /// Wall times of the first pairs, which device and processor compute in turn.
  struct Race {
    std::vector<double> device_ms;
    std::vector<double> processor_ms;
  };
  /// What an engine can refuse: width, height, number of disparities.
  using Search = std::array<int, 3>;
  static Search search_of(const StereoPair& pair, const MatchConfig& config);

  std::optional<Matches> match_or_leave(const StereoPair& pair, const MatchConfig& config,
                                        const SemiGlobalConfig& penalties, const Exec& exec);

  // Under engine_mutex_:
  bool is_ready();
  void take(std::unique_ptr<Engine> tested);
  void start_opening();
  void be_sure_of(const MatchConfig& config);
  void submit_waiting();
  Matches on_device(const StereoPair& pair, const MatchConfig& config, const SemiGlobalConfig& penalties,
                    const Exec& exec);
  void decide_race();
  void lose(const Lost& lost);
  void give_up(const std::string& why);

  void count(bool on_device, const std::vector<DeviceKernel>& work = {});
  void notify(const std::string& says);
  void tell();

  const Open open_;
  const Trust trust_;
  const Notice notice_;
  const Pool pool_ = Pool::make();
  std::atomic<bool> is_taking_ = false;  // begin() has an effect

  std::mutex engine_mutex_;         // held while the engine works; locked before the other two
  std::unique_ptr<Engine> engine_;  // null: not opened yet, lost, or given up
  std::set<std::string> trusted_;   // variants of its kernels
  std::set<Search> unfit_;          // for it
  bool is_given_up_ = false;
  int losses_ = 0;
  Clock::time_point lost_at_;
  std::optional<Race> race_;       // until it is decided
  std::optional<Task> submitted_;  // by begin(): at work
  std::optional<Done> done_;       // begun, and finished before it was asked for

  std::mutex queue_mutex_;
  std::optional<Task> waiting_;  // by begin(): submitted when the engine is free

  mutable std::mutex report_mutex_;
  DeviceReport report_;
  std::set<std::string> told_;
  std::vector<std::string> untold_;

  std::future<std::unique_ptr<Engine>> opening_;  // last: its work uses the others
};

}  // namespace cairn::device
