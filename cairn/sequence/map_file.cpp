// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/sequence/map_file.hpp>

#include <SQLiteCpp/SQLiteCpp.h>
#include <fcntl.h>
#include <sqlite3.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cairn/core/error.hpp>
#include <cmath>
#include <cstring>
#include <map>
#include <new>
#include <nlohmann/json.hpp>
#include <random>
#include <type_traits>

namespace cairn {
namespace {

namespace fs = std::filesystem;

constexpr int kApplication = 0x63726e31;  // "crn1"
constexpr int kSchema = 1;
constexpr int kFramesPerTransaction = 30;
constexpr double kSecondsPerTransaction = 1;
constexpr int kMaxObservations = 200;   // of one landmark in one run
constexpr double kSameBaseline = 0.02;  // relative

constexpr const char* kTables = R"(
CREATE TABLE meta(key TEXT PRIMARY KEY, value TEXT NOT NULL);
CREATE TABLE run(id INTEGER PRIMARY KEY, source TEXT NOT NULL, began_ns INTEGER NOT NULL, ended_ns INTEGER NOT NULL,
  frames INTEGER NOT NULL, map_from_odom BLOB, state TEXT NOT NULL);
CREATE TABLE pose(run INTEGER NOT NULL REFERENCES run, stamp_ns INTEGER NOT NULL, tx REAL, ty REAL, tz REAL,
  qx REAL, qy REAL, qz REAL, qw REAL, cov BLOB, PRIMARY KEY(run, stamp_ns)) WITHOUT ROWID;
CREATE TABLE landmark(id INTEGER PRIMARY KEY, x REAL, y REAL, z REAL, cov BLOB, narrowest REAL, widest REAL,
  height REAL, over_floor REAL, log_odds REAL, state TEXT NOT NULL, name TEXT NOT NULL, seen INTEGER, expected INTEGER,
  seen_through INTEGER, open_share REAL, first_ns INTEGER, last_ns INTEGER, run INTEGER);
CREATE TABLE look(landmark INTEGER NOT NULL REFERENCES landmark ON DELETE CASCADE, octant INTEGER NOT NULL,
  hist BLOB NOT NULL, crop BLOB, pixels INTEGER, PRIMARY KEY(landmark, octant)) WITHOUT ROWID;
CREATE TABLE observation(run INTEGER NOT NULL REFERENCES run, stamp_ns INTEGER NOT NULL,
  landmark INTEGER NOT NULL REFERENCES landmark ON DELETE CASCADE, track INTEGER, x REAL, y REAL, z REAL, cov BLOB,
  confidence REAL, PRIMARY KEY(landmark, run, stamp_ns)) WITHOUT ROWID;
CREATE TABLE event(id INTEGER PRIMARY KEY, run INTEGER NOT NULL REFERENCES run, stamp_ns INTEGER NOT NULL,
  kind TEXT NOT NULL, landmark INTEGER, x REAL, y REAL, z REAL, dx REAL, dy REAL, dz REAL, probability REAL,
  frames TEXT);
CREATE TABLE floor(x INTEGER NOT NULL, y INTEGER NOT NULL, frames INTEGER NOT NULL, PRIMARY KEY(x, y)) WITHOUT ROWID;
)";

/// Numbers from a blob, in the machine's byte order.
template <class T, std::size_t N>
std::array<T, N> numbers_in(const SQLite::Column& column, const char* what) {
  std::array<T, N> values{};
  if (column.getBytes() != static_cast<int>(sizeof values)) {
    throw Error(std::string(what) + " of " + std::to_string(column.getBytes()) + " bytes, expected " +
                std::to_string(sizeof values));
  }
  std::memcpy(values.data(), column.getBlob(), sizeof values);
  for (const T value : values) {
    if (!std::isfinite(value)) throw Error(std::string(what) + " contains numbers that are not finite");
  }
  return values;
}

double finite(const SQLite::Column& column, const char* what) {
  const double value = column.getDouble();
  if (column.isNull() || !std::isfinite(value) || std::abs(value) > 1e9)
    throw Error(std::string(what) + " is not a finite number");
  return value;
}

constexpr int kMaxWhole = std::numeric_limits<int>::max();

int whole(std::int64_t value, const char* what, int least = 0) {
  if (value < least || value > kMaxWhole) {
    throw Error(std::string(what) + " is " + std::to_string(value) + ", expected " + std::to_string(least) +
                " … " + std::to_string(kMaxWhole));
  }
  return static_cast<int>(value);
}

int whole(const SQLite::Column& column, const char* what, int least = 0) {
  return whole(column.getInt64(), what, least);
}

/// A side of a landmark, m.
double side(const SQLite::Column& column, const char* what) {
  constexpr double kMax_m = 1000;
  const double value = finite(column, what);
  if (value < 0 || value > kMax_m)
    throw Error(std::string(what) + " is " + std::to_string(value) + ", expected 0 … 1000 m");
  return value;
}

/// Ids are counted up from 1, so the highest must leave room.
LandmarkId landmark_id(std::int64_t value) {
  constexpr std::int64_t kMax = std::int64_t{1} << 53U;
  if (value < 1 || value > kMax)
    throw Error("landmark " + std::to_string(value) + ": expected an id of 1 … 2^53");
  return LandmarkId{value};
}

template <class E, std::size_t N>
E choice_in(const SQLite::Column& column, const std::array<Choice<E>, N>& choices, const char* what) {
  const std::string name = column.getString();
  for (const Choice<E>& choice : choices) {
    if (choice.name == name) return choice.value;
  }
  throw Error(std::string(what) + " is '" + name + "'");
}

/// The upper triangle in single precision: 84 instead of 288 bytes per keyframe.
std::array<float, 21> packed(const Covariance6& covariance) {
  std::array<float, 21> values{};
  std::size_t at = 0;
  for (std::size_t r = 0; r < 6; ++r) {
    for (std::size_t c = r; c < 6; ++c) values[at++] = static_cast<float>(covariance[6 * r + c]);
  }
  return values;
}

Covariance6 unpacked(const std::array<float, 21>& values) {
  Covariance6 covariance{};
  std::size_t at = 0;
  for (std::size_t r = 0; r < 6; ++r) {
    for (std::size_t c = r; c < 6; ++c) {
      covariance[6 * r + c] = static_cast<double>(values[at]);
      covariance[6 * c + r] = static_cast<double>(values[at++]);
    }
  }
  return covariance;
}

std::array<double, 7> numbers_of(const Pose& pose) {
  const std::array<double, 4> q = quaternion(pose);
  return {pose.translation_m.x, pose.translation_m.y, pose.translation_m.z, q[0], q[1], q[2], q[3]};
}

Pose pose_from(const std::array<double, 7>& n) {
  const double norm = std::sqrt(n[3] * n[3] + n[4] * n[4] + n[5] * n[5] + n[6] * n[6]);
  if (std::abs(norm - 1) > 1e-3) throw Error("a rotation is not a unit quaternion");
  return pose_of({n[0], n[1], n[2]}, {n[3], n[4], n[5], n[6]});
}

template <class T, std::size_t N>
void bind_numbers(SQLite::Statement& statement, int index, const std::array<T, N>& values) {
  statement.bind(index, values.data(), static_cast<int>(sizeof values));
}

std::string random_id() {
  std::random_device device;
  std::string id;
  for (int i = 0; i < 4; ++i) {
    char part[9];
    std::snprintf(part, sizeof part, "%08x", device());
    id += part;
  }
  return id;
}

/// A file: URI with the path percent-encoded, as SQLite expects.
std::string uri_of(const fs::path& path) {
  std::string uri = "file:";
  for (const char c : fs::absolute(path).string()) {
    if (c == '?' || c == '#' || c == '%') {
      char code[4];
      std::snprintf(code, sizeof code, "%%%02X", static_cast<unsigned>(static_cast<unsigned char>(c)));
      uri += code;
    } else {
      uri += c;
    }
  }
  return uri;
}

std::string words_for(const SQLite::Exception& error) {
  switch (error.getErrorCode()) {
    case SQLITE_NOTADB:
      return "is not a map: not an SQLite file";
    case SQLITE_CORRUPT:
      return "is damaged: " + std::string(error.what());
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return "is in use by another process";
    case SQLITE_READONLY:
      return "cannot be written: read-only";
    case SQLITE_FULL:
      return "cannot be written: no space left";
    case SQLITE_IOERR:
      return "cannot be read or written: " + std::string(error.what());
    case SQLITE_CANTOPEN:
      return "cannot be opened";
    default:
      break;
  }
  std::string words = error.what();
  std::replace(words.begin(), words.end(), '\n', ' ');
  return "is damaged, or not a map: " + words;
}

/// The stored state of a landmark, to detect changes.
struct StoredLandmark {
  double log_odds = 0;
  int seen = 0;
  int expected = 0;
  bool is_gone = false;
  Point3 position_m;
  std::string name;
  std::vector<int> pixels;  // of each look
  friend bool operator==(const StoredLandmark&, const StoredLandmark&) = default;
};

StoredLandmark stored_of(const Landmark& landmark) {
  StoredLandmark stored{landmark.log_odds,
                        landmark.seen,
                        landmark.expected,
                        landmark.is_gone,
                        landmark.position_m,
                        landmark.name,
                        {}};
  for (const LandmarkLook& look : landmark.looks) stored.pixels.push_back(8 * look.pixels + look.octant);
  return stored;
}

}  // namespace

