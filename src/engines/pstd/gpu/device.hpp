// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

#include <array>
#include <concepts>
#include <cstddef>
#include <map>
#include <memory>
#include <signal.h>
#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

namespace shearwake::pstd::gpu {

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

/// An array on a device: numbers, which have 4 or 8 bytes, or structures. Without memory it stands
/// for local memory as an argument of a kernel.
struct Buffer {
    std::size_t size = 0, value_B = 0;
    Handle<cl_mem> memory = {nullptr, nullptr};
    std::size_t bytes() const { return size * value_B; }
};

struct Kernel {
    std::string name;
    Handle<cl_kernel> kernel;
};
using Kernels = std::map<std::string, Kernel>; // by name

/// The kernels know two types of numbers: Real, of `real_B` bytes, and Sum, double precision if the
/// device has it.
struct DeviceFacts {
    std::string name; // and driver
    double memory_B, most_array_B;
    std::size_t local_B, real_B, sum_B;
};

/// A device with a queue whose commands run in order. Every function throws CaseFailure with the
/// name of the device if a command fails, also one that was enqueued before. The library of OpenCL
/// is loaded when a device is opened, so that a program that uses no GPU never loads it or the
/// compilers of its drivers. Not collective.
class Device {
public:
    using Range = std::array<std::size_t, 3>;

    /// `number`: of the devices of all drivers, those that are GPUs first; below 0 the one whose
    /// turn it is for `rank`, a rank of this machine. The message of a missing one lists the
    /// devices. Throws CaseFailure if `real_B` is 8 and the device has no double precision.
    Device(int number, int rank, std::size_t real_B);
    const DeviceFacts& facts() const { return facts_; }

    Buffer zeros(std::size_t size, std::size_t value_B) const;
    /// Numbers of `value_B` bytes.
    Buffer numbers(const std::vector<double>& values, std::size_t value_B) const;
    /// Values as they are.
    template <class Values>
    Buffer uploaded(const Values& values) const {
        Buffer made = zeros(values.size(), sizeof(typename Values::value_type));
        copy_to(made, made.bytes(), values.data());
        return made;
    }
    /// Both convert numbers, wait for the commands before, and return when the values are there.
    void write(const Buffer& to, const std::vector<double>& values) const;
    std::vector<double> read(const Buffer& from) const;

    /// The types of the kernels precede the text.
    Kernels compile(const std::string& text, const std::string& options,
                    const std::vector<std::string>& names) const;
    /// Enqueues `items` work items, rounded up to groups of `group`. Arguments are arrays,
    /// integers, and tuples of them.
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
    void copy_to(const Buffer& to, std::size_t bytes, const void* values) const;
    void enqueue(const Kernel& kernel, Range items, Range group) const;
    void set_argument(const Kernel& kernel, cl_uint index, std::size_t size,
                      const void* value) const;
    void set(const Kernel& kernel, cl_uint& index, const Buffer& buffer) const;
    void set(const Kernel& kernel, cl_uint& index, std::integral auto value) const {
        set_argument(kernel, index++, sizeof value, &value);
    }
    template <class... T>
    void set(const Kernel& kernel, cl_uint& index, const std::tuple<T...>& several) const {
        std::apply([&](const auto&... each) { (set(kernel, index, each), ...); }, several);
    }

    cl_device_id id_ = nullptr;
    DeviceFacts facts_;
    Handle<cl_context> context_ = {nullptr, nullptr};
    Handle<cl_command_queue> queue_ = {nullptr, nullptr};
};

} // namespace shearwake::pstd::gpu
