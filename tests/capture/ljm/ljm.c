/* An emulated LJM library: what LabJack's Python package calls, with a T7 behind it that streams a pendulum in real time.
 *
 * Written from the LJM User's Guide ("Device functions", "Stream functions"): functions return 0 or an error code; names are the
 * Modbus map's; eStreamStart tells the rate that the device really gives (here 1e6 over a whole number of microseconds, as its
 * clock does); eStreamRead blocks until there are scans enough, and a scan that was lost stands in the data as -9999. The
 * environment tells what happens: LJM_LOSE scans, from the hundredth on, are lost; after LJM_UNPLUG scans the device is gone.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define DEVICE_NOT_FOUND 1227
#define INVALID_NAME 1294
#define STREAM_NOT_RUNNING 1303
#define RECONNECT_FAILED 1239
#define MAX_RATE 100000.0

static double rate, range = 10, begun;
static int streaming, per_read;
static long scanned;

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return t.tv_sec + 1e-9 * t.tv_nsec;
}

static long environment(const char *name)
{
    const char *value = getenv(name);
    return value ? atol(value) : 0;
}

int LJM_OpenS(const char *device, const char *connection, const char *identifier, int *handle)
{
    (void)connection;
    if (strcmp(device, "T7") && strcmp(device, "ANY"))
        return DEVICE_NOT_FOUND;
    if (strcmp(identifier, "ANY") && strcmp(identifier, "470012345"))
        return DEVICE_NOT_FOUND;
    *handle = 1;
    return 0;
}

int LJM_Close(int handle)
{
    (void)handle;
    return 0;
}

int LJM_ErrorToString(int error, char *text)
{
    strcpy(text, error == DEVICE_NOT_FOUND ? "LJME_DEVICE_NOT_FOUND" : error == INVALID_NAME ? "LJME_INVALID_NAME" : "LJME_EMULATED");
    return 0;
}

int LJM_NameToAddress(const char *name, int *address, int *type)
{
    if (strncmp(name, "AIN", 3) || name[3] < '0' || name[3] > '9' || strlen(name) > 5)
        return INVALID_NAME;
    *address = 2 * atoi(name + 3);
    *type = 3; /* FLOAT32 */
    return 0;
}

int LJM_eWriteName(int handle, const char *name, double value)
{
    (void)handle;
    if (strstr(name, "_RANGE"))
        range = value;
    else if (!strstr(name, "_NEGATIVE_CH"))
        return INVALID_NAME;
    return 0;
}

int LJM_ReadLibraryConfigS(const char *parameter, double *value)
{
    (void)parameter;
    *value = 1.23;
    return 0;
}

int LJM_eStreamStart(int handle, int scans, int count, const int *addresses, double *wanted)
{
    (void)handle, (void)addresses;
    if (count != 1 || *wanted > MAX_RATE)
        return INVALID_NAME;
    rate = *wanted = 1e6 / round(1e6 / *wanted);
    per_read = scans, scanned = 0, streaming = 1, begun = now();
    return 0;
}

int LJM_eStreamRead(int handle, double *data, int *device_backlog, int *library_backlog)
{
    long lost = environment("LJM_LOSE"), unplug = environment("LJM_UNPLUG");
    (void)handle;
    if (!streaming)
        return STREAM_NOT_RUNNING;
    if (unplug && scanned >= unplug)
        return RECONNECT_FAILED;
    double due = begun + (scanned + per_read) / rate - now();
    if (due > 0) {
        struct timespec wait = {(time_t)due, (long)(1e9 * (due - floor(due)))};
        nanosleep(&wait, NULL);
    }
    for (int k = 0; k < per_read; k++, scanned++) {
        double volts = 2.5 + 1.5 * cos(7.25 * scanned / rate);
        data[k] = scanned >= 100 && scanned < 100 + lost ? -9999 : fmin(fmax(volts, -range), range);
    }
    *device_backlog = *library_backlog = 0;
    return 0;
}

int LJM_eStreamStop(int handle)
{
    (void)handle;
    streaming = 0;
    return 0;
}
