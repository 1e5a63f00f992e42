/* Counters by perf_event_open. With libpfm4 events have the names of the processor's manual, else only the
   kernel's generic ones are there. SPDX-License-Identifier: MIT */
#define _GNU_SOURCE
#include "perf.h"
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>
#ifdef __linux__
#include <linux/perf_event.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>
#ifdef BENCH_PFM
#include <perfmon/pfmlib_perf_event.h>
#endif

#define HARDWARE(event) \
    .generic = true, .type = PERF_TYPE_HARDWARE, .config = PERF_COUNT_HW_##event, .factor = 1
#define CACHE_L1D(access, result) \
    .generic = true, .type = PERF_TYPE_HW_CACHE, .factor = 1, \
    .config = PERF_COUNT_HW_CACHE_L1D | PERF_COUNT_HW_CACHE_OP_##access << 8 | \
              PERF_COUNT_HW_CACHE_RESULT_##result << 16

/* An FP_ARITH event is one instruction, an FMA two: times its lanes they are operations. Zen 4 counts
   micro-operations by width, FMA once, moves too; older ones have no widths. */
#define FP(count_name, intel, amd, lanes) \
    {.name = count_name, \
     .event = {"FP_ARITH_INST_RETIRED:" intel, "FP_ARITH:" intel, "RETIRED_FP_OPS_BY_WIDTH:" amd}, \
     .factor = lanes}

/* Few in a group, so that each has its counters to itself; every group has a run of its own. */
const struct perf_group perf_groups[] = {
    {NULL,
     {{.name = "task_clock_ns",
       .generic = true,
       .type = PERF_TYPE_SOFTWARE,
       .config = PERF_COUNT_SW_TASK_CLOCK,
       .factor = 1}}},
    {NULL,
     {{.name = "cycles", HARDWARE(CPU_CYCLES)},
      {.name = "instructions", HARDWARE(INSTRUCTIONS)},
      {.name = "branches", HARDWARE(BRANCH_INSTRUCTIONS)},
      {.name = "branch_misses", HARDWARE(BRANCH_MISSES)}}},
    {NULL,
     {{.name = "loads",
       .event = {"MEM_INST_RETIRED:ALL_LOADS", "MEM_UOPS_RETIRED:ALL_LOADS", "LS_DISPATCH:LD_DISPATCH"},
       .factor = 1},
      {.name = "stores",
       .event = {"MEM_INST_RETIRED:ALL_STORES", "MEM_UOPS_RETIRED:ALL_STORES", "LS_DISPATCH:STORE_DISPATCH"},
       .factor = 1},
      {.name = "l1d_accesses", CACHE_L1D(READ, ACCESS)},
      {.name = "l1d_misses", CACHE_L1D(READ, MISS)}}},
    {NULL,
     {{.name = "stall_cycles",
       .event = {"CYCLE_ACTIVITY:STALLS_TOTAL", "CYCLE_ACTIVITY:CYCLES_NO_EXECUTE"},
       HARDWARE(STALLED_CYCLES_BACKEND)},
      {.name = "memory_stall_cycles",
       .event = {"CYCLE_ACTIVITY:STALLS_MEM_ANY", "CYCLE_ACTIVITY:STALLS_LDM_PENDING",
                 "EXE_ACTIVITY:BOUND_ON_LOADS"},
       .factor = 1}}},
    {"double",
     {FP("fp_scalar", "SCALAR_DOUBLE", "SCALAR_UOPS_RETIRED", 1),
      FP("fp_128", "128B_PACKED_DOUBLE", "PACK128_UOPS_RETIRED", 2),
      FP("fp_256", "256B_PACKED_DOUBLE", "PACK256_UOPS_RETIRED", 4),
      FP("fp_512", "512B_PACKED_DOUBLE", "PACK512_UOPS_RETIRED", 8)}},
    {"float",
     {FP("fp_scalar", "SCALAR_SINGLE", "SCALAR_UOPS_RETIRED", 1),
      FP("fp_128", "128B_PACKED_SINGLE", "PACK128_UOPS_RETIRED", 4),
      FP("fp_256", "256B_PACKED_SINGLE", "PACK256_UOPS_RETIRED", 8),
      FP("fp_512", "512B_PACKED_SINGLE", "PACK512_UOPS_RETIRED", 16)}},
};
const int perf_group_count = sizeof perf_groups / sizeof *perf_groups;

/* ---- events ---- */

static int open_event(struct perf_event_attr *attr, int leader) {
    attr->size = sizeof *attr;
    attr->disabled = leader < 0;
    attr->exclude_kernel = attr->exclude_hv = 1;
    attr->read_format = PERF_FORMAT_GROUP | PERF_FORMAT_TOTAL_TIME_ENABLED | PERF_FORMAT_TOTAL_TIME_RUNNING;
    return (int)syscall(SYS_perf_event_open, attr, 0, -1, leader, 0);
}

