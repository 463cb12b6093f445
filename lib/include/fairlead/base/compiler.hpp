#pragma once
// What fairlead needs of the compiler and its flags. Every public header includes this one before
// any code, so that a wrong setting stops the compilation with one sentence, not with wrong motion.
//
// The same input gives the same bits on every machine only where each operation on a float is one
// IEEE 754 operation, rounded once. Fast-math options give up that rule. Some compilers announce
// the option by a macro; what no compiler announces is in docs/portability.md, and
// base/arithmetic.hpp tests for it at run time.
#include <cfloat>

#if !defined(__GNUC__) && !defined(__clang__)
#error "fairlead: this compiler is not supported. Use GCC (11 or later) or Clang (14 or later)."
#endif

// MSVC and clang-cl keep __cplusplus at 199711L; _MSVC_LANG has the true value
#if defined(_MSVC_LANG)
#define FAIRLEAD_CPLUSPLUS _MSVC_LANG
#else
#define FAIRLEAD_CPLUSPLUS __cplusplus
#endif
#if FAIRLEAD_CPLUSPLUS < 201703L
#error "fairlead: C++17 or later is needed. Compile with -std=c++17 or -std=gnu++17."
#endif
#undef FAIRLEAD_CPLUSPLUS

#if defined(__FAST_MATH__)
#error "fairlead: -ffast-math (or -Ofast) breaks the tolerance; remove it."
#elif defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__
#error "fairlead: -ffinite-math-only hides NaN; remove it."
#elif defined(__ASSOCIATIVE_MATH__) && __ASSOCIATIVE_MATH__
#error "fairlead: -fassociative-math (or -funsafe-math-optimizations) reorders sums; remove it."
#elif defined(__RECIPROCAL_MATH__) && __RECIPROCAL_MATH__
#error "fairlead: -freciprocal-math changes quotients; remove it."
#elif defined(__NO_SIGNED_ZEROS__) && __NO_SIGNED_ZEROS__
#error "fairlead: -fno-signed-zeros changes the sign of angles; remove it."
#endif

#if defined(FLT_EVAL_METHOD) && FLT_EVAL_METHOD != 0
#error "fairlead: floats have excess precision (FLT_EVAL_METHOD). On x86: -msse2 -mfpmath=sse."
#endif

// A function that has one code for all callers where the build asks for few bytes of flash.
#if defined(__OPTIMIZE_SIZE__)
#define FAIRLEAD_SMALL [[gnu::noinline]]
#else
#define FAIRLEAD_SMALL
#endif

static_assert(FLT_RADIX == 2 && FLT_MANT_DIG == 24 && FLT_MAX_EXP == 128,
              "fairlead: float must be the IEEE 754 type of 32 bits.");
static_assert(DBL_MANT_DIG == 53 && DBL_MAX_EXP == 1024,
              "fairlead: double must be the IEEE 754 type of 64 bits; remove -fshort-double.");
static_assert(sizeof(1.0) == sizeof(double),
              "fairlead: remove -fsingle-precision-constant; it shortens double constants.");
