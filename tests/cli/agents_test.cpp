// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/fleet/fleet_book.hpp>
#include <cairn/fleet/shared_map.hpp>
#include <cairn/live/dds/agents.hpp>
#include <cairn/ros/dds/participant.hpp>
#include <cairn/sequence/map_file.hpp>
#include <chrono>
#include <cmath>
#include <csignal>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "command.hpp"
#include "support/dds_domain.hpp"
#include "support/landmark_rooms.hpp"

/// Robots, a map agent and a watch as processes: what they know of each other, and what happens when one dies. Limits in
/// time are ten times those of docs/agents.md.
namespace cairn::command {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::json;

constexpr auto kLimit = 30s;

/// A command that runs beside the test.
class Process {
 public:
  Process(const std::vector<std::string>& arguments, const std::string& folder, const std::string& log) {
    id_ = ::fork();
    if (id_ != 0) return;
    const int out = ::open((log + ".out").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    const int err = ::open((log + ".err").c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    ::dup2(out, STDOUT_FILENO);
    ::dup2(err, STDERR_FILENO);
    std::vector<char*> argv;
    std::vector<std::string> words{CAIRN_COMMAND};
    words.insert(words.end(), arguments.begin(), arguments.end());
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    if (::chdir(folder.c_str()) == 0) ::execv(CAIRN_COMMAND, argv.data());
    ::_exit(127);
  }
  ~Process() {
    if (id_ > 0) end(SIGKILL);
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
  void signal(int which) const { ::kill(id_, which); }
  /// The exit code; 128 + signal if it was killed.
  int end(int which) {
    signal(which);
    int status = 0;
    ::waitpid(id_, &status, 0);
    id_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
  [[nodiscard]] pid_t id() const { return id_; }

 private:
  pid_t id_ = -1;
};
using ProcessPtr = std::unique_ptr<Process>;

class Agents : public CommandTest {
 protected:
  Agents() { ::unsetenv("CYCLONEDDS_URI"); }

  static std::string domain() { return std::to_string(120 + ::getpid() % 100); }

  /// A map file with these landmarks.
  void write_map(const std::string& name, const LandmarkMap& map) const {
    MapFile::open(at(name + ".db"), MapMode::update).replace(map);
  }
  /// Two robots in one room of 14 things.
  void write_two_maps() const {
    write_map("a", map_of(room_, 0, 10, {}));
    write_map("b", map_of(room_, 4, 14, turned_by(0.7, 2, -1)));
  }

  [[nodiscard]] ProcessPtr start(const std::string& log, std::vector<std::string> arguments) const {
    arguments.insert(arguments.end(), {"--fleet-domain", domain()});
    return std::make_unique<Process>(arguments, path(""), path(log));
  }
  [[nodiscard]] ProcessPtr robot(const std::string& name) const {
    return start("robot_" + name, {"live", CAIRN_SOURCE_DIR "/data/sequences/rolling_ball", "--loop",
                                   "--every-frame", "--map", path(name + ".db"), "--share", name});
  }
  [[nodiscard]] ProcessPtr map_agent(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{"agent", "map", path("fleet.db")};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return start("map", arguments);
  }
  [[nodiscard]] ProcessPtr watch() const { return start("watch", {"agent", "watch", "--json-lines"}); }

  /// The last line of the watch.
  [[nodiscard]] Json seen() const {
    const std::string text = content(at("watch.out"));
    const std::size_t end = text.rfind('\n');
    if (end == std::string::npos) return Json::object();
    const std::size_t begin = end == 0 ? std::string::npos : text.rfind('\n', end - 1);
    return Json::parse(text.substr(begin == std::string::npos ? 0 : begin + 1, end));
  }
  /// "ok", "SILENT" …; empty if it is not listed.
  [[nodiscard]] std::string state_of(const std::string& name) const {
    const Json now = seen();
    std::string state;
    for (const Json& agent : now.value("agents", Json::array())) {
      if (agent["name"] == name && state != "ok" && state != "warning") state = agent["state"];
    }
    return state;
  }
  [[nodiscard]] bool is_alive(const std::string& name) const {
    const std::string state = state_of(name);
    return !state.empty() && state != "SILENT" && state != "ended";
  }
  /// Those whose place in the shared map is known, with all their landmarks.
  [[nodiscard]] std::size_t located() const {
    const Json now = seen();
    std::size_t count = 0;
    for (const Json& one : now.value("robots", Json::array()))
      count += one["located"].get<bool>() && one["landmarks"] == 10 ? 1U : 0U;
    return count;
  }

  /// The file of the map agent equals the robots' files, merged.
  void expect_merged() const {
    const MapFile fleet = MapFile::open(at("fleet.db"), MapMode::read_only);
    EXPECT_TRUE(fleet.check().empty());
    const LandmarkMap shared = fleet.load();
    std::map<std::string, LandmarkMap> own;
    for (const char* const name : {"a", "b"})
      own[name] = MapFile::open(at(std::string(name) + ".db"), MapMode::read_only).load();
    const bool is_a_first = [&] {
      const std::string id = MapFile::open(at("a.db"), MapMode::read_only).map_id();
      return fleet.kept().at("origin") == id;
    }();
    MapsMerge merged = merge_all(own[is_a_first ? "a" : "b"], {{own[is_a_first ? "b" : "a"], false, {}}}, {});
    ASSERT_EQ(shared.list.size(), room_.size());
    ASSERT_EQ(merged.map.list.size(), room_.size());
    for (const Landmark& expected : merged.map.list) {
      EXPECT_TRUE(std::ranges::any_of(shared.list, [&](const Landmark& landmark) {
        return landmark.position_m == expected.position_m &&
               landmark.covariance_m2 == expected.covariance_m2 && landmark.seen == expected.seen &&
               landmark.log_odds == expected.log_odds;
      })) << number(expected.id);
    }
    EXPECT_EQ(shared.floor.size(), merged.map.floor.size());
  }

  const std::vector<Landmark> room_ = room_of(14, 21);
};

TEST_F(Agents, TwoRobotsShareOneMapWhateverStartsFirst) {
  write_two_maps();
  const ProcessPtr watching = watch();
  ProcessPtr a = robot("a");
  ASSERT_TRUE(comes_true([&] { return is_alive("a"); }, kLimit)) << content(at("robot_a.err"));
  ProcessPtr map = map_agent();  // late: the rows of a are there already
  ASSERT_TRUE(comes_true([&] { return located() == 1; }, kLimit)) << content(at("map.err"));
  ProcessPtr b = robot("b");
  ASSERT_TRUE(comes_true([&] { return located() == 2; }, kLimit)) << content(at("map.err"));

  // The shared map, its view and the transforms, for those who know nothing of cairn.
  const ros::Participant person(ros::domain_of_fleet(static_cast<std::uint32_t>(std::stoi(domain())), ""));
  ros::Reader<ros::Detection3DArray> landmarks(person, "/cairn/map/landmarks",
                                               {.reliable = true, .depth = 1, .latched = true});
  ros::Reader<ros::TFMessage> transforms(person, "/tf", {.reliable = true, .depth = 5});
  ros::Reader<ros::DiagnosticArray> diagnostics(person, "/diagnostics", {.reliable = true, .depth = 5});
  std::optional<ros::Detection3DArray> view;
  EXPECT_TRUE(comes_true([&] {
    if (auto newer = landmarks.take()) view = std::move(newer);
    return view && view->detections.size() == room_.size();
  }));
  EXPECT_EQ(view->header.frame_id, "map");
  std::optional<ros::TFMessage> placed;
  EXPECT_TRUE(comes_true([&] { return (placed = transforms.take()) && placed->transforms.size() == 2; }));
  std::set<std::string> said;
  EXPECT_TRUE(comes_true([&] {
    while (const auto message = diagnostics.take()) said.insert(message->status.at(0).name);
    return said.size() == 3;
  }));
  EXPECT_EQ(said, (std::set<std::string>{"a/cairn: perception", "b/cairn: perception", "cairn: map"}));

  EXPECT_EQ(a->end(SIGTERM), 0) << content(at("robot_a.err"));
  EXPECT_NE(content(at("robot_a.err")).find("shared as a in domain " + domain() + ": 10 landmarks"),
            std::string::npos)
      << content(at("robot_a.err"));
  EXPECT_EQ(b->end(SIGTERM), 0);
  EXPECT_TRUE(comes_true([&] { return state_of("a") == "ended" && state_of("b") == "ended"; }, kLimit));
  EXPECT_EQ(map->end(SIGTERM), 0) << content(at("map.err"));
  EXPECT_NE(content(at("map.err")).find("b: located at"), std::string::npos) << content(at("map.err"));
  expect_merged();
  EXPECT_EQ(run({"map", "check", path("fleet.db")}).code, 0);
}

TEST_F(Agents, OneThatIsKilledOrHangsIsNoticedAndComesBack) {
  write_two_maps();
  const ProcessPtr watching = watch();
  ProcessPtr map = map_agent();
  ProcessPtr a = robot("a");
  const ProcessPtr b = robot("b");
  ASSERT_TRUE(comes_true([&] { return located() == 2; }, kLimit)) << content(at("map.err"));
  const Outcome well = run({"agent", "watch", "--once", "--expect", "a", "--expect", "b", "--expect", "map",
                            "--wait", "20", "--fleet-domain", domain()});
  EXPECT_EQ(well.code, 0) << well.err << well.out;
  EXPECT_NE(well.out.find("perception"), std::string::npos) << well.out;

  // Killed: its landmarks stay, and it is listed.
  EXPECT_EQ(a->end(SIGKILL), 128 + SIGKILL);
  EXPECT_TRUE(comes_true([&] { return state_of("a") == "SILENT"; }, kLimit));
  EXPECT_EQ(located(), 2U);
  EXPECT_TRUE(is_alive("b"));
  EXPECT_EQ(run({"map", "check", path("a.db")}).code, 0);
  const Outcome ill =
      run({"agent", "watch", "--once", "--expect", "a", "--wait", "1", "--fleet-domain", domain()});
  EXPECT_EQ(ill.code, 3) << ill.out;
  EXPECT_NE(ill.err.find("a: missing"), std::string::npos) << ill.err;
  a = robot("a");
  EXPECT_TRUE(comes_true([&] { return is_alive("a"); }, kLimit)) << content(at("robot_a.err"));

  // Stopped, as if its work hung.
  b->signal(SIGSTOP);
  EXPECT_TRUE(comes_true([&] { return state_of("b") == "SILENT"; }, kLimit));
  EXPECT_TRUE(is_alive("a"));
  b->signal(SIGCONT);
  EXPECT_TRUE(comes_true([&] { return is_alive("b"); }, kLimit));

  // The map agent: robots go on, and it has lost nothing.
  EXPECT_EQ(map->end(SIGKILL), 128 + SIGKILL);
  EXPECT_TRUE(comes_true([&] { return state_of("map") == "SILENT"; }, kLimit));
  EXPECT_TRUE(is_alive("a") && is_alive("b"));
  EXPECT_EQ(run({"map", "check", path("fleet.db")}).code, 0);
  map = map_agent();
  EXPECT_TRUE(comes_true([&] { return is_alive("map") && located() == 2; }, kLimit))
      << content(at("map.err"));
  EXPECT_EQ(map->end(SIGTERM), 0);
  expect_merged();
}

TEST_F(Agents, ARobotInAnotherPlaceIsUnknownUnlessItsPoseIsGiven) {
  write_two_maps();
  write_map("c", map_of(room_of(10, 77), 0, 10, {}));
  const ProcessPtr watching = watch();
  const ProcessPtr a = robot("a");
  const ProcessPtr c = robot("c");
  const auto located_at = [&](const std::string& name) -> std::optional<double> {
    const Json now = seen();
    for (const Json& one : now.value("robots", Json::array()))
      if (one["name"] == name && one["located"].get<bool>()) return one["x_m"].get<double>();
    return std::nullopt;
  };
  {
    const ProcessPtr map = map_agent();
    ASSERT_TRUE(comes_true([&] { return seen().value("robots", Json::array()).size() == 2; }, kLimit));
    std::this_thread::sleep_for(2s);
    EXPECT_EQ(located(), 1U);
    map->end(SIGTERM);
  }
  ASSERT_TRUE(comes_true([&] { return !is_alive("map"); }, kLimit));
  const ProcessPtr map = map_agent({"--at", "a=1,0,0", "--at", "c=50,0,90"});
  EXPECT_TRUE(comes_true([&] { return located_at("a") == 1 && located_at("c") == 50; }, kLimit))
      << seen().dump(1);
  // The file belongs to the agent.
  refuses({"agent", "map", path("fleet.db"), "--forget", "c"}, {"fleet.db", "in use"});
  map->end(SIGTERM);
  EXPECT_EQ(run({"agent", "map", path("fleet.db"), "--forget", "c"}).code, 0);
  EXPECT_EQ(MapFile::open(at("fleet.db"), MapMode::read_only).load().list.size(), 10U);
  refuses({"agent", "map", path("fleet.db"), "--forget", "c"}, {"--forget c", "no such robot"});
}

TEST_F(Agents, AMapAgentThatWasStoppedMissesNothing) {
  const ProcessPtr watching = watch();
  const ProcessPtr map = map_agent();
  const auto sink = live::share_sink(
      {"a", "00112233445566778899aabbccddeeff", {}, {static_cast<std::uint32_t>(std::stoi(domain())), ""}});
  const auto known = [&] {
    const Json now = seen();
    for (const Json& one : now.value("robots", Json::array())) return one["landmarks"].get<int>();
    return 0;
  };
  std::vector<Landmark> large = room_of(300, 5);
  for (Landmark& landmark : large) {
    landmark.looks.resize(8, landmark.looks[0]);
    for (int octant = 0; octant < 8; ++octant)
      landmark.looks[static_cast<std::size_t>(octant)].octant = octant;
  }
  const auto offer = [&](std::size_t count) {
    sink->offer_map(std::make_shared<const LandmarkMap>(map_of(large, 0, count, {})), 1);
  };
  offer(5);
  ASSERT_TRUE(comes_true([&] { return known() == 5; }, kLimit)) << content(at("map.err"));
  map->signal(SIGSTOP);
  for (std::size_t count = 50; count <= large.size(); count += 50) {
    offer(count);
    std::this_thread::sleep_for(400ms);
  }
  map->signal(SIGCONT);
  EXPECT_TRUE(comes_true([&] { return known() == 300; }, kLimit)) << known();
  sink->finish();
}

TEST_F(Agents, ADeletedMapFileMakesANewRobotOfThatName) {
  write_two_maps();
  const ProcessPtr watching = watch();
  const ProcessPtr map = map_agent({"--at", "a=3,0,0"});
  {
    const ProcessPtr a = robot("a");
    ASSERT_TRUE(comes_true([&] { return located() == 1; }, kLimit)) << content(at("map.err"));
    a->end(SIGTERM);
  }
  for (const char* const file : {"a.db", "a.db-wal", "a.db-shm"}) fs::remove(at(file));
  write_map("a", map_of(room_of(10, 88), 0, 10, {}));
  const ProcessPtr a = robot("a");
  const auto states = [&] {
    std::vector<std::string> all;
    const Json now = seen();
    for (const Json& one : now.value("robots", Json::array()))
      all.push_back(one["located"].get<bool>() ? "at " + std::to_string(std::lround(one["x_m"].get<double>()))
                                               : one.value("refusal", ""));
    std::ranges::sort(all);
    return all;
  };
  EXPECT_TRUE(comes_true(
      [&] {
        return states() == std::vector<std::string>{"a former map of this robot", "at 3"};
      },
      kLimit))
      << seen().dump(1);
}

TEST_F(Agents, NothingIsSharedUnlessItIsAskedFor) {
  const auto sockets_of = [](const Process& process) {
    int count = 0;
    for (const auto& entry : fs::directory_iterator("/proc/" + std::to_string(process.id()) + "/fd")) {
      std::error_code gone;
      count += fs::read_symlink(entry, gone).string().starts_with("socket:") ? 1 : 0;
    }
    return count;
  };
  const Process alone({"live", CAIRN_SOURCE_DIR "/data/sequences/rolling_ball", "--loop", "--map",
                       path("a.db"), "--json-lines"},
                      path(""), path("alone"));
  ASSERT_TRUE(comes_true([&] { return !content(at("alone.out")).empty(); }, kLimit))
      << content(at("alone.err"));
  EXPECT_EQ(sockets_of(alone), 0);
  write_map("b", {});
  const ProcessPtr sharing = robot("b");
  EXPECT_TRUE(comes_true([&] { return sockets_of(*sharing) > 0; }, kLimit));
}

TEST_F(Agents, RefuseBadOptions) {
  const std::string source = CAIRN_SOURCE_DIR "/data/sequences/rolling_ball";
  refuses({"live", source, "--share", "a"}, {"--share", "--map"});
  refuses({"live", source, "--share", "a", "--map", path("none.db"), "--read-only"}, {"none.db"});
  refuses({"agent", "watch", "--expect", "a"}, {"--expect", "--once"});
  refuses({"agent", "watch", "--wait", "3"}, {"--wait", "--once"});
  refuses({"agent", "map", path("f.db"), "--forget", "a", "--at", "a=1,2,3"}, {"--at", "--forget"});
  refuses({"live", source, "--fleet-domain", "3"}, {"--fleet-domain", "--share"});
  refuses({"live", source, "--fleet-interface", "lo"}, {"--fleet-interface", "--share"});
  write_map("a", map_of(room_, 0, 4, {}));
  const std::string map = path("a.db");
  refuses({"live", source, "--map", map, "--share", "Robot A"}, {"--share", "Robot A"});
  refuses({"live", source, "--map", map, "--share", "a", "--fleet-domain", "233"},
          {"fleet domain", "233", "232"});
  refuses({"live", source, "--map", map, "--read-only", "--share", "a"}, {"--share", "--read-only"});
  refuses({"agent", "map", map}, {"a.db", "is the map of a robot"});
  EXPECT_EQ(MapFile::open(map, MapMode::read_only).load().list.size(), 4U);
  refuses({"agent", "map"}, {"FILE"});
  refuses({"agent", "watch", "x.db"}, {"FILE", "agent map"});
  refuses({"agent", "watch", "--at", "a=1,2,3"}, {"--at", "agent map"});
  refuses({"agent", "map", path("f.db"), "--once"}, {"--once", "agent watch"});
  refuses({"agent", "map", path("f.db"), "--at", "a=1,2"}, {"--at a=1,2", "X,Y,DEG"});
  refuses({"agent", "map", path("f.db"), "--at", "a=1,2,3", "--at", "a=1,2,3"}, {"--at", "second"});
  refuses({"agent", "map", path("f.db"), "--forget", "a"}, {"f.db", "no such file"});
  refuses({"agent", "map", path("f.db"), "--duration", "-1"}, {"--duration", "-1"});
  refuses({"agent", "watch", "--once", "--wait", "-1"}, {"--wait", "-1"});
  refuses({"agent", "watch", "--once", "--duration", "1"}, {"--duration", "--once"});
}

}  // namespace
}  // namespace cairn::command
