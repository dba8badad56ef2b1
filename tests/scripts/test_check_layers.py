# SPDX-License-Identifier: BSD-3-Clause
"""The layer check on small trees: one that respects the layers, and one for each way to violate them."""
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

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


class LayerCheck(unittest.TestCase):
    def check(self, changes):
        """Exit code and output of the check on TREE with these changes."""
        with tempfile.TemporaryDirectory(prefix="shearwake-test-") as folder:
            for name, text in {**TREE, **changes}.items():
                path = Path(folder) / name
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text, encoding="utf-8")
            done = subprocess.run([sys.executable, str(CHECK), folder], capture_output=True, text=True,
                                  check=False)
        return done.returncode, done.stdout + done.stderr

    def assert_rejected(self, changes, *messages):
        code, output = self.check(changes)
        self.assertEqual(code, 1, output)
        for message in messages:
            self.assertIn(message, output)

    def low(self, line):
        return {"src/lower/low.cpp": TREE["src/lower/low.cpp"] + line + "\n"}

    def test_accepts_a_tree_that_respects_the_layers(self):
        self.assertEqual(self.check({}), (0, "2 components, 1 dependencies, 2 levels\n"))

    def test_accepts_the_tree_of_the_program(self):
        done = subprocess.run([sys.executable, str(CHECK)], capture_output=True, text=True, check=False)
        self.assertRegex(done.stdout, r"\A\d+ components, \d+ dependencies, \d+ levels\n\Z")

    def test_a_folder_without_components_is_an_error(self):
        done = subprocess.run([sys.executable, str(CHECK), str(ROOT / "src")], capture_output=True, text=True, check=False)
        self.assertEqual((done.returncode, done.stdout), (2, ""))
        self.assertIn("has no components", done.stderr)

    def test_rejects_a_header_of_a_higher_folder(self):
        self.assert_rejected(self.low('#include "upper/up.hpp"'), "low.cpp:5", "lower does not list upper")

    def test_rejects_a_project_header_in_angle_brackets(self):
        self.assert_rejected(self.low("#include <upper/up.hpp>"), "write it in quotes")

    def test_rejects_other_spellings_of_an_include(self):
        for line in ('#include_next "upper/up.hpp"', '#import "upper/up.hpp"', "#include UPPER",
                     '%:include "upper/up.hpp"', '#/**/include "upper/up.hpp"', '#include/**/"upper/up.hpp"',
                     '#inc\\\nlude "upper/up.hpp"', '/* */ #include "upper/up.hpp"', 'import "upper/up.hpp";'):
            with self.subTest(line=line):
                self.assert_rejected(self.low(line), "src/lower/low.cpp:")

    def test_ignores_includes_in_comments_and_strings(self):
        for line in ('// #include "upper/up.hpp"', '/*\n#include "upper/up.hpp"\n*/',
                     'const char* text = R"x(\n#include "upper/up.hpp"\n)x";'):
            with self.subTest(line=line):
                self.assertEqual(self.check(self.low(line))[0], 0)

    def test_rejects_a_small_header_that_is_not_an_interface(self):
        self.assert_rejected({"src/lower/tiny.hpp": "#pragma once\ninline int tiny() { return 1; }\n"},
                             "src/lower/tiny.hpp:1", "is not an interface")

    def test_rejects_a_folder_with_too_many_files(self):
        files = {f"src/lower/part_{i}.cpp": f"int part_{i}() {{ return {i}; }}\n" for i in range(24)}
        self.assert_rejected(files, "src/lower:1", "has 26 source files")

    def test_accepts_an_engine_that_is_registered(self):
        self.assertEqual(self.check(ENGINE)[0], 0)

    def test_rejects_an_engine_that_is_not_registered(self):
        self.assert_rejected({**ENGINE, "src/engines/registry/make.cpp": "int make() { return 0; }\n"},
                             "engines/toy is listed as PRIVATE, but is not used in that way")

    def test_rejects_headers_of_an_engine_outside_of_its_folder(self):
        lists = "shearwake_component(\n    PRIVATE engines/toy lower)\n"
        source = TREE["src/upper/up.cpp"].replace("lower/low.hpp", 'engines/toy/toy.hpp"\n#include "lower/low.hpp')
        self.assert_rejected({**ENGINE, "src/upper/CMakeLists.txt": lists, "src/upper/up.cpp": source},
                             "only the registry, benchmarks and kwave may include headers of an engine")

    def test_rejects_options_of_an_engine_outside_of_engines(self):
        options = {"src/problem/case/CMakeLists.txt": "shearwake_component()\n", "src/problem/case/solver_options.hpp":
                   "#pragma once\nstruct ToyOptions {\n    virtual void check() = 0;\n};\nusing SolverOptions = std::variant<ToyOptions>;\n"}
        toy = {"src/engines/toy/toy.cpp": ENGINE["src/engines/toy/toy.cpp"] + "struct ToyOptions;\n"}
        self.assertEqual(self.check({**ENGINE, **options, **toy})[0], 0)
        self.assert_rejected({**ENGINE, **options, **self.low("struct ToyOptions;")},
                             "low.cpp:5: ToyOptions: only engines, benchmarks and problem/case may name the options of an engine")
        self.assertEqual(self.check({**ENGINE, **options, **self.low("// as ToyOptions")})[0], 0)

    def test_rejects_paths_that_leave_the_folder(self):
        self.assert_rejected(self.low('#include "../upper/up.hpp"'), "is not a header of a component")
        self.assert_rejected(self.low('#include "low.hpp"'), "is not a header of a component")

    def test_rejects_headers_reached_through_tests(self):
        self.assert_rejected(self.low('#include "support/help.hpp"'), "is not a header of a component")
        self.assert_rejected(self.low('#include "../../tests/support/help.hpp"'), "is not a header of a component")
        self.assert_rejected(self.low("#include <support/help.hpp>"), "write it in quotes")

    def test_checks_the_tests_as_well(self):
        self.assert_rejected({"tests/unit/test_low.cpp": "#include <lower/low.hpp>\n"}, "write it in quotes")
        self.assert_rejected({"tests/unit/test_low.cpp": "#include <boost/mpi.hpp>\n"}, "does not belong to a library")

    def test_rejects_a_private_dependency_in_a_header(self):
        header = TREE["src/upper/up.hpp"] + '#include "lower/low.hpp"\n'
        self.assert_rejected({"src/upper/up.hpp": header}, "upper does not list lower as PUBLIC")

    def test_rejects_libraries_and_wrappers_that_are_not_listed(self):
        self.assert_rejected(self.low("#include <mpi.h>"), "lower does not list MPI::MPI_C")
        for header in ("openmpi/mpi.h", "mpi-ext.h", "boost/mpi.hpp", "mpicxx.h"):
            self.assert_rejected(self.low(f"#include <{header}>"), "does not belong to a library")
        self.assert_rejected(self.low('extern "C" int MPI_Finalize();'), "MPI_Finalize: lower does not list")
        self.assert_rejected(self.low("void* plan = fftw_malloc(8);"), "fftw_malloc: lower does not list")

    def test_rejects_a_folder_without_a_component(self):
        self.assert_rejected({"src/stray/stray.cpp": "int stray;\n"}, "src/stray is not a component")
        self.assert_rejected({"src/lower/deep/stray.hpp": "int stray;\n"}, "src/lower/deep is not a component")
        self.assert_rejected({"src/stray.cpp": "int stray;\n"}, "is not a component")
        self.assert_rejected({"src/stray/CMakeLists.txt": "add_library(stray)\n"},
                             "does not call shearwake_component()")

    def test_rejects_sources_that_are_not_listed_or_missing(self):
        self.assert_rejected({"src/lower/CMakeLists.txt": "shearwake_component(\n    KERNELS low gone)\n"},
                             "gone.cpp is listed, but does not exist")
        self.assert_rejected({"src/lower/hidden.inc": '#include "upper/up.hpp"\n'}, "source files end in .cpp")

    def test_rejects_dependencies_that_are_unused_unknown_or_circular(self):
        lists = "shearwake_component(\n    PRIVATE {})\n"
        self.assert_rejected({"src/lower/CMakeLists.txt": lists.format("upper")},
                             "upper is listed as PRIVATE, but is not used")
        self.assert_rejected({"src/lower/CMakeLists.txt": lists.format("nothing")}, "neither a component nor")
        self.assert_rejected({"src/lower/CMakeLists.txt": lists.format("upper"),
                              **self.low('#include "upper/up.hpp"')}, "lower -> upper -> lower")

    def test_rejects_python_modules_that_import_each_other(self):
        package = {"analysis/shearwake/case.py": "def plot():\n    from .sub import plot\n", "analysis/shearwake/sub/plot.py": "import os\n"}
        self.assertEqual(self.check(package)[0], 0)
        self.assert_rejected({**package, "analysis/shearwake/sub/plot.py": "from ..case import plot\n"},
                             "case.py -> sub/plot.py -> case.py")
