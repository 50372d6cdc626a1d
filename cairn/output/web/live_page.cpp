// SPDX-License-Identifier: Apache-2.0
// SPDX-FileCopyrightText: 2026 the cairn authors
#include <cairn/output/web/html_template.hpp>
#include <cairn/output/web/live_page.hpp>
#include <cairn/output/web/page_parts.hpp>

namespace cairn::output {

std::string live_page(const std::string& nonce) {
  const nlohmann::ordered_json run{{"command", "live"}, {"cairn", CAIRN_VERSION}, {"look", look()}};
  const PageShell shell =
      page_shell(kLiveLayout, kLiveStyle, std::string(kLiveScene) += kLiveScript, "cairn live", nonce);
  return shell.before + script_block("run", for_script(run)) + shell.after;
}

}  // namespace cairn::output
