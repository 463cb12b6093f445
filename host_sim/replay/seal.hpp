#pragma once
// Proof at run time that a loop does not touch the heap: while a HeapSeal lives, any allocation in
// the process says so on stderr and aborts. seal.cpp replaces malloc and its relatives (operator
// new ends there too); under a sanitizer, which owns malloc, it asks the sanitizer's hook.
namespace fairlead::sim {

class HeapSeal {
  public:
    HeapSeal();
    ~HeapSeal();
    HeapSeal(const HeapSeal&) = delete;
    HeapSeal& operator=(const HeapSeal&) = delete;
};

}  // namespace fairlead::sim
