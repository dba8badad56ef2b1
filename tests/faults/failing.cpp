// SPDX-License-Identifier: BSD-3-Clause
// Loaded before the C library (LD_PRELOAD), this file makes the system fail.
//
// Each process counts writes, flushes and renames of files whose path contains FAULT_PATH, in which
// * matches any text, and $ the end:
//   FAULT_CALL=name       counts only these calls
//   FAULT_STOP_AT=n       the n-th stops the process before the call, until SIGCONT
//   FAULT_HOUR_AT=n       from the n-th on, the clock that measures intervals is an hour ahead
//   FAULT_KILL_AT=n       the n-th kills the process after half of its data is written
//   FAULT_EIO_AT=n        the n-th fails with an I/O error
//   FAULT_EIO_COUNT=m     the m - 1 calls after it fail as well
//   FAULT_ERRNO=e         they fail with this error instead
// It also counts the allocations of C++ of at least 1 KB:
//   FAULT_NEW_AT=n        the n-th fails
//   FAULT_NEW_COUNT=file  their number is written to this file at the end
// Others:
//   FAULT_LOCKS=e         locks fail with this error (-1: all are granted), namely those
//   FAULT_LOCKS_IN=path   of files whose path contains this
//   FAULT_FOLDERS=e       flushes of folders fail with this error
//   FAULT_CHMOD=e         changes of permissions fail with this error
//   FAULT_CLOCK=s         the time of day is wrong by s seconds from the 20th reading on
//   FAULT_RANK=r          only MPI rank r is affected
#include <cerrno>
#include <csignal>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <dlfcn.h>
#include <fcntl.h>
#include <fnmatch.h>
#include <new>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <time.h>
#include <unistd.h>

namespace {

/* The variable, unless it is meant for another rank. */
const char* value(const char* name) {
    const char* rank = getenv("FAULT_RANK");
    const char* mine = getenv("OMPI_COMM_WORLD_RANK");
    const char* text = getenv(name);
    return rank && (!mine || strcmp(rank, mine) != 0) ? nullptr : text;
}

long number(const char* name) {
    const char* text = value(name);
    return text ? atol(text) : 0;
}

int counts(const char* path, const char* variable = "FAULT_PATH") {
    const char* wanted = getenv(variable);
    char pattern[4096];
    if (!wanted || !path) return 0;
    const int length = strlen(wanted);
    const int ends = length > 0 && wanted[length - 1] == '$';
    snprintf(pattern, sizeof pattern, ends ? "*%.*s" : "*%.*s*", length - ends, wanted);
    return fnmatch(pattern, path, 0) == 0;
}

int fd_counts(int fd, const char* variable = "FAULT_PATH") {
    char link[64], path[4096];
    snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
    const ssize_t length = readlink(link, path, sizeof path - 1);
    if (length <= 0) return 0;
    path[length] = '\0';
    return counts(path, variable);
}

/* With which the locks of a file fail; 0: they work. */
long lock_error(int fd) {
    const long error = number("FAULT_LOCKS");
    return error != 0 && fd_counts(fd, "FAULT_LOCKS_IN") ? error : 0;
}

long ahead_s = 0;

/* 0: continue; 1: fail; 2: end the process. */
int fate(int relevant, const char* call) {
    static long seen = 0;
    const char* only = getenv("FAULT_CALL");
    if (!relevant || (only && strcmp(only, call) != 0)) return 0;
    const long now = __sync_add_and_fetch(&seen, 1);
    if (now == number("FAULT_STOP_AT")) kill(getpid(), SIGSTOP);
    if (now == number("FAULT_HOUR_AT")) ahead_s = 3600;
    if (now == number("FAULT_KILL_AT")) return 2;
    const long first = number("FAULT_EIO_AT"), many = number("FAULT_EIO_COUNT");
    return first > 0 && now >= first && now < first + (many > 0 ? many : 1);
}

#define REAL(name) (reinterpret_cast<decltype(&name)>(dlsym(RTLD_NEXT, #name)))

void end(void) {
    kill(getpid(), SIGKILL);
}

int failed(void) {
    const long error = number("FAULT_ERRNO");
    errno = error > 0 ? static_cast<int>(error) : EIO;
    return -1;
}

} // namespace

