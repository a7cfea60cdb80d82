# SPDX-License-Identifier: BSD-3-Clause
# cellist::surface. Files are read by assimp where it is installed; without it, surfaces come from arrays and cells, and
# reading a file says that it is unsupported.
option(CELLIST_ASSIMP "Read STL, OBJ and PLY files if assimp is installed" ON)
find_package(PkgConfig REQUIRED)
if(CELLIST_ASSIMP)
  pkg_check_modules(ASSIMP IMPORTED_TARGET GLOBAL assimp)
endif()
set(surface_sources surface cells coincident layer read tree)
set(surface_libraries m)
set(surface_packages "")
if(ASSIMP_FOUND)
  list(APPEND surface_sources import_assimp ply_check)
  list(APPEND surface_libraries PkgConfig::ASSIMP)
  set(surface_packages assimp)
  cellist_static_dependencies("find_dependency(PkgConfig)"
    "pkg_check_modules(ASSIMP REQUIRED IMPORTED_TARGET GLOBAL assimp)")
else()
  message(STATUS "surface: assimp was not found; surface files are not read")
endif()
list(TRANSFORM surface_sources REPLACE "(.+)" "surface/\\1.c")
cellist_add_library(surface
  SOURCES ${surface_sources}
  HEADERS cellist/surface.h
  DEPENDS data optics
  PRIVATE ${surface_libraries}
  REQUIRES ${surface_packages}
  LIBS -lm)
target_include_directories(cellist_surface PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
target_compile_definitions(cellist_surface PRIVATE CELLIST_HAVE_ASSIMP=$<BOOL:${ASSIMP_FOUND}>)
