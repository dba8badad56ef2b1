// SPDX-License-Identifier: BSD-3-Clause
// A library of OpenCL that is linked with the one of the system under the name libRealCL.so.1, and
// fails:
//   FAULT_KERNEL_AT=n             the n-th kernel and those after it find no device
//   FAULT_ARRAY_AT=n              the n-th array finds no memory
//   FAULT_SIZES_IN=file           appends the sizes in bytes of arrays before the first kernel
//   FAULT_MEMORY_B=b, _LOCAL_B=b  the device has this memory, or this local memory
#define CL_TARGET_OPENCL_VERSION 120
#include <CL/cl.h>

#include <cstdio>
#include <cstdlib>
#include <dlfcn.h>

namespace {

template <class Function>
Function* original(Function*, const char* name) {
    return reinterpret_cast<Function*>(dlsym(dlopen("libRealCL.so.1", RTLD_NOW), name));
}

long number(const char* name) {
    const char* text = getenv(name);
    return text ? atol(text) : 0;
}

long kernels = 0;

} // namespace

extern "C" {

cl_int clGetDeviceInfo(cl_device_id device, cl_device_info what, size_t size, void* value,
                       size_t* used) {
    const cl_int code =
        original(clGetDeviceInfo, "clGetDeviceInfo")(device, what, size, value, used);
    const long limit = what == CL_DEVICE_GLOBAL_MEM_SIZE  ? number("FAULT_MEMORY_B")
                       : what == CL_DEVICE_LOCAL_MEM_SIZE ? number("FAULT_LOCAL_B")
                                                          : 0;
    if (limit > 0 && value) *static_cast<cl_ulong*>(value) = static_cast<cl_ulong>(limit);
    return code;
}

cl_mem clCreateBuffer(cl_context context, cl_mem_flags flags, size_t size, void* host,
                      cl_int* code) {
    static long count = 0;
    if (++count == number("FAULT_ARRAY_AT")) {
        *code = CL_MEM_OBJECT_ALLOCATION_FAILURE;
        return nullptr;
    }
    if (const char* name = getenv("FAULT_SIZES_IN"); name && kernels == 0)
        if (FILE* file = fopen(name, "a")) {
            fprintf(file, "%zu\n", size);
            fclose(file);
        }
    return original(clCreateBuffer, "clCreateBuffer")(context, flags, size, host, code);
}

cl_int clEnqueueNDRangeKernel(cl_command_queue queue, cl_kernel kernel, cl_uint dimensions,
                              const size_t* first, const size_t* items, const size_t* group,
                              cl_uint waits, const cl_event* events, cl_event* event) {
    const long at = number("FAULT_KERNEL_AT");
    if (++kernels >= at && at > 0) return CL_DEVICE_NOT_AVAILABLE;
    return original(clEnqueueNDRangeKernel, "clEnqueueNDRangeKernel")(
        queue, kernel, dimensions, first, items, group, waits, events, event);
}

} // extern "C"
