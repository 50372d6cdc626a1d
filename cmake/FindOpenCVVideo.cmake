# OpenCV's optical flow: target OpenCVVideo::video. See FindOpenCVImgproc.cmake.
find_path(OpenCVVideo_INCLUDE_DIR opencv2/video/tracking.hpp PATH_SUFFIXES opencv4)
find_library(OpenCVVideo_LIBRARY opencv_video)
mark_as_advanced(OpenCVVideo_INCLUDE_DIR OpenCVVideo_LIBRARY)

if(OpenCVVideo_INCLUDE_DIR AND OpenCVVideo_LIBRARY)
  find_package(OpenCVImgproc QUIET)
  set(OpenCVVideo_FOUND ${OpenCVImgproc_FOUND})
  if(OpenCVVideo_FOUND AND NOT TARGET OpenCVVideo::video)
    add_library(OpenCVVideo::video UNKNOWN IMPORTED)
    set_target_properties(OpenCVVideo::video PROPERTIES
      IMPORTED_LOCATION ${OpenCVVideo_LIBRARY}
      INTERFACE_INCLUDE_DIRECTORIES ${OpenCVVideo_INCLUDE_DIR}
      INTERFACE_LINK_LIBRARIES OpenCVImgproc::imgproc)
  endif()
else()
  find_package(OpenCV QUIET COMPONENTS core imgproc video)
  set(OpenCVVideo_FOUND ${OpenCV_FOUND})
  if(OpenCVVideo_FOUND AND NOT TARGET OpenCVVideo::video)
    add_library(OpenCVVideo::video INTERFACE IMPORTED)
    target_link_libraries(OpenCVVideo::video INTERFACE opencv_video)
  endif()
endif()
