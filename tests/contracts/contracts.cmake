# What the project promises to those who build on it. Included by tests/CMakeLists.txt.

# Each public header compiles alone, and twice over: one generated source per header.
file(GLOB_RECURSE headers CONFIGURE_DEPENDS RELATIVE ${PROJECT_SOURCE_DIR}
  ${PROJECT_SOURCE_DIR}/cairn/*.hpp ${PROJECT_SOURCE_DIR}/io/*.hpp ${PROJECT_SOURCE_DIR}/page/*.hpp
  ${PROJECT_SOURCE_DIR}/tracking/*.hpp ${PROJECT_SOURCE_DIR}/landmarks/*.hpp ${PROJECT_SOURCE_DIR}/source/*.hpp
  ${PROJECT_SOURCE_DIR}/ros/*.hpp ${PROJECT_SOURCE_DIR}/live/*.hpp)
# What a kernel's source includes once per instruction set is no header in this sense.
list(FILTER headers EXCLUDE REGEX "-inl\\.hpp$")
if(NOT CAIRN_IO)
  list(FILTER headers EXCLUDE REGEX "^(io|page)/|^cairn/opencv\\.hpp$")
endif()
if(NOT CAIRN_HAS_TRACKING)
  list(FILTER headers EXCLUDE REGEX "^(tracking|landmarks|source|ros|live)/")
endif()
set(alone_sources)
foreach(header IN LISTS headers)
  string(REPLACE "/" "_" alone ${header})
  set(alone ${CMAKE_CURRENT_BINARY_DIR}/alone/${alone}.cpp)
  file(CONFIGURE OUTPUT ${alone} CONTENT "#include <${header}>\n#include <${header}>\n" @ONLY)
  list(APPEND alone_sources ${alone})
endforeach()
add_library(cairn_headers_alone OBJECT ${alone_sources})
target_link_libraries(cairn_headers_alone PRIVATE cairn_options cairn::cairn)
if(CAIRN_IO)
  find_package(OpenCVImgproc REQUIRED)
  target_link_libraries(cairn_headers_alone PRIVATE cairn::io OpenCVImgproc::imgproc)
endif()
if(CAIRN_HAS_TRACKING)
  find_package(Eigen3 REQUIRED NO_MODULE)  # in headers that are not installed
  find_package(nlohmann_json REQUIRED)
  target_link_libraries(cairn_headers_alone PRIVATE cairn::sequences Eigen3::Eigen nlohmann_json::nlohmann_json)
endif()

function(cairn_contract name)
  add_test(NAME contracts/${name} COMMAND ${ARGN})
  set_tests_properties(contracts/${name} PROPERTIES LABELS contracts)
endfunction()

set(here ${CMAKE_CURRENT_SOURCE_DIR}/contracts)
cairn_contract(mistakes_do_not_compile ${here}/must_not_compile.sh ${CMAKE_CXX_COMPILER} ${PROJECT_SOURCE_DIR})
cairn_contract(headers_define_no_foreign_macro ${here}/no_foreign_macros.sh ${CMAKE_CXX_COMPILER} ${PROJECT_SOURCE_DIR})
cairn_contract(io_headers_hold_where_they_are_installed ${here}/io_headers_move.sh ${PROJECT_SOURCE_DIR})
cairn_contract(no_include_runs_upwards ${here}/no_upward_includes.sh ${PROJECT_SOURCE_DIR})
cairn_contract(links_of_the_pages_exist ${here}/links_exist.sh ${PROJECT_SOURCE_DIR})
cairn_contract(no_temporaries_in_shared_folders ${here}/no_shared_temporaries.sh ${PROJECT_SOURCE_DIR})
# No generator expression: the comma of "address,undefined" would part its arguments.
set(consumer_flags)
if(CAIRN_SANITIZE)
  set(consumer_flags -fsanitize=${CAIRN_SANITIZE})
endif()
foreach(how cmake pkg-config headers fetch)
  if(NOT CAIRN_INSTALL_RULES AND NOT how STREQUAL "fetch")
    continue()
  endif()
  cairn_contract(used_by_others_${how} ${here}/install_and_use.sh
    ${how} ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR} ${CMAKE_CXX_COMPILER})
  set_tests_properties(contracts/used_by_others_${how} PROPERTIES
    LABELS "contracts;slow"
    SKIP_RETURN_CODE 77
    ENVIRONMENT "CAIRN_CONSUMER_FLAGS=${consumer_flags}")
endforeach()

if(CAIRN_IO)
  cairn_test(contracts/exec_law_test.cpp LIBRARIES cairn::io)
  cairn_test(contracts/segmenter_test.cpp LIBRARIES cairn::io)
  cairn_contract(commands_answer_help ${here}/commands_answer_help.sh $<TARGET_FILE:cairn_cli>)
  cairn_contract(manual_pages_and_completion ${here}/manual.sh $<TARGET_FILE:cairn_cli> ${PROJECT_BINARY_DIR}/manual)
  cairn_contract(docs_are_as_generated ${PROJECT_SOURCE_DIR}/docs/update.sh --check ${PROJECT_BINARY_DIR})
  # Debian's Python, which has Debian's modules.
  find_program(CAIRN_SYSTEM_PYTHON python3 PATHS /usr/bin NO_DEFAULT_PATH)
  if(CAIRN_SYSTEM_PYTHON)
    cairn_contract(shown_code_runs ${CAIRN_SYSTEM_PYTHON} ${here}/shown_code_runs.py
      ${PROJECT_SOURCE_DIR} ${PROJECT_BINARY_DIR} ${CMAKE_CXX_COMPILER})
    cairn_contract(site_builds_and_its_links_lead_somewhere ${PROJECT_SOURCE_DIR}/docs/site/build.sh ${PROJECT_BINARY_DIR})
    set_tests_properties(contracts/site_builds_and_its_links_lead_somewhere PROPERTIES
      LABELS "contracts;slow" SKIP_RETURN_CODE 77)
  endif()
  cairn_contract(instruction_counts ${PROJECT_SOURCE_DIR}/benchmarks/instruction_counts.sh --check ${PROJECT_BINARY_DIR})
  set_tests_properties(contracts/instruction_counts PROPERTIES SKIP_RETURN_CODE 77)
endif()
# What is shipped is a release build.
if(CAIRN_INSTALL_RULES AND NOT CMAKE_CROSSCOMPILING)
  cairn_contract(release_builds_are_hardened ${here}/release_is_hardened.sh ${PROJECT_SOURCE_DIR} ${CMAKE_CXX_COMPILER})
endif()
if(CAIRN_HARDENING AND CAIRN_IO)
  set(binaries)
  foreach(target cairn_cli cairn_video cairn_gstreamer cairn_dds cairn_python)
    if(TARGET ${target})
      list(APPEND binaries $<TARGET_FILE:${target}>)
    endif()
  endforeach()
  cairn_contract(binaries_are_hardened ${here}/hardened.sh ${binaries})
  set_tests_properties(contracts/binaries_are_hardened PROPERTIES SKIP_RETURN_CODE 77)
endif()
if(TARGET 01_objects_from_a_pair)
  cairn_contract(example_01_runs 01_objects_from_a_pair ${PROJECT_SOURCE_DIR}/samples/four_in_a_row)
  cairn_contract(example_02_runs 02_stage_by_stage ${PROJECT_SOURCE_DIR}/samples/glossy_floor)
  cairn_contract(example_03_runs 03_your_own_check ${PROJECT_SOURCE_DIR}/samples/dim_light)
endif()
if(TARGET 05_follow_a_sequence)
  cairn_contract(example_05_runs 05_follow_a_sequence ${PROJECT_SOURCE_DIR}/sequences/rolling_ball)
  set_tests_properties(contracts/example_05_runs PROPERTIES PASS_REGULAR_EXPRESSION "005: camera at.*track [0-9]+ at [^\n]*, moving")
endif()
