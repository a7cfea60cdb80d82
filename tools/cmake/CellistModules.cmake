# SPDX-License-Identifier: BSD-3-Clause
# Which modules are built. CELLIST_MODULES names what is wanted; what these need comes along.
#   cmake -DCELLIST_MODULES=sort ...        the sorter and the base, nothing else
#   cmake -DCELLIST_MODULES="raycast;tools" no OpenGL, no convexifier
set(CELLIST_ALL_MODULES base data generators convexify sort optics surface raycast soft gl tools)
set(CELLIST_MODULES "all" CACHE STRING "Modules to build: all, or some of ${CELLIST_ALL_MODULES}")

set(needs_base "")
set(needs_data base)
set(needs_generators data)
set(needs_convexify data)
set(needs_sort base)
set(needs_optics base)
set(needs_surface data optics)
set(needs_raycast data optics surface)
set(needs_soft data optics surface)
set(needs_gl data optics surface)
set(needs_tools data generators sort optics surface raycast soft)

set(CELLIST_ENABLED ${CELLIST_MODULES})
if(CELLIST_MODULES STREQUAL "all")
  set(CELLIST_ENABLED ${CELLIST_ALL_MODULES})
endif()
foreach(pass RANGE 3) # the longest chain is three long
  foreach(module IN LISTS CELLIST_ENABLED)
    if(NOT module IN_LIST CELLIST_ALL_MODULES)
      message(FATAL_ERROR "CELLIST_MODULES: no module '${module}'; there are: all ${CELLIST_ALL_MODULES}")
    endif()
    list(APPEND CELLIST_ENABLED ${needs_${module}})
  endforeach()
  list(REMOVE_DUPLICATES CELLIST_ENABLED)
endforeach()

set(tests_default OFF)
if(PROJECT_IS_TOP_LEVEL AND CELLIST_MODULES STREQUAL "all")
  set(tests_default ON)
endif()
option(CELLIST_TESTS "Build the tests and benchmarks (needs all modules)" ${tests_default})
option(CELLIST_WARNINGS_AS_ERRORS "Treat compiler warnings as errors" OFF)
option(CELLIST_FUZZ "Build the fuzz targets with libFuzzer (clang only)" OFF)
set(CELLIST_SANITIZE "" CACHE STRING "Sanitizers for everything, e.g. address,undefined")
set(CELLIST_SHARED_DIR "${PROJECT_SOURCE_DIR}/../shared" CACHE PATH "Folder with data/ (real meshes) for tests; may be absent")
