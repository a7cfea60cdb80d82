# SPDX-License-Identifier: BSD-3-Clause
# cellist::gl, with every OpenGL backend that this machine has the headers of. Leave gl out of CELLIST_MODULES on a
# machine that has none.
include(CellistEmbed)
find_package(PkgConfig REQUIRED)
pkg_check_modules(OSMESA osmesa)
pkg_check_modules(EGL egl)
pkg_check_modules(GLFW glfw3)
if(NOT OSMESA_FOUND AND NOT EGL_FOUND)
  message(FATAL_ERROR "gl: neither OSMesa nor EGL was found; install libosmesa6-dev or libegl-dev, or leave gl out of CELLIST_MODULES")
endif()

set(gl_sources api batch cells context fan footprint gl groups integrators intervals light limits plain_portable program records stages surface tables target)
set(gl_libraries "")
set(gl_packages "")
foreach(backend IN ITEMS OSMESA EGL GLFW)
  if(${backend}_FOUND)
    string(TOLOWER ${backend} name)
    list(APPEND gl_sources context_${name})
    list(APPEND gl_libraries ${${backend}_LINK_LIBRARIES})
    list(APPEND gl_packages ${${backend}_MODULE_NAME})
  endif()
endforeach()
list(TRANSFORM gl_sources REPLACE "(.+)" "gl/\\1.c")
set(gl_shaders surface.vert surface.frag faces.vert everywhere.vert fan.vert handed.glsl hand_on.glsl segment.glsl cell.glsl fan.glsl faces.frag small_groups.frag list_nodes.glsl list.frag
  list_resolve.frag layer.frag layer_resolve.frag exact.glsl exact_lit.glsl emission.glsl maximum.glsl isosurfaces.glsl part.glsl
  light.glsl lit.glsl unlit.glsl psi.glsl table.glsl)
list(TRANSFORM gl_shaders PREPEND gl/shaders/)
cellist_embed(${CMAKE_CURRENT_BINARY_DIR}/gl_shaders.c ${gl_shaders})

cellist_add_library(gl
  SOURCES ${gl_sources} ${CMAKE_CURRENT_BINARY_DIR}/gl_shaders.c
  HEADERS cellist/gl.h
  DEPENDS data optics surface
  PRIVATE ${gl_libraries} m
  REQUIRES ${gl_packages}
  LIBS -lm)
target_include_directories(cellist_gl PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
foreach(backend IN ITEMS OSMESA EGL GLFW)
  target_compile_definitions(cellist_gl PRIVATE CELLIST_HAVE_${backend}=$<BOOL:${${backend}_FOUND}>)
endforeach()
cellist_add_avx2_kernel(cellist_gl gl/plain_avx2.c CELLIST_GL_AVX2)
string(FIND "${CELLIST_SANITIZE}" address gl_leak_check)
target_include_directories(cellist_gl PRIVATE ${CMAKE_CURRENT_SOURCE_DIR})
target_compile_definitions(cellist_gl PRIVATE CELLIST_LEAK_CHECK=$<NOT:$<EQUAL:${gl_leak_check},-1>>)