static int open_generic(const struct perf_counter *c, int leader) {
    struct perf_event_attr attr;
    memset(&attr, 0, sizeof attr);
    attr.type = c->type;
    attr.config = c->config;
    return open_event(&attr, leader);
}

/* By the processor's own name; -1 if it has none such, or libpfm4 is missing. */
static int open_named(const char *event, int leader) {
#ifdef BENCH_PFM
    struct perf_event_attr attr;
    pfm_perf_encode_arg_t arg;
    memset(&attr, 0, sizeof attr);
    memset(&arg, 0, sizeof arg);
    arg.attr = &attr;
    arg.size = sizeof arg;
    if (pfm_initialize() != PFM_SUCCESS ||
        pfm_get_os_event_encoding(event, PFM_PLM3, PFM_OS_PERF_EVENT, &arg) != PFM_SUCCESS)
        return -1;
    return open_event(&attr, leader);
#else
    (void)event, (void)leader;
    return -1;
#endif
}

static int open_counter(const struct perf_counter *c, int leader) {
    for (int i = 0; i < 4 && c->event[i]; i++) {
        int fd = open_named(c->event[i], leader);
        if (fd >= 0) return fd;
    }
    return c->generic ? open_generic(c, leader) : -1;
}

bool perf_available(char *text, int size) {
    const struct perf_counter instructions = {HARDWARE(INSTRUCTIONS)};
    int fd = open_generic(&instructions, -1);
    if (fd >= 0) {
        close(fd);
        snprintf(text, (size_t)size, "hardware counters: available");
        return true;
    }
    if (errno == EACCES || errno == EPERM)
        snprintf(
            text, (size_t)size,
            "hardware counters: not permitted; as root: sysctl kernel.perf_event_paranoid=1 (in a container: "
            "--cap-add PERFMON)");
    else if (errno == ENOSYS)
        snprintf(text, (size_t)size,
                 "hardware counters: this kernel has no perf_event_open; use valgrind's counts");
    else
        snprintf(
            text, (size_t)size,
            "hardware counters: the machine shows none (%s), as virtual machines often do; use valgrind's "
            "counts, or a host with a PMU (KVM: -cpu host,pmu=on)",
            strerror(errno));
    return false;
}

/* ---- runs ---- */

static int leader_of(const struct perf_run *r) {
    for (int i = 0; i < PERF_GROUP; i++)
        if (r->fd[i] >= 0) return r->fd[i];
    return -1;
}

void perf_open(struct perf_run *r, const struct perf_group *group) {
    *r = (struct perf_run){.group = group, .fd = {-1, -1, -1, -1}};
    for (int i = 0; i < PERF_GROUP && group->counter[i].name; i++)
        r->fd[i] = open_counter(&group->counter[i], leader_of(r));
}

void perf_start(const struct perf_run *r) {
    const int leader = leader_of(r);
    if (leader >= 0) {
        ioctl(leader, PERF_EVENT_IOC_RESET, PERF_IOC_FLAG_GROUP);
        ioctl(leader, PERF_EVENT_IOC_ENABLE, PERF_IOC_FLAG_GROUP);
    }
}

void perf_stop(struct perf_run *r) {
    struct {
        uint64_t n, enabled, running, value[PERF_GROUP];
    } data = {0, 0, 0, {0}};
    const int leader = leader_of(r);
    if (leader < 0) return;
    ioctl(leader, PERF_EVENT_IOC_DISABLE, PERF_IOC_FLAG_GROUP);
    if (read(leader, &data, sizeof data) < (ssize_t)(3 * sizeof(uint64_t))) data.n = data.running = 0;
    r->share = data.enabled ? (double)data.running / (double)data.enabled : 0;
    for (int i = 0, k = 0; i < PERF_GROUP; i++) /* values come in the order of opening */
        if (r->fd[i] >= 0)
            r->count[i] =
                r->group->counter[i].factor * perf_scaled(data.value[k++], data.enabled, data.running);
}

void perf_close(struct perf_run *r) {
    for (int i = PERF_GROUP - 1; i >= 0; i--)
        if (r->fd[i] >= 0) close(r->fd[i]);
}

#else

const struct perf_group perf_groups[1] = {{NULL, {{.name = NULL}}}};
const int perf_group_count = 0;

bool perf_available(char *text, int size) {
    snprintf(text, (size_t)size, "hardware counters: on Linux only");
    return false;
}
void perf_open(struct perf_run *r, const struct perf_group *group) {
    *r = (struct perf_run){.group = group, .fd = {-1, -1, -1, -1}};
}
void perf_start(const struct perf_run *r) { (void)r; }
void perf_stop(struct perf_run *r) { (void)r; }
void perf_close(struct perf_run *r) { (void)r; }

#endif

double perf_scaled(uint64_t count, uint64_t enabled, uint64_t running) {
    return running == 0 ? 0 : (double)count * ((double)enabled / (double)running);
}
