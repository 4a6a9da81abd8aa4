// Preloaded into a program under test: its wall clock is off by the seconds that a file says at that moment.
// Its steady clock is left alone, as a real jump leaves it; the kernel's is not moved, so a wait until some
// wall clock time is told to the kernel in its own: else every wait of gRPC's would be over at once, or last
// for days. Waits that have begun before a jump do not feel it, as they would feel a real one.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <linux/futex.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

static int real_time(clockid_t clock, struct timespec* now) {
  static _Atomic(void*) real;
  if (atomic_load(&real) == NULL) atomic_store(&real, dlsym(RTLD_NEXT, "clock_gettime"));
  return ((int (*)(clockid_t, struct timespec*))atomic_load(&real))(clock, now);
}

static long read_offset(void) {
  const char* path = getenv("PENUMBRA_CLOCK_FILE");
  FILE* file = path == NULL ? NULL : fopen(path, "r");
  long seconds = 0;
  if (file == NULL) return 0;
  if (fscanf(file, "%ld", &seconds) != 1) seconds = 0;
  fclose(file);
  return seconds;
}

/// Looks into the file at most 100 times a second: the clock is read far more often.
static long offset_seconds(void) {
  static _Atomic long offset, next_look;
  struct timespec now;
  real_time(CLOCK_MONOTONIC, &now);
  const long hundredths = now.tv_sec * 100 + now.tv_nsec / 10000000;
  if (hundredths < atomic_load(&next_look)) return atomic_load(&offset);
  const long found = read_offset();
  atomic_store(&offset, found);
  atomic_store(&next_look, hundredths + 1);
  return found;
}

int clock_gettime(clockid_t clock, struct timespec* now) {
  const int result = real_time(clock, now);
  if (result == 0 && clock == CLOCK_REALTIME) now->tv_sec += offset_seconds();
  return result;
}

/// Abseil's locks wait by futex(2).
long syscall(long number, ...) {
  static _Atomic(void*) real;
  if (atomic_load(&real) == NULL) atomic_store(&real, dlsym(RTLD_NEXT, "syscall"));
  va_list list;
  va_start(list, number);
  long a[6];
  for (int i = 0; i < 6; ++i) a[i] = va_arg(list, long);
  va_end(list);
  struct timespec until;
  if (number == SYS_futex && (a[1] & FUTEX_CLOCK_REALTIME) != 0 && a[3] != 0) {
    until = *(const struct timespec*)a[3];
    until.tv_sec -= offset_seconds();
    if (until.tv_sec < 0) until.tv_sec = 0;
    a[3] = (long)&until;
  }
  return ((long (*)(long, ...))atomic_load(&real))(number, a[0], a[1], a[2], a[3], a[4], a[5]);
}

int gettimeofday(struct timeval* restrict now, void* restrict zone) {
  (void)zone;
  struct timespec exact;
  clock_gettime(CLOCK_REALTIME, &exact);
  now->tv_sec = exact.tv_sec;
  now->tv_usec = exact.tv_nsec / 1000;
  return 0;
}

time_t time(time_t* out) {
  struct timespec exact;
  clock_gettime(CLOCK_REALTIME, &exact);
  if (out != NULL) *out = exact.tv_sec;
  return exact.tv_sec;
}
