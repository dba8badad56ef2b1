// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/gpu/device.hpp"

#include "base/error.hpp"
#include "base/units.hpp"

#include <algorithm>
#include <dlfcn.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace shearwake::pstd::gpu {

SignalHandlers::SignalHandlers() {
    for (std::size_t i = 1; i < handlers_.size(); ++i)
        ::sigaction(static_cast<int>(i), nullptr, &handlers_[i]);
}

void SignalHandlers::restore() const {
    for (std::size_t i = 1; i < handlers_.size(); ++i)
        ::sigaction(static_cast<int>(i), &handlers_[i], nullptr);
}

namespace {

void* symbol_of(const char* name) {
    static void* const library = [] {
        if (void* loaded = ::dlopen("libOpenCL.so.1", RTLD_NOW | RTLD_LOCAL)) return loaded;
        throw CaseFailure(fmt::format("device \"gpu\" requires OpenCL: {}; install the driver of "
                                      "the GPU and a loader of OpenCL (ocl-icd-libopencl1)",
                                      ::dlerror()));
    }();
    void* found = ::dlsym(library, name);
    if (!found) throw CaseFailure(fmt::format("libOpenCL.so.1 has no function {}", name));
    return found;
}

/// A function of OpenCL, which is looked up when it is called for the first time.
#define CL(name)                                                                                   \
    ([] {                                                                                          \
        static const auto function = reinterpret_cast<decltype(&::name)>(symbol_of(#name));        \
        return function;                                                                           \
    }())

std::string error_name(cl_int code) {
    constexpr std::pair<cl_int, const char*> names[] = {
        {CL_DEVICE_NOT_AVAILABLE, "the device is not available"},
        {CL_MEM_OBJECT_ALLOCATION_FAILURE, "the memory of the device is exhausted"},
        {CL_OUT_OF_RESOURCES, "the resources of the device are exhausted, or a kernel failed"}};
    for (const auto& [known, name] : names)
        if (known == code) return fmt::format("{} (OpenCL error {})", name, code);
    return fmt::format("OpenCL error {}", code);
}

template <class T>
T fact_of(cl_device_id id, cl_device_info which) {
    T value{};
    CL(clGetDeviceInfo)(id, which, sizeof value, &value, nullptr);
    return value;
}

std::string text_of(cl_device_id id, cl_device_info which) {
    std::size_t size = 0;
    CL(clGetDeviceInfo)(id, which, 0, nullptr, &size);
    std::string text(size, '\0');
    CL(clGetDeviceInfo)(id, which, size, text.data(), nullptr);
    return text.c_str(); // without the zero at the end
}

cl_device_id choose_device(int number, int rank) {
    cl_uint count = 0;
    if (CL(clGetPlatformIDs)(0, nullptr, &count) != CL_SUCCESS) count = 0;
    std::vector<cl_platform_id> platforms(count);
    if (count > 0) CL(clGetPlatformIDs)(count, platforms.data(), nullptr);
    std::vector<cl_device_id> all;
    std::size_t in_turn = 0; // GPUs if there are any, or all devices
    constexpr cl_device_type types[] = {CL_DEVICE_TYPE_GPU,
                                        CL_DEVICE_TYPE_CPU | CL_DEVICE_TYPE_ACCELERATOR};
    for (const cl_device_type type : types) {
        for (cl_platform_id platform : platforms) {
            if (CL(clGetDeviceIDs)(platform, type, 0, nullptr, &count) != CL_SUCCESS) continue;
            all.resize(all.size() + count);
            CL(clGetDeviceIDs)(platform, type, count, all.data() + all.size() - count, nullptr);
        }
        if (in_turn == 0) in_turn = all.size();
    }
    if (all.empty())
        throw CaseFailure("device \"gpu\": the drivers of OpenCL offer no device; `clinfo` lists "
                          "what they find");
    if (number < 0) return all[static_cast<std::size_t>(rank) % in_turn];
    if (number < std::ssize(all)) return all[static_cast<std::size_t>(number)];
    std::vector<std::string> lines;
    for (cl_device_id id : all)
        lines.push_back(fmt::format("{}: {}", lines.size(), text_of(id, CL_DEVICE_NAME)));
    throw CaseFailure(
        fmt::format("there is no device {}; the devices are {}", number, fmt::join(lines, ", ")));
}

DeviceFacts facts_of(cl_device_id id, std::size_t real_B) {
    const bool has_doubles =
        text_of(id, CL_DEVICE_EXTENSIONS).find("cl_khr_fp64") != std::string::npos;
    return {.name = fmt::format("{} (driver {})", text_of(id, CL_DEVICE_NAME),
                                text_of(id, CL_DRIVER_VERSION)),
            .memory_B = static_cast<double>(fact_of<cl_ulong>(id, CL_DEVICE_GLOBAL_MEM_SIZE)),
            .most_array_B =
                static_cast<double>(fact_of<cl_ulong>(id, CL_DEVICE_MAX_MEM_ALLOC_SIZE)),
            .local_B = fact_of<cl_ulong>(id, CL_DEVICE_LOCAL_MEM_SIZE),
            .real_B = real_B,
            .sum_B = has_doubles ? sizeof(double) : sizeof(float)};
}

} // namespace

Device::Device(int number, int rank, std::size_t real_B)
    : id_(choose_device(number, rank)), facts_(facts_of(id_, real_B)) {
    if (real_B > facts_.sum_B)
        throw CaseFailure(fmt::format("device {} has no double precision; use precision = "
                                      "\"single\"",
                                      facts_.name));
    cl_int code = CL_SUCCESS;
    context_ = {CL(clCreateContext)(nullptr, 1, &id_, nullptr, nullptr, &code),
                CL(clReleaseContext)};
    check(code, "opening it");
    queue_ = {CL(clCreateCommandQueue)(context_.get(), id_, 0, &code), CL(clReleaseCommandQueue)};
    check(code, "making a queue");
}

void Device::check(cl_int code, const std::string& what) const {
    if (code != CL_SUCCESS)
        throw CaseFailure(
            fmt::format("device {}: {} failed: {}", facts_.name, what, error_name(code)));
}

Buffer Device::zeros(std::size_t size, std::size_t value_B) const {
    const std::size_t bytes = size * value_B;
    const cl_uint zero = 0;
    cl_int code = CL_SUCCESS;
    Buffer made{size,
                value_B,
                {CL(clCreateBuffer)(context_.get(), CL_MEM_READ_WRITE,
                                    std::max<std::size_t>(bytes, 1), nullptr, &code),
                 CL(clReleaseMemObject)}};
    check(code, fmt::format("allocating {:.3g} MB", 1e-6 * static_cast<double>(bytes)));
    if (bytes > 0)
        check(CL(clEnqueueFillBuffer)(queue_.get(), made.memory.get(), &zero, sizeof zero, 0, bytes,
                                      0, nullptr, nullptr),
              "clearing an array");
    return made;
}

Buffer Device::numbers(const std::vector<double>& values, std::size_t value_B) const {
    Buffer made = zeros(values.size(), value_B);
    write(made, values);
    return made;
}

void Device::copy_to(const Buffer& to, std::size_t bytes, const void* values) const {
    if (bytes > 0)
        check(CL(clEnqueueWriteBuffer)(queue_.get(), to.memory.get(), CL_TRUE, 0, bytes, values, 0,
                                       nullptr, nullptr),
              "copying to it");
}

void Device::write(const Buffer& to, const std::vector<double>& values) const {
    const std::size_t bytes = values.size() * to.value_B;
    if (to.value_B == sizeof(double)) return copy_to(to, bytes, values.data());
    copy_to(to, bytes, std::vector<float>(values.begin(), values.end()).data());
}

std::vector<double> Device::read(const Buffer& from) const {
    std::vector<double> values(from.size);
    std::vector<float> narrow(from.value_B == sizeof(float) ? from.size : 0);
    void* to = narrow.empty() ? static_cast<void*>(values.data()) : narrow.data();
    if (from.size > 0)
        check(CL(clEnqueueReadBuffer)(queue_.get(), from.memory.get(), CL_TRUE, 0, from.bytes(), to,
                                      0, nullptr, nullptr),
              "copying from it");
    std::copy(narrow.begin(), narrow.end(), values.begin());
    return values;
}

Kernels Device::compile(const std::string& text, const std::string& options,
                        const std::vector<std::string>& names) const {
    const char *real = facts_.real_B == 8 ? "double" : "float",
               *sum = facts_.sum_B == 8 ? "double" : "float";
    const std::string all =
        fmt::format("{0}typedef {1} Real;\ntypedef {1}2 Real2;\ntypedef {1}3 Real3;\n"
                    "typedef {2} Sum;\n{3}",
                    facts_.sum_B == 8 ? "#pragma OPENCL EXTENSION cl_khr_fp64 : enable\n" : "",
                    real, sum, text);
    const char* source = all.c_str();
    cl_int code = CL_SUCCESS;
    const Handle<cl_program> program{
        CL(clCreateProgramWithSource)(context_.get(), 1, &source, nullptr, &code),
        CL(clReleaseProgram)};
    check(code, "loading kernels");
    code = CL(clBuildProgram)(program.get(), 1, &id_, ("-cl-std=CL1.2 " + options).c_str(), nullptr,
                              nullptr);
    if (code != CL_SUCCESS) {
        std::string log(16384, '\0');
        CL(clGetProgramBuildInfo)
        (program.get(), id_, CL_PROGRAM_BUILD_LOG, log.size(), log.data(), nullptr);
        check(code, "compiling kernels (" + std::string(log.c_str()) + ")");
    }
    Kernels kernels;
    for (const std::string& name : names) {
        Kernel kernel{
            name, {CL(clCreateKernel)(program.get(), name.c_str(), &code), CL(clReleaseKernel)}};
        check(code, fmt::format("loading kernel {}", name));
        kernels.emplace(name, std::move(kernel));
    }
    return kernels;
}

void Device::set_argument(const Kernel& kernel, cl_uint index, std::size_t size,
                          const void* value) const {
    check(CL(clSetKernelArg)(kernel.kernel.get(), index, size, value),
          fmt::format("passing argument {} to kernel {}", index, kernel.name));
}

void Device::set(const Kernel& kernel, cl_uint& index, const Buffer& buffer) const {
    cl_mem memory = buffer.memory.get();
    if (memory)
        set_argument(kernel, index++, sizeof memory, &memory);
    else
        set_argument(kernel, index++, buffer.bytes(), nullptr);
}

void Device::enqueue(const Kernel& kernel, Range items, Range group) const {
    for (std::size_t i = 0; i < items.size(); ++i)
        items[i] = (items[i] + group[i] - 1) / group[i] * group[i];
    if (items[0] * items[1] * items[2] == 0) return;
    check(CL(clEnqueueNDRangeKernel)(queue_.get(), kernel.kernel.get(), 3, nullptr, items.data(),
                                     group.data(), 0, nullptr, nullptr),
          "starting kernel " + kernel.name);
}

void Device::finish() const {
    check(CL(clFinish)(queue_.get()), "completing its work");
}

double Device::measured_copies_B_s() const {
    const Buffer from = zeros(
        std::min<std::size_t>(1 << 28, static_cast<std::size_t>(facts_.memory_B) / 64) / 8, 8);
    const Buffer to = zeros(from.size, 8);
    double best_s = 1e300;
    for (int i = 0; i < 5; ++i) {
        const auto began = Clock::now();
        check(CL(clEnqueueCopyBuffer)(queue_.get(), from.memory.get(), to.memory.get(), 0, 0,
                                      from.bytes(), 0, nullptr, nullptr),
              "copying an array");
        finish();
        best_s = std::min(best_s, seconds_since(began));
    }
    return 2.0 * static_cast<double>(from.bytes()) / best_s;
}

} // namespace shearwake::pstd::gpu
