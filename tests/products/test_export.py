"""Products: what is written where, and what is refused before anything is compiled."""

import pytest
from typer.testing import CliRunner

import kanegen as kg
from kanegen.browser import toolchain
from kanegen.browser.wasm import wasm_module
from kanegen.c.provenance import is_unchanged
from kanegen.cli import options
from kanegen.cli.app import app
from kanegen.errors import BuildError, OptionError, WriteError
from kanegen.extras import is_installed
from kanegen.products import PLATFORMS, PRODUCTS, chosen_platforms, platforms
from tests.support.paths import ROOT


@pytest.fixture(scope="module")
def pendulum():
    return kg.load(ROOT / "models" / "double_pendulum.toml")


def test_a_product_is_written_to_a_file_or_into_a_folder(pendulum, tmp_path):
    source = kg.generate(pendulum)
    expected = wasm_module(source, batch=True, simd=True)
    assert kg.export(source, "wasm", tmp_path / "module.wasm").read_bytes() == expected
    assert kg.export(pendulum, "wasm", str(tmp_path)) == tmp_path / "double_pendulum.wasm"
    usual = kg.generate(pendulum, ("mass_matrix", "forcing", "forward_dynamics"))
    written = (tmp_path / "double_pendulum.wasm").read_bytes()
    assert written == wasm_module(usual, batch=True, simd=True)


def test_the_table_describes_every_product(pendulum):
    source = kg.generate(pendulum)
    for name, product in PRODUCTS.items():
        assert product.name == name
        assert product.summary.endswith(".")
        assert product.file(source).startswith("double_pendulum")


def test_wrong_names_are_refused(pendulum, tmp_path):
    with pytest.raises(OptionError, match=r"unknown product 'wams'. Did you mean 'wasm'"):
        kg.export(pendulum, "wams", tmp_path)
    with pytest.raises(OptionError, match=r"no compiler makes .* kg\.generate\(system, artifacts='rust'\)"):
        kg.export(pendulum, "rust", tmp_path)
    with pytest.raises(OptionError, match=r"unknown product 'fmi'. Did you mean 'fmi2' or 'fmi3'\?"):
        kg.export(pendulum, "fmi", tmp_path)
    with pytest.raises(OptionError, match=r"'linux'. Did you mean 'x86_64-linux' or 'aarch64-linux'\?"):
        kg.export(pendulum, "fmi3", tmp_path, platforms="linux")
    with pytest.raises(OptionError, match=r"'macOS'. Did you mean 'x86_64-darwin' or 'aarch64-darwin'\?"):
        chosen_platforms(["macOS"])
    with pytest.raises(OptionError, match="the same on every platform"):
        kg.export(pendulum, "wasm", tmp_path, platforms="x86_64-linux")
    with pytest.raises(OptionError, match=r"unknown platform 'x86_64-window'. Did you mean 'x86_64-windows'"):
        chosen_platforms(["x86_64-window"])
    with pytest.raises(OptionError, match="neither a system nor generated code"):
        kg.export("double_pendulum.toml", "wasm", tmp_path)


def test_a_missing_tool_or_folder_is_found_before_anything_is_generated(pendulum, tmp_path, monkeypatch):
    monkeypatch.setattr("kanegen.products.exporting.generate", None)  # so that a call would fail
    with pytest.raises(WriteError, match="cannot be written"):
        kg.export(pendulum, "wasm", tmp_path / "missing" / "module.wasm")
    monkeypatch.setenv("PATH", "")
    monkeypatch.setattr(toolchain, "is_installed", lambda name: False)
    with pytest.raises(BuildError, match="pip install ziglang"):
        kg.export(pendulum, "wasm", tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_each_platform_has_a_compiler(monkeypatch):
    assert chosen_platforms() == (platforms.host(),)
    assert is_installed("ziglang")
    for one in PLATFORMS.values():
        command = platforms.compiler_for(one).command
        assert (one == platforms.host()) or command[-1] == one.target
    monkeypatch.setattr(platforms, "is_installed", lambda name: False)
    other = next(one for one in PLATFORMS.values() if one != platforms.host())
    with pytest.raises(BuildError, match=f"{other.name}.*pip install ziglang"):
        platforms.compiler_for(other)


def test_the_command_line_writes_products_beside_the_c(tmp_path, monkeypatch):
    folder, model = tmp_path / "out", str(ROOT / "models" / "double_pendulum.toml")
    arguments = ["generate", model, "-o", str(folder), "--output", "forcing", "--for", "wasm"]
    for _ in range(2):  # its own files may be renewed
        CliRunner().invoke(app, arguments, catch_exceptions=False)
        assert is_unchanged((folder / "wasm" / "double_pendulum.wasm").read_bytes())
        assert (folder / "double_pendulum.h").is_file()
    monkeypatch.setenv("PATH", "")
    monkeypatch.setattr(toolchain, "is_installed", lambda name: False)
    arguments[3] = str(tmp_path / "missing")
    with pytest.raises(BuildError, match="pip install ziglang"):
        CliRunner().invoke(app, arguments, catch_exceptions=False)
    assert not (tmp_path / "missing").exists()


def test_platforms_on_the_command_line(tmp_path):
    model = str(ROOT / "models" / "planar_pendulum.toml")
    assert tuple(PLATFORMS) == options.PLATFORM_NAMES
    for arguments, words in (
        (["--for", "fmi3", "--platform", "x86_64-window"], "Did you mean 'x86_64-windows'"),
        (["--for", "wasm", "--platform", "x86_64-linux"], "no target has platforms"),
    ):
        result = CliRunner().invoke(app, ["generate", model, "-o", str(tmp_path / "new"), *arguments])
        assert result.exit_code != 0
        assert words in result.output + str(result.exception)
        assert not (tmp_path / "new").exists()
