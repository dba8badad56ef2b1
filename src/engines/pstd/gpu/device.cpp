// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/gpu/device.hpp"

#include "base/error.hpp"
#include "base/units.hpp"

#include <algorithm>
#include <dlfcn.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace shearwake::pstd::gpu {

#define SHEARWAKE_OPENCL_FUNCTIONS(use)                                                            \
    use(clGetPlatformIDs) use(clGetDeviceIDs) use(clGetDeviceInfo) use(clCreateContext)            \
        use(clReleaseContext) use(clCreateCommandQueue) use(clReleaseCommandQueue)                 \
            use(clCreateBuffer) use(clReleaseMemObject) use(clEnqueueWriteBuffer)                  \
                use(clEnqueueReadBuffer) use(clEnqueueCopyBuffer) use(clEnqueueFillBuffer)         \
                    use(clCreateProgramWithSource) use(clBuildProgram) use(clGetProgramBuildInfo)  \
                        use(clReleaseProgram) use(clCreateKernel) use(clReleaseKernel)             \
                            use(clSetKernelArg) use(clEnqueueNDRangeKernel) use(clFinish)

struct Functions {
#define SHEARWAKE_DECLARE(name) decltype(&::name) name = nullptr;
    SHEARWAKE_OPENCL_FUNCTIONS(SHEARWAKE_DECLARE)
#undef SHEARWAKE_DECLARE
};

SignalHandlers::SignalHandlers() {
    for (std::size_t i = 1; i < handlers_.size(); ++i)
        ::sigaction(static_cast<int>(i), nullptr, &handlers_[i]);
}

void SignalHandlers::restore() const {
    for (std::size_t i = 1; i < handlers_.size(); ++i)
        ::sigaction(static_cast<int>(i), &handlers_[i], nullptr);
}

namespace {

Functions load_functions() {
    void* library = ::dlopen("libOpenCL.so.1", RTLD_NOW | RTLD_LOCAL);
    if (!library)
        throw CaseFailure(fmt::format("device \"gpu\" requires OpenCL: {}; install the driver of "
                                      "the GPU and a loader of OpenCL (ocl-icd-libopencl1)",
                                      ::dlerror()));
    Functions loaded;
    const auto load = [&](auto& function, const char* name) {
        function =
            reinterpret_cast<std::remove_reference_t<decltype(function)>>(::dlsym(library, name));
        if (!function) throw CaseFailure(fmt::format("libOpenCL.so.1 has no function {}", name));
    };
#define SHEARWAKE_LOAD(name) load(loaded.name, #name);
    SHEARWAKE_OPENCL_FUNCTIONS(SHEARWAKE_LOAD)
#undef SHEARWAKE_LOAD
    return loaded;
}

const Functions& functions() {
    static const Functions loaded = load_functions();
    return loaded;
}

std::string error_name(cl_int code) {
    constexpr std::pair<cl_int, const char*> names[] = {
        {CL_DEVICE_NOT_AVAILABLE, "the device is not available"},
        {CL_COMPILER_NOT_AVAILABLE, "the driver has no compiler"},
        {CL_MEM_OBJECT_ALLOCATION_FAILURE, "the memory of the device is exhausted"},
        {CL_OUT_OF_RESOURCES, "the resources of the device are exhausted, or a kernel failed"},
        {CL_OUT_OF_HOST_MEMORY, "the memory of the host is exhausted"},
        {CL_BUILD_PROGRAM_FAILURE, "the kernels were not compiled"},
        {CL_INVALID_BUFFER_SIZE, "an array is larger than the device supports"}};
    for (const auto& [known, name] : names)
        if (known == code) return fmt::format("{} (OpenCL error {})", name, code);
    return fmt::format("OpenCL error {}", code);
}

template <class T>
T fact_of(const Functions& cl, cl_device_id id, cl_device_info which) {
    T value{};
    cl.clGetDeviceInfo(id, which, sizeof value, &value, nullptr);
    return value;
}

std::string text_of(const Functions& cl, cl_device_id id, cl_device_info which) {
    std::size_t size = 0;
    cl.clGetDeviceInfo(id, which, 0, nullptr, &size);
    std::string text(size, '\0');
    cl.clGetDeviceInfo(id, which, size, text.data(), nullptr);
    return text.c_str(); // without the zero at the end
}

/// The devices of all drivers, those that are GPUs first.
std::vector<cl_device_id> all_devices(const Functions& cl) {
    std::vector<cl_device_id> found;
    cl_uint count = 0;
    if (cl.clGetPlatformIDs(0, nullptr, &count) != CL_SUCCESS) count = 0;
    std::vector<cl_platform_id> platforms(count);
    if (count > 0) cl.clGetPlatformIDs(count, platforms.data(), nullptr);
    for (cl_platform_id platform : platforms) {
        if (cl.clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 0, nullptr, &count) != CL_SUCCESS)
            continue;
        std::vector<cl_device_id> some(count);
        cl.clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, count, some.data(), nullptr);
        found.insert(found.end(), some.begin(), some.end());
    }
    std::stable_partition(found.begin(), found.end(), [&](cl_device_id id) {
        return (fact_of<cl_device_type>(cl, id, CL_DEVICE_TYPE) & CL_DEVICE_TYPE_GPU) != 0;
    });
    return found;
}

