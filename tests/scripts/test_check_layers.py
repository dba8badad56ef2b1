# SPDX-License-Identifier: BSD-3-Clause
"""The layer check on small trees: one that respects the layers, and one for each way to violate them."""
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent.parent
CHECK = ROOT / "scripts" / "check_layers.py"

# `upper` depends on `lower`: only the .cpp file of `upper` includes its header.
TREE = {
    "src/lower/CMakeLists.txt": "shearwake_component()\n",
    "src/lower/low.hpp": "#pragma once\nint low();\n",
    "src/lower/low.cpp": '#include "lower/low.hpp"\n\n#include <vector>\nint low() { return 1; }\n',
    "src/upper/CMakeLists.txt": "shearwake_component(\n    PRIVATE lower)\n",
    "src/upper/up.hpp": "#pragma once\nint up();\n",
    "src/upper/up.cpp": '#include "upper/up.hpp"\n\n#include "lower/low.hpp"\nint up() { return low(); }\n',
    "tests/support/help.hpp": "#pragma once\n",
    "tests/unit/test_up.cpp": '#include "support/help.hpp"\n#include "upper/up.hpp"\n\n#include <catch2/catch.hpp>\n',
}


# The same with an engine that is registered.
ENGINE = {
    "src/engines/toy/CMakeLists.txt": "shearwake_component()\n",
    "src/engines/toy/toy.hpp": "#pragma once\nint toy();\n",
    "src/engines/toy/toy.cpp": '#include "engines/toy/toy.hpp"\n\nint toy() { return 2; }\n',
    "src/engines/CMakeLists.txt": "shearwake_component()\n",
    "src/engines/engine.cpp": "int engine() { return 3; }\n",
    "src/engines/registry/CMakeLists.txt": "shearwake_component(\n    PRIVATE ${SHEARWAKE_ENGINES})\n",
    "src/engines/registry/make.cpp": '#include "engines/toy/toy.hpp"\n\nint make() { return toy(); }\n',
}


def run(*arguments):
    done = subprocess.run([sys.executable, str(CHECK), *map(str, arguments)], capture_output=True, text=True, check=False)
    return done.returncode, done.stdout + done.stderr


def check(changes):
    """Exit code and output of the check on TREE with these changes."""
    with tempfile.TemporaryDirectory(prefix="shearwake-test-") as folder:
        for name, text in {**TREE, **changes}.items():
            path = Path(folder) / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
        return run(folder)


def low(line):
    return {"src/lower/low.cpp": TREE["src/lower/low.cpp"] + line + "\n"}


def lower_lists(names):
    return {"src/lower/CMakeLists.txt": f"shearwake_component(\n    {names})\n"}


OPTIONS = {**ENGINE, "src/problem/case/CMakeLists.txt": "shearwake_component()\n", "src/problem/case/solver_options.hpp":
           "#pragma once\nstruct ToyOptions {\n    virtual void check() = 0;\n};\nusing SolverOptions = std::variant<ToyOptions>;\n"}
