/* SPDX-License-Identifier: BSD-3-Clause
 * The OpenGL entry points that the renderers use, in one table that is filled from whatever context is there. A call
 * is gl->Clear(...): no library is linked for it, so one program can hold contexts of several backends. Private. */
#ifndef CELLIST_GL_API_H
#define CELLIST_GL_API_H

#include <GL/glcorearb.h>
#include <cellist/context.h>

#define GL_API_LIST(X)                                         \
  X(ActiveTexture, PFNGLACTIVETEXTUREPROC)                     \
  X(AttachShader, PFNGLATTACHSHADERPROC)                       \
  X(BeginQuery, PFNGLBEGINQUERYPROC)                           \
  X(BindAttribLocation, PFNGLBINDATTRIBLOCATIONPROC)           \
  X(BindBuffer, PFNGLBINDBUFFERPROC)                           \
  X(BindBufferBase, PFNGLBINDBUFFERBASEPROC)                   \
  X(BindFragDataLocation, PFNGLBINDFRAGDATALOCATIONPROC)       \
  X(BindFramebuffer, PFNGLBINDFRAMEBUFFERPROC)                 \
  X(BindRenderbuffer, PFNGLBINDRENDERBUFFERPROC)               \
  X(BindTexture, PFNGLBINDTEXTUREPROC)                         \
  X(BindVertexArray, PFNGLBINDVERTEXARRAYPROC)                 \
  X(BlendEquationi, PFNGLBLENDEQUATIONIPROC)                   \
  X(BlendFuncSeparatei, PFNGLBLENDFUNCSEPARATEIPROC)           \
  X(BufferData, PFNGLBUFFERDATAPROC)                           \
  X(BufferSubData, PFNGLBUFFERSUBDATAPROC)                     \
  X(CheckFramebufferStatus, PFNGLCHECKFRAMEBUFFERSTATUSPROC)   \
  X(ClearBufferfv, PFNGLCLEARBUFFERFVPROC)                     \
  X(ColorMask, PFNGLCOLORMASKPROC)                             \
  X(CompileShader, PFNGLCOMPILESHADERPROC)                     \
  X(CreateProgram, PFNGLCREATEPROGRAMPROC)                     \
  X(CreateShader, PFNGLCREATESHADERPROC)                       \
  X(DeleteBuffers, PFNGLDELETEBUFFERSPROC)                     \
  X(DeleteFramebuffers, PFNGLDELETEFRAMEBUFFERSPROC)           \
  X(DeleteProgram, PFNGLDELETEPROGRAMPROC)                     \
  X(DeleteQueries, PFNGLDELETEQUERIESPROC)                     \
  X(DeleteRenderbuffers, PFNGLDELETERENDERBUFFERSPROC)         \
  X(DeleteShader, PFNGLDELETESHADERPROC)                       \
  X(DeleteTextures, PFNGLDELETETEXTURESPROC)                   \
  X(DeleteVertexArrays, PFNGLDELETEVERTEXARRAYSPROC)           \
  X(DepthFunc, PFNGLDEPTHFUNCPROC)                             \
  X(Disable, PFNGLDISABLEPROC)                                 \
  X(DrawArrays, PFNGLDRAWARRAYSPROC)                           \
  X(DrawBuffers, PFNGLDRAWBUFFERSPROC)                         \
  X(Enable, PFNGLENABLEPROC)                                   \
  X(EnableVertexAttribArray, PFNGLENABLEVERTEXATTRIBARRAYPROC) \
  X(EndQuery, PFNGLENDQUERYPROC)                               \
  X(FramebufferRenderbuffer, PFNGLFRAMEBUFFERRENDERBUFFERPROC) \
  X(FramebufferTexture2D, PFNGLFRAMEBUFFERTEXTURE2DPROC)       \
  X(GenBuffers, PFNGLGENBUFFERSPROC)                           \
  X(GenFramebuffers, PFNGLGENFRAMEBUFFERSPROC)                 \
  X(GenQueries, PFNGLGENQUERIESPROC)                           \
  X(GenRenderbuffers, PFNGLGENRENDERBUFFERSPROC)               \
  X(GenTextures, PFNGLGENTEXTURESPROC)                         \
  X(GenVertexArrays, PFNGLGENVERTEXARRAYSPROC)                 \
  X(GetBufferSubData, PFNGLGETBUFFERSUBDATAPROC)               \
  X(GetError, PFNGLGETERRORPROC)                               \
  X(GetIntegerv, PFNGLGETINTEGERVPROC)                         \
  X(GetProgramInfoLog, PFNGLGETPROGRAMINFOLOGPROC)             \
  X(GetProgramiv, PFNGLGETPROGRAMIVPROC)                       \
  X(GetQueryObjectui64v, PFNGLGETQUERYOBJECTUI64VPROC)         \
  X(GetShaderInfoLog, PFNGLGETSHADERINFOLOGPROC)               \
  X(GetShaderiv, PFNGLGETSHADERIVPROC)                         \
  X(GetString, PFNGLGETSTRINGPROC)                             \
  X(GetUniformLocation, PFNGLGETUNIFORMLOCATIONPROC)           \
  X(LinkProgram, PFNGLLINKPROGRAMPROC)                         \
  X(MapBufferRange, PFNGLMAPBUFFERRANGEPROC)                   \
  X(MultiDrawArrays, PFNGLMULTIDRAWARRAYSPROC)                 \
  X(PixelStorei, PFNGLPIXELSTOREIPROC)                         \
  X(ReadBuffer, PFNGLREADBUFFERPROC)                           \
  X(ReadPixels, PFNGLREADPIXELSPROC)                           \
  X(RenderbufferStorage, PFNGLRENDERBUFFERSTORAGEPROC)         \
  X(Scissor, PFNGLSCISSORPROC)                                 \
  X(ShaderSource, PFNGLSHADERSOURCEPROC)                       \
  X(TexBuffer, PFNGLTEXBUFFERPROC)                             \
  X(TexImage2D, PFNGLTEXIMAGE2DPROC)                           \
  X(TexImage3D, PFNGLTEXIMAGE3DPROC)                           \
  X(TexParameteri, PFNGLTEXPARAMETERIPROC)                     \
  X(Uniform1f, PFNGLUNIFORM1FPROC)                             \
  X(Uniform1i, PFNGLUNIFORM1IPROC)                             \
  X(Uniform2f, PFNGLUNIFORM2FPROC)                             \
  X(Uniform3f, PFNGLUNIFORM3FPROC)                             \
  X(Uniform4f, PFNGLUNIFORM4FPROC)                             \
  X(UnmapBuffer, PFNGLUNMAPBUFFERPROC)                         \
  X(UseProgram, PFNGLUSEPROGRAMPROC)                           \
  X(VertexAttribPointer, PFNGLVERTEXATTRIBPOINTERPROC)         \
  X(Viewport, PFNGLVIEWPORTPROC)

/* Entry points of OpenGL 4.3: NULL below it. */
#define GL_API_LIST_43(X)                      \
  X(ClearBufferData, PFNGLCLEARBUFFERDATAPROC) \
  X(MemoryBarrier, PFNGLMEMORYBARRIERPROC)

typedef struct gl_api {
#define GL_API_MEMBER(name, type) type name;
  GL_API_LIST(GL_API_MEMBER)
  GL_API_LIST_43(GL_API_MEMBER)
#undef GL_API_MEMBER
} gl_api;

typedef void (*gl_procedure)(void);

/* Fills the table; the context must be current. Fails with GRAPHICS and the first name that is missing. */
cellist_result gl_api_load(cellist_context *context, gl_procedure (*procedure)(void *state, const char *name),
                           void *state, gl_api *api);

#endif
