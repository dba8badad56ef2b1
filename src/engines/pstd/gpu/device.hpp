// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <memory>
#include <signal.h>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

namespace shearwake::pstd::gpu {

/// The functions of OpenCL that are used. The library is loaded when a device is opened, so that a
/// program that uses no GPU never loads it or the compilers of its drivers.
struct Functions;

/// The handlers of signals when it is made. LLVM, with which drivers such as pocl compile, replaces
/// some of them, so that no signal would stop a run.
class SignalHandlers {
public:
    SignalHandlers();
    void restore() const;

private:
    std::array<struct sigaction, 32> handlers_ = {};
};

/// Owns an object of OpenCL.
template <class T>
using Handle = std::unique_ptr<std::remove_pointer_t<T>, cl_int(CL_API_CALL*)(T)>;

/// An array on a device.
template <class T>
class Buffer {
public:
    Buffer() : memory_(nullptr, nullptr) {}
    Buffer(Handle<cl_mem> memory, std::size_t size) : memory_(std::move(memory)), size_(size) {}
    cl_mem raw() const { return memory_.get(); }
    std::size_t size() const { return size_; }

private:
    Handle<cl_mem> memory_;
    std::size_t size_ = 0;
};

/// Bytes of local memory as an argument of a kernel.
struct LocalMemory {
    std::size_t bytes;
};

struct Kernel {
    Handle<cl_kernel> kernel = {nullptr, nullptr};
    std::string name = {};
};

/// Compiled kernels.
using Program = Handle<cl_program>;

/// A device with a queue whose commands run in order. Every function throws CaseFailure with the
/// name of the device if a command fails, also one that was enqueued before. Not collective.
class Device {
public:
    using Range = std::array<std::size_t, 3>;

    /// `number`: of the devices of all drivers, those that are GPUs first; below 0 the one whose
    /// turn it is for `rank`, a rank of this machine. The message of a missing one lists the
    /// devices.
    Device(int number, int rank);

    std::string name() const;
    double memory_B() const;
    double most_array_B() const;
    std::size_t local_B() const;
    bool has_doubles() const;

    template <class T>
    Buffer<T> buffer(std::size_t size) const {
        return {allocate(std::max<std::size_t>(size, 1) * sizeof(T)), size};
    }
    template <class T>
    Buffer<T> zeros(std::size_t size) const {
        Buffer<T> made = buffer<T>(size);
        clear(made.raw(), size * sizeof(T));
        return made;
    }
    template <class Values>
    auto uploaded(const Values& values) const {
        using T = typename Values::value_type;
        Buffer<T> made = buffer<T>(values.size());
        write(made, values);
        return made;
    }
    /// Both wait for the commands before, and return when the values are there.
    template <class T, class Values>
    void write(const Buffer<T>& to, const Values& values) const {
        write(to.raw(), values.size() * sizeof(T), values.data());
    }
    template <class T>
    std::vector<T> read(const Buffer<T>& from) const {
        std::vector<T> values(from.size());
        read(from.raw(), values.size() * sizeof(T), values.data());
        return values;
    }

    /// The types of the kernels, Real of this many bytes, Sum of 8 if the device has doubles,
    /// precede the text.
    Program compile(const std::string& text, const std::string& options, std::size_t real_B) const;
    /// Arrays of Sum.
    Buffer<char> uploaded_sums(const std::vector<double>& values) const;
    std::vector<double> read_sums(const Buffer<char>& from) const;
    Kernel kernel(const Program& program, const char* name) const;
    /// Enqueues `items` work items, rounded up to groups of `group`. Arguments are buffers,
    /// numbers, local memory, and tuples of them.
    template <class... Arguments>
    void run(const Kernel& kernel, Range items, Range group, const Arguments&... arguments) const {
        cl_uint index = 0;
        (set(kernel, index, arguments), ...);
        enqueue(kernel, items, group);
    }
    void finish() const;
    /// Bytes per second that copies of an array read and write.
    double measured_copies_B_s() const;

private:
    void check(cl_int code, const std::string& what) const;
    Handle<cl_mem> allocate(std::size_t bytes) const;
    void clear(cl_mem memory, std::size_t bytes) const;
    void write(cl_mem to, std::size_t bytes, const void* values) const;
    void read(cl_mem from, std::size_t bytes, void* values) const;
    void enqueue(const Kernel& kernel, Range items, Range group) const;
    void set_argument(const Kernel& kernel, cl_uint index, std::size_t size,
                      const void* value) const;
    template <class T>
    void set(const Kernel& kernel, cl_uint& index, const Buffer<T>& buffer) const {
        cl_mem memory = buffer.raw();
        set_argument(kernel, index++, sizeof(cl_mem), &memory);
    }
    void set(const Kernel& kernel, cl_uint& index, const LocalMemory& local) const {
        set_argument(kernel, index++, local.bytes, nullptr);
    }
    template <class... T>
    void set(const Kernel& kernel, cl_uint& index, const std::tuple<T...>& several) const {
        std::apply([&](const auto&... each) { (set(kernel, index, each), ...); }, several);
    }
    template <class T>
    void set(const Kernel& kernel, cl_uint& index, const T& value) const {
        static_assert(std::is_arithmetic_v<T>);
        set_argument(kernel, index++, sizeof value, &value);
    }

    const Functions& cl_;
    cl_device_id id_ = nullptr;
    Handle<cl_context> context_;
    Handle<cl_command_queue> queue_;
};

} // namespace shearwake::pstd::gpu