struct MapFile::Store {
  fs::path path;
  MapMode mode = MapMode::read_only;
  // Released after the database is closed: closing any other descriptor of the file would drop SQLite's own
  // locks.
  struct Lock {
    int file = -1;
    ~Lock() {
      if (file >= 0) ::close(file);
    }
  } lock;
  std::unique_ptr<SQLite::Database> database;

  std::int64_t run = 0;
  int frames = 0;
  int since_commit = 0;
  Stamp committed;
  Stamp latest;
  bool is_open = false;  // inside a transaction
  std::optional<Pose> map_from_odom;
  std::map<LandmarkId, StoredLandmark> stored;
  std::vector<FloorCell> stored_floor;
  bool knows_kept_map = false;  // `stored` and `stored_floor` are those of the last keep()
  struct ThinningRule {
    int every = 1;
    int met = 0;
    int kept = 0;
  };
  std::map<LandmarkId, ThinningRule> thinning;

  /// Opens the database; locks the file for updates.
  void connect() {
    constexpr int kPatience_ms = 2000;
    if (mode == MapMode::update) {
      lock.file = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
      if (lock.file < 0) throw Error(std::string("cannot be written: ") + std::strerror(errno));
      if (::flock(lock.file, LOCK_EX | LOCK_NB) != 0) throw Error("is in use by another process");
      database = std::make_unique<SQLite::Database>(
          path.string(), SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE, kPatience_ms);
      return;
    }
    // Without a journal there is no writer. The file is then opened as immutable, since SQLite would
    // otherwise create files next to it, which fails in a read-only folder.
    std::error_code unimportant;
    const bool is_quiet = !fs::exists(path.string() + "-wal", unimportant);
    database = std::make_unique<SQLite::Database>(uri_of(path) + (is_quiet ? "?immutable=1" : ""),
                                                  SQLite::OPEN_READONLY | SQLite::OPEN_URI, kPatience_ms);
  }

