/* Stands in for liblsl in tests: the functions that libstudy/markers and libstudy/trackers use, with the
 * parameters of liblsl's interface for C. It writes one line for each call of an outlet to the file that
 * LSL_STUB_LOG names. LSL_STUB_CONSUMERS is the number of recorders.
 *
 * An inlet gives a sample every 5 ms: (0.6, 0, -0.8), and every tenth time NaN. The sender's clock is 100 s
 * ahead. LSL_STUB_STREAMS is the number of streams of the name that is asked for, LSL_STUB_CHANNELS and
 * LSL_STUB_FORMAT are theirs; while LSL_STUB_LOST is 1 the stream has ended. */
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

static int inlet;
static double next_sample;
static int samples;

static int number(const char* name, int otherwise) { return getenv(name) ? atoi(getenv(name)) : otherwise; }

int32_t lsl_resolve_byprop(void** found, uint32_t most, const char* property, const char* value,
                           int32_t least, double timeout) {
  (void)property, (void)value, (void)least, (void)timeout;
  int32_t count = number("LSL_STUB_LOST", 0) ? 0 : number("LSL_STUB_STREAMS", 1);
  if (count > (int32_t)most) count = (int32_t)most;
  for (int32_t i = 0; i < count; ++i) found[i] = &info;
  return count;
}

int32_t lsl_get_channel_count(void* one) { return one == &info ? number("LSL_STUB_CHANNELS", 4) : 0; }
int32_t lsl_get_channel_format(void* one) { return one == &info ? number("LSL_STUB_FORMAT", 2) : 0; }
const char* lsl_get_hostname(void* one) { return one == &info ? "lab-pc" : ""; }

void* lsl_create_inlet(void* one, int32_t buffered, int32_t chunk, int32_t recover) {
  (void)buffered, (void)chunk, (void)recover;
  next_sample = lsl_local_clock();
  return one == &info ? &inlet : 0;
}

void lsl_destroy_inlet(void* one) { (void)one; }

void lsl_open_stream(void* one, double timeout, int32_t* error) {
  (void)timeout;
  *error = one == &inlet ? 0 : -3;
}

double lsl_pull_sample_d(void* one, double* values, int32_t count, double timeout, int32_t* error) {
  *error = one != &inlet ? -3 : number("LSL_STUB_LOST", 0) ? -2 : 0;
  if (*error) return 0;
  const double until = lsl_local_clock() + timeout;
  while (lsl_local_clock() < next_sample) {
    if (lsl_local_clock() >= until) return 0;
    const struct timespec little = {0, 500000};
    nanosleep(&little, 0);
  }
  const double lost = ++samples % 10 == 0 ? 0.0 / 0.0 : 1;
  const double all[4] = {0.6 * lost, 0, -0.8, 1};
  for (int32_t i = 0; i < count && i < 4; ++i) values[i] = all[i];
  next_sample += 0.005;
  return next_sample - 0.005 + 100;
}

double lsl_time_correction_ex(void* one, double* remote, double* uncertainty, double timeout,
                              int32_t* error) {
  (void)timeout;
  *error = one == &inlet ? 0 : -3;
  *remote = lsl_local_clock() + 100;
  *uncertainty = 0.0002;
  return -100;
}
