"""The house: which packages there are, which way they import, and what the documents say of them."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from itertools import pairwise
from pathlib import Path

import pytest

import kanegen
from tests.support.joint_kinds import JOINT_KINDS
from tests.support.paths import ROOT

PACKAGE = ROOT / "kanegen"

ORDER = (
    "errors",
    "choices",
    "files",
    "extras",
    "pictures",
    "program",
    "options",
    "model",
    "linear",
    "readers reference symbolic",
    "recursion",
    "lowering",
    "c",
    "artifacts",
    "library",
    "measure",
    "compiler",
    "simulation",
    "interop",
    "viewer",
    "browser",
    "products",
    "sweeps",
    "studies",
    "cli",
)
"""The order of imports: a module imports from its own line's package or from lines above it."""

LEVEL = {name: level for level, line in enumerate(ORDER) for name in line.split()}


@cache
def modules() -> dict[str, Path]:
    """The file of every module by its dotted name."""
    return {_dotted(path): path for path in sorted(PACKAGE.rglob("*.py"))}


@cache
def tree(name: str) -> ast.Module:
    """The syntax tree of the module `name`."""
    return ast.parse(modules()[name].read_text(encoding="utf-8"))


@cache
def imports(name: str) -> frozenset[str]:
    """The modules of kanegen that the module `name` imports anywhere, also within functions.

    The package `kanegen` itself does not count: it names modules and imports none until they are used.
    """
    found = set()
    for node in ast.walk(tree(name)):
        if isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
            names = [f"{node.module}.{alias.name}" for alias in node.names]
            found |= {full if full in modules() else node.module for full in names}
        elif isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
    return frozenset(found & modules().keys() - {"kanegen"})


def all_imports(name: str) -> set[str]:
    """The modules that the module `name` imports, and those that they import, and so on."""
    found: set[str] = set()
    waiting = [name]
    while waiting:
        new = imports(waiting.pop()) - found
        found |= new
        waiting += new
    return found


def below(*packages: str) -> Iterator[str]:
    """The modules of packages of kanegen, such as "measure.truth"."""
    for package in packages:
        prefix = f"kanegen.{package}"
        yield from (name for name in modules() if name == prefix or name.startswith(f"{prefix}."))


def _dotted(path: Path) -> str:
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def _stage(name: str) -> str:
    """The package, or the module of the root, in which a module stands."""
    return name.split(".")[1]


def test_the_root_holds_few_modules_and_packages() -> None:
    entries = [path for path in PACKAGE.iterdir() if path.name != "__pycache__"]
    assert sum(path.suffix == ".py" for path in entries) <= 8
    assert sum(path.is_dir() for path in entries) <= 21


def test_every_module_has_a_place_in_the_order() -> None:
    found = {_stage(name) for name in modules() if name not in {"kanegen", "kanegen.__main__"}}
    assert found == LEVEL.keys()


def test_imports_run_one_way() -> None:
    against = [
        f"{name} imports {other}"
        for name in modules()
        if name not in {"kanegen", "kanegen.__main__"}
        for other in imports(name)
        if _stage(other) != _stage(name) and LEVEL[_stage(other)] >= LEVEL[_stage(name)]
    ]
    assert not against


def test_no_modules_import_each_other_in_a_circle() -> None:
    circles = [name for name in modules() if name != "kanegen" and name in all_imports(name)]
    assert not circles


def test_packages_stand_on_few_floors() -> None:
    above: dict[str, set[str]] = {stage: set() for stage in LEVEL}
    for name in modules().keys() - {"kanegen", "kanegen.__main__"}:
        above[_stage(name)] |= {_stage(other) for other in imports(name)} - {_stage(name)}

    packages = [stage for stage in LEVEL if (PACKAGE / stage).is_dir()]

    @cache
    def floor(stage: str) -> int:
        """The number of packages on the longest way of imports down from `stage`, itself included."""
        return (stage in packages) + max((floor(other) for other in above[stage]), default=0)

    assert max(map(floor, LEVEL)) <= 13


@pytest.mark.parametrize("independent", ["reference", "measure.truth"])
def test_what_proves_the_code_shares_nothing_with_it(independent: str) -> None:
    compiler = {*below("symbolic", "recursion", "lowering", "program.passes", "c")}
    for name in below(independent):
        assert not all_imports(name) & compiler, name