  /// The tables of a new map.
  void create() {
    database->exec("PRAGMA application_id=" + std::to_string(kApplication));
    database->exec("PRAGMA user_version=" + std::to_string(kSchema));
    database->exec(kTables);
    set("cairn", CAIRN_VERSION);
    set("frame_id", "map");
    set("map_id", random_id());
  }

  /// Calls `work` and rethrows its errors as Error with the file's name.
  template <class F>
  auto guarded(F&& work) const {
    try {
      return work();
    } catch (const SQLite::Exception& error) {
      if (error.getErrorCode() == SQLITE_NOMEM) throw std::bad_alloc();
      throw Error(path.string() + ": " + words_for(error));
    } catch (const Error& error) {
      throw Error(path.string() + ": " + error.what());
    }
  }

  void begin() {
    if (is_open) return;
    database->exec("BEGIN IMMEDIATE");
    is_open = true;
  }

  void commit(const LandmarkMap& map) {
    store(map);
    SQLite::Statement update(*database, "UPDATE run SET ended_ns=?, frames=?, map_from_odom=? WHERE id=?");
    update.bind(1, latest.ns);
    update.bind(2, frames);
    if (map_from_odom) {
      bind_numbers(update, 3, numbers_of(*map_from_odom));
    } else {
      update.bind(3);
    }
    update.bind(4, run);
    update.exec();
    database->exec("COMMIT");
    is_open = false;
    since_commit = 0;
    committed = latest;
  }

  void rollback() noexcept {
    if (!is_open) return;
    is_open = false;
    try {
      database->exec("ROLLBACK");
    } catch (const SQLite::Exception&) {  // SQLite has rolled back already
    } catch (const std::bad_alloc&) {     // closing the database rolls back
    }
  }

  void store_pose(const LandmarkFrame& frame, const MapLocation& located) const {
    SQLite::Statement put(*database, "INSERT OR REPLACE INTO pose VALUES(?,?,?,?,?,?,?,?,?,?)");
    put.bind(1, run);
    put.bind(2, frame.stamp.ns);
    const auto numbers = numbers_of(located.map_from_odom * frame.odom_from_camera);
    for (std::size_t i = 0; i < numbers.size(); ++i) put.bind(static_cast<int>(i) + 3, numbers[i]);
    bind_numbers(put, 10, packed(camera_covariance(located, frame.pose_covariance)));
    put.exec();
  }

  void store_event(const LandmarkEvent& event) const {
    SQLite::Statement put(
        *database,
        "INSERT INTO event(run, stamp_ns, kind, landmark, x, y, z, dx, dy, dz, probability, "
        "frames) VALUES(?,?,?,?,?,?,?,?,?,?,?,?)");
    int i = 0;
    put.bind(++i, run);
    put.bind(++i, event.stamp.ns);
    put.bind(++i, choice_name(event.kind, kLandmarkEventKinds));
    put.bind(++i, number(event.landmark));
    for (const double v : {event.position_m.x, event.position_m.y, event.position_m.z, event.moved_by_m.x,
                           event.moved_by_m.y, event.moved_by_m.z, event.probability})
      put.bind(++i, v);
    put.bind(++i, nlohmann::json(event.frames).dump());
    put.exec();
  }

  /// Stores one in `every` observations of a landmark in a run.
  void store_observation(const LandmarkOfTrack& seen, const LandmarkFrame& frame,
                         const MapLocation& located) {
    if (seen.landmark == LandmarkId::none || !stored.contains(seen.landmark)) return;
    const auto track = std::find_if(frame.tracks->list.begin(), frame.tracks->list.end(),
                                    [&](const Track& t) { return t.id == seen.track; });
    if (track == frame.tracks->list.end() || track->object == ObjectId::none) return;
    ThinningRule& thin = thinning[seen.landmark];
    if (thin.met++ % thin.every != 0) return;
    if (thin.kept >= kMaxObservations) halve_observations(seen.landmark, thin);
    SQLite::Statement put(*database, "INSERT OR REPLACE INTO observation VALUES(?,?,?,?,?,?,?,?,?)");
    const Point3 at = located.map_from_odom(track->position_m);
    put.bind(1, run);
    put.bind(2, frame.stamp.ns);
    put.bind(3, number(seen.landmark));
    put.bind(4, number(seen.track));
    put.bind(5, at.x);
    put.bind(6, at.y);
    put.bind(7, at.z);
    bind_numbers(put, 8, rotated(located.map_from_odom, track->covariance_m2));
    put.bind(9, static_cast<double>(track->confidence));
    put.exec();
    ++thin.kept;
  }

