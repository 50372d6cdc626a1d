# cairn_wants(OPTION PACKAGES RESULT): sets RESULT to whether the part controlled by OPTION (AUTO, ON or OFF) is
# built. AUTO: if all PACKAGES are found; ON requires them. A macro, so that the caller sees the variables of
# find_package.
macro(cairn_wants option packages result)
  set(${result} OFF)
  if(${option})  # ON or AUTO
    set(${result} ON)
    foreach(cairn_package ${packages})
      if(${option} STREQUAL "AUTO")
        find_package(${cairn_package} QUIET)
        if(NOT ${cairn_package}_FOUND)
          set(${result} OFF)
        endif()
      else()
        find_package(${cairn_package} REQUIRED)
      endif()
    endforeach()
  endif()
endmacro()
