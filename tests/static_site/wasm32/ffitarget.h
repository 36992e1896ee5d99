/* What libffi says about its calls on 32-bit WebAssembly as Emscripten lays it out. */
#ifndef LIBFFI_TARGET_H
#define LIBFFI_TARGET_H

typedef unsigned long ffi_arg;
typedef signed long ffi_sarg;
typedef enum ffi_abi {
  FFI_FIRST_ABI = 0,
  FFI_WASM32,
  FFI_WASM32_EMSCRIPTEN,
  FFI_LAST_ABI,
  FFI_DEFAULT_ABI = FFI_WASM32_EMSCRIPTEN
} ffi_abi;

#define FFI_CLOSURES 1
#define FFI_GO_CLOSURES 0
#define FFI_NATIVE_RAW_API 0
#define FFI_TRAMPOLINE_SIZE 4
#define FFI_TARGET_HAS_COMPLEX_TYPE
#define FFI_EXTRA_CIF_FIELDS unsigned int nfixedargs

#endif
