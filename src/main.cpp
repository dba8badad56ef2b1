#include "parallel/session.hpp"
#include "sweep/commands.hpp"

int main(int argc, char** argv) {
    return shearwake::guarded_main(argc, argv, [&](const shearwake::Comm& world) {
        return shearwake::program(argc, argv, world);
    });
}
