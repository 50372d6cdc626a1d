# OpenCV's videos: target OpenCVVideoio::videoio. See FindOpenCVImgproc.cmake.
find_path(OpenCVVideoio_INCLUDE_DIR opencv2/videoio.hpp PATH_SUFFIXES opencv4)
find_library(OpenCVVideoio_LIBRARY opencv_videoio)
mark_as_advanced(OpenCVVideoio_INCLUDE_DIR OpenCVVideoio_LIBRARY)

if(OpenCVVideoio_INCLUDE_DIR AND OpenCVVideoio_LIBRARY)
  find_package(OpenCVImgproc QUIET)
  set(OpenCVVideoio_FOUND ${OpenCVImgproc_FOUND})
  if(OpenCVVideoio_FOUND AND NOT TARGET OpenCVVideoio::videoio)
    add_library(OpenCVVideoio::videoio UNKNOWN IMPORTED)
    set_target_properties(OpenCVVideoio::videoio PROPERTIES
      IMPORTED_LOCATION ${OpenCVVideoio_LIBRARY}
      INTERFACE_INCLUDE_DIRECTORIES ${OpenCVVideoio_INCLUDE_DIR}
      INTERFACE_LINK_LIBRARIES OpenCVImgproc::imgproc)
  endif()
else()
  find_package(OpenCV QUIET COMPONENTS core imgproc videoio)
  set(OpenCVVideoio_FOUND ${OpenCV_FOUND})
  if(OpenCVVideoio_FOUND AND NOT TARGET OpenCVVideoio::videoio)
    add_library(OpenCVVideoio::videoio INTERFACE IMPORTED)
    target_link_libraries(OpenCVVideoio::videoio INTERFACE opencv_videoio)
  endif()
endif()
