"""FMUs for FMI 2.0 and 3.0: their variables, their description in XML, and their sources in C.

`layout` puts all arrays of the C one after the other, `variables` names their parts, `structure` reads off
the programs what depends on what, `calls` says which functions of the C compute what. `description` makes
attributes of XML of this, and `files` fills the templates.
"""

from kanegen.artifacts.fmi.files import files, fmi2, fmi3, needed_outputs, refusal, usual_outputs

__all__ = ["files", "fmi2", "fmi3", "needed_outputs", "refusal", "usual_outputs"]
