// Preloaded into a program under test: everything that waits for the disk takes longer by the milliseconds that a
// file says at that moment.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static void wait_for_the_disk(void) {
  const char* path = getenv("PENUMBRA_DISK_FILE");
  FILE* file = path == NULL ? NULL : fopen(path, "r");
  long milliseconds = 0;
  if (file == NULL) return;
  if (fscanf(file, "%ld", &milliseconds) != 1) milliseconds = 0;
  fclose(file);
  const struct timespec time = {milliseconds / 1000, milliseconds % 1000 * 1000000};
  nanosleep(&time, NULL);
}

#define SLOW(name)                                        \
  int name(int file) {                                    \
    wait_for_the_disk();                                  \
    return ((int (*)(int))dlsym(RTLD_NEXT, #name))(file); \
  }

SLOW(fsync)
SLOW(fdatasync)
SLOW(syncfs)
