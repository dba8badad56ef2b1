// SPDX-License-Identifier: BSD-3-Clause
#include "app/program.hpp"
#include "parallel/session.hpp"
#include "storage/hdf5/h5.hpp"

int main(int argc, char** argv) {
    shearwake::h5::never_tidy_up();
    return shearwake::guarded_main(argc, argv, [&](const shearwake::Comm& world) {
        return shearwake::app::program(argc, argv, world);
    });
}
