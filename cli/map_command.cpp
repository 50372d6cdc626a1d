// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include "commands.hpp"
#include "map_work.hpp"

namespace cairn::cli {

Work declare_map(CLI::App& app) {
  auto options = std::make_shared<MapOptions>();
  app.add_option(
         "ACTION", options->action,
         "show: landmarks, runs and events; check: whether the file is sound; export: in another form; "
         "diff: what OTHER has changed; merge: both in one file; forget: without some landmarks")
      ->required()
      ->check(CLI::IsMember({"show", "check", "export", "diff", "merge", "forget"}).name(""))
      ->type_name("");
  app.add_option("FILE", options->file, "map of landmarks, as `cairn follow --map` writes it")
      ->required()
      ->type_name("");
  app.add_option("OTHER", options->other, "second map, of diff and merge")->type_name("");
  app.add_option("--form", options->form, "of export: geojson, g2o, tum or csv (default: geojson)")
      ->check(CLI::IsMember({"geojson", "g2o", "tum", "csv"}).name(""))
      ->type_name("FORM");
  app.add_option("--run", options->run, "of export --form tum: the run (default: the last one)")
      ->type_name("N");
  app.add_option("--id", options->ids, "of forget: landmarks to forget")->type_name("N");
  app.add_flag("--gone", options->gone, "of forget: all landmarks that are gone");
  app.add_option("-o,--output", options->output, "file for export (default: stdout) and merge")
      ->type_name("FILE");
  return [options] { return work_on_map(*options); };
}

}  // namespace cairn::cli
