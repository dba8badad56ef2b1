#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Checks that all #include lines respect the layers of the program.

Usage: check_layers.py [ROOT] (default: the folder above this script). Prints each error with file and line,
and exits 1 if there is one, and 2 if ROOT has no components. Otherwise prints the numbers of components, of their
dependencies on each other, and of levels.

${SHEARWAKE_ENGINES} stands for the folders of engines, as in src/CMakeLists.txt. A folder that the registry does
not include is an error, as is a file outside of an engine's folder that includes one of its headers; the registry,
benchmarks and kwave, which runs files of k-Wave on engine pstd, may. No file outside of engines, benchmarks, kwave and
problem/case names the options of an engine, the members of SolverOptions in problem/case/solver_options.hpp.
A folder has at most 25 source files, a file at most 400 lines, a function at most 60 lines, a header no parameter of
type bool, and `app` does not run jobs: it includes no engine.

A component is a folder of src with a CMakeLists.txt that calls shearwake_component(), see
cmake/components.cmake. It may include its own headers and those of the folders that it lists:
PUBLIC ones everywhere, PRIVATE ones in .cpp files only. The lists must be complete, must not contain
unused entries, and must not form a cycle. To include a header of a library, or to use one of its
functions, a component must list the library. Tests may include every component, but no component may
include tests.
"""
import ast
import functools
import graphlib
import re
import sys
from pathlib import Path

# Libraries with the patterns of their headers and of their names. Every other header in angle brackets must
# belong to the standard library, POSIX or fmt.
LIBRARIES = {
    "MPI::MPI_C": (r"mpi\.h", r"MPI_\w+"),
    "FFTW::FFTW": (r"fftw3(-mpi)?\.h", r"fftwf?_\w+"),
    "HDF5::parallel": (r"hdf5(_hl)?\.h", r"H5[A-Z]{1,2}\w+"),
    "tomlplusplus::tomlplusplus": (r"toml\+\+/.*\.h", r"toml::\w+"),
    "Random123::Random123": (r"Random123/.*", r"r123::\w+"),
    "xxhash::xxhash": (r"xxhash\.h", r"XXH\w+"),
    "Eigen3::Eigen": (r"Eigen/\w+", r"Eigen::\w+"),
    "Boost::Boost": (r"boost/(random|math)/.*\.hpp", r"boost::\w+"),
    "CLI11::CLI11": (r"CLI/CLI\.hpp", r"CLI::\w+"),
    "OpenCL::OpenCL": (r"CL/cl\.h", r"cl[A-Z]\w+"),
    "PNG::PNG": (r"png\.h", r"png_\w+"),
    "nlohmann_json::nlohmann_json": (r"nlohmann/json(?:_fwd)?\.hpp", r"nlohmann::\w+"),
}
STANDARD = set("""
    algorithm any array atomic bit cassert cctype cerrno cfenv cfloat charconv chrono cinttypes climits clocale cmath
    compare complex concepts condition_variable csignal cstdarg cstddef cstdint cstdio cstdlib cstring ctime
    deque exception execution filesystem forward_list fstream functional future initializer_list iomanip ios
    iosfwd iostream istream iterator latch limits list locale map memory memory_resource mutex new numbers
    numeric optional ostream queue random ranges ratio regex set shared_mutex source_location span sstream
    stack stdexcept stop_token streambuf string string_view system_error thread tuple type_traits typeindex
    typeinfo unordered_map unordered_set utility valarray variant vector version
    dirent.h dlfcn.h emmintrin.h fcntl.h fnmatch.h immintrin.h malloc.h poll.h sched.h signal.h time.h unistd.h x86intrin.h sys/file.h sys/ioctl.h sys/mman.h
    sys/prctl.h sys/resource.h sys/socket.h sys/stat.h sys/statvfs.h sys/time.h sys/types.h sys/utsname.h sys/vfs.h
    sys/wait.h linux/magic.h fmt/core.h fmt/format.h fmt/ranges.h fmt/std.h fmt/chrono.h""".split())
GENERATED = {"git_id.hpp", "kernels_cl.hpp", "labels_csv.hpp"}  # by the build
KEYWORDS = ("KERNELS", "PUBLIC", "PRIVATE")
ENGINES = "${SHEARWAKE_ENGINES}"
MOST_FILES, LEAST_LINES = 25, 40  # of a folder, of a header that is not an interface
MOST_LINES, MOST_FUNCTION_LINES = 400, 60
# In formatted sources, a function begins and ends in the first column, and its parameters and body are indented.
FUNCTION = re.compile(r"^(?!namespace|struct|class|enum|union|[a-z]+:)[A-Za-z~][^\n]*\n(?:[ \t][^\n]*\n|\n)*\}(?=\s*(?:catch\b[^\n]*)?$)", re.M)


class Component:
    def __init__(self, folder, text, engines):
        self.folder = folder
        self.lists = {keyword: [] for keyword in KEYWORDS}
        call = re.search(r"^shearwake_component\(([^)]*)\)", text, re.M)
        mode = None
        for word in re.sub(r"#.*", "", call.group(1)).split() if call else ():
            if word in KEYWORDS:
                mode = word
            elif mode:
                self.lists[mode] += engines.get(word, [word])
        self.found = call is not None

    def may_use(self, dependency, suffix):
        return dependency in self.lists["PUBLIC"] or (
            suffix == ".cpp" and dependency in self.lists["PRIVATE"])


def without_comments(text):
    """The text with joined line continuations and without comments and string literals, except for the names
    in include lines. Line numbers are preserved."""
    pattern = re.compile(
        r'//[^\n]*|/\*.*?\*/|(?P<include>^[ \t]*(?:#|%:|\?\?=)[^\n]*)|R"(?P<d>[^(\s]*)\(.*?\)(?P=d)"'
        r'''|"(?:\\.|[^"\\\n])*"|'(?:\\.|[^'\\\n])*\'''', re.S | re.M)

    def replace(match):
        if match.group("include"):
            return re.sub(r"//.*|/\*.*?\*/", " ", match.group(0))
        return "\n" * match.group(0).count("\n") or " "

    joined = re.sub(r"\\\n((?:[^\n]*\\\n)*)", lambda m: m.group(1).replace("\\\n", ""), text)
    return pattern.sub(replace, joined)


def included(text):
    """Line number and argument of each directive that includes a file; the argument is None if the directive
    does not name the file literally."""
    for number, line in enumerate(text.splitlines(), 1):
        match = re.match(r"\s*(?:#|%:|\?\?=)\s*(include|include_next|import|embed)\b(.*)", line)
        if match:
            plain = re.fullmatch(r'\s*("[^"]+"|<[^>]+>)\s*', match.group(2))
            yield number, plain.group(1) if plain and match.group(1) == "include" else None
        elif re.match(r"\s*(export\s+)?(import|module)\b[^=(]*;", line):
            yield number, None


class Tree:
    def __init__(self, root):
        self.root, self.source = root, root / "src"
        self.components = {}
        options = self.source / "problem/case/solver_options.hpp"
        found = re.search(r"using SolverOptions = std::variant<([^>]*)>", options.read_text(encoding="utf-8")) if options.exists() else None
        self.options = re.compile(r"\b(?:" + "|".join(found[1].replace(",", " ").split()) + r")\b") if found else None
        self.engines = {ENGINES: sorted(path.parent.relative_to(self.source).as_posix()
                                        for path in self.source.glob("engines/*/CMakeLists.txt")
                                        if path.parent.name != "registry")}
        for path in sorted(self.source.rglob("CMakeLists.txt")):
            folder = path.parent.relative_to(self.source).as_posix()
            if folder != ".":
                self.components[folder] = Component(folder, path.read_text(encoding="utf-8"), self.engines)

    def errors(self):
        yield from self.errors_of_lists()
        yield from self.errors_of_sizes()
        yield from self.cycles()
        yield from python_cycle(self.root / "analysis" / "shearwake")
        yield from self.missing_files()
        for top in ("src", "tests"):
            for path in sorted((self.root / top).rglob("*")):
                if path.suffix in (".cpp", ".hpp"):
                    yield from self.errors_of_file(path)
                elif path.suffix in (".h", ".cc", ".cxx", ".hh", ".hxx", ".ipp", ".inl", ".inc", ".tpp", ".c"):
                    yield path, 1, "source files end in .cpp and headers in .hpp"

    def missing_files(self):
        """Comments that name a source file that does not exist, by the end of its path; NAME.cpp stands for any file."""
        paths = [path for top in ("src", "tests", "analysis", "scripts") for path in (self.root / top).rglob("*")
                 if path.suffix in (".cpp", ".hpp", ".py")]
        ends = {"/".join(path.parts[-n:]) for path in paths for n in range(1, len(path.parts))}
        for path in paths:
            if path.suffix == ".py" and path.is_relative_to(self.root / "tests"):  # contains sources as texts
                continue
            for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
                comment = re.search(r"(?:^|\s)#.*" if path.suffix == ".py" else r"//.*", line)
                for name in re.findall(r"(?<![\w./*-])(?:[\w-]+/)*[a-z][\w-]*\.(?:[ch]pp|py)\b", comment[0] if comment else ""):
                    if name not in ends:
                        yield path, number, f"the comment names {name}, which does not exist"

    def errors_of_lists(self):
        for folder, component in self.components.items():
            lists = self.source / folder / "CMakeLists.txt"
            if not component.found:
                yield lists, 1, "does not call shearwake_component()"
            used = self.used_by(folder)
            for keyword in ("PUBLIC", "PRIVATE"):
                for dependency in component.lists[keyword]:
                    if dependency not in self.components and dependency not in LIBRARIES:
                        yield lists, 1, f"{dependency} is neither a component nor a known library"
                    elif keyword not in used.get(dependency, ()):
                        yield lists, 1, f"{dependency} is listed as {keyword}, but is not used in that way"
            for name in component.lists["KERNELS"]:
                if not (self.source / folder / f"{name}.cpp").exists():
                    yield lists, 1, f"{name}.cpp is listed, but does not exist"

    def errors_of_sizes(self):
        for folder in self.components:
            files = [path for path in (self.source / folder).iterdir() if path.suffix in (".cpp", ".hpp")]
            if len(files) > MOST_FILES:
                yield self.source / folder, 1, f"has {len(files)} source files; a folder has at most {MOST_FILES} source files"
            for path in files:
                text = path.read_text(encoding="utf-8") if path.suffix == ".hpp" else ""
                lines, source = text.count("\n"), path.with_suffix(".cpp")
                if text and lines < LEAST_LINES and not re.search(r"= 0;|std::function<", text) and not (
                        source.exists() and source.read_text(encoding="utf-8").count("\n") > lines):
                    yield path, 1, f"has {lines} lines and is not an interface; merge it into the header that it belongs to"

    def below(self, folder):
        component = self.components[folder]
        return {name for name in component.lists["PUBLIC"] + component.lists["PRIVATE"] if name in self.components}

    def arrows(self):
        return sum(len(self.below(folder)) for folder in self.components)

    def levels(self):
        """The number of components in the longest chain of dependencies."""
        @functools.cache
        def height(folder):
            return 1 + max(map(height, self.below(folder)), default=0)
        return max(map(height, self.components))

    def used_by(self, folder):
        """How each dependency is used: PUBLIC if a header uses it, PRIVATE if only .cpp files do."""
        used = {}
        for path in sorted((self.source / folder).glob("*.[ch]pp"), key=lambda p: p.suffix != ".hpp"):
            for _, name in included(without_comments(path.read_text(encoding="utf-8"))):
                dependency = name and (name[1:-1].rpartition("/")[0] if name[0] == '"' else library(name[1:-1]))
                if dependency:
                    used.setdefault(dependency, "PUBLIC" if path.suffix == ".hpp" else "PRIVATE")
        return used

    def cycles(self):
        done, path = set(), []

        def visit(folder):
            if folder in path:
                ring = " -> ".join([*path[path.index(folder):], folder])
                yield self.source / folder / "CMakeLists.txt", 1, f"components depend on each other: {ring}"
            elif folder not in done and folder in self.components:
                path.append(folder)
                lists = self.components[folder].lists
                for dependency in lists["PUBLIC"] + lists["PRIVATE"]:
                    yield from visit(dependency)
                path.pop()
                done.add(folder)

        for folder in self.components:
            yield from visit(folder)

    def errors_of_file(self, path):
        relative = path.relative_to(self.root)
        folder = relative.parent.relative_to(relative.parts[0]).as_posix()
        in_tests = relative.parts[0] == "tests"
        component = None if in_tests else self.components.get(folder)
        if not in_tests and component is None:
            yield path, 1, f"src/{folder} is not a component: it has no CMakeLists.txt"
            return
        text = path.read_text(encoding="utf-8")
        if component:
            yield from long_parts(text, path)
        text = without_comments(text)
        for number, name in included(text):
            if name is None:
                yield path, number, 'unsupported directive: write #include "..." or #include <...>'
            elif name[0] == '"':
                message = self.project_header(name[1:-1], path, component)
                if message:
                    yield path, number, message
            else:
                message = self.library_header(name[1:-1], path, component)
                if message:
                    yield path, number, message
        if component:
            yield from self.names(text, path, component)
            yield from self.named_options(text, path, component)

    def named_options(self, text, path, component):
        allowed = component.folder in ("problem/case", "bench") or component.folder.split("/")[0] == "engines"
        found = [] if allowed or not self.options else [(n, m[0]) for n, line in enumerate(text.splitlines(), 1)
                                                        if (m := self.options.search(line))]
        if found:
            yield path, found[0][0], f"{found[0][1]}: only engines, benchmarks and problem/case may name the options of an engine"

    def project_header(self, header, path, component):
        if component and header in GENERATED:
            return None
        where, _, _ = header.rpartition("/")
        if not component and (self.root / "tests" / header).is_file():
            return None
        if ".." in Path(header).parts or where not in self.components or not (self.source / header).is_file():
            return f'"{header}" is not a header of a component; write its path relative to src'
        if component and self.engine_of(where) not in (None, self.engine_of(component.folder)) and \
                component.folder not in ("engines/registry", "bench", "kwave"):
            return f'"{header}": only the registry, benchmarks and kwave may include headers of an engine'
        if component and where != component.folder and not component.may_use(where, path.suffix):
            list_name = "PUBLIC" if path.suffix == ".hpp" else "PUBLIC or PRIVATE"
            return f'"{header}": {component.folder} does not list {where} as {list_name}'
        return None

    def engine_of(self, folder):
        """The engine that a component belongs to, or None."""
        return next((e for e in self.engines[ENGINES] if folder == e or folder.startswith(e + "/")), None)

    def library_header(self, header, path, component):
        found = library(header)
        if found is None:
            if header in STANDARD or (not component and header in ("catch2/catch.hpp", "catch2/catch_all.hpp")):
                return None
            if (self.source / header).is_file() or (self.root / "tests" / header).is_file():
                return f"<{header}> is a header of the project; write it in quotes"
            return f"<{header}> does not belong to a library that the program uses"
        if component and not component.may_use(found, path.suffix):
            return f"<{header}>: {component.folder} does not list {found}"
        return None

    def names(self, text, path, component):
        for found, (_, prefix) in LIBRARIES.items():
            if component.may_use(found, ".cpp"):
                continue
            for number, line in enumerate(text.splitlines(), 1):
                match = re.search(rf"(?<![\w:])(?:::)?{prefix}", line)
                if match:
                    yield path, number, f"{match.group(0)}: {component.folder} does not list {found}"
                    break


def python_cycle(package):
    """The modules that import each other, also within functions or for type hints."""
    graph = {path: set() for path in package.rglob("*.py")}
    for path in graph:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.ImportFrom) and node.level:
                parent = path.parents[node.level - 1].joinpath(*(node.module or "").split("."))
                for name in [*(parent / alias.name for alias in node.names), parent]:
                    graph[path] |= graph.keys() & {name.with_suffix(".py")}
    try:
        graphlib.TopologicalSorter(graph).prepare()
    except graphlib.CycleError as error:
        ring = " -> ".join(str(path.relative_to(package)) for path in reversed(error.args[1]))
        yield error.args[1][0], 1, f"modules import each other: {ring}"


def long_parts(text, path):
    if (lines := text.count("\n")) > MOST_LINES:
        yield path, 1, f"has {lines} lines; a file has at most {MOST_LINES}"
    if path.suffix == ".hpp":
        code = without_comments(text)
        for match in re.finditer(r"[(,]\s*(?:const )?bool (?!value\b)(\w+)(?: = \w+)?[,)]", code):
            yield path, code.count("\n", 0, match.start(1)) + 1, f"bool {match[1]}: a parameter of a header is an enumeration, unless it is a value"
    for match in FUNCTION.finditer(text):
        if (lines := match[0].count("\n") + 1) > MOST_FUNCTION_LINES:
            yield path, text.count("\n", 0, match.start()) + 1, f"has {lines} lines; a function has at most {MOST_FUNCTION_LINES}"


def library(header):
    return next((name for name, (headers, _) in LIBRARIES.items() if re.fullmatch(headers, header)), None)


def main():
    root = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parent.parent).resolve()
    tree = Tree(root)
    if not tree.components:
        print(f"{root} has no components in src; give the root of the tree", file=sys.stderr)
        return 2
    found = 0
    for path, number, message in tree.errors():
        print(f"{path}:{number}: {message}")
        found += 1
    if not found:
        print(f"{len(tree.components)} components, {tree.arrows()} dependencies, {tree.levels()} levels")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
