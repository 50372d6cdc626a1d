# cairn_wants(OPTION PACKAGES RESULT): whether what OPTION (AUTO, ON or OFF) stands for is built. AUTO: where all PACKAGES are
# found; ON demands them. A macro: what find_package defines must stay with who asks.
macro(cairn_wants option packages result)
  set(${result} OFF)
  if(${option})  # AUTO, too
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