cl_device_id choose_device(const Functions& cl, int number, int rank) {
    const std::vector<cl_device_id> all = all_devices(cl);
    const auto is_gpu = [&](cl_device_id id) {
        return (fact_of<cl_device_type>(cl, id, CL_DEVICE_TYPE) & CL_DEVICE_TYPE_GPU) != 0;
    };
    const auto gpus = static_cast<std::size_t>(std::count_if(all.begin(), all.end(), is_gpu));
    if (all.empty())
        throw CaseFailure("device \"gpu\": the drivers of OpenCL offer no device; `clinfo` lists "
                          "what they find");
    if (number >= static_cast<int>(all.size())) {
        std::vector<std::string> lines;
        for (std::size_t i = 0; i < all.size(); ++i)
            lines.push_back(fmt::format("{}: {}", i, text_of(cl, all[i], CL_DEVICE_NAME)));
        throw CaseFailure(fmt::format("there is no device {}; the devices are {}", number,
                                      fmt::join(lines, ", ")));
    }
    return number >= 0 ? all[static_cast<std::size_t>(number)]
                       : all[static_cast<std::size_t>(rank) % (gpus > 0 ? gpus : all.size())];
}

} // namespace

Device::Device(int number, int rank)
    : cl_(functions()), id_(choose_device(cl_, number, rank)), context_(nullptr, nullptr),
      queue_(nullptr, nullptr) {
    cl_int code = CL_SUCCESS;
    context_ = {cl_.clCreateContext(nullptr, 1, &id_, nullptr, nullptr, &code),
                cl_.clReleaseContext};
    check(code, "opening it");
    queue_ = {cl_.clCreateCommandQueue(context_.get(), id_, 0, &code), cl_.clReleaseCommandQueue};
    check(code, "making a queue");
}

std::string Device::name() const {
    return fmt::format("{} (driver {})", text_of(cl_, id_, CL_DEVICE_NAME),
                       text_of(cl_, id_, CL_DRIVER_VERSION));
}
double Device::memory_B() const {
    return static_cast<double>(fact_of<cl_ulong>(cl_, id_, CL_DEVICE_GLOBAL_MEM_SIZE));
}
double Device::most_array_B() const {
    return static_cast<double>(fact_of<cl_ulong>(cl_, id_, CL_DEVICE_MAX_MEM_ALLOC_SIZE));
}
std::size_t Device::local_B() const {
    return fact_of<cl_ulong>(cl_, id_, CL_DEVICE_LOCAL_MEM_SIZE);
}
bool Device::has_doubles() const {
    return text_of(cl_, id_, CL_DEVICE_EXTENSIONS).find("cl_khr_fp64") != std::string::npos;
}

void Device::check(cl_int code, const std::string& what) const {
    if (code != CL_SUCCESS)
        throw CaseFailure(fmt::format("device {}: {} failed: {}", text_of(cl_, id_, CL_DEVICE_NAME),
                                      what, error_name(code)));
}

Handle<cl_mem> Device::allocate(std::size_t bytes) const {
    cl_int code = CL_SUCCESS;
    Handle<cl_mem> memory{
        cl_.clCreateBuffer(context_.get(), CL_MEM_READ_WRITE, bytes, nullptr, &code),
        cl_.clReleaseMemObject};
    check(code, fmt::format("allocating {:.3g} MB", 1e-6 * static_cast<double>(bytes)));
    return memory;
}

void Device::clear(cl_mem memory, std::size_t bytes) const {
    const cl_uint zero = 0;
    if (bytes == 0) return;
    check(cl_.clEnqueueFillBuffer(queue_.get(), memory, &zero, bytes % 4 == 0 ? 4 : 1, 0, bytes, 0,
                                  nullptr, nullptr),
          "clearing an array");
}

