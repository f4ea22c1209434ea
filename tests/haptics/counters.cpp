// SPDX-License-Identifier: Apache-2.0
#include "counters.hpp"

#include <dlfcn.h>
#include <pthread.h>

#include <cstdlib>
#include <new>

namespace {
thread_local bool counting = false;
thread_local long allocations = 0;
thread_local long locks = 0;
}  // namespace

// Sanitizers bring their own operator new and locks.
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
void* operator new(std::size_t size) {
  if (counting) ++allocations;
  if (void* p = std::malloc(size ? size : 1)) return p;
  throw std::bad_alloc();
}
void* operator new[](std::size_t size) {
  return operator new(size);
}
void operator delete(void* p) noexcept {
  std::free(p);
}
void operator delete[](void* p) noexcept {
  std::free(p);
}
void operator delete(void* p, std::size_t) noexcept {
  std::free(p);
}
void operator delete[](void* p, std::size_t) noexcept {
  std::free(p);
}
extern "C" int pthread_mutex_lock(pthread_mutex_t* mutex) {
  using Lock = int (*)(pthread_mutex_t*);
  static const auto real = reinterpret_cast<Lock>(dlsym(RTLD_NEXT, "pthread_mutex_lock"));
  if (counting) ++locks;
  return real(mutex);
}
#endif

namespace palpate::haptics {

void start_counting() {
  allocations = 0;
  locks = 0;
  counting = true;
}
void stop_counting() {
  counting = false;
}
long counted_allocations() {
  return allocations;
}
long counted_locks() {
  return locks;
}
QuietScope::QuietScope() {
  start_counting();
}
QuietScope::~QuietScope() {
  stop_counting();
}
long QuietScope::allocations() const {
  return counted_allocations();
}
long QuietScope::locks() const {
  return counted_locks();
}

}  // namespace palpate::haptics
