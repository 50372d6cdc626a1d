# cairn_wants(OPTION PACKAGE RESULT): whether what OPTION (AUTO, ON or OFF) stands for is built. AUTO: where PACKAGE is found;
# ON demands it. A macro: what find_package defines must stay with who asks.
macro(cairn_wants option package result)
  set(${result} OFF)
  if(${option} STREQUAL "AUTO")
    find_package(${package} QUIET)
    set(${result} ${${package}_FOUND})
  elseif(${option})
    find_package(${package} REQUIRED)
    set(${result} ON)
  endif()
endmacro()
