"""Facades: C and C++ that is compiled together with generated code into one shared library."""

import ctypes
import shutil

import numpy as np
import pytest

from kanegen.errors import MissingError
from kanegen.library import load
from kanegen.library.native.build import build
from kanegen.library.native.facade import Facade
from tests.support.handmade import source

C_TEXT = """\
#include "handmade.h"
#include "scale.h"

int scaled(const double *x, double *A) {
    const int status = handmade_mass_matrix(x, A);
    A[0] *= SCALE;
    return status;
}
"""

CPP_TEXT = """\
#include <scale.h>
#include "handmade.h"

extern "C" double largest(const double *x) {
    double A[4] = {};
    handmade_mass_matrix(x, A);
    double found = 0.0;
    for (const double entry : A) { found = entry > found ? entry : found; }
    return SCALE * found;
}
"""

X = np.array([0.3, -0.7])


@pytest.fixture(scope="module")
def model():
    return source(parameters=False)


def pointer(array):
    return array.ctypes.data_as(ctypes.c_void_p)


def test_c_that_calls_the_generated_functions(model):
    files = {"scaled.c": C_TEXT, "scale.h": "#define SCALE 2.0\n"}
    library = ctypes.CDLL(str(build(model, facade=Facade("handmade_scaled", files))))
    A = np.empty((2, 2))
    assert library.scaled(pointer(X), pointer(A)) == 0
    expected = load(model).mass_matrix(X)
    expected[0, 0] *= 2.0
    np.testing.assert_array_equal(A, expected)


def test_cpp_with_headers_of_another_package(model, tmp_path):
    (tmp_path / "scale.h").write_text("#define SCALE 4.0\n")
    facade = Facade("handmade_cpp", {"largest.cpp": CPP_TEXT}, (tmp_path,))
    path = build(model, facade=facade)
    library = ctypes.CDLL(str(path))
    library.largest.restype = ctypes.c_double
    assert library.largest(pointer(X)) == 4.0 * load(model).mass_matrix(X).max()
    assert build(model, facade=facade) == path
    (tmp_path / "scale.h").write_text("#define SCALE 16.0\n")
    assert build(model, facade=facade) != path, "a header has changed"


def test_without_a_cpp_compiler(model, monkeypatch, tmp_path):
    monkeypatch.delenv("CXX", raising=False)
    monkeypatch.setenv("CC", shutil.which("cc") or shutil.which("gcc"))
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(MissingError, match="no C\\+\\+ compiler"):
        build(model, facade=Facade("handmade_cpp", {"largest.cpp": CPP_TEXT}))


def test_what_is_no_facade(model):
    with pytest.raises(ValueError, match=r"none of notes\.txt ends in \.c or \.cpp"):
        Facade("notes", {"notes.txt": ""})
    with pytest.raises(ValueError, match=r"handmade\.c is a file of the model, too"):
        build(model, facade=Facade("other", {"handmade.c": ""}))