void Device::write(cl_mem to, std::size_t bytes, const void* values) const {
    if (bytes == 0) return;
    check(
        cl_.clEnqueueWriteBuffer(queue_.get(), to, CL_TRUE, 0, bytes, values, 0, nullptr, nullptr),
        "copying to it");
}

void Device::read(cl_mem from, std::size_t bytes, void* values) const {
    if (bytes == 0) return;
    check(
        cl_.clEnqueueReadBuffer(queue_.get(), from, CL_TRUE, 0, bytes, values, 0, nullptr, nullptr),
        "copying from it");
}

Program Device::compile(const std::string& text, const std::string& options,
                        std::size_t real_B) const {
    const char *real = real_B == 8 ? "double" : "float", *sum = has_doubles() ? "double" : "float";
    const std::string all =
        fmt::format("{}typedef {} Real;\ntypedef {}2 Real2;\ntypedef {} Sum;\n",
                    has_doubles() ? "#pragma OPENCL EXTENSION cl_khr_fp64 : enable\n" : "", real,
                    real, sum) +
        text;
    const char* source = all.c_str();
    cl_int code = CL_SUCCESS;
    Program program{cl_.clCreateProgramWithSource(context_.get(), 1, &source, nullptr, &code),
                    cl_.clReleaseProgram};
    check(code, "loading kernels");
    code = cl_.clBuildProgram(program.get(), 1, &id_, ("-cl-std=CL1.2 " + options).c_str(), nullptr,
                              nullptr);
    if (code == CL_SUCCESS) return program;
    std::string log(16384, '\0');
    cl_.clGetProgramBuildInfo(program.get(), id_, CL_PROGRAM_BUILD_LOG, log.size(), log.data(),
                              nullptr);
    check(code, "compiling kernels (" + std::string(log.c_str()) + ")");
    return program;
}

Buffer<char> Device::uploaded_sums(const std::vector<double>& values) const {
    Buffer<char> made = buffer<char>(values.size() * (has_doubles() ? 8 : 4));
    if (has_doubles())
        write(made.raw(), 8 * values.size(), values.data());
    else
        write(made.raw(), 4 * values.size(),
              std::vector<float>(values.begin(), values.end()).data());
    return made;
}

std::vector<double> Device::read_sums(const Buffer<char>& from) const {
    if (!has_doubles()) {
        std::vector<float> narrow(from.size() / 4);
        read(from.raw(), from.size(), narrow.data());
        return {narrow.begin(), narrow.end()};
    }
    std::vector<double> values(from.size() / 8);
    read(from.raw(), from.size(), values.data());
    return values;
}

Kernel Device::kernel(const Program& program, const char* name) const {
    cl_int code = CL_SUCCESS;
    Kernel kernel{{cl_.clCreateKernel(program.get(), name, &code), cl_.clReleaseKernel}, name};
    check(code, fmt::format("loading kernel {}", name));
    return kernel;
}

void Device::set_argument(const Kernel& kernel, cl_uint index, std::size_t size,
                          const void* value) const {
    check(cl_.clSetKernelArg(kernel.kernel.get(), index, size, value),
          fmt::format("passing argument {} to kernel {}", index, kernel.name));
}

void Device::enqueue(const Kernel& kernel, Range items, Range group) const {
    for (std::size_t i = 0; i < items.size(); ++i)
        items[i] = (items[i] + group[i] - 1) / group[i] * group[i];
    if (items[0] * items[1] * items[2] == 0) return;
    check(cl_.clEnqueueNDRangeKernel(queue_.get(), kernel.kernel.get(), 3, nullptr, items.data(),
                                     group.data(), 0, nullptr, nullptr),
          "starting kernel " + kernel.name);
}

void Device::finish() const {
    check(cl_.clFinish(queue_.get()), "completing its work");
}

double Device::measured_copies_B_s() const {
    const std::size_t size =
        std::min<std::size_t>(std::size_t{1} << 28, static_cast<std::size_t>(memory_B()) / 64);
    const Buffer<char> from = zeros<char>(size), to = zeros<char>(size);
    double best_s = 1e300;
    for (int i = 0; i < 5; ++i) {
        const auto began = Clock::now();
        check(cl_.clEnqueueCopyBuffer(queue_.get(), from.raw(), to.raw(), 0, 0, size, 0, nullptr,
                                      nullptr),
              "copying an array");
        finish();
        best_s = std::min(best_s, seconds_since(began));
    }
    return 2.0 * static_cast<double>(size) / best_s;
}

} // namespace shearwake::pstd::gpu
