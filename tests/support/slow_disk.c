/* Preloaded into a program (LD_PRELOAD): a disk that takes SLOW_DISK_MICROSECONDS more for every pwrite, and is full after
   SLOW_DISK_WRITES of them (unset: never). */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <sys/types.h>
#include <unistd.h>

typedef ssize_t (*Write)(int, const void*, size_t, off_t);

static ssize_t write_slowly(const char* name, int file, const void* data, size_t size, off_t offset) {
  static atomic_long writes;
  const char* microseconds = getenv("SLOW_DISK_MICROSECONDS");
  const char* room = getenv("SLOW_DISK_WRITES");
  if (microseconds) usleep((useconds_t)atol(microseconds));
  if (room && atomic_fetch_add(&writes, 1) >= atol(room)) {
    errno = ENOSPC;
    return -1;
  }
  return ((Write)dlsym(RTLD_NEXT, name))(file, data, size, offset);
}

ssize_t pwrite(int file, const void* data, size_t size, off_t offset) {
  return write_slowly("pwrite", file, data, size, offset);
}
ssize_t pwrite64(int file, const void* data, size_t size, off64_t offset) {
  return write_slowly("pwrite64", file, data, size, offset);
}
