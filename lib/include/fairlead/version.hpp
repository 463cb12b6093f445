#pragma once
// The version of the library and its API. This is the only place where it is written: all manifests
// and archives are generated from here (make dist). What may change with which number:
// docs/versions.md. The version of the byte stream is another number, and belongs to wire/.
#include "fairlead/base/compiler.hpp"

#define FAIRLEAD_VERSION_MAJOR 0
#define FAIRLEAD_VERSION_MINOR 1
#define FAIRLEAD_VERSION_PATCH 0

#define FAIRLEAD_TEXT_OF(x) #x
#define FAIRLEAD_DOTTED(a, b, c) FAIRLEAD_TEXT_OF(a) "." FAIRLEAD_TEXT_OF(b) "." FAIRLEAD_TEXT_OF(c)
/// The version as text, for instance "0.1.0".
#define FAIRLEAD_VERSION \
    FAIRLEAD_DOTTED(FAIRLEAD_VERSION_MAJOR, FAIRLEAD_VERSION_MINOR, FAIRLEAD_VERSION_PATCH)
/// The version as one number that grows, for the preprocessor: 0.1.0 is 100, 1.2.3 is 10203.
#define FAIRLEAD_VERSION_NUMBER \
    (FAIRLEAD_VERSION_MAJOR * 10000 + FAIRLEAD_VERSION_MINOR * 100 + FAIRLEAD_VERSION_PATCH)
