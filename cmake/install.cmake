# `cmake --install`: the components library, sequences, video, gstreamer, ros2, vulkan, dev and tools; docs/install.md
# describes their use.
include(CMakePackageConfigHelpers)
set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/cairn)
set(include_dir ${CMAKE_INSTALL_INCLUDEDIR}/cairn)

# cairn_install_library(TARGETS EXPORT COMPONENT): shared libraries go into the component, files for building against
# them into `dev`.
function(cairn_install_library targets export component)
  install(TARGETS ${targets} EXPORT ${export}
    LIBRARY COMPONENT ${component} NAMELINK_COMPONENT dev
    ARCHIVE COMPONENT dev
    INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
  install(EXPORT ${export} NAMESPACE cairn:: FILE ${export}.cmake DESTINATION ${package_dir} COMPONENT dev)
endfunction()

# ---- libraries and their headers ----

# All other headers are private: they may change or disappear in any version.
set(private_headers
  core/disjoint_sets core/each_index core/highway_targets stereo/label_kernels_plain core/nearest core/stage_clock
  core/number_text core/pair_copy core/pool_memory core/random core/robust_fit core/scratch core/statistics
  image/gaussian image/local_contrast image/prefilter image/sparse_points image/texture
  stereo/byte_lanes_plain stereo/islands stereo/lanes_plain stereo/memory
  scene/floor_search scene/plane_fit scene/plane_through_pairs
  regions/gradient_threshold regions/growing_regions regions/percent regions/runs regions/superpixel_regions
  regions/split_floor regions/surfaces_behind
  objects/ground_curvature objects/object_match objects/obstacle_rows objects/ranks pipeline/match_and_check pipeline/methods pipeline/option_walk pipeline/scenes_ahead
  sequence/assign sequence/changes sequence/kalman sequence/landmark_geometry sequence/motion_fit sequence/twist
  io/calibration_forms io/frame_names io/load_module io/raster io/read_file io/sha256 io/yaml_text
  device/careful_device device/engine device/module
  input/binned_sequence input/frame_list input/frame_watch input/mcap_sequence input/mcap_topics input/ros_depth input/sequence_over input/stamped_images io/names_and_numbers
  input/open_parts input/sequence_scores_json sequence/stamp_pairing io/text_lines
  live/topics output/drawing output/json output/json_line web/html_template web/live_page web/page_parts ros/mcap_format
  view/access view/channels view/client view/frame_json view/parameters
  [a-z]+/[a-z_]+_kernels)
list(JOIN private_headers "|" private_headers)

set(not_built)
if(NOT CAIRN_IO)
  list(APPEND not_built REGEX "/cairn/(device|io|output)/|/cairn/opencv\\.hpp$" EXCLUDE)
endif()
if(NOT CAIRN_HAS_TRACKING)
  list(APPEND not_built REGEX "/cairn/(sequence|input|ros|live)/|/output/(follow|track|trajectory)_[a-z]+\\.hpp$" EXCLUDE)
endif()
cairn_install_library(cairn cairnTargets library)
install(DIRECTORY cairn/ DESTINATION ${include_dir} COMPONENT dev FILES_MATCHING
  PATTERN "*.hpp"
  PATTERN "*-inl.hpp" EXCLUDE
  REGEX "/(${private_headers})\\.hpp$" EXCLUDE
  REGEX "/cairn/(batch|timing|fitted)$|/(video|camera|dds|vulkan)$" EXCLUDE
  ${not_built})
if(CAIRN_IO)
  cairn_install_library(cairn_io cairnIoTargets library)
  if(CAIRN_HAS_TRACKING)
    cairn_install_library(cairn_sequences cairnSequencesTargets sequences)
  endif()
  install(FILES docs/schema/objects.schema.json docs/schema/batch_row.schema.json packaging/slurm/cairn.sbatch DESTINATION ${CMAKE_INSTALL_DATADIR}/cairn COMPONENT tools)
  # The commands' help refers to these pages.
  install(DIRECTORY docs DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT tools FILES_MATCHING
    REGEX "\\.(md|png)$"
    PATTERN site EXCLUDE
    PATTERN schema EXCLUDE)
endif()

# ---- for find_package(cairn) ----

# Whoever links a static library must also link its dependencies.
set(static_library OFF)
get_target_property(type cairn TYPE)
if(type STREQUAL "STATIC_LIBRARY")
  set(static_library ON)
endif()
set(CAIRN_SEQUENCES_PACKAGES)
foreach(optional IN ITEMS VIDEO:cairn_video:OpenCVVideoio GSTREAMER:cairn_gstreamer:GStreamerApp DDS:cairn_dds:CycloneDDS
    VIEW::OpenSSL ZSTD::Zstd)
  string(REPLACE ":" ";" optional ${optional})
  list(GET optional 0 part)
  list(GET optional 1 module)
  list(GET optional 2 package)
  if(CAIRN_HAS_${part} AND (module STREQUAL "" OR NOT TARGET ${module}))  # linked directly, not a loadable module
    list(APPEND CAIRN_SEQUENCES_PACKAGES ${package})
  endif()
endforeach()
string(REPLACE ";" " " CAIRN_SEQUENCES_PACKAGES "${CAIRN_SEQUENCES_PACKAGES}")
configure_package_config_file(cmake/cairnConfig.cmake.in cairnConfig.cmake INSTALL_DESTINATION ${package_dir})
write_basic_package_version_file(cairnConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/cairnConfig.cmake ${CMAKE_CURRENT_BINARY_DIR}/cairnConfigVersion.cmake
  DESTINATION ${package_dir} COMPONENT dev)
if(CAIRN_IO AND static_library)
  install(FILES cmake/FindOpenCVImgproc.cmake cmake/FindOpenCVCalib3d.cmake cmake/FindOpenCVVideo.cmake
    cmake/FindOpenCVVideoio.cmake cmake/FindGStreamerApp.cmake cmake/FindZstd.cmake
    DESTINATION ${package_dir} COMPONENT dev)
endif()

# ---- for pkg-config ----

# cairn_install_pkgconfig(NAME DESCRIPTION LIBS REQUIRES STATIC_REQUIRES STATIC_LIBS): the last two only for static
# libraries, because pkg-config requires packages of Requires.private to be installed even for shared ones.
function(cairn_install_pkgconfig name description libs requires static_requires static_libs)
  # The prefix is relative to the file, so that an installed tree can be moved.
  file(RELATIVE_PATH to_prefix /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
  string(REGEX REPLACE "/$" "" to_prefix ${to_prefix})
  if(static_library)
    string(APPEND requires " ${static_requires}")
    string(APPEND libs " ${static_libs}")
  endif()
  configure_file(${CMAKE_CURRENT_FUNCTION_LIST_DIR}/library.pc.in ${name}.pc @ONLY)
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/${name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT dev)
endfunction()

set(static_requires)
if(CAIRN_SIMD)
  list(APPEND static_requires libhwy)
endif()
if(CAIRN_TBB)
  list(APPEND static_requires tbb)
endif()
list(JOIN static_requires " " static_requires)
cairn_install_pkgconfig(cairn "${PROJECT_DESCRIPTION}" "-lcairn" "" "${static_requires}" "-pthread")
if(CAIRN_IO)
  # OpenCV's libraries directly: its own .pc file names every module.
  set(io_libs "-ldl")
  if(CAIRN_HAS_CALIBRATION AND NOT CAIRN_HAS_TRACKING)
    string(PREPEND io_libs "-lopencv_calib3d -lopencv_imgproc -lopencv_core ")
  endif()
  cairn_install_pkgconfig(cairn-io "Files of cairn: images, calibrations, options and results" "-lcairn-io"
    "cairn = ${PROJECT_VERSION}" "yaml-cpp libpng libjpeg zlib" "${io_libs}")
  if(CAIRN_HAS_TRACKING)
    set(mcap_requires)
    if(CAIRN_HAS_ZSTD)
      set(mcap_requires " libzstd")
    endif()
    cairn_install_pkgconfig(cairn-sequences "Sequences with cairn: odometry, tracks, landmarks, sources of frames"
      "-lcairn-sequences" "cairn-io = ${PROJECT_VERSION}" "sqlite3${mcap_requires}"
      "-lSQLiteCpp -lopencv_video -lopencv_calib3d -lopencv_imgproc -lopencv_core -ldl")
  endif()
endif()

# ---- the command ----

if(CAIRN_IO)
  install(TARGETS cairn_cli RUNTIME COMPONENT tools)
  if(TARGET cairn_commands)
    install(TARGETS cairn_commands LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/cairn COMPONENT tools)
  endif()
  if(TARGET cairn_video)
    install(TARGETS cairn_video LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/cairn COMPONENT video)
  endif()
  if(TARGET cairn_gstreamer)
    install(TARGETS cairn_gstreamer LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/cairn COMPONENT gstreamer)
  endif()
  if(TARGET cairn_dds)
    install(TARGETS cairn_dds LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/cairn COMPONENT ros2)
    install(FILES packaging/systemd/cairn-live@.service packaging/systemd/cairn-map.service
      DESTINATION lib/systemd/system COMPONENT ros2)
    install(PROGRAMS packaging/dds/fleet_keys.sh DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples COMPONENT ros2)
  endif()
  if(TARGET cairn_vulkan)
    install(TARGETS cairn_vulkan LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/cairn COMPONENT vulkan)
  endif()
  set(manual ${PROJECT_BINARY_DIR}/manual)
  if(CAIRN_HELP2MAN)
    install(DIRECTORY ${manual}/man1 ${manual}/man7 DESTINATION ${CMAKE_INSTALL_MANDIR} COMPONENT tools)
  endif()
  install(DIRECTORY ${manual}/bash-completion DESTINATION ${CMAKE_INSTALL_DATADIR} COMPONENT tools)
  install(DIRECTORY data/samples/ DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples COMPONENT tools)
  # The pages link to the licence there.
  install(DIRECTORY examples/batch DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples COMPONENT tools USE_SOURCE_PERMISSIONS)
  if(CAIRN_HAS_TRACKING)
    install(DIRECTORY data/sequences DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT tools)
  endif()
endif()
if(NOT CAIRN_DEBIAN)  # Debian: each package's copyright file has it
  install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT dev)
endif()
include(cmake/packages.cmake)
