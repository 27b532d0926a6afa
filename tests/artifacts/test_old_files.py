"""Files of an earlier call in the same folder: those of the same model that nobody changed go away."""

import os
from pathlib import Path, PurePosixPath

import pytest

import kanegen as kg
from kanegen.artifacts import ARTIFACTS, places, with_artifacts
from kanegen.c import folder as folders
from kanegen.c.provenance import with_provenance, with_provenance_at_end
from kanegen.errors import WriteError
from tests.support.command import kanegen
from tests.support.handmade import source
from tests.support.paths import ROOT

PENDULUM = str(ROOT / "models" / "double_pendulum.toml")


@pytest.fixture(scope="module")
def plain():
    return source()


@pytest.fixture(scope="module")
def many(plain):
    """The source with files beside it and in a folder below, which `plain` lacks."""
    return with_artifacts(plain, ["cpp", "description", "rust"])


def tree(folder):
    return {
        path.relative_to(folder).as_posix(): path.read_bytes() for path in folder.rglob("*") if path.is_file()
    }


def files(made):
    return {name: text.encode() for name, text in made.files.items()}


def write(made, folder, force=False):
    return folders.write(made.files, folder, force, made.model.name, made.places)


GONE = ("handmade.hpp", "handmade.json", "handmade_description.h", "kanegen_views.hpp", "rust/")


@pytest.mark.parametrize("force", [False, True])
def test_files_that_the_new_call_does_not_make_go_away(plain, many, tmp_path, force):
    write(many, tmp_path)
    assert write(plain, tmp_path, force) == GONE
    assert tree(tmp_path) == files(plain)
    assert not (tmp_path / "rust").exists()
    assert write(plain, tmp_path) == ()
    many.write(tmp_path)
    plain.write(tmp_path)
    assert tree(tmp_path) == files(plain)


def test_products_go_away_as_well(plain, tmp_path):
    products = {
        "handmade.fmu": with_provenance_at_end(b"PK\x03\x04 an archive \0\0"),
        "wasm/handmade.wasm": with_provenance_at_end(b"\0asm\x01\0\0\0"),
    }
    folders.write({**plain.files, **products}, tmp_path)
    assert write(plain, tmp_path) == ("handmade.fmu", "wasm/")
    assert tree(tmp_path) == files(plain)


@pytest.mark.parametrize("name", ["handmade.hpp", "rust/src/lib.rs", "rust/target/deep/x.o", "rust/mine.rs"])
def test_files_that_are_not_as_kanegen_wrote_them_stay(plain, many, tmp_path, name):
    write(many, tmp_path)
    changed = tmp_path / name
    changed.parent.mkdir(parents=True, exist_ok=True)
    with changed.open("a") as file:
        file.write("mine\n")
    before = tree(tmp_path)
    shown = "rust/target" if "target" in name else name
    with pytest.raises(
        WriteError, match=f": holds {shown}, which are not this model's files as kanegen wrote"
    ):
        write(plain, tmp_path)
    assert tree(tmp_path) == before
    write(plain, tmp_path, force=True)
    assert tree(tmp_path) == {**files(plain), name: before[name]}


def test_files_of_other_models_stay(plain, tmp_path):
    """One name is the beginning of the other."""
    longer = with_artifacts(source("handmade_2"), ["cpp", "rust"])
    write(longer, tmp_path)
    before = tree(tmp_path)
    with pytest.raises(
        WriteError, match=r"holds handmade_2\.c, handmade_2\.h, .*, which are not this model's"
    ):
        write(plain, tmp_path)
    assert write(plain, tmp_path, force=True) == ()
    assert tree(tmp_path) == {**before, **files(plain)}
    assert write(with_artifacts(plain, ["description"]), tmp_path, force=True) == ()
    assert write(plain, tmp_path, force=True) == ("handmade.json", "handmade_description.h")
    write(longer, tmp_path, force=True)
    assert files(plain).keys() | files(longer).keys() == tree(tmp_path).keys()


def test_code_in_a_folder_below_and_links_stay(plain, tmp_path):
    """A folder of other code below is none of the folders that targets have."""
    plain.write(tmp_path / "models" / "handmade")
    (tmp_path / "handmade.hpp").symlink_to(tmp_path / "models" / "handmade" / "handmade.h")
    (tmp_path / "wasm").symlink_to(tmp_path / "models")
    before = tree(tmp_path)
    with pytest.raises(WriteError, match=r"holds handmade\.hpp, models, wasm, which"):
        write(plain, tmp_path)
    assert write(plain, tmp_path, force=True) == ()
    assert tree(tmp_path) == {**before, **files(plain)}


def test_a_file_that_is_written_through_a_link_stays(plain, tmp_path):
    write(with_artifacts(plain, ["cpp"]), tmp_path)
    (tmp_path / "main.c").unlink()
    (tmp_path / "main.c").symlink_to("handmade.hpp")
    assert write(plain, tmp_path) == ("kanegen_views.hpp",)
    assert tree(tmp_path) == {**files(plain), "handmade.hpp": files(plain)["main.c"]}


def test_all_or_nothing(plain, many, tmp_path, monkeypatch):
    """An old file cannot be removed, after all others were written."""
    write(many, tmp_path)
    before = tree(tmp_path)
    replace = os.replace

    def refuse(old, new):
        if Path(old).name == "sys.rs":
            raise PermissionError(13, "Permission denied")
        replace(old, new)

    monkeypatch.setattr(os, "replace", refuse)
    with pytest.raises(WriteError, match=r"sys\.rs: cannot be written: Permission denied"):
        write(source(parameters=False), tmp_path)
    assert tree(tmp_path) == before


def test_every_artifact_says_where_its_files_can_be():
    made = kg.generate(kg.load(PENDULUM), artifacts=["fmi2"])
    names = [name for name in ARTIFACTS if not ARTIFACTS[name].obstacle(made)]
    # The others name their files after the model in any case.
    assert set(ARTIFACTS) - set(names) == {"casadi", "certificate", "reanchoring"}
    tops = {PurePosixPath(file).parts[0] for name in names for file in ARTIFACTS[name].files(made)}
    usual = {top for top in tops if top.startswith(("double_pendulum.", "double_pendulum_", "kanegen_"))}
    assert tops - usual == set(places("double_pendulum"))


def test_the_command_line_says_what_it_removed(tmp_path):
    folder = str(tmp_path / "two")
    assert "removed" not in kanegen("generate", PENDULUM, "--for", "cpp", "-o", folder).stdout
    said = kanegen("generate", PENDULUM, "--for", "description", "-o", folder).stdout
    assert said.endswith("\nremoved double_pendulum.hpp, kanegen_views.hpp, which this call does not make\n")
    own = with_provenance("a.h", "int a;\n")
    (tmp_path / "two" / "notes.h").write_text(own)
    assert "holds notes.h" in kanegen("generate", PENDULUM, "-o", folder, status=2).stderr
