# SPDX-License-Identifier: BSD-3-Clause
# Turns text files into one C file of strings. As a module: cellist_embed(OUTPUT_C FILE...) gives the rule;
# as a script (cmake -P) it does the work. FILE "a/faces.frag" becomes  const char cellist_text_faces_frag[].
if(CMAKE_SCRIPT_MODE_FILE)
  set(text "/* Made by CellistEmbed.cmake. */\n")
  string(REPLACE "|" ";" files "${INPUTS}")
  foreach(file IN LISTS files)
    get_filename_component(name ${file} NAME)
    string(MAKE_C_IDENTIFIER ${name} name)
    file(READ ${file} bytes HEX)
    string(REGEX REPLACE "(..)" "0x\\1," bytes "${bytes}")
    string(APPEND text "extern const char cellist_text_${name}[];\nconst char cellist_text_${name}[] = {${bytes}0};\n")
  endforeach()
  file(WRITE ${OUTPUT} "${text}")
  return()
endif()

set(CELLIST_EMBED_SCRIPT ${CMAKE_CURRENT_LIST_FILE})
function(cellist_embed output)
  list(TRANSFORM ARGN PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/ OUTPUT_VARIABLE files)
  list(JOIN files "|" inputs)
  add_custom_command(OUTPUT ${output} DEPENDS ${files} ${CELLIST_EMBED_SCRIPT} VERBATIM
    COMMAND ${CMAKE_COMMAND} -DINPUTS=${inputs} -DOUTPUT=${output} -P ${CELLIST_EMBED_SCRIPT})
endfunction()
