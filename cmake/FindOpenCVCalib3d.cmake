# OpenCV's matchers and camera models: target OpenCVCalib3d::calib3d. FindOpenCVImgproc.cmake says why OpenCV's own
# package file is not used.
find_path(OpenCVCalib3d_INCLUDE_DIR opencv2/calib3d.hpp PATH_SUFFIXES opencv4)
find_library(OpenCVCalib3d_LIBRARY opencv_calib3d)
mark_as_advanced(OpenCVCalib3d_INCLUDE_DIR OpenCVCalib3d_LIBRARY)

if(OpenCVCalib3d_INCLUDE_DIR AND OpenCVCalib3d_LIBRARY)
  find_package(OpenCVImgproc QUIET)
  set(OpenCVCalib3d_FOUND ${OpenCVImgproc_FOUND})
  if(OpenCVCalib3d_FOUND AND NOT TARGET OpenCVCalib3d::calib3d)
    add_library(OpenCVCalib3d::calib3d UNKNOWN IMPORTED)
    set_target_properties(OpenCVCalib3d::calib3d PROPERTIES
      IMPORTED_LOCATION ${OpenCVCalib3d_LIBRARY}
      INTERFACE_INCLUDE_DIRECTORIES ${OpenCVCalib3d_INCLUDE_DIR}
      INTERFACE_LINK_LIBRARIES OpenCVImgproc::imgproc)
  endif()
else()
  find_package(OpenCV QUIET COMPONENTS core imgproc calib3d)
  set(OpenCVCalib3d_FOUND ${OpenCV_FOUND})
  if(OpenCVCalib3d_FOUND AND NOT TARGET OpenCVCalib3d::calib3d)
    add_library(OpenCVCalib3d::calib3d INTERFACE IMPORTED)
    target_link_libraries(OpenCVCalib3d::calib3d INTERFACE opencv_calib3d)
  endif()
endif()
