# Options that make remaining bugs harder to exploit: random addresses (PIE), function tables that are read-only at
# run time (RELRO, BIND_NOW), stack canaries, and checked calls into the C library. Only for release builds, which
# users run. Not for developers' builds, not with sanitizers, which check more, and not if cairn is part of another
# project, which makes its own choice.
# Two tests check it: contracts/release_builds_are_hardened checks the build, `./dev package` the packages
# (tests/contracts/hardened.sh). Its cost: docs/reliability.md.
set(hardened OFF)
if(PROJECT_IS_TOP_LEVEL AND CMAKE_BUILD_TYPE MATCHES "^(Release|MinSizeRel)$" AND NOT CAIRN_SANITIZE)
  set(hardened ON)
endif()
option(CAIRN_HARDENING "PIE, RELRO, stack protector, checked calls into the C library" ${hardened})
if(NOT CAIRN_HARDENING)
  return()
endif()
if(CAIRN_SANITIZE)
  message(FATAL_ERROR "CAIRN_HARDENING=ON: found CAIRN_SANITIZE=${CAIRN_SANITIZE}, expected a build without sanitizers")
endif()

include(CheckPIESupported)
check_pie_supported(LANGUAGES CXX)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
target_compile_options(cairn_options INTERFACE
  -fstack-protector-strong
  # The C library's checks need an optimising compiler. Some distributions' compilers define this already.
  "$<$<NOT:$<CONFIG:Debug>>:-U_FORTIFY_SOURCE;-D_FORTIFY_SOURCE=2>")
target_link_options(cairn_options INTERFACE LINKER:-z,relro,-z,now,-z,noexecstack)