  /// Of the stored observations, and from now on the rate of new ones.
  void halve_observations(LandmarkId landmark, ThinningRule& thin) const {
    SQLite::Statement drop(
        *database,
        "DELETE FROM observation WHERE landmark=?1 AND run=?2 AND stamp_ns IN (SELECT stamp_ns FROM "
        "(SELECT stamp_ns, row_number() OVER (ORDER BY stamp_ns) AS n FROM observation WHERE landmark=?1 "
        "AND run=?2) WHERE n % 2 = 0)");
    drop.bind(1, number(landmark));
    drop.bind(2, run);
    thin.kept -= drop.exec();
    thin.every *= 2;
  }

  void store_landmark(const Landmark& l) const {
    SQLite::Statement put(
        *database,
        "INSERT INTO landmark VALUES(?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?) ON CONFLICT(id) DO UPDATE SET "
        "x=excluded.x, y=excluded.y, z=excluded.z, cov=excluded.cov, narrowest=excluded.narrowest, "
        "widest=excluded.widest, height=excluded.height, over_floor=excluded.over_floor, "
        "log_odds=excluded.log_odds, state=excluded.state, name=excluded.name, seen=excluded.seen, "
        "expected=excluded.expected, seen_through=excluded.seen_through, open_share=excluded.open_share, "
        "first_ns=excluded.first_ns, last_ns=excluded.last_ns, run=excluded.run");
    int i = 0;
    put.bind(++i, number(l.id));
    for (const double v : {l.position_m.x, l.position_m.y, l.position_m.z}) put.bind(++i, v);
    bind_numbers(put, ++i, l.covariance_m2);
    for (const double v :
         {l.size.narrowest_m, l.size.widest_m, l.size.height_m, l.height_over_floor_m, l.log_odds})
      put.bind(++i, v);
    put.bind(++i, l.is_gone ? "gone" : "present");
    put.bind(++i, l.name);
    for (const int v : {l.seen, l.expected, l.seen_through}) put.bind(++i, v);
    put.bind(++i, l.open_share);
    for (const std::int64_t v : {l.first.ns, l.last.ns, l.run}) put.bind(++i, v);
    put.exec();
    SQLite::Statement drop(*database, "DELETE FROM look WHERE landmark=?");
    drop.bind(1, number(l.id));
    drop.exec();
    SQLite::Statement look(*database, "INSERT INTO look VALUES(?,?,?,?,?)");
    for (const LandmarkLook& one : l.looks) {
      look.reset();
      look.bind(1, number(l.id));
      look.bind(2, one.octant);
      bind_numbers(look, 3, one.colours);
      if (one.crop_png.empty()) {
        look.bind(4);
      } else {
        look.bind(4, one.crop_png.data(), static_cast<int>(one.crop_png.size()));
      }
      look.bind(5, one.pixels);
      look.exec();
    }
  }

  /// Writes the differences from the stored state.
  void store(const LandmarkMap& map) {
    for (const Landmark& landmark : map.list) {
      StoredLandmark now = stored_of(landmark);
      const auto at = stored.find(landmark.id);
      if (at != stored.end() && at->second == now) continue;
      store_landmark(landmark);
      stored[landmark.id] = std::move(now);
    }
    for (auto at = stored.begin(); at != stored.end();) {
      if (find(map, at->first) != nullptr) {
        ++at;
        continue;
      }
      SQLite::Statement drop(*database, "DELETE FROM landmark WHERE id=?");
      drop.bind(1, number(at->first));
      drop.exec();
      at = stored.erase(at);
    }
    set("next_landmark", std::to_string(map.next));
    SQLite::Statement cell(
        *database, "INSERT INTO floor VALUES(?,?,?) ON CONFLICT(x, y) DO UPDATE SET frames=excluded.frames");
    auto before = stored_floor.begin();
    for (const FloorCell& now : map.floor) {
      while (before != stored_floor.end() && std::tie(before->x, before->y) < std::tie(now.x, now.y))
        ++before;
      if (before != stored_floor.end() && *before == now) continue;
      cell.reset();
      cell.bind(1, now.x);
      cell.bind(2, now.y);
      cell.bind(3, now.frames);
      cell.exec();
    }
    // A map restarted in a new segment has dropped its floor.
    SQLite::Statement drop(*database, "DELETE FROM floor WHERE x=? AND y=?");
    auto now = map.floor.begin();
    for (const FloorCell& was : stored_floor) {
      while (now != map.floor.end() && std::tie(now->x, now->y) < std::tie(was.x, was.y)) ++now;
      if (now != map.floor.end() && now->x == was.x && now->y == was.y) continue;
      drop.reset();
      drop.bind(1, was.x);
      drop.bind(2, was.y);
      drop.exec();
    }
    stored_floor = map.floor;
  }

