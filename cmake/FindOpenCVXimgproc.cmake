# OpenCV's graph segmentation, for benchmarks only: target opencv_ximgproc. See FindOpenCVImgproc.cmake.
find_path(OpenCVXimgproc_INCLUDE_DIR opencv2/ximgproc/segmentation.hpp PATH_SUFFIXES opencv4)
find_library(OpenCVXimgproc_LIBRARY opencv_ximgproc)
mark_as_advanced(OpenCVXimgproc_INCLUDE_DIR OpenCVXimgproc_LIBRARY)

find_package(OpenCVImgproc QUIET)
set(OpenCVXimgproc_FOUND FALSE)
if(OpenCVXimgproc_INCLUDE_DIR AND OpenCVXimgproc_LIBRARY AND OpenCVImgproc_FOUND)
  set(OpenCVXimgproc_FOUND TRUE)
  if(NOT TARGET opencv_ximgproc)
    add_library(opencv_ximgproc UNKNOWN IMPORTED)
    set_target_properties(opencv_ximgproc PROPERTIES
      IMPORTED_LOCATION ${OpenCVXimgproc_LIBRARY}
      INTERFACE_INCLUDE_DIRECTORIES ${OpenCVXimgproc_INCLUDE_DIR}
      INTERFACE_LINK_LIBRARIES OpenCVImgproc::imgproc)
  endif()
endif()
