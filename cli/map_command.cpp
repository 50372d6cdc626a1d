// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <CLI/CLI.hpp>

#include "commands.hpp"
#include "map_work.hpp"

namespace cairn::cli {

Work declare_map(CLI::App& app) {
  auto options = std::make_shared<MapOptions>();
  app.add_option("ACTION", options->action,
                 "show: list landmarks, runs and events; check: verify the file; export: convert; diff: "
                 "compare with OTHER; merge: combine with OTHER ...; forget: remove landmarks")
      ->required()
      ->check(CLI::IsMember({"show", "check", "export", "diff", "merge", "forget"}).name(""))
      ->type_name("");
  app.add_option("FILE", options->file, "map of landmarks from `cairn follow --map`")
      ->required()
      ->type_name("");
  app.add_option("OTHER", options->others, "diff: second map; merge: further maps")->type_name("");
  app.add_option("--at", options->places,
                 "merge: pose of a map, named without folder and ending, in the frame of FILE: m and degrees "
                 "counter-clockwise; may be repeated (default: by common landmarks)")
      ->type_name("NAME=X,Y,DEG")
      ->allow_extra_args(false);
  app.add_option("--form", options->form, "export: geojson, g2o, tum or csv (default: geojson)")
      ->check(CLI::IsMember({"geojson", "g2o", "tum", "csv"}).name(""))
      ->type_name("FORM");
  app.add_option("--run", options->run, "export --form tum: run (default: the last one)")->type_name("N");
  app.add_option("--id", options->ids, "forget: ids of the landmarks")->type_name("N");
  app.add_flag("--gone", options->gone, "forget: all landmarks marked as gone");
  app.add_option("-o,--output", options->output, "export (default: stdout), merge: output file")
      ->type_name("FILE");
  return [options] { return work_on_map(*options); };
}

}  // namespace cairn::cli
