/* Python's settings for 64-bit Linux, with the sizes that a 32-bit WebAssembly has. */
#include "x86_64-linux-gnu/python3.14/pyconfig.h"

#undef SIZEOF_LONG
#undef SIZEOF_VOID_P
#undef SIZEOF_SIZE_T
#undef SIZEOF_UINTPTR_T
#undef SIZEOF_PTHREAD_T
#undef ALIGNOF_LONG
#undef ALIGNOF_SIZE_T
#undef ALIGNOF_MAX_ALIGN_T
#define SIZEOF_LONG 4
#define SIZEOF_VOID_P 4
#define SIZEOF_SIZE_T 4
#define SIZEOF_UINTPTR_T 4
#define SIZEOF_PTHREAD_T 4
#define ALIGNOF_LONG 4
#define ALIGNOF_SIZE_T 4
#define ALIGNOF_MAX_ALIGN_T 8

#undef HAVE_GCC_UINT128_T
#undef HAVE_STD_ATOMIC
#undef HAVE_BUILTIN_ATOMIC
