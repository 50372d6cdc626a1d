# SPDX-License-Identifier: Apache-2.0
# SPDX-FileCopyrightText: 2026 the cairn authors
#
# cmake -DFOLDER=… -DOUT=… -P embed.cmake: the files of the page as string constants of a C++ source.
set(source "// Made from page/ by page/embed.cmake.\n#include <page/html_template.hpp>\n\nnamespace cairn::io {\n\n")
foreach(part IN ITEMS Layout:page.html Style:page.css Script:page.js)
  string(REGEX MATCH "(.*):(.*)" unused ${part})
  file(READ ${FOLDER}/${CMAKE_MATCH_2} content)
  string(APPEND source "const std::string_view kPage${CMAKE_MATCH_1} = R\"cairn(${content})cairn\";\n\n")
endforeach()
string(APPEND source "}  // namespace cairn::io\n")
file(WRITE ${OUT} "${source}")
