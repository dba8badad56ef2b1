#include "io/h5.hpp"
#include "parallel/session.hpp"
#include "sweep/commands.hpp"

int main(int argc, char** argv) {
    shearwake::h5::never_tidy_up();
    return shearwake::guarded_main(argc, argv, [&](const shearwake::Comm& world) {
        return shearwake::program(argc, argv, world);
    });
}
