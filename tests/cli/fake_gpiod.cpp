// SPDX-License-Identifier: MIT
// A stand-in for libgpiod, of either version (LD_PRELOAD): /dev/null is a chip, and the one byte of the file
// TACTOR_LINE is the state of its line, '0' or '1'. The process that has the file open holds the line.
#include <cerrno>
#include <cstdlib>
#include <cstring>

#include <dlfcn.h>
#include <fcntl.h>
#include <gpiod.h>
#include <unistd.h>

namespace {

int line_fd = -1;

/// Each of the library's objects exists once and is empty.
template <class T>
T* the() noexcept
{
    return reinterpret_cast<T*>(&line_fd);
}

int put(bool on) noexcept
{
    return ::pwrite(line_fd, on ? "1" : "0", 1, 0) == 1 ? 0 : -1;
}

int take_line() noexcept
{
    line_fd = ::open(std::getenv("TACTOR_LINE"), O_RDWR | O_CLOEXEC);
    return line_fd < 0 ? -1 : put(false);
}

} // namespace

/// Puts /dev/null on the bus of GPIO chips, as the kernel would say.
extern "C" char* realpath(const char* path, char* resolved)
{
    if (resolved == nullptr && std::strcmp(path, "/sys/dev/char/1:3/subsystem") == 0)
        return ::strdup("/sys/bus/gpio");
    return reinterpret_cast<char* (*)(const char*, char*)>(::dlsym(RTLD_NEXT, "realpath"))(path, resolved);
}

gpiod_chip* gpiod_chip_open(const char* path)
{
    if (std::strcmp(path, "/dev/null") == 0)
        return the<gpiod_chip>();
    errno = ENOENT;
    return nullptr;
}

void gpiod_chip_close(gpiod_chip*)
{
}

#ifdef GPIOD_LINE_BULK_MAX_LINES // version 1

const char* gpiod_chip_name(gpiod_chip*)
{
    return "fake";
}

const char* gpiod_chip_label(gpiod_chip*)
{
    return "fake";
}

unsigned int gpiod_chip_num_lines(gpiod_chip*)
{
    return 1;
}

gpiod_line* gpiod_chip_get_line(gpiod_chip*, unsigned int)
{
    return the<gpiod_line>();
}

unsigned int gpiod_line_offset(gpiod_line*)
{
    return 0;
}

const char* gpiod_line_name(gpiod_line*)
{
    return "line";
}

const char* gpiod_line_consumer(gpiod_line*)
{
    return nullptr;
}

bool gpiod_line_is_used(gpiod_line*)
{
    return false;
}

int gpiod_line_direction(gpiod_line*)
{
    return GPIOD_LINE_DIRECTION_OUTPUT;
}

int gpiod_line_request_output_flags(gpiod_line*, const char*, int, int)
{
    return take_line();
}

int gpiod_line_set_value(gpiod_line*, int value)
{
    return put(value != 0);
}

#else

gpiod_chip_info* gpiod_chip_get_info(gpiod_chip*)
{
    return the<gpiod_chip_info>();
}

void gpiod_chip_info_free(gpiod_chip_info*)
{
}

const char* gpiod_chip_info_get_name(gpiod_chip_info*)
{
    return "fake";
}

const char* gpiod_chip_info_get_label(gpiod_chip_info*)
{
    return "fake";
}

size_t gpiod_chip_info_get_num_lines(gpiod_chip_info*)
{
    return 1;
}

gpiod_line_info* gpiod_chip_get_line_info(gpiod_chip*, unsigned int)
{
    return the<gpiod_line_info>();
}

void gpiod_line_info_free(gpiod_line_info*)
{
}

unsigned int gpiod_line_info_get_offset(gpiod_line_info*)
{
    return 0;
}

const char* gpiod_line_info_get_name(gpiod_line_info*)
{
    return "line";
}

const char* gpiod_line_info_get_consumer(gpiod_line_info*)
{
    return nullptr;
}

bool gpiod_line_info_is_used(gpiod_line_info*)
{
    return false;
}

gpiod_line_direction gpiod_line_info_get_direction(gpiod_line_info*)
{
    return GPIOD_LINE_DIRECTION_OUTPUT;
}

gpiod_line_request* gpiod_chip_request_lines(gpiod_chip*, gpiod_request_config*, gpiod_line_config*)
{
    return take_line() == 0 ? the<gpiod_line_request>() : nullptr;
}

void gpiod_line_request_release(gpiod_line_request*)
{
}

int gpiod_line_request_get_fd(gpiod_line_request*)
{
    return line_fd;
}

int gpiod_line_request_set_value(gpiod_line_request*, unsigned int, gpiod_line_value value)
{
    return put(value == GPIOD_LINE_VALUE_ACTIVE);
}

#endif
