# What makes a fault that is still in there harder to use: programs at random addresses (PIE), tables of functions that are
# read-only once a program runs (RELRO, BIND_NOW), canaries on the stack, and checked calls into the C library. For release
# builds, which is what others run; developers' builds stay as they are, sanitizers watch more than this, and a project that
# builds cairn as a part of itself decides for itself.
# Two tests look for it: contracts/release_builds_are_hardened in how a release is built, and `./dev package` in the packages
# (tests/contracts/hardened.sh). What it costs: docs/reliability.md.
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
  # The C library's checks need an optimising compiler. Some distributions' compilers define it by themselves.
  "$<$<NOT:$<CONFIG:Debug>>:-U_FORTIFY_SOURCE;-D_FORTIFY_SOURCE=2>")
target_link_options(cairn_options INTERFACE LINKER:-z,relro,-z,now,-z,noexecstack)