PYTHON = {"analysis/shearwake/case.py": "def plot():\n    from .sub import plot\n", "analysis/shearwake/sub/plot.py": "import os\n"}
HIGHER = '#include "upper/up.hpp"'
NO_HEADER, QUOTES, NO_LIBRARY = "is not a header of a component", "write it in quotes", "does not belong to a library"
REJECTED = [
    (low(HIGHER), "low.cpp:5"), (low(HIGHER), "lower does not list upper"), (low("#include <upper/up.hpp>"), QUOTES),
    *((low(line), "src/lower/low.cpp:") for line in (
        '#include_next "upper/up.hpp"', '#import "upper/up.hpp"', "#include UPPER", '%:include "upper/up.hpp"', '#/**/include "upper/up.hpp"',
        '#include/**/"upper/up.hpp"', '#inc\\\nlude "upper/up.hpp"', '/* */ #include "upper/up.hpp"', 'import "upper/up.hpp";')),
    ({"src/lower/tiny.hpp": "#pragma once\ninline int tiny() { return 1; }\n"}, "is not an interface"),
    ({f"src/lower/part_{i}.cpp": f"int part_{i}() {{ return {i}; }}\n" for i in range(24)}, "has 26 source files"),
    ({**ENGINE, "src/engines/registry/make.cpp": "int make() { return 0; }\n"}, "engines/toy is listed as PRIVATE, but is not used in that way"),
    ({**ENGINE, "src/upper/CMakeLists.txt": "shearwake_component(\n    PRIVATE engines/toy lower)\n", "src/upper/up.cpp":
      TREE["src/upper/up.cpp"].replace("lower/low.hpp", 'engines/toy/toy.hpp"\n#include "lower/low.hpp')},
     "only the registry, benchmarks and kwave may include headers of an engine"),
    ({**OPTIONS, **low("struct ToyOptions;")}, "low.cpp:5: ToyOptions: only engines, benchmarks and problem/case may name the options of an engine"),
    (low('#include "../upper/up.hpp"'), NO_HEADER), (low('#include "low.hpp"'), NO_HEADER), (low('#include "support/help.hpp"'), NO_HEADER),
    (low('#include "../../tests/support/help.hpp"'), NO_HEADER), (low("#include <support/help.hpp>"), QUOTES),
    ({"tests/unit/test_low.cpp": "#include <lower/low.hpp>\n"}, QUOTES), ({"tests/unit/test_low.cpp": "#include <boost/mpi.hpp>\n"}, NO_LIBRARY),
    ({"src/upper/up.hpp": TREE["src/upper/up.hpp"] + '#include "lower/low.hpp"\n'}, "upper does not list lower as PUBLIC"),
    (low("#include <mpi.h>"), "lower does not list MPI::MPI_C"),
    *((low(f"#include <{header}>"), NO_LIBRARY) for header in ("openmpi/mpi.h", "mpi-ext.h", "boost/mpi.hpp", "mpicxx.h")),
    (low('extern "C" int MPI_Finalize();'), "MPI_Finalize: lower does not list"),
    (low("void* plan = fftw_malloc(8);"), "fftw_malloc: lower does not list"),
    ({"src/stray/stray.cpp": "int stray;\n"}, "src/stray is not a component"),
    ({"src/lower/deep/stray.hpp": "int stray;\n"}, "src/lower/deep is not a component"),
    ({"src/stray.cpp": "int stray;\n"}, "is not a component"),
    ({"src/stray/CMakeLists.txt": "add_library(stray)\n"}, "does not call shearwake_component()"),
    (lower_lists("KERNELS low gone"), "gone.cpp is listed, but does not exist"),
    ({"src/lower/hidden.inc": HIGHER + "\n"}, "source files end in .cpp"),
    (lower_lists("PRIVATE upper"), "upper is listed as PRIVATE, but is not used"), (lower_lists("PRIVATE nothing"), "neither a component nor"),
    ({**lower_lists("PRIVATE upper"), **low(HIGHER)}, "lower -> upper -> lower"),
    (low("int x; // see lower/gone.hpp"), "low.cpp:5: the comment names lower/gone.hpp, which does not exist"),
    (low("int x;\n" * 396), "low.cpp:1: has 401 lines; a file has at most 400"),
    (low("static int slow(int a,\n                int b) {\n" + "    ++a;\n" * 58 + "}"), "low.cpp:5: has 61 lines; a function has at most 60"),
    ({"src/upper/up.hpp": TREE["src/upper/up.hpp"] + "// Of (bool text).\nint go(int a,\n       bool fast = true);\n"}, "up.hpp:5: bool fast: a parameter of a header"),
    ({**PYTHON, "analysis/shearwake/sub/plot.py": "from ..case import plot\n"}, "case.py -> sub/plot.py -> case.py"),
]
ACCEPTED = [{}, ENGINE, PYTHON, low("// " + HIGHER), low("// as lower/low.cpp and NAME.cpp"),
            low("int fast(int a) {\n" + "    ++a;\n" * 58 + "}\n\nint next;"), low("struct Long {\n" + "    int x;\n\n" * 60 + "};"), low(f"/*\n{HIGHER}\n*/"), low(f'const char* text = R"x(\n{HIGHER}\n)x";'),
            {**OPTIONS, "src/engines/toy/toy.cpp": ENGINE["src/engines/toy/toy.cpp"] + "struct ToyOptions;\n"},
            {**OPTIONS, **low("// as ToyOptions")}]


@pytest.mark.parametrize("changes, message", REJECTED)
def test_rejects_what_violates_the_layers(changes, message):
    code, output = check(changes)
    assert code == 1 and message in output, output


@pytest.mark.parametrize("changes", ACCEPTED)
def test_accepts_trees_that_respect_the_layers(changes):
    code, output = check(changes)
    assert code == 0, output


@pytest.mark.extended
def test_counts_components_dependencies_and_levels():
    assert check({}) == (0, "2 components, 1 dependencies, 2 levels\n")
    assert run()[0] == 0  # the tree of the program


def test_a_folder_without_components_is_an_error():
    code, output = run(ROOT / "src")
    assert code == 2 and "has no components" in output
