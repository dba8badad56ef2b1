// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/error.hpp"
#include "storage/hdf5/guard.hpp"
#include "storage/hdf5/h5.hpp"

#include <filesystem>
#include <fmt/format.h>
#include <new>

namespace shearwake::storage {

/// Returns the result of `read` for the HDF5 file of a user, after running it in a forked child,
/// since a damaged file can crash the library. All errors are UsageErrors that begin with the name
/// of the file. Not collective.
template <class Read>
auto read_user_file(const std::filesystem::path& path, Read read) {
    const std::string name = path.string();
    if (!std::filesystem::is_regular_file(path))
        throw UsageError(
            name + (std::filesystem::exists(path) ? " is not a regular file" : " does not exist"));
    const auto open_and_read = [&] {
        const h5::Id file = h5::open_file(path, h5::Access::read);
        return read(file.raw());
    };
    try {
        must_survive(path, open_and_read);
        return open_and_read();
    } catch (const std::bad_alloc&) {
        throw UsageError(name + ": it does not fit into the memory of this machine");
    } catch (const UsageError& problem) {
        throw UsageError(fmt::format("{}: {}", name, problem.what()));
    } catch (const Error& problem) {
        throw UsageError(fmt::format("{}: it cannot be read as HDF5: {}", name, problem.what()));
    }
}

} // namespace shearwake::storage
