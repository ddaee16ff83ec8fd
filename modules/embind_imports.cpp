// Functions that the transcoder imports. Their names come from embind_names.h, their types from the
// header that wasm2c writes, so that a transcoder with others does not compile. Arguments without a
// name are of no use to us.

#include <cstring>

#include "embind_names.h"
#include "modules/embind_host.h"

namespace {

using mirage::EmbindHost;
using mirage::WasmTrap;
using mirage::WireType;

EmbindHost& host(Z_a_instance_t* environment) { return *static_cast<EmbindHost*>(environment); }

constexpr u32 kBadFile = 8;  // EBADF of WASI

}  // namespace

extern "C" {

// Errors and memory.

void MIRAGE_IMPORT_cxa_throw(Z_a_instance_t*, u32, u32, u32) {
  throw WasmTrap{"it throws an exception"};
}
void MIRAGE_IMPORT_abort_js(Z_a_instance_t*) { throw WasmTrap{"it aborts"}; }
void MIRAGE_IMPORT_emscripten_memcpy_js(Z_a_instance_t* env, u32 to, u32 from, u32 count) {
  const std::span<std::uint8_t> target = mirage::wasm_bytes(host(env).memory(), to, count);
  std::memmove(target.data(), mirage::wasm_bytes(host(env).memory(), from, count).data(), count);
}
u32 MIRAGE_IMPORT_emscripten_resize_heap(Z_a_instance_t* env, u32 bytes) {
  return host(env).grow(bytes) ? 1 : 0;
}

// Files. There are none; text that the transcoder prints goes nowhere.

u32 MIRAGE_IMPORT_fd_close(Z_a_instance_t*, u32) { return kBadFile; }
u32 MIRAGE_IMPORT_fd_seek(Z_a_instance_t*, u32, u32, u32, u32, u32) { return kBadFile; }
u32 MIRAGE_IMPORT_fd_write(Z_a_instance_t*, u32, u32, u32, u32) { return kBadFile; }

// Types. Those that no call of ours uses stay unknown.

void MIRAGE_IMPORT_embind_register_void(Z_a_instance_t* env, u32 type, u32) {
  host(env).add_type(type, WireType::kVoid);
}
void MIRAGE_IMPORT_embind_register_integer(Z_a_instance_t* env, u32 type, u32, u32 size, u32 least,
                                           u32) {
  if (size == 4 && least == 0) host(env).add_type(type, WireType::kUnsigned32);
}
void MIRAGE_IMPORT_embind_register_emval(Z_a_instance_t* env, u32 type) {
  host(env).add_type(type, WireType::kEmval);
}
void MIRAGE_IMPORT_embind_register_bigint(Z_a_instance_t*, u32, u32, u32, u32, u32, u32, u32) {}
void MIRAGE_IMPORT_embind_register_bool(Z_a_instance_t*, u32, u32, u32, u32) {}
void MIRAGE_IMPORT_embind_register_constant(Z_a_instance_t*, u32, u32, f64) {}
void MIRAGE_IMPORT_embind_register_enum(Z_a_instance_t*, u32, u32, u32, u32) {}
void MIRAGE_IMPORT_embind_register_enum_value(Z_a_instance_t*, u32, u32, u32) {}
void MIRAGE_IMPORT_embind_register_float(Z_a_instance_t*, u32, u32, u32) {}
void MIRAGE_IMPORT_embind_register_memory_view(Z_a_instance_t*, u32, u32, u32) {}
void MIRAGE_IMPORT_embind_register_std_string(Z_a_instance_t*, u32, u32) {}
void MIRAGE_IMPORT_embind_register_std_wstring(Z_a_instance_t*, u32, u32, u32) {}
void MIRAGE_IMPORT_embind_register_value_object(Z_a_instance_t*, u32, u32, u32, u32, u32, u32) {}
void MIRAGE_IMPORT_embind_register_value_object_field(Z_a_instance_t*, u32, u32, u32, u32, u32, u32,
                                                      u32, u32, u32, u32) {}
void MIRAGE_IMPORT_embind_finalize_value_object(Z_a_instance_t*, u32) {}

// Classes and functions.

void MIRAGE_IMPORT_embind_register_class(Z_a_instance_t* env, u32 type, u32, u32, u32, u32, u32,
                                         u32, u32, u32, u32, u32 name, u32, u32) {
  host(env).add_class(type, name);
}
void MIRAGE_IMPORT_embind_register_class_constructor(Z_a_instance_t* env, u32 type, u32 count,
                                                     u32 types, u32, u32 invoker, u32 context) {
  host(env).add_function(host(env).class_name(type), count, types, invoker, context);
}
void MIRAGE_IMPORT_embind_register_class_function(Z_a_instance_t* env, u32 type, u32 name,
                                                  u32 count, u32 types, u32, u32 invoker,
                                                  u32 context, u32, u32) {
  const std::string full = host(env).class_name(type) + "." + host(env).text_at(name);
  host(env).add_function(full, count, types, invoker, context);
}
void MIRAGE_IMPORT_embind_register_function(Z_a_instance_t* env, u32 name, u32 count, u32 types,
                                            u32, u32 invoker, u32 context, u32) {
  host(env).add_function(host(env).text_at(name), count, types, invoker, context);
}

// Values.

void MIRAGE_IMPORT_emval_incref(Z_a_instance_t* env, u32 handle) {
  host(env).values().add_reference(handle);
}
void MIRAGE_IMPORT_emval_decref(Z_a_instance_t* env, u32 handle) {
  host(env).values().drop_reference(handle);
}
u32 MIRAGE_IMPORT_emval_new_cstring(Z_a_instance_t* env, u32 text) {
  return host(env).values().add(host(env).text_at(text));
}
u32 MIRAGE_IMPORT_emval_get_module_property(Z_a_instance_t* env, u32 name) {
  if (host(env).text_at(name) != "HEAP8") throw WasmTrap{"it asks for an unknown global"};
  return host(env).values().add(mirage::JsHeap{});
}
u32 MIRAGE_IMPORT_emval_get_global(Z_a_instance_t* env, u32 name) {
  if (host(env).text_at(name) != "Uint8Array") throw WasmTrap{"it asks for an unknown global"};
  return host(env).values().add(mirage::JsUint8Array{});
}
u32 MIRAGE_IMPORT_emval_get_property(Z_a_instance_t* env, u32 object, u32 key) {
  mirage::EmvalTable& values = host(env).values();
  return values.add(mirage::js_property(values.at(object), values.at(key)));
}
f64 MIRAGE_IMPORT_emval_as(Z_a_instance_t* env, u32 handle, u32 type, u32) {
  const double* const number = std::get_if<double>(&host(env).values().at(handle));
  if (!number || host(env).wire_type(type) != WireType::kUnsigned32) {
    throw WasmTrap{"it converts an unknown value"};
  }
  return *number;
}
u32 MIRAGE_IMPORT_emval_get_method_caller(Z_a_instance_t* env, u32 count, u32 types, u32 kind) {
  return host(env).add_caller(count, types, kind);
}
f64 MIRAGE_IMPORT_emval_call(Z_a_instance_t* env, u32 caller, u32 object, u32, u32 arguments) {
  return host(env).call_value(caller, object, nullptr, arguments);
}
f64 MIRAGE_IMPORT_emval_call_method(Z_a_instance_t* env, u32 caller, u32 object, u32 name, u32,
                                    u32 arguments) {
  const std::string method = host(env).text_at(name);
  return host(env).call_value(caller, object, &method, arguments);
}
void MIRAGE_IMPORT_emval_run_destructors(Z_a_instance_t*, u32) {
  throw WasmTrap{"it hands over a value that needs to be destroyed"};
}

}  // extern "C"
