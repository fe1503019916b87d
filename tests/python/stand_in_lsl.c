/* SPDX-License-Identifier: MIT
   What tactor.lsl and tactor experiment call of liblsl, which prints what it is told to the file in $STAND_IN_LSL. Its clock runs 1000 s ahead. */
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static FILE* out;

double lsl_local_clock(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1000.0 + (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

void* lsl_create_streaminfo(const char* name, const char* type, int channels, double rate, int format, const char* source)
{
    out = fopen(getenv("STAND_IN_LSL"), "w");
    if (out != NULL)
        fprintf(out, "info %s %s %d %g %d %s\n", name, type, channels, rate, format, source);
    return out;
}

void* lsl_create_outlet(void* info, int chunk, int buffered)
{
    fprintf(info, "outlet %d %d\n", chunk, buffered);
    return info;
}

int lsl_push_sample_strtp(void* outlet, const char** sample, double at, int through)
{
    fprintf(outlet, "%.9f %d %s\n", at, through, sample[0]);
    fflush(outlet);
    return 0;
}

int lsl_push_sample_itp(void* outlet, const int* sample, double at, int through)
{
    fprintf(outlet, "%.9f %d %d\n", at, through, sample[0]);
    fflush(outlet);
    return 0;
}

void lsl_destroy_outlet(void* outlet)
{
    fprintf(outlet, "destroyed\n");
}

void lsl_destroy_streaminfo(void* info)
{
    fclose(info);
}
