cmake_minimum_required(VERSION 3.25)
# Writes OUTPUT, a header that gives the shortened names in the transcoder's wasm their full names: MIRAGE_IMPORT_emval_as and
# so on. JS is the file that holds the table of both. Fails if the files are others than SUMS lists, or if a name is new or
# missing, because the host must then be read anew. Run it with cmake -P.
set(help "the texture transcoder in MIRAGE_BASIS_DIR is not the one of three 0.187.0; run scripts/setup-ktx2")
get_filename_component(folder ${JS} DIRECTORY)
file(STRINGS ${SUMS} lines)
foreach(line ${lines})
  string(REGEX MATCH "^([0-9a-f]+)  (.+)$" matched "${line}")
  set(sum ${CMAKE_MATCH_1})
  set(file ${folder}/${CMAKE_MATCH_2})
  file(SHA256 ${file} found)
  if(NOT found STREQUAL sum)
    message(FATAL_ERROR "${file} has the SHA-256 ${found}, expected ${sum}: ${help}")
  endif()
endforeach()

set(imports
    cxa_throw abort_js embind_finalize_value_object embind_register_bigint embind_register_bool embind_register_class
    embind_register_class_constructor embind_register_class_function embind_register_constant embind_register_emval
    embind_register_enum embind_register_enum_value embind_register_float embind_register_function embind_register_integer
    embind_register_memory_view embind_register_std_string embind_register_std_wstring embind_register_value_object
    embind_register_value_object_field embind_register_void emscripten_memcpy_js emval_as emval_call emval_call_method
    emval_decref emval_get_global emval_get_method_caller emval_get_module_property emval_get_property emval_incref
    emval_new_cstring emval_run_destructors emscripten_resize_heap fd_close fd_seek fd_write)
file(READ ${JS} text)
string(REGEX MATCH "var wasmImports={([^}]*)}" table "${text}")
string(REPLACE "," ";" entries "${CMAKE_MATCH_1}")
set(header "#pragma once\n// Generated: full names of what the transcoder's wasm imports and exports.\n")
set(rest ${imports})
foreach(entry ${entries})
  string(REGEX MATCH "^([A-Za-z]+):_+(.+)$" matched "${entry}")
  set(name "${CMAKE_MATCH_2}")
  if(NOT name IN_LIST rest)
    message(FATAL_ERROR "the transcoder imports '${entry}', which modules/embind_imports.cpp does not know: ${help}")
  endif()
  list(REMOVE_ITEM rest ${name})
  string(APPEND header "#define MIRAGE_IMPORT_${name} Z_aZ_${CMAKE_MATCH_1}\n")
endforeach()
if(rest)
  message(FATAL_ERROR "the transcoder does not import ${rest}: ${help}")
endif()

foreach(export memory=wasmMemory table=wasmTable call_ctors=___wasm_call_ctors)
  string(REPLACE "=" ";" pair ${export})
  list(GET pair 0 name)
  list(GET pair 1 variable)
  string(REGEX MATCH "[^A-Za-z_]${variable}=wasmExports\\[\"([A-Za-z]+)\"\\]|\\(${variable}=wasmExports\\[\"([A-Za-z]+)\"\\]\\)"
         matched "${text}")
  if(NOT matched)
    message(FATAL_ERROR "the transcoder does not export ${variable}: ${help}")
  endif()
  string(REGEX REPLACE ".*\"([A-Za-z]+)\".*" "\\1" letter "${matched}")
  string(APPEND header "#define MIRAGE_EXPORT_${name} Z_basis_transcoderZ_${letter}\n")
endforeach()
file(WRITE ${OUTPUT} "${header}")