  void set(const std::string& key, const std::string& value) const {
    SQLite::Statement put(*database,
                          "INSERT INTO meta VALUES(?,?) ON CONFLICT(key) DO UPDATE SET value=excluded.value");
    put.bind(1, key);
    put.bind(2, value);
    put.exec();
  }

  void store_kept(const std::map<std::string, std::optional<std::string>>& changes) const {
    if (changes.empty()) return;
    database->exec(
        "CREATE TABLE IF NOT EXISTS kept(key TEXT PRIMARY KEY, value BLOB NOT NULL) WITHOUT ROWID");
    SQLite::Statement put(*database,
                          "INSERT INTO kept VALUES(?,?) ON CONFLICT(key) DO UPDATE SET value=excluded.value");
    SQLite::Statement drop(*database, "DELETE FROM kept WHERE key=?");
    for (const auto& [key, value] : changes) {
      SQLite::Statement& statement = value ? put : drop;
      statement.reset();
      statement.bind(1, key);
      if (value) statement.bind(2, value->data(), static_cast<int>(value->size()));
      statement.exec();
    }
  }

  [[nodiscard]] std::optional<std::string> get(const std::string& key) const {
    SQLite::Statement ask(*database, "SELECT value FROM meta WHERE key=?");
    ask.bind(1, key);
    if (!ask.executeStep()) return std::nullopt;
    return ask.getColumn(0).getString();
  }

  [[nodiscard]] std::optional<StereoRig> known_rig() const {
    const auto text = get("rig");
    if (!text) return std::nullopt;
    const nlohmann::json json = nlohmann::json::parse(*text, nullptr, false);
    StereoRig rig;
    const auto read = [&](const char* key, float& value) {
      if (!json.is_object() || !json.contains(key) || !json[key].is_number())
        throw Error("its rig has no " + std::string(key));
      value = json[key].get<float>();
    };
    read("focal_px", rig.focal_px);
    read("cx_px", rig.cx_px);
    read("cy_px", rig.cy_px);
    read("baseline_m", rig.baseline_m);
    read("doffs_px", rig.doffs_px);
    return rig;
  }

  void meet(const StereoRig& rig) {
    const auto known = known_rig();
    if (known) {
      const double ratio = static_cast<double>(rig.baseline_m) / static_cast<double>(known->baseline_m);
      if (!(std::abs(ratio - 1) <= kSameBaseline)) {
        char words[160];
        std::snprintf(words, sizeof words,
                      "is the map of another rig: its baseline is %g m, that of these frames %g m",
                      static_cast<double>(known->baseline_m), static_cast<double>(rig.baseline_m));
        throw Error(words);
      }
    } else if (mode == MapMode::update) {
      const nlohmann::json json{{"focal_px", rig.focal_px},
                                {"cx_px", rig.cx_px},
                                {"cy_px", rig.cy_px},
                                {"baseline_m", rig.baseline_m},
                                {"doffs_px", rig.doffs_px}};
      set("rig", json.dump());
    }
  }
};

MapFile::MapFile(std::unique_ptr<Store> store) : store_(std::move(store)) {}
MapFile::MapFile(MapFile&&) noexcept = default;
MapFile& MapFile::operator=(MapFile&&) noexcept = default;
MapFile::~MapFile() {
  if (store_) store_->rollback();
}

namespace {

/// Whether the file exists. Throws Error if it cannot be opened in this mode.
bool check_file(const fs::path& path, bool is_update) {
  std::error_code unimportant;
  const auto status = fs::status(path, unimportant);
  if (fs::is_directory(status)) throw Error("is a folder, expected a map");
  const bool is_there = fs::exists(status);
  if (!is_there && !is_update) throw Error("no such file");
  if (is_there && !fs::is_regular_file(status)) throw Error("is not a regular file");
  if (!is_there && path.has_parent_path() && !fs::is_directory(path.parent_path(), unimportant))
    throw Error("its folder does not exist");
  if (is_there && is_update && ::access(path.c_str(), W_OK) != 0)
    throw Error("cannot be written: read-only; --read-only uses it unchanged");
  return is_there;
}

void check_schema(SQLite::Database& database) {
  const int application = database.execAndGet("PRAGMA application_id").getInt();
  const int schema = database.execAndGet("PRAGMA user_version").getInt();
  if (application != kApplication) throw Error("is the database of another program, expected a map");
  if (schema > kSchema) {
    throw Error("was written by a newer cairn: schema " + std::to_string(schema) + ", known up to " +
                std::to_string(kSchema));
  }
  if (schema < 1) throw Error("has schema " + std::to_string(schema) + ", expected 1");
}

}  // namespace

