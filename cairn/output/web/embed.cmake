# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
#
# cmake -DFOLDER=… -DOUT=… -P embed.cmake: writes the files of the page as string constants into a C++ source.
set(source "// Made by cairn/output/web/embed.cmake.\n#include <cairn/output/web/html_template.hpp>\n\nnamespace cairn::output {\n\n")
foreach(part IN ITEMS
    SharedStyle:shared.css SharedScript:shared.js
    PageLayout:page.html PageStyle:page.css PageScript:page.js
    FollowLayout:follow.html FollowStyle:follow.css FollowScript:follow.js
    LiveLayout:live.html LiveStyle:live.css LiveScene:live_scene.js LiveScript:live.js)
  string(REGEX MATCH "(.*):(.*)" unused ${part})
  file(READ ${FOLDER}/${CMAKE_MATCH_2} content)
  string(APPEND source "const std::string_view k${CMAKE_MATCH_1} = R\"cairn(${content})cairn\";\n\n")
endforeach()
string(APPEND source "}  // namespace cairn::output\n")
file(WRITE ${OUT} "${source}")
