# SPDX-License-Identifier: BSD-3-Clause
# cellist_add_library(NAME SOURCES ... HEADERS ... [DEPENDS ...] [PRIVATE ...] [REQUIRES ...] [FIND ...])
#   makes target cellist_NAME, alias cellist::NAME, installed and exported, with a pkg-config file.
#   HEADERS   public headers, relative to ./include, each of which must compile on its own
#   DEPENDS   modules of ours that its headers or its users need
#   PRIVATE   libraries that only its sources need
#   REQUIRES  pkg-config names of the PRIVATE libraries, for static linking
#   LIBS      linker flags of PRIVATE libraries without a pkg-config file
include(GNUInstallDirs)

set(CELLIST_C_WARNINGS -Wall -Wextra -Wpedantic -Wshadow -Wstrict-prototypes -Wmissing-prototypes -Wvla -Wundef)
set(CELLIST_CXX_WARNINGS -Wall -Wextra -Wshadow)

function(cellist_compile_options target)
  set_target_properties(${target} PROPERTIES C_STANDARD 17 C_STANDARD_REQUIRED ON C_EXTENSIONS OFF
    CXX_STANDARD 17 CXX_STANDARD_REQUIRED ON CXX_EXTENSIONS OFF C_VISIBILITY_PRESET hidden
    CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON POSITION_INDEPENDENT_CODE ON)
  target_compile_definitions(${target} PRIVATE _POSIX_C_SOURCE=200809L)
  # No contraction: the exact predicates' error bounds hold for IEEE operations only.
  target_compile_options(${target} PRIVATE -ffp-contract=off
    "$<$<COMPILE_LANGUAGE:C>:${CELLIST_C_WARNINGS}>" "$<$<COMPILE_LANGUAGE:CXX>:${CELLIST_CXX_WARNINGS}>")
  if(CELLIST_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  if(CELLIST_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=${CELLIST_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
    target_link_options(${target} PUBLIC -fsanitize=${CELLIST_SANITIZE})
  endif()
  if(CELLIST_FUZZ)
    target_compile_options(${target} PRIVATE -fsanitize=fuzzer-no-link)
  endif()
endfunction()

function(cellist_add_library name)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES;HEADERS;DEPENDS;PRIVATE;REQUIRES;LIBS")
  set(target cellist_${name})
  add_library(${target} ${arg_SOURCES})
  add_library(cellist::${name} ALIAS ${target})
  list(TRANSFORM arg_HEADERS PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/include/)
  target_sources(${target} PUBLIC FILE_SET HEADERS BASE_DIRS ${CMAKE_CURRENT_SOURCE_DIR}/include FILES ${arg_HEADERS})
  list(TRANSFORM arg_DEPENDS PREPEND cellist:: OUTPUT_VARIABLE modules)
  target_link_libraries(${target} PUBLIC ${modules} PRIVATE ${arg_PRIVATE})
  # Code that modules share but do not install (data/base/wide.h, say) is included as <base/wide.h>.
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR}/data)
  cellist_compile_options(${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${name} VERIFY_INTERFACE_HEADER_SETS ON)
  install(TARGETS ${target} EXPORT cellist-targets FILE_SET HEADERS)

  list(TRANSFORM arg_DEPENDS PREPEND cellist- OUTPUT_VARIABLE pc_requires)
  list(JOIN pc_requires " " PC_REQUIRES)
  list(JOIN arg_REQUIRES " " PC_REQUIRES_PRIVATE)
  list(JOIN arg_LIBS " " PC_LIBS_PRIVATE)
  set(PC_NAME ${name})
  # Relative, so that an installation may be moved, or made elsewhere than it was configured for.
  file(RELATIVE_PATH PC_PREFIX /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
  configure_file(${PROJECT_SOURCE_DIR}/tools/cmake/cellist.pc.in ${PROJECT_BINARY_DIR}/cellist-${name}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/cellist-${name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
  set_property(GLOBAL APPEND PROPERTY CELLIST_INSTALLED_MODULES ${name})
endfunction()

# cellist_static_dependencies("find_dependency(ZLIB)" ...): what find_package(cellist) must find first, since a static
# library hands on what its sources link to.
function(cellist_static_dependencies)
  set_property(GLOBAL APPEND PROPERTY CELLIST_STATIC_DEPENDENCIES ${ARGN})
endfunction()

# cellist_add_avx2_kernel(TARGET SOURCE DEFINITION): a file of vector kernels, compiled for AVX2 and chosen at run time;
# DEFINITION tells the target's other sources that it is there. Nothing on other processors.
function(cellist_add_avx2_kernel target source definition)
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64|amd64)$")
    target_sources(${target} PRIVATE ${source})
    set_source_files_properties(${source} PROPERTIES COMPILE_OPTIONS "-mavx2;-mfma")
    target_compile_definitions(${target} PRIVATE ${definition})
  endif()
endfunction()