MapFile MapFile::open(const fs::path& path, MapMode mode, const std::optional<StereoRig>& rig) {
  auto store = std::make_unique<Store>();
  store->path = path;
  store->mode = mode;
  const bool is_update = mode == MapMode::update;
  return store->guarded([&] {
    const bool is_there = check_file(path, is_update);
    std::error_code unimportant;
    store->connect();
    SQLite::Database& database = *store->database;
    const bool is_empty = is_update && (!is_there || fs::file_size(path, unimportant) == 0);
    if (!is_empty) check_schema(database);
    database.exec("PRAGMA foreign_keys=ON");
    if (is_update) {
      database.exec("PRAGMA journal_mode=WAL");
      database.exec("PRAGMA synchronous=NORMAL");
      database.exec("BEGIN IMMEDIATE");
      store->is_open = true;
      if (is_empty) store->create();
      database.exec("UPDATE run SET state='aborted' WHERE state='running'");
      if (rig) store->meet(*rig);
      database.exec("COMMIT");
      store->is_open = false;
    } else if (rig) {
      store->meet(*rig);
    }
    return MapFile(std::move(store));
  });
}

namespace {

std::vector<Landmark> load_landmarks(const SQLite::Database& database) {
  std::vector<Landmark> list;
  SQLite::Statement rows(
      database,
      "SELECT id, x, y, z, cov, narrowest, widest, height, over_floor, log_odds, state, name, "
      "seen, expected, seen_through, open_share, first_ns, last_ns, run FROM landmark ORDER BY id");
  while (rows.executeStep()) {
    Landmark l;
    l.id = landmark_id(rows.getColumn(0).getInt64());
    l.position_m = {finite(rows.getColumn(1), "landmark.x"), finite(rows.getColumn(2), "landmark.y"),
                    finite(rows.getColumn(3), "landmark.z")};
    l.covariance_m2 = numbers_in<double, 9>(rows.getColumn(4), "landmark.cov");
    for (const std::size_t i : {0U, 4U, 8U}) {
      if (l.covariance_m2[i] <= 0) throw Error("landmark.cov is not a covariance");
    }
    l.size = {side(rows.getColumn(5), "landmark.narrowest"), side(rows.getColumn(6), "landmark.widest"),
              side(rows.getColumn(7), "landmark.height")};
    l.height_over_floor_m = finite(rows.getColumn(8), "landmark.over_floor");
    l.log_odds = finite(rows.getColumn(9), "landmark.log_odds");
    const std::string state = rows.getColumn(10).getString();
    if (state != "gone" && state != "present") throw Error("landmark.state is '" + state + "'");
    l.is_gone = state == "gone";
    l.name = rows.getColumn(11).getString();
    l.seen = whole(rows.getColumn(12), "landmark.seen");
    l.expected = whole(rows.getColumn(13), "landmark.expected");
    l.seen_through = whole(rows.getColumn(14), "landmark.seen_through");
    l.open_share = finite(rows.getColumn(15), "landmark.open_share");
    l.first = {rows.getColumn(16).getInt64()};
    l.last = {rows.getColumn(17).getInt64()};
    l.run = rows.getColumn(18).getInt64();
    list.push_back(std::move(l));
  }
  return list;
}

/// Adds their looks to landmarks in the order of their ids.
void load_looks(const SQLite::Database& database, std::vector<Landmark>& list) {
  SQLite::Statement looks(database,
                          "SELECT landmark, octant, hist, crop, pixels FROM look ORDER BY landmark, octant");
  auto at = list.begin();
  while (looks.executeStep()) {
    const LandmarkId id{looks.getColumn(0).getInt64()};
    while (at != list.end() && at->id < id) ++at;
    if (at == list.end() || at->id != id)
      throw Error("look of landmark " + std::to_string(number(id)) + ", which does not exist");
    LandmarkLook look;
    look.octant = whole(looks.getColumn(1), "look.octant");
    if (look.octant > 7) throw Error("look.octant is " + std::to_string(look.octant) + ", expected 0 … 7");
    look.colours = numbers_in<float, std::tuple_size_v<ColourHistogram>>(looks.getColumn(2), "look.hist");
    const SQLite::Column crop = looks.getColumn(3);
    if (!crop.isNull()) {
      look.crop_png.assign(static_cast<const char*>(crop.getBlob()),
                           static_cast<std::size_t>(crop.getBytes()));
    }
    look.pixels = look.crop_pixels = whole(looks.getColumn(4), "look.pixels");
    at->looks.push_back(std::move(look));
  }
}

}  // namespace

LandmarkMap MapFile::load() const {
  return store_->guarded([&] {
    const SQLite::Database& database = *store_->database;
    LandmarkMap map;
    map.list = load_landmarks(database);
    load_looks(database, map.list);
    SQLite::Statement cells(database, "SELECT x, y, frames FROM floor ORDER BY x, y");
    while (cells.executeStep()) {
      map.floor.push_back({whole(cells.getColumn(0), "floor.x", -kMaxWhole),
                           whole(cells.getColumn(1), "floor.y", -kMaxWhole),
                           whole(cells.getColumn(2), "floor.frames")});
    }
    const std::string next = store_->get("next_landmark").value_or("1");
    map.next = std::max<std::int64_t>(std::strtoll(next.c_str(), nullptr, 10), 1);
    (void)landmark_id(map.next);
    if (!map.list.empty()) map.next = std::max(map.next, number(map.list.back().id) + 1);
    return map;
  });
}

