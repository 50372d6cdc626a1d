# OpenCV's drawing functions: target OpenCVImgproc::imgproc with its dependencies. The name differs from OpenCV's own
# target, which find_package(OpenCV) would otherwise refuse to define.
#
# OpenCV's own package file requires every module, which on Debian are 270 more packages and 760 MB for drawing lines
# and text. So the two libraries of libopencv-imgproc-dev are searched for directly.
find_path(OpenCVImgproc_INCLUDE_DIR opencv2/imgproc.hpp PATH_SUFFIXES opencv4)
find_library(OpenCVImgproc_LIBRARY opencv_imgproc)
find_library(OpenCVImgproc_CORE_LIBRARY opencv_core)
mark_as_advanced(OpenCVImgproc_INCLUDE_DIR OpenCVImgproc_LIBRARY OpenCVImgproc_CORE_LIBRARY)

if(OpenCVImgproc_INCLUDE_DIR AND OpenCVImgproc_LIBRARY AND OpenCVImgproc_CORE_LIBRARY)
  set(OpenCVImgproc_FOUND TRUE)
  if(NOT TARGET OpenCVImgproc::imgproc)
    add_library(OpenCVImgproc::imgproc UNKNOWN IMPORTED)
    set_target_properties(OpenCVImgproc::imgproc PROPERTIES
      IMPORTED_LOCATION ${OpenCVImgproc_LIBRARY}
      INTERFACE_INCLUDE_DIRECTORIES ${OpenCVImgproc_INCLUDE_DIR}
      INTERFACE_LINK_LIBRARIES ${OpenCVImgproc_CORE_LIBRARY})
  endif()
else()
  # OpenCV_DIR names a location outside the usual library folders.
  set(opencv_required)
  if(OpenCVImgproc_FIND_REQUIRED)
    set(opencv_required REQUIRED)
  endif()
  find_package(OpenCV QUIET ${opencv_required} COMPONENTS core imgproc)
  set(OpenCVImgproc_FOUND ${OpenCV_FOUND})
  if(OpenCVImgproc_FOUND AND NOT TARGET OpenCVImgproc::imgproc)
    add_library(OpenCVImgproc::imgproc INTERFACE IMPORTED)
    target_link_libraries(OpenCVImgproc::imgproc INTERFACE opencv_imgproc opencv_core)
  endif()
endif()