extern "C" {

ssize_t write(int fd, const void* data, size_t size) {
    const int f = fate(fd_counts(fd), "write");
    if (f == 2) {
        REAL(write)(fd, data, size / 2);
        end();
    }
    return f ? failed() : REAL(write)(fd, data, size);
}

ssize_t pwrite(int fd, const void* data, size_t size, off_t at) {
    const int f = fate(fd_counts(fd), "pwrite");
    if (f == 2) {
        REAL(pwrite)(fd, data, size / 2, at);
        end();
    }
    return f ? failed() : REAL(pwrite)(fd, data, size, at);
}

ssize_t pwrite64(int fd, const void* data, size_t size, off64_t at) {
    const int f = fate(fd_counts(fd), "pwrite64");
    if (f == 2) {
        REAL(pwrite64)(fd, data, size / 2, at);
        end();
    }
    return f ? failed() : REAL(pwrite64)(fd, data, size, at);
}

int fsync(int fd) {
    struct stat info {};
    if (number("FAULT_FOLDERS") > 0 && fstat(fd, &info) == 0 && S_ISDIR(info.st_mode)) {
        errno = static_cast<int>(number("FAULT_FOLDERS"));
        return -1;
    }
    const int f = fate(fd_counts(fd), "fsync");
    if (f == 2) end();
    return f ? failed() : REAL(fsync)(fd);
}

int rename(const char* from, const char* to) {
    const int f = fate(counts(to), "rename");
    if (f == 2) end();
    return f ? failed() : REAL(rename)(from, to);
}

int chmod(const char* path, mode_t mode) {
    errno = static_cast<int>(number("FAULT_CHMOD"));
    return errno > 0 ? -1 : REAL(chmod)(path, mode);
}

int fchmod(int fd, mode_t mode) {
    errno = static_cast<int>(number("FAULT_CHMOD"));
    return errno > 0 ? -1 : REAL(fchmod)(fd, mode);
}

int fchmodat(int folder, const char* path, mode_t mode, int flags) {
    errno = static_cast<int>(number("FAULT_CHMOD"));
    return errno > 0 ? -1 : REAL(fchmodat)(folder, path, mode, flags);
}

int flock(int fd, int operation) {
    const long error = lock_error(fd);
    if (error == 0) return REAL(flock)(fd, operation);
    errno = static_cast<int>(error);
    return error > 0 ? -1 : 0;
}

int fcntl(int fd, int command, ...) {
    va_list arguments;
    va_start(arguments, command);
    void* argument = va_arg(arguments, void*);
    va_end(arguments);
    const bool locks = command == F_SETLK || command == F_SETLKW || command == F_OFD_SETLK ||
                       command == F_OFD_SETLKW;
    const long error = locks ? lock_error(fd) : 0;
    if (error == 0) return REAL(fcntl)(fd, command, argument);
    errno = static_cast<int>(error);
    return error > 0 ? -1 : 0;
}

int fcntl64(int fd, int command, ...) __attribute__((alias("fcntl")));

int clock_gettime(clockid_t clock, struct timespec* out) {
    static long asked = 0;
    static const auto real = REAL(clock_gettime);
    const int status = real(clock, out);
    if (clock == CLOCK_REALTIME && __sync_add_and_fetch(&asked, 1) > 20)
        out->tv_sec += number("FAULT_CLOCK");
    if (clock == CLOCK_MONOTONIC) out->tv_sec += ahead_s;
    return status;
}

time_t time(time_t* out) {
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    if (out) *out = now.tv_sec;
    return now.tv_sec;
}

} // extern "C"

namespace {

long allocations = 0;

__attribute__((destructor)) void write_count() {
    const char* path = value("FAULT_NEW_COUNT");
    FILE* file = path && allocations > 0 ? fopen(path, "w") : nullptr;
    if (!file) return;
    fprintf(file, "%ld\n", allocations);
    fclose(file);
}

} // namespace

void* operator new(std::size_t size) {
    void* memory = nullptr;
    if (size < 1024 || __sync_add_and_fetch(&allocations, 1) != number("FAULT_NEW_AT"))
        memory = std::malloc(size > 0 ? size : 1);
    if (!memory) throw std::bad_alloc();
    return memory;
}
void operator delete(void* memory) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    std::free(memory);
}
