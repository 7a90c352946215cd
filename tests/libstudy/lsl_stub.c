/* Stands in for liblsl in tests: the functions that libstudy/markers uses, with the parameters of liblsl's
 * interface for C. It writes one line for each call to the file that LSL_STUB_LOG names. LSL_STUB_CONSUMERS
 * is the number of recorders. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static int info, outlet;

static FILE* open_log(void) { return fopen(getenv("LSL_STUB_LOG"), "a"); }

static void tell(const char* line) {
  FILE* log = open_log();
  fprintf(log, "%s\n", line);
  fclose(log);
}

double lsl_local_clock(void) {
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

void* lsl_create_streaminfo(const char* name, const char* type, int32_t channels, double rate, int format,
                            const char* source) {
  FILE* log = open_log();
  fprintf(log, "streaminfo %s, %s, %d channel, rate %g, format %d, %s\n", name, type, (int)channels, rate,
          format, source);
  fclose(log);
  return &info;
}

void lsl_destroy_streaminfo(void* one) { tell(one == &info ? "destroy streaminfo" : "wrong streaminfo"); }

void* lsl_create_outlet(void* one, int32_t chunk, int32_t buffered) {
  FILE* log = open_log();
  fprintf(log, "outlet %s, chunk %d, buffered %d\n", one == &info ? "right" : "wrong", (int)chunk,
          (int)buffered);
  fclose(log);
  return &outlet;
}

void lsl_destroy_outlet(void* one) { tell(one == &outlet ? "destroy outlet" : "wrong outlet"); }

int32_t lsl_have_consumers(void* one) {
  return one == &outlet && getenv("LSL_STUB_CONSUMERS") ? atoi(getenv("LSL_STUB_CONSUMERS")) : 0;
}

int32_t lsl_push_sample_strtp(void* one, const char** sample, double time, int32_t at_once) {
  FILE* log = open_log();
  fprintf(log, "push %s, %.9f, %d, %s\n", sample[0], time, (int)at_once, one == &outlet ? "right" : "wrong");
  fclose(log);
  return 0;
}
