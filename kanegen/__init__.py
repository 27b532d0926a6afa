"""kanegen: Kane's equations of motion for a tree of rigid bodies, as C specialised to that tree."""

from kanegen.numbers import Parameter
from kanegen.system import Body, Joint, System

__all__ = ["Body", "Joint", "Parameter", "System"]
