/* SPDX-License-Identifier: BSD-3-Clause
 * Replay: runs a fuzz target on the files named, without libFuzzer. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static int replay(const char *path) {
  FILE *file = fopen(path, "rb");
  if (file == NULL || fseek(file, 0, SEEK_END) != 0) return 1;
  const long size = ftell(file);
  rewind(file);
  uint8_t *data = malloc(size > 0 ? (size_t)size : 1);
  const int ok = data != NULL && size >= 0 && fread(data, 1, (size_t)size, file) == (size_t)size;
  fclose(file);
  if (ok) LLVMFuzzerTestOneInput(data, (size_t)size);
  free(data);
  return !ok;
}

int main(int argc, char **argv) {
  int failed = argc < 2; /* a target without seeds is a mistake */
  for (int i = 1; i < argc; i++) {
    if (replay(argv[i]) == 0) continue;
    fprintf(stderr, "%s could not be read\n", argv[i]);
    failed = 1;
  }
  printf("%d files replayed\n", argc - 1);
  return failed;
}