std::vector<MapRun> MapFile::runs() const {
  return store_->guarded([&] {
    std::vector<MapRun> all;
    SQLite::Statement rows(
        *store_->database,
        "SELECT id, source, began_ns, ended_ns, frames, map_from_odom, state FROM run ORDER BY id");
    while (rows.executeStep()) {
      MapRun run;
      run.id = rows.getColumn(0).getInt64();
      run.source = rows.getColumn(1).getString();
      run.began = {rows.getColumn(2).getInt64()};
      run.ended = {rows.getColumn(3).getInt64()};
      run.frames = whole(rows.getColumn(4), "run.frames");
      if (!rows.getColumn(5).isNull())
        run.map_from_odom = pose_from(numbers_in<double, 7>(rows.getColumn(5), "run.map_from_odom"));
      run.state = choice_in(rows.getColumn(6), kRunStates, "run.state");
      all.push_back(std::move(run));
    }
    return all;
  });
}

std::vector<MapPose> MapFile::poses() const {
  return store_->guarded([&] {
    std::vector<MapPose> all;
    SQLite::Statement rows(
        *store_->database,
        "SELECT run, stamp_ns, tx, ty, tz, qx, qy, qz, qw, cov FROM pose ORDER BY run, stamp_ns");
    while (rows.executeStep()) {
      MapPose pose;
      pose.run = rows.getColumn(0).getInt64();
      pose.stamp = {rows.getColumn(1).getInt64()};
      std::array<double, 7> numbers{};
      for (std::size_t i = 0; i < numbers.size(); ++i)
        numbers[i] = finite(rows.getColumn(static_cast<int>(i) + 2), "pose");
      pose.map_from_camera = pose_from(numbers);
      pose.covariance = unpacked(numbers_in<float, 21>(rows.getColumn(9), "pose.cov"));
      all.push_back(pose);
    }
    return all;
  });
}

std::vector<MapObservation> MapFile::observations() const {
  return store_->guarded([&] {
    std::vector<MapObservation> all;
    SQLite::Statement rows(*store_->database,
                           "SELECT run, stamp_ns, landmark, track, x, y, z, cov, confidence FROM observation "
                           "ORDER BY run, stamp_ns, landmark");
    while (rows.executeStep()) {
      MapObservation one;
      one.run = rows.getColumn(0).getInt64();
      one.stamp = {rows.getColumn(1).getInt64()};
      one.landmark = LandmarkId{rows.getColumn(2).getInt64()};
      one.track = TrackId{rows.getColumn(3).getInt64()};
      one.position_m = {finite(rows.getColumn(4), "observation.x"),
                        finite(rows.getColumn(5), "observation.y"),
                        finite(rows.getColumn(6), "observation.z")};
      one.covariance_m2 = numbers_in<double, 9>(rows.getColumn(7), "observation.cov");
      one.confidence = finite(rows.getColumn(8), "observation.confidence");
      all.push_back(one);
    }
    return all;
  });
}

std::vector<MapEvent> MapFile::events() const {
  return store_->guarded([&] {
    std::vector<MapEvent> all;
    SQLite::Statement rows(
        *store_->database,
        "SELECT run, stamp_ns, kind, landmark, x, y, z, dx, dy, dz, probability, frames FROM event "
        "ORDER BY id");
    while (rows.executeStep()) {
      MapEvent one;
      one.run = rows.getColumn(0).getInt64();
      LandmarkEvent& event = one.event;
      event.stamp = {rows.getColumn(1).getInt64()};
      event.kind = choice_in(rows.getColumn(2), kLandmarkEventKinds, "event.kind");
      event.landmark = LandmarkId{rows.getColumn(3).getInt64()};
      event.position_m = {finite(rows.getColumn(4), "event.x"), finite(rows.getColumn(5), "event.y"),
                          finite(rows.getColumn(6), "event.z")};
      event.moved_by_m = {finite(rows.getColumn(7), "event.dx"), finite(rows.getColumn(8), "event.dy"),
                          finite(rows.getColumn(9), "event.dz")};
      event.probability = finite(rows.getColumn(10), "event.probability");
      const nlohmann::json frames = nlohmann::json::parse(rows.getColumn(11).getString(), nullptr, false);
      if (!frames.is_array()) throw Error("event.frames is not a list");
      for (const auto& frame : frames) {
        if (!frame.is_number_integer()) throw Error("event.frames is not a list of numbers");
        event.frames.push_back(whole(frame.get<std::int64_t>(), "event.frames"));
      }
      all.push_back(std::move(one));
    }
    return all;
  });
}

std::string MapFile::map_id() const {
  return store_->guarded([&] { return store_->get("map_id").value_or(""); });
}

std::optional<StereoRig> MapFile::rig() const {
  return store_->guarded([&] { return store_->known_rig(); });
}

std::vector<std::string> MapFile::check() const {
  std::vector<std::string> wrong;
  store_->guarded([&] {
    SQLite::Statement sound(*store_->database, "PRAGMA integrity_check");
    while (sound.executeStep()) {
      const std::string line = sound.getColumn(0).getString();
      if (line != "ok") wrong.push_back(line);
    }
    SQLite::Statement keys(*store_->database, "PRAGMA foreign_key_check");
    while (keys.executeStep()) {
      wrong.push_back("a row of " + keys.getColumn(0).getString() + " belongs to a row of " +
                      keys.getColumn(2).getString() + " that does not exist");
    }
  });
  const auto attempt = [&](auto&& read) {
    try {
      (void)read();
    } catch (const Error& error) {
      wrong.emplace_back(error.what());
    }
  };
  attempt([&] { return load(); });
  attempt([&] { return runs(); });
  attempt([&] { return poses(); });
  attempt([&] { return observations(); });
  attempt([&] { return events(); });
  return wrong;
}

