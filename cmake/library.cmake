# cairn_library(TARGET): settings common to our libraries, static or shared (BUILD_SHARED_LIBS).
include(CheckLinkerFlag)
set(CAIRN_EXPORTS ${CMAKE_CURRENT_LIST_DIR}/exports.map)
check_linker_flag(CXX "LINKER:--version-script=${CAIRN_EXPORTS}" CAIRN_HAS_VERSION_SCRIPT)

# An installed tree can be moved: command and libraries find each other by relative paths. On Debian they are in /usr.
if(PROJECT_IS_TOP_LEVEL AND BUILD_SHARED_LIBS AND NOT CAIRN_DEBIAN)
  file(RELATIVE_PATH bin_to_lib /${CMAKE_INSTALL_BINDIR} /${CMAKE_INSTALL_LIBDIR})
  set(CMAKE_INSTALL_RPATH $ORIGIN $ORIGIN/${bin_to_lib})
endif()

function(cairn_library target)
  set_target_properties(${target} PROPERTIES
    POSITION_INDEPENDENT_CODE ON
    # Before 1.0, each minor version may change the binary interface.
    VERSION ${PROJECT_VERSION}
    SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}
    # No macro marks a shared build: both kinds use the same objects.
    DEFINE_SYMBOL "")
  get_target_property(type ${target} TYPE)
  if(type STREQUAL "SHARED_LIBRARY" AND CAIRN_HAS_VERSION_SCRIPT AND NOT CAIRN_SANITIZE)
    target_link_options(${target} PRIVATE LINKER:--version-script=${CAIRN_EXPORTS} LINKER:--no-undefined)
    set_target_properties(${target} PROPERTIES LINK_DEPENDS ${CAIRN_EXPORTS})
  endif()
endfunction()

# cairn_module(TARGET NAME LIBRARIES SOURCES...): a module loaded on first use by cairn/io/load_module.cpp.
function(cairn_module target name libraries)
  # Refuses modules of other builds.
  set(version ${CMAKE_CURRENT_BINARY_DIR}/module_version.cpp)
  file(CONFIGURE OUTPUT ${version} CONTENT
    "extern \"C\" __attribute__((visibility(\"default\"))) const char* cairn_module_version() { return \"@PROJECT_VERSION@\"; }\n")
  add_library(${target} MODULE ${ARGN} ${version})
  target_link_libraries(${target} PRIVATE cairn_options ${libraries})
  target_compile_definitions(${target} PRIVATE CAIRN_VERSION="${PROJECT_VERSION}")
  target_link_options(${target} PRIVATE LINKER:--exclude-libs,ALL)
  set_target_properties(${target} PROPERTIES
    PREFIX "" OUTPUT_NAME ${name} LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR})
  if(CMAKE_INSTALL_RPATH)  # the module's folder is below that of the libraries
    set_target_properties(${target} PROPERTIES INSTALL_RPATH $ORIGIN/..)
  endif()
endfunction()