def test_nothing_below_the_compiler_imports_studies_or_the_command_line() -> None:
    upper = {*below("compiler", "studies", "cli")}
    inner = modules().keys() - {"kanegen", "kanegen.__main__"}
    lower = [name for name in inner if LEVEL[_stage(name)] < LEVEL["compiler"]]
    assert not [name for name in lower if all_imports(name) & upper]


def test_public_names_are_where_the_package_says() -> None:
    hints = {
        alias.name: node.module
        for block in tree("kanegen").body
        if isinstance(block, ast.If)
        for node in block.body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }
    defined = {name: f"kanegen.{module}" for name, module in kanegen._DEFINED_IN.items()}
    assert hints == defined
    assert set(kanegen.__all__) == {*hints, "__version__"}
    for name in hints:
        assert getattr(kanegen, name).__module__.startswith("kanegen.")


def _docstrings() -> Iterator[tuple[str, str]]:
    for name in modules():
        for node in ast.walk(tree(name)):
            if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
                text = ast.get_docstring(node)
                if text:
                    yield f"{name}.{getattr(node, 'name', '')}", text


@pytest.mark.parametrize("name", ["library", "compiler", "errors", "readers"])
def test_packages_are_attributes_without_an_import(name: str) -> None:
    code = f"import kanegen; print(kanegen.{name}.__name__, hasattr(kanegen, 'bogus'))"
    printed = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert printed.split() == [f"kanegen.{name}", "False"]


def test_docstrings_are_sentences() -> None:
    short = [where for where, text in _docstrings() if len(text.split()) <= 4]
    assert len(short) <= 20, short


def test_every_package_says_what_lives_there() -> None:
    packages = [path.parent for path in PACKAGE.rglob("__init__.py")]
    for package in packages:
        text = ast.get_docstring(tree(_dotted(package / "__init__.py")))
        assert text, package


def test_no_test_module_imports_another_one() -> None:
    """What several test modules need stands in `tests.support`."""
    imported = [
        f"{path.relative_to(ROOT)} imports {name}"
        for path in (ROOT / "tests").rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        for name in _imported_names(node)
        if re.match(r"tests\.(\w+\.)*test_", name)
    ]
    assert not imported


def _imported_names(node: ast.AST) -> list[str]:
    """Return the dotted names that an import statement names, none for other nodes."""
    if isinstance(node, ast.ImportFrom):
        return [f"{node.module}.{alias.name}" for alias in node.names]
    return [alias.name for alias in node.names] if isinstance(node, ast.Import) else []


DOCUMENTS = ["README.md", "CONTRIBUTING.md", "docs/architecture.md"]


@pytest.mark.parametrize("document", DOCUMENTS)
def test_documents_name_files_that_exist(document: str) -> None:
    text = (ROOT / document).read_text(encoding="utf-8")
    named = re.findall(r"`((?:kanegen|templates|tests|benchmarks|docs|models|generated)/[\w./*-]*)`", text)
    linked = [link for link in re.findall(r"\]\(([^)#]+)[^)]*\)", text) if "://" not in link]
    folder = (ROOT / document).parent
    missing = [path for path in named if not list(ROOT.glob(path))]
    missing += [link for link in linked if not (folder / link).exists()]
    assert not missing


def test_the_architecture_draws_the_order_of_imports() -> None:
    text = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    lines = [line for line in text.splitlines() if re.match(r"[a-z][a-z ]*\| ", line)]
    drawn = [name for line in lines for name in line.partition("|")[0].split()]
    places = {name: drawn.index(name) for name in LEVEL if name in drawn}
    assert places.keys() == LEVEL.keys()
    ordered = sorted(places, key=places.__getitem__)
    assert all(LEVEL[a] <= LEVEL[b] for a, b in pairwise(ordered))


def test_the_architecture_lists_the_files_of_a_joint_kind() -> None:
    text = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    section = text.partition("**Joint**")[2].partition("**Output**")[0]
    assert re.findall(r"^\| `kanegen/([\w./]+)` \|", section, flags=re.MULTILINE) == list(JOINT_KINDS)