std::int64_t MapFile::begin_run(const std::string& source, Stamp began) {
  return store_->guarded([&] {
    Store& s = *store_;
    const LandmarkMap map = load();
    s.knows_kept_map = false;
    s.stored.clear();
    for (const Landmark& landmark : map.list) s.stored[landmark.id] = stored_of(landmark);
    s.stored_floor = map.floor;
    SQLite::Statement put(*s.database,
                          "INSERT INTO run(source, began_ns, ended_ns, frames, map_from_odom, state) "
                          "VALUES(?, ?, ?, 0, NULL, 'running')");
    put.bind(1, source);
    put.bind(2, began.ns);
    put.bind(3, began.ns);
    put.exec();
    s.run = s.database->getLastInsertRowid();
    s.frames = 0;
    s.since_commit = 0;
    s.committed = began;
    s.latest = began;
    s.thinning.clear();
    return s.run;
  });
}

void MapFile::write(const LandmarkFrame& frame, const LandmarkUpdate& step) {
  store_->guarded([&] {
    Store& s = *store_;
    try {
      s.begin();
      ++s.frames;
      s.latest = frame.stamp;
      const LandmarkMap& map = step.state.map;
      const MapLocation& located = step.state.located;
      if (step.state.is_located) s.map_from_odom = located.map_from_odom;
      // New landmarks first: observations and looks refer to them.
      for (auto l = map.list.rbegin(); l != map.list.rend() && !s.stored.contains(l->id); ++l) {
        s.store_landmark(*l);
        s.stored[l->id] = stored_of(*l);
      }
      if (frame.is_keyframe && !frame.is_lost && step.state.is_located) s.store_pose(frame, located);
      for (const LandmarkEvent& event : step.events) s.store_event(event);
      if (!is_guessed(frame)) {  // else its positions are guesses, too
        for (const LandmarkOfTrack& seen : step.tracks) s.store_observation(seen, frame, located);
      }
      if (++s.since_commit >= kFramesPerTransaction ||
          seconds_between(s.committed, s.latest) >= kSecondsPerTransaction)
        s.commit(map);
    } catch (...) {
      s.rollback();
      throw;
    }
  });
}

void MapFile::end_run(RunState state, const LandmarkMap& map) {
  store_->guarded([&] {
    Store& s = *store_;
    try {
      s.begin();
      SQLite::Statement put(*s.database, "UPDATE run SET state=? WHERE id=?");
      put.bind(1, choice_name(state, kRunStates));
      put.bind(2, s.run);
      put.exec();
      s.commit(map);
    } catch (...) {
      s.rollback();
      throw;
    }
  });
}

void MapFile::replace(const LandmarkMap& map) {
  keep({}, map);
}

void MapFile::keep(const std::map<std::string, std::optional<std::string>>& changes, const LandmarkMap& map) {
  store_->guarded([&] {
    Store& s = *store_;
    if (!s.knows_kept_map) {
      const LandmarkMap before = load();
      s.stored.clear();
      for (const Landmark& landmark : before.list) s.stored[landmark.id] = {-1e9, -1, -1, false, {}, {}, {}};
      s.stored_floor.clear();
    }
    try {
      s.begin();
      if (!s.knows_kept_map) s.database->exec("DELETE FROM floor");
      s.knows_kept_map = false;
      s.store(map);
      s.database->exec("DELETE FROM event WHERE landmark > 0 AND landmark NOT IN (SELECT id FROM landmark)");
      s.store_kept(changes);
      s.database->exec("COMMIT");
      s.is_open = false;
      s.knows_kept_map = true;
    } catch (...) {
      s.rollback();
      throw;
    }
  });
}

std::map<std::string, std::string> MapFile::kept() const {
  return store_->guarded([&] {
    std::map<std::string, std::string> all;
    if (!store_->database->tableExists("kept")) return all;
    SQLite::Statement rows(*store_->database, "SELECT key, value FROM kept");
    while (rows.executeStep()) {
      const SQLite::Column value = rows.getColumn(1);
      all[rows.getColumn(0).getString()] =
          std::string(static_cast<const char*>(value.getBlob()), static_cast<std::size_t>(value.getBytes()));
    }
    return all;
  });
}

void MapFile::copy_to(const fs::path& path) const {
  store_->guarded([&] {
    if (fs::exists(path)) throw Error("cannot be copied to " + path.string() + ", which already exists");
    SQLite::Statement copy(*store_->database, "VACUUM INTO ?");
    copy.bind(1, path.string());
    copy.exec();
  });
}

LandmarkMap forget(LandmarkMap map, LandmarkId id) {
  if (std::erase_if(map.list, [&](const Landmark& landmark) { return landmark.id == id; }) == 0)
    throw Error("no landmark " + std::to_string(number(id)));
  return map;
}

}  // namespace cairn
